"""The whole program: OB1 with all jobs, a simulated unit behind every channel."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from itertools import islice, product
from typing import Any

from plcgen.ds47.plan.access import Use
from plcgen.ds47.plan.nouns import DriveCaller, DriveJob, DrivePlan, DriveTelegram, PlannedUnit
from plcgen.ds47.proof import asked, clock_input, message_lists, records
from plcgen.ds47.proof.contents import ValueSet, alike, piece, value_set, values_of
from plcgen.ds47.proof.cycles import SINCE, cycle_signals, hold_back
from plcgen.ds47.proof.pace import SCAN, Pace
from plcgen.ds47.proof.partner import ScriptedDrive
from plcgen.ds47.proof.poll_results import check_held_back, saving_scans
from plcgen.ds47.proof.records import NUMBER, Records, shared
from plcgen.ds47.proof.restoration import CAUSE, OUTCOMES
from plcgen.ds47.proof.scenario import Contents, DriveScenario
from plcgen.ds47.proof.step_facts import FAILED
from plcgen.ds47.proof.words import DONE, GRANT, WORDS
from plcgen.ds47.sim.awaited import let_come
from plcgen.ds47.sim.bench import build_unit
from plcgen.proof.rig import Members
from plcgen.proof.scenario import IDLE, RUNNING, STARTED, ScenarioError
from plcgen.s7.cpu.cpu import Cpu
from plcgen.s7.cpu.program import Program
from plcgen.s7.cpu.system.port import Periphery
from plcgen.s7.cpu.system.record import PLACES

SIGNALS = ("execute", "busy", "done", "error", "status")
MANY = 100
"""So many combinations of answers are tried where jobs send the same."""
TELEGRAM_SCANS = 40
"""Scans that a telegram takes at most when its unit is free."""


class Plant:
    """All units and the CPU with its OB1. ``fresh`` begins again; ``name`` decides about the values.

    ``blocks`` are called instead of OB1: the plan is then a part of one.
    """

    def __init__(self, plan: DrivePlan, program: Program, cpu: Cpu | None = None, blocks: Sequence[str] = ()) -> None:
        self.plan, self.program, self.blocks = plan, program, blocks
        family: Any = plan.target.family
        self.cpu = cpu or Cpu(program, Periphery(), family=family)
        self.units = {unit.key: self._build(unit) for unit in plan.units}
        self._controls = {caller.number: self._control(caller) for caller in plan.callers}
        self._instances = {caller.number: self._instance(caller) for caller in plan.callers}
        waiting = {job.drive.unit.key: job.drive.unit.db.name for job in plan.jobs if job.waits}
        self._turns = {key: Members(self.cpu, program, db, ["unit.turn.grant"]) for key, db in waiting.items()}
        self.values: dict[str, ValueSet] = {}
        self.records: dict[str, Records] = {}
        self.forgiven: frozenset[str] = frozenset()
        """Misuses that are not the program's doing."""
        self.name = ""
        self.round = self.scans = 0
        main = program.main()
        line = main.result.tokens.position(main.unit.start)[0] if main is not None else 1
        self.place = (main.result.tokens.file if main is not None else "", line)

    def _control(self, caller: DriveCaller) -> Members:
        members = [f"{job.member}.{name}" for job in self._jobs(caller) for name in self._signals(job)]
        return Members(self.cpu, self.program, caller.control.name, members)

    def _instance(self, caller: DriveCaller) -> Members:
        members = [f"{job.member}.statRest" for job in self._jobs(caller) if job.guarded]
        members += [f"{job.member}.statStep" for job in self._jobs(caller) if job.waits]
        members += [f"{job.member}.{SINCE}" for job in self._jobs(caller) if job.cycle]
        return Members(self.cpu, self.program, caller.instance.name, members)

    def _jobs(self, caller: DriveCaller) -> list[DriveJob]:
        return [job for job in self.plan.jobs if job.caller is caller]

    def control(self, job: DriveJob) -> Members:
        """Commands and results of a job and of others."""
        return self._controls[job.caller.number]

    @staticmethod
    def _signals(job: DriveJob) -> Iterable[str]:
        """Members of the job's structure: what has no flag, and values."""
        yield from (name for name in SIGNALS if getattr(job.trigger, name) is None)
        yield from FAILED if job.in_steps else ()
        yield from (CAUSE,) if job.restores else ()
        yield from records.recipe_signals(job)
        yield from cycle_signals(job)
        yield from clock_input.inputs(job)
        yield from asked.names(job)
        yield from (use.member for use in job.outputs)
        yield from message_lists.paths(job)

    def _build(self, unit: PlannedUnit) -> ScriptedDrive:
        uses: dict[int, list[Use]] = {drive.drive_object: [] for drive in self.plan.drives if drive.unit is unit}
        for job in self.plan.jobs:
            if job.drive.unit is unit:
                uses[job.drive.drive_object] += job.own
        drive = ScriptedDrive(build_unit(unit.device, uses))
        if any(job.waits for job in self.plan.jobs if job.drive.unit is unit):
            drive.asked = partial(self.let_come, unit)
        return drive

    def fresh(self, name: str = "") -> Plant:
        """Everything as after a download, all drives there; nothing is left of what ran before.

        ``name`` decides which values are drawn.
        """
        cpu, bus = self.cpu, self.cpu.bus
        cpu.records.places = PLACES[cpu.family]
        bus.write_busy = bus.read_busy = 1
        cpu.restart("cold")
        cpu.misuses.clear()
        cpu.forget_coverage()
        self.name, self.round = name, 0
        self.scans, self.forgiven = 0, frozenset()
        bus.drives.clear()
        self.connect()
        for drive in self.units.values():
            drive.switch_off()
        return self

    def connect(self) -> None:
        """Every unit that has jobs at the addresses of its drives."""
        for drive in (one for one in self.plan.drives if one.unit.key in self.units):
            self.cpu.bus.attach(drive.id_value, self.units[drive.unit.key])

    # --- one scan -------------------------------------------------------------------------------------

    def step(self, count: int = 1, milliseconds: int = SCAN) -> None:
        """Scans of OB1."""
        for _ in range(count):
            self.scans += 1
            self.hold()
            self.cpu.scan(milliseconds, blocks=self.blocks)
            if self.forgiven:
                self.cpu.misuses[:] = [misuse for misuse in self.cpu.misuses if misuse.code not in self.forgiven]
            if self.cpu.misuses or self.cpu.faulted:
                raise ScenarioError("misuse")

    def hold(self) -> None:
        """No cycle is over in the next scan."""
        for caller in self.plan.callers:
            hold_back(self._instances[caller.number], self._jobs(caller))

    def let_come(self, unit: PlannedUnit) -> None:
        """A unit is asked: what a sequence waits for that holds it is there."""
        slot = self._turns[unit.key].get("unit.turn.grant") // GRANT
        for job in self.plan.jobs:
            if job.waits and job.drive.unit is unit and job.slot == slot:
                step = self._instances[job.caller.number].get(f"{job.member}.statStep")
                let_come(self.units[unit.key].objects[job.drive.drive_object], job, step)

    def path(self, job: DriveJob, signal: str) -> str:
        """Where OB1 takes or leaves a signal of a job."""
        address = getattr(job.trigger, signal, None)
        return f'"{job.caller.control.name}".{job.member}.{signal}' if address is None else str(address)

    def get(self, job: DriveJob, signal: str) -> int:
        """Value of a signal."""
        if getattr(job.trigger, signal) is not None:
            value = self.cpu[self.path(job, signal)]
            return value if isinstance(value, int) else -1
        name = f"{job.member}.{signal}"
        return self.control(job).flag(name) if signal != "status" else self.control(job).get(name)

    def execute(self, job: DriveJob, *, value: bool = True) -> None:
        """Set the command of a job; the last save is long ago."""
        if job.guarded:
            self._instances[job.caller.number].set(f"{job.member}.statRest", 0)
        if job.trigger.execute is not None:
            self.cpu[str(job.trigger.execute)] = value
        else:
            self.control(job).set(f"{job.member}.execute", value)

    def result(self, job: DriveJob) -> tuple[bool, int]:
        """Whether a job has ended, and its status word."""
        busy, done, error = (self.get(job, name) for name in ("busy", "done", "error"))
        status = self.get(job, "status")
        if busy + done + error > 1 or bool(busy) != (status in {STARTED, RUNNING}) or bool(done) != (status == DONE):
            raise ScenarioError(f"{job.key}: busy {busy}, done {done}, error {error} with status 16#{status:04X}")
        return bool(done or error), status

    def ended_well(self, job: DriveJob) -> bool:
        """Whether a job is done. Raises ScenarioError if it ended otherwise."""
        ended, status = self.result(job)
        if ended and status != DONE:
            raise ScenarioError(f"{job.key} ends with 16#{status:04X}")
        return ended

    # --- rounds of all jobs ---------------------------------------------------------------------------

    def begin(self, scenario: DriveScenario | None = None, *, delivered: bool = False) -> None:
        """Other values for every drive and every input; ``delivered``: inputs and commands are as they are at first."""
        self.round += 1
        for job in self.plan.jobs if not delivered else ():
            if job.cycle:
                self.execute(job, value=False)
        for drive in self.units.values():
            drive.begin(scenario or DriveScenario(name="OB1"))
        for job in self.plan.jobs:
            unit, number = self.units[job.drive.unit.key], job.drive.drive_object
            kind: Contents = "factory" if delivered else "next"
            values = self.values[job.key] = value_set(job, unit, number, kind, f"{job.key} {self.name} {self.round}")
            values.put(unit, number)
            for member, data in values.inputs(job) if not delivered or job.timed else ():
                self.control(job).put(f"{job.member}.{member}", data)
        self._records(delivered=delivered)

    def _records(self, *, delivered: bool) -> None:
        """All jobs that take the record of a recipe have the first one, those that give it its values the last one."""
        self.records.clear()
        first: dict[str, Mapping[str, bytes]] = {}
        for job in self.plan.jobs:
            if job.recipe is None:
                continue
            db = Members(self.cpu, self.program, job.recipe.db.name, [])
            found = self.records[job.key] = Records(job, db, "records", job.recipe.count if job.stores else 1)
            self.control(job).set(f"{job.member}.{NUMBER}", found.number)
            if job.stores:
                continue
            own = self.values[job.key].given
            drawn = {use.member: own[use.position] for use in records.members(job)}
            record = job.recipe.values[0] if delivered else first.setdefault(job.recipe.key, drawn)
            given = {use.position: record[use.member] for use in records.members(job)}
            if not delivered:
                found.put(given)
            self.values[job.key] = shared(self.values[job.key], job, given)

    @property
    def patience(self) -> int:
        """Scans in which all jobs end if every one is started once: units wait for places, jobs for their unit."""
        busiest = max(sum(len(job.telegrams) for job in self.plan.jobs if job.drive.unit is u) for u in self.plan.units)
        places = self.cpu.records.places.total or self.cpu.records.places.each or 1
        saving = sum(saving_scans(job) for job in self.plan.jobs)
        return TELEGRAM_SCANS * (busiest + 2) * -(-len(self.plan.units) // places) + saving

    def start(self) -> None:
        """Start every job."""
        for job in self.plan.jobs:
            self.execute(job)

    def launch(self, scans: int = 0) -> None:
        """Other values, and every job started; then so many scans."""
        self.begin()
        self.start()
        self.step(scans)

    def until(
        self, wanted: Callable[[DriveJob, int], bool], scans: int, jobs: Sequence[DriveJob] | None = None
    ) -> None:
        """Run until every job, or some of them, has ended in a way that is wanted."""
        waiting, pace = list(self.plan.jobs if jobs is None else jobs), Pace(self.cpu, self.units.values())
        for _ in range(scans):
            self.step(1, pace.length())
            left = []
            for job in waiting:
                ended, status = self.result(job)
                if ended and not wanted(job, status):
                    raise ScenarioError(f"{job.key} ends with 16#{status:04X}")
                if not ended:
                    left.append(job)
            waiting = left
            if not waiting:
                return
        raise ScenarioError(f"{waiting[0].key} has not ended after {scans} scans")

    def fall(self) -> None:
        """The commands fall: all jobs are idle."""
        for job in self.plan.jobs:
            self.execute(job, value=False)
        self.step()
        for job in self.plan.jobs:
            if self.result(job) != (False, IDLE):
                raise ScenarioError(f"{job.key} is not idle after its command has fallen")

    def all_done(self) -> None:
        """Every job once: all of them end well, with the right telegrams and values."""
        self.begin()
        self.start()
        self.until(lambda _, status: status == DONE, self.patience)
        self.check()
        self.fall()

    # --- what must hold -------------------------------------------------------------------------------

    def exchanges(self, unit: PlannedUnit) -> list[tuple[bytes, bytes]]:
        """Requests of a unit and their answers, in order: never two at once."""
        found: list[tuple[bytes, bytes]] = []
        request = None
        for exchange in self.units[unit.key].journal:
            if exchange.index != unit.record_index & 0xFFFF:
                raise ScenarioError(f"data record 16#{exchange.index:04X} of {unit.key} is used")
            if exchange.direction == "write" and not exchange.status:
                request = exchange.data
            elif exchange.direction == "read" and not exchange.status:
                if request is None:
                    raise ScenarioError(f"{unit.key} is asked for an answer without a request")
                found.append((request, exchange.data))
                request = None
        return found

    def check(self) -> None:
        """Every job has sent its telegrams, and passes on what came."""
        for unit in self.plan.units:
            exchanges = self.exchanges(unit)
            jobs = [job for job in self.plan.jobs if job.drive.unit is unit]
            check_held_back(jobs, exchanges)
            for job in jobs:
                self.check_job(job, exchanges)
                self.check_failed(job)

    def check_failed(self, job: DriveJob) -> None:
        """A sequence that is done has no step that failed; of one whose first parameter is refused it is told."""
        if not job.in_steps:
            return
        refused = self.result(job)[1] == WORDS["PARAMETER_ERROR"]
        wanted = [1, job.uses[0].parameter.pnu] if refused else [0, 0]
        found = [self.control(job).get(f"{job.member}.{name}") for name in FAILED]
        if found != wanted:
            raise ScenarioError(f"{', '.join(FAILED)} of {job.key} are {found} instead of {wanted}")

    def check_job(self, job: DriveJob, exchanges: list[tuple[bytes, bytes]]) -> None:
        """Telegrams, and values of the outputs from the answers."""
        requests = self.values[job.key].requests(job, job.drive.drive_object)
        behind = 0
        for telegram, request in zip(job.telegrams, requests, strict=True):
            places = [n for n, (sent, _) in enumerate(exchanges) if n >= behind and alike(telegram, sent, request)]
            answers = [exchanges[n][1] for n in places]
            if places and job.verified and telegram.writes:
                behind = places[0]  # what is read back is not what another job has read before
            if not answers and self.result(job)[1] in {WORDS["DEVIATES"], *OUTCOMES}:
                return  # somebody else has written in between
            if not answers:
                raise ScenarioError(f"{job.key} does not send {request.hex(' ').upper()} (reference aside)")
            if telegram.parts[0].use in job.saving:
                answers = answers[-1:]  # asked again and again: the last one counts
            elif job.verified and not telegram.parts[0].use.precedes:
                answers = answers[:1]
            if not telegram.writes and not job.whole:
                self.check_outputs(job, telegram, answers)
        if job.stores:
            self.check_record(job)
        if job.listed is not None:
            self.check_list(job, [[a for sent, a in exchanges if sent[1:] == one[1:]] for one in requests])

    def check_list(self, job: DriveJob, answers: list[list[bytes]]) -> None:
        """A list is that of the last answers; where jobs send the same, and something is written, of earlier ones."""
        given = self.values[job.key].given
        shown = message_lists.shown_list(job, self.control(job), f"{job.member}.")
        tried = islice(product(*(dict.fromkeys(reversed(found)) for found in answers)), MANY)
        if not any(message_lists.answered(job, chosen, given) == shown for chosen in tried):
            raise ScenarioError(f"the list of {job.key} is not what came")

    def check_record(self, job: DriveJob) -> None:
        """The record has what has come to one of the jobs that give it their values."""
        found = self.records[job.key]
        for one in self.plan.jobs:
            if not one.stores or one.recipe is not job.recipe:
                continue
            exchanges = self.exchanges(one.drive.unit)
            requests = self.values[one.key].requests(one, one.drive.drive_object)
            answers = [[a for sent, a in exchanges if sent[1:] == request[1:]] for request in requests]
            tried = islice(product(*(dict.fromkeys(reversed(came)) for came in answers)), MANY)
            if any(found.holds(message_lists.came(one, chosen)) for chosen in tried):
                return
        raise ScenarioError(f"the record of {job.key} has not what came")

    def check_outputs(self, job: DriveJob, telegram: DriveTelegram, answers: list[bytes]) -> None:
        """The outputs of a telegram show one of the answers: where jobs send the same, nobody knows whose is which."""
        uses = [(part, f"{job.member}.{part.use.member}") for part in telegram.parts]
        control = self.control(job)
        shown = [piece(part, control.bytes(name, part.use.count * part.use.format.size)) for part, name in uses]
        came = [values_of(telegram, answer) for answer in answers]
        if shown in came:
            return
        for (_, name), found, value in zip(uses, shown, came[0], strict=True):
            if found != value:
                where = f"{job.caller.control.name}.{name}"
                raise ScenarioError(f"{where} is {found.hex(' ')}, {value.hex(' ')} came")
