"""What lies in a delivered folder, against its manifest: complete, unchanged, nothing else."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

from plcgen.diagnostics import Diagnostic, Span
from plcgen.input.files import read_bounded
from plcgen.input.hashes import has_digest
from plcgen.project.nouns import Project
from plcgen.project.ownership import is_owned
from plcgen.sources.generated import JOURNAL, MANIFEST, MAX_MANIFEST, known_files

MOST_FILES = 200_000
"""Files that are listed in a folder."""


def listed_files(folder: Path) -> tuple[dict[str, str], list[Diagnostic]]:
    """Hash of every file by its path, and what is wrong with the manifest itself."""
    path = folder / MANIFEST
    try:
        return known_files(read_bounded(path, MAX_MANIFEST)), []
    except OSError as problem:
        why = problem.strerror or str(problem)
        return {}, [Diagnostic("PG507", f"no manifest: {why}", Span(str(path)), help="run plcgen generate")]
    except ValueError as problem:
        return {}, [Diagnostic("PG611", str(problem), Span(str(path)), help="run plcgen generate")]


def owned_files(project: Project, folder: Path, known: Mapping[str, str]) -> list[str]:
    """Files that the spec calls the user's own and that differ from what was generated."""
    names = project.loaded.spec.plc.user_owned
    owned = (name for name in found_files(folder) if is_owned(name, names))
    return [name for name in owned if not _as_generated(folder / name, known.get(name, ""))]


def inventory(project: Project, folder: Path, known: Mapping[str, str]) -> Iterator[Diagnostic]:
    """Every file that is missing, changed or unknown; those of the user's own are not looked at."""
    if (folder / JOURNAL).exists():
        message = "a generation was interrupted here: some files are old, some are new"
        yield Diagnostic("PG602", message, Span(str(folder)), help="run plcgen generate once more")
    owned = project.loaded.spec.plc.user_owned
    root = folder.resolve()
    for name, expected in known.items():
        path = folder / name
        if not path.resolve().is_relative_to(root):
            message = f'the manifest names "{name}" outside the folder'
            yield Diagnostic("PG611", message, Span(str(folder / MANIFEST)))
        elif not path.is_file():
            yield Diagnostic("PG601", "generated file is missing", Span(str(path)), help="run plcgen generate")
        elif not is_owned(name, owned) and not _as_generated(path, expected):
            help_ = f"generate again, or say that it is yours: plc: {{user_owned: [{path.stem}]}}"
            yield Diagnostic("PG602", "file was changed after it was generated", Span(str(path)), help=help_)
    for name in found_files(folder):
        if known and name not in known and not is_owned(name, owned):
            help_ = f"move it away, or say that it is yours: plc: {{user_owned: [{name}]}}"
            yield Diagnostic("PG613", "plcgen did not make this file", Span(str(folder / name)), help=help_)


def found_files(folder: Path) -> list[str]:
    """Files below a folder, by path with forward slashes; the manifest and what is hidden are left out."""
    found = []
    for path in folder.rglob("*"):
        name = path.relative_to(folder)
        if name.as_posix() != MANIFEST and not any(part.startswith(".") for part in name.parts) and not path.is_dir():
            found.append(name.as_posix())
        if len(found) >= MOST_FILES:
            break
    return sorted(found)


def _as_generated(path: Path, expected: str) -> bool:
    return path.is_file() and has_digest(path.read_bytes(), expected)
