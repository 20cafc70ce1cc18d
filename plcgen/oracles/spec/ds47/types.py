"""Types on the wire by the names of the list manuals: code, bytes of a value, and how the bytes are to be read."""

from __future__ import annotations

import re
import struct

from plcgen.oracles.profidrive import TYPES
from plcgen.oracles.spec.place import NotStatedError

OCTETS = {"BinaryDate": (0x32, 7), "TimeOfDay": (0x0C, 6), "TimeDifferenceWithDate": (0x35, 6)}
"""Types that no CPU has as a number: docs/spec.md, "Parameters"; OPC 30144 B.2."""
ANY, ROOM = "Any", 8
"""A type that only the answer tells, and the octets that are kept of its value (docs/spec.md, "Parameters")."""
OCTETS[ANY] = (0x38, ROOM)  # what the device has that fills all of them: Unsigned64
STRING = re.compile(r"(VisibleString|OctetString)\[(\d+)\]")
SHORT = {"Float": "FloatingPoint"}


def string_octets(type_: str) -> int:
    """How many octets a string has; 0 for any other type."""
    match = STRING.fullmatch(type_)
    return int(match[2]) if match else 0


def base(type_: str) -> str:
    """The name without the length of a string."""
    return type_.partition("[")[0]


def code_of(type_: str) -> int:
    """Code of the type in a telegram."""
    name = base(type_)
    if name in OCTETS:
        return OCTETS[name][0]
    if name not in TYPES:
        raise NotStatedError(f"no document names a type {type_}")
    return TYPES[name][0]


def size_of(type_: str) -> int:
    """Bytes of one value; the values of a string are its octets."""
    name = base(type_)
    if name in OCTETS:
        return OCTETS[name][1]
    if name not in TYPES:
        raise NotStatedError(f"no document names a type {type_}")
    return struct.calcsize(">" + TYPES[name][1])


def is_float(type_: str) -> bool:
    """Whether values are floating-point numbers."""
    return base(type_) in TYPES and TYPES[base(type_)][1] in "fd"


def is_signed(type_: str) -> bool:
    """Whether values are integers with a sign."""
    return base(type_) in TYPES and TYPES[base(type_)][1] in "bhiq"


def packed(type_: str, value: float) -> bytes:
    """One value as it stands in a telegram, big-endian."""
    name = base(type_)
    if name in OCTETS:
        return int(value).to_bytes(OCTETS[name][1])
    layout = TYPES[name][1]
    return struct.pack(">" + layout, value if layout in "fd" else int(value))


def unpacked(type_: str, data: bytes) -> int | float:
    """The value of the bytes."""
    name = base(type_)
    if name in OCTETS:
        return int.from_bytes(data)
    value: int | float = struct.unpack(">" + TYPES[name][1], data)[0]
    return value
