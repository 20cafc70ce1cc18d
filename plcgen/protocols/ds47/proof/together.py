"""Scenarios of the whole program: OB1 with all jobs, several jobs on one drive, CPU limits, wrong DB numbers."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from dataclasses import replace

from plcgen.cpu.cpu import Cpu
from plcgen.cpu.program import Program
from plcgen.cpu.system.bus import Periphery
from plcgen.proof.rig import Members
from plcgen.proof.runner import Runner
from plcgen.proof.scenario import Failure, ScenarioError
from plcgen.proof.suite import Procedure
from plcgen.protocols.ds47.plan.nouns import DriveJob, DrivePlan
from plcgen.protocols.ds47.proof.conduct import JobConduct
from plcgen.protocols.ds47.proof.rig import JobRig, ScriptedDrive
from plcgen.protocols.ds47.proof.scenario import DriveScenario
from plcgen.protocols.ds47.proof.words import DONE, LEASE_MS, WORDS
from plcgen.protocols.ds47.sim.bench import build_drive
from plcgen.protocols.ds47.sim.drive import Drive
from plcgen.protocols.ds47.sim.faults import Fault, FaultKind
from plcgen.s7.blocks import BlockKind

ROUNDS = 500
UNUSED_NUMBER = 59_999
ROW = 600
TAKE_OVER = 1500
"""Time in ms beside LEASE that a job takes to end well behind an owner that is not called any more."""


class Plant:
    """All drives and the CPU with its OB1."""

    def __init__(self, plan: DrivePlan, program: Program, job_limit: int | None = None) -> None:
        self.plan, self.program = plan, program
        self.bus = Periphery(write_busy=1, read_busy=1)
        self.drives: dict[int, ScriptedDrive] = {}
        for planned in plan.drives:
            built = build_drive(plan, planned)
            known = self.drives.get(planned.id_value)
            if known is not None:
                objects = (*known.objects.values(), *built.objects.values())
                built = Drive(replace(built.behaviour, local_object=None), objects)
            self.drives[planned.id_value] = ScriptedDrive(built)
            self.bus.attach(planned.id_value, self.drives[planned.id_value])
        self.cpu = Cpu(program, self.bus, job_limit=job_limit)
        self.cpu.restart("cold")
        self.scans = 0
        main = program.main()
        line = main.result.tokens.position(main.unit.start)[0] if main is not None else 1
        self.place = (main.result.tokens.file if main is not None else "", line)

    def path(self, job: DriveJob, signal: str) -> str:
        """Where OB1 takes or leaves a signal of a job."""
        address = getattr(job.trigger, signal, None)
        return f'"{self.plan.control_db.name}".{job.member}.{signal}' if address is None else str(address)

    def start(self, job: DriveJob, *, value: bool = True) -> None:
        """Set the command of a job."""
        self.cpu[self.path(job, "execute")] = value

    def step(self) -> None:
        """One scan of OB1."""
        self.scans += 1
        self.cpu.scan(10)
        if self.cpu.misuses or self.cpu.faulted:
            raise ScenarioError("misuse")

    def result(self, job: DriveJob) -> tuple[bool, bool, int]:
        """Flags done and error and the status word as OB1 passes them on."""
        flags = (bool(self.cpu[self.path(job, name)]) for name in ("done", "error"))
        status = self.cpu[self.path(job, "status")]
        return next(flags), next(flags), int(status) if isinstance(status, int) else -1


def procedures(plan: DrivePlan, program: Program) -> Iterator[Procedure]:
    """What the jobs do to each other."""

    def procedure(name: str, run: Callable[[Plant], None], job_limit: int | None = None) -> Procedure:
        return Procedure(name, lambda: Plant(plan, program, job_limit), run)

    yield procedure("every job through OB1", _one_by_one)
    jobs = plan.jobs
    least = min(job.timeout for job in jobs)
    round_ = 100 + sum(100 + 60 * len(job.telegrams) for job in jobs)
    if round_ < least:
        yield procedure("all jobs again and again", _again_and_again)
    waits = sum(len(job.telegrams) for job in jobs)
    if all(job.retries > waits and waits * (job.retry_pause + 100) + round_ < job.timeout for job in jobs):
        yield procedure("all jobs at once, one record call at a time in the CPU", _at_once, 1)
    for token, drives in plan.tokens:
        sharing = [job for job in jobs if job.drive in drives]
        for first, second in itertools.pairwise(sharing):
            if min(first.timeout, second.timeout) < LEASE_MS + TAKE_OVER:
                continue
            for calls in (3, 4, 5, 6):
                name = f"{first.key} is not called after scan {calls}, {second.key} takes {token.name} over"
                yield procedure(name, _take_over(first, second, calls))


def _one_by_one(plant: Plant) -> None:
    """Commands, inputs and results of every job travel through OB1."""
    control = plant.plan.control_db.name
    for job in plant.plan.jobs:
        rig = JobRig(plant.plan, plant.program, job)
        paths = (f"{job.member}.{use.member}" for use in (*job.inputs, *job.outputs))
        signals = Members(plant.cpu, plant.program, control, paths, f"{job.member}.")
        drive = plant.drives[job.drive.id_value]
        drive.begin(DriveScenario(name="OB1"))
        values, inputs, requests = rig.sets[0]
        parameters = drive.objects[job.drive.drive_object].parameters
        for pnu, content in values.items():
            parameters[pnu].values = list(content)
        for member, data in inputs:
            signals.put(member, data)
        plant.start(job)
        busy = plant.path(job, "busy")
        for _ in range(200 * len(job.telegrams)):
            plant.step()
            done, error, _status = plant.result(job)
            if bool(plant.cpu[busy]) == (done or error):
                raise ScenarioError(f"busy of {job.key} is wrong behind OB1")
            if done or error:
                break
        if plant.result(job) != (True, False, DONE):
            raise ScenarioError(f"{job.key} gives {plant.result(job)}, not done")
        sent = [e.data[1:] for e in drive.journal if e.direction == "write"]
        if sent != [request[1:] for request in requests]:
            raise ScenarioError(f"{job.key} sends other telegrams than planned")
        rig.drive.objects = drive.objects
        for use in job.outputs:
            expected = rig.expected(use)
            if signals.bytes(use.member, len(expected)) != expected:
                raise ScenarioError(f"{control}.{job.member}.{use.member} does not hold the drive's value")
        _fall(plant, job)
        drive.begin(DriveScenario(name="OB1", faults=(Fault(FaultKind.ERROR, number=0x11, position=1, words=1),)))
        plant.start(job)
        for _ in range(200):
            plant.step()
            if any(plant.result(job)[:2]):
                break
        if plant.result(job) != (False, True, WORDS["PARAMETER_ERROR"]):
            raise ScenarioError(f"{job.key} gives {plant.result(job)} after an error of the drive")
        _fall(plant, job)


def _fall(plant: Plant, job: DriveJob) -> None:
    """The command of a job falls."""
    plant.start(job, value=False)
    plant.step()
    if plant.result(job) != (False, False, WORDS["IDLE"]):
        raise ScenarioError(f"{job.key} is not idle after its command has fallen")


def _again_and_again(plant: Plant) -> None:
    """Every job is started again as soon as it has ended: each gets its turn, one request at a time."""
    jobs = plant.plan.jobs
    ended = dict.fromkeys((job.key for job in jobs), 0)
    for job in jobs:
        plant.start(job)
    owners = [(plant.cpu.db(token.name), plant.drives[drives[0].id_value]) for token, drives in plant.plan.tokens]
    for _ in range(ROUNDS * max(1, len(jobs) // 4)):
        plant.step()
        for job in jobs:
            done, error, status = plant.result(job)
            if error:
                raise ScenarioError(f"{job.key} ends with 16#{status:04X}")
            ended[job.key] += done
            plant.start(job, value=not done)
    for _, drive in owners:
        order = [exchange.direction for exchange in drive.journal if not exchange.status]
        if any(one == other for one, other in itertools.pairwise(order)):
            raise ScenarioError("two requests at once on one drive")
    for _, drives in plant.plan.tokens:
        counts = [ended[job.key] for job in jobs if job.drive in drives]
        if counts and (min(counts) < max(counts) - 1 or not min(counts)):
            raise ScenarioError(f"a job never gets its turn: {counts} jobs ended")


def _at_once(plant: Plant) -> None:
    """The CPU runs one record call of a kind at a time: refused ones are repeated."""
    jobs = plant.plan.jobs
    for job in jobs:
        plant.start(job)
    for _ in range(400 + 400 * len(jobs)):
        plant.step()
        if all(plant.result(job)[0] for job in jobs):
            return
        for job in jobs:
            _done, error, status = plant.result(job)
            if error:
                raise ScenarioError(f"{job.key} ends with 16#{status:04X}")
    raise ScenarioError("not every job came to its end")


def _take_over(first: DriveJob, second: DriveJob, calls: int) -> Callable[[Plant], None]:
    """A job that is not called any more loses the drive after LEASE, and reports it when it is called again."""

    def call(plant: Plant, job: DriveJob, *, execute: bool = True) -> tuple[bool, int]:
        plant.scans += 1
        plant.cpu.call(job.instance.name, 50, execute=execute)
        busy, status = plant.cpu[f"{job.instance.name}.busy"], plant.cpu[f"{job.instance.name}.status"]
        if plant.cpu.misuses:
            raise ScenarioError("misuse")
        return bool(busy), int(status) if isinstance(status, int) else -1

    def until_end(plant: Plant, job: DriveJob, status: int) -> int:
        started = plant.cpu.clock
        for _ in range(400):
            busy, found = call(plant, job)
            if not busy:
                break
        if found != status:
            raise ScenarioError(f"{job.key} ends with 16#{found:04X} instead of 16#{status:04X}")
        call(plant, job, execute=False)
        return plant.cpu.clock - started

    def run(plant: Plant) -> None:
        for _ in range(calls):
            call(plant, first)
        passed = until_end(plant, second, DONE)
        if passed < 3000:
            raise ScenarioError(f"{second.key} took the drive over within {passed} ms")
        until_end(plant, first, WORDS["DRIVE_LOST"])
        until_end(plant, first, DONE)
        until_end(plant, second, DONE)

    return run


# --- wrong numbers ----------------------------------------------------------------------------------------


def wrong_numbers(
    plan: DrivePlan, program: Program, job: DriveJob
) -> Iterator[tuple[Failure | None, Runner[DriveScenario]]]:
    """Buffer DBs that have other numbers than the block expects: nothing is sent."""
    blocks = {entry.name: entry for entry in program.link.blocks.values() if entry.block.kind is BlockKind.DB}
    for index, telegram in enumerate(job.telegrams, 1):
        request, response = telegram.request.db.name, telegram.response.db.name
        control = plan.control_db.name
        first, second = blocks[request].number, blocks[response].number
        cases: list[tuple[str, dict[str, int | None], bytes | None]] = [
            ("request and response DB are exchanged", {request: second, response: first}, None),
            ("another DB has the number of the request DB", {request: UNUSED_NUMBER, control: first}, None),
            ("another DB has the number of the response DB", {response: UNUSED_NUMBER, control: second}, None),
        ]
        for which, name in (("request", request), ("response", response)):
            for byte in (0, index, 0xFF - index):
                title = f"the {which} DB is missing, byte {byte:02X}h is left behind"
                cases.append((title, {name: UNUSED_NUMBER}, bytes((byte,))))
        for title, numbers, litter in cases:
            before = {name: blocks[name].number for name in numbers}
            for name, number in numbers.items():
                blocks[name].number = number
            scenario = DriveScenario(
                name=f"telegram {index}: {title}",
                status=(WORDS["WRONG_DB"],),
                telegram=index,
                calls=(-1, -1),
                litter=litter,
                tolerate=True,
                follow=False,
            )
            rig = JobRig(plan, program, job)
            size = len(rig.cpu.db(control))
            for other, number in before.items():
                blocks[other].number = number
            if control in numbers and size < max(len(telegram.request.data), telegram.response.size):
                continue
            runner = Runner(JobConduct(rig))
            yield runner.try_run(scenario), runner


def row(runner: Runner[DriveScenario]) -> Failure | None:
    """600 jobs in a row: the reference wraps twice."""
    for number in range(1, ROW + 1):
        failure = runner.try_run(DriveScenario(name=f"job {number} of {ROW} in a row", busy=(0, 0), follow=False))
        if failure is not None:
            return failure
    return None
