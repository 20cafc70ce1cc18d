"""BICO values: how the value of a binector or connector input names the parameter that it takes its signal from.

An Unsigned32: bits 31..16 parameter number, 15..10 drive object, 9..0 index or bit; 3Fh is the drive object that is
addressed. Sources: G110M operating instructions p. 198 (P840 = r722.2: 02 D2 FC 02; G120C, G115D and G120XA print the
same table), DCM operating instructions p. 453 (r53010 of drive object 1: CF 12 04 00).
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

Layout: TypeAlias = Literal["drive-object", "plain"]
"""Whether a family's values carry the drive object, or zeros in its place."""

SELF = 0x3F
"""The drive object that is addressed."""

_INDEX_BITS = 10
_SOURCE = re.compile(r"[PpRr]0*([0-9]{1,5})(?:\.([0-9]{1,4})|\[([0-9]{1,4})\])?(?:@(?:([0-9]{1,2})|self))?\Z")


@dataclass(frozen=True, slots=True)
class BicoSource:
    """A parameter as a source: its number, index or bit, and the drive object that has it."""

    pnu: int
    index: int = 0
    drive_object: int = SELF

    @property
    def value(self) -> int:
        """Value on the wire."""
        return self.pnu << 16 | self.drive_object << _INDEX_BITS | self.index

    def within(self, layout: Layout) -> int | None:
        """Value for a family; None if it has no room for the drive object."""
        if layout == "drive-object":
            return self.value
        return self.pnu << 16 | self.index if self.drive_object == SELF else None

    def seen_from(self, drive_object: int) -> BicoSource:
        """The same source without the number of the drive object that is addressed anyway."""
        return replace(self, drive_object=SELF) if self.drive_object == drive_object else self

    def __str__(self) -> str:
        """``r722.2``, or ``r722.2@3`` in another drive object."""
        return f"r{self.pnu}.{self.index}" + ("" if self.drive_object == SELF else f"@{self.drive_object}")


def parse_bico(text: str) -> BicoSource | None:
    """Read ``r0722.2``, ``r722[2]``, ``r722.2@3`` or ``r722.2@self``; None if the text is none of them."""
    match = _SOURCE.match(text)
    if not match:
        return None
    pnu, index = int(match[1]), int(match[2] or match[3] or 0)
    drive_object = SELF if match[4] is None else int(match[4])
    if not 1 <= pnu <= 0xFFFF or index >> _INDEX_BITS or (match[4] is not None and drive_object >= SELF):
        return None
    return BicoSource(pnu, index, drive_object)


def read_bico(value: int) -> BicoSource:
    """Take a value on the wire apart."""
    return BicoSource(value >> 16, value & (1 << _INDEX_BITS) - 1, value >> _INDEX_BITS & SELF)
