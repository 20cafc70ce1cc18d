"""The jobs of a project in a run: which members tell their story, when they start and how they end."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from plcgen.cpu.cpu import Cpu
from plcgen.protocols.ds47.plan.nouns import DriveJob, DrivePlan, Use
from plcgen.protocols.ds47.wire.formats import unpack_values
from plcgen.protocols.ds47.words import STATES, STATUS_WORDS
from plcgen.trace.model import Contact, Ending, JobResult, JobValue, Signal, Value
from plcgen.trace.recorder import Watched, plain, signal, watch

STATE_NAMES = {number: name.removeprefix("STATE_") for name, number, _ in STATES}
STATUS_TEXTS = {number: text for _, number, text in STATUS_WORDS}
_WAIT = next(number for name, number, _ in STATES if name == "STATE_WAIT")

_MEMBERS = (
    ("state", "diagnostics.state"),
    ("telegram", "diagnostics.telegram"),
    ("retries", "diagnostics.retries"),
    ("reference", "diagnostics.requestReference"),
    ("busy", "busy"),
    ("done", "done"),
    ("error", "error"),
    ("status", "status"),
    ("recordStatus", "diagnostics.recordStatus"),
    ("errors", "errors"),
    ("errorInfos", "errorInfos"),
)
_OWN = frozenset({"execute", *(name for name, _ in _MEMBERS)})
"""Names of signals that a value may have too: not all of them are names at the interface of the block."""


def execute_path(plan: DrivePlan, job: DriveJob) -> str:
    """Where a job is started: its flag, or the member of the control DB."""
    flag = job.trigger.execute
    return str(flag) if flag is not None else f'"{plan.control_db.name}".{job.member}.execute'


def job_signals(cpu: Cpu, plan: DrivePlan, job: DriveJob) -> Iterator[tuple[Signal, Watched]]:
    """Signals of a job: start, state, outputs; its values are listed by the text report."""
    yield signal(cpu, job.key, "execute", execute_path(plan, job))
    for name, member in _MEMBERS:
        names = STATE_NAMES if name == "state" else STATUS_TEXTS if name == "status" else {}
        yield signal(cpu, job.key, name, f'"{job.instance.name}".{member}', names=names)
    for use in (*job.inputs, *job.outputs):
        path = f'"{job.instance.name}".{use.member}'
        name = f"{use.member}_value" if use.member in _OWN else use.member
        yield signal(cpu, job.key, name, path, unit=use.parameter.unit or "", listed=not job.writes)


def token_signals(cpu: Cpu, plan: DrivePlan) -> Iterator[tuple[Signal, Watched]]:
    """Which job owns which drive; the last request reference."""
    for token, drives in plan.tokens:
        owners = {job.owner: job.key for job in plan.jobs if job.drive in drives}
        yield signal(cpu, token.name, "owner", f'"{token.name}".owner', names={0: "", **owners})
        yield signal(cpu, token.name, "requestReference", f'"{token.name}".requestReference')


class JobWatch:
    """One job of a run: started in the first scan, followed until done or error."""

    def __init__(self, cpu: Cpu, plan: DrivePlan, planned: DriveJob) -> None:
        self.planned = planned
        self.timeout = planned.timeout
        self.ending: Ending = "not started"
        self._execute = execute_path(plan, planned)
        self._cpu = cpu
        self._members = {name: self._watch(name) for name in ("busy", "done", "error", "diagnostics.state")}
        self._now: dict[str, Value] = {name: item.value() for name, item in self._members.items()}
        self._status = 0
        self._record_status = 0
        self._end = (0, 0)
        self._telegrams = self._retries = 0
        self._values: tuple[JobValue, ...] = ()

    def _watch(self, member: str) -> Watched:
        found, _ = watch(self._cpu, f'"{self.planned.instance.name}".{member}')
        found.changed()
        return found

    def _read(self, member: str) -> Value:
        return plain(self._cpu[f'"{self.planned.instance.name}".{member}'])

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
                self._retries += name == "diagnostics.state" and self._now[name] == _WAIT
        if self._now["done"] or self._now["error"]:
            self.ending = "error" if self._now["error"] else "done"
            self._end = scan, self._cpu.clock
            self._keep()
        elif self._now["busy"]:
            self.ending = "running"

    def _keep(self) -> None:
        """Take status and values over as they are now: the next start changes them."""
        self._status = self._number("status")
        self._record_status = self._number("diagnostics.recordStatus")
        errors, infos = self._read("errors"), self._read("errorInfos")
        self._values = tuple(self._value(use, errors, infos) for use in self.planned.uses)

    def _value(self, use: Use, errors: Value, infos: Value) -> JobValue:
        word = _element(errors, use.position)
        number = word & 0xFF if word & 0x8000 else None
        value: Value | None = None
        if self.planned.writes and use.constant:
            values = [_octets(item) for item in unpack_values(use.format, use.count, use.data)]
            value = plain(values[0] if len(values) == 1 else values)
        elif self.planned.writes or self.ending == "done":
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
