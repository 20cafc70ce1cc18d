"""The bench a generated PPI master runs on: files on disk in a soft CPU, a port, S7-200 stations in memory."""

from __future__ import annotations

import random
from collections.abc import Mapping
from dataclasses import replace

from plcgen.ppi.plan.nouns import PlannedMaster, PpiJob, PpiPlan, PpiTelegram, PpiValue
from plcgen.ppi.proof.scenario import Bend, Edit
from plcgen.ppi.proof.words import WORDS
from plcgen.ppi.sim import Bus as Line
from plcgen.ppi.sim import Station
from plcgen.ppi.sim.cpu import Session, StationCpu
from plcgen.ppi.wire.areas import Area
from plcgen.ppi.wire.fdl import encode_frame, examine_frame
from plcgen.ppi.wire.model import Item, VariableFrame
from plcgen.proof.rig import Members, Source, Spot
from plcgen.s7.cpu.cpu import Cpu
from plcgen.s7.cpu.program import Program
from plcgen.s7.cpu.system.port import UNSET, Periphery, Port, PortSettings

ACKNOWLEDGED = b"\xe5"
CHARACTER_MS = 2
"""More than a character takes at 9600 bit/s, 11 bits."""
SIGNALS = ("execute", "busy", "done", "error", "status")
DETAILS = (
    "moduleStatus", "headerError", "pduReference", "state", "job", "telegram", "retries", "polls", "failedItem",
    "ignoredFrames", "damagedFrames", "functionCode",
)  # fmt: skip


class RecordingStation(StationCpu):
    """The CPU of a station that keeps what it executed."""

    def __init__(self, plain: StationCpu, executed: list[bytes]) -> None:
        super().__init__(plain.memory, plain.mode, plain.switch, plain.pdu_limit, plain.protected)
        self.executed = executed

    def answer(
        self, data: bytes, session: Session, *, refuse: int | None = None, items: Mapping[int, int] | None = None
    ) -> bytes | None:
        """Execute a request and note it."""
        self.executed.append(data)
        return super().answer(data, session, refuse=refuse, items=items)


class EditedLine:
    """A line on which replies are changed: ``edit`` every PDU, with a new frame around it, ``bend`` the first frame.

    ``broken`` cuts the first one behind so many bytes, the others come ``rest`` ms later; ``again`` is how many come if
    even those break off. ``only``: there is one reply, so many ms late, and E5 instead
    of every other one; if ``unready`` before it, too.
    """

    def __init__(self, line: Line) -> None:
        self.line = line
        self.edit: Edit | None = None
        self.bend: Bend | None = None
        self.broken = self.again = self.rest = self.only = 0
        self.unready = self._replied = False
        self._held: tuple[int, bytes] | None = None

    def alone(self, late: int, *, unready: bool) -> None:
        """Let there be one reply, so many ms late, and E5 before it if ``unready``; 0: as many as there are."""
        self.only, self.unready, self._replied = late, unready, False

    def receive(self, data: bytes, now: int) -> None:
        """Hand bytes on to the stations."""
        self.line.receive(data, now)

    def due(self) -> int | None:
        """When the next bytes come."""
        due = self.line.due()
        return due if self._held is None else self._held[0] if due is None else min(due, self._held[0])

    def transmit(self, now: int) -> bytes:
        """Bytes of the stations, changed if they are one reply."""
        if self._held is not None and self._held[0] <= now:
            held, self._held = self._held[1], None
            return self._hold_back(held, now) if self.again else held
        data = self.line.transmit(now)
        if self.edit is None and self.bend is None and not self.broken and not self.only:
            return data
        frame = examine_frame(data)[0] if data else None
        if not isinstance(frame, VariableFrame):
            return data
        if self.only:
            late, self._replied = not self._replied, True
            self._held = (now + self.only, data) if late else self._held
            return b"" if late and not self.unready else ACKNOWLEDGED
        if self.edit is not None:
            data = encode_frame(replace(frame, pdu=self.edit(frame.pdu)))
        if self.bend is not None:
            data, self.bend = self.bend(data), None
        if self.broken:
            self.broken, self.again, next_ = 0, self.broken, self.again
            data, self.again = self._hold_back(data, now), next_
        return data

    def _hold_back(self, data: bytes, now: int) -> bytes:
        data, rest, self.again = data[: self.again], data[self.again :], 0
        self._held = now + self.rest + len(data) * CHARACTER_MS, rest
        return data


class MasterRig:
    """One master of a program on a CPU of its own, with every station it talks to."""

    def __init__(self, plan: PpiPlan, program: Program, master: PlannedMaster) -> None:
        self.plan, self.program, self.master = plan, program, master
        self.stations = {s.address: Station(s.profile.key, s.address, frame_count="strict") for s in master.stations}
        self.executed: list[bytes] = []
        for station in self.stations.values():
            station.cpu = RecordingStation(station.cpu, self.executed)
        self.line = Line(self.stations.values())
        self.bus = Periphery()
        self.edited = EditedLine(self.line)
        hardware = PortSettings(baud=master.baud) if plan.target.classic else UNSET  # a CP 341 is set in the hardware
        self.port = Port(peer=self.edited, line_baud=master.baud, hardware=hardware)
        self.bus.ports[master.port] = self.port
        self.cpu = Cpu(program, self.bus)
        self.cpu.restart("cold")
        self.job = master.jobs[0]
        paths = [f"diagnostics.{name}" for name in DETAILS]
        for job in master.jobs:
            names = [*SIGNALS, *(value.member for value in (*job.inputs, *job.outputs))]
            paths += [job.pin(name) for name in (*names, *(["errors"] if job.values else []))]
        self.db = Members(self.cpu, program, master.instance.name, paths, "diagnostics.")
        self._ranges, self._bits = self._shown()
        self.source = Source(program, master.block)
        self.place = (self.source.file, self.source.line)
        place = self.source.probes
        own = zip(program.probes[place], program.link.counted_by[place], strict=True)
        self._statements = [number - place.start for probe, number in own if probe.kind == "statement"]
        self.draw = random.Random(master.key)  # noqa: S311 - test values
        self.inputs: dict[str, bytes] = {}
        self._supplied: list[tuple[Spot, bytes, bytes]] = []
        busy = [(job, self.db.spots[job.pin("busy")], self.db.spots[job.pin("status")].byte) for job in master.jobs]
        self._signals = [(job, spot.byte, 1 << spot.bit, status) for job, spot, status in busy]

    def _shown(self) -> tuple[list[tuple[int, int]], list[tuple[int, int]]]:
        """Where the value outputs lie: ranges of bytes, and bytes with a mask for bits."""
        spots = [
            (self.db.spots[job.pin(value.member)], value.count * value.size)
            for job in self.master.jobs
            for value in job.outputs
        ]
        masks: dict[int, int] = {}
        ranges: list[tuple[int, int]] = []
        for spot, size in sorted(spots, key=lambda entry: entry[0].byte):
            if spot.flag:
                masks[spot.byte] = masks.get(spot.byte, 0) | 1 << spot.bit
            elif ranges and ranges[-1][1] == spot.byte:
                ranges[-1] = ranges[-1][0], spot.byte + size
            else:
                ranges.append((spot.byte, spot.byte + size))
        return ranges, list(masks.items())

    @property
    def scans(self) -> int:
        """Scans of OB1 so far."""
        return self.cpu.scans

    def clock(self) -> int:
        """The clock of the block on S7-1200/1500 in ms."""
        return int(str(self.cpu[f'"{self.db.block}".instClock.ET']))

    def counts(self) -> tuple[int, int]:
        """Frames that were passed over so far, and damaged ones."""
        return self.db.get("ignoredFrames"), self.db.get("damagedFrames")

    def statements(self, before: list[int]) -> int:
        """Statements of the block that were executed since its counters of coverage were ``before``."""
        now = self.cpu.counters[self.source.probes]
        return sum(now[number] - before[number] for number in self._statements)

    def pin(self, name: str) -> str:
        """Name at the block of a signal of the job that runs."""
        return self.job.pin(name)

    def errors(self) -> list[int]:
        """Errors per address of the job that runs."""
        return self.db.words(self.pin("errors"), len(self.job.values)) if self.job.values else []

    def shown(self, job: PpiJob, value: PpiValue) -> bytes:
        """Bytes of an output."""
        return self.db.bytes(job.pin(value.member), value.count * value.size)

    def outputs(self) -> list[bytes | int]:
        """Bytes of every value output of the master: neighbours together, bits alone. Asked in every scan."""
        memory = self.db.memory
        found: list[bytes | int] = [bytes(memory[first:end]) for first, end in self._ranges]
        return found + [memory[byte] & mask for byte, mask in self._bits]

    # --- stations -------------------------------------------------------------------------------------

    def station(self, job: PpiJob) -> Station:
        """The station of a job."""
        return self.stations[job.station.address]

    def memory(self, job: PpiJob, item: Item) -> bytes:
        """What a station holds at an address."""
        return self.station(job).cpu.memory.read(item).data

    def new_values(self, job: PpiJob) -> None:
        """Give the station and the inputs of a job other values than before."""
        for value in job.outputs:
            self.station(job).cpu.memory.put(value.item, self.random_bytes(value))
        for value in job.inputs:
            self.inputs[job.pin(value.member)] = self.random_bytes(value)
        supplied = [(self.db.spots[job.pin(v.member)], self.inputs[job.pin(v.member)]) for v in job.inputs]
        self._supplied = [(spot, data, bytes(octet ^ 0xFF for octet in data)) for spot, data in supplied]
        self.put_inputs()

    def put_inputs(self, *, wrong: bool = False) -> None:
        """Supply the inputs again, as a main program does in every scan, or the opposite of every bit."""
        memory = self.db.memory
        for spot, data, opposite in self._supplied:
            spot.put(memory, opposite if wrong else data)

    def moving(self) -> PpiJob | None:
        """A job other than the one that runs that is not idle. Asked in every scan."""
        memory, idle = self.db.memory, WORDS["IDLE"]
        for job, byte, mask, word in self._signals:
            if job is not self.job and (memory[byte] & mask or memory[word] << 8 | memory[word + 1] != idle):
                return job
        return None

    def quiet(self) -> bool:
        """Whether nothing is on its way from a station, and no message waits in the module."""
        return self.edited.due() is None and not self.port.waiting

    def random_bytes(self, value: PpiValue) -> bytes:
        """Wire bytes of a value that its type takes."""
        if value.bit:
            return bytes((self.draw.getrandbits(1),))
        octets = bytearray(self.draw.randbytes(value.item.octets))
        if value.element.name == "REAL":
            for n in range(0, len(octets), 4):
                octets[n] = octets[n] & 0x80 | 0x41  # no NaN, no infinity
        if value.item.area == Area.SYS:
            return bytes(65 + octet % 26 for octet in octets)
        return bytes(octets)

    def expected(self, job: PpiJob, value: PpiValue) -> bytes:
        """What an output must show of what the station holds."""
        data = self.memory(job, value.item)
        if value.bit:
            return data[:1]
        step, first = value.stride, value.skip
        pieces = [data[n * step + first : (n + 1) * step] for n in range(value.count)]
        return b"".join(piece[-value.size :] for piece in pieces)

    def planned(self, job: PpiJob, telegram: PpiTelegram) -> bytes:
        """The request with the inputs of this run; function code 6Ch, reference 0."""
        image = bytearray(telegram.request.data)
        at = len(image) - 2
        for field in telegram.request.fields:
            if field.role != "value":
                continue
            for placed in field.placed:
                value = placed.value
                data = self.inputs.get(job.pin(value.member), value.data) if not value.constant else value.data
                start = field.offset - 1 + placed.offset
                image[start : start + placed.length] = data[placed.start : placed.start + placed.length]
        image[at] = sum(image[4:at]) & 0xFF
        return bytes(image)
