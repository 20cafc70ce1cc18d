"""Jobs of a PPI master in a recorded run: which members tell their story, when they start and how they end."""

from __future__ import annotations

from collections.abc import Iterator

from plcgen.ppi.plan.nouns import PlannedMaster, PpiJob, PpiPlan, PpiValue
from plcgen.ppi.wire.codes import return_code
from plcgen.ppi.wire.fdl import SD2
from plcgen.ppi.words import STATES, STATUS_WORDS
from plcgen.report.trace.face import JobEnd, JobFacts, JobInput, Observed
from plcgen.report.trace.model import Contact, JobValue, Signal, Value
from plcgen.report.trace.recorder import Derived, recorded_value, signal
from plcgen.s7.cpu.cpu import Cpu
from plcgen.s7.types.values import unpack_value

_WAITING = 1 + max(number for _, number, _ in STATES)
STATE_NAMES = {number: name.removeprefix("STATE_") for name, number, _ in STATES} | {_WAITING: "WAITING"}
"""States of a job: those of the block while it has the port, IDLE, and waiting for its turn."""
STATUS_TEXTS = {number: text for _, number, text in STATUS_WORDS}
_MEMBERS = ("busy", "done", "error", "status")
_ERROR = 0x8000


class MasterWatch:
    """One master of a run: which job has its port."""

    def __init__(self, cpu: Cpu, plan: PpiPlan, master: PlannedMaster) -> None:
        self._cpu, self.plan, self.master = cpu, plan, master
        self._keys = {job.number: plan.key(master, job) for job in master.jobs}

    def number(self, member: str) -> int:
        """A number of the block."""
        value = self._cpu[f'"{self.master.instance.name}".{member}']
        return value if isinstance(value, int) else 0

    @property
    def owner(self) -> int:
        """Number of the job that has the port, 0 if none has."""
        return self.number("statJob") if self.number("statState") else 0

    @property
    def last(self) -> str:
        """The job that has the port or had it last; empty if there was none."""
        return self._keys.get(self.number("statJob"), "")

    def state(self, job: PpiJob) -> int:
        """State of a job, see STATE_NAMES."""
        if not self._cpu[f'"{self.master.instance.name}".{job.pin("busy")}']:
            return 0
        return self.number("statState") if self.owner == job.number else _WAITING

    def signals(self) -> Iterator[Observed]:
        """Which job has the port."""
        path = f'"{self.master.instance.name}".statJob'
        names = {0: "", **self._keys}
        owner = Signal(self.master.instance.name, "owner", "integer", 16, path=path, names=names)
        yield owner, Derived(lambda: self.owner)


class PpiJobWatch:
    """One job of a run."""

    def __init__(self, cpu: Cpu, watch: MasterWatch, job: PpiJob) -> None:
        plan, master = watch.plan, watch.master
        flag = job.trigger.execute
        member = f'"{plan.control_db.name}".{job.member}.execute'
        self._cpu, self._watch, self._job = cpu, watch, job
        self.facts = JobFacts(
            plan.key(master, job),
            job.station.key,
            job.timeout,
            member if flag is None else str(flag),
            {name: self._path(name) for name in _MEMBERS},
            STATUS_TEXTS,
        )
        self._telegrams = {telegram.number: number for number, telegram in enumerate(job.telegrams, 1)}
        self._kept = {"statTelegram": 0, "statRetries": 0}
        self._retries = 0

    def _path(self, pin: str) -> str:
        return f'"{self._watch.master.instance.name}".{self._job.pin(pin)}'

    def inputs(self) -> Iterator[JobInput]:
        """What it writes, as the control DB has it."""
        for value in self._job.inputs:
            path = f'"{self._watch.plan.control_db.name}".{self._job.member}.{value.member}'
            yield JobInput(path, value.title or value.label)

    def signals(self) -> Iterator[Observed]:
        """Start, state, outputs and values."""
        key, watch, job = self.facts.key, self._watch, self._job
        block = f'"{watch.master.instance.name}"'
        yield signal(self._cpu, key, "execute", self.facts.execute)
        state = Signal(key, "state", "integer", 16, path=f"{block}.statState", names=STATE_NAMES)
        yield state, Derived(lambda: watch.state(job))
        telegram = Signal(key, "telegram", "integer", 16, path=f"{block}.statTelegram")
        yield telegram, Derived(lambda: self._telegrams.get(self._held("statTelegram"), 0))
        yield (
            Signal(key, "retries", "integer", 16, path=f"{block}.statRetries"),
            Derived(lambda: self._held("statRetries")),
        )
        for name in _MEMBERS:
            names = STATUS_TEXTS if name == "status" else {}
            yield signal(self._cpu, key, name, self.facts.pins[name], names=names)
        if job.values:
            yield signal(self._cpu, key, "errors", self._path("errors"))
        taken = {*_MEMBERS, "execute", "state", "telegram", "retries", "errors"}
        for value in (*job.inputs, *job.outputs):
            name = f"{value.member}_value" if value.member in taken else value.member
            yield signal(self._cpu, key, name, self._path(value.member), listed=value in job.outputs)

    def _held(self, member: str) -> int:
        """A number of the block as long as the job has the port; afterwards what it was then."""
        if self._watch.owner == self._job.number:
            self._kept[member] = self._watch.number(member)
        return self._kept[member]

    def after(self) -> bool:
        """Whether a repetition of the telegram began."""
        before, self._retries = self._retries, self._held("statRetries")
        return self._retries > before

    def sends(self, contact: Contact) -> bool:
        """Whether a frame is a request with a PDU: polls and acknowledgements do not count."""
        return contact.direction == "write" and contact.data[:1] == bytes((SD2,))

    def end(self, *, finished: bool) -> JobEnd:
        """STATUS of the module's block that failed last, and every address."""
        errors = recorded_value(self._cpu[self._path("errors")]) if self._job.values else []
        values = tuple(self._value(value, errors, finished=finished) for value in self._job.values)
        failed = self._watch.number("statModuleStatus")
        return JobEnd(failed, "see the manual of the module" if failed & _ERROR else "", values)

    def _value(self, value: PpiValue, errors: Value, *, finished: bool) -> JobValue:
        word = errors[value.position - 1] if isinstance(errors, list) else 0
        code = word & 0xFF if isinstance(word, int) and word & _ERROR else None
        shown: Value | None = None
        if value.constant:
            shown = _constant(value)
        elif self._job.kind == "write" or (finished and code is None):
            shown = recorded_value(self._cpu[self._path(value.member)])
        text = f"{code:02X}h {return_code(code).text}" if code is not None else ""
        return JobValue(value.label, value.member, value.title, "", shown, code, 0, text)


def _constant(value: PpiValue) -> Value:
    size = value.size
    found = [
        bool(value.data[0]) if value.bit else recorded_value(unpack_value(value.data[n : n + size], value.element))
        for n in range(0, value.count * size, size)
    ]
    return found[0] if len(found) == 1 else recorded_value(found)
