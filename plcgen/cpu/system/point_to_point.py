"""Blocks of serial modules: Send_P2P, Receive_P2P, Receive_Reset, Port_Config (S7-1200/1500), P_SND_RK, P_RCV_RK.

Sources: TIA Portal information system, "Point-to-point" (S7-1200/1500) and "PtP data link CP 341" (S7-300/400).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from plcgen.cpu.memory import Memory, Reference
from plcgen.cpu.system.bus import Periphery
from plcgen.cpu.system.interfaces import SystemFb
from plcgen.cpu.system.port import BAUD, Port
from plcgen.cpu.system.timers import Fields
from plcgen.s7.shapes import Shape

IDLE, FIRST, RUNNING = 0x7000, 0x7001, 0x7002
NO_PORT, BAD_LENGTH, STILL_SENDING = 0x8080, 0x8088, 0x80D0
WRONG_VALUES = {"BAUD": 0x80A1, "PARITY": 0x80A2, "DATABITS": 0x80A3, "STOPBITS": 0x80A4, "FLOWCTRL": 0x80A5}
ALLOWED = {"BAUD": range(1, 12), "PARITY": range(1, 6), "DATABITS": (1, 2), "STOPBITS": (1, 2), "FLOWCTRL": range(1, 5)}
CP_NO_MODULE, CP_BAD_LENGTH, CP_NO_DB = 0x1E0E, 0x1E41, 0x1E0F

Report = Callable[[str, str], None]
Locate = Callable[[str, int], Memory | None]
Key = tuple[int, int]


@dataclass(slots=True)
class Transfer:
    """A running job: ``calls`` is how many calls it takes at least."""

    port: Port
    place: tuple[int, int]
    memory: Memory | None
    data: bytes
    calls: int
    length: int = 0


class PortBlock:
    """What the blocks of serial modules have in common: one job an instance, edges, flags of one call."""

    ready = "DONE"
    port = "PORT"

    def __init__(self, system: SystemFb, shape: Shape, bus: Periphery, report: Report, locate: Locate) -> None:
        self.kind = system.block.name
        self.bus = bus
        self.report = report
        self.locate = locate
        self.fields = Fields(shape)
        self.jobs: dict[Key, Transfer] = {}
        self.old: dict[Key, bool] = {}
        self.called: dict[Key, int] = {}
        self.scan = 0

    def __call__(self, memory: Memory, offset: int, buffer: Reference = (None, 0, 0)) -> None:
        """One call of the block."""
        key = id(memory), offset
        self.called[key] = self.scan
        requested = self.bit(memory, offset, "REQ")
        edge, self.old[key] = requested and not self.old.get(key, False), requested
        job = self.jobs.get(key)
        if job is not None:
            if edge:
                self.report("PG830", f"REQ of {self.kind} rises again while its job runs")
            self.check(job, memory, offset, buffer)
            self.go_on(memory, offset, key, job, RUNNING)
        elif edge:
            self.start(memory, offset, key, buffer)
        else:
            self.finish(memory, offset, (False, False), IDLE)

    # --- what a block does ----------------------------------------------------------------------------

    def start(self, memory: Memory, offset: int, key: Key, _buffer: Reference) -> None:
        """Take a job over."""
        port = self.find(memory, offset)
        if port is None:
            self.finish(memory, offset, (False, True), NO_PORT)
            return
        self.jobs[key] = Transfer(port, (0, 0), None, b"", port.calls)
        self.go_on(memory, offset, key, self.jobs[key], FIRST)

    def check(self, job: Transfer, memory: Memory, offset: int, buffer: Reference) -> None:
        """Misuse: what must stay the same in every call of a job."""

    def go_on(self, memory: Memory, offset: int, key: Key, job: Transfer, status: int) -> None:
        """One more call of a running job."""
        job.calls -= 1
        if job.calls > 0 or self.working(job):
            self.finish(memory, offset, (False, False), status)
            return
        del self.jobs[key]
        self.act(memory, offset, job)
        self.finish(memory, offset, (True, False), 0)

    def working(self, _job: Transfer) -> bool:
        """Whether the module has not finished yet."""
        return False

    def act(self, _memory: Memory, _offset: int, job: Transfer) -> None:
        """What happens at the end of a job."""

    # --- memory ---------------------------------------------------------------------------------------

    def bit(self, memory: Memory, offset: int, name: str) -> bool:
        """BOOL of the instance; False if the block has no such parameter."""
        if name not in self.fields.places:
            return False
        byte, mask = self.fields.flag(name)
        return bool(memory[offset + byte] & mask)

    def number(self, memory: Memory, offset: int, name: str) -> int:
        """Unsigned number of the instance."""
        byte, _, bits = self.fields.places[name]
        return int.from_bytes(memory[offset + byte : offset + byte + bits // 8])

    def find(self, memory: Memory, offset: int) -> Port | None:
        """The port a call names."""
        return self.bus.ports.get(self.number(memory, offset, self.port))

    def finish(self, memory: Memory, offset: int, flags: tuple[bool, bool], status: int) -> None:
        """Set the outputs of this call."""
        for name, value in zip((self.ready, "ERROR"), flags, strict=True):
            byte, mask = self.fields.flag(name)
            memory[offset + byte] = memory[offset + byte] | mask if value else memory[offset + byte] & 255 - mask
        self.fields.put(memory, offset, "STATUS", status)

    def drop(self) -> None:
        """Forget every job: the CPU starts again."""
        for port in self.bus.ports.values():
            port.restart()
        self.jobs.clear()
        self.old.clear()

    def watch(self, memory: Memory, offset: int) -> None:
        """Note a read of STATUS; PG832 if the block was not called in this scan."""
        if self.called.get((id(memory), offset)) not in {self.scan, None}:
            self.report("PG832", f"STATUS of {self.kind} is read after its scan: it counts for one call only")


class Sender(PortBlock):
    """Send_P2P: DONE when the last character has left."""

    too_long = BAD_LENGTH
    no_port = NO_PORT
    area, length = "BUFFER", "LENGTH"
    queues = False
    """Whether the module keeps a further frame while it sends."""

    def source(self, _memory: Memory, _offset: int, buffer: Reference) -> Reference:
        """Where the bytes lie."""
        return buffer

    def start(self, memory: Memory, offset: int, key: Key, buffer: Reference) -> None:
        """Take the bytes over and begin to send."""
        area, first, room = self.source(memory, offset, buffer)
        length = self.number(memory, offset, self.length)
        port = self.find(memory, offset)
        if area is None or first < 0 or not 0 < (length or room) <= room or first + room > len(area):
            self.report("PG834", f"{self.length} {length} of {self.kind} reaches beyond {self.area} of {room} bytes")
            self.finish(memory, offset, (False, True), self.too_long)
            return
        if area.area == "L":
            self.report("PG831", f"{self.area} of {self.kind} is local data: it is gone before the job ends")
        if port is None:
            self.finish(memory, offset, (False, True), self.no_port)
            return
        if port.transmitting and not self.queues:
            self.report("PG837", f"{self.kind} sends through a port that is sending for another block")
            self.finish(memory, offset, (False, True), STILL_SENDING)
            return
        data = bytes(area[first : first + (length or room)])
        status = port.transmit(data)
        if status:
            self.finish(memory, offset, (False, True), status)
            return
        self.jobs[key] = Transfer(port, (id(area), first), area, data, port.calls, length)
        self.go_on(memory, offset, key, self.jobs[key], FIRST)

    def check(self, job: Transfer, memory: Memory, offset: int, buffer: Reference) -> None:
        """The bytes and where they lie must not change while they are sent."""
        area, first, _ = self.source(memory, offset, buffer)
        if (id(area), first) != job.place:
            self.report("PG830", f"{self.area} of {self.kind} changed during the job")
        elif self.number(memory, offset, self.length) != job.length:
            self.report("PG830", f"{self.length} of {self.kind} changed during the job")
        elif job.memory is not None and job.memory[first : first + len(job.data)] != job.data:
            self.report("PG830", f"the contents of {self.area} of {self.kind} changed during the job")

    def working(self, job: Transfer) -> bool:
        """Whether characters are still leaving."""
        return job.port.transmitting


class Receiver(PortBlock):
    """Receive_P2P: hands over one message a job; a job is what begins with a message that waits."""

    ready = "NDR"
    too_long = BAD_LENGTH
    no_port = NO_PORT
    idle = RUNNING
    area, length = "BUFFER", "LENGTH"

    def __init__(self, system: SystemFb, shape: Shape, bus: Periphery, report: Report, locate: Locate) -> None:
        super().__init__(system, shape, bus, report, locate)
        self.users: dict[int, tuple[int, Key]] = {}

    def target(self, _memory: Memory, _offset: int, buffer: Reference) -> Reference:
        """Where the bytes go."""
        return buffer

    def enabled(self, _memory: Memory, _offset: int) -> bool:
        """Whether the call may receive."""
        return True

    def __call__(self, memory: Memory, offset: int, buffer: Reference = (None, 0, 0)) -> None:
        """One call of the block."""
        key = id(memory), offset
        self.called[key] = self.scan
        port = self.find(memory, offset)
        if port is None:
            self.finish(memory, offset, (False, True), self.no_port)
            return
        scan, user = self.users.get(id(port), (-1, key))
        if scan == self.scan:
            twice = "another instance of" if user != key else "a second call of"
            self.report("PG837", f"{twice} {self.kind} asks the same port in one scan")
        self.users[id(port)] = self.scan, key
        area, first, room = self.target(memory, offset, buffer)
        if area is not None and area.area == "L":
            self.report("PG831", f"{self.area} of {self.kind} is local data: what is received is lost")
        if not self.enabled(memory, offset) or not port.waiting:
            self.jobs.pop(key, None)
            self.finish(memory, offset, (False, False), self.idle)
            return
        job = self.jobs.setdefault(key, Transfer(port, (id(area), first), area, b"", port.calls))
        job.calls -= 1
        if job.calls > 0:
            self.finish(memory, offset, (False, False), self.idle)
            return
        del self.jobs[key]
        data = port.fetch()
        if area is None or first < 0 or len(data) > room or first + len(data) > len(area):
            self.report("PG834", f"{len(data)} bytes received do not fit {self.area} of {self.kind}")
            self.finish(memory, offset, (False, True), self.too_long)
            return
        area[first : first + len(data)] = data
        self.fields.put(memory, offset, self.length, len(data))
        self.finish(memory, offset, (True, False), 0)


class Reset(PortBlock):
    """Receive_Reset: what was received is thrown away."""

    def start(self, memory: Memory, offset: int, key: Key, buffer: Reference) -> None:
        """Fail at once if the module does."""
        port = self.find(memory, offset)
        if port is not None and port.reset_fault:
            self.finish(memory, offset, (False, True), port.reset_fault)
            return
        super().start(memory, offset, key, buffer)

    def act(self, _memory: Memory, _offset: int, job: Transfer) -> None:
        """Empty the buffer of the module."""
        job.port.clear()


class Configuration(PortBlock):
    """Port_Config: speed and parity of the port until the next power-up."""

    def start(self, memory: Memory, offset: int, key: Key, buffer: Reference) -> None:
        """Check the parameters first."""
        for name, status in WRONG_VALUES.items():
            if self.number(memory, offset, name) not in ALLOWED[name]:
                self.finish(memory, offset, (False, True), status)
                return
        super().start(memory, offset, key, buffer)

    def act(self, _memory: Memory, _offset: int, job: Transfer) -> None:
        """Set the port."""
        job.port.baud = BAUD[self.number(_memory, _offset, "BAUD")]
        job.port.even = (self.number(_memory, _offset, "PARITY"), self.number(_memory, _offset, "DATABITS")) == (2, 1)
        job.port.configured += 1


class CpSender(Sender):
    """P_SND_RK of the CP 341: DB_NO, DBB_NO and LEN name the bytes; R cancels."""

    port = "LADDR"
    area, length = "DB_NO, DBB_NO", "LEN"
    too_long, no_port = CP_BAD_LENGTH, CP_NO_MODULE
    queues = True

    def source(self, memory: Memory, offset: int, _buffer: Reference) -> Reference:
        """Bytes of a data block by its number, to its end."""
        return data_block(self, memory, offset)

    def __call__(self, memory: Memory, offset: int, buffer: Reference = (None, 0, 0)) -> None:
        """One call of the block; without a job STATUS is 0."""
        if self.bit(memory, offset, "R"):
            key = id(memory), offset
            self.jobs.pop(key, None)
            self.called[key] = self.scan
            self.old[key] = self.bit(memory, offset, "REQ")
            self.finish(memory, offset, (False, False), 0)
            return
        super().__call__(memory, offset, buffer)

    def finish(self, memory: Memory, offset: int, flags: tuple[bool, bool], status: int) -> None:
        """Set the outputs of this call: STATUS counts with ERROR only."""
        super().finish(memory, offset, flags, status if flags[1] else 0)


class CpReceiver(Receiver):
    """P_RCV_RK of the CP 341: the message goes to a data block by its number."""

    port = "LADDR"
    area, length = "DB_NO, DBB_NO", "LEN"
    idle = 0
    too_long, no_port = CP_BAD_LENGTH, CP_NO_MODULE

    def target(self, memory: Memory, offset: int, _buffer: Reference) -> Reference:
        """Bytes of a data block by its number, to its end."""
        return data_block(self, memory, offset)

    def enabled(self, memory: Memory, offset: int) -> bool:
        """EN_R without R."""
        return self.bit(memory, offset, "EN_R") and not self.bit(memory, offset, "R")


def data_block(block: PortBlock, memory: Memory, offset: int) -> Reference:
    """What DB_NO and DBB_NO name: from there to the end of the data block."""
    found = block.locate("DB", block.number(memory, offset, "DB_NO"))
    first = block.number(memory, offset, "DBB_NO")
    return found, first, max(0, len(found) - first) if found is not None else 0


PORT_BLOCKS: dict[str, type[PortBlock]] = {
    "SEND_P2P": Sender,
    "RECEIVE_P2P": Receiver,
    "RECEIVE_RESET": Reset,
    "PORT_CONFIG": Configuration,
    "P_SND_RK": CpSender,
    "P_RCV_RK": CpReceiver,
}
"""Behaviour by the name of the block."""
