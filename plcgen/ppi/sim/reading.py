"""Reads that come again and again: a request that was understood once is answered from the memory at once.

Only what can end in one way is kept: a read of items that this CPU has, whose answer fits. Everything else is looked
at anew each time.
"""

from __future__ import annotations

from dataclasses import dataclass

from plcgen.ppi.sim.memory import StationMemory
from plcgen.ppi.wire.areas import Function, ReturnCode, Rosctr, SizeCode
from plcgen.ppi.wire.model import ReadRequest
from plcgen.ppi.wire.pdu import PROTOCOL, reply_size

_MOST = 256
"""Different requests that are kept: a panel reads a few again and again."""
_HEAD = bytes((PROTOCOL, Rosctr.ACK_DATA, 0, 0))

Part = tuple[bytes, bytearray, int, int, int, bytes]
"""Header of a value, its area, first byte and end there, bit or -1, pad."""


@dataclass(frozen=True, slots=True)
class KnownRead:
    """The answer to a read, but for reference and values; ``size`` is its length."""

    head: bytes
    parts: tuple[Part, ...]
    size: int

    def answer(self, reference: bytes) -> bytes:
        """The answer to the request with this reference."""
        found: list[bytes | bytearray] = [_HEAD, reference, self.head]
        for header, area, first, end, bit, pad in self.parts:
            found.append(header)
            found.append(area[first:end] if bit < 0 else b"\x01" if area[first] >> bit & 1 else b"\x00")
            if pad:
                found.append(pad)
        return b"".join(found)


class KnownReads:
    """Reads by their bytes without the reference."""

    def __init__(self, memory: StationMemory) -> None:
        self._memory = memory
        self._known: dict[bytes, KnownRead] = {}

    def find(self, data: bytes) -> KnownRead | None:
        """What is known about a request."""
        return self._known.get(data[:4] + data[6:])

    def keep(self, data: bytes, request: ReadRequest) -> None:
        """Keep a read that is answered with values only."""
        if any(self._memory.check(item) != ReturnCode.OK for item in request.items):
            return
        parts: list[Part] = []
        for number, item in enumerate(request.items, 1):
            area, first = self._memory.locate(item)
            octets, code = item.octets, item.size_code
            length = 1 if code == SizeCode.BIT else octets if code == SizeCode.OCTETS else octets * 8
            header = bytes((ReturnCode.OK, code)) + length.to_bytes(2)
            pad = bytes(octets % 2) if number < len(request.items) else b""
            bit = item.bit_number if code == SizeCode.BIT else -1
            parts.append((header, area, first, first + octets, bit, pad))
        size = reply_size(request.items)
        head = b"\x00\x02" + (size - 14).to_bytes(2) + b"\0\0" + bytes((Function.READ, len(parts)))
        if len(self._known) >= _MOST:
            self._known.clear()
        self._known[data[:4] + data[6:]] = KnownRead(head, tuple(parts), size)
