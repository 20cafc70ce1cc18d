"""What is known of one version of a source, or of a part of one."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from plcgen.base.diagnostics import Diagnostic, Span
from plcgen.s7.cpu.sources import SUFFIXES, read_shown
from plcgen.s7.scl import ast
from plcgen.s7.scl.lexer import LOCAL, NAME, QUOTED, WORDS, Tokens, tokenize
from plcgen.s7.scl.parser import ParseResult
from plcgen.s7.types.blocks import Block
from plcgen.workbench.service.documents import Document

NAMES = WORDS | {LOCAL}
"""Kinds of tokens that may be a step of a name."""


def is_source(document: Document) -> bool:
    """Whether a document is a PLC source."""
    return document.path.suffix.lower() in SUFFIXES


class Around(Mapping[str, Block]):
    """Blocks that stand elsewhere: in other parts of the file, as it is now, else in the files around it."""

    def __init__(self, outside: Callable[[], Mapping[str, Block]]) -> None:
        self.outside = outside
        self.inside: Mapping[str, Block] = {}

    def __getitem__(self, key: str) -> Block:
        return self.inside[key] if key in self.inside else self.outside()[key]

    def __iter__(self) -> Iterator[str]:
        return iter({**self.outside(), **self.inside})

    def __len__(self) -> int:
        return len({*self.outside(), *self.inside})


@dataclass(frozen=True, eq=False)
class SourceState:
    """A version of a source; each part is worked out when it is asked for, once."""

    document: Document
    around: Mapping[str, Block]
    """Blocks that stand elsewhere by name in upper case."""
    file: str
    """What spans call it: its path, or a name of its own for a part of a file."""

    @cached_property
    def _read(self) -> tuple[ParseResult, list[Block], list[Diagnostic]]:
        kept: list[ParseResult] = []
        found, problems = read_shown(self.document.text, self.document.path, self.file, keep=kept.append)
        return kept[0], found, problems

    @property
    def result(self) -> ParseResult:
        """Its tree and its tokens."""
        return self._read[0]

    @property
    def tokens(self) -> Tokens:
        """Its tokens."""
        return self._read[0].tokens

    @property
    def lexed(self) -> Tokens:
        """Its tokens, without a tree if nobody has asked for one."""
        return self.tokens if "_read" in self.__dict__ else tokenize(self.document.text, self.file)

    @property
    def blocks(self) -> Sequence[Block]:
        """Its blocks."""
        return self._read[1]

    @property
    def problems(self) -> Sequence[Diagnostic]:
        """What is wrong with its syntax and its declarations."""
        return self._read[2]

    @cached_property
    def own(self) -> Mapping[str, Block]:
        """Its blocks by name in upper case; of two with one name the first."""
        return {block.name.upper(): block for block in reversed(self.blocks)}

    @cached_property
    def types(self) -> Mapping[str, Block]:
        """Every block that it can name: its own, those of other files."""
        return {**self.around, **self.own}

    def offset(self, line: int, column: int) -> int:
        """Character offset of a place."""
        starts = self._line_starts
        return starts[min(line, len(starts)) - 1] + column - 1

    @cached_property
    def _line_starts(self) -> Sequence[int]:
        """Offsets at which the lines begin; every line end is one character."""
        found = [0]
        for line in self.document.lines:
            found.append(found[-1] + len(line) + 1)
        return found[:-1]

    def token_at(self, offset: int) -> int | None:
        """The token at an offset; between two of them the one that is a name."""
        tokens = self.tokens
        last = bisect_right(tokens.starts, offset) - 1
        found = [at for at in (last, last - 1) if at >= 0 and tokens.texts[at] and offset <= tokens.end(at)]
        return next((at for at in found if tokens.kinds[at] in NAMES), found[0] if found else None)

    def unit_at(self, offset: int) -> ast.Unit | None:
        """The block in which an offset is."""
        return next((unit for unit in self.result.units if unit.start <= offset <= unit.end), None)

    def block_of(self, unit: ast.Unit) -> Block | None:
        """The block that a unit declares."""
        return next((block for block in self.blocks if block.name == unit.name), None)

    def name_place(self, unit: ast.Unit) -> Span:
        """Where the name of a block stands, else the word that begins it."""
        tokens = self.tokens
        first = bisect_right(tokens.starts, unit.start) - 1
        for at in range(first, min(first + 4, len(tokens.kinds))):
            if tokens.kinds[at] in {NAME, QUOTED} and tokens.texts[at].strip('"') == unit.name:
                return tokens.span(tokens.starts[at], tokens.end(at))
        return tokens.span(unit.start, unit.start + len(unit.keyword))
