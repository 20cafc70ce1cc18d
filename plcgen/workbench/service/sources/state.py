"""What is known of one version of a source, and of the sources around it.

Of other files only their declarations are kept, each read once until it changes on disk; typing into one file reads no
other one again.
"""

from __future__ import annotations

import pathlib
from bisect import bisect_right
from collections import ChainMap
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.project.allowances import allowances, settled
from plcgen.s7.cpu.sources import SUFFIXES, check_text, find_sources
from plcgen.s7.read.text import load_text, parse_source
from plcgen.s7.scl import ast
from plcgen.s7.scl.lexer import LOCAL, NAME, QUOTED, WORDS, Tokens, tokenize
from plcgen.s7.scl.parser import ParseResult
from plcgen.s7.types.blocks import Block
from plcgen.workbench.service.documents import Document, Documents

NAMES = WORDS | {LOCAL}
"""Kinds of tokens that may be a step of a name."""
MOST_BYTES = 32 * 1024 * 1024
"""Sources around a file are read up to so many bytes together."""


def is_source(document: Document) -> bool:
    """Whether a document is a PLC source."""
    return document.path.suffix.lower() in SUFFIXES


@dataclass(frozen=True)
class SourceState:
    """A version of a source; each part is worked out when it is asked for, once."""

    document: Document
    around: Mapping[str, Block]
    """Blocks of other files by name in upper case."""

    @cached_property
    def _read(self) -> tuple[ParseResult, list[Block], list[Diagnostic]]:
        kept: list[ParseResult] = []
        found, problems = check_text(self.document.text, self.document.path, keep=kept.append)
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
        return self.tokens if "_read" in self.__dict__ else tokenize(self.document.text, self.document.file)

    @property
    def blocks(self) -> Sequence[Block]:
        """Its blocks."""
        return self._read[1]

    @property
    def diagnostics(self) -> Sequence[Diagnostic]:
        """What ``check`` says of it, less what its comments allow."""
        file = self.document.path.as_posix()
        return tuple(settled(self._read[2], allowances(self.document.text, file)))

    @cached_property
    def own(self) -> Mapping[str, Block]:
        """Its blocks by name in upper case; of two with one name the first."""
        return {block.name.upper(): block for block in reversed(self.blocks)}

    @cached_property
    def types(self) -> Mapping[str, Block]:
        """Every block that it can name: its own, those of other files."""
        return ChainMap(dict(self.own), self.around)  # type: ignore[arg-type]

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


@dataclass(frozen=True, slots=True)
class _Kept:
    """The declarations of a file on disk as it was then."""

    stamp: tuple[int, int]
    blocks: tuple[Block, ...]


class _Around(Mapping[str, Block]):
    """Blocks of the files around one, read when a name is looked up that the file itself does not declare."""

    def __init__(self, sources: Sources, path: pathlib.Path) -> None:
        self._sources, self._path = sources, path

    @cached_property
    def _found(self) -> dict[str, Block]:
        return self._sources.declared_around(self._path)

    def __getitem__(self, key: str) -> Block:
        return self._found[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._found)

    def __len__(self) -> int:
        return len(self._found)


@dataclass(slots=True)
class Sources:
    """What is known of the sources among some documents."""

    documents: Documents
    _states: dict[pathlib.Path, SourceState] = field(default_factory=dict)
    _kept: dict[pathlib.Path, _Kept] = field(default_factory=dict)
    _files: tuple[int, tuple[pathlib.Path, ...]] | None = None

    def state(self, document: Document) -> SourceState:
        """What is known of a version; what is around it is looked up anew for each version."""
        known = self._states.get(document.path)
        if known is None or known.document is not document:
            known = SourceState(document, _Around(self, document.path))
            if self.documents.find(document.path) is document:
                self._states[document.path] = known
        return known

    def renewed(self) -> None:
        """Files or documents are others: what open ones see around them is looked up again."""
        for path, state in self._states.items():
            self._states[path] = SourceState(state.document, _Around(self, path))
        self._states = {path: one for path, one in self._states.items() if self.documents.find(path) is one.document}

    def files(self) -> tuple[pathlib.Path, ...]:
        """The sources of the folder, as it was when a file on disk was last reported as changed."""
        if self._files is None or self._files[0] != self.documents.seen:
            try:
                found = tuple(find_sources(self.documents.folder))
            except (DiagnosticError, OSError):  # too many files, or a folder that nobody may read: none is known
                found = ()
            self._files = (self.documents.seen, found)
        return self._files[1]

    def declared_around(self, path: pathlib.Path) -> dict[str, Block]:
        """Blocks of all other files by name; of several with one name that of the file which is nearest."""
        found: dict[str, Block] = {}
        room = MOST_BYTES
        for other in sorted(self.files(), key=lambda one: _distance(path, one)):
            if other == path:
                continue
            for block in self.blocks_of(other):
                found.setdefault(block.name.upper(), block)
            room -= self._kept[other].stamp[1] if other in self._kept else 0
            if room < 0:
                break
        return found

    def blocks_of(self, path: pathlib.Path) -> Sequence[Block]:
        """The blocks that a file declares, as it is open or on disk."""
        document = self.documents.find(path)
        return self.state(document).blocks if document is not None else self._declarations(path).blocks

    def _declarations(self, path: pathlib.Path) -> _Kept:
        """The declarations of a file on disk, read again only if it is another one than before."""
        try:
            status = path.stat()
            stamp = (status.st_mtime_ns, status.st_size)
        except OSError:
            return _Kept((0, 0), ())
        known = self._kept.get(path)
        if known is None or known.stamp != stamp:
            loaded = load_text(path)
            blocks = () if isinstance(loaded, Diagnostic) else tuple(_declared(loaded[0], path))
            known = self._kept[path] = _Kept(stamp, blocks)
        return known


def _declared(text: str, path: pathlib.Path) -> list[Block]:
    return parse_source(text, path.as_posix(), bodies=False)[0]


def _distance(path: pathlib.Path, other: pathlib.Path) -> tuple[int, str]:
    """How many folders lie between two files."""
    own, others = path.parent.parts, other.parent.parts
    same = next((n for n, (a, b) in enumerate(zip(own, others, strict=False)) if a != b), min(len(own), len(others)))
    return len(own) + len(others) - 2 * same, other.as_posix()
