"""A second reader and calculator of layouts with standard access: sources in, the place of every member out.

Written apart from the first one, from the Siemens manuals "Programming with STEP 7" and "S7-SCL for S7-300/400", their
appendices on data types: a BOOL takes the next bit, a byte the next byte, everything longer an even byte; a structure
and an array begin at an even byte and end there; a STRING has two bytes in front of its characters.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from math import prod

BITS = {
    **dict.fromkeys(("BYTE", "CHAR", "SINT", "USINT"), 8),
    **dict.fromkeys(("WORD", "INT", "UINT", "DATE", "S5TIME", "DB_ANY", "HW_IO", "PORT", "BLOCK_DB"), 16),
    **dict.fromkeys(("DWORD", "DINT", "UDINT", "REAL", "TIME", "TIME_OF_DAY", "TOD"), 32),
    **dict.fromkeys(("LWORD", "LINT", "ULINT", "LREAL", "DATE_AND_TIME", "DT"), 64),
    "BOOL": 1,
}
"""Types whose width the manuals print."""
DEEPEST = 32
"""Levels of structures and types."""
_TOKEN = re.compile(
    r"""(?P<skip>\s+|//[^\n]*|\(\*.*?\*\)|\{[^}\n]*\})|"(?P<quoted>[^"\n]+)"|(?P<text>'[^'\n]*')"""
    r"|(?P<word>[^\W\d]\w*)|(?P<number>\d[\w#.]*)|(?P<sign>\.\.|:=|.)",
    re.DOTALL,
)
_FREE = re.compile(r"^\s*(TITLE|AUTHOR|FAMILY|NAME|VERSION)\s*[=:].*$", re.MULTILINE)
"""Lines of a header; what stands in them is anybody's text."""


class NotKnownError(Exception):
    """Something that this calculator does not know: a type, a way of writing."""


@dataclass(frozen=True, slots=True)
class MemberPlace:
    """Where a member lies, in bits from the start of its block."""

    path: str
    bit: int


@dataclass(slots=True)
class WrittenBlock:
    """A type or data block: its members as (names, tokens of the type), or the type that it is made of."""

    members: list[tuple[str, WrittenType]] = field(default_factory=list)
    of: str = ""


@dataclass(slots=True)
class WrittenType:
    """A type as it is written: a word, bounds of an array, members of a structure."""

    word: str = ""
    bounds: tuple[tuple[int, int], ...] = ()
    length: int = 254
    members: list[tuple[str, WrittenType]] = field(default_factory=list)


class WrittenBlocks:
    """Types and data blocks of some sources, by name in upper case."""

    def __init__(self, texts: Iterable[str]) -> None:
        self.known: dict[str, WrittenBlock] = {}
        for text in texts:
            reader = _Reader(text)
            while (found := reader.block()) is not None:
                self.known[found[0].upper()] = found[1]

    def places(self, name: str) -> tuple[list[MemberPlace], int]:
        """Every member of a block but those inside arrays, and its length in bytes. Raises NotKnownError."""
        found: list[MemberPlace] = []
        end = self._members(self._body(name, 0), 0, "", found, 0)
        return found, _up(end, 16) // 8

    def _body(self, name: str, depth: int) -> list[tuple[str, WrittenType]]:
        block = self.known.get(name.upper())
        if block is None or depth > DEEPEST:
            raise NotKnownError(name)
        return self._body(block.of, depth + 1) if block.of else block.members

    def _members(
        self, members: list[tuple[str, WrittenType]], at: int, prefix: str, found: list[MemberPlace] | None, depth: int
    ) -> int:
        for name, spelling in members:
            at = self._place(spelling, at, f"{prefix}{name}", found, depth)
        return at

    def _place(self, spelling: WrittenType, at: int, path: str, found: list[MemberPlace] | None, depth: int) -> int:
        """Put one member at or after bit ``at``; its end comes back."""
        if depth > DEEPEST:
            raise NotKnownError(path)
        word = spelling.word
        if spelling.bounds:
            at = _up(at, 16)
            _note(found, path, at)
            return _up(at + self._array(spelling, depth), 16)
        if word == "STRING":
            at = _up(at, 16)
            _note(found, path, at)
            return at + 8 * (spelling.length + 2)
        if word in BITS:
            at = _up(at, min(BITS[word], 16))
            _note(found, path, at)
            return at + BITS[word]
        at = _up(at, 16)
        _note(found, path, at)
        inside = spelling.members if word == "STRUCT" else self._body(word, 0)
        return _up(self._members(inside, at, f"{path}.", found, depth + 1), 16)

    def _array(self, spelling: WrittenType, depth: int) -> int:
        """Bits of all elements: those of a row of BOOL are packed, a row begins at a whole byte."""
        counts = [high - low + 1 for low, high in spelling.bounds]
        one = WrittenType(spelling.word, (), spelling.length, spelling.members)
        size = self._place(one, 0, "", None, depth + 1)
        if spelling.word == "BOOL":
            return prod(counts[:-1]) * _up(counts[-1], 8)
        return prod(counts) * (_up(size, 16) if size > 8 else size)


def _note(found: list[MemberPlace] | None, path: str, at: int) -> None:
    if found is not None:
        found.append(MemberPlace(path, at))


def _up(value: int, step: int) -> int:
    return -(-value // step) * step


class _Reader:
    """Tokens of one source, and what is declared in it."""

    def __init__(self, text: str) -> None:
        self.tokens = list(_tokens(text))
        self.at = self.depth = 0

    def next(self) -> str:
        """The next token; quoted names keep a quote in front. Raises NotKnownError at the end."""
        if self.at >= len(self.tokens):
            raise NotKnownError("the source ends too early")
        self.at += 1
        return self.tokens[self.at - 1]

    def block(self) -> tuple[str, WrittenBlock] | None:
        """The next type or data block; others are passed over."""
        while self.at < len(self.tokens):
            word = self.next().upper()
            if word in {"TYPE", "DATA_BLOCK"}:
                return self.name(self.next()), self.declared(f"END_{word}")
            if word in {"FUNCTION_BLOCK", "FUNCTION", "ORGANIZATION_BLOCK"}:
                self.skip_to(f"END_{word}")
        return None

    def declared(self, end: str) -> WrittenBlock:
        """What is between the name of a block and its end."""
        made = WrittenBlock()
        while (token := self.next()).upper() != end:
            if token.upper() == "STRUCT" and not made.members:
                made.members = self.members()
            elif token.startswith('"'):
                made.of = self.name(token)
            elif token.upper() == "BEGIN":
                self.skip_to(end)
                break
        return made

    def members(self) -> list[tuple[str, WrittenType]]:
        """Members up to END_STRUCT."""
        found: list[tuple[str, WrittenType]] = []
        self.depth += 1
        if self.depth > DEEPEST:
            raise NotKnownError("structures nested so deeply")
        while (word := self.next()).upper() != "END_STRUCT":
            if word == ";":
                continue
            names = [self.name(word)]
            while (sign := self.next()) == ",":
                names.append(self.name(self.next()))
            if sign != ":":
                raise NotKnownError(f"{names[0]} {sign}")
            spelling = self.spelling()
            while self.next() != ";":
                pass
            found += [(name, spelling) for name in names]
        self.depth -= 1
        return found

    def spelling(self) -> WrittenType:
        """A type."""
        word = self.next()
        upper = word.upper()
        if upper == "ARRAY":
            bounds = self.bounds()
            inner = self.spelling() if self.tokens[self.at : self.at + 1] != ["ARRAY"] else WrittenType(bounds=bounds)
            if inner.bounds:
                raise NotKnownError("an array of arrays")
            return WrittenType(inner.word, bounds, inner.length, inner.members)
        if upper == "STRUCT":
            return WrittenType("STRUCT", members=self.members())
        if upper == "STRING" and self.tokens[self.at : self.at + 1] == ["["]:
            self.next()
            length = self.next()
            if not length.isdecimal() or len(length) > 3 or self.next() != "]":
                raise NotKnownError(f"STRING[{length}")
            return WrittenType("STRING", length=int(length))
        return WrittenType(self.name(word) if word.startswith('"') else upper)

    def bounds(self) -> tuple[tuple[int, int], ...]:
        """``[0..7, 1..2] OF``."""
        text = ""
        while (token := self.next()).upper() != "OF":
            text += token
        try:
            rows = [part.split("..") for part in text.strip("[]").split(",")]
            return tuple((int(low), int(high)) for low, high in rows)
        except ValueError:
            raise NotKnownError(text) from None

    def skip_to(self, end: str) -> None:
        """Pass everything up to a word."""
        while self.next().upper() != end:
            pass

    @staticmethod
    def name(token: str) -> str:
        """A name without its quote."""
        return token.removeprefix('"')


def _tokens(text: str) -> Iterator[str]:
    for found in _TOKEN.finditer(_FREE.sub("", text)):
        if found["quoted"] is not None:
            yield f'"{found["quoted"]}'
        elif found["skip"] is None:
            yield found[0]
