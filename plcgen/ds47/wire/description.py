"""The parameter description (attribute 20h): 46 bytes in twelve elements.

Subindex 0 reads the complete description as an OctetString, 1 to 12 one element in its own format. Source:
the PROFIdrive profile's description elements, as printed in the manual of the Danfoss FCD 302 (table 5.10,
"Parameter description elements").
"""

from __future__ import annotations

import struct
from dataclasses import dataclass

from plcgen.ds47.wire import formats
from plcgen.ds47.wire.model import ValueBlock

SIZE = 46

READ_ONLY, TEXT_ARRAY, CHANGED, RESET_ONLY, ARRAY = 1 << 9, 1 << 10, 1 << 12, 1 << 13, 1 << 14
NO_SCALE = 1 << 8
"""Bits of the identifier word; bits 0 to 7 hold the format code."""

ELEMENTS: tuple[tuple[str, str, int], ...] = (
    ("identifier", "V2", 2),
    ("number of array elements", "Unsigned16", 2),
    ("standardisation factor", "FloatingPoint", 4),
    ("variable attribute", "OctetString", 2),
    ("reserved", "OctetString", 4),
    ("name", "VisibleString", 16),
    ("lower limit", "OctetString", 4),
    ("upper limit", "OctetString", 4),
    ("reserved", "OctetString", 2),
    ("identifier extension", "V2", 2),
    ("process data reference parameter", "Unsigned16", 2),
    ("process data normalisation", "V2", 2),
)
"""Name, format and length of the elements 1 to 12."""

_LAYOUT = struct.Struct(">HHf2s4x16s4s4s2xHHH")


@dataclass(frozen=True, slots=True)
class Description:
    """Contents of a parameter description; limits are the raw four bytes in the parameter's own format."""

    identifier: int
    elements: int = 0
    factor: float = 1.0
    variable_attribute: bytes = bytes(2)
    name: str = ""
    lower: bytes = bytes(4)
    upper: bytes = bytes(4)
    extension: int = 0
    reference: int = 0
    normalisation: int = 0

    @property
    def format(self) -> int:
        """Format code of the parameter's values."""
        return self.identifier & 0xFF

    def pack(self) -> bytes:
        """Return the complete description; a name over 16 characters is cut."""
        name = self.name.encode("latin-1", "replace")[:16].ljust(16)
        limits = (self.lower.rjust(4, b"\x00"), self.upper.rjust(4, b"\x00"))
        head = (self.identifier, self.elements, self.factor, self.variable_attribute, name)
        return _LAYOUT.pack(*head, *limits, self.extension, self.reference, self.normalisation)

    @classmethod
    def unpack(cls, data: bytes) -> Description:
        """Read a complete description; FormatValueError if it has not 46 bytes."""
        if len(data) != SIZE:
            raise formats.FormatValueError(f"a parameter description takes {SIZE} bytes, not {len(data)}")
        identifier, elements, factor, attribute, name, lower, upper, *rest = _LAYOUT.unpack(data)
        text = name.decode("latin-1").rstrip(" \x00")
        return cls(identifier, elements, factor, attribute, text, lower, upper, *rest)

    def block(self, subindex: int) -> ValueBlock:
        """Return the answer to attribute 20h: element ``subindex`` (IndexError if over 12), 0 is all."""
        data = self.pack()
        if subindex == 0:
            return ValueBlock(formats.OCTET_STRING, SIZE, data)
        _, name, size = ELEMENTS[subindex - 1]
        start = sum(item[2] for item in ELEMENTS[: subindex - 1])
        fmt = formats.by_name(name)
        return ValueBlock(fmt.code, size // fmt.size, data[start : start + size])
