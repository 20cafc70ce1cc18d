"""Values as people write them <-> bytes of an item, big-endian."""

from __future__ import annotations

import math
import struct
from collections.abc import Mapping, Sequence
from typing import Any

from plcgen.ppi.wire.areas import OCTETS, TransportSize
from plcgen.ppi.wire.model import Item

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
