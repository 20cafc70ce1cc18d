"""Bytes in any common spelling: watch tables, traces, manuals, C and Python."""

from __future__ import annotations

import re
from dataclasses import dataclass

from plcgen.base.diagnostics import Diagnostic, PlcgenError, Span
from plcgen.base.diagnostics.counting import quantity

MAX_BYTES = 64 * 1024
"""Longest telegram text that is taken apart; a record has 240 bytes at most."""

_SEPARATORS = re.compile(r"[\s,;:|_\-\[\](){}]+|\\x|b?['\"]")
_TOKEN = re.compile(
    r"(?:(?P<type>B|W|DW|L|BYTE|WORD|DWORD|LWORD)#)?(?P<prefix>16#|0x|\$)?(?P<digits>[0-9a-f]+(?:_[0-9a-f]+)*)(?P<h>h?)",
    re.IGNORECASE,
)
_SIZES = {"B": 1, "BYTE": 1, "W": 2, "WORD": 2, "DW": 4, "DWORD": 4, "L": 8, "LWORD": 8}


class HexError(PlcgenError, ValueError):
    """Text that is no bytes: column (from 0), length of the piece, why."""

    def __init__(self, column: int, length: int, reason: str) -> None:
        self.column, self.length, self.reason = column, length, reason
        super().__init__(reason)


def hex_problem(problem: HexError, name: str, line: int, spellings: str) -> Diagnostic:
    """The piece that is no bytes, in its line."""
    start = problem.column + 1
    return Diagnostic("PG701", problem.reason, Span(name, line, start, line, start + problem.length), help=spellings)


@dataclass(frozen=True, slots=True)
class HexText:
    """Bytes with the place of each in the text: (column from 0, length)."""

    data: bytes
    places: tuple[tuple[int, int], ...]

    def place(self, offset: int) -> tuple[int, int]:
        """Where byte ``offset`` stands; after the last byte: just after it."""
        if offset < len(self.places):
            return self.places[offset]
        column, length = self.places[-1] if self.places else (0, 0)
        return column + length, 1


def strip_comment(text: str) -> str:
    """Cut ``// ...`` off, as ``plcgen encode`` writes it; lines starting with ``# `` are comments too."""
    body = text.split("//", 1)[0]
    return "" if body.lstrip().startswith("# ") or body.strip() == "#" else body.rstrip()


def parse_hex(text: str) -> HexText:
    """Read bytes: ``03 01``, ``0301``, ``16#03``, ``W#16#0101``, ``0x03``, ``03h``, ``03-01``, commas.

    Raises HexError at the first piece that is not a hexadecimal number.
    """
    data = bytearray()
    places: list[tuple[int, int]] = []
    position = 0
    while position < len(text):
        separator = _SEPARATORS.match(text, position)
        if separator:
            position = separator.end()
            continue
        match = _TOKEN.match(text, position)
        if match is None or not _ends(text, match.end()):
            end = re.compile(r"[\s,;]|\Z").search(text, position)
            stop = end.start() if end else len(text)
            piece = text[position:stop]
            raise HexError(position, max(1, len(piece)), f'"{piece[:40]}" is not a hexadecimal number')
        _append(match, data, places)
        if len(data) > MAX_BYTES:
            raise HexError(position, 1, f"more than {MAX_BYTES} bytes in one line; a record has at most 240")
        position = match.end()
    return HexText(bytes(data), tuple(places))


def _ends(text: str, position: int) -> bool:
    return position == len(text) or _SEPARATORS.match(text, position) is not None


def _append(match: re.Match[str], data: bytearray, places: list[tuple[int, int]]) -> None:
    """Add one token; a literal with a prefix is filled up with zeros from the left."""
    digits = match["digits"].replace("_", "")
    start, length = match.start(), match.end() - match.start()
    size = _SIZES.get((match["type"] or "").upper(), 0)
    if size and len(digits) > 2 * size:
        raise HexError(start, length, f"{match[0]} has more than {quantity(size, 'byte')}")
    prefixed = bool(match["prefix"] or match["h"] or match["type"])
    if len(digits) % 2 and not prefixed:
        raise HexError(start, length, f'"{match[0][:40]}" has an odd number of digits')
    digits = digits.zfill(max(2 * size, len(digits) + len(digits) % 2))
    piece = bytes.fromhex(digits)
    data += piece
    plain = len(match["digits"]) == len(digits)
    first = match.start("digits")
    places += [(first + 2 * n, 2) if plain else (start, length) for n in range(len(piece))]
