"""Serial ports on a virtual clock, and the bus: which drive answers under which address, which port is which."""

from __future__ import annotations

from bisect import insort
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from math import ceil, inf
from typing import Literal, Protocol

from plcgen.base.line.endpoint import Endpoint

CHARACTER_BITS = 11
"""Start bit, 8 data bits, parity, stop bit."""
BAUD = {1: 300, 2: 600, 3: 1200, 4: 2400, 5: 4800, 6: 9600, 7: 19200, 8: 38400, 9: 57600, 10: 76800, 11: 115200}
"""Port_Config BAUD (TIA Portal information system, "Port_Config"); 12, 250 kbit/s, is not known to every module."""
RS485 = 4
"""Port_Config MODE: half duplex, two-wire."""
MAX_STORED = 4096
"""Bytes a module keeps until they are fetched."""


@dataclass(frozen=True, slots=True)
class PortSettings:
    """How a port is set: ``even`` parity with 8 data bits and 1 stop bit, MODE, ``clear`` if no character is taken for
    XON or XOFF. ``gap_bits`` without a character end a message, so do ``max_length`` bytes; 0: they do not. Any
    character begins one if ``any_start``, not only one behind an idle line.
    """

    baud: int = 9600
    even: bool = True
    mode: int = RS485
    clear: bool = True
    gap_bits: int = 35
    max_length: int = 512
    any_start: bool = True


UNSET = PortSettings(even=False, mode=0, gap_bits=0, max_length=0, any_start=False)
"""A port that nobody has set: the defaults of Port_Config and Receive_Config, which end no message at all."""


@dataclass(slots=True)
class Port:
    """One port.

    ``peer`` hears what is sent when the last character has left; ``line_baud`` is the speed of the stations: if speed,
    parity or wiring differ nobody understands anybody. ``hardware`` are the settings that the module has when it gets
    power, ``settings`` those of now. ``calls`` is how many calls a job of a block takes at least.

    Faults: ``faults`` maps the n-th transmission (from 1, 0: every one) to a STATUS it fails with; ``hang`` keeps
    transmissions busy, ``stuck`` a RESET of P_SND_RK; ``refusals`` maps a block such as RECEIVE_RESET to the STATUS it
    fails with; ``echo``: the module hears what it sends, while it sends it.

    ``configured`` and ``conditioned`` count the jobs of Port_Config and Receive_Config. ``fetched`` are the last
    messages that a block has taken.
    """

    peer: Endpoint | None = None
    line_baud: int = 9600
    hardware: PortSettings = PortSettings()
    calls: int = 2
    faults: dict[int, int] = field(default_factory=dict)
    hang: bool = False
    stuck: bool = False
    refusals: dict[str, int] = field(default_factory=dict)
    echo: bool = False
    time: float = 0.0
    sent: list[tuple[float, bytes]] = field(default_factory=list)
    fetched: deque[bytes] = field(default_factory=lambda: deque(maxlen=100))
    configured: int = 0
    conditioned: int = 0
    transmissions: int = 0
    settings: PortSettings = field(init=False)
    _busy_until: float = 0.0
    _outgoing: bytes = b""
    _waiting: deque[bytes] = field(default_factory=deque)
    _arrivals: list[tuple[float, int]] = field(default_factory=list)
    _messages: deque[bytes] = field(default_factory=deque)

    def __post_init__(self) -> None:
        self.settings = self.hardware

    @property
    def character(self) -> float:
        """Duration of one character in ms."""
        return CHARACTER_BITS * 1000 / self.settings.baud

    @property
    def gap(self) -> float:
        """Silence in ms that ends a message; endless if silence ends none."""
        return self.settings.gap_bits * 1000 / self.settings.baud if self.settings.gap_bits else inf

    @property
    def transmitting(self) -> bool:
        """Whether characters of a transmission are still leaving."""
        return bool(self._outgoing)

    def transmit(self, data: bytes) -> int:
        """Begin a transmission; STATUS of a failure, 0 if it runs."""
        self.transmissions += 1
        status = self.faults.get(self.transmissions) or self.faults.get(0, 0)
        if not status:
            self._waiting.append(data)
            self.begin()
        return status

    def begin(self) -> None:
        """Send what waits, if nothing is being sent."""
        if self._waiting and not self._outgoing:
            self._outgoing = self._waiting.popleft()
            self._busy_until = inf if self.hang else self.time + len(self._outgoing) * self.character
            if self.echo and not self.hang:
                self._arrive(self.time, self._outgoing)

    def set(self, settings: PortSettings) -> None:
        """Take other settings: what was received so far is thrown away."""
        self.settings = settings
        self._arrivals.clear()
        self._messages.clear()

    def power_up(self) -> None:
        """The module gets power: it has the settings of the hardware configuration."""
        self.set(self.hardware)

    def restart(self) -> None:
        """The CPU starts again: what was stored or is being sent is gone, the settings are those of the hardware."""
        self._outgoing = b""
        self._waiting.clear()
        self.power_up()

    def inject(self, delay: float, data: bytes) -> None:
        """Characters of somebody else, the first one ending ``delay`` ms plus one character from now."""
        self._arrive(self.time + delay, data)

    def deliver(self, message: bytes) -> None:
        """A message that has arrived."""
        self._messages.append(message)

    def advance(self, milliseconds: float) -> None:
        """Let time pass."""
        self.time += milliseconds
        if self._busy_until == inf and not self.hang:
            self._outgoing, self._busy_until = b"", self.time  # what hung is lost
        while self._outgoing and self._busy_until <= self.time:
            data, end = self._outgoing, self._busy_until
            self._outgoing = b""
            self.sent.append((end, data))
            self.listen(end)
            if self.understood and self.peer is not None:
                self.peer.receive(data, ceil(end))
            self.begin()
        self.listen(self.time)
        self._collect()

    @property
    def understood(self) -> bool:
        """Whether port and stations have the same speed and parity and the wires of RS485."""
        settings = self.settings
        return settings.even and settings.clear and settings.mode == RS485 and settings.baud == self.line_baud

    def listen(self, until: float) -> None:
        """Take what the stations send up to a time; characters that come while the port sends are lost."""
        while self.peer is not None and (due := self.peer.due()) is not None and due <= until:
            data = self.peer.transmit(due)
            if self.understood and not self._outgoing:
                self._arrive(float(due), data)

    def _arrive(self, start: float, data: bytes) -> None:
        character = self.character
        for number, byte in enumerate(data, 1):
            insort(self._arrivals, (start + number * character, byte), key=lambda entry: entry[0])

    def _collect(self) -> None:
        """Turn arrived characters into messages."""
        gap, most = self.gap, self.settings.max_length or MAX_STORED
        while self._arrivals:
            message = bytearray()
            last = self._arrivals[0][0]
            for at, byte in self._arrivals:
                if at > self.time or at - last > gap or len(message) >= most:
                    break
                message.append(byte)
                last = at
            if not message or (last + gap > self.time and len(message) < most):
                return
            del self._arrivals[: len(message)]
            if sum(map(len, self._messages)) + len(message) <= MAX_STORED:
                self._messages.append(bytes(message))

    @property
    def waiting(self) -> bool:
        """Whether a complete message can be fetched."""
        return bool(self._messages)

    @property
    def size(self) -> int:
        """Bytes of the message that is fetched next."""
        return len(self._messages[0]) if self._messages else 0

    def fetch(self) -> bytes:
        """The oldest complete message."""
        message = self._messages.popleft()
        self.fetched.append(message)
        return message

    def clear(self) -> None:
        """Throw away what was received so far."""
        self._messages.clear()
        self._arrivals = [entry for entry in self._arrivals if entry[0] > self.time]


class RecordServer(Protocol):
    """What answers WRREC and RDREC at an address: a simulated drive."""

    def write_record(self, index: int, data: bytes) -> int:
        """Take a data record; returns the STATUS, 0 if it is good."""

    def read_record(self, index: int, max_length: int) -> tuple[int, bytes]:
        """Return STATUS and the bytes of a data record."""

    def advance(self, milliseconds: int) -> None:
        """Let time pass."""


Busy = int | Callable[[], int]

_OUTPUT_BIT = 0x8000


@dataclass(slots=True)
class Periphery:
    """Drives by logical address or hardware identifier.

    ``write_busy`` and ``read_busy`` say how many scans a job takes: as many calls, one a scan, answer BUSY. A function
    is asked anew for every job. None keeps a job busy forever. ``write_time`` and ``read_time`` say it in ms instead.
    ``network`` is that of the drives: on PROFIBUS a good RDREC may set STATUS[4]. ``ports`` are serial ports by
    hardware identifier (S7-1200/1500) or address of their module (S7-300/400).
    """

    drives: dict[int, RecordServer] = field(default_factory=dict)
    write_busy: Busy | None = 2
    read_busy: Busy | None = 2
    ports: dict[int, Port] = field(default_factory=dict)
    write_time: Busy | None = None
    read_time: Busy | None = None
    network: Literal["profinet", "profibus"] = "profinet"

    def attach(self, address: int, drive: RecordServer) -> None:
        """Put a drive at a logical address or hardware identifier."""
        self.drives[address] = drive

    def find(self, address: int) -> RecordServer | None:
        """Return the drive at an address; bit 15 of an output-only module is looked through."""
        return self.drives.get(address) or self.drives.get(address & ~_OUTPUT_BIT & 0xFFFFFFFF)

    def duration(self, kind: str) -> tuple[int | None, int | None]:
        """Scans and milliseconds that the next job takes; milliseconds are None unless they decide."""
        time = self.write_time if kind == "WRREC" else self.read_time
        if time is not None:
            return None, time() if callable(time) else time
        chosen = self.write_busy if kind == "WRREC" else self.read_busy
        return chosen() if callable(chosen) else chosen, None

    def advance(self, milliseconds: int) -> None:
        """Let time pass for every drive once."""
        if self.drives:
            for drive in {id(drive): drive for drive in self.drives.values()}.values():
                drive.advance(milliseconds)
        for port in self.ports.values():
            port.advance(milliseconds)
