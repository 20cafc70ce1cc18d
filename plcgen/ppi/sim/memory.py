"""Memory of a simulated S7-200: reads and writes of items with the return codes of a CPU, values as people write them.

Of requests that come again only what can end in one way is kept: a read of items that this CPU has, whose
answer fits. Everything else is looked at anew each time.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from plcgen.ppi.wire.areas import ELEMENT_SIZES, OCTETS, Area, Function, ReturnCode, Rosctr, SizeCode, TransportSize
from plcgen.ppi.wire.model import Item, ItemResult, ReadRequest
from plcgen.ppi.wire.pdu import PROTOCOL, reply_size
from plcgen.ppi.wire.profiles import TYPE_LENGTH, CpuProfile

READ_ONLY = frozenset({Area.AI, Area.HC, Area.SYS})
READ_ONLY_SM = 30
"""SMB0 to SMB29 belong to the CPU (S7-200 system manual, appendix "Special memory bits")."""

_ALWAYS_ON = 0x01
_ANALOG = frozenset({Area.AI, Area.AQ})
_PLAIN_ONLY = frozenset({TransportSize.BYTE, TransportSize.CHAR})
_ELEMENT_CODES = frozenset(ELEMENT_SIZES.values())


class StationMemory:
    """All areas of one CPU, zero at power-on but for SYS and SM0.0, which is always on.

    ``write_inputs`` False refuses writes to I. That timers and counters can be written, and anything be forced, is what
    one document says; no capture shows it.
    """

    def __init__(self, profile: CpuProfile, type_: str | None = None, *, write_inputs: bool = True) -> None:
        self.profile = profile
        self.write_inputs = write_inputs
        self.forced: dict[Item, bytes] = {}
        self._bytes = {area: bytearray(size * _width(area)) for area, size in profile.sizes.items()}
        text = profile.type if type_ is None else type_
        self._bytes[Area.SM][0] = _ALWAYS_ON
        self._bytes[Area.SYS][:TYPE_LENGTH] = text.encode("ascii", "replace")[:TYPE_LENGTH].ljust(TYPE_LENGTH)

    def read(self, item: Item) -> ItemResult:
        """Answer one item of a read."""
        code = self._check(item)
        return ItemResult(code) if code != ReturnCode.OK else ItemResult.of(item, self._get(item))

    def write(self, item: Item, data: bytes) -> ReturnCode:
        """Execute one item of a write request and return its code; nothing is changed unless it is FFh."""
        code = self._check(item)
        if code == ReturnCode.OK and self._read_only(item):
            code = ReturnCode.ACCESS_DENIED
        if code == ReturnCode.OK and len(data) != item.octets:
            code = ReturnCode.SIZE_MISMATCH
        if code == ReturnCode.OK:
            self.put(item, data)
            self._restore_forced()
        return code

    def put(self, item: Item, data: bytes) -> None:
        """Set a value as the process or the program does, read-only areas too; the item must be in range."""
        if item.size == TransportSize.BIT:
            mask = 1 << item.bit_number
            cell = self._bytes[Area(item.area)]
            cell[item.byte] = cell[item.byte] | mask if data[0] & 1 else cell[item.byte] & ~mask
            return
        start = self._start(item)
        self._bytes[Area(item.area)][start : start + len(data)] = data

    def force(self, item: Item, data: bytes | None) -> ReturnCode:
        """Force an item to a value, or release it with None."""
        code = self._check(item)
        if code != ReturnCode.OK:
            return code
        if data is None:
            self.forced.pop(item, None)
        else:
            self.forced[item] = data
            self._restore_forced()
        return code

    def check(self, item: Item) -> ReturnCode:
        """Return code of an access to an item, without doing it."""
        return self._check(item)

    def _check(self, item: Item) -> ReturnCode:
        area = item.area
        if area not in self._bytes or (area == Area.V and item.db != Area.V.db):
            return ReturnCode.NOT_AVAILABLE
        if area in ELEMENT_SIZES and item.size != ELEMENT_SIZES[Area(area)]:
            return ReturnCode.ACCESS_DENIED  # what a CPU says to T40 as a byte; of C and HC it is assumed
        if not _suits(item):
            return ReturnCode.TYPE_NOT_SUPPORTED
        if item.count == 0:
            return ReturnCode.SIZE_MISMATCH
        if item.size == TransportSize.BIT and item.count != 1:
            return (
                ReturnCode.TYPE_NOT_SUPPORTED
            )  # libnodave, nodave.h: what a CPU 200 says to a bit block longer than 1
        plain = not item.by_element and item.size != TransportSize.BIT
        if plain and (item.bit_number or (area in _ANALOG and item.byte % 2)):
            return ReturnCode.OUT_OF_RANGE
        if self._start(item) + item.octets > len(self._bytes[Area(area)]):
            return ReturnCode.OUT_OF_RANGE
        return ReturnCode.OK

    def _read_only(self, item: Item) -> bool:
        area = item.area
        if area in READ_ONLY or (area == Area.I and not self.write_inputs):
            return True
        return area == Area.SM and item.byte < READ_ONLY_SM

    def _get(self, item: Item) -> bytes:
        cell = self._bytes[Area(item.area)]
        if item.size == TransportSize.BIT:
            return bytes((cell[item.byte] >> item.bit_number & 1,))
        start = self._start(item)
        return bytes(cell[start : start + item.octets])

    def locate(self, item: Item) -> tuple[bytearray, int]:
        """The area of an item that is in range, and where it begins there."""
        return self._bytes[Area(item.area)], item.byte if item.size == TransportSize.BIT else self._start(item)

    def _start(self, item: Item) -> int:
        return item.address * _width(Area(item.area)) if item.by_element else item.address >> 3

    def _restore_forced(self) -> None:
        for item, data in self.forced.items():
            self.put(item, data)


def _width(area: Area) -> int:
    """Bytes of one element: 5 for a timer (status and 32 bits), 3 for a counter, 1 where bytes are addressed."""
    return OCTETS[ELEMENT_SIZES[area]] if area in ELEMENT_SIZES else 1


def _suits(item: Item) -> bool:
    if item.area in ELEMENT_SIZES:
        return True
    if item.size not in OCTETS or item.size in _ELEMENT_CODES:
        return False
    if item.area == Area.SYS:
        return item.size in _PLAIN_ONLY
    return item.area not in _ANALOG or item.size != TransportSize.BIT


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


ON = 0x02
"""Status byte of a timer whose bit is on: two captures show it for T32 at 32767, where a timer stops; of counters and
high-speed counters it is assumed."""
_ELEMENT_BITS = {TransportSize.TIMER: 32, TransportSize.COUNTER: 16, TransportSize.HIGH_SPEED_COUNTER: 32}


def encode_value(item: Item, value: Any) -> bytes:
    """Return the bytes of a value for an item. ValueError says what does not fit.

    One element is a whole number, signed or not; a double word also takes a real number; a bit takes true and false;
    T, C and HC take their current value or ``{value: 5, on: true}``. Several elements are a list, bytes are text too.
    """
    if item.count == 1 and not isinstance(value, list | tuple | str | bytes | bytearray):
        return _element(item.size, value)
    if isinstance(value, str | bytes | bytearray):
        return _text(item, value)
    if not isinstance(value, Sequence):
        raise ValueError(f"{item.count} values are needed, as a list")  # noqa: TRY004 - see below
    if len(value) != item.count:
        raise ValueError(f"{len(value)} values for {item.count} elements")
    return b"".join(_element(item.size, entry) for entry in value)


def decode_value(item: Item, data: bytes) -> Any:
    """Return a value as Python data: bool, unsigned int, bytes for several bytes, list for other several elements.

    Of T, C and HC it is the current value; of a double word the unsigned number, whatever it means.
    """
    if item.size == TransportSize.BIT:
        return bool(data[0])
    if item.count > 1 and item.octets == item.count:
        return data
    size = OCTETS[item.size]
    skip = 1 if item.size in _ELEMENT_BITS else 0
    found = [int.from_bytes(data[at + skip : at + size]) for at in range(0, len(data), size)]
    return found[0] if item.count == 1 else found


def _text(item: Item, value: str | bytes | bytearray) -> bytes:
    if item.octets != item.count or item.size == TransportSize.BIT:
        raise ValueError("text goes into bytes, for example VB100[20]")
    try:
        data = value.encode("latin-1") if isinstance(value, str) else bytes(value)
    except UnicodeEncodeError as problem:
        raise ValueError(f"{value[problem.start]!r} has no byte of its own") from problem
    if len(data) > item.octets:
        raise ValueError(f"{len(data)} characters for {item.octets} bytes")
    return data.ljust(item.octets, b"\x00")


def _element(size: int, value: Any) -> bytes:
    if size == TransportSize.BIT:
        if not isinstance(value, int | float) or value not in {0, 1}:
            raise ValueError(f"a bit is true or false, not {value!r}")
        return bytes((int(value),))
    if size in _ELEMENT_BITS:
        return _counted(TransportSize(size), value)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError(f"a number is needed, not {value!r}")  # noqa: TRY004 - one kind of error for all values
    bits = OCTETS[size] * 8
    if isinstance(value, float) or size == TransportSize.REAL:
        if bits != 32:
            raise ValueError(f"{value} is a real number and needs a double word, for example VD100")
        return _real(float(value))
    return _integer(value, bits, signed=value < 0)


def _counted(size: TransportSize, value: Any) -> bytes:
    bits = _ELEMENT_BITS[size]
    on = False
    if isinstance(value, Mapping):
        if not set(value) <= {"value", "on"}:
            raise ValueError("the keys are value and on")
        on, value = value.get("on", False), value.get("value", 0)
    if isinstance(value, bool) or not isinstance(value, int) or not isinstance(on, bool):
        raise ValueError("a whole number is needed, or a mapping with value and on")  # noqa: TRY004
    return bytes((ON if on else 0,)) + _integer(value, bits, signed=value < 0)


def _integer(value: int, bits: int, *, signed: bool) -> bytes:
    if not -(1 << bits - 1) <= value < 1 << bits:
        raise ValueError(f"{value} does not fit into {bits} bits")
    return value.to_bytes(bits // 8, signed=signed)


def _real(value: float) -> bytes:
    try:
        data = struct.pack(">f", value)
    except OverflowError:
        data = struct.pack(">f", math.inf)
    if not math.isfinite(struct.unpack(">f", data)[0]):
        raise ValueError(f"{value} does not fit into 32 bits")
    return data
