"""Guides that are not in English, read back: each heading, sentence and column as the English one that it translates.

The phrase book beside the templates is the only thing that is shared with what writes them; how it is applied is found
out here from its other side. A sentence that is not in it stays as it is, and nobody states it.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator
from functools import cache

from plcgen.base.resources import templates_dir

_MARKED = re.compile(r"\d+\. |- ")
_FRONT = re.compile(r"(#+ |\d+\. |- |)(.*)", re.DOTALL)
_OWN_LINE = ("#", "|", "```")
_BAR = re.compile(r"(?<!\\)\|")
_RULE = re.compile(r"\|(?:-+:?\|)+")
_COLUMN = {"de": 0, "zh": 1}
_SPOKEN = frozenset({"phrase", "speed", "title"})
"""Places that have a phrase of their own."""
Reading = tuple[re.Pattern[str], str]
"""A translation as a pattern of the whole text, and the English form."""


def read_back(text: str, language: str) -> str:
    """The text with each paragraph in its first line, as many lines as before; in English if the book has it so."""
    lines = list(_joined(text.split("\n")))
    column = _COLUMN.get(language[:2].lower())
    if column is None:
        return "\n".join(lines)
    headers = {at - 1 for at, line in enumerate(lines) if _RULE.fullmatch(line)}
    return "\n".join(_english(line, column, header=at in headers) for at, line in enumerate(lines))


def title_in(language: str, title: str) -> str:
    """The title of a parameter as the table of titles has it; what a connection calls itself stands in front."""
    role, _, rest = title.rpartition(": ")
    texts = _titles().get(rest, []) if role in {"", "BI", "CI", "BO", "CO", "CO/BO"} else _titles().get(title, [])
    column = _COLUMN.get(language[:2].lower())
    return title if column is None or not texts else f"{role}{': ' if role else ''}{texts[column]}"


@cache
def _titles() -> dict[str, list[str]]:
    found: dict[str, list[str]] = {}
    for path in sorted(templates_dir().glob("*/titles.toml")):
        found |= tomllib.loads(path.read_text("utf-8"))
    return found


def _joined(lines: list[str]) -> Iterator[str]:
    """Paragraphs of several lines in one, and empty lines for the others; code and tables as they are."""
    whole: list[str] = []
    waiting = 0
    code = False
    for line in [*lines, ""]:
        own = code or line.startswith(_OWN_LINE) or not line.strip()
        if whole and (own or _MARKED.match(line)):
            yield from [" ".join(whole), *[""] * waiting]
            whole, waiting = [], 0
        code ^= line.startswith("```")
        if own:
            yield line
        else:
            waiting += bool(whole)
            whole.append(line.strip())


def _english(line: str, column: int, *, header: bool) -> str:
    if _RULE.fullmatch(line):
        return line
    if line.startswith("|"):
        part = "columns" if header else "cells"
        return "|".join(f" {_cell(cell.strip(), part, column)} " if cell else cell for cell in _BAR.split(line))
    front = _FRONT.match(line)
    mark, text = front.groups() if front else ("", line)
    return f"{mark}{_meant(text, 'lines', column) or text}"


def _cell(cell: str, part: str, column: int) -> str:
    whole = _meant(cell, part, column)
    return whole or "; ".join(_meant(piece, "pieces", column) or piece for piece in cell.split("; "))


def _meant(text: str, part: str, column: int) -> str:
    """The English of a text; empty if it is no translation."""
    for pattern, english in _book(part, column):
        found = pattern.fullmatch(text)
        if found is not None:
            places = found.groupdict()
            inner = {name: _meant(places[name], "phrases", column) for name in _SPOKEN & places.keys()}
            return english.format(**places | {name: one for name, one in inner.items() if one})
    return ""


@cache
def _book(part: str, column: int) -> list[Reading]:
    paths = (
        sorted(templates_dir().glob("*/phrases.toml"), reverse=True)
        if part == "phrases"
        else [templates_dir() / "text" / "guide.toml"]
    )
    books = [tomllib.loads(path.read_text("utf-8")) for path in paths]
    rows = [row for book in books for row in (book if part == "phrases" else book[part]).items()]
    return [(_pattern(texts[column]), english) for english, texts in rows]


def _pattern(text: str) -> re.Pattern[str]:
    return re.compile("".join(
        f"(?P<{piece[1:-1]}>.+?)" if piece.startswith("{") else re.escape(piece)
        for piece in re.split(r"(\{\w+\})", text)
    ))  # fmt: skip
