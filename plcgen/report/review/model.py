"""What stands on a review page, before any format."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from plcgen.base.diagnostics import Diagnostic, has_errors
from plcgen.build.sheet import ReviewSheet
from plcgen.project.composing import from_disk
from plcgen.project.includes import Read
from plcgen.proof.checks import Check, Outcome, Verification
from plcgen.proof.ledger import Assumption, Grade
from plcgen.report.trace.model import Trace
from plcgen.s7.compare.model import Comparison
from plcgen.s7.tables.tables import BlockTable


@dataclass(frozen=True, slots=True)
class ReviewRequest:
    """What is reviewed, and how: ``against`` is a folder, a spec or a git revision, empty for none.

    ``faults`` is how much of the fault matrix runs, ``fault`` what goes wrong in the second run of every job;
    ``lock`` a layout lock (None: the one beside the spec, if there is one). ``read`` gives the text of the spec, and
    ``home`` is where a revision has the folder, if that lies elsewhere now.
    """

    spec: Path
    folder: Path
    against: str = ""
    faults: str = "quick"
    fault: str = ""
    lock: Path | None = None
    read: Read = from_disk
    home: Path | None = None


@dataclass(frozen=True, slots=True)
class ReviewedFile:
    """A file of the manifest: path in the folder, SHA-256, bytes, why nobody has seen it imported ("" if seen)."""

    path: str
    sha256: str
    bytes: int
    experimental: str


@dataclass(frozen=True, slots=True)
class LayoutPair:
    """A block before and after; None where it does not exist, or where there is nothing to compare with."""

    before: BlockTable | None
    after: BlockTable | None

    @property
    def changed(self) -> bool:
        """Whether both exist and are not alike."""
        return self.before is not None and self.after is not None and self.before != self.after


@dataclass(frozen=True, slots=True)
class RecordedRun:
    """A recorded run of one job, without a fault or with one."""

    job: str
    fault: str
    trace: Trace


@dataclass(frozen=True, slots=True)
class SourceLine:
    """A line of a generated source; ``member`` is the offset in its telegram, None if it declares none."""

    number: int
    text: str
    member: int | None


@dataclass(frozen=True, slots=True)
class Excerpt:
    """The lines that declare or use the members of a buffer; ``block`` is the buffer, ``file`` where they stand."""

    block: str
    file: str
    lines: tuple[SourceLine, ...]


@dataclass(frozen=True, slots=True)
class Review:
    """Everything of a page.

    ``spec_hash`` covers the files that the spec has ``included``; ``base`` names what was compared with, empty if
    nothing was; ``changes`` are comparisons, each with a title; ``lock`` is the comparison of the lock with the
    sources; ``missing`` are sentences about what is not there; ``planned`` is whether the spec could be planned;
    ``language`` is the first one of the project, without its region; ``made_now`` is whether the files are not those of
    the folder on disk, which nobody has looked at.
    """

    spec: str
    folder: str
    project: str
    target: str
    spec_hash: str
    included: tuple[str, ...]
    files_hash: str
    files: tuple[ReviewedFile, ...]
    verification: Verification
    sheet: ReviewSheet
    base: str
    changes: tuple[tuple[str, Comparison], ...]
    lock: Comparison | None
    layouts: tuple[LayoutPair, ...]
    runs: tuple[RecordedRun, ...]
    excerpts: tuple[Excerpt, ...]
    missing: tuple[str, ...]
    planned: bool = True
    language: str = "en"
    made_now: bool = False

    @property
    def problems(self) -> tuple[Diagnostic, ...]:
        """Every diagnostic once, the errors first: of the verification, the comparisons, the lock and the runs."""
        found = tuple(self.verification.told)
        for comparison in (*(comparison for _, comparison in self.changes), self.lock):
            found += comparison.diagnostics if comparison is not None else ()
        return tuple(sorted(dict.fromkeys(found), key=lambda d: -d.severity))

    @property
    def ok(self) -> bool:
        """Whether nothing is wrong: no check failed, no diagnostic is an error, the lock is as the sources are."""
        errors = has_errors(self.problems)
        return self.verification.ok and not errors and not (self.lock is not None and self.lock.changes)

    @property
    def not_run(self) -> tuple[Check, ...]:
        """Checks that exist and were not executed."""
        return tuple(check for check in self.verification.checks() if check.outcome is Outcome.NOT_RUN)

    @property
    def assumptions(self) -> tuple[Assumption, ...]:
        """What the result rests on, the worst known first."""
        order = list(Grade)
        return tuple(sorted(self.verification.ledger, key=lambda one: -order.index(one.grade)))

    @property
    def grades(self) -> tuple[tuple[str, int], ...]:
        """How many assumptions are known how well, the worst first."""
        return tuple(Counter(one.grade.value for one in self.assumptions).items())

    def count(self, outcome: Outcome) -> int:
        """How many checks had this outcome."""
        return sum(check.outcome is outcome for check in self.verification.checks())
