"""What drive jobs contribute to verification."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import chain
from pathlib import Path

from plcgen.cpu.program import Program
from plcgen.input.text import read_text
from plcgen.project.nouns import BufferField
from plcgen.proof.checks import Check, CheckGroup, Outcome
from plcgen.proof.conditions import Premise
from plcgen.proof.coverage import NO_OTHER
from plcgen.proof.folder import Folder
from plcgen.proof.rig import value_text
from plcgen.proof.runner import Runner
from plcgen.proof.scenario import Failure, Statistics
from plcgen.proof.suite import CodeBlock, LaidOut, Level, Procedure, Progress
from plcgen.protocols.ds47.plan.nouns import DriveJob, DrivePlan
from plcgen.protocols.ds47.proof.answer_scenarios import answer_scenarios, error_matrix
from plcgen.protocols.ds47.proof.conduct import JobConduct
from plcgen.protocols.ds47.proof.exchanges import check_drive, check_telegrams
from plcgen.protocols.ds47.proof.own_drive import own_checks
from plcgen.protocols.ds47.proof.record_scenarios import STATE_CONFLICT, cpu_scenarios, record_scenarios
from plcgen.protocols.ds47.proof.rig import JobRig
from plcgen.protocols.ds47.proof.scenario import DriveScenario
from plcgen.protocols.ds47.proof.times import transitions
from plcgen.protocols.ds47.proof.together import procedures, row, wrong_numbers
from plcgen.protocols.ds47.proof.words import STATES, state_name
from plcgen.protocols.ds47.sim.drive import Drive
from plcgen.protocols.ds47.wire.errors import known_numbers

QUICK_ERRORS = 600
SHOWN_VALUES = 3
POLLS = 2
"""State conflicts of the nominal run, if the job has time for them."""
CALL_MS = 4
"""Time that a try takes at least besides its pause."""


class DriveProof:
    """The proof of a plan of drive jobs."""

    def __init__(self, plan: DrivePlan) -> None:
        self.plan = plan

    def layouts(self) -> Iterator[LaidOut]:
        """Request and response DB of every telegram."""
        for job in self.plan.jobs:
            for telegram in job.telegrams:
                positive, negative = telegram.positive_length, telegram.negative_length
                note = f"positive {positive} / negative {negative}  "
                yield LaidOut(telegram.request, _no_reserve)
                yield LaidOut(telegram.response, _no_reserve, room=max(positive, negative), note=note)

    def telegrams(self, folder: Folder) -> Iterator[Check]:
        """Start values of the request DBs."""
        return check_telegrams(self.plan, folder)

    def exchanges(self, folder: Folder, partner: Path | None, progress: Progress | None) -> CheckGroup | None:
        """Every telegram against the simulated drive, or the one in a drive file."""
        if not self.plan.jobs:
            return None
        own = drive_maker(partner)() if partner is not None else None
        return CheckGroup("drive", "Simulated drive", tuple(check_drive(self.plan, folder, own, progress)))

    def suites(self) -> list[DriveSuite]:
        """All jobs are one suite: they may share drives."""
        return [DriveSuite(self.plan)] if self.plan.jobs else []


def _no_reserve(field: BufferField) -> bool:
    return field.role != "reserve"


def drive_maker(file: Path) -> Callable[[], Drive]:
    """Makes a new drive of a drive file each time. Raises DiagnosticError."""
    from plcgen.protocols.ds47.sim.load import load_drive  # its models cost start-up time that few runs need

    text = read_text(file)
    return lambda: load_drive(text, str(file))


class DriveSuite:
    """The jobs of a plan, each in a block of its own."""

    prefix = ""
    page = "docs/generated-code.md"

    def __init__(self, plan: DrivePlan) -> None:
        self.plan, self.jobs = plan, plan.jobs

    def blocks(self) -> list[CodeBlock]:
        """One block per job."""
        return [self.block(job) for job in self.jobs]

    def block(self, job: DriveJob) -> CodeBlock:
        """The block of a job. Telegrams count from 1; with long pauses TIMEOUT comes before the last retry."""
        numbers = frozenset(range(1, len(job.telegrams) + 1))
        premises = [Premise(NO_OTHER, variable="statTelegram", values=numbers, among=frozenset(range(len(STATES))))]
        if all(len(telegram.parts) == 1 for telegram in job.telegrams):
            premises.append(Premise("a telegram of one parameter has one error", follow=("statFailed",)))
        if not job.retries:
            premises.append(Premise("retries: 0", follow=("MAX_RETRIES",)))
        if job.retries * (job.retry_pause + CALL_MS) >= job.timeout:
            premises.append(Premise("MAX_RETRIES x RETRY_PAUSE is longer than TIMEOUT", never="STATUS_RETRIES"))
        steps = transitions(job, classic=self.plan.target.classic)
        span = self.plan.loaded.key_span(job.path)
        opened = ("statFailed", "MAX_RETRIES")
        name = job.block.name
        return CodeBlock(job.key, job.key, name, (job,), lambda: span, tuple(premises), opened, steps, state_name)

    def runner(self, program: Program, job: DriveJob, statistics: Statistics | None = None) -> Runner[DriveScenario]:
        """The job against its simulated drive."""
        return Runner(JobConduct(JobRig(self.plan, program, job)), statistics)

    def first(self) -> DriveScenario:
        """An ordinary run."""
        return DriveScenario(name="first run")

    def nominal(self, runner: Runner[DriveScenario]) -> DriveScenario:
        """A run with the factory settings, busy calls and a few temporary errors."""
        polls = self.polls(runner)
        return DriveScenario(
            name="nominal run",
            busy=(3, 1),
            reads=dict.fromkeys(range(1, polls + 1), STATE_CONFLICT),
            factory=True,
            retries=None,
            calls=(0, polls),
            follow=False,
        )

    @staticmethod
    def polls(runner: Runner[DriveScenario]) -> int:
        """State conflicts for which there is time."""
        rig = rig_of(runner)
        return next((n for n in range(POLLS, 0, -1) if rig.limits.fits(n, len(rig.job.telegrams))), 0)

    def shown(self, runner: Runner[DriveScenario], scans: int) -> tuple[str, str]:
        """Scans and what happened in them; the values read."""
        rig, polls = rig_of(runner), self.polls(runner)
        name, job = rig.job.instance.name, rig.job
        values = [(use, value_text(rig.cpu[f"{name}.{use.member}"])) for use in job.outputs]
        shown = [f"{use.label} = {text} {use.parameter.unit}".rstrip() for use, text in values]
        shown = shown or [f"{use.label} written" for use in job.uses]
        more = f", .. ({len(shown)})" if len(shown) > SHOWN_VALUES else ""
        tail = f", RDREC B5 x{polls}" if polls else ""
        return f"{scans} scans, WRREC busy 3{tail}", ", ".join(shown[:SHOWN_VALUES]) + more

    def matrix(self, runner: Runner[DriveScenario], scans: int, level: Level) -> Iterator[DriveScenario]:
        """Answers, record calls, the CPU, error numbers."""
        rig, target = rig_of(runner), self.plan.target
        yield from answer_scenarios(rig.job, classic=target.classic)
        yield from record_scenarios(rig.job, rig.limits)
        yield from cpu_scenarios(rig.job, rig.limits, scans, retentive=target.v5)
        yield from errors_of(rig.job, level)

    def behind(
        self, program: Program, runner: Runner[DriveScenario]
    ) -> Iterator[tuple[Failure | None, Runner[DriveScenario]]]:
        """Many jobs in a row; on S7-300/400 DBs with wrong numbers."""
        failure = row(runner)
        yield failure, runner
        if self.plan.target.classic and failure is None:
            for failure, other in wrong_numbers(self.plan, program, rig_of(runner).job):
                runner.statistics.transitions |= other.statistics.transitions
                yield failure, other

    def faults(self, job: DriveJob, level: Level, kinds: int) -> str:
        """Error numbers, positions, other faults."""
        errors = sum(1 for _ in errors_of(job, level))
        positions = sum(len(telegram.parts) for telegram in job.telegrams)
        return f"{len(known_numbers())} error numbers x {positions} positions, {kinds - errors} other faults"

    def procedures(self, program: Program) -> Iterator[Procedure]:
        """What the jobs do to each other."""
        return procedures(self.plan, program)

    def together(self, procedures: int) -> Check:
        """All jobs on all drives."""
        drives = len(self.plan.tokens)
        text = f"{len(self.jobs)} jobs on {drives} drives through OB1: {procedures} scenarios"
        return Check("together", "all jobs", text, Outcome.OK, "never two requests at once, every job gets its turn")

    def own(self, program: Program, partner: Path) -> Iterator[Check]:
        """Every job against the drive of a drive file."""
        return own_checks(self.plan, program, drive_maker(partner))


def rig_of(runner: Runner[DriveScenario]) -> JobRig:
    """The rig of a drive job."""
    rig = runner.conduct.rig
    if not isinstance(rig, JobRig):
        raise TypeError("not a drive job")
    return rig


def errors_of(job: DriveJob, level: Level) -> Iterator[DriveScenario]:
    """Error numbers: every combination, or in a large quick matrix every number and every position."""
    positions = sum(len(telegram.parts) for telegram in job.telegrams)
    if level == "full" or len(known_numbers()) * positions * 2 <= QUICK_ERRORS:
        return error_matrix(job)
    step = positions * 2 + 1
    chosen = (scenario for number, scenario in enumerate(error_matrix(job)) if number % step == number // step % step)
    return chain(chosen, error_matrix(job, (0x11,)))
