"""WRREC and RDREC: asynchronous record jobs between instance memory and the drives of the bus.

Sources: help of the TIA Portal, "Difference between synchronous and asynchronous instructions" (S7-300/400 and
S7-1200/1500) and "RDREC", "WRREC", "Parameter STATUS"; Siemens entry 15364459 (record jobs at once).
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from plcgen.s7.cpu.memory import Memory, Reference
from plcgen.s7.cpu.system.interfaces import SystemFb
from plcgen.s7.cpu.system.port import Periphery
from plcgen.s7.layout.shapes import Shape

IDLE, FIRST, RUNNING = 0x00700000, 0x00700100, 0x00700200
NO_MODULE, BUSY_RESOURCE, BAD_RECORD = 0xC0809000, 0xC080C300, 0xC080B100
"""STATUS of local errors: no such address, too many jobs at once, RECORD does not hold LEN bytes."""

Report = Callable[[str, str], None]
Key = tuple[int, int]
"""An instance: identity of its memory, first byte."""


def _nobody(_job: RecordJob) -> None:
    """Nobody wants to know when a job ends."""


@dataclass(frozen=True, slots=True)
class RecordPlaces:
    """How many record jobs a CPU runs at once: in ``total``, and of WRREC and RDREC ``each``; None is no limit.

    ``until_reported``: a place is taken until a call of the block reports the end ("as long as BUSY is 1", help of the
    S7-300/400); if not, until the job has been processed ("available again after a job has been processed", S7-1500
    system manual). What a CPU does whose block is not called any more is not said anywhere.
    """

    total: int | None = None
    each: int | None = None
    until_reported: bool = True


PLACES: Mapping[str, RecordPlaces] = MappingProxyType(
    {
        "s7-300": RecordPlaces(total=4),  # 312 to 316
        "s7-317": RecordPlaces(total=8),  # 317 and 319
        "s7-400": RecordPlaces(each=8),  # of every segment; the soft CPU has one
        "s7-1200": RecordPlaces(total=4),
        "s7-1500": RecordPlaces(each=10),  # firmware up to V1.8
        "s7-1500-v2": RecordPlaces(each=20),
    }
)
"""Record jobs at once by family, and by the types that differ (entry 15364459)."""


@dataclass(slots=True)
class RecordJob:
    """A record job of the CPU: ``scans`` or ``due`` (clock in ms) say when it ends, None for never.

    ``memory`` and ``offset`` are where its instance lies; ``length`` is LEN or MLEN as it was given, ``result`` STATUS
    and bytes once the drive has answered.
    """

    memory: Memory
    offset: int
    write: bool
    address: int
    index: int
    length: int
    record: Reference
    snapshot: bytes = b""
    scans: int | None = None
    due: int | None = None
    result: tuple[int, bytes] | None = None

    @property
    def room(self) -> int:
        """Bytes that go out or may come in: MLEN may be longer than RECORD, 0 takes all of it."""
        return min(self.length or self.record[2], self.record[2])


class RecordJobs:
    """All record jobs of a CPU. They go on when their block is not called: time ends them, not calls.

    ``ended`` is told of every job that the drive has answered. ``on_edge``: a job starts only if REQ was FALSE in the
    call before. Manuals say level ("REQ = 1: transfer data record"); Siemens' LAcycCom resets REQ before every job.
    """

    on_edge = False

    def __init__(
        self, bus: Periphery, clock: list[int], eno: list[bool], places: RecordPlaces, *, idle_needs_place: bool
    ) -> None:
        self.bus = bus
        self.eno = eno
        self.clock = clock
        self.places = places
        self.idle_needs_place = idle_needs_place
        self.jobs: dict[Key, RecordJob] = {}
        self.orphans: list[RecordJob] = []
        self.ended: Callable[[RecordJob], None] = _nobody

    def free(self, *, write: bool) -> bool:
        """Whether one more job finds a place."""
        if not self.jobs and not self.orphans:
            return self.places.total != 0 and self.places.each != 0
        taken = [job.write for job in (*self.jobs.values(), *self.orphans) if self.takes(job)]
        total, each = self.places.total, self.places.each
        return (total is None or len(taken) < total) and (each is None or taken.count(write) < each)

    def takes(self, job: RecordJob) -> bool:
        """Whether a job takes a place."""
        return job.result is None or self.places.until_reported

    def start(self, key: Key, job: RecordJob) -> None:
        """Take a job over; one without busy scans ends at once."""
        scans, milliseconds = self.bus.duration("WRREC" if job.write else "RDREC")
        job.scans = scans
        job.due = None if milliseconds is None else self.clock[0] + milliseconds
        self.jobs[key] = job
        self.try_end(job)

    def advance(self) -> None:
        """A scan begins: what is due ends at the drive, whether its block is called or not."""
        for job in (*self.jobs.values(), *self.orphans):
            if job.scans:
                job.scans -= 1
            self.try_end(job)
        self.orphans = [job for job in self.orphans if job.result is None]

    def try_end(self, job: RecordJob) -> None:
        """Let the drive answer if it is time."""
        if job.result is not None or (job.scans != 0 if job.due is None else job.due > self.clock[0]):
            return
        drive = self.bus.find(job.address)
        if drive is None:
            job.result = NO_MODULE, b""
        elif job.write:
            job.result = drive.write_record(job.index, job.snapshot), b""
        else:
            job.result = drive.read_record(job.index, job.room)
        self.ended(job)

    def abandon(self, memory: Memory) -> None:
        """The instances in a memory forget their jobs; these go on in the CPU."""
        for key in [key for key in self.jobs if key[0] == id(memory)]:
            job = self.jobs.pop(key)
            if job.result is None:
                self.orphans.append(job)

    def drop(self) -> None:
        """Forget every job: the CPU starts again."""
        self.jobs.clear()
        self.orphans.clear()


class RecordBlock:
    """WRREC or RDREC of one CPU: every instance has at most one job."""

    def __init__(self, system: SystemFb, shape: Shape, cpu: RecordJobs, report: Report) -> None:
        self.kind = system.block.name
        self.write = system.kind == "WRREC"
        self.cpu = cpu
        self.report = report
        self.called: dict[Key, int] = {}
        self.requested: dict[Key, bool] = {}
        """REQ in the last call of each instance."""
        self.scan = 0
        fields = shape.index
        self.req = self._bit(fields["REQ"].offset)
        self.flags = tuple(self._bit(fields[n].offset) for n in ("DONE" if self.write else "VALID", "BUSY", "ERROR"))
        self.id = fields["ID"].offset // 8
        self.id_size = fields["ID"].shape.bits // 8
        self.classic = self.id_size == 4  # where the target of RDREC must not change either (help, RDREC of S7-300/400)
        self.index = fields["INDEX"].offset // 8
        self.index_size = fields["INDEX"].shape.bits // 8
        self.length = fields["LEN" if self.write else "MLEN"].offset // 8
        self.answer = fields["LEN"].offset // 8
        self.status = fields["STATUS"].offset // 8

    @staticmethod
    def _bit(offset: int) -> tuple[int, int]:
        return offset // 8, 1 << offset % 8

    def __call__(self, memory: Memory, offset: int, record: Reference) -> None:
        """One call of the block; REQ is looked at only when no job of the instance runs."""
        key = (id(memory), offset)
        self.called[key] = self.scan
        job = self.cpu.jobs.get(key)
        starts = requested = bool(memory[offset + self.req[0]] & self.req[1])
        if self.cpu.on_edge:
            starts = requested and not self.requested.get(key)
        self.requested[key] = requested
        if job is None and not starts:
            refused = self.cpu.idle_needs_place and not self.cpu.free(write=self.write)
            self.finish(memory, offset, (False, False, refused), BUSY_RESOURCE if refused else IDLE)
            return
        address = int.from_bytes(memory[offset + self.id : offset + self.id + self.id_size])
        at = offset + self.index
        index = int.from_bytes(memory[at : at + self.index_size]) & 0xFFFF
        length = int.from_bytes(memory[offset + self.length : offset + self.length + 2])
        if job is None:
            job = RecordJob(memory, offset, self.write, address, index, length, record)
            status = self.refusal(job)
            if status:
                self.finish(memory, offset, (False, False, True), status)
                return
            self.cpu.start(key, job)
            self.go_on(memory, offset, key, job, FIRST)
            return
        self.check(job, address, index, length, record)
        self.go_on(memory, offset, key, job, RUNNING)

    def refusal(self, job: RecordJob) -> int:
        """STATUS of a job that cannot start; 0 with a snapshot of RECORD if it can."""
        target, first, room = job.record
        if target is not None and target.area == "L":
            self.report("PG831", f"RECORD of {self.kind} is local data: it is gone before the job ends")
        if target is None or first < 0 or first + room > len(target):
            self.report("PG834", f"RECORD of {self.kind} is not inside a data block")
            return BAD_RECORD
        if job.length > room:
            if self.write:
                return BAD_RECORD
            # help, RDREC: "Select the target range RECORD at least MLEN bytes long"; it says nothing of an error
            self.report("PG658", f"MLEN of {self.kind} is {job.length}, RECORD has room for {room} bytes")
        if self.cpu.bus.find(job.address) is None:
            return NO_MODULE
        if not self.cpu.free(write=self.write):
            return BUSY_RESOURCE
        job.snapshot = bytes(target[first : first + job.room])
        return 0

    def check(self, job: RecordJob, address: int, index: int, length: int, record: Reference) -> None:
        """Misuse: what must stay the same in every call of a job."""
        if record[:2] != job.record[:2] or record[0] is not job.record[0]:
            self.report("PG830", f"RECORD of {self.kind} changed during the job")
        elif length != job.length:
            self.report("PG830", f"{'LEN' if self.write else 'MLEN'} of {self.kind} changed during the job")
        elif (address, index) != (job.address, job.index):
            self.report("PG830", f"ID or INDEX of {self.kind} changed during the job")
        elif (self.write or self.classic) and record[0] is not None:
            size = len(job.snapshot)
            if record[0][record[1] : record[1] + size] != job.snapshot:
                self.report("PG830", f"the contents of RECORD of {self.kind} changed during the job")

    def go_on(self, memory: Memory, offset: int, key: Key, job: RecordJob, status: int) -> None:
        """One more call of a job: it runs, or its end is reported once."""
        if job.result is None:
            self.finish(memory, offset, (False, True, False), status)
            return
        del self.cpu.jobs[key]
        result, data = job.result
        target = job.record[0]
        if not self.write and not result and target is not None:
            target[job.record[1] : job.record[1] + len(data)] = data
            memory[offset + self.answer : offset + self.answer + 2] = len(data).to_bytes(2)
            self.finish(memory, offset, (True, False, False), self.good_status(job, len(data)))
            return
        self.finish(memory, offset, (not result, False, bool(result)), result)

    def good_status(self, job: RecordJob, came: int) -> int:
        """STATUS of a good read: on PROFIBUS STATUS[4] says which length was the shorter one (help, STATUS[4])."""
        room = job.record[2]
        if self.cpu.bus.network == "profinet":
            return 0
        shown = room if job.length > room else job.length if came < job.length < room else 0
        return shown if shown <= 0xFF else 0

    def finish(self, memory: Memory, offset: int, flags: tuple[bool, bool, bool], status: int) -> None:
        """Set the outputs of this call; ENO is FALSE with an error (help, "Overview" of asynchronous instructions)."""
        self.cpu.eno[0] = not flags[2]
        for (byte, mask), value in zip(self.flags, flags, strict=True):
            if value:
                memory[offset + byte] |= mask
            else:
                memory[offset + byte] &= 255 - mask
        struct.pack_into(">I", memory, offset + self.status, status)

    def watch(self, memory: Memory, offset: int) -> None:
        """Note a read of STATUS; PG832 if the block was not called in this scan."""
        if self.called.get((id(memory), offset)) not in {self.scan, None}:
            self.report("PG832", f"STATUS of {self.kind} is read after its scan: it is valid for one call only")
