"""Drive jobs in a recorded run: which members tell their story, when they start and how they end."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

from plcgen.ds47.messages import CODES, find
from plcgen.ds47.plan.access import Compare, Recount, Use
from plcgen.ds47.plan.nouns import DriveJob, DrivePlan
from plcgen.ds47.sim.awaited import let_come
from plcgen.ds47.sim.drive import Drive
from plcgen.ds47.wire.codec import TelegramError, decode_request
from plcgen.ds47.wire.errors import error_text
from plcgen.ds47.wire.formats import unpack_values
from plcgen.ds47.wire.model import RequestId
from plcgen.ds47.wire.status import explain_status
from plcgen.ds47.words import CHANNEL_STATES, ERROR_DEVIATES, STATUS_WORDS
from plcgen.report.trace.face import JobEnd, JobFacts, JobInput, Observed
from plcgen.report.trace.model import Contact, JobValue, Signal, Value
from plcgen.report.trace.recorder import Derived, recorded_kind, recorded_value, signal, watch
from plcgen.report.trace.values import input_members
from plcgen.s7.cpu.cpu import Cpu

_WAITING = 1 + max(number for _, number, _ in CHANNEL_STATES)
STATE_NAMES = {number: name.removeprefix("STATE_") for name, number, _ in CHANNEL_STATES} | {_WAITING: "WAITING"}
"""States of a job: those of the channel while it holds the unit, IDLE, and waiting for its turn."""
STATUS_TEXTS = {number: text for _, number, text in STATUS_WORDS}
_PAUSE = next(number for name, number, _ in CHANNEL_STATES if name == "STATE_PAUSE")
_TICKETS = 100_000
"""A grant is the slot times this, plus the number under which the job asks."""

_MEMBERS = ("busy", "done", "error", "status")
_RESULTS = ("errors", "errorInfos")
_OF_UNIT = {"retries": "retries", "reference": "telegram[0]", "recordStatus": "recordStatus"}
"""What a job shows of its unit while it holds it."""
_LISTED = 4
"""Deviations that are shown."""
_ENTRY = ("parameter", "index", "wanted", "found")
"""Of each of them."""
_OWN = frozenset({"execute", "state", "telegram", *_MEMBERS, *_RESULTS, *_OF_UNIT})
"""Names of signals that a value may have too: not all of them are names at the interface of the block."""


def execute_path(job: DriveJob) -> str:
    """Where a job is started: its flag, or the member of the control DB."""
    flag = job.trigger.execute
    return str(flag) if flag is not None else f'"{job.caller.control.name}".{job.member}.execute'


def instance_path(job: DriveJob) -> str:
    """Where the instance of a job lies."""
    return f'"{job.caller.instance.name}".{job.member}'


def diagnosis_path(job: DriveJob) -> str:
    """Where it is told why a job failed."""
    return f'"{job.caller.control.name}".{job.member}.diagnosis'


class UnitWatch:
    """The units of a run: which job holds each of them."""

    def __init__(self, cpu: Cpu, plan: DrivePlan) -> None:
        self._cpu, self._plan = cpu, plan
        self._grants = {unit.key: watch(cpu, f'"{unit.db.name}".unit.turn.grant')[0] for unit in plan.units}
        self._channels = {
            f"{caller.instance.name}.{unit.member}".upper(): unit.key
            for caller in plan.callers
            for unit in plan.channels(caller)
        }
        self._jobs = {(job.drive.unit.key, job.slot): job.key for job in plan.jobs}

    def slot(self, unit: str) -> int:
        """The slot that holds a unit, 0 if none does."""
        grant = self._grants[unit].value()
        return grant // _TICKETS if isinstance(grant, int) else 0

    def holds(self, job: DriveJob) -> bool:
        """Whether a job holds its unit."""
        return self.slot(job.drive.unit.key) == job.slot

    def job_of(self, instance: str) -> str | None:
        """Key of the job for which an instance of WRREC or RDREC works; None if it belongs to none."""
        unit = self._channels.get(instance.rpartition(".")[0].upper())
        return None if unit is None else self._jobs.get((unit, self.slot(unit)))

    def let_come(self, address: int, partner: Drive) -> None:
        """The drive at an address is asked: what a job waits for that holds its unit is there."""
        for job in self._plan.jobs:
            if job.waits and job.drive.id_value == address and self.holds(job):
                step = self._cpu[f"{instance_path(job)}.statStep"]
                let_come(partner.objects[job.drive.drive_object], job, step if isinstance(step, int) else 0)

    def state(self, job: DriveJob) -> int:
        """State of a job, see STATE_NAMES."""
        if not self._cpu[f"{instance_path(job)}.busy"]:
            return 0
        found = self._cpu[f'"{job.drive.unit.db.name}".unit.state'] if self.holds(job) else _WAITING
        return found if isinstance(found, int) else 0

    def signals(self) -> Iterator[Observed]:
        """Which job holds which unit."""
        for unit in self._plan.units:
            names = {0: "", **{job.slot: job.key for job in self._plan.jobs if job.drive.unit is unit}}
            path = f'"{unit.db.name}".unit.turn.grant'
            yield (
                Signal(unit.db.name, "owner", "integer", 16, path=path, names=names),
                Derived(partial(self.slot, unit.key)),
            )


def job_signals(cpu: Cpu, job: DriveJob, units: UnitWatch) -> Iterator[Observed]:
    """Signals of a job: start, state, outputs; its values are listed by the text report."""
    own, unit = instance_path(job), f'"{job.drive.unit.db.name}".unit'
    yield signal(cpu, job.key, "execute", execute_path(job))
    state = Signal(job.key, "state", "integer", 16, path=f"{unit}.state", names=STATE_NAMES)
    yield state, Derived(partial(units.state, job))
    yield signal(cpu, job.key, "telegram", f"{own}.statTicket.ask.telegram")
    for name, member in _OF_UNIT.items():
        path = f"{unit}.{member}"
        kind, bits = recorded_kind(watch(cpu, path)[1])
        yield Signal(job.key, name, kind, bits, path=path), Derived(_while_held(cpu, path, units, job))
    for name in _MEMBERS:
        names = STATUS_TEXTS if name == "status" else {}
        yield signal(cpu, job.key, name, f"{own}.{name}", names=names)
    for name in _RESULTS:
        yield signal(cpu, job.key, name, f"{diagnosis_path(job)}.{name}")
    if job.messages is not None:
        yield signal(cpu, job.key, job.messages.count, f"{own}.{job.messages.count}", listed=True)
    if job.deviations is not None:
        found = job.deviations
        entries = (f"{found.member}[{n}].{name}" for n in range(1, min(found.places, _LISTED) + 1) for name in _ENTRY)
        for name in (found.count, found.equal, *entries):
            yield signal(cpu, job.key, name, f"{own}.{name}", listed=True)
    for use in (*job.inputs, *job.outputs, *(use for use in job.uses if use.recorded)):
        name = f"{use.member}_value" if use.member in _OWN else use.member
        path = f"{own}.{value_path(job, use)}"
        yield signal(cpu, job.key, name, path, unit=use.parameter.unit or "", listed=use in job.outputs)
    for _, one in job.shown:
        yield signal(cpu, job.key, one.member, f"{own}.{one.member}", listed=True)


def _while_held(cpu: Cpu, path: str, units: UnitWatch, job: DriveJob) -> Callable[[], Value]:
    """A member of a unit as long as a job holds it; afterwards what it was then."""
    last: list[Value] = [0]

    def value() -> Value:
        if units.holds(job):
            last[0] = recorded_value(cpu[path])
        return last[0]

    return value


class DriveJobWatch:
    """One job of a run."""

    def __init__(self, cpu: Cpu, plan: DrivePlan, planned: DriveJob, units: UnitWatch) -> None:
        own = instance_path(planned)
        self._cpu, self._plan, self._planned, self._units, self._path = cpu, plan, planned, units, own
        self._diagnosis = diagnosis_path(planned)
        self.facts = JobFacts(
            planned.key,
            planned.drive.key,
            planned.timeout,
            execute_path(planned),
            {name: f"{own}.{name}" for name in ("busy", "done", "error", "status")},
            STATUS_TEXTS,
        )
        self._state = Derived(partial(units.state, planned))
        self._state.changed()
        self._record = _while_held(cpu, f'"{planned.drive.unit.db.name}".unit.recordStatus', units, planned)
        self._sent: dict[int, bytearray] = {}

    def inputs(self) -> Iterator[JobInput]:
        """Values of parameters with what the catalogue knows of them, then what else the kind takes."""
        job = self._planned
        known = {use.member: use for use in job.inputs}
        commands = f'"{job.caller.control.name}".{job.member}'
        for member, comment in input_members(self._cpu, job.block.name, commands):
            path, use = f"{commands}.{member}", known.get(member)
            if use is None:
                yield JobInput(path, comment)
                continue
            one, bit = use.parameter, use.bit is not None
            limits = (None, None) if bit else (one.minimum, one.maximum)
            yield JobInput(path, f"{use.label} {one.title}", one.unit or "", *limits, {} if bit else one.values)

    def signals(self) -> Iterator[Observed]:
        """Start, state, outputs and values."""
        yield from job_signals(self._cpu, self._planned, self._units)

    def after(self) -> bool:
        """Whether a pause began, which every retry does with."""
        self._record()
        return self._state.changed() and self._state.value() == _PAUSE

    def sends(self, contact: Contact) -> bool:
        """Whether the drive took a request; what was written with it is kept for the end."""
        taken = contact.direction == "write" and not contact.status
        if taken:
            self._keep_sent(contact.data)
        return taken

    def _keep_sent(self, request: bytes) -> None:
        """The request may lie in a data block of the user's: what is planned is only its start value."""
        try:
            found = decode_request(request)
        except TelegramError:
            return
        if found.request_id != RequestId.CHANGE:
            return
        number = self._cpu[f"{self._path}.statTicket.ask.telegram"]
        parts = next((one.parts for one in self._planned.telegrams if one.number == number), ())
        for part, address, block in zip(parts, found.addresses, found.values, strict=False):
            use, same = part.use, (address.pnu, address.subindex) == (part.use.parameter.pnu, part.subindex)
            again = self._planned.restores and use.position in self._sent  # old values, written back
            if use.writes and same and len(block.data) == part.size and not again:
                at = part.start * use.format.size
                self._sent.setdefault(use.position, bytearray(use.data))[at : at + part.size] = block.data

    def end(self, *, finished: bool) -> JobEnd:
        """STATUS of the last record call while the job had the unit, and every parameter."""
        record = self._record()
        number = record if isinstance(record, int) else 0
        found = explain_status(number)
        errors, infos = (recorded_value(self._cpu[f"{self._diagnosis}.{name}"]) for name in _RESULTS)
        values = tuple(self._value(use, errors, infos, finished=finished) for use in self._planned.uses)
        if finished:
            self._sent.clear()
        return JobEnd(number, found.text if found.error else "", values)

    def _value(self, use: Use, errors: Value, infos: Value, *, finished: bool) -> JobValue:
        word, info = _element(errors, use.position), _element(infos, use.position)
        number = word & 0xFF if word & 0xFF00 == 0x8000 else None
        value: Value | None = None
        if use.bits:
            value = None  # what the word is besides its bits, the old one says
        elif use.constant or use.position in self._sent:
            sent = bytes(self._sent.get(use.position, use.data))
            values = [_octets(item) for item in unpack_values(use.format, use.count, sent)]
            value = recorded_value(values[0] if len(values) == 1 else values)
        elif not use.as_(Recount) and (use.supplied or (finished and word in {0, ERROR_DEVIATES})):
            value = recorded_value(self._cpu[f"{self._path}.{value_path(self._planned, use)}"])
        parameter = use.parameter
        text = error_text(number).explain(info) if number is not None else ""
        return JobValue(
            use.label, use.member, parameter.title, parameter.unit or "", value, number, info, text,
            _meaning(self._planned, use, value),
        )  # fmt: skip


def _meaning(job: DriveJob, use: Use, value: Value | None) -> str:
    """What the lists of the drive call the messages whose numbers were read, or the value of a parameter."""
    whole = [one for one in (value if isinstance(value, list) else [value]) if type(one) is int]
    kind = CODES.get(use.parameter.pnu)
    if kind is None:
        named = {number: name for name, number in use.parameter.values.items()}
        return named.get(whole[0], "") if len(whole) == 1 and not use.bits and use.bit is None else ""
    told = {number: find(number, job.drive.device.messages, kind) for number in whole if number}
    titles = {number: " / ".join(dict.fromkeys(one.title for one in found)) for number, found in told.items()}
    return "; ".join(f"{kind}{number:05} {title}" for number, title in titles.items() if title)


def value_path(job: DriveJob, use: Use) -> str:
    """Where an instance has a value; of a time as it is sent, of messages and records as they came or are sent."""
    if use in job.timed:
        return f"statRequest.{use.member}"
    if job.messages is None and not use.recorded:
        return use.member
    number = next(one.number for one in job.telegrams if one.parts[-1].use.position >= use.position)
    view = "Request" if use.writes else "WantedView" if use.as_(Compare) else "Response"
    return f"stat{view}{number if len(job.telegrams) > 1 else ''}.{use.member}"


def _octets(value: object) -> object:
    return value.hex(" ").upper() if isinstance(value, bytes) else value


def _element(values: Value, position: int) -> int:
    """Element of an array that counts from 1; 0 if there is none."""
    found = values[position - 1] if isinstance(values, list) and 0 < position <= len(values) else 0
    return found if isinstance(found, int) else 0
