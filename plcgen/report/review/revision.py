"""The other side of a review: a folder, a spec, or a revision in git, as files on disk for the time of a ``with``."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from plcgen.base.files.files import YAML_SUFFIXES
from plcgen.base.files.options import usage
from plcgen.report.revision import fetched, top_of


@dataclass(frozen=True, slots=True)
class BaseFiles:
    """What there is of the base: ``spec``, ``folder`` of generated sources, ``lock``; None where it has none.

    ``label`` names the base for people, ``root`` is what stands before its paths and means nothing to them.
    """

    label: str
    root: str
    spec: Path | None
    folder: Path | None
    lock: Path | None


@contextmanager
def base_files(against: str, spec: Path, folder: Path, lock: Path | None) -> Iterator[BaseFiles]:
    """Find or fetch the other side. Raises DiagnosticError (PG901) if there is none of that name."""
    path = Path(against)
    if path.suffix.lower() in YAML_SUFFIXES and path.is_file():
        yield BaseFiles(path.as_posix(), "", path, None, None)
    elif path.is_dir():
        yield _in_folder(path, spec, folder, lock)
    else:
        with tempfile.TemporaryDirectory(prefix="plcgen-base-") as room:
            asked = [path for path in (spec, folder, lock) if path is not None]
            top = top_of(f"--against {against}", spec, against)
            if lock is not None and not lock.resolve().is_relative_to(top):
                help_ = f"leave --lock out, and compare with it alone: plcgen lock --check --out {lock.as_posix()} SPEC"
                raise usage(f"--lock {lock.as_posix()}", f"it is outside the repository of the spec, {top}", help_)
            label, found = fetched("--against", against, asked, Path(room), top)
            there = _existing(found[0], found[1], found[2] if lock else Path(room, ".no-lock"))
            yield BaseFiles(label, f"{Path(room).as_posix()}/", *there)


def _in_folder(base: Path, spec: Path, folder: Path, lock: Path | None) -> BaseFiles:
    there = _existing(base / spec.name, base / folder.name, base / (lock.name if lock else ".no-lock"))
    sources = there[1] or (base if there[0] is None else None)
    return BaseFiles(base.as_posix(), "", there[0], sources, there[2])


def _existing(spec: Path, folder: Path, lock: Path) -> tuple[Path | None, Path | None, Path | None]:
    return (
        spec if spec.is_file() else None,
        folder if folder.is_dir() else None,
        lock if lock.is_file() else None,
    )
