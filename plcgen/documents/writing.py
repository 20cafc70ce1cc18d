"""Writing an output folder so that it is either the old one or the new one, and comparing it.

New content is staged beside the old; one atomic rename of a journal is the point of no return; whatever is
interrupted before it is discarded, after it completed by the next run. A file that plcgen did not write, or that
was changed since, is never touched without ``force``.
"""

from __future__ import annotations

import difflib
import errno
import json
import os
import shutil
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from plcgen.diagnostics import Diagnostic, DiagnosticError, Severity, Span
from plcgen.documents.environment import RenderedFile
from plcgen.documents.folder import MANIFEST, known_files
from plcgen.documents.folder_lock import exclusive
from plcgen.documents.manifest import digest

JOURNAL = ".plcgen-journal.json"
STAGE = ".plcgen-stage-"
MAX_DIFF = 400_000
"""Bytes of a file, old and new, up to which its lines are compared."""

Progress = Callable[[str, int, int], None]


@dataclass(frozen=True, slots=True)
class Written:
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
    files: Sequence[RenderedFile], folder: Path, *, force: bool = False, progress: Progress | None = None
) -> Written:
    """Bring a folder to exactly these files.

    Raises:
        DiagnosticError: PG501/PG502/PG506 if something of the user is in the way, PG503 if the folder cannot be
            written; the old state is then untouched.
    """
    try:
        with exclusive(folder):
            recovered = recover(folder)
            known = _known(folder)
            changed, unchanged = _plan(files, folder, known, force=force)
            removed, kept = _obsolete(files, folder, known)
            if changed or removed:
                _commit(changed, removed, folder, progress)
    except (OSError, RuntimeError) as problem:  # RuntimeError: a loop of symbolic links
        raise DiagnosticError([_cannot_write(problem, folder)]) from problem
    return Written(
        tuple(file.path for file in changed), tuple(unchanged), tuple(removed), tuple(kept), recovered=recovered
    )


def add_files(files: Sequence[RenderedFile], folder: Path, *, force: bool = False) -> Written:
    """Put files into a folder beside what is there, all or none.

    Raises:
        DiagnosticError: PG501 if a file exists (unless ``force``), PG503/PG506 as :func:`write_folder`.
    """
    try:
        with exclusive(folder):
            recovered = recover(folder)
            changed, unchanged = _plan(files, folder, None, force=force)
            if changed:
                _commit(changed, [], folder, None)
    except (OSError, RuntimeError) as problem:
        raise DiagnosticError([_cannot_write(problem, folder)]) from problem
    return Written(tuple(file.path for file in changed), tuple(unchanged), (), (), recovered=recovered)


def compare_folder(files: Sequence[RenderedFile], folder: Path) -> tuple[str, list[Diagnostic]]:
    """Unified diff from the folder to what would be generated, and one PG504 per file that differs."""
    found: list[Diagnostic] = []
    diff: list[str] = []
    try:
        if (folder / JOURNAL).exists():
            found.append(_stale(folder / JOURNAL, "an interrupted generation has to be completed"))
        for file in files:
            path = folder / file.path
            old = path.read_bytes() if path.is_file() else None
            if old == file.data:
                continue
            found.append(_stale(path, "file is missing" if old is None else "file is out of date"))
            diff += _diff(file, old)
        obsolete, _ = _obsolete(files, folder, _known(folder))
        found += [_stale(folder / name, "file is no longer generated") for name in obsolete]
    except OSError as problem:
        found.append(Diagnostic("PG503", f"cannot read the folder: {problem.strerror or problem}", Span(str(folder))))
    return "".join(diff), found


def recover(folder: Path) -> bool:
    """Complete an interrupted generation that passed its point of no return, discard one that did not.

    Returns:
        Whether something was completed or discarded.
    """
    if not folder.is_dir():
        return False
    journal = folder / JOURNAL
    done = False
    if journal.is_file():
        try:
            plan = json.loads(journal.read_bytes())
            stage = folder / str(plan["stage"])
            moves = {str(path): str(value) for path, value in plan["moves"].items()}
            removals = [str(path) for path in plan["removals"]]
        except (ValueError, KeyError, TypeError, AttributeError):
            journal.unlink()
        else:
            if stage.parent == folder and stage.name.startswith(STAGE):
                _finish(folder, stage, moves, removals)
            journal.unlink()
        done = True
    for stale in folder.glob(f"{STAGE}*"):
        shutil.rmtree(stale, ignore_errors=True)
        done = True
    return done


def _finish(
    folder: Path, stage: Path, moves: dict[str, str], removals: Sequence[str], *, recovering: bool = True
) -> None:
    """Move staged files into place; when recovering, a staged file with other bytes than the journal's is left out."""
    for number, (path, expected) in enumerate(moves.items()):
        source = stage / str(number)
        if not recovering or (source.is_file() and digest(source.read_bytes()) == expected):
            target = _inside(folder, path)
            target.parent.mkdir(parents=True, exist_ok=True)
            source.replace(target)
    for path in removals:
        target = _inside(folder, path)
        target.unlink(missing_ok=True)
        if target.parent != folder and target.parent.is_dir() and not any(target.parent.iterdir()):
            target.parent.rmdir()


def _inside(folder: Path, path: str) -> Path:
    """The path inside the folder; nothing written leaves it, not even through a symbolic link."""
    pure = PurePosixPath(path)
    target = folder / path
    if pure.is_absolute() or ".." in pure.parts or "\\" in path or ":" in path or not pure.parts:
        raise DiagnosticError([_escapes(folder, path)])
    real = folder.resolve()
    if target.is_symlink() or not target.parent.resolve().is_relative_to(real):
        raise DiagnosticError([_escapes(folder, path)])
    return target


def _escapes(folder: Path, path: str) -> Diagnostic:
    return Diagnostic(
        "PG506",
        f'"{path}" would be written outside the output folder',
        Span(str(folder)),
        help="rename the block",
    )


def _known(folder: Path) -> dict[str, str]:
    path = folder / MANIFEST
    if not path.is_file():
        return {}
    try:
        return known_files(path.read_bytes())
    except ValueError:
        return {}


def _plan(
    files: Sequence[RenderedFile], folder: Path, known: dict[str, str] | None, *, force: bool
) -> tuple[list[RenderedFile], list[str]]:
    """Split files into changed and unchanged; every conflict with the user's files is reported at once."""
    problems: list[Diagnostic] = []
    changed: list[RenderedFile] = []
    unchanged: list[str] = []
    for file in files:
        try:
            target = _inside(folder, file.path)
        except DiagnosticError as problem:
            problems.extend(problem.diagnostics)
            continue
        blocked = _blocking_parent(folder, target)
        if blocked is not None:
            problems.append(blocked)
            continue
        if not os.path.lexists(target):
            changed.append(file)
            continue
        old = target.read_bytes() if target.is_file() else None
        if old == file.data:
            unchanged.append(file.path)
            continue
        conflict = _conflict(target, file.path, old, known)
        if conflict is not None and (not force or old is None):
            problems.append(conflict)
        changed.append(file)
    if problems:
        raise DiagnosticError(problems)
    return changed, unchanged


def _blocking_parent(folder: Path, target: Path) -> Diagnostic | None:
    """A file that stands where a folder of the output is needed."""
    parent = target.parent
    while parent != folder and parent.is_relative_to(folder):
        if os.path.lexists(parent) and not parent.is_dir():
            return Diagnostic("PG501", "a file has the name of a folder to be made", Span(str(parent)), help=_MOVE)
        parent = parent.parent
    return None


def _conflict(target: Path, path: str, old: bytes | None, known: dict[str, str] | None) -> Diagnostic | None:
    place = Span(str(target))
    if old is None:
        return Diagnostic("PG501", "a folder has the name of a file to be generated", place, help=_MOVE)
    if known is None:
        return Diagnostic("PG501", "the file exists", place, help=_FORCE)
    if path == MANIFEST:
        if known:
            return None
        return Diagnostic("PG501", "the folder has a manifest.json of something else", place, help=_FORCE)
    if path not in known:
        return Diagnostic("PG501", "the file exists and was not generated by plcgen", place, help=_FORCE)
    if digest(old) != known[path]:
        return Diagnostic("PG502", "the file was changed after it was generated", place, help=_FORCE)
    return None


_MOVE = "move it away, or choose another --out"
_FORCE = "keep your copy elsewhere, choose another --out, or overwrite with --force"


def _obsolete(files: Sequence[RenderedFile], folder: Path, known: dict[str, str]) -> tuple[list[str], list[str]]:
    """Files of the last generation that are no longer generated: unchanged ones, and those changed by hand."""
    wanted = {file.path for file in files}
    removed: list[str] = []
    kept: list[str] = []
    for path, expected in known.items():
        if path in wanted:
            continue
        try:
            target = _inside(folder, path)
        except DiagnosticError:
            continue
        if target.is_file():
            (removed if digest(target.read_bytes()) == expected else kept).append(path)
    return removed, kept


def _commit(changed: Sequence[RenderedFile], removed: Sequence[str], folder: Path, progress: Progress | None) -> None:
    fresh = not folder.exists()
    folder.mkdir(parents=True, exist_ok=True)
    stage = Path(tempfile.mkdtemp(prefix=STAGE, dir=folder))
    journal = folder / JOURNAL
    try:
        for number, file in enumerate(changed):
            (stage / str(number)).write_bytes(file.data)
            if progress is not None and number % 50 == 0:
                progress("write", number, len(changed))
        for parent in {_inside(folder, file.path).parent for file in changed}:
            parent.mkdir(parents=True, exist_ok=True)
        moves = {file.path: digest(file.data) for file in changed}
        draft = stage / "journal"
        with draft.open("wb") as out:
            out.write(json.dumps({"stage": stage.name, "moves": moves, "removals": list(removed)}).encode())
            out.flush()
            os.fsync(out.fileno())
        draft.replace(journal)
    except BaseException:
        shutil.rmtree(stage, ignore_errors=True)
        if fresh:
            shutil.rmtree(folder, ignore_errors=True)
        raise
    try:
        _finish(folder, stage, moves, removed, recovering=False)
        journal.unlink()
    except OSError as problem:
        why = f"interrupted half-way: {problem.strerror or problem}"
        place = Span(str(problem.filename or folder))
        raise DiagnosticError(
            [
                Diagnostic(
                    "PG503", why, place, help="remove the cause and run plcgen generate again: it completes this run"
                )
            ]
        ) from problem
    shutil.rmtree(stage, ignore_errors=True)


def _cannot_write(problem: OSError | RuntimeError, folder: Path) -> Diagnostic:
    if not isinstance(problem, OSError):
        return Diagnostic(
            "PG503", f"cannot write the output: {problem}", Span(str(folder)), help="choose another --out"
        )
    why = problem.strerror or str(problem)
    help_ = (
        "free some space; nothing was changed" if problem.errno == errno.ENOSPC else "check the folder's permissions"
    )
    return Diagnostic("PG503", f"cannot write the output: {why}", Span(str(problem.filename or folder)), help=help_)


def _stale(path: Path, message: str) -> Diagnostic:
    help_ = "run plcgen generate with the same --out, without --check"
    return Diagnostic("PG504", message, Span(str(path)), Severity.ERROR, help=help_)


def _diff(file: RenderedFile, old: bytes | None) -> list[str]:
    """Unified diff of one file; of a very long one and of the manifest only the header."""
    if file.path == MANIFEST or len(file.data) + len(old or b"") > MAX_DIFF:
        return [f"--- a/{file.path}\n+++ b/{file.path}\n(differs)\n"]
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
