"""Whole lists of parameters: what the manufacturer prints of every number of a drive object, as facts.

Each file names its list in the first line and has a line for each parameter, by number; a number can stand several
times, for different drive objects. ``python -m tests.evidence LISTS --part lists --save`` makes them (docs/devices.md).
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

COLUMNS = (
    "number", "letter", "objects", "title", "type", "bico", "array", "unit", "min", "max", "default", "scaling",
    "changeable", "values", "bits", "indexes",
)  # fmt: skip
FOLDER = Path(__file__).parent
ALL = "ALL"
"""What stands for every drive object."""


@dataclass(frozen=True, slots=True)
class Listed:
    """A line of a list: texts by their columns, empty where the list says nothing."""

    texts: Mapping[str, str]

    @property
    def objects(self) -> frozenset[str]:
        """Drive objects that have it, as the list calls them; none in a list of a device that has only one."""
        return frozenset(self.texts["objects"].split())

    def names(self, column: str) -> Mapping[int, str]:
        """What numbers stand for: of values, bits (with the meaning of 0 and 1) or indexes."""
        pairs = (one.partition("=") for one in self.texts[column].split("; ") if re.match(r"-?[0-9]+=", one))
        return {int(number): name for number, _, name in pairs}


@lru_cache(maxsize=4)
def _text(name: str) -> str:
    return "\n" + (FOLDER / f"{name}.tsv").read_text("utf-8")


def names() -> Sequence[str]:
    """The lists that there are."""
    return sorted(path.stem for path in FOLDER.glob("*.tsv"))


def source(name: str) -> str:
    """What a list is."""
    return _text(name)[1:].partition("\n")[0].removeprefix("# ")


def find(name: str, number: int) -> Sequence[Listed]:
    """What a list says of a number; empty if it does not have it."""
    text, found = _text(name), []
    at = text.find(f"\n{number}\t")
    while at >= 0:
        fields = text[at + 1 : text.find("\n", at + 1)].split("\t")
        found.append(Listed(dict(zip(COLUMNS, fields + [""] * (len(COLUMNS) - len(fields)), strict=True))))
        at = text.find(f"\n{number}\t", at + 1)
    return found
