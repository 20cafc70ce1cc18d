"""What drive jobs contribute to verification."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path

from plcgen.base.diagnostics import Span
from plcgen.base.diagnostics.counting import quantity, shortlist
from plcgen.base.files.text import read_text
from plcgen.ds47.plan.nouns import DriveJob, DrivePlan
from plcgen.ds47.proof import stimulus
from plcgen.ds47.proof.calls import check_calls
from plcgen.ds47.proof.commands import check_commands
from plcgen.ds47.proof.conduct import JobConduct
from plcgen.ds47.proof.dissected import dissected_checks
from plcgen.ds47.proof.engine import NAMES, DriveEngine, engine_check
from plcgen.ds47.proof.exchanges import check_drive, check_telegrams
from plcgen.ds47.proof.ledger import ledger
from plcgen.ds47.proof.own_drive import own_checks
from plcgen.ds47.proof.plant import Plant
from plcgen.ds47.proof.published import published_checks
from plcgen.ds47.proof.restoration import CHECK
from plcgen.ds47.proof.rig import JobRig
from plcgen.ds47.proof.scenario import DriveScenario
from plcgen.ds47.proof.scenarios import STATE_CONFLICT, fault_matrix, polls
from plcgen.ds47.proof.second import fact_checks, second_checks
from plcgen.ds47.proof.sections import PlantSection
from plcgen.ds47.proof.stated.checks import stated_checks
from plcgen.ds47.proof.together import left_out_together, procedures
from plcgen.ds47.proof.wording import DriveWording
from plcgen.ds47.recording.jobs import execute_path, instance_path
from plcgen.ds47.sim.drive import Drive
from plcgen.project.nouns import BufferField
from plcgen.proof.checks import Check, CheckGroup, Outcome
from plcgen.proof.conditions import Premise
from plcgen.proof.coverage import NO_OTHER
from plcgen.proof.effort import Faults
from plcgen.proof.folder import Folder
from plcgen.proof.ledger import Assumption
from plcgen.proof.making import Pending, make_checks
from plcgen.proof.rig import shown_value
from plcgen.proof.runner import Runner
from plcgen.proof.scenario import Failure, Statistics
from plcgen.proof.suite import CodeBlock, LaidOut, Procedure, Progress, Reads
from plcgen.s7.cpu.cpu import Cpu
from plcgen.s7.cpu.program import Program
from plcgen.s7.read.generated import generated_sources

SHOWN_VALUES = 3
ROLES = {"gate_data": "gate_type"}
"""Blocks of the engine that its proof and the plan call differently."""
TELEGRAM = ("statTicket.ask.telegram", "tempSeen.telegram")
"""Where a job block looks which telegram it is."""


class DriveProof:
    """The proof of a plan of drive jobs."""

    def __init__(self, plan: DrivePlan) -> None:
        self.plan = plan

    def constants(self) -> dict[str, int]:
        """Hardware identifiers that are named."""
        return {drive.id_name: drive.id_value for drive in self.plan.drives if drive.id_name}

    def stimulus(self) -> tuple[tuple[str, str], ...]:
        """Callers of every job block."""
        return ((stimulus.FILE, stimulus.stimulus(self.plan)),) if self.plan.jobs else ()

    def layouts(self) -> Iterator[LaidOut]:
        """Request and response of every telegram."""
        for job in self.plan.shapes:
            for telegram in job.telegrams:
                positive, negative = telegram.positive_length, telegram.negative_length
                note = f"positive {positive} / negative {negative}  "
                yield LaidOut(telegram.request, _no_reserve)
                yield LaidOut(telegram.response, _no_reserve, room=max(positive, negative), note=note)

    def telegrams(self, folder: Folder) -> Iterator[Check]:
        """Start values of the requests, and of the commands of all jobs."""
        return make_checks(self._telegrams(folder), "telegrams", Span(str(folder.path)))

    def _telegrams(self, folder: Folder) -> Iterator[Pending]:
        yield from check_telegrams(self.plan, folder)
        place, plan = (lambda: Span(str(folder.path))), self.plan
        yield Pending("commands", "commands", place, lambda: check_commands(plan, folder))
        yield Pending("calls", "calls", place, lambda: check_calls(plan, folder))

    def exchanges(self, folder: Folder, partner: Path | None, progress: Progress | None) -> CheckGroup | None:
        """Every telegram against the simulated drive, or the one in a drive file."""
        if not self.plan.jobs:
            return None
        own = drive_maker(partner)() if partner is not None else None
        checks = make_checks(check_drive(self.plan, folder, own, progress), "drive", Span(str(folder.path)))
        return CheckGroup("drive", "Simulated drive", tuple(checks))

    def oracles(self, folder: Folder, *, dissector: bool) -> Iterator[Check]:
        """Published telegrams, facts of documents, the second drive; with ``dissector`` Wireshark."""
        return make_checks(self._oracles(folder, dissector=dissector), "oracles", Span(str(folder.path)))

    def _oracles(self, folder: Folder, *, dissector: bool) -> Iterator[Check | Pending]:
        yield from published_checks(self.plan)
        yield from fact_checks(self.plan)
        yield from second_checks(self.plan, folder)
        if dissector:
            make = partial(dissected_checks, self.plan, folder)
            yield Pending("wireshark", "Wireshark", lambda: Span(str(folder.path)), make)
        elif self.plan.jobs:
            yield Check("wireshark", "Wireshark", "", Outcome.NOT_RUN, "not run: only with --oracle tshark")

    def stated(self, program: Program) -> Iterator[Check]:
        """What the files do against what the spec demands, stated apart from the plan."""
        if self.plan.jobs:
            loaded = self.plan.loaded
            yield from stated_checks(loaded, program, self.constants(), loaded.spec.plc.family)

    def wording(self) -> DriveWording:
        """What the documents say."""
        return DriveWording(self.plan)

    def ledger(self) -> Iterator[Assumption]:
        """What documents say about devices, telegrams and parameters."""
        return ledger(self.plan)

    def foundation(self, folder: Path) -> Iterator[Check]:
        """The engine: channel, ticket and gate."""
        if self.plan.jobs:
            names = {role: getattr(self.plan.engine, ROLES.get(role, role)).name for role in NAMES}
            engine = DriveEngine.of(generated_sources(folder), self.plan.target.dialect, names)
            yield engine_check(engine)

    def suites(self) -> list[DriveSuite]:
        """All jobs are one suite: they may share units."""
        return [DriveSuite(self.plan)] if self.plan.jobs else []


def _no_reserve(field: BufferField) -> bool:
    return field.role != "reserve"


def drive_maker(file: Path) -> Callable[[], Drive]:
    """Makes a new drive of a drive file each time. Raises DiagnosticError."""
    from plcgen.ds47.sim.load import load_drive  # its models cost start-up time that few runs need

    text = read_text(file)
    return lambda: load_drive(text, str(file))


class DriveSuite:
    """The job blocks of a plan, each once, and what all instances do together."""

    prefix = ""
    page = "docs/generated-code.md"

    def __init__(self, plan: DrivePlan) -> None:
        self.plan = plan
        self.jobs = tuple(replace(job, key=job.shape) for job in plan.shapes)
        self.numbers = {job.shape: number for number, job in enumerate(plan.shapes, 1)}
        self._cpu: Cpu | None = None

    def pins(self, job: DriveJob) -> dict[str, str]:
        """Where a job is started, and outputs of its instance."""
        outputs = {name: f"{instance_path(job)}.{name}" for name in ("busy", "done", "error", "status")}
        return {"execute": execute_path(job), **outputs}

    def shown_name(self, job: DriveJob) -> str:
        """Its key."""
        return job.key

    def blocks(self) -> list[CodeBlock]:
        """One block per kind of job, and the callers."""
        callers = [caller.block.name for caller in self.plan.callers]
        span = self.plan.loaded.key_span(("plc",))
        return [
            *(self.block(job) for job in self.jobs),
            *(CodeBlock(name, name, name, (), lambda: span) for name in callers),
        ]

    def block(self, job: DriveJob) -> CodeBlock:
        """The block of a job. Its telegrams count from 1."""
        span = self.plan.loaded.key_span(job.path)
        numbers = frozenset(range(1, (CHECK if job.restores else len(job.telegrams)) + 1))
        names = (
            TELEGRAM if job.poll is None and job.messages is None else ()
        )  # a telegram that is repeated has a number of its own each time
        premises = [Premise(NO_OTHER, variable=name, values=numbers, given="") for name in names]
        return CodeBlock(job.key, job.key, job.block.name, (job,), lambda: span, tuple(premises))

    def runner(self, program: Program, job: DriveJob, statistics: Statistics | None = None) -> Runner[DriveScenario]:
        """The job against its simulated drive. One CPU serves all jobs: the program may be large."""
        if self._cpu is None or self._cpu.program is not program:
            self._cpu = Cpu(program)
        return Runner(JobConduct(JobRig(self.plan, program, job, self.numbers[job.shape], self._cpu)), statistics)

    def reads(self, job: DriveJob) -> Reads:
        """Its caller, with all that this calls, and the job; a job that is not there cannot be looked at."""
        caller = stimulus.shape_fb(self.numbers[job.shape])
        return Reads((caller, f"{caller}_DB", *stimulus.UNITS, stimulus.GATE_DB), (self.plan.target, job))

    def first(self) -> DriveScenario:
        """An ordinary run."""
        return DriveScenario(name="first run", guarded=True)

    def nominal(self, runner: Runner[DriveScenario]) -> DriveScenario:
        """A run with the factory settings, busy calls and a few temporary errors."""
        reads = dict.fromkeys(range(1, polls(rig_of(runner).job) + 1), STATE_CONFLICT)
        return DriveScenario(name="nominal run", busy=(3, 1), reads=reads, values="factory", guarded=True, follow=False)

    def shown(self, runner: Runner[DriveScenario], scans: int) -> tuple[str, str]:
        """Scans and what happened in them; the values read."""
        rig = rig_of(runner)
        name, job, count = rig.db.block, rig.job, polls(rig.job)
        values = [(use, shown_value(rig.cpu[f"{name}.job.{use.member}"])) for use in job.outputs]
        shown = [f"{use.label} = {text} {use.parameter.unit}".rstrip() for use, text in values]
        if job.messages is not None:
            member = job.messages.member
            latest, present = (
                shown_value(rig.cpu[f"{name}.job.{path}"]) for path in (f"{member}[1].code", job.messages.count)
            )
            shown = [f"{present} {member}, the latest {latest}"]
        if job.deviations is not None:
            shown = [f"{shown_value(rig.cpu[f'{name}.job.{job.deviations.count}'])} deviations"]
        shown = shown or [f"{use.label} {'written' if use.writes else 'stored'}" for use in job.uses]
        tail = f", RDREC B5 x{count}" if count else ""
        return f"{scans} scans, WRREC busy 3{tail}", shortlist(shown, SHOWN_VALUES, f", .. ({len(shown)})")

    def matrix(self, runner: Runner[DriveScenario], scans: int, level: Faults) -> Iterator[DriveScenario]:
        """What is the job's own."""
        rig = rig_of(runner)
        return fault_matrix(rig.job, scans, rig.longest)

    def behind(
        self, program: Program, runner: Runner[DriveScenario]
    ) -> Iterator[tuple[Failure | None, Runner[DriveScenario]]]:
        """Nothing."""
        return iter(())

    def faults(self, job: DriveJob, level: Faults, kinds: int) -> str:
        """Scenarios."""
        return f"{kinds} scenarios of values, errors, signals"

    def procedures(self, program: Program) -> Iterator[Procedure]:
        """What the jobs do to each other."""
        made: list[tuple[PlantSection, Plant]] = []  # one at a time: they share a CPU

        def plant(name: str, section: PlantSection) -> Plant:
            if not made or made[0][0].plan is not section.plan:
                cpu = made.pop()[1].cpu if made else None
                made.append((section, Plant(section.plan, program, cpu, section.blocks)))
            return made[0][1].fresh(name)

        return procedures(self.plan, plant)

    def together(self, procedures: int) -> Check:
        """All jobs on all drives."""
        units = quantity(len(self.plan.units), "unit")
        text = f"{quantity(len(self.plan.jobs), 'job')} on {units} through OB1: {procedures} scenarios"
        return Check("together", "all jobs", text, Outcome.OK, "never two requests at once, every job gets its turn")

    def left_out(self) -> Iterator[Check]:
        """Points of time, OBs and masters."""
        missing = left_out_together(self.plan)
        if missing:
            subject = quantity(len(self.plan.jobs), "job")
            yield Check("together.rest", subject, "", Outcome.NOT_RUN, f"not run: {'; '.join(missing)}")

    def own(self, program: Program, partner: Path) -> Iterator[Check]:
        """Every job against the drive of a drive file."""
        return own_checks(self.plan, program, drive_maker(partner))


def rig_of(runner: Runner[DriveScenario]) -> JobRig:
    """The rig of a drive job."""
    rig = runner.conduct.rig
    if not isinstance(rig, JobRig):
        raise TypeError("not a drive job")
    return rig
