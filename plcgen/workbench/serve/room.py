"""The folder that is served: specs are read and saved in it, and nothing else of the machine is touched."""

from __future__ import annotations

import hashlib
from pathlib import Path

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.base.files.files import YAML_SUFFIXES, below, refusal
from plcgen.base.files.text import read_text
from plcgen.base.files.yaml import MAX_BYTES

MAX_LISTED = 500
"""So many specs of a folder are offered."""


class Room:
    """Files of one folder by their names in it, with / between folders."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder.resolve()

    def find(self, name: str) -> Path:
        """Path of a YAML file, there or not.

        Raises:
            DiagnosticError: PG901 if it is none, or not in the folder, through a link either.
        """
        path = below(self.folder, name) if name else None
        if path is None:
            raise wrong(name, f'"{name}" {refusal(name, "the folder that is served")}')
        if path.suffix.lower() not in YAML_SUFFIXES:
            raise wrong(name, f'"{name}" is no spec: its name must end in .yaml or .yml')
        return path

    def shown(self, file: str) -> str:
        """A path as the page shows it: its name in the folder, if it is in it."""
        return file.removeprefix(f"{self.folder.as_posix()}/")

    def read(self, name: str) -> str:
        """Text of a spec. Raises DiagnosticError."""
        return read_text(self.find(name), name)

    def save(self, name: str, text: str, known: str) -> str:
        """Save a spec and return its hash; ``known`` is that of the file as the page has read it, "" for a new one.

        Raises:
            DiagnosticError: PG501 if another program has changed it meanwhile, or a new one exists; PG503 if it cannot
                be written.
        """
        path = self.find(name)
        data = text.encode()
        if len(data) > MAX_BYTES:
            raise wrong(name, f"larger than {MAX_BYTES // 1024 // 1024} MiB")
        there = digest(path.read_bytes()) if path.is_file() else ""
        if there != known:
            what = "another program has changed the file since it was opened" if known else "the file exists"
            help_ = "reload it, or save under another name"
            raise DiagnosticError([Diagnostic("PG501", what, Span(name), help=help_)])
        draft = path.with_name(f".plcgen-draft-{path.name}")
        try:
            draft.write_bytes(data)
            draft.replace(path)
        except OSError as problem:
            draft.unlink(missing_ok=True)
            message = f"cannot write the file: {problem.strerror or problem}"
            raise DiagnosticError([Diagnostic("PG503", message, Span(name))]) from problem
        return digest(data)


def digest(data: bytes) -> str:
    """SHA-256 of a file, by which a later change is noticed."""
    return hashlib.sha256(data).hexdigest()


def wrong(name: str, message: str, help_: str = "") -> DiagnosticError:
    """A request that cannot be answered."""
    return DiagnosticError([Diagnostic("PG901", message, Span(name), help=help_)])
