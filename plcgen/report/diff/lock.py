"""``lock``: write the lock of sources or a spec, and compare it with what they are now."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span, has_errors
from plcgen.base.files.hashes import same_text
from plcgen.base.paths import trap_in
from plcgen.base.replacing import digest_of, replace_file
from plcgen.report.diff.lockfile import lock_text, read_lock, reduced, unkept
from plcgen.report.diff.run import compare_snapshots, snapshot
from plcgen.s7.compare.model import Comparison
from plcgen.s7.compare.policy import load_policy

DEFAULT = "plcgen.lock.json"


@dataclass(frozen=True, slots=True)
class LockResult:
    """What writing a lock did: its path, how many blocks it holds, whether the file changed."""

    path: Path
    blocks: int
    changed: bool
    diagnostics: tuple[Diagnostic, ...]

    @property
    def ok(self) -> bool:
        """Whether no diagnostic is an error."""
        return not has_errors(self.diagnostics)


def write_lock(
    paths: Sequence[Path], path: Path, *, classic: bool = False, force: bool = False, keep_going: bool = False
) -> LockResult:
    """Write the lock of sources or one spec; without paths, of those that the existing lock names.

    Nothing is written if something cannot be read, or if the file is there and is no lock (PG501), unless
    ``force`` says so; with ``keep_going``, files with errors are left out.
    """
    try:
        chosen = list(paths) or _locked_sources(path)
        state = reduced(snapshot(chosen, classic=classic, keep_going=keep_going))
        help_ = "spell such a character as SCL does ($N, $200B), or leave this source out"
        lost = [
            Diagnostic("PG633", f"a lock cannot keep {what}", span or Span(str(path)), help=help_)
            for what, span in unkept(state)
        ]
        found = tuple(dict.fromkeys((*state.diagnostics, *lost)))
        if has_errors(found):
            return LockResult(path, 0, False, found)  # noqa: FBT003 - see the field's name
        known = digest_of(path.resolve())
        _check_target(path, force=force)
        text = lock_text(state, _names(chosen, path))
        data = text.encode()
        changed = not path.is_file() or not same_text(path.read_bytes(), data)
        if changed:
            replace_file(path, data, known)
    except DiagnosticError as problem:
        return LockResult(path, 0, False, problem.diagnostics)  # noqa: FBT003
    except FileExistsError:
        message = "the lock was changed while plcgen was running: it is kept as it is now"
        return LockResult(path, 0, False, (Diagnostic("PG509", message, Span(str(path))),))  # noqa: FBT003
    except OSError as problem:
        message = f"cannot write the lock: {problem.strerror or problem}"
        return LockResult(path, 0, False, (Diagnostic("PG503", message, Span(str(path))),))  # noqa: FBT003
    return LockResult(path, len(state.blocks), changed, found)


def check_lock(
    paths: Sequence[Path],
    path: Path,
    policy: Sequence[str] = (),
    *,
    classic: bool = False,
    keep_going: bool = False,
) -> Comparison:
    """Compare the lock with sources or a spec; without paths, with those that the lock names."""
    if not os.path.lexists(path):
        help_ = f"make it and commit it: plcgen lock FOLDER --out {path.as_posix()}; until then leave the check out"
        earlier = path.with_suffix(".yaml")
        if path.suffix == ".json" and earlier.is_file():
            help_ = f"{earlier.as_posix()} is one of an earlier version: replace it, "
            help_ += f"plcgen lock FOLDER --out {path.as_posix()}"
        missing = Diagnostic("PG110", "there is no layout lock yet", Span(path.as_posix()), help=help_)
        return Comparison(path.as_posix(), "", (), (missing,))
    try:
        levels = load_policy(policy)
        lock = read_lock(path)
        chosen = list(paths) or _inside(lock.sources, path)
        state = reduced(snapshot(chosen, classic=classic, keep_going=keep_going))
    except DiagnosticError as problem:
        return Comparison(path.as_posix(), "", (), problem.diagnostics)
    return compare_snapshots(lock.snapshot, state, levels, classic=classic)


def _is_earlier(problems: Sequence[Diagnostic]) -> bool:
    """Whether the file is a lock that an earlier version wrote."""
    return [d.code for d in problems] == ["PG633"] and "earlier version" in problems[0].help


def _locked_sources(path: Path) -> list[Path]:
    if not path.is_file():
        message = "nothing to lock: name files, a folder or a spec"
        help_ = "plcgen lock job_generated, or plcgen lock job.yaml"
        raise DiagnosticError([Diagnostic("PG632", message, Span(str(path)), help=help_)])
    return _inside(read_lock(path).sources, path)


def _inside(sources: Sequence[str], path: Path) -> list[Path]:
    """Sources that a lock names; only such below its own folder are read without being asked for."""
    problems = []
    for source in sources:
        if trap_in(source):
            message = f'the lock names "{source[:80]}", which is refused: {trap_in(source)}'
            problems.append(Diagnostic("PG633", message, Span(str(path)), help="name the sources on the command line"))
    if not sources:
        message = "the lock names no sources"
        problems.append(Diagnostic("PG633", message, Span(str(path)), help="name the sources on the command line"))
    if problems:
        raise DiagnosticError(problems)
    return [path.parent / source for source in sources]


def _names(sources: Sequence[Path], lock: Path) -> list[str]:
    """Sources as the lock names them; none if one is not below its folder: such a path says nothing elsewhere."""
    folder = lock.parent.resolve()
    found = [Path(os.path.abspath(source)) for source in sources]  # noqa: PTH100 - a link keeps its name
    if not all(source.is_relative_to(folder) for source in found):
        found = [source.resolve() for source in found]
    below = all(source.is_relative_to(folder) for source in found)
    return [source.relative_to(folder).as_posix() for source in found] if below else []


def _check_target(path: Path, *, force: bool) -> None:
    """Refuse to overwrite what is no lock."""
    if force or not os.path.lexists(path):
        return
    try:
        read_lock(path)
    except DiagnosticError as problem:
        if all(d.code == "PG634" for d in problem.diagnostics) or _is_earlier(problem.diagnostics):
            return
        message = "the file exists and is not a layout lock"
        help_ = "choose another --out, or overwrite it with --force"
        raise DiagnosticError([Diagnostic("PG501", message, Span(str(path)), help=help_)]) from problem
