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
from collections.abc import Collection, Iterable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path, PurePosixPath
from typing import Self

from pydantic import TypeAdapter, ValidationError

from plcgen.diagnostics import Diagnostic, DiagnosticError, Severity, Span
from plcgen.documents.environment import RenderedFile
from plcgen.documents.folder_lock import exclusive
from plcgen.documents.manifest import digest
from plcgen.input.files import read_bounded
from plcgen.input.hashes import has_digest, same_text
from plcgen.project.ownership import is_owned, owning
from plcgen.sources.generated import ATTRIBUTES, JOURNAL, MANIFEST, known_files, project_of

STAGE = ".plcgen-stage-"
_REMEDIES = {
    errno.ENOSPC: "free some space; nothing was changed",
    errno.EEXIST: "a file has the name of the folder: choose another one",
    errno.ENOTDIR: "a file has the name of a folder above it: choose another one",
}
_MAX_JOURNAL = 256 * 1024 * 1024
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
        DiagnosticError: PG501/PG502/PG506 if something of the user is in the way, PG503 if the folder cannot be
            written; the old state is then untouched.
    """
    return _write(files, folder, force=force, whole=True, owned=owned)


def add_files(files: Iterable[RenderedFile], folder: Path, *, force: bool = False) -> WrittenFolder:
    """Put files into a folder beside what is there, all or none.

    Raises:
        DiagnosticError: PG501 if a file exists (unless ``force``), PG503/PG506 as :func:`write_folder`.
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
            with _Stage(folder) as stage:
                unchanged = _staged(files, stage, known, force=force, owned=owned)
                removed, kept = _obsolete({*stage.moves, *unchanged}, folder, known or {})
                stage.commit(removed)
    except OSError as problem:
        raise DiagnosticError([_cannot_write(problem, folder)]) from problem
    return WrittenFolder(tuple(stage.moves), tuple(unchanged), tuple(removed), tuple(kept), recovered=recovered)


class _Stage:
    """New content beside the old: a folder made when the first file comes, gone at the end whatever happens."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.path: Path | None = None
        self.moves: dict[str, str] = {}
        """Hash of each staged file by its path, in the order of their numbers in the stage."""
        self.before: dict[str, str] = {}
        """Hash of each file that will be replaced or removed."""
        self._fresh = not folder.exists()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        committed = (self.folder / JOURNAL).exists()  # then the next run needs the stage
        if self.path is not None and not committed:
            shutil.rmtree(self.path, ignore_errors=True)
            if kind is not None and self._fresh:
                shutil.rmtree(self.folder, ignore_errors=True)

    def _made(self) -> Path:
        if self.path is None:
            self.folder.mkdir(parents=True, exist_ok=True)
            self.path = Path(tempfile.mkdtemp(prefix=STAGE, dir=self.folder))
        return self.path

    def add(self, file: RenderedFile, old: bytes | None) -> None:
        """Stage a file, which will replace ``old``."""
        (self._made() / str(len(self.moves))).write_bytes(file.data)
        self.moves[file.path] = digest(file.data)
        if old is not None:
            self.before[file.path] = digest(old)

    def commit(self, removed: Mapping[str, str]) -> None:
        """Write the journal, the point of no return, then move every file into place; ``removed``: path -> hash."""
        if not self.moves and not removed:
            return
        stage, journal = self._made(), self.folder / JOURNAL
        bounds = _Bounds(self.folder)
        for parent in {bounds.inside(path).parent for path in self.moves}:
            parent.mkdir(parents=True, exist_ok=True)
        plan = _Plan(stage.name, self.moves, list(removed), self.before | dict(removed))
        draft = stage / "journal"
        with draft.open("wb") as out:
            out.write(json.dumps(asdict(plan)).encode())
            out.flush()
            os.fsync(out.fileno())
        draft.replace(journal)
        try:
            plan.finish(self.folder)
            journal.unlink()
        except OSError as problem:
            why = f"interrupted half-way: {problem.strerror or problem}"
            place = Span(str(problem.filename or self.folder))
            help_ = "remove the cause and run plcgen generate again: it completes this run"
            raise DiagnosticError([Diagnostic("PG503", why, place, help=help_)]) from problem


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
            diff += _diff(file, old)
        obsolete, _ = _obsolete(wanted, folder, _known(folder))
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
    if os.path.lexists(journal):
        plan = _Plan.read(journal)
        if plan is not None:
            plan.finish(folder, recovering=True)
        journal.unlink()
        done = True
    for stale in folder.glob(f"{STAGE}*"):
        shutil.rmtree(stale, ignore_errors=True)
        done = True
    return done


@dataclass(frozen=True, slots=True)
class _Plan:
    """What a journal says; whoever can write into the folder can have written it, so recovering trusts no line of it.

    ``moves`` and ``before`` are hashes by path: of the staged files in the order of their numbers, and of what they
    replace or what is removed.
    """

    stage: str
    moves: dict[str, str]
    removals: list[str]
    before: dict[str, str]

    @classmethod
    def read(cls, journal: Path) -> Self | None:
        """The plan of a journal; None if plcgen did not write it."""
        try:
            plan = TypeAdapter(cls).validate_json(read_bounded(journal, _MAX_JOURNAL), strict=True)
        except (OSError, ValidationError):
            return None
        stage = journal.parent / plan.stage
        odd = stage.parent != journal.parent or not plan.stage.startswith(STAGE) or stage.is_symlink()
        paths = (path for path in (*plan.moves, *plan.removals) if path != ATTRIBUTES)
        hidden = (part for path in paths for part in path.split("/") if part.startswith("."))
        return None if odd or any(hidden) else plan

    def finish(self, folder: Path, *, recovering: bool = False) -> None:
        """Move staged files into place and remove what is left over.

        When recovering, only a file that still is what the interrupted run found is replaced or removed, and only by
        a staged file with the bytes that were staged.
        """
        bounds = _Bounds(folder)
        for number, (path, expected) in enumerate(self.moves.items()):
            source, target = folder / self.stage / str(number), bounds.inside(path)
            if not recovering or (_hash(source) == expected and self._untouched(path, target)):
                target.parent.mkdir(parents=True, exist_ok=True)
                source.replace(target)
        for path in self.removals:
            target = bounds.inside(path)
            if recovering and not self._untouched(path, target):
                continue
            target.unlink(missing_ok=True)
            if target.parent != folder and target.parent.is_dir() and not any(target.parent.iterdir()):
                target.parent.rmdir()

    def _untouched(self, path: str, target: Path) -> bool:
        return _hash(target) == self.before.get(path) and (path in self.before or not os.path.lexists(target))


def _hash(path: Path) -> str | None:
    return digest(path.read_bytes()) if path.is_file() and not path.is_symlink() else None


class _Bounds:
    """Where paths lie in a folder; nothing written leaves it, not even through a symbolic link.

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
        if pure.is_absolute() or ".." in pure.parts or "\\" in path or ":" in path or not pure.parts:
            raise DiagnosticError([_escapes(self.folder, path)])
        if pure.parent not in self._holds:
            self._holds[pure.parent] = self._held(self.folder / pure.parent)
        target = self.folder / path
        if not self._holds[pure.parent] or target.is_symlink():
            raise DiagnosticError([_escapes(self.folder, path)])
        return target

    def _held(self, parent: Path) -> bool:
        try:
            return parent.resolve().is_relative_to(self.folder.resolve())
        except RuntimeError as problem:
            raise OSError(errno.ELOOP, os.strerror(errno.ELOOP), str(self.folder)) from problem


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


def _staged(
    files: Iterable[RenderedFile],
    stage: _Stage,
    known: dict[str, str] | None,
    *,
    force: bool,
    owned: Collection[str],
) -> list[str]:
    """Stage what differs from the folder and return the rest; every conflict with the user's files is told at once."""
    problems: list[Diagnostic] = []
    unchanged: list[str] = []
    bounds = _Bounds(stage.folder)
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
    bounds = _Bounds(folder)
    for path, expected in known.items():
        if path in wanted:
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


def _diff(file: RenderedFile, old: bytes | None) -> list[str]:
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
