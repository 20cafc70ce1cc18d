"""The bench a generated job block runs on: the files on disk in a soft CPU, a scripted drive, places in memory."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import replace

from plcgen.cpu.cpu import Cpu
from plcgen.cpu.program import Program
from plcgen.cpu.system.bus import Periphery
from plcgen.proof.rig import Members, Source
from plcgen.protocols.ds47.plan.nouns import DriveJob, DrivePlan, DriveTelegram, Use
from plcgen.protocols.ds47.proof.scenario import DriveScenario, TimeLimits
from plcgen.protocols.ds47.proof.words import DRAIN_MS, LEASE_MS
from plcgen.protocols.ds47.sim.bench import build_drive
from plcgen.protocols.ds47.sim.drive import Drive, RecordExchange
from plcgen.protocols.ds47.wire.formats import FormatKind, Value, pack_values, unpack_values

VALUE_SETS = 3
SIGNALS = ("execute", "busy", "done", "error", "status", "errors", "errorInfos", "statRequest", "statResponse")
DETAILS = (
    "recordStatus", "state", "telegram", "retries", "requestReference", "responseLength", "failedParameter",
)  # fmt: skip


class ScriptedDrive(Drive):
    """A drive that follows the script of a scenario; ``reads`` and ``writes`` count the calls of this run."""

    def __init__(self, plain: Drive) -> None:
        super().__init__(plain.behaviour, plain.objects.values())
        self.own = plain.behaviour
        self.begin(DriveScenario(name="idle"))

    def begin(self, scenario: DriveScenario) -> None:
        """Start a run: forget the script before, keep the state of the channel."""
        self.scenario = scenario
        self.journal.clear()
        self.reads = self.writes = 0
        self.faults = [replace(fault) for fault in scenario.faults]
        form = self.own.answer_format
        if scenario.generic is not None:
            form = "size" if scenario.generic else "exact"
        if (self.behaviour.answer_format, self.behaviour.processing) != (form, scenario.processing):
            self.behaviour = replace(self.own, answer_format=form, processing=scenario.processing)
            self._server.behaviour = self.behaviour

    def write_record(self, index: int, data: bytes) -> int:
        """Take a request, unless the script has a STATUS for this call."""
        self.writes += 1
        script = self.scenario.writes
        status = script.get(self.writes) or script.get(0, 0)
        if status:
            self.journal.append(RecordExchange(self.time, "write", index, status, bytes(data)))
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
            self.journal.append(RecordExchange(self.time, "read", index, act, b""))
            return act, b""
        if self.reads in self.scenario.stale:
            sent = next(exchange.data for exchange in reversed(self.journal) if exchange.direction == "write")
            old = bytes((sent[0] - 1 or 255,)) + bytes((self._response or b"\0\0\0\0")[1:])
            self.journal.append(RecordExchange(self.time, "read", index, 0, old))
            return 0, old
        if act is not None and self._response is not None:
            self._response = act(self._response)
        return super().read_record(index, max_length)


class JobRig:
    """One job of a program on a CPU of its own."""

    def __init__(self, plan: DrivePlan, program: Program, job: DriveJob) -> None:
        self.plan, self.program, self.job = plan, program, job
        self.drive = ScriptedDrive(build_drive(plan, job.drive))
        self.bus = Periphery()
        self.bus.attach(job.drive.id_value, self.drive)
        self.cpu = Cpu(program, self.bus)
        self.cpu.restart("cold")
        self.limits = TimeLimits(job.timeout, job.retry_pause, job.retries, DRAIN_MS, LEASE_MS, int(plan.target.t15))
        paths = (*SIGNALS, *(f"diagnostics.{name}" for name in DETAILS))
        self.db = Members(self.cpu, program, job.instance.name, paths, "diagnostics.")
        values = [use.member for use in (*job.inputs, *job.outputs)]
        self.values = Members(self.cpu, program, job.instance.name, values)
        """Apart from the rest: a value may be called as a member of the diagnostics is."""
        self.token = Members(self.cpu, program, job.drive.token.name, ("owner", "heartbeat", "requestReference"))
        first, last = self.db.spots["status"], self.db.spots["errors"]
        self.values_range = slice(first.byte + first.size, last.byte)
        self.source = Source(program, job.block)
        self.sets = [_value_set(self.drive, job, number) for number in range(VALUE_SETS)]
        self.sets.append(_factory_set(self.drive, job))
        self.set_number = 0

    @staticmethod
    def pin(name: str) -> str:
        """There is one job in the block."""
        return name

    def litter(self, pattern: bytes) -> None:
        """Fill everything that the next request and its answer will overwrite."""
        telegrams, spots = self.job.telegrams, self.db.spots
        buffers = [
            (self.db.memory, spots["statRequest"].byte, max(len(t.request.data) for t in telegrams)),
            (self.db.memory, spots["statResponse"].byte, max(t.response.size for t in telegrams)),
        ]
        if self.plan.target.classic:
            response = telegrams[self.db.get("telegram") - 1].response
            buffers.append((self.cpu.db(response.db.name), 0, response.size))
        for memory, first, size in buffers:
            memory[first : first + size] = (pattern * size)[:size]

    def words(self, name: str) -> list[int]:
        """Array of words of the instance, for every use of the job."""
        return self.db.words(name, len(self.job.uses))

    def outputs(self) -> bytes:
        """All value outputs."""
        return bytes(self.db.memory[self.values_range])

    # --- values ---------------------------------------------------------------------------------------

    def next_values(self, *, factory: bool = False) -> None:
        """Give drive and inputs other values than in the run before, or those of the factory and the spec."""
        self.set_number = VALUE_SETS if factory else (self.set_number + 1) % VALUE_SETS
        parameters = self.drive.objects[self.job.drive.drive_object].parameters
        for pnu, content in self.sets[self.set_number][0].items():
            parameters[pnu].values = list(content)
        self.put_inputs()

    def put_inputs(self) -> None:
        """Supply the inputs, as a main program does in every scan."""
        for member, data in self.sets[self.set_number][1]:
            self.values.put(member, data)

    def requests(self) -> list[bytes]:
        """The telegrams this run must send, reference 0."""
        return self.sets[self.set_number][2]

    def expected(self, use: Use) -> bytes:
        """Wire bytes of a value the drive holds."""
        return held(self.drive, self.job.drive.drive_object, use)


def held(drive: Drive, drive_object: int, use: Use) -> bytes:
    """Wire bytes of the values of a use in a drive. Raises KeyError."""
    values = drive.objects[drive_object].parameters[use.parameter.pnu].values
    return pack_values(use.format, [values[0]] if use.format.is_string else values[use.subindex :][: use.count])


ValueSet = tuple[dict[int, list[Value]], list[tuple[str, bytes]], list[bytes]]


def _value_set(drive: Drive, job: DriveJob, number: int) -> ValueSet:
    """Contents of the drive's parameters, the block's inputs, and the telegrams that result from them."""
    draw = random.Random(f"{job.key} {number}")  # noqa: S311 - test values
    parameters = drive.objects[job.drive.drive_object].parameters
    by_pnu = {use.parameter.pnu: use for use in job.uses}
    contents = {pnu: _sample(use, len(parameters[pnu].values), draw) for pnu, use in by_pnu.items()}
    data = {
        use.position: pack_values(use.format, _sample(use, 1 if use.format.is_string else use.count, draw))
        for use in job.inputs
    }
    return contents, *_sent(job, data)


def _factory_set(drive: Drive, job: DriveJob) -> ValueSet:
    """Contents as the drive has them at first, inputs as the spec has them."""
    parameters = drive.objects[job.drive.drive_object].parameters
    contents = {use.parameter.pnu: list(parameters[use.parameter.pnu].values) for use in job.uses}
    return contents, *_sent(job, {})


def _sent(job: DriveJob, given: dict[int, bytes]) -> tuple[list[tuple[str, bytes]], list[bytes]]:
    """Inputs and telegrams; what is not given is what the spec has."""
    data = {use.position: given.get(use.position, use.data) for use in job.uses}
    inputs = [(use.member, data[use.position]) for use in job.inputs]
    return inputs, [_request(telegram, data) for telegram in job.telegrams]


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
        low, high = (65, 90) if fmt.kind is FormatKind.TEXT else (0, 255)
        return list(unpack_values(fmt, size, bytes(draw.randint(low, high) for _ in range(size))))
    if fmt.kind is FormatKind.BOOLEAN:
        flags: Sequence[Value] = [bool(draw.getrandbits(1)) for _ in range(count)]
        return list(flags)
    if fmt.kind is FormatKind.FLOAT:
        low_f = definition.minimum if definition.minimum is not None else -1e6
        high_f = definition.maximum if definition.maximum is not None else 1e6
        packed = b"".join(pack_values(fmt, [draw.uniform(low_f, high_f)]) for _ in range(count))
        return list(unpack_values(fmt, count, packed))
    if fmt.kind in {FormatKind.SIGNED, FormatKind.UNSIGNED} and (
        definition.minimum is not None or definition.maximum is not None
    ):
        span = 1 << fmt.size * 8 - (1 if fmt.kind is FormatKind.SIGNED else 0)
        least = (
            int(definition.minimum)
            if definition.minimum is not None
            else (-span if fmt.kind is FormatKind.SIGNED else 0)
        )
        most = int(definition.maximum) if definition.maximum is not None else span - 1
        return [draw.randint(least, most) for _ in range(count)]
    return list(unpack_values(fmt, count, draw.randbytes(fmt.size * count)))
