"""What is known of the sources of a folder.

Of other files only their declarations are kept, each read once until it changes on disk; typing into one file reads no
other one again.
"""

from __future__ import annotations

import pathlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.s7.cpu.sources import find_sources
from plcgen.s7.read.text import load_text, parse_source
from plcgen.s7.types.blocks import Block
from plcgen.workbench.service.documents import Document, Documents
from plcgen.workbench.service.sources.parts import PART, SourceFile
from plcgen.workbench.service.sources.version import Around, SourceState

MOST_BYTES = 32 * 1024 * 1024
"""Sources around a file are read up to so many bytes together."""


@dataclass(frozen=True, slots=True)
class _Kept:
    """The declarations of a file on disk as it was then."""

    stamp: tuple[int, int]
    blocks: tuple[Block, ...]


@dataclass(slots=True)
class _Outside:
    """Blocks of the files around one: read when they are asked for, and again after files have changed."""

    sources: Sources
    path: pathlib.Path
    turn: int = -1
    found: Mapping[str, Block] = field(default_factory=dict)

    def __call__(self) -> Mapping[str, Block]:
        if self.turn != self.sources.turn:
            self.turn, self.found = self.sources.turn, self.sources.declared_around(self.path)
        return self.found


@dataclass(slots=True)
class Sources:
    """What is known of the sources among some documents; ``turn`` grows when there are other files or documents."""

    documents: Documents
    turn: int = 0
    _known: dict[pathlib.Path, SourceFile] = field(default_factory=dict)
    _kept: dict[pathlib.Path, _Kept] = field(default_factory=dict)
    _files: tuple[int, tuple[pathlib.Path, ...]] | None = None

    def file(self, document: Document) -> SourceFile:
        """What is known of a version: what an edit has left alone is what was known before."""
        known = self._known.get(document.path)
        if known is not None and known.document is document:
            return known
        found = None if known is None else known.after(document)
        found = found or SourceFile.of(document, Around(_Outside(self, document.path)))
        if self.documents.find(document.path) is document:
            self._known[document.path] = found
        return found

    def at(self, document: Document, line: int) -> tuple[SourceState, int]:
        """The part in which a line of a document is, and which line of it that is."""
        return self.file(document).at(line)

    def real(self, place: Span) -> Span:
        """A place of a part as one of its file."""
        file, mark, _ = place.file.partition(PART)
        known = self._known.get(pathlib.Path(file)) if mark else None
        return place if known is None else known.real(place)

    def renewed(self) -> None:
        """Files or documents are others: what open ones see around them is looked up again."""
        self.turn += 1
        self._known = {path: one for path, one in self._known.items() if self.documents.find(path) is one.document}

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
        return self.file(document).blocks if document is not None else self._declarations(path).blocks

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
