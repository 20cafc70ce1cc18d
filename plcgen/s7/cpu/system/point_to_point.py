"""Blocks of serial modules: Send_P2P, Receive_P2P, Receive_Reset, Port_Config, Receive_Config (S7-1200/1500), P_SND_RK,
P_RCV_RK (S7-300).

Sources: TIA Portal information system, "Point-to-point" (parameters, "Error messages") and "PtP data link CP 341";
manual "CP 341, Installation and Parameter Assignment", A5E02191071-01, table 6-15 (calls of a job, RESET).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache

from plcgen.s7.cpu.memory import Memory, Reference
from plcgen.s7.cpu.system.interfaces import SystemFb
from plcgen.s7.cpu.system.port import BAUD, Periphery, Port
from plcgen.s7.cpu.system.timers import Fields
from plcgen.s7.layout.layout import layout_block, locate
from plcgen.s7.layout.shapes import Shape
from plcgen.s7.types.system import RECEIVE_CONDITIONS

IDLE, FIRST, RUNNING = 0x7000, 0x7001, 0x7002
NO_PORT, BAD_LENGTH, STILL_SENDING = 0x8080, 0x8088, 0x81D0
ALLOWED = {
    "PROTOCOL": (range(2), 0x81A0),
    "BAUD": (range(1, 12), 0x81A1),
    "PARITY": (range(1, 7), 0x81A2),
    "DATABITS": (range(1, 3), 0x81A3),
    "STOPBITS": (range(1, 3), 0x81A4),
    "FLOWCTRL": (range(1, 6), 0x81A5),
    "MODE": (range(5), 0x81AA),
    "LINE_PRE": (range(3), 0x81AB),
    "BRK_DET": (range(2), 0x81AC),
}
"""Values of the parameters of Port_Config, and the STATUS of all others."""
BREAK_LINE, BREAK_MODES = 1, (1, 3)
"""LINE_PRE 1, R(A) 5 V and R(B) 0 V, exists with four wires only, point-to-point or as a slave."""
ANY_CHARACTER, IDLE_LINE = 0x02, 0x08
GAP_ENDS, LENGTH_ENDS, ALL_ENDS = 0x04, 0x08, 0x7F
MOST_LENGTH = 4096
BAD_START, BAD_END, BAD_MAXLEN, BAD_GAP = 0x81C0, 0x81C1, 0x81C3, 0x81C9
CP_PIECE, CP_MORE_CALLS, CP_RESET_CALLS = 32, 2, 4
"""Bytes that a CP 341 moves in a program cycle; calls of a job beside those, three for up to 32 bytes; least calls of a
RESET.
"""
CP_NO_MODULE, CP_BAD_LENGTH = 0x1E0E, 0x1E41

Report = Callable[[str, str], None]
Locate = Callable[[str, int], Memory | None]
Key = tuple[int, int]


@dataclass(slots=True)
class Transfer:
    """A running job: ``calls`` is how many calls it takes at least, ``settings`` gap and length of a Receive_Config,
    ``any_start`` whether any character begins a message.
    """

    port: Port
    place: tuple[int, int]
    memory: Memory | None
    data: bytes
    calls: int
    length: int = 0
    settings: tuple[int, int] = (0, 0)
    any_start: bool = False


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
        status = NO_PORT if port is None else port.refusals.get(self.kind.upper(), 0)
        if port is None or status:
            self.finish(memory, offset, (False, True), status)
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
            self.report("PG832", f"STATUS of {self.kind} is read after its scan: it is valid for one call only")


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
        self.take(memory, offset, key, Transfer(port, (id(area), first), area, data, port.calls, length))

    def take(self, memory: Memory, offset: int, key: Key, job: Transfer) -> None:
        """The module takes all bytes at once and begins to send them."""
        status = job.port.transmit(job.data)
        if status:
            self.finish(memory, offset, (False, True), status)
            return
        self.jobs[key] = job
        self.go_on(memory, offset, key, job, FIRST)

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

    def needed(self, port: Port) -> int:
        """Calls that hand over the message that waits."""
        return port.calls

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
        refused = port.refusals.get(self.kind.upper(), 0)
        if refused or not self.enabled(memory, offset) or not port.waiting:
            self.jobs.pop(key, None)
            self.finish(memory, offset, (False, bool(refused)), refused or self.idle)
            return
        job = self.jobs.setdefault(key, Transfer(port, (id(area), first), area, b"", self.needed(port)))
        if (id(area), first) != job.place:
            self.report("PG830", f"{self.area} of {self.kind} changed while it receives")
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

    def act(self, _memory: Memory, _offset: int, job: Transfer) -> None:
        """Empty the buffer of the module."""
        job.port.clear()


class Configuration(PortBlock):
    """Port_Config: speed, parity and wiring of the port until the module gets power again."""

    def start(self, memory: Memory, offset: int, key: Key, buffer: Reference) -> None:
        """Check the parameters first."""
        found = {name: self.number(memory, offset, name) for name in ALLOWED}
        wrong = [status for name, (values, status) in ALLOWED.items() if found[name] not in values]
        if found["LINE_PRE"] == BREAK_LINE and found["MODE"] not in BREAK_MODES:
            wrong.append(ALLOWED["LINE_PRE"][1])
        if wrong:
            self.finish(memory, offset, (False, True), wrong[0])
            return
        super().start(memory, offset, key, buffer)

    def act(self, memory: Memory, offset: int, job: Transfer) -> None:
        """Set the port."""
        value = {name: self.number(memory, offset, name) for name in ALLOWED}
        settings = replace(
            job.port.settings,
            baud=BAUD[value["BAUD"]],
            even=(value["PARITY"], value["DATABITS"], value["STOPBITS"]) == (2, 1, 1),
            mode=value["MODE"],
            clear=(value["PROTOCOL"], value["FLOWCTRL"], value["BRK_DET"]) == (0, 1, 0),
        )
        job.port.set(settings)
        job.port.configured += 1


@cache
def conditions() -> dict[str, int]:
    """Where the members of Receive_Conditions lie that are looked at; all of them are words."""
    layout = layout_block(RECEIVE_CONDITIONS, {})
    names = ("START.STARTCOND", "END.ENDCOND", "END.MAXLEN", "END.CHARGAP")
    return {name: locate(layout, name).byte for name in names}


class ReceiveConfiguration(PortBlock):
    """Receive_Config: what begins and ends a message, until the module gets power again.

    Any character or an idle line may begin one, a gap between characters or a number of bytes end it. With other
    conditions nothing is received here.
    """

    def start(self, memory: Memory, offset: int, key: Key, buffer: Reference) -> None:
        """Read the conditions and check them."""
        area, first, room = buffer
        if area is None or room < layout_block(RECEIVE_CONDITIONS, {}).size:
            self.report("PG834", f"RECEIVE_CONDITIONS of {self.kind} is not a Receive_Conditions")
            self.finish(memory, offset, (False, True), BAD_START)
            return
        start, end, most, gap = (int.from_bytes(area[first + at : first + at + 2]) for at in conditions().values())
        wrong = 0
        if not 0 < start <= 0xFF or (start & ANY_CHARACTER and start != ANY_CHARACTER):
            wrong = BAD_START
        elif not 0 < end <= ALL_ENDS:
            wrong = BAD_END
        elif end & LENGTH_ENDS and not 0 < most <= MOST_LENGTH:
            wrong = BAD_MAXLEN
        elif end & GAP_ENDS and not gap:
            wrong = BAD_GAP
        if wrong:
            self.finish(memory, offset, (False, True), wrong)
            return
        super().start(memory, offset, key, buffer)
        job = self.jobs.get(key)
        if job is not None:
            known = start in {ANY_CHARACTER, IDLE_LINE} and not end & ~(GAP_ENDS | LENGTH_ENDS)
            job.any_start = start == ANY_CHARACTER
            job.settings = gap if known and end & GAP_ENDS else 0, most if known and end & LENGTH_ENDS else 0

    def act(self, _memory: Memory, _offset: int, job: Transfer) -> None:
        """Set the port."""
        gap_bits, max_length = job.settings
        settings = replace(job.port.settings, gap_bits=gap_bits, max_length=max_length, any_start=job.any_start)
        job.port.set(settings)
        job.port.conditioned += 1


class CpSender(Sender):
    """P_SND_RK of the CP 341: DB_NO, DBB_NO and LEN name the bytes, 32 go to the CP with each call; R cancels."""

    port = "LADDR"
    area, length = "DB_NO, DBB_NO", "LEN"
    too_long, no_port = CP_BAD_LENGTH, CP_NO_MODULE
    queues = True

    def __init__(self, system: SystemFb, shape: Shape, bus: Periphery, report: Report, locate: Locate) -> None:
        super().__init__(system, shape, bus, report, locate)
        self.resets: dict[Key, int] = {}

    def source(self, memory: Memory, offset: int, _buffer: Reference) -> Reference:
        """Bytes of a data block by its number, to its end."""
        return data_block(self, memory, offset)

    def take(self, memory: Memory, offset: int, key: Key, job: Transfer) -> None:
        """The bytes go to the CP piece by piece; it sends when it has them all. With the ASCII driver it only sends."""
        if self.number(memory, offset, "SF") != ord("S"):
            self.report("PG834", f"SF of {self.kind} is not 'S': the ASCII driver fetches nothing")
            self.finish(memory, offset, (False, True), self.too_long)
            return
        job.calls = CP_MORE_CALLS + -(-len(job.data) // CP_PIECE)
        self.jobs[key] = job
        self.go_on(memory, offset, key, job, FIRST)

    def go_on(self, memory: Memory, offset: int, key: Key, job: Transfer, status: int) -> None:
        """One more piece; the CP sends in the call in which it has all of them."""
        job.calls -= 1
        fault = job.port.transmit(job.data) if job.calls == 1 else 0
        if fault:
            del self.jobs[key]
            self.finish(memory, offset, (False, True), fault)
        elif job.calls > 0 or self.working(job):
            self.finish(memory, offset, (False, False), status)
        else:
            del self.jobs[key]
            self.finish(memory, offset, (True, False), 0)

    def __call__(self, memory: Memory, offset: int, buffer: Reference = (None, 0, 0)) -> None:
        """One call of the block; without a job STATUS is 0."""
        key = id(memory), offset
        if not self.bit(memory, offset, "R"):
            self.resets.pop(key, None)
            super().__call__(memory, offset, buffer)
            return
        self.jobs.pop(key, None)
        self.called[key] = self.scan
        self.old[key] = self.bit(memory, offset, "REQ")
        port = self.find(memory, offset)
        if port is None:
            self.finish(memory, offset, (False, True), self.no_port)
            return
        self.resets[key] = self.resets.get(key, 0) + (not port.stuck)
        self.finish(memory, offset, (self.resets[key] == CP_RESET_CALLS, False), 0)

    def drop(self) -> None:
        """Forget every job and every RESET."""
        super().drop()
        self.resets.clear()

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

    def needed(self, port: Port) -> int:
        """32 bytes with each call."""
        return CP_MORE_CALLS + -(-port.size // CP_PIECE)

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
    "RECEIVE_CONFIG": ReceiveConfiguration,
    "P_SND_RK": CpSender,
    "P_RCV_RK": CpReceiver,
}
"""Behaviour by the name of the block."""
