"""The S7 types that hold the formats of data set 47 on each target."""

from __future__ import annotations

from plcgen.ds47.wire.formats import Format
from plcgen.project.target import Target
from plcgen.s7.types.data_types import ELEMENTARY, Elementary

_SAME = {"FloatingPoint": "REAL", "Integer16": "INT", "Integer32": "DINT", "Boolean": "BYTE", "VisibleString": "CHAR",
         "OctetString": "BYTE", "V2": "WORD", "L2": "WORD", "N2": "INT", "E2": "INT", "X2": "INT", "N4": "DINT",
         "C4": "DINT", "X4": "DINT", "Byte": "BYTE", "Word": "WORD", "DoubleWord": "DWORD"}  # fmt: skip
_CLASSIC = {"Integer8": "BYTE", "Unsigned8": "BYTE", "Unsigned16": "WORD", "Unsigned32": "DWORD", "R2": "WORD",
            "T2": "WORD", "D2": "WORD", "T4": "DWORD", "TimeDifference": "DWORD",
            "TimeOfDayWithoutDate": "DWORD", "TimeDifferenceWithoutDate": "DWORD"}  # fmt: skip
_NEW = {"Integer8": "SINT", "Unsigned8": "USINT", "Unsigned16": "UINT", "Unsigned32": "UDINT", "R2": "UINT",
        "T2": "UINT", "D2": "UINT", "T4": "UDINT", "TimeDifference": "UDINT",
        "TimeOfDayWithoutDate": "UDINT", "TimeDifferenceWithoutDate": "UDINT", "Float64": "LREAL"}  # fmt: skip
_LONG = {"Integer64": "LINT", "Unsigned64": "ULINT"}


def element_type(fmt: Format, where: Target) -> Elementary | None:
    """S7 type that holds one value of a DS47 format; None if only bytes can hold it on this CPU."""
    name = _SAME.get(fmt.name) or (_NEW if where.t15 else _CLASSIC).get(fmt.name)
    if name is None and where.family == "s7-1500":
        name = _LONG.get(fmt.name)
    return ELEMENTARY[name] if name else None
