"""Writing an output folder so that it is either the old one or the new one, and comparing it.

A file that plcgen did not write, or that was changed since, is never touched without ``force``; how the rest takes
its place is a matter of :mod:`plcgen.build.staging`.
"""

from __future__ import annotations

import difflib
import errno
import os
from collections.abc import Collection, Iterable
from dataclasses import dataclass
from pathlib import Path

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Severity, Span
from plcgen.base.files.hashes import has_digest, same_text
from plcgen.build.bounds import Bounds, is_hidden
from plcgen.build.environment import RenderedFile
from plcgen.build.folder_lock import exclusive
from plcgen.build.manifest import digest
from plcgen.build.staging import Stage, recover
from plcgen.project.ownership import is_owned, owning
from plcgen.s7.read.generated import JOURNAL, MANIFEST, known_files, project_of

_REMEDIES = {
    errno.ENOSPC: "free some space; nothing was changed",
    errno.EEXIST: "a file has the name of the folder: choose another one",
    errno.ENOTDIR: "a file has the name of a folder above it: choose another one",
}
MAX_DIFF = 400_000
"""Bytes of a file, old and new, up to which its lines are compared."""


@dataclass(frozen=True, slots=True)
class WrittenFolder:
    """Relative paths by what happened to them.

    ``kept`` are files of an earlier generation that are no longer generated but were changed by hand;
    ``recovered`` says that an earlier run had been interrupted.
    """

    written: tuple[str, ...]
    unchanged: tuple[str, ...]
    removed: tuple[str, ...]
    kept: tuple[str, ...]
    recovered: bool = False


def write_folder(
    files: Iterable[RenderedFile], folder: Path, *, force: bool = False, owned: Collection[str] = ()
) -> WrittenFolder:
    """Bring a folder to exactly these files; each may be made when it is asked for, none is kept in memory.

    ``owned`` names files that stay as the user left them, whatever ``force`` says.

    Raises:
        DiagnosticError: PG501/PG502/PG506/PG509 if something of the user is in the way, PG503 if the folder cannot be
            written; the old state is then untouched.
    """
    return _write(files, folder, force=force, whole=True, owned=owned)


def add_files(files: Iterable[RenderedFile], folder: Path, *, force: bool = False) -> WrittenFolder:
    """Put files into a folder beside what is there, all or none.

    Raises:
        DiagnosticError: PG501 if a file exists (unless ``force``), PG503/PG506/PG509 as
            :func:`write_folder`.
    """
    return _write(files, folder, force=force, whole=False)


def _write(
    files: Iterable[RenderedFile], folder: Path, *, force: bool, whole: bool, owned: Collection[str] = ()
) -> WrittenFolder:
    """``whole``: the folder belongs to plcgen, so its manifest tells what may be replaced and what is left over."""
    try:
        with exclusive(folder):
            recovered = recover(folder)
            known = _known(folder) if whole else None
            with Stage(folder) as stage:
                unchanged = _staged(files, stage, known, force=force, owned=owned)
                removed, kept = _obsolete({*stage.moves, *unchanged}, folder, known or {})
                stage.commit(removed)
    except OSError as problem:
        raise DiagnosticError([_cannot_write(problem, folder)]) from problem
    return WrittenFolder(tuple(stage.moves), tuple(unchanged), tuple(removed), tuple(kept), recovered=recovered)


def compare_folder(
    files: Iterable[RenderedFile], folder: Path, owned: Collection[str] = ()
) -> tuple[str, list[Diagnostic]]:
    """Unified diff from the folder to what would be generated, and one PG504 per file that differs, if not owned."""
    found: list[Diagnostic] = []
    diff: list[str] = []
    try:
        if (folder / JOURNAL).exists():
            found.append(_stale(folder / JOURNAL, "an interrupted generation has to be completed"))
        wanted = set()
        for file in files:
            wanted.add(file.path)
            path = folder / file.path
            old = path.read_bytes() if path.is_file() else None
            if old is not None and (same_text(old, file.data) or is_owned(file.path, owned)):
                continue
            found.append(_stale(path, "file is missing" if old is None else "file is out of date"))
            diff += file_diff(file, old)
        obsolete, _ = _obsolete(wanted, folder, _known(folder))
        found += [_stale(folder / name, "file is no longer generated") for name in obsolete]
    except OSError as problem:
        found.append(Diagnostic("PG503", f"cannot read the folder: {problem.strerror or problem}", Span(str(folder))))
    return "".join(diff), found


def _known(folder: Path) -> dict[str, str]:
    path = folder / MANIFEST
    if not path.is_file():
        return {}
    try:
        return known_files(path.read_bytes())
    except ValueError:
        return {}


def _staged(
    files: Iterable[RenderedFile],
    stage: Stage,
    known: dict[str, str] | None,
    *,
    force: bool,
    owned: Collection[str],
) -> list[str]:
    """Stage what differs from the folder and return the rest; every conflict with the user's files is told at once."""
    problems: list[Diagnostic] = []
    unchanged: list[str] = []
    bounds = Bounds(stage.folder)
    for file in files:
        try:
            target = bounds.inside(file.path)
        except DiagnosticError as problem:
            problems.extend(problem.diagnostics)
            continue
        blocked = _blocking_parent(stage.folder, target)
        exists = blocked is None and os.path.lexists(target)
        old = target.read_bytes() if exists and target.is_file() else None
        changed = old is not None and known is not None and not has_digest(old, known.get(file.path, ""))
        same = old is not None and same_text(old, file.data)
        if exists and (same or (changed and is_owned(file.path, owned))):
            unchanged.append(file.path)
            continue
        conflict = _conflict(target, file, old, known) if exists else blocked
        if conflict is not None and (not force or old is None):
            problems.append(conflict)
        elif not problems:
            stage.add(file, old)
    if problems:
        raise DiagnosticError(problems)
    return unchanged


def _blocking_parent(folder: Path, target: Path) -> Diagnostic | None:
    """A file that stands where a folder of the output is needed."""
    parent = target.parent
    while parent != folder and parent.is_relative_to(folder):
        if os.path.lexists(parent) and not parent.is_dir():
            return Diagnostic("PG501", "a file has the name of a folder to be made", Span(str(parent)), help=_MOVE)
        parent = parent.parent
    return None


def _conflict(target: Path, file: RenderedFile, old: bytes | None, known: dict[str, str] | None) -> Diagnostic | None:
    place, path = Span(str(target)), file.path
    if old is None:
        return Diagnostic("PG501", "a folder has the name of a file to be generated", place, help=_MOVE)
    if known is None:
        return Diagnostic("PG501", "the file exists", place, help=_FORCE)
    if path == MANIFEST:
        other = project_of(old) if known else None
        if known and other in {None, project_of(file.data)}:
            return None
        what = "a manifest.json of something else" if other is None else f'the files of another project, "{other}"'
        return Diagnostic("PG501", f"the folder has {what}", place, help=_FORCE)
    if path not in known:
        return Diagnostic("PG501", "the file exists and was not generated by plcgen", place, help=_FORCE)
    if not has_digest(old, known[path]):
        help_ = f"{owning(path)}, or overwrite it with --force: your change is lost then"
        return Diagnostic("PG502", "the file was changed after it was generated", place, help=help_)
    return None


_MOVE = "move it away, or choose another --out"
_FORCE = "keep your copy elsewhere, choose another --out, or overwrite with --force"


def _obsolete(wanted: set[str], folder: Path, known: dict[str, str]) -> tuple[dict[str, str], list[str]]:
    """Files of the last generation that are no longer generated: unchanged ones (path -> hash), and edited ones."""
    removed: dict[str, str] = {}
    kept: list[str] = []
    bounds = Bounds(folder)
    for path, expected in known.items():
        if path in wanted or is_hidden(path):
            continue
        try:
            target = bounds.inside(path)
        except DiagnosticError:
            continue
        if target.is_file():
            data = target.read_bytes()
            if has_digest(data, expected):
                removed[path] = digest(data)
            else:
                kept.append(path)
    return removed, kept


def _cannot_write(problem: OSError, folder: Path) -> Diagnostic:
    why = problem.strerror or str(problem)
    help_ = _REMEDIES.get(problem.errno or 0, "check the folder's permissions")
    return Diagnostic("PG503", f"cannot write the output: {why}", Span(str(problem.filename or folder)), help=help_)


def _stale(path: Path, message: str) -> Diagnostic:
    help_ = "run plcgen generate with the same --out, without --check"
    return Diagnostic("PG504", message, Span(str(path)), Severity.ERROR, help=help_)


def file_diff(file: RenderedFile, old: bytes | None) -> list[str]:
    """Unified diff of one file; of a very long one and of the manifest only the header."""
    if file.path == MANIFEST or len(file.data) + len(old or b"") > MAX_DIFF:
        return [f"--- a/{file.path}\n+++ b/{file.path}\n(differs)\n"]
    if b"\0" in file.data:
        return [f"--- a/{file.path}\n+++ b/{file.path}\n(no text: differs)\n"]
    try:
        before = [] if old is None else old.decode("utf-8-sig").splitlines(keepends=True)
        after = file.data.decode("utf-8-sig").splitlines(keepends=True)
    except UnicodeDecodeError:
        before = [] if old is None else old.decode("cp1252", "replace").splitlines(keepends=True)
        after = file.data.decode("cp1252", "replace").splitlines(keepends=True)
    lines = list(difflib.unified_diff(before, after, f"a/{file.path}", f"b/{file.path}"))
    if not lines:
        return [f"--- a/{file.path}\n+++ b/{file.path}\n(byte order mark, encoding or line ends differ)\n"]
    return [line if line.endswith("\n") else f"{line}\n\\ No newline at end of file\n" for line in lines]
