"""WRREC and RDREC: asynchronous record jobs between instance memory and the drives of the bus."""

from __future__ import annotations

import struct
from collections.abc import Callable
from dataclasses import dataclass

from plcgen.cpu.memory import Memory, Reference
from plcgen.cpu.system.bus import Periphery
from plcgen.cpu.system.interfaces import SystemFb
from plcgen.s7.shapes import Shape

IDLE, FIRST, RUNNING = 0x00700000, 0x00700100, 0x00700200
NO_MODULE, BUSY_RESOURCE, BAD_RECORD = 0xC0809000, 0xC080C300, 0xC080B100
"""STATUS of local errors: no such address, too many jobs at once, RECORD does not hold LEN bytes."""

Report = Callable[[str, str], None]


@dataclass(slots=True)
class RecordJob:
    """A running record job; ``calls`` is how many calls still answer BUSY, None for ever."""

    address: int
    index: int
    length: int
    record: Reference
    snapshot: bytes
    calls: int | None


class RecordBlock:
    """WRREC or RDREC of one CPU: every instance has at most one job, the CPU a bounded number."""

    def __init__(self, system: SystemFb, shape: Shape, bus: Periphery, report: Report, limit: int) -> None:
        self.kind = system.block.name
        self.write = system.kind == "WRREC"
        self.bus = bus
        self.report = report
        self.limit = limit
        self.jobs: dict[tuple[int, int], RecordJob] = {}
        self.called: dict[tuple[int, int], int] = {}
        self.scan = 0
        fields = shape.index
        self.req = self._bit(fields["REQ"].offset)
        self.flags = tuple(self._bit(fields[n].offset) for n in ("DONE" if self.write else "VALID", "BUSY", "ERROR"))
        self.id = fields["ID"].offset // 8
        self.id_size = fields["ID"].shape.bits // 8
        self.index = fields["INDEX"].offset // 8
        self.index_size = fields["INDEX"].shape.bits // 8
        self.length = fields["LEN" if self.write else "MLEN"].offset // 8
        self.answer = fields["LEN"].offset // 8
        self.status = fields["STATUS"].offset // 8

    @staticmethod
    def _bit(offset: int) -> tuple[int, int]:
        return offset // 8, 1 << offset % 8

    def __call__(self, memory: Memory, offset: int, record: Reference) -> None:
        """One call of the block."""
        key = (id(memory), offset)
        self.called[key] = self.scan
        requested = bool(memory[offset + self.req[0]] & self.req[1])
        job = self.jobs.get(key)
        if job is None and not requested:
            self.finish(memory, offset, (False, False, False), IDLE)
            return
        address = int.from_bytes(memory[offset + self.id : offset + self.id + self.id_size])
        at = offset + self.index
        index = int.from_bytes(memory[at : at + self.index_size]) & 0xFFFF
        length = int.from_bytes(memory[offset + self.length : offset + self.length + 2])
        if job is None:
            self.start(memory, offset, key, RecordJob(address, index, length, record, b"", 0))
            return
        if requested:
            self.report("PG833", f"REQ of {self.kind} is still TRUE while its job runs")
        self.check(job, address, index, length, record)
        self.go_on(memory, offset, key, job, RUNNING)

    def start(self, memory: Memory, offset: int, key: tuple[int, int], job: RecordJob) -> None:
        """Take a job over, with a snapshot of RECORD."""
        target, first, room = job.record
        if target is not None and target.area == "L":
            self.report("PG831", f"RECORD of {self.kind} is local data: it is gone before the job ends")
        if target is None or first < 0 or first + room > len(target):
            self.report("PG834", f"RECORD of {self.kind} does not lie inside a data block")
            self.finish(memory, offset, (False, False, True), BAD_RECORD)
            return
        if job.length > room and self.write:
            self.finish(memory, offset, (False, False, True), BAD_RECORD)
            return
        if self.bus.find(job.address) is None:
            self.finish(memory, offset, (False, False, True), NO_MODULE)
            return
        if len(self.jobs) >= self.limit:
            self.finish(memory, offset, (False, False, True), BUSY_RESOURCE)
            return
        size = job.length or room
        job.snapshot = bytes(target[first : first + size])
        if not self.write:
            job.length = min(size, room)
        job.calls = self.bus.busy_calls("WRREC" if self.write else "RDREC")
        self.jobs[key] = job
        self.go_on(memory, offset, key, job, FIRST)

    def check(self, job: RecordJob, address: int, index: int, length: int, record: Reference) -> None:
        """Misuse: what must stay the same in every call of a job."""
        if record[:2] != job.record[:2] or record[0] is not job.record[0]:
            self.report("PG830", f"RECORD of {self.kind} changed during the job")
        elif length != job.length and (self.write or length):
            self.report("PG830", f"{'LEN' if self.write else 'MLEN'} of {self.kind} changed during the job")
        elif (address, index) != (job.address, job.index):
            self.report("PG830", f"ID or INDEX of {self.kind} changed during the job")
        elif self.write and record[0] is not None:
            size = len(job.snapshot)
            if record[0][record[1] : record[1] + size] != job.snapshot:
                self.report("PG830", f"the contents of RECORD of {self.kind} changed during the job")

    def go_on(self, memory: Memory, offset: int, key: tuple[int, int], job: RecordJob, status: int) -> None:
        """One more call of a running job."""
        if job.calls is None or job.calls > 0:
            if job.calls is not None:
                job.calls -= 1
            self.finish(memory, offset, (False, True, False), status)
            return
        del self.jobs[key]
        drive = self.bus.find(job.address)
        if drive is None:
            self.finish(memory, offset, (False, False, True), NO_MODULE)
            return
        if self.write:
            result = drive.write_record(job.index, job.snapshot)
        else:
            result, data = drive.read_record(job.index, job.length)
            target = job.record[0]
            if not result and target is not None:
                target[job.record[1] : job.record[1] + len(data)] = data
                memory[offset + self.answer : offset + self.answer + 2] = len(data).to_bytes(2)
        self.finish(memory, offset, (not result, False, bool(result)), result)

    def finish(self, memory: Memory, offset: int, flags: tuple[bool, bool, bool], status: int) -> None:
        """Set the outputs of this call."""
        for (byte, mask), value in zip(self.flags, flags, strict=True):
            if value:
                memory[offset + byte] |= mask
            else:
                memory[offset + byte] &= 255 - mask
        struct.pack_into(">I", memory, offset + self.status, status)

    def drop(self) -> None:
        """Forget every job: the CPU starts again."""
        self.jobs.clear()

    def watch(self, memory: Memory, offset: int) -> None:
        """Note a read of STATUS; PG832 if the block was not called in this scan."""
        if self.called.get((id(memory), offset)) not in {self.scan, None}:
            self.report("PG832", f"STATUS of {self.kind} is read after its scan: it counts for one call only")
