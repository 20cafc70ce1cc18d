"""New content beside the old, and how it takes its place: all of it or nothing, and nobody's edit is lost.

A stage is a folder in the output folder. One atomic rename of a journal is the point of no return; whatever is
interrupted before it is discarded, after it completed by the next run. A file that somebody changed since the decision
to replace it was made stops the change: everything goes back to what it was. What is tidied up is only what this run
made, name by name.
"""

from __future__ import annotations

import contextlib
import json
import os
import re
import tempfile
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from itertools import takewhile
from pathlib import Path
from typing import Self

from pydantic import TypeAdapter, ValidationError

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.base.files.files import read_bounded
from plcgen.base.interrupts import uninterrupted
from plcgen.base.replacing import digest_of, put_back, swap, take
from plcgen.build.bounds import Bounds, is_hidden
from plcgen.build.environment import RenderedFile
from plcgen.build.manifest import digest
from plcgen.s7.read.generated import JOURNAL

STAGE = ".plcgen-stage-"
_DRAFT = "journal"
_STAGED = re.compile(r"[0-9]{1,9}(\.old)?|journal")
"""Names in a stage."""
_MAX_JOURNAL = 256 * 1024 * 1024


class Stage:
    """New content beside the old: a folder made when the first file comes, gone at the end whatever happens."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.path: Path | None = None
        self.moves: dict[str, str] = {}
        """Hash of each staged file by its path, in the order of their numbers in the stage."""
        self.before: dict[str, str] = {}
        """Hash of each file that will be replaced or removed."""
        self._made: list[Path] = []
        """Folders that were not there, the outermost first."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        with uninterrupted():
            if self.path is not None and not (self.folder / JOURNAL).exists():  # else the next run needs the stage
                _discard(self.path)
            for folder in reversed(self._made) if kind is not None else ():
                with contextlib.suppress(OSError):  # somebody else has put something into it
                    folder.rmdir()

    def _open(self) -> Path:
        if self.path is None:
            with uninterrupted():
                self._make(self.folder)
                self.path = Path(tempfile.mkdtemp(prefix=STAGE, dir=self.folder))
        return self.path

    def _make(self, folder: Path) -> None:
        """Make a folder and those above it, and know which of them were not there."""
        for each in reversed([*takewhile(lambda each: not os.path.lexists(each), (folder, *folder.parents))]):
            with contextlib.suppress(FileExistsError):  # somebody else was faster
                each.mkdir()
                self._made.append(each)
        if not folder.is_dir():
            folder.mkdir()  # a file has its name: the error says so

    def add(self, file: RenderedFile, old: bytes | None) -> None:
        """Stage a file, which will replace ``old``."""
        (self._open() / str(len(self.moves))).write_bytes(file.data)
        self.moves[file.path] = digest(file.data)
        if old is not None:
            self.before[file.path] = digest(old)

    def commit(self, removed: Mapping[str, str]) -> None:
        """Write the journal, the point of no return, then move every file into place; ``removed``: path -> hash.

        Raises:
            DiagnosticError: PG509 if a file was changed since it was staged: nothing was written then; PG503 if
                the change was interrupted half-way.
        """
        if not self.moves and not removed:
            return
        stage = self._open()
        plan = FolderPlan(stage.name, self.moves, list(removed), self.before | dict(removed))
        with uninterrupted():
            edited = plan.edited(self.folder)
            if not edited:
                edited = self._moved(plan, stage)
        if edited:
            raise DiagnosticError([_edited(self.folder / path) for path in edited])

    def _moved(self, plan: FolderPlan, stage: Path) -> list[str]:
        """Move everything; the paths that somebody changed meanwhile, if nothing was moved for their sake."""
        bounds = Bounds(self.folder)
        for parent in {bounds.inside(path).parent for path in self.moves}:
            self._make(parent)
        draft, journal = stage / _DRAFT, self.folder / JOURNAL
        with draft.open("wb") as out:
            out.write(json.dumps(asdict(plan)).encode())
            out.flush()
            os.fsync(out.fileno())
        draft.replace(journal)
        try:
            edited = plan.finish(self.folder)
            journal.unlink()
        except OSError as problem:
            why = f"interrupted half-way: {problem.strerror or problem}"
            span = Span(str(problem.filename or self.folder))
            help_ = "remove the cause and run plcgen generate again: it completes this run"
            raise DiagnosticError([Diagnostic("PG503", why, span, help=help_)]) from problem
        return edited


def _edited(path: Path) -> Diagnostic:
    message = "the file was changed while plcgen was running: it is kept as it is now, and nothing was written"
    return Diagnostic("PG509", message, Span(str(path)), help="run plcgen again: it takes the file as it is now")


def recover(folder: Path) -> bool:
    """Complete an interrupted generation that passed its point of no return, discard one that did not.

    Returns:
        Whether something was completed or discarded.
    """
    if not folder.is_dir():
        return False
    journal = folder / JOURNAL
    done = False
    with uninterrupted():
        if os.path.lexists(journal):
            plan = FolderPlan.read(journal)
            if plan is not None:
                plan.complete(folder)
            journal.unlink()
            done = True
        for stale in folder.glob(f"{STAGE}*"):
            done |= _discard(stale)
    return done


def _discard(stage: Path) -> bool:
    """Remove a stage with the files that belong there; whether there was something. What else is in it stays."""
    if stage.is_symlink() or not stage.is_dir():
        return False
    done = False
    for path in [path for path in stage.iterdir() if _STAGED.fullmatch(path.name)]:
        with contextlib.suppress(OSError):
            path.unlink()
            done = True
    with contextlib.suppress(OSError):
        stage.rmdir()
        done = True
    return done


@dataclass(frozen=True, slots=True)
class _Step:
    """One file of a plan: ``source`` is staged (None: ``target`` is removed), ``aside`` where the old one goes.

    ``expected`` and ``known`` are hashes of the new and the old file, None where there is none.
    """

    path: str
    target: Path
    source: Path | None
    aside: Path
    expected: str | None
    known: str | None

    def do(self) -> bool:
        """Take the step; False if somebody else's file is in the way: it stays."""
        if self.source is not None:
            return swap(self.source, self.target, self.aside, self.known)
        return self.known is not None and take(self.target, self.aside, self.known)

    def undo(self) -> None:
        """Take it back; what somebody else has put to the place since then stays, too."""
        if self.source is not None and self.expected is not None:
            take(self.target, self.source, self.expected)
        if os.path.lexists(self.aside):
            if os.path.lexists(self.target) and digest_of(self.aside) == self.known:
                return
            put_back(self.aside, self.target)

    @property
    def untouched(self) -> bool:
        """Whether the target still is what it was, or still is not there."""
        if self.known is None:
            return not os.path.lexists(self.target)
        return digest_of(self.target) == self.known

    @property
    def edited(self) -> bool:
        """Whether somebody wrote into the old file, which he still had open, after it went aside."""
        return os.path.lexists(self.aside) and digest_of(self.aside) != self.known

    def complete(self) -> None:
        """Take the step of a run that ended half-way, if its old file still is what that run found."""
        ready = self.source is None or digest_of(self.source) == self.expected
        if self.edited:
            self.undo()
        elif ready and (self.untouched or (os.path.lexists(self.aside) and not os.path.lexists(self.target))):
            self.do()


@dataclass(frozen=True, slots=True)
class FolderPlan:
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
        return None if odd or any(map(is_hidden, (*plan.moves, *plan.removals))) else plan

    def _steps(self, folder: Path) -> Iterator[_Step]:
        bounds, stage = Bounds(folder), folder / self.stage
        for number, path in enumerate((*self.moves, *self.removals)):
            source = stage / str(number) if number < len(self.moves) else None
            known = self.before.get(path)
            yield _Step(path, bounds.inside(path), source, stage / f"{number}.old", self.moves.get(path), known)

    def edited(self, folder: Path) -> list[str]:
        """The files that are not any more what the plan was made for; one that is gone needs no care."""
        steps = self._steps(folder)
        return [step.path for step in steps if not step.untouched and os.path.lexists(step.target)]

    def finish(self, folder: Path) -> list[str]:
        """Move staged files into place and remove what is left over.

        If somebody changed one of the files meanwhile, nothing is done in the end; the paths of these.
        """
        done: list[_Step] = []
        edited: list[str] = []
        for step in self._steps(folder):
            if not step.do():
                edited.append(step.path)
                break
            done.append(step)
        edited += [step.path for step in done if step.edited]
        if edited:
            for step in reversed(done):
                step.undo()
        else:
            self._tidy(folder)
        return edited

    def complete(self, folder: Path) -> None:
        """Finish what another run began: a file that somebody changed since stays, everything else is done."""
        for step in self._steps(folder):
            step.target.parent.mkdir(parents=True, exist_ok=True)
            step.complete()
        self._tidy(folder)

    def _tidy(self, folder: Path) -> None:
        """Remove folders that have lost their last file."""
        for parent in {(folder / path).parent for path in self.removals} - {folder}:
            with contextlib.suppress(OSError):
                parent.rmdir()
