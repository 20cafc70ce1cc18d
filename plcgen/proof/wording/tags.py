"""Comments of tags and symbols: the signal and the title of its job."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Sequence

from plcgen.project.nouns import Project
from plcgen.proof.folder import plain
from plcgen.proof.wording.model import Wording, agrees
from plcgen.s7.types.address import Address

_COLUMNS, _LONGEST = 4, 80
"""Columns of a tag or a symbol; characters of the comment of a symbol."""


def commented(project: Project, stated: Sequence[Wording]) -> dict[str, frozenset[str]]:
    """What the comment of a flag may say, by its address without percent sign."""
    return {
        place.text(percent=False): frozenset(f"{signal}: {title}" for one in stated for title in one.called(job) or ())
        for job in project.jobs
        for signal, place in job.trigger.items()
        if isinstance(place, Address)
    }


def check_tags(project: Project, stated: Sequence[Wording], text: str) -> Iterator[tuple[int, str]]:
    """``tags.csv``."""
    wanted, english = commented(project, stated), project.languages[0].startswith("en")
    for number, row in enumerate(csv.reader(text.splitlines(), delimiter=";"), 1):
        texts = wanted.get(row[2].removeprefix("%")) if len(row) == _COLUMNS else None
        if texts is not None and not agrees(row[3], texts, english=english):
            yield number, f'{row[0]} says "{row[3]}"; stated: {" or ".join(sorted(texts))}'


def check_symbols(project: Project, stated: Sequence[Wording], text: str) -> Iterator[tuple[int, str]]:
    """``symbols.sdf``: columns of 24, 12, 10 and 80 characters; of blocks, only those of a CP have a comment."""
    wanted, english = commented(project, stated), project.languages[0].startswith("en")
    system = {name: said for one in stated for name, said in one.symbols.items()}
    for number, row in enumerate(csv.reader(text.splitlines()), 1):
        if len(row) != _COLUMNS:
            continue  # told where tables are read
        name, address, comment = row[0].strip(), "".join(row[1].split()), row[3].strip()
        texts = wanted.get(address, frozenset({system[name]} if name in system else {""}))
        cut = frozenset(plain(text.replace('"', "'"))[:_LONGEST].strip() for text in texts)
        if not agrees(comment, cut | {""} if not comment.isascii() or not english else cut, english=english):
            yield number, f'{name} says "{comment}"; stated: {" or ".join(sorted(cut)) or "nothing"}'
        if [len(cell) for cell in row[1:]] != [12, 10, 80] or len(row[0]) < 24:
            yield number, f"{name}: the columns are not 24, 12, 10 and 80 characters wide"
