"""Recorded runs of PPI masters: the stations on their lines, the jobs, and every frame."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from copy import copy
from functools import partial
from pathlib import Path

from plcgen.base.diagnostics import DiagnosticError, Report
from plcgen.base.files.options import usage
from plcgen.base.files.text import read_text
from plcgen.base.files.validation import FileShape, StrictModel, load_document
from plcgen.base.telegrams.decoded import DecodedTelegram
from plcgen.ppi.plan.nouns import PlannedMaster, PpiJob, PpiPlan, PpiValue
from plcgen.ppi.sim import Bus, Fault, Station, Traffic
from plcgen.ppi.sim.faults import KINDS, FaultKeys, parse_fault
from plcgen.ppi.sim.load import load_bus, set_address
from plcgen.ppi.sim.memory import decode_value
from plcgen.ppi.texts import StreamPiece, TrafficText, decode_pieces
from plcgen.ppi.wire.address import address_text
from plcgen.ppi.wire.areas import Area
from plcgen.ppi.wire.codes import return_code, return_codes
from plcgen.ppi.wire.fdl import SD2
from plcgen.ppi.wire.model import FixedFrame, VariableFrame
from plcgen.ppi.words import DRAIN_MS, STATES, STATUS_WORDS
from plcgen.report.trace.face import FaultKind, JobEnd, JobFacts, JobInput, Observed, PartnerOptions, PartnerValue
from plcgen.report.trace.faults import fault_kinds
from plcgen.report.trace.model import CallShape, Contact, Direction, JobValue, Signal, Value
from plcgen.report.trace.recorder import Derived, RecordingCpu, recorded_value, signal
from plcgen.report.trace.settings import FAULTS_SHAPE, with_faults_key
from plcgen.s7.cpu.cpu import Cpu
from plcgen.s7.cpu.system.port import UNSET, Periphery, Port, PortSettings
from plcgen.s7.types.values import pack_value, unpack_value

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
            size = value.size
            found = [
                bool(value.data[0])
                if value.bit
                else recorded_value(unpack_value(value.data[n : n + size], value.element))
                for n in range(0, value.count * size, size)
            ]
            shown = found[0] if len(found) == 1 else recorded_value(found)
        elif self._job.kind == "write" or (finished and code is None):
            shown = recorded_value(self._cpu[self._path(value.member)])
        text = f"{code:02X}h {return_code(code).text}" if code is not None else ""
        return JobValue(value.label, value.member, value.title, "", shown, code, 0, text)


class LineFaults(StrictModel):
    """A file of faults."""

    faults: tuple[FaultKeys, ...]


_FILE = FileShape(LineFaults, "the file", FAULTS_SHAPE, prepare=with_faults_key)


def read_faults(texts: Sequence[str], file: Path | None) -> list[Fault]:
    """Faults of the command line and of a YAML file. Raises DiagnosticError with every problem."""
    report = Report()
    faults: list[Fault] = []
    for text in texts:
        with report.catch():
            faults.append(parse_fault(text))
    if file is not None:
        with report.catch():
            faults += [keys.fault() for keys in load_document(read_text(file), str(file), _FILE).model.faults]
    if report.diagnostics:
        raise DiagnosticError(report.diagnostics)
    return faults


class PpiRecording:
    """What can be recorded of masters and jobs."""

    faults = tuple(kind.value for kind in KINDS)
    fault = "silence"
    drain = DRAIN_MS
    words = ("module call", "station")

    def __init__(self, plan: PpiPlan) -> None:
        self.plan = plan
        self.jobs = tuple(plan.key(master, job) for master in plan.masters for job in master.jobs)
        self.partners = tuple(master.key for master in plan.masters)
        self.constants: dict[str, int] = {}
        self.controls = [plan.control_db.name]
        self.calls: tuple[CallShape, ...] = (
            CallShape("SEND_P2P", "DONE", 16),
            CallShape("RECEIVE_P2P", "NDR", 16, answers=True),
        )
        if plan.target.classic:
            self.calls = CallShape("P_SND_RK", "DONE", 16), CallShape("P_RCV_RK", "NDR", 16, answers=True)
        self._traffic: list[tuple[PlannedMaster, Traffic]] = []
        self._lines: dict[str, Bus] = {}

    def connect(self, bus: Periphery, options: PartnerOptions) -> None:
        """A line with its stations at every port. Raises DiagnosticError."""
        faults = read_faults(options.faults, options.fault_file)
        files = self._files(options.files)
        for master in self.plan.masters:
            path = files.get(master.key) or files.get("")
            line = _line(master) if path is None else load_bus(read_text(path), str(path))
            line.faults += map(copy, faults)
            self._lines[master.key] = line
            line.listener = partial(self._hear, master)
            hardware = PortSettings(baud=master.baud) if self.plan.target.classic else UNSET
            bus.ports[master.port] = Port(peer=line, line_baud=master.baud, hardware=hardware)

    @property
    def kinds(self) -> tuple[FaultKind, ...]:
        """On every line, or of one station."""
        stations = {str(one.address): one.key for master in self.plan.masters for one in master.stations}
        codes = [(f"16#{code:02X}", meaning.text) for code, meaning in return_codes().items() if code != 0xFF]
        return fault_kinds(FaultKeys, KINDS, {"code": codes, "station": list(stations.items())})

    def contents(self) -> Iterator[PartnerValue]:
        """Every address that a job accesses: ``line/2:VW100``."""
        seen = set[str]()
        for master in self.plan.masters:
            for job in master.jobs:
                station = self._lines[master.key].stations.get(job.station.address)
                for value in job.values if station is not None else ():
                    name = f"{master.key}/{job.station.address}:{address_text(value.item)}"
                    if name not in seen and station is not None:
                        seen.add(name)
                        found = decode_value(value.item, station.cpu.memory.read(value.item).data)
                        text = found.hex(" ").upper() if isinstance(found, bytes) else str(found)
                        yield PartnerValue(name, f"{job.station.key} {value.title}".strip(), "", text)

    def put(self, text: str) -> bool:
        """``line/2:VW100=5``. Raises DiagnosticError."""
        key, slash, rest = text.partition("/")
        if not slash or key not in self._lines:
            return False
        set_address(self._lines[key], rest)
        return True

    def strike(self, fault: str) -> list[Fault]:
        """On every line. Raises DiagnosticError."""
        struck: list[Fault] = []
        for line in self._lines.values():
            fresh = read_faults([fault], None)
            line.faults += fresh
            struck += fresh
        return struck

    def attach(self, cpu: RecordingCpu) -> RecordedMasters:
        """Watch masters and jobs."""
        return RecordedMasters(cpu, self.plan, self._traffic)

    def _hear(self, master: PlannedMaster, entry: Traffic) -> None:
        self._traffic.append((master, entry))

    def _files(self, texts: Sequence[str]) -> dict[str, Path]:
        chosen: dict[str, Path] = {}
        for text in texts:
            key, equals, path = text.partition("=")
            own = bool(equals) and key in self.partners
            key, path = (key, path) if own else ("", text)
            if key in chosen:
                raise usage(f"--drive {text}", "there is a file for this line already", "write MASTER=FILE for each")
            chosen[key] = Path(path)
        return chosen


def _line(master: PlannedMaster) -> Bus:
    """The stations of a master with something to read: values that differ."""
    stations = {s.address: Station(s.profile.key, s.address, frame_count="strict") for s in master.stations}
    for job in master.jobs:
        for value in job.outputs:
            memory = stations[job.station.address].cpu.memory
            if not any(memory.read(value.item).data) and (data := _content(value)):  # addresses may overlap
                memory.put(value.item, data)
    return Bus(stations.values())


def _content(value: PpiValue) -> bytes:
    """Wire bytes of an address: numbers that count, and every bit TRUE; empty if its type has no such value."""
    if value.bit:
        return b"\x01"
    name = value.element.name
    if value.item.area == Area.SYS or name not in _NUMBERS:
        return b""
    octets = bytearray(value.item.octets)
    for number in range(value.count):
        end = (number + 1) * value.stride
        content = pack_value(value.number + number + (0.5 if name == "REAL" else 0), value.element)
        octets[end - value.size : end] = content
    return bytes(octets)


_NUMBERS = frozenset({"BYTE", "WORD", "DWORD", "INT", "DINT", "UINT", "UDINT", "USINT", "SINT", "REAL"})


class RecordedMasters:
    """Masters and jobs on a CPU; every frame on their lines is a contact."""

    def __init__(self, cpu: RecordingCpu, plan: PpiPlan, traffic: list[tuple[PlannedMaster, Traffic]]) -> None:
        self._cpu, self._traffic = cpu, traffic
        self._masters = {master.key: MasterWatch(cpu, plan, master) for master in plan.masters}
        self._jobs = {plan.key(master, job): (master, job) for master in plan.masters for job in master.jobs}
        own = [(master.instance.name, master) for master in plan.masters]
        own += [(block.name, master) for master in plan.masters for block in master.module_instances or ()]
        self._instances = {name.upper(): self._masters[master.key] for name, master in own}
        self._words = {master.key: TrafficText() for master in plan.masters}
        self._stations = {master.key: {s.address: s.key for s in master.stations} for master in plan.masters}
        self._asked: dict[str, tuple[str, bytes]] = {}

    def job(self, key: str) -> PpiJobWatch:
        """One job."""
        master, job = self._jobs[key]
        return PpiJobWatch(self._cpu, self._masters[master.key], job)

    def signals(self) -> Iterator[Observed]:
        """Who has which port."""
        for master in self._masters.values():
            yield from master.signals()

    def job_of(self, instance: str) -> str | None:
        """The job that has the port of a master, or had it last."""
        found = self._instances.get(instance.split(".", 1)[0].upper())
        return None if found is None else found.last or None

    def take(self) -> tuple[Contact, ...]:
        """Frames since the last time."""
        found = tuple(self._contact(master, entry) for master, entry in self._traffic)
        self._traffic.clear()
        return found

    def _contact(self, master: PlannedMaster, entry: Traffic) -> Contact:
        key, frame = master.key, entry.frame
        text = self._words[key].words(entry)
        if entry.direction == ">":
            station, asked = self._asked.get(key, ("", b""))
            if isinstance(frame, FixedFrame | VariableFrame):
                station = self._stations[key].get(frame.destination, f"station {frame.destination}")
            asked = entry.data if isinstance(frame, VariableFrame) else asked
            self._asked[key] = station, asked
            telegram = _decoded(entry)
        else:
            station, asked = self._asked.get(key, ("", b""))
            telegram = _decoded(entry, asked if isinstance(frame, VariableFrame) else b"")
            text += f" (fault: {entry.note})" if entry.note else ""
        direction: Direction = "write" if entry.direction == ">" else "read"
        group = self._masters[key].last or key
        return Contact(group, station, direction, 0, 0, entry.data, asked, text, telegram)


def _decoded(entry: Traffic, request: bytes = b"") -> DecodedTelegram:
    pieces = [StreamPiece(0, request, telegram=True)] if request else []
    return decode_pieces([*pieces, StreamPiece(0, entry.data, telegram=entry.frame is not None)])[-1].table
