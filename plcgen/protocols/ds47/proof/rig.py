"""The bench a generated job block runs on: the files on disk in a soft CPU, a scripted drive, places in memory."""

from __future__ import annotations

import random
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

from plcgen.cpu.cpu import Cpu
from plcgen.cpu.folder import load_folder
from plcgen.cpu.program import Program
from plcgen.cpu.system.bus import Bus
from plcgen.diagnostics import DiagnosticError, PlcgenError
from plcgen.project.nouns import Frame, Project
from plcgen.proof.folder import DIALECTS
from plcgen.protocols.ds47.plan.nouns import DriveJob, DrivePlan, DriveTelegram, Use
from plcgen.protocols.ds47.proof.bench import build_drive
from plcgen.protocols.ds47.proof.scenario import Limits, Scenario
from plcgen.protocols.ds47.sim.drive import Drive, Exchange
from plcgen.protocols.ds47.wire.formats import Kind, Value, pack_values, unpack_values
from plcgen.protocols.ds47.words import DRAIN_MS, LEASE_MS
from plcgen.s7.layout import Layout, locate
from plcgen.s7.types import Elementary

_LOCALS = re.compile(r"^( )((?:v\d+=)+)(0|0\.0|False)$", re.MULTILINE)
_GARBAGE = {"0": "0xA0", "0.0": "1e30", "False": "True"}
VALUE_SETS = 3


class ScenarioError(PlcgenError):
    """The block did not do what the scenario demands."""


def load_program(project: Frame, folder: Path) -> Program:
    """Compile the folder's sources with coverage; local data holds garbage at the start of a call, as in a CPU."""
    program = load_folder(folder, DIALECTS[project.target.dialect], coverage=True)
    if not program.ok:
        raise DiagnosticError([d for d in program.diagnostics if d.severity.label == "error"])
    for compiled in program.compiled:
        head, probe, body = compiled.source.partition("\n H[")
        dirty = _LOCALS.sub(lambda found: found[1] + found[2] + _GARBAGE[found[3]], head) + probe + body
        if compiled.code is not None and dirty != compiled.source:
            compiled.code = compile(dirty, f"<{compiled.file}>", "exec", dont_inherit=True, optimize=1)
    return program


class Bench:
    """A project and the program in its folder. A worker that starts from nothing compiles the program again."""

    def __init__(self, project: Project, folder: Path) -> None:
        self.project, self.folder = project, folder

    @cached_property
    def program(self) -> Program:
        """The compiled sources. Raises DiagnosticError."""
        return load_program(self.project, self.folder)

    def __reduce__(self) -> tuple[type[Bench], tuple[Project, Path]]:
        """A program cannot be pickled."""
        return Bench, (self.project, self.folder)


class ScriptedDrive(Drive):
    """A drive that follows the script of a scenario; ``reads`` and ``writes`` count the calls of this run."""

    def __init__(self, plain: Drive) -> None:
        super().__init__(plain.habits, plain.objects.values())
        self.own = plain.habits
        self.begin(Scenario(name="idle"))

    def begin(self, scenario: Scenario) -> None:
        """Start a run: forget the script before, keep the state of the channel."""
        self.scenario = scenario
        self.journal.clear()
        self.reads = self.writes = 0
        self.faults = [replace(fault) for fault in scenario.faults]
        form = self.own.answer_format
        if scenario.generic is not None:
            form = "size" if scenario.generic else "exact"
        if (self.habits.answer_format, self.habits.processing) != (form, scenario.processing):
            self.habits = replace(self.own, answer_format=form, processing=scenario.processing)
            self._server.habits = self.habits

    def write_record(self, index: int, data: bytes) -> int:
        """Take a request, unless the script has a STATUS for this call."""
        self.writes += 1
        script = self.scenario.writes
        status = script.get(self.writes) or script.get(0, 0)
        if status:
            self.journal.append(Exchange(self.time, "write", index, status, bytes(data)))
            return status
        status = super().write_record(index, data)
        if not status and self.scenario.silent:
            self._request = self._response = None
        return status

    def read_record(self, index: int, max_length: int) -> tuple[int, bytes]:
        """Hand out an answer, unless the script has something else for this call."""
        self.reads += 1
        act = self.scenario.reads.get(self.reads) or self.scenario.reads.get(0)
        if isinstance(act, int):
            self.journal.append(Exchange(self.time, "read", index, act, b""))
            return act, b""
        if self.reads in self.scenario.stale:
            sent = next(exchange.data for exchange in reversed(self.journal) if exchange.direction == "write")
            old = bytes((sent[0] - 1 or 255,)) + bytes((self._response or b"\0\0\0\0")[1:])
            self.journal.append(Exchange(self.time, "read", index, 0, old))
            return 0, old
        if act is not None and self._response is not None:
            self._response = act(self._response)
        return super().read_record(index, max_length)


@dataclass(frozen=True, slots=True)
class Spot:
    """Where a member lies: byte, bytes, and the bit of a BOOL (``flag``)."""

    byte: int
    size: int
    bit: int
    flag: bool = False

    @classmethod
    def of(cls, layout: Layout, path: str) -> Spot:
        """Place of a member. Raises KeyError."""
        entry = locate(layout, path)
        flag = isinstance(entry.type, Elementary) and entry.type.name == "BOOL"
        return cls(entry.byte, (entry.size + 7) // 8, entry.bit, flag)


class JobRig:
    """One job of a program on a CPU of its own."""

    def __init__(self, plan: DrivePlan, program: Program, job: DriveJob, job_limit: int | None = None) -> None:
        self.plan, self.program, self.job = plan, program, job
        self.drive = ScriptedDrive(build_drive(plan, job.drive))
        self.bus = Bus()
        self.bus.attach(job.drive.id_value, self.drive)
        self.cpu = Cpu(program, self.bus, job_limit=job_limit)
        self.cpu.restart("cold")
        self.limits = Limits(job.timeout, job.retry_pause, job.retries, DRAIN_MS, LEASE_MS, int(plan.target.t15))
        self.instance = self.cpu.db(job.instance.name)
        self.token = self.cpu.db(job.drive.token.name)
        layout = self.layout(job.instance.name)
        members = ["execute", "busy", "done", "error", "status", "errors", "errorInfos"]
        details = [
            "recordStatus",
            "state",
            "telegram",
            "retries",
            "requestReference",
            "responseLength",
            "failedParameter",
        ]
        self.spots = {name: Spot.of(layout, name) for name in members}
        self.spots |= {name: Spot.of(layout, f"diagnostics.{name}") for name in details}
        self.spots |= {use.member: Spot.of(layout, use.member) for use in (*job.inputs, *job.outputs)}
        token = self.layout(job.drive.token.name)
        self.token_spots = {name: Spot.of(token, name) for name in ("owner", "heartbeat", "requestReference")}
        first, last = self.spots["status"], self.spots["errors"]
        self.values_range = first.byte + first.size, last.byte
        block = self.program.link.find(job.block.name)
        file = block.result.tokens.file if block is not None else ""
        self.probes = [i for i, probe in enumerate(program.probes) if probe.file == file]
        self.file = file
        self.sets = [_value_set(self.drive, job, number) for number in range(VALUE_SETS)]
        self.sets.append(_factory_set(self.drive, job))
        self.set_number = 0
        self.buffers = [
            (self.instance, Spot.of(layout, "statRequest").byte, max(len(t.request.data) for t in job.telegrams)),
            (self.instance, Spot.of(layout, "statResponse").byte, max(t.response.size for t in job.telegrams)),
        ]

    def litter(self, pattern: bytes) -> None:
        """Fill everything that the next request and its answer will overwrite."""
        buffers = list(self.buffers)
        if self.plan.target.classic:
            telegram = self.job.telegrams[self.get("telegram") - 1]
            buffers.append((self.cpu.db(telegram.response.db.name), 0, telegram.response.size))
        for memory, first, size in buffers:
            memory[first : first + size] = (pattern * size)[:size]

    def layout(self, name: str) -> Layout:
        """Layout of a block as the soft CPU has it."""
        entry = self.program.link.find(name)
        if entry is None or entry.shape is None:
            raise ScenarioError(f'"{name}" is missing')
        return Layout(entry.shape.bits // 8, entry.shape)

    def get(self, name: str) -> int:
        """Unsigned value of a member of the instance."""
        spot = self.spots[name]
        return int.from_bytes(self.instance[spot.byte : spot.byte + spot.size])

    def flag(self, name: str) -> bool:
        """BOOL of the instance."""
        spot = self.spots[name]
        return bool(self.instance[spot.byte] >> spot.bit & 1)

    def set_flag(self, name: str, *, value: bool) -> None:
        """Set a BOOL of the instance."""
        spot = self.spots[name]
        mask = 1 << spot.bit
        self.instance[spot.byte] = self.instance[spot.byte] & 255 - mask | (mask if value else 0)

    def words(self, name: str) -> list[int]:
        """Array of words of the instance, forevery use of the job."""
        at = self.spots[name].byte
        return [int.from_bytes(self.instance[at + 2 * i : at + 2 * i + 2]) for i in range(len(self.job.uses))]

    def token_get(self, name: str) -> int:
        """Member of the drive's token."""
        at = self.token_spots[name].byte
        return int.from_bytes(self.token[at : at + 2], signed=True)

    def token_set(self, name: str, value: int) -> None:
        """Set a member of the drive's token."""
        at = self.token_spots[name].byte
        self.token[at : at + 2] = value.to_bytes(2, signed=True)

    # --- values ---------------------------------------------------------------------------------------

    def next_values(self, *, factory: bool = False) -> None:
        """Give drive and inputs other values than in the run before, or those of the factory and the spec."""
        self.set_number = VALUE_SETS if factory else (self.set_number + 1) % VALUE_SETS
        values, inputs, _ = self.sets[self.set_number]
        parameters = self.drive.objects[self.job.drive.drive_object].parameters
        for pnu, content in values.items():
            parameters[pnu].values = list(content)
        for member, data in inputs:
            self.put(self.instance, self.spots[member], data)

    @staticmethod
    def put(memory: bytearray, spot: Spot, data: bytes) -> None:
        """Store wire bytes in a member of the interface."""
        if spot.flag:
            memory[spot.byte] = memory[spot.byte] & 255 - (1 << spot.bit) | data[0] << spot.bit
        else:
            memory[spot.byte : spot.byte + len(data)] = data

    def requests(self) -> list[bytes]:
        """The telegrams this run must send, reference 0."""
        return self.sets[self.set_number][2]

    def expected(self, use: Use) -> bytes:
        """Wire bytes of a value the drive holds."""
        values = self.drive.objects[self.job.drive.drive_object].parameters[use.parameter.pnu].values
        chosen = [values[0]] if use.format.is_string else values[use.subindex : use.subindex + use.count]
        return pack_values(use.format, chosen)

    @staticmethod
    def shown(memory: bytearray, spot: Spot, size: int) -> bytes:
        """Wire bytes of a member of the interface."""
        if spot.flag:
            return bytes((memory[spot.byte] >> spot.bit & 1,))
        return bytes(memory[spot.byte : spot.byte + size])


ValueSet = tuple[dict[int, list[Value]], list[tuple[str, bytes]], list[bytes]]


def _value_set(drive: Drive, job: DriveJob, number: int) -> ValueSet:
    """Contents of the drive's parameters, the block's inputs, and the telegrams that result from them."""
    draw = random.Random(f"{job.key} {number}")  # noqa: S311 - test values
    by_pnu = {use.parameter.pnu: use for use in job.uses}
    parameters = drive.objects[job.drive.drive_object].parameters
    contents: dict[int, list[Value]] = {
        pnu: _sample(use, len(parameters[pnu].values), draw) for pnu, use in by_pnu.items()
    }
    data = {use.position: use.data for use in job.uses}
    inputs = []
    for use in job.inputs:
        count = 1 if use.format.is_string else use.count
        data[use.position] = pack_values(use.format, _sample(use, count, draw))
        inputs.append((use.member, data[use.position]))
    return contents, inputs, [_request(telegram, data) for telegram in job.telegrams]


def _factory_set(drive: Drive, job: DriveJob) -> ValueSet:
    """Contents as the drive has them at first, inputs as the spec has them."""
    parameters = drive.objects[job.drive.drive_object].parameters
    contents = {use.parameter.pnu: list(parameters[use.parameter.pnu].values) for use in job.uses}
    data = {use.position: use.data for use in job.uses}
    inputs = [(use.member, use.data) for use in job.inputs]
    return contents, inputs, [_request(telegram, data) for telegram in job.telegrams]


def _request(telegram: DriveTelegram, data: dict[int, bytes]) -> bytes:
    """The planned telegram with the values of the inputs."""
    image = bytearray(telegram.request.data)
    image[0] = 0
    at = 4 + 6 * len(telegram.parts)
    for part in telegram.parts:
        size = part.size
        if len(image) > 4 + 6 * len(telegram.parts):
            start = part.start * part.use.format.size
            image[at + 2 : at + 2 + size] = data[part.use.position][start : start + size]
            at += 2 + size + size % 2
    return bytes(image)


def _sample(use: Use, count: int, draw: random.Random) -> list[Value]:
    """Values within the limits of a parameter; the whole range of the type if it has none."""
    fmt, definition = use.format, use.parameter
    if fmt.is_string:
        size = use.count
        low, high = (65, 90) if fmt.kind is Kind.TEXT else (0, 255)
        return list(unpack_values(fmt, size, bytes(draw.randint(low, high) for _ in range(size))))
    if fmt.kind is Kind.BOOLEAN:
        flags: Sequence[Value] = [bool(draw.getrandbits(1)) for _ in range(count)]
        return list(flags)
    if fmt.kind is Kind.FLOAT:
        low_f = definition.minimum if definition.minimum is not None else -1e6
        high_f = definition.maximum if definition.maximum is not None else 1e6
        packed = b"".join(pack_values(fmt, [draw.uniform(low_f, high_f)]) for _ in range(count))
        return list(unpack_values(fmt, count, packed))
    if fmt.kind in {Kind.SIGNED, Kind.UNSIGNED} and (definition.minimum is not None or definition.maximum is not None):
        span = 1 << fmt.size * 8 - (1 if fmt.kind is Kind.SIGNED else 0)
        least = int(definition.minimum) if definition.minimum is not None else (-span if fmt.kind is Kind.SIGNED else 0)
        most = int(definition.maximum) if definition.maximum is not None else span - 1
        return [draw.randint(least, most) for _ in range(count)]
    return list(unpack_values(fmt, count, draw.randbytes(fmt.size * count)))
