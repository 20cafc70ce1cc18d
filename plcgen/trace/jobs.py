"""The jobs of a project in a run: which members tell their story, when they start and how they end."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial

from plcgen.cpu.cpu import Cpu
from plcgen.protocols.ds47.plan.nouns import DriveJob, DrivePlan, Use
from plcgen.protocols.ds47.wire.formats import unpack_values
from plcgen.protocols.ds47.words import CHANNEL_STATES, STATUS_WORDS
from plcgen.trace.model import Contact, Ending, JobResult, JobValue, Signal, Value
from plcgen.trace.recorder import Derived, Watched, kind_of, plain, signal, watch

_WAITING = 1 + max(number for _, number, _ in CHANNEL_STATES)
STATE_NAMES = {number: name.removeprefix("STATE_") for name, number, _ in CHANNEL_STATES} | {_WAITING: "WAITING"}
"""States of a job: those of the channel while it holds the unit, IDLE, and waiting for its turn."""
STATUS_TEXTS = {number: text for _, number, text in STATUS_WORDS}
_PAUSE = next(number for name, number, _ in CHANNEL_STATES if name == "STATE_PAUSE")
_TICKETS = 100_000
"""A grant is the slot times this, plus the number under which the job asks."""

_MEMBERS = ("busy", "done", "error", "status", "errors", "errorInfos")
_OF_UNIT = {"retries": "retries", "reference": "telegram[0]", "recordStatus": "recordStatus"}
"""What a job shows of its unit while it holds it."""
_OWN = frozenset({"execute", "state", "telegram", *_MEMBERS, *_OF_UNIT})
"""Names of signals that a value may have too: not all of them are names at the interface of the block."""


def execute_path(plan: DrivePlan, job: DriveJob) -> str:
    """Where a job is started: its flag, or the member of the control DB."""
    flag = job.trigger.execute
    return str(flag) if flag is not None else f'"{plan.control_db.name}".{job.member}.execute'


def instance_path(plan: DrivePlan, job: DriveJob) -> str:
    """Where the instance of a job lies."""
    return f'"{plan.engine.calls_db.name}".{job.member}'


class UnitWatch:
    """The units of a run: which job holds each of them."""

    def __init__(self, cpu: Cpu, plan: DrivePlan) -> None:
        self._cpu, self._plan = cpu, plan
        self._grants = {unit.key: watch(cpu, f'"{unit.db.name}".unit.turn.grant')[0] for unit in plan.units}
        self._channels = {f"{plan.engine.calls_db.name}.{unit.member}".upper(): unit.key for unit in plan.units}
        self._jobs = {(job.drive.unit.key, job.slot): job.key for job in plan.jobs}

    def slot(self, unit: str) -> int:
        """The slot that holds a unit, 0 if none does."""
        grant = self._grants[unit].value()
        return grant // _TICKETS if isinstance(grant, int) else 0

    def holds(self, job: DriveJob) -> bool:
        """Whether a job holds its unit."""
        return self.slot(job.drive.unit.key) == job.slot

    def job_of(self, instance: str) -> str:
        """Key of the job for which an instance of WRREC or RDREC works; the instance itself if it belongs to none."""
        unit = self._channels.get(instance.rpartition(".")[0].upper())
        return instance if unit is None else self._jobs.get((unit, self.slot(unit)), instance)

    def state(self, job: DriveJob) -> int:
        """State of a job, see STATE_NAMES."""
        if not self._cpu[f"{instance_path(self._plan, job)}.busy"]:
            return 0
        found = self._cpu[f'"{job.drive.unit.db.name}".unit.state'] if self.holds(job) else _WAITING
        return found if isinstance(found, int) else 0

    def signals(self) -> Iterator[tuple[Signal, Derived]]:
        """Which job holds which unit."""
        for unit in self._plan.units:
            names = {0: "", **{job.slot: job.key for job in self._plan.jobs if job.drive.unit is unit}}
            path = f'"{unit.db.name}".unit.turn.grant'
            yield (
                Signal(unit.db.name, "owner", "integer", 16, path=path, names=names),
                Derived(partial(self.slot, unit.key)),
            )


def job_signals(
    cpu: Cpu, plan: DrivePlan, job: DriveJob, units: UnitWatch
) -> Iterator[tuple[Signal, Watched | Derived]]:
    """Signals of a job: start, state, outputs; its values are listed by the text report."""
    own, unit = instance_path(plan, job), f'"{job.drive.unit.db.name}".unit'
    yield signal(cpu, job.key, "execute", execute_path(plan, job))
    state = Signal(job.key, "state", "integer", 16, path=f"{unit}.state", names=STATE_NAMES)
    yield state, Derived(partial(units.state, job))
    yield signal(cpu, job.key, "telegram", f"{own}.statTicket.ask.telegram")
    for name, member in _OF_UNIT.items():
        path = f"{unit}.{member}"
        kind, bits = kind_of(watch(cpu, path)[1])
        yield Signal(job.key, name, kind, bits, path=path), Derived(_while_held(cpu, path, units, job))
    for name in _MEMBERS:
        names = STATUS_TEXTS if name == "status" else {}
        yield signal(cpu, job.key, name, f"{own}.{name}", names=names)
    for use in (*job.inputs, *job.outputs):
        name = f"{use.member}_value" if use.member in _OWN else use.member
        path = f"{own}.{use.member}"
        yield signal(cpu, job.key, name, path, unit=use.parameter.unit or "", listed=use in job.outputs)


def _while_held(cpu: Cpu, path: str, units: UnitWatch, job: DriveJob) -> Callable[[], Value]:
    """A member of a unit as long as a job holds it; afterwards what it was then."""
    last: list[Value] = [0]

    def value() -> Value:
        if units.holds(job):
            last[0] = plain(cpu[path])
        return last[0]

    return value


class JobWatch:
    """One job of a run: started in the first scan, followed until done or error."""

    def __init__(self, cpu: Cpu, plan: DrivePlan, planned: DriveJob, units: UnitWatch) -> None:
        self.planned = planned
        self._path = instance_path(plan, planned)
        self.timeout = planned.timeout
        self.ending: Ending = "not started"
        self._execute = execute_path(plan, planned)
        self._cpu = cpu
        self._members: dict[str, Watched | Derived] = {name: self._watch(name) for name in ("busy", "done", "error")}
        self._members["state"] = Derived(partial(units.state, planned))
        self._record = _while_held(cpu, f'"{planned.drive.unit.db.name}".unit.recordStatus', units, planned)
        self._now: dict[str, Value] = {name: item.value() for name, item in self._members.items()}
        self._status = 0
        self._record_status = 0
        self._end = (0, 0)
        self._telegrams = self._retries = 0
        self._values: tuple[JobValue, ...] = ()

    def _watch(self, member: str) -> Watched:
        found, _ = watch(self._cpu, f"{self._path}.{member}")
        found.changed()
        return found

    def _read(self, member: str) -> Value:
        return plain(self._cpu[f"{self._path}.{member}"])

    def _number(self, member: str) -> int:
        value = self._read(member)
        return value if isinstance(value, int) else 0

    @property
    def finished(self) -> bool:
        """Whether the job has ended."""
        return self.ending in {"done", "error"}

    def begin(self) -> None:
        """Set execute."""
        self._cpu[self._execute] = True

    def after(self, scan: int, contacts: Sequence[Contact]) -> None:
        """Look at the job after a scan."""
        if self.finished:
            return
        self._telegrams += sum(contact.direction == "write" and not contact.status for contact in contacts)
        for name, item in self._members.items():
            if item.changed():
                self._now[name] = item.value()
                self._retries += name == "state" and self._now[name] == _PAUSE
        self._record()
        if self._now["done"] or self._now["error"]:
            self.ending = "error" if self._now["error"] else "done"
            self._end = scan, self._cpu.clock
            self._keep()
        elif self._now["busy"]:
            self.ending = "running"

    def _keep(self) -> None:
        """Take status and values over as they are now: the next start changes them."""
        self._status = self._number("status")
        record = self._record()
        self._record_status = record if isinstance(record, int) else 0
        errors, infos = self._read("errors"), self._read("errorInfos")
        self._values = tuple(self._value(use, errors, infos) for use in self.planned.uses)

    def _value(self, use: Use, errors: Value, infos: Value) -> JobValue:
        word = _element(errors, use.position)
        number = word & 0xFF if word & 0xFF00 == 0x8000 else None
        value: Value | None = None
        if use.writes and use.constant:
            values = [_octets(item) for item in unpack_values(use.format, use.count, use.data)]
            value = plain(values[0] if len(values) == 1 else values)
        elif use.writes or (self.finished and not word):
            value = self._read(use.member)
        parameter = use.parameter
        return JobValue(
            use.label, use.member, parameter.title, parameter.unit or "", value, number, _element(infos, use.position)
        )

    def result(self) -> JobResult:
        """How the job ended, or where it stands."""
        if not self.finished:
            self._keep()
            self._end = self._cpu.scans, self._cpu.clock
        text = STATUS_TEXTS.get(self._status, "not a status word of a job block")
        job = self.planned
        return JobResult(
            job.key,
            job.drive.key,
            self.ending,
            self._status,
            text,
            *self._end,
            self._telegrams,
            self._retries,
            self._record_status,
            self._values,
        )


def _octets(value: object) -> object:
    return value.hex(" ").upper() if isinstance(value, bytes) else value


def _element(values: Value, position: int) -> int:
    """Element of an array that counts from 1; 0 if there is none."""
    found = values[position - 1] if isinstance(values, list) and 0 < position <= len(values) else 0
    return found if isinstance(found, int) else 0
