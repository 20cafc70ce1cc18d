"""A master from disk against the statement of its spec: stations record what comes and answer from the statement.

What is expected comes from ``oracles.spec`` alone. The plan is asked for the name of the instance and where the spec
stands, for nothing else.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from plcgen.base.diagnostics import Diagnostic, DiagnosticError
from plcgen.oracles.spec.place import Keys
from plcgen.oracles.spec.ppi import statement as spec
from plcgen.oracles.spec.ppi.statement import PpiStatement, StatedAddress, StatedPort
from plcgen.oracles.spec.ppi.stations import AnsweringMemory, Number, RecordingLine, to_number
from plcgen.ppi.plan.nouns import PlannedMaster, PpiPlan
from plcgen.project.spec import LoadedSpec
from plcgen.proof.rig import layout_of
from plcgen.proof.scenario import ScenarioError
from plcgen.s7.cpu.cpu import Cpu
from plcgen.s7.cpu.program import Program
from plcgen.s7.cpu.system.port import CHARACTER_BITS, UNSET, Periphery, Port, PortSettings
from plcgen.s7.layout.image import Tree
from plcgen.s7.layout.shapes import Field
from plcgen.s7.types.data_types import ArrayType, Elementary

PAGE = "docs/verify.md says what is compared with the spec"
CONTROL = "PpiJobs"
"""The data block with commands and results (docs/ppi-master.md)."""
SIGNALS = ("execute", "busy", "done", "error", "status")
ERRORS = "errors"
STEP = 5
"""Milliseconds of a scan where no time is measured; a cycle of OB1 is longer, or else as long as it may be."""
MARGIN = 60
"""Milliseconds before an awaited moment from which on scans take 1 ms: a request of 33 bytes lasts 38."""


def ports_of(loaded: LoadedSpec) -> dict[str, StatedPort]:
    """The statement of every master of a spec, by key. Raises NotStatedError."""
    data = loaded.root.data()
    tables = {
        name: (Path(loaded.file).parent / name).read_bytes()
        for master in data["ppi"].values()
        for station in master["stations"].values()
        if isinstance(name := station.get("symbols"), str)
    }
    return {port.key: port for port in spec.stated_ports(data, tables)}


@dataclass(frozen=True)
class JobMembers:
    """Where the program from disk has signals and values of a job: paths; ``span`` are its bytes in the control DB."""

    signals: Mapping[str, str]
    values: tuple[str, ...]
    errors: str
    span: tuple[int, int]


class StatedBed:
    """The whole program on a CPU of its own; a port leads to stations that record."""

    def __init__(self, plan: PpiPlan, program: Program, master: PlannedMaster, ports: Mapping[str, StatedPort]) -> None:
        self.loaded, self.program, self.port = plan.loaded, program, ports[master.key]
        self.jobs = self.port.jobs
        self.control = plan.loaded.spec.plc.prefix + CONTROL
        self.instance = master.instance.name
        self.line = RecordingLine({address: AnsweringMemory() for address in self.port.stations.values()})
        hardware = PortSettings(baud=self.port.baud) if self.port.classic else UNSET
        self.module = Port(peer=self.line, line_baud=self.port.baud, hardware=hardware)
        self.cpu = Cpu(program, Periphery(ports={self.port.port: self.module}))
        self.draw = random.Random(self.port.key)  # noqa: S311 - test values
        self.step = min(STEP, self.port.ob1_cycle)
        structures = self._structures(ports)
        self.members = {job.key: self._members(job, structures.get(job.path)) for job in self.jobs}
        self._started = [
            f'"{self.control}".{structures[job.path].member.name}.execute'
            for port in ports.values()
            for job in port.jobs
            if job.cycle and "execute" not in job.flags
        ]
        self._octets: list[int] = []

    def wrong(self, path: Keys, what: str, wanted: object, found: object) -> DiagnosticError:
        """The error for something that is not as the spec says."""
        span = self.loaded.span(path) if isinstance(path[-1], int) else self.loaded.key_span(path)
        message = f"{what}: the spec says {wanted}, found {found}"
        return DiagnosticError([Diagnostic("PG641", message, span, help=PAGE)])

    # --- what is where -----------------------------------------------------------------------------------------

    def _structures(self, ports: Mapping[str, StatedPort]) -> dict[Keys, Field]:
        """The structure of each job in the control DB, in the order of the spec; a job may have no member at all."""
        wanted = [(port, job) for port in ports.values() for job in port.jobs if job.values or self._signals(job)]
        try:
            fields = layout_of(self.program, self.control).shape.fields if wanted else ()
        except ScenarioError:
            fields = ()
        names = {job.path: folded(job.key if len(ports) == 1 else port.key + job.key) for port, job in wanted}
        if len(fields) != len(wanted):
            raise self.wrong(("ppi",), f'structures of "{self.control}"', len(wanted), len(fields))
        for field, (_, job) in zip(fields, wanted, strict=True):
            name = folded(field.member.name)
            if name != names[job.path] and name in names.values():
                raise self.wrong(job.path, f'structure of {job.key} in "{self.control}"', job.key, field.member.name)
        return {job.path: field for field, (_, job) in zip(fields, wanted, strict=True)}

    def _signals(self, job: PpiStatement) -> list[str]:
        return [signal for signal in SIGNALS if signal not in job.flags]

    def _members(self, job: PpiStatement, own: Field | None) -> JobMembers:
        """Signals of a job, and its inputs or outputs in the order of the spec."""
        if own is None:
            return JobMembers(job.flags, (), "", (0, 0))
        base, values = f'"{self.control}".{own.member.name}', job.inputs or job.outputs
        inner = {field.member.name: field for field in own.shape.fields}
        names = [name for name in inner if name not in (*SIGNALS, ERRORS)]
        if len(names) != len(values):
            said = f"{len(values)} values"
            raise self.wrong(job.path, f"members of {job.key}", said, ", ".join(names) or "none")
        for name, value in zip(names, values, strict=True):
            others = {folded(other.name) for other in values if other is not value}
            if name != value.name if value.given else folded(name) in others - {folded(value.name)}:
                raise self.wrong(value.path, f"the member of {value.text}", value.name, name)
            type_, kind = inner[name].member.type, value.kind
            element = type_.element if isinstance(type_, ArrayType) else type_
            count = type_.bounds[0][1] - type_.bounds[0][0] + 1 if isinstance(type_, ArrayType) else 0
            if not isinstance(element, Elementary) or (element.name, count) != (kind, value.count):
                raise self.wrong(value.path, f"type of {job.key}.{name}", f"{kind} {value.count or ''}", type_)
        signals = {signal: job.flags.get(signal, f"{base}.{signal}") for signal in SIGNALS}
        span = own.offset // 8, (own.offset + own.shape.bits + 7) // 8
        return JobMembers(signals, tuple(f"{base}.{name}" for name in names), f"{base}.{ERRORS}", span)

    # --- time and signals --------------------------------------------------------------------------------------

    def power_up(self) -> None:
        """Start with the data blocks as delivered; no job starts on its own."""
        self.module.hang = False
        self.line.deaf = self.line.mute = self.line.busy = self.line.refuse = False
        self.line.forget()
        self.module.sent.clear()
        self.cpu.restart("cold")
        for path in self._started:
            self.cpu[path] = False
        self.cpu.scan(1)

    def signal(self, job: PpiStatement, name: str) -> int:
        """A signal of a job as its user sees it."""
        return int(str(int(self.cpu[self.members[job.key].signals[name]])))  # type: ignore[arg-type]

    def start(self, job: PpiStatement) -> None:
        """Set execute of a job."""
        self.cpu[self.members[job.key].signals["execute"]] = True

    def over(self, job: PpiStatement) -> bool:
        """Whether a job has ended."""
        return bool(self.signal(job, "done") or self.signal(job, "error"))

    def run(self, job: PpiStatement) -> int:
        """Start a job and wait for its end: its status. execute falls afterwards."""
        self.line.forget()
        self.start(job)
        for _ in range(2 * job.timeout // self.step + 2000):
            self.cpu.scan(self.step)
            if self.over(job):
                break
        else:
            raise self.wrong(job.path, f"job {job.key}", "ends", "never ends")
        if self.cpu.misuses:
            raise self.wrong(job.path, f"what {job.key} does", "nothing that a CPU refuses", self.cpu.misuses[0])
        return self.signal(job, "status")

    def rest(self, job: PpiStatement) -> None:
        """Let execute fall."""
        self.cpu[self.members[job.key].signals["execute"]] = False
        self.cpu.scan(self.step, 3)

    def until(self, moment: float) -> None:
        """One scan towards a moment: a long one while it is far away, else one of 1 ms."""
        far = int(moment - self.cpu.clock) - MARGIN
        self.cpu.scan(far if far > MARGIN else 1)

    def begins(self) -> list[float]:
        """When each frame that was sent began, in ms."""
        return [end - len(frame) * CHARACTER_BITS * 1000 / self.port.baud for end, frame in self.module.sent]

    # --- values ------------------------------------------------------------------------------------------------

    def fresh(self, value: StatedAddress, code: int, turn: int) -> bytes:
        """Bytes for an address that occur nowhere else as long as there are any; a bit is bit ``turn`` of its code."""
        if value.kind == "BOOL":
            return bytes((code >> turn & 1,))
        data = b""
        for place in value.places:
            octets = bytearray(self._octet() for _ in range(spec.element_octets(place)))
            if value.kind == "REAL":
                octets[0] = octets[0] & 0x8F | 0x40  # no NaN, no infinity
            elif value.kind == "CHAR":
                octets[0] = 0x21 + octets[0] % 94
            data += octets
        return data

    def _octet(self) -> int:
        if not self._octets:
            self._octets = self.draw.sample(range(256), 256)
        return self._octets.pop()

    def shown(self, path: str) -> list[Number]:
        """A value of the control DB as numbers."""
        return list(_numbers(self.cpu[path]))

    def supply(self, path: str, value: StatedAddress, numbers: Sequence[Number]) -> None:
        """Give an input numbers of its type."""
        trees = [bool(n) if value.kind == "BOOL" else chr(int(n)) if value.kind == "CHAR" else n for n in numbers]
        self.cpu[path] = trees if value.count else trees[0]

    def held(self, job: PpiStatement, value: StatedAddress) -> list[Number]:
        """What the station holds at an address, as numbers of the declared type."""
        memory = self.line.stations[job.station]
        return [to_number(memory.read(place), value.kind) for place in value.places]

    def pins(self) -> Mapping[str, str]:
        """Members of the instance by folded name."""
        fields = layout_of(self.program, self.instance).shape.fields
        return {folded(field.member.name): f'"{self.instance}".{field.member.name}' for field in fields}


def folded(name: str) -> str:
    """A name without what styles change: capitals, underscores."""
    return "".join(c for c in name.casefold() if c.isalnum())


def numbers_of(value: StatedAddress, data: bytes) -> list[Number]:
    """Bytes of all elements as numbers of the declared type."""
    size = len(data) // len(value.places)
    return [to_number(data[at : at + size], value.kind) for at in range(0, len(data), size)]


def _numbers(tree: Tree) -> Iterator[Number]:
    if isinstance(tree, list):
        for inner in tree:
            yield from _numbers(inner)
    elif isinstance(tree, str):
        yield ord(tree)
    else:
        yield tree if isinstance(tree, float) else int(tree)  # type: ignore[arg-type]
