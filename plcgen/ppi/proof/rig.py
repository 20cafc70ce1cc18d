"""The bench a generated PPI master runs on, and its telegram tables and response DBs before and after a job.

Tables and DBs are littered before the job, so a copy that is missing shows.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from functools import partial

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.ppi.plan.nouns import PlannedMaster, PpiJob, PpiPlan, PpiTelegram, PpiValue
from plcgen.ppi.proof.scenario import Bend, Edit
from plcgen.ppi.proof.words import LEAD, WORDS
from plcgen.ppi.sim import Bus as Line
from plcgen.ppi.sim import Station
from plcgen.ppi.sim.station import Session, StationCpu
from plcgen.ppi.wire.areas import Area
from plcgen.ppi.wire.errors import PpiError
from plcgen.ppi.wire.fdl import decode_frame, encode_frame, examine_frame
from plcgen.ppi.wire.model import (
    FIRST,
    Item,
    ReadReply,
    ReadRequest,
    RunRequest,
    StopRequest,
    VariableFrame,
    WriteReply,
    WriteRequest,
)
from plcgen.ppi.wire.pdu import decode_pdu, examine_pdu
from plcgen.proof.checks import Check, Outcome
from plcgen.proof.folder import Folder
from plcgen.proof.making import Pending
from plcgen.proof.rig import Members, Source, Spot
from plcgen.proof.scenario import ScenarioError
from plcgen.s7.cpu.cpu import Cpu
from plcgen.s7.cpu.program import Program
from plcgen.s7.cpu.system.port import UNSET, Periphery, Port, PortSettings
from plcgen.s7.layout.image import StartValueError, image, start_place
from plcgen.s7.layout.layout import layout_block

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


LITTER = 0xA5
DATA = 14
"""Where the data of a reply with items begins: header 12, function, number of items."""
RUN_TIME = frozenset({"function_code", "reference", "fcs"})
"""Members of a table that the block fills whatever they were."""


def litter(rig: MasterRig) -> None:
    """Fill every response DB and what the block fills in every table with a pattern."""
    for telegram in rig.master.telegrams:
        table = rig.cpu.db(telegram.request.home.name)
        for field in telegram.request.fields:
            if field.role in RUN_TIME:
                table[field.offset : field.offset + field.size] = bytes((LITTER,)) * field.size
        if telegram.response is not None:
            response = rig.cpu.db(telegram.response.home.name)
            response[:] = bytes((LITTER,)) * len(response)


def check_job_tables(rig: MasterRig, job: PpiJob, *, refused: bool) -> None:
    """Tables and response DBs after a job that is done, or whose last telegram has refused items."""
    last = rig.db.get("telegram")
    for telegram in rig.master.telegrams:
        mine = telegram in job.telegrams and telegram.number <= last
        if mine:
            reply = _exchange(rig, telegram)
            _compare(rig, telegram, reply, refused=refused and telegram.number == last)
        elif telegram.response is not None and set(rig.cpu.db(telegram.response.home.name)) - {LITTER}:
            raise ScenarioError(f'"{telegram.response.home.name}" changed although its telegram was not sent')


def _exchange(rig: MasterRig, telegram: PpiTelegram) -> bytes:
    """The table is the request that was sent; PDU of the reply to it."""
    table = bytes(rig.cpu.db(telegram.request.home.name)[LEAD : LEAD + len(telegram.request.data)])
    if table not in {data for _, data in rig.port.sent}:
        raise ScenarioError(f'"{telegram.request.home.name}" holds {table.hex(" ").upper()}, which was not sent')
    frame = examine_frame(table)[0]
    reference = frame.pdu[4:6] if isinstance(frame, VariableFrame) else b""
    for entry in reversed(rig.line.journal):
        answer = entry.frame
        known = isinstance(answer, VariableFrame) and answer.source == telegram.station.address
        if entry.direction == "<" and known and isinstance(answer, VariableFrame) and answer.pdu[4:6] == reference:
            return answer.pdu
    raise ScenarioError(f'nothing answered "{telegram.request.home.name}", but the job says so')


def _compare(rig: MasterRig, telegram: PpiTelegram, pdu: bytes, *, refused: bool) -> None:
    """Every member of the response DB is what the reply says; without values if an item was refused."""
    if telegram.response is None:
        return
    found = rig.cpu.db(telegram.response.home.name)
    reply = examine_pdu(pdu)[0]  # a return code that nobody knows is one, too
    if isinstance(reply, ReadReply):
        codes = [result.code for result in reply.results]
    elif isinstance(reply, WriteReply):
        codes = list(reply.codes)
    else:
        raise ScenarioError(f'"{telegram.response.home.name}": the reply has no items')
    for field in telegram.response.fields:
        kept = telegram.items[field.item - 1].item.octets if field.role == "value" else field.size  # without pad
        if field.role == "return_code":
            wanted = bytes((codes[field.item - 1],))
        elif field.role == "pad" or refused:
            wanted = b""
        else:
            wanted = pdu[DATA + field.offset : DATA + field.offset + kept]
        wanted += bytes((LITTER,)) * (field.size - len(wanted))
        octets = bytes(found[field.offset : field.offset + field.size])
        if octets != wanted:
            shown = f"{octets.hex(' ').upper()} instead of {wanted.hex(' ').upper()}"
            raise ScenarioError(f'"{telegram.response.home.name}".{field.name} is {shown}')


def check_telegrams(plan: PpiPlan, folder: Folder) -> Iterator[Pending]:
    """Checks of the group ``telegrams``: the table's start values are one telegram that says what the spec asks."""
    for master in plan.masters:
        for telegram in master.telegrams:
            job = next((job for job in master.jobs if telegram in job.telegrams), None)
            key = f"first frame to {plan.station_key(master, telegram.station)}"
            if job is not None:
                key = f"{plan.key(master, job)}{_part(job.telegrams, telegram)}"
            name = telegram.request.home.name
            make = partial(_telegram, plan, folder, master, telegram, key)
            yield Pending(f"telegram.{name}", key, partial(folder.place, name), make)


def _part(telegrams: tuple[PpiTelegram, ...], telegram: PpiTelegram) -> str:
    return f" {telegrams.index(telegram) + 1}" if len(telegrams) > 1 else ""


def _telegram(plan: PpiPlan, folder: Folder, master: PlannedMaster, telegram: PpiTelegram, key: str) -> Check:
    name, subject = f"telegram.{telegram.request.home.name}", key
    shown = telegram.request.data.hex(" ").upper()
    text = f"{shown} ({len(telegram.request.data)} bytes)"
    problem = _first_problem(plan, folder, master, telegram)
    if problem is None:
        return Check(name, subject, text, Outcome.OK, "start values form exactly this telegram")
    found = Diagnostic("PG604", problem, _place(folder, telegram), help="run plcgen generate")
    return Check(name, subject, text, Outcome.ERROR, problem, found)


def _place(folder: Folder, telegram: PpiTelegram) -> Span:
    """The line that says the first byte that is another one, or the block."""
    name, wanted = telegram.request.home.name, telegram.request.data
    block = folder.text.get(name.upper())
    with suppress(DiagnosticError, StartValueError):
        data = bytes(image(block, folder.text)) if block is not None else b""
        table = bytes([len(wanted), *wanted])
        at = next((at for at, pair in enumerate(zip(data, table, strict=False)) if pair[0] != pair[1]), None)
        if block is not None and at is not None:
            return start_place(block, folder.text, at) or folder.place(name)
    return folder.place(name)


def _first_problem(plan: PpiPlan, folder: Folder, master: PlannedMaster, telegram: PpiTelegram) -> str | None:
    """What is wrong with the start values in the text source or the SimaticML, or None."""
    for origin, blocks in (("text source", folder.text), ("SimaticML", folder.xml)):
        if origin == "SimaticML" and plan.target.xml_version is None:
            continue
        block = blocks.get(telegram.request.home.name.upper())
        if block is None:
            return f'DB "{telegram.request.home.name}" is missing in the {origin}s'
        try:
            data = bytes(image(block, blocks))
            size = layout_block(block, blocks).size
        except (DiagnosticError, StartValueError) as problem:
            return f"{origin}: {problem}"
        problem_text = _wrong(data[: min(size, len(data))], master, telegram)
        if problem_text is not None:
            return f"{origin}: {problem_text}"
    return None


def _wrong(data: bytes, master: PlannedMaster, telegram: PpiTelegram) -> str | None:
    """Compare the bytes of a table with what the spec asks for, through the strict decoder."""
    length = data[0]
    frame = data[LEAD : LEAD + length]
    try:
        found = decode_frame(frame)
        pdu = decode_pdu(found.pdu) if isinstance(found, VariableFrame) else None
    except PpiError as problem:
        return f"the start values form no telegram: {problem}"
    if not isinstance(found, VariableFrame) or pdu is None:
        return "the start values form no request"
    wanted = (telegram.station.address, master.own_address, FIRST)
    if (found.destination, found.source, found.function) != wanted:
        return f"stations and function code are {found.destination}, {found.source}, {found.function:02X}h"
    if pdu.reference:
        return f"the start value of the reference is {pdu.reference}"
    kinds = {"run": RunRequest, "stop": StopRequest, "write": WriteRequest}
    if not isinstance(pdu, kinds.get(telegram.kind, ReadRequest)):
        return f"the request is a {type(pdu).__name__}, not what a {telegram.kind} job sends"
    if isinstance(pdu, WriteRequest):
        return _same([(entry.item, entry.data) for entry in pdu.items], [(w.item, w.data) for w in telegram.items])
    if isinstance(pdu, ReadRequest):
        return _same([(item, b"") for item in pdu.items], [(wire.item, b"") for wire in telegram.items])
    return None


def _same(found: list[tuple[Item, bytes]], wanted: list[tuple[Item, bytes]]) -> str | None:
    if len(found) != len(wanted):
        return f"{len(found)} items instead of {len(wanted)}"
    for number, (have, want) in enumerate(zip(found, wanted, strict=True), 1):
        if have != want:
            return f"item {number} is {have[0]} {have[1].hex(' ')}, not {want[0]} {want[1].hex(' ')}"
    return None
