"""What a protocol contributes to verification: checks of the files, and suites of jobs to execute."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol, TypeVar

from plcgen.base.diagnostics import Span
from plcgen.project.nouns import Buffer, BufferField, PlannedJob
from plcgen.proof.checks import Check, CheckGroup
from plcgen.proof.conditions import Premise
from plcgen.proof.coverage import Step
from plcgen.proof.effort import Faults
from plcgen.proof.folder import Folder
from plcgen.proof.ledger import Assumption
from plcgen.proof.runner import Runner
from plcgen.proof.scenario import Failure, Scenario, Statistics
from plcgen.s7.cpu.cpu import Cpu
from plcgen.s7.cpu.program import Program

Progress = Callable[[str, int, int], None]
S = TypeVar("S", bound=Scenario)


@dataclass(frozen=True, slots=True)
class LaidOut:
    """A buffer whose offsets are calculated; ``prefix`` is where it lies in its DB, ``shown`` what a report names.

    ``room`` is how long the longest answer is, and ``note`` stands in front of the offsets.
    """

    buffer: Buffer[BufferField]
    shown: Callable[[BufferField], bool]
    prefix: str = ""
    room: int = 0
    note: str = ""


@dataclass(frozen=True, slots=True)
class CodeBlock:
    """A generated block with the jobs in it. ``key`` ends the id of its coverage, ``name`` is what messages call it.

    ``premises`` say what cannot happen in this project, ``opened`` which names they may follow. ``steps`` are all ways
    from state to state, None if nobody draws them; ``state`` names a state.
    """

    key: str
    name: str
    block: str
    jobs: tuple[PlannedJob, ...]
    span: Callable[[], Span]
    premises: tuple[Premise, ...] = ()
    opened: tuple[str, ...] = ()
    steps: frozenset[Step] | None = None
    state: Callable[[int], str] = str


class Bed(Protocol):
    """A CPU with the whole program; ``place`` is the source and line to look at if it fails."""

    @property
    def cpu(self) -> Cpu:
        """The CPU."""

    @property
    def place(self) -> tuple[str, int]:
        """File and line."""

    @property
    def scans(self) -> int:
        """Scans so far."""


@dataclass(frozen=True, slots=True)
class Reads:
    """What a part looks at: blocks, with all that these name, and ``plan``, values of the plan."""

    blocks: tuple[str, ...]
    plan: object


@dataclass(frozen=True, slots=True)
class Procedure:
    """Something that several jobs do to each other; ``run`` raises ScenarioError.

    ``reads`` is what it looks at, None for all of the project. What comes out must not depend on what ran before.
    """

    name: str
    bed: Callable[[], Bed]
    run: Callable[[Any], None]
    reads: Reads | None = None


@dataclass(frozen=True, slots=True)
class WorkPart:
    """What one worker does at a time: a job of a suite, or a procedure of its jobs; all by their numbers."""

    suite: int
    job: int | None = None
    procedure: int = 0


class Suite(Protocol[S]):
    """Jobs that share blocks or partners: they are run one by one, then all together."""

    @property
    def prefix(self) -> str:
        """In front of the key of a job in the ids of its checks."""

    @property
    def page(self) -> str:
        """The page of the documentation that describes the blocks."""

    @property
    def jobs(self) -> Sequence[PlannedJob]:
        """The jobs, in the order of the report."""

    def pins(self, job: Any) -> Mapping[str, str]:
        """Paths of execute, busy, done, error and status of a job in the whole program."""

    def shown_name(self, job: Any) -> str:
        """What a report calls a job: no two jobs of the project alike."""

    def blocks(self) -> Sequence[CodeBlock]:
        """The blocks whose coverage counts."""

    def runner(self, program: Program, job: Any, statistics: Statistics | None = None) -> Runner[S]:
        """The job on a CPU of its own. Raises ScenarioError or KeyError if its block cannot be called."""

    def reads(self, job: Any) -> Reads | None:
        """What the runs of a job look at; None for all of the project."""

    def first(self) -> S:
        """The first run of a job."""

    def nominal(self, runner: Runner[S]) -> S:
        """The run that the report shows."""

    def shown(self, runner: Runner[S], scans: int) -> tuple[str, str]:
        """What the report says about the nominal run, and about the values."""

    def matrix(self, runner: Runner[S], scans: int, level: Faults) -> Iterator[S]:
        """Every fault; ``scans`` is how long a good run takes."""

    def behind(self, program: Program, runner: Runner[S]) -> Iterator[tuple[Failure | None, Runner[S]]]:
        """What a job goes through behind the matrix, on its own or another CPU."""

    def faults(self, job: Any, level: Faults, kinds: int) -> str:
        """What the report says about a matrix with so many scenarios."""

    def procedures(self, program: Program) -> Iterator[Procedure]:
        """What the jobs do to each other."""

    def together(self, procedures: int) -> Check:
        """The check of the procedures, if all went well."""

    def left_out(self) -> Iterator[Check]:
        """What is not run because the project is large."""

    def own(self, program: Program, partner: Path) -> Iterator[Check]:
        """Every job against a partner that a file of the user describes."""


class Proof(Protocol):
    """What a protocol contributes to the verification of one plan."""

    def constants(self) -> Mapping[str, int]:
        """System constants that the generated code names, with numbers that stand for theirs."""

    def stimulus(self) -> Sequence[tuple[str, str]]:
        """Sources that are executed with the generated ones: file name and text."""

    def layouts(self) -> Iterator[LaidOut]:
        """Every buffer."""

    def telegrams(self, folder: Folder) -> Iterator[Check]:
        """Start values against the spec and the standard."""

    def foundation(self, folder: Path) -> Iterator[Check]:
        """What is the same in every project and known by its hash; ``run`` executes it even if it is known."""

    def exchanges(self, folder: Folder, partner: Path | None, progress: Progress | None) -> CheckGroup | None:
        """Telegrams against a simulated partner, or the one in a file; None if there is nothing like that."""

    def oracles(self, folder: Folder, *, dissector: bool) -> Iterator[Check]:
        """What somebody else says about the telegrams; ``dissector`` asks a program that is not plcgen's."""

    def stated(self, program: Program) -> Iterator[Check]:
        """What the files do against what the spec demands, stated apart from the plan."""

    def ledger(self) -> Iterator[Assumption]:
        """Every assumption that the rest goes by."""

    def suites(self) -> Sequence[Suite[Any]]:
        """What is executed."""
