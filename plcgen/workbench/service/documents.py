"""Documents while somebody edits them."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from plcgen.base.diagnostics import ArgumentError, DiagnosticError, Span
from plcgen.base.files.files import YAML_SUFFIXES
from plcgen.base.files.text import read_text
from plcgen.base.files.yaml import MAX_BYTES
from plcgen.workbench.service.positions import split_lines, without_surrogates

MAX_OPEN = 1_000
"""Documents that are open at once; an editor has fewer."""


@dataclass(frozen=True)
class Document:
    """One version of the text of a file; what is worked out about it lives as long as this version."""

    path: Path
    text: str

    @property
    def file(self) -> str:
        """Its path as spans name it."""
        return self.path.as_posix()

    @property
    def is_yaml(self) -> bool:
        """Whether it may be a spec."""
        return self.path.suffix.lower() in YAML_SUFFIXES

    @cached_property
    def lines(self) -> Sequence[str]:
        """Its lines without their ends."""
        return split_lines(self.text)

    def part(self, span: Span) -> str:
        """The text at a span of one line; empty for others."""
        if span.line != span.end_line or not 1 <= span.line <= len(self.lines):
            return ""
        return self.lines[span.line - 1][span.column - 1 : span.end_column - 1]


@dataclass(slots=True)
class Documents:
    """The documents of a folder that are open; what is not open is read from disk.

    ``generation`` grows whenever a file may have changed, ``seen`` when that may be one on disk.
    """

    folder: Path
    generation: int = 0
    seen: int = 0
    _open: dict[Path, Document] = field(default_factory=dict)

    def open(self, path: Path | str, text: str) -> Document:
        """Take the text of a document that was opened or changed.

        Raises:
            ArgumentError: the text is larger than a file may be, or too many documents are open.
        """
        document = Document(_absolute(path), without_surrogates(text))
        if len(text) > MAX_BYTES:
            raise ArgumentError(f"{document.path.name} is larger than {MAX_BYTES // 1024 // 1024} MiB")
        if document.path not in self._open and len(self._open) >= MAX_OPEN:
            raise ArgumentError(f"more than {MAX_OPEN} documents are open")
        self._open[document.path] = document
        self.generation += 1
        return document

    def close(self, path: Path | str) -> None:
        """Forget a document: from now on its file on disk counts."""
        self._open.pop(_absolute(path), None)
        self.generation += 1

    def changed(self) -> None:
        """Files on disk may be others than before."""
        self.generation += 1
        self.seen += 1

    def find(self, path: Path | str) -> Document | None:
        """The open document of a path."""
        return self._open.get(_absolute(path))

    def __iter__(self) -> Iterator[Document]:
        return iter(tuple(self._open.values()))

    def read(self, path: Path, file: str) -> str:
        """Text of a file: what is open, else what is on disk. Raises DiagnosticError."""
        document = self.find(path)
        return document.text if document is not None else read_text(path, file)

    def get(self, path: Path | str) -> Document | None:
        """The open document of a path, or one of the file on disk, which stays closed; None if it cannot be read."""
        place = _absolute(path)
        try:
            return self.find(place) or Document(place, read_text(place))
        except DiagnosticError:
            return None

    def writable(self, path: Path | str) -> bool:
        """Whether edits may be made for a file: it is in the folder, also behind links."""
        return Path(path).resolve().is_relative_to(self.folder.resolve())


def _absolute(path: Path | str) -> Path:
    """A path as documents are kept by: from the root, without ``..``, links not followed."""
    return Path(os.path.normpath(Path(path).absolute()))
