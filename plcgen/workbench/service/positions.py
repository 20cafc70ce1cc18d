"""Columns as others count them: spans count characters from 1, editors and browsers units of an encoding from 0.

UTF-16 is what browsers count, and editors that agree on nothing else; some prefer UTF-8 or characters (UTF-32).
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Literal

Encoding = Literal["utf-8", "utf-16", "utf-32"]
_ENDS = re.compile(r"\r\n|\n|\r")
_SURROGATES = re.compile("[\ud800-\udfff]")


def split_lines(text: str) -> list[str]:
    """Lines as editors count them; the other separators of Unicode end none."""
    return _ENDS.split(text)


def without_surrogates(text: str) -> str:
    """Text without halves of characters, which no file can hold; each becomes the replacement character."""
    return text if text.isascii() else _SURROGATES.sub("\ufffd", text)


def width(text: str, encoding: Encoding = "utf-16") -> int:
    """Length in units of an encoding."""
    if encoding == "utf-32" or text.isascii():
        return len(text)
    if encoding == "utf-8":
        return len(text.encode())
    return len(text) + sum(char > "\uffff" for char in text)


def to_units(lines: Sequence[str], line: int, column: int, encoding: Encoding = "utf-16") -> tuple[int, int]:
    """Line and column of a span as line and character of the language server protocol; what is outside is moved in."""
    if line < 1:
        return 0, 0
    if line > len(lines):
        return max(len(lines) - 1, 0), width(lines[-1], encoding) if lines else 0
    return line - 1, width(lines[line - 1][: max(column - 1, 0)], encoding)


def from_units(lines: Sequence[str], line: int, character: int, encoding: Encoding = "utf-16") -> tuple[int, int]:
    """The way back; the middle of a character that takes several units is its beginning."""
    if not lines or line < 0:
        return 1, 1
    if line >= len(lines):
        return len(lines), len(lines[-1]) + 1
    text, left = lines[line], max(character, 0)
    if text.isascii() or encoding == "utf-32":
        return line + 1, min(left, len(text)) + 1
    for column, char in enumerate(text, 1):
        left -= width(char, encoding)
        if left < 0:
            return line + 1, column
    return line + 1, len(text) + 1
