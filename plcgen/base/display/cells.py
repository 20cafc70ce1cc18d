"""Text as a terminal shows it: columns instead of characters, and nothing a terminal would obey."""

from __future__ import annotations

import unicodedata

TAB = 4
_BIDI = frozenset("\u200e\u200f\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069")
"""Direction marks: they make a line look different from what a compiler reads."""


def clean(text: str) -> str:
    """Make foreign text safe for one terminal line: line ends become spaces, other controls U+FFFD."""
    if text.isascii() and text.isprintable():
        return text
    return "".join(_safe(character) for character in text)


def _safe(character: str) -> str:
    if character in "\t\n\r\x0b\x0c\x85\u2028\u2029":
        return " "
    if character in _BIDI or unicodedata.category(character) in {"Cc", "Cs"}:
        return "\ufffd"
    return character


def width(text: str) -> int:
    """Number of terminal columns of clean text: East Asian wide characters take two, combining marks none."""
    return len(text) if text.isascii() else sum(_columns(character) for character in text)


def _columns(character: str) -> int:
    if unicodedata.category(character) in {"Mn", "Me", "Cf"}:
        return 0
    return 2 if unicodedata.east_asian_width(character) in "WF" else 1


def pad(text: str, columns: int) -> str:
    """Fill text up with spaces to a number of columns."""
    return text + " " * max(0, columns - width(text))


def cut(text: str, columns: int) -> str:
    """Shorten text to a number of columns; ``...`` marks the cut."""
    if width(text) <= columns:
        return text
    room, kept = max(0, columns - 3), ""
    for character in text:
        room -= _columns(character)
        if room < 0:
            break
        kept += character
    return kept + "..."


def wrap(text: str, columns: int) -> list[str]:
    """Break text at spaces into lines of at most ``columns``; a longer word stands alone; never empty."""
    lines, line, used = [], "", 0
    for word in text.split():
        size = width(word)
        if line and used + 1 + size > columns:
            lines.append(line)
            line, used = "", 0
        line = f"{line} {word}" if line else word
        used += size + (1 if used else 0)
    return [*lines, line]


def expand(line: str, start: int, end: int) -> tuple[str, int, int]:
    """Expand tabs and clean a source line; ``start`` and ``end`` (characters from 0) become columns."""
    shown: list[str] = []
    column, first, last = 0, -1, -1
    for position, character in enumerate(line):
        if position == start:
            first = column
        if position == end:
            last = column
        piece = " " * (TAB - column % TAB) if character == "\t" else _safe(character)
        shown.append(piece)
        column += width(piece)
    first = column if first < 0 else first
    last = column if last < 0 else last
    return "".join(shown), first, max(last, first)


def window(text: str, start: int, end: int, columns: int) -> tuple[str, int, int]:
    """Cut a long line to a window that shows columns ``start`` to ``end``; returns text and their new place."""
    if width(text) <= columns:
        return text, start, end
    room = columns - 6
    left = max(0, min(start - room // 4, max(0, width(text) - room)))
    kept, column, offset = "", 0, 0
    for character in text:
        size = _columns(character)
        if column >= left and column + size <= left + room:
            if not kept:
                offset = column
            kept += character
        column += size
    head = "..." if left else ""
    tail = "..." if left + room < width(text) else ""
    shift = len(head) - offset
    right = width(head) + width(kept)
    return head + kept + tail, start + shift, min(end + shift, right)
