"""Where files lie in an output folder: nothing written leaves it."""

from __future__ import annotations

import errno
import os
from pathlib import Path, PurePosixPath

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.base.paths import trap_in
from plcgen.s7.read.generated import ATTRIBUTES


def is_hidden(path: str) -> bool:
    """Whether a path is, or lies in, what only tools look at (``.git``); of these, one file is generated."""
    return path != ATTRIBUTES and any(part.startswith(".") for part in path.split("/"))


class Bounds:
    """Where paths lie in a folder; not even a symbolic link leads out of it.

    A folder below is followed once; between two looks at the disk, whoever asks again takes new bounds.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._holds: dict[PurePosixPath, bool] = {}

    def inside(self, path: str) -> Path:
        """The path inside the folder.

        Raises:
            DiagnosticError: PG506 if it leaves the folder.
        """
        pure = PurePosixPath(path)
        why = trap_in(path) or ("" if pure.parts else "it names no file")
        if why:
            raise DiagnosticError([self._refusal(path, why)])
        if pure.parent not in self._holds:
            self._holds[pure.parent] = self._held(self.folder / pure.parent)
        target = self.folder / path
        if not self._holds[pure.parent] or target.is_symlink():
            raise DiagnosticError([self._refusal(path, "a link leads out of the folder")])
        return target

    def _held(self, parent: Path) -> bool:
        try:
            return parent.resolve().is_relative_to(self.folder.resolve())
        except RuntimeError as problem:
            raise OSError(errno.ELOOP, os.strerror(errno.ELOOP), str(self.folder)) from problem

    def _refusal(self, path: str, why: str) -> Diagnostic:
        message = f'"{path}" would be written outside the output folder: {why}'
        return Diagnostic("PG506", message, Span(str(self.folder)), help="rename the block, or remove the link")
