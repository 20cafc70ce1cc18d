"""A serial port of a communication module: characters on a virtual clock, messages by the gaps between them."""

from __future__ import annotations

from bisect import insort
from collections import deque
from dataclasses import dataclass, field
from math import floor, inf

from plcgen.line.endpoint import Endpoint

CHARACTER_BITS = 11
"""Start bit, 8 data bits, parity, stop bit."""
BAUD = {1: 300, 2: 600, 3: 1200, 4: 2400, 5: 4800, 6: 9600, 7: 19200, 8: 38400, 9: 57600, 10: 76800, 11: 115200}
"""Port_Config BAUD (S7-1200 system manual, Port_Config)."""
MAX_STORED = 4096
"""Bytes a module keeps until they are fetched."""


@dataclass(slots=True)
class Port:
    """One port.

    ``peer`` hears what is sent when the last character has left; ``line_baud`` is the speed of the stations,
    ``baud`` that of the port, ``even`` its parity: if they differ nobody understands anybody. ``gap_bits`` ends a
    message, so does ``max_length``. ``calls`` is how many calls a job of a block takes at least. ``faults`` maps
    the n-th transmission (from 1, 0: every one) to a STATUS it fails with; ``hang`` keeps transmissions busy,
    ``reset_fault`` is the STATUS that Receive_Reset fails with.
    """

    peer: Endpoint | None = None
    baud: int = 9600
    line_baud: int = 9600
    even: bool = True
    gap_bits: int = 35
    max_length: int = 512
    calls: int = 2
    faults: dict[int, int] = field(default_factory=dict)
    hang: bool = False
    reset_fault: int = 0
    time: float = 0.0
    sent: list[tuple[float, bytes]] = field(default_factory=list)
    configured: int = 0
    transmissions: int = 0
    _busy_until: float = 0.0
    _outgoing: bytes = b""
    _waiting: deque[bytes] = field(default_factory=deque)
    _arrivals: list[tuple[float, int]] = field(default_factory=list)
    _messages: deque[bytes] = field(default_factory=deque)

    @property
    def character(self) -> float:
        """Duration of one character in ms."""
        return CHARACTER_BITS * 1000 / self.baud

    @property
    def gap(self) -> float:
        """Silence in ms that ends a message."""
        return self.gap_bits * 1000 / self.baud

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

    def restart(self) -> None:
        """The CPU starts again: what was stored or is being sent is gone, the configuration is that of the hardware."""
        self._outgoing = b""
        self._waiting.clear()
        self._arrivals.clear()
        self._messages.clear()

    def inject(self, delay: float, data: bytes) -> None:
        """Characters of somebody else, the first one ending ``delay`` ms plus one character from now."""
        self._arrive(self.time + delay, data)

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
                self.peer.receive(data, floor(end))
            self.begin()
        self.listen(self.time)
        self._collect()

    @property
    def understood(self) -> bool:
        """Whether port and stations have the same speed and parity."""
        return self.even and self.baud == self.line_baud

    def listen(self, until: float) -> None:
        """Take what the stations send up to a time; characters that come while the port sends are lost."""
        while self.peer is not None and (due := self.peer.due()) is not None and due <= until:
            data = self.peer.transmit(due)
            if self.understood and not self._outgoing:
                self._arrive(float(due), data)

    def _arrive(self, start: float, data: bytes) -> None:
        for number, byte in enumerate(data, 1):
            insort(self._arrivals, (start + number * self.character, byte), key=lambda entry: entry[0])

    def _collect(self) -> None:
        """Turn arrived characters into messages."""
        while self._arrivals:
            message = bytearray()
            last = self._arrivals[0][0]
            count = 0
            for at, byte in self._arrivals:
                if at > self.time or at - last > self.gap or len(message) >= self.max_length:
                    break
                message.append(byte)
                last = at
                count += 1
            full = len(message) >= self.max_length
            if not message or (last + self.gap > self.time and not full):
                return
            del self._arrivals[:count]
            if sum(map(len, self._messages)) + len(message) <= MAX_STORED:
                self._messages.append(bytes(message))

    @property
    def waiting(self) -> bool:
        """Whether a complete message can be fetched."""
        return bool(self._messages)

    def fetch(self) -> bytes:
        """The oldest complete message."""
        return self._messages.popleft()

    def clear(self) -> None:
        """Throw away what was received so far."""
        self._messages.clear()
        self._arrivals = [entry for entry in self._arrivals if entry[0] > self.time]
