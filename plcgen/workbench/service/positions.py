"""Columns as others count them: editors and browsers count UTF-16 units from 0, spans count characters from 1."""

from __future__ import annotations

import re
from collections.abc import Sequence

_ENDS = re.compile(r"\r\n|\n|\r")


def split_lines(text: str) -> list[str]:
    """Lines as editors and the YAML reader count them; the other separators of Unicode end none."""
    return _ENDS.split(text)


def units(text: str) -> int:
    """Length in UTF-16 units."""
    return len(text) + sum(char > "\uffff" for char in text)


def to_utf16(lines: Sequence[str], line: int, column: int) -> tuple[int, int]:
    """Line and column of a span as line and character of the language server protocol; what is outside is moved in."""
    if not lines or line < 1:
        return 0, 0
    at = min(line, len(lines)) - 1
    return at, units(lines[at][: max(column - 1, 0)]) if line <= len(lines) else units(lines[at])


def from_utf16(lines: Sequence[str], line: int, character: int) -> tuple[int, int]:
    """The way back; the middle of a character that takes two units is its beginning."""
    if not lines or line < 0:
        return 1, 1
    if line >= len(lines):
        return len(lines), len(lines[-1]) + 1
    text, left = lines[line], max(character, 0)
    if text.isascii():
        return line + 1, min(left, len(text)) + 1
    for column, char in enumerate(text, 1):
        left -= 1 + (char > "\uffff")
        if left < 0:
            return line + 1, column
    return line + 1, len(text) + 1
