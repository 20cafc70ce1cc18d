"""Data formats of data set 47: code, standard name, size, and Python values <-> bytes (big-endian).

Sources: the format column of the request and response tables in Siemens FAQ 109750712 (table 4-3), of the
S7-300/MM4 guide part 3 (tables 2-2 and 2-4; "10" and "13" are decimal there) and the PROFIdrive profile's
data types as others print them: OPC 30144 (table 59), E_PD_Datatype of Beckhoff, Siemens' application example AC4.
Sizes of the date and time formats differ between documents; chosen here:

* TimeDifference: 4 bytes, milliseconds (the MM4 guide says 32 bits);
* TimeOfDay and TimeDifferenceWithDate: 6 bytes, BinaryDate: 7 bytes (IEC 61158 encodings with date), exchanged as
  uninterpreted octets;
* BinaryDate has code 32h in all three that print PROFIdrive's codes, of 7 octets (AC4: 8, the last one for alignment);
  none of them has 0Bh, its number in IEC 61158;
* TimeOfDayWithoutDate, TimeDifferenceWithoutDate: 4 bytes, milliseconds. The latter is how newer firmware answers a
  TimeDifference (r0948), and is read like one.

VisibleString and OctetString count octets: one ``str`` or ``bytes`` value of ``count`` octets.
The normalised formats (N2, C4, ...) are exchanged as raw integers, not scaled to percent or seconds.
"""

from __future__ import annotations

import enum
import math
import struct
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Literal, TypeAlias

from plcgen.base.diagnostics import PlcgenError
from plcgen.s7.types.values import keeps

if TYPE_CHECKING:
    from collections.abc import Sequence

Value: TypeAlias = bool | int | float | str | bytes
Takes: TypeAlias = Literal["any", "own", "size", "double_word"]
"""In which formats a device takes a change: the own type or 41h to 43h, one of these two, or 43h alone."""


class FormatValueError(PlcgenError, ValueError):
    """A Python value does not fit a format; the message says the allowed range."""


class FormatKind(enum.Enum):
    """How the bytes of one value are read."""

    BOOLEAN = "boolean"
    SIGNED = "signed"
    UNSIGNED = "unsigned"
    FLOAT = "float"
    TEXT = "text"
    OCTETS = "octets"
    OPAQUE = "opaque"
    ZERO = "zero"
    ERROR = "error"


@dataclass(frozen=True, slots=True)
class Format:
    """One format: wire code, standard name, bytes per counted value, kind, where the code is documented."""

    code: int
    name: str
    size: int
    kind: FormatKind
    source: str

    @property
    def generic(self) -> bool:
        """Whether this is 41h, 42h or 43h, which name a size instead of a type."""
        return BYTE <= self.code <= DOUBLE_WORD

    @property
    def writable(self) -> bool:
        """Whether a change request may use the format; 40h and 44h occur in responses only."""
        return self.kind not in {FormatKind.ZERO, FormatKind.ERROR}

    @property
    def is_string(self) -> bool:
        """Whether ``count`` counts octets of one value instead of values."""
        return self.kind is FormatKind.TEXT or self.kind is FormatKind.OCTETS


FLOATING_POINT, VISIBLE_STRING, OCTET_STRING = 0x08, 0x09, 0x0A
TIME_DIFFERENCES = (0x0D, 0x36)
"""Two codes of one type: which of them a drive answers depends on its firmware."""
ZERO, BYTE, WORD, DOUBLE_WORD, ERROR = 0x40, 0x41, 0x42, 0x43, 0x44
_GENERIC = {1: BYTE, 2: WORD, 4: DOUBLE_WORD}

_TABLE_4_3 = "FAQ 109750712 table 4-3"
_MM4 = "MM4 guide part 3 table 2-2"
_PROFILE = "PROFIdrive profile, data types, as in OPC 30144 table 59 and in Siemens' application example AC4"
_MCA120 = "Danfoss VLT PROFINET MCA 120, p. 42 (21h, 23h); the others as far below 71h to 7Ch"
_G120X = "SINAMICS G120X operating instructions p. 222"

FORMATS: tuple[Format, ...] = (
    Format(0x01, "Boolean", 1, FormatKind.BOOLEAN, _PROFILE),
    Format(0x02, "Integer8", 1, FormatKind.SIGNED, _TABLE_4_3),
    Format(0x03, "Integer16", 2, FormatKind.SIGNED, _TABLE_4_3),
    Format(0x04, "Integer32", 4, FormatKind.SIGNED, _TABLE_4_3),
    Format(0x05, "Unsigned8", 1, FormatKind.UNSIGNED, _TABLE_4_3),
    Format(0x06, "Unsigned16", 2, FormatKind.UNSIGNED, _TABLE_4_3),
    Format(0x07, "Unsigned32", 4, FormatKind.UNSIGNED, _TABLE_4_3),
    Format(0x08, "FloatingPoint", 4, FormatKind.FLOAT, _TABLE_4_3),
    Format(0x09, "VisibleString", 1, FormatKind.TEXT, _PROFILE),
    Format(0x0A, "OctetString", 1, FormatKind.OCTETS, _MM4),
    Format(0x0C, "TimeOfDay", 6, FormatKind.OPAQUE, _PROFILE),
    Format(0x0D, "TimeDifference", 4, FormatKind.UNSIGNED, _MM4),
    Format(0x0F, "Float64", 8, FormatKind.FLOAT, _PROFILE),
    Format(0x32, "BinaryDate", 7, FormatKind.OPAQUE, _PROFILE),
    Format(0x34, "TimeOfDayWithoutDate", 4, FormatKind.UNSIGNED, _G120X),
    Format(0x35, "TimeDifferenceWithDate", 6, FormatKind.OPAQUE, _G120X),
    Format(0x36, "TimeDifferenceWithoutDate", 4, FormatKind.UNSIGNED, _G120X),
    Format(0x37, "Integer64", 8, FormatKind.SIGNED, _PROFILE),
    Format(0x38, "Unsigned64", 8, FormatKind.UNSIGNED, _PROFILE),
    Format(0x71, "N2", 2, FormatKind.SIGNED, _PROFILE),
    Format(0x72, "N4", 4, FormatKind.SIGNED, _PROFILE),
    Format(0x73, "V2", 2, FormatKind.UNSIGNED, _PROFILE),
    Format(0x74, "L2", 2, FormatKind.UNSIGNED, _PROFILE),
    Format(0x75, "R2", 2, FormatKind.UNSIGNED, _PROFILE),
    Format(0x76, "T2", 2, FormatKind.UNSIGNED, _PROFILE),
    Format(0x77, "T4", 4, FormatKind.UNSIGNED, _PROFILE),
    Format(0x78, "D2", 2, FormatKind.UNSIGNED, _PROFILE),
    Format(0x79, "E2", 2, FormatKind.SIGNED, _PROFILE),
    Format(0x7A, "C4", 4, FormatKind.SIGNED, _PROFILE),
    Format(0x7B, "X2", 2, FormatKind.SIGNED, _PROFILE),
    Format(0x7C, "X4", 4, FormatKind.SIGNED, _PROFILE),
    Format(0x40, "Zero", 0, FormatKind.ZERO, _TABLE_4_3),
    Format(0x41, "Byte", 1, FormatKind.UNSIGNED, _TABLE_4_3),
    Format(0x42, "Word", 2, FormatKind.UNSIGNED, _TABLE_4_3),
    Format(0x43, "DoubleWord", 4, FormatKind.UNSIGNED, _TABLE_4_3),
    Format(0x44, "Error", 2, FormatKind.ERROR, _TABLE_4_3),
)

FROM_ANSWER = Format(0x38, "Any", 8, FormatKind.OPAQUE, "docs/spec.md: a read without a type")
"""What stands for a type that only the answer tells: room for 8 bytes, which a simulated drive fills as Unsigned64."""

_OLDER = 0x50
"""So much lower are the older codes of 71h to 7Ch."""
OLDER = tuple(
    Format(item.code - _OLDER, f"{item.name} ({item.code - _OLDER:02X}h)", item.size, item.kind, _MCA120)
    for item in FORMATS
    if 0x71 <= item.code <= 0x7C
)
"""N2 to X4 under the numbers that they had before, 21h to 2Ch: some devices answer so."""


@cache
def _codes() -> dict[int, Format]:
    return {item.code: item for item in (*FORMATS, *OLDER)}


@cache
def _names() -> dict[str, Format]:
    return {item.name.lower(): item for item in FORMATS}


def format_names() -> list[str]:
    """Names of what a parameter can be, without strings, which have a length."""
    return [item.name for item in FORMATS if item.writable and not item.is_string]


def find(code: int) -> Format | None:
    """Return the format with this wire code, or None if the code is reserved."""
    return _codes().get(code)


def by_code(code: int) -> Format:
    """Return the format with this wire code; KeyError if the code is reserved."""
    try:
        return _codes()[code]
    except KeyError:
        raise KeyError(f"no DS47 format has the code {code:02X}h") from None


def by_name(name: str) -> Format:
    """Return the format with this standard name in any letter case; KeyError if there is none."""
    try:
        return _names()[name.lower()]
    except KeyError:
        raise KeyError(f"no DS47 format is called {name!r}") from None


def generic_of(size: int) -> Format | None:
    """Return Byte, Word or DoubleWord for a size of 1, 2 or 4 bytes, else None."""
    code = _GENERIC.get(size)
    return None if code is None else by_code(code)


def accepts(declared: Format, wire: int, takes: Takes = "any") -> bool:
    """Whether a change of ``declared`` may come as ``wire``: the exact code, or the generic format of the same size."""
    generic = None if declared.is_string else generic_of(declared.size)
    by_size = generic is not None and wire == generic.code
    if takes == "double_word":
        return by_size and wire == DOUBLE_WORD
    return (wire == declared.code and takes != "size") or (by_size and takes != "own")


def answers(declared: Format) -> tuple[int, ...]:
    """Codes in which a drive may answer ``declared``: its own first, the generic one of the same size last."""
    same: tuple[int, ...] = TIME_DIFFERENCES if declared.code in TIME_DIFFERENCES else ()
    same += tuple(item.code for item in OLDER if item.code + _OLDER == declared.code)
    generic = None if declared.is_string else generic_of(declared.size)
    return tuple(dict.fromkeys((declared.code, *same, *([generic.code] if generic is not None else []))))


def padded(size: int) -> int:
    """Length of ``size`` bytes of values on the wire: each value block ends on a word boundary."""
    return size + size % 2


def integer_range(fmt: Format) -> tuple[int, int] | None:
    """Smallest and largest raw integer of an integer format, None for the others."""
    bits = 8 * fmt.size
    if fmt.kind is FormatKind.SIGNED:
        return -(1 << bits - 1), (1 << bits - 1) - 1
    if fmt.kind is FormatKind.UNSIGNED:
        return 0, (1 << bits) - 1
    return None


def _pack_integer(fmt: Format, value: Value) -> bytes:
    number = int(value) if isinstance(value, float) and value.is_integer() else value
    if not isinstance(number, int) or isinstance(number, bool):
        raise _no_integer(fmt, value)
    try:
        return number.to_bytes(fmt.size, "big", signed=fmt.kind is FormatKind.SIGNED)
    except OverflowError:
        raise _no_integer(fmt, number) from None


def _no_integer(fmt: Format, value: Value) -> FormatValueError:
    low, high = integer_range(fmt) or (0, 0)
    return FormatValueError(f"{fmt.name} takes an integer from {low} to {high}, not {value!r}")


def _pack_float(fmt: Format, value: Value) -> bytes:
    limit = "3.4028235e+38" if fmt.size == 4 else "1.7976931348623157e+308"
    problem = FormatValueError(f"{fmt.name} takes a finite number from -{limit} to {limit}, not {value!r}")
    if not isinstance(value, int | float) or isinstance(value, bool):
        raise problem
    try:
        number = float(value)
        if not math.isfinite(number):
            raise problem
        packed = struct.pack(">f" if fmt.size == 4 else ">d", number)
    except OverflowError:
        raise problem from None
    nearest = _unpack_float(packed)
    if not keeps(nearest, value):
        raise FormatValueError(f"{fmt.name} does not have {value!r}: the nearest is {nearest!r}")
    return packed


def _unpack_float(data: bytes) -> float:
    return float(struct.unpack(">f" if len(data) == 4 else ">d", data)[0])


def _pack_boolean(fmt: Format, value: Value) -> bytes:
    if value not in {0, 1} or not isinstance(value, int):
        raise FormatValueError(f"{fmt.name} takes false or true, not {value!r}")
    return b"\x01" if value else b"\x00"


def _pack_text(fmt: Format, value: Value) -> bytes:
    if not isinstance(value, str) or any(ord(character) > 0xFF for character in value):
        raise FormatValueError(f"{fmt.name} takes text of characters 00h to FFh, not {value!r}")
    return value.encode("latin-1")


def _pack_octets(fmt: Format, value: Value) -> bytes:
    if not isinstance(value, bytes):
        raise FormatValueError(f"{fmt.name} takes bytes, not {value!r}")
    if fmt.kind is FormatKind.OPAQUE and len(value) != fmt.size:
        raise FormatValueError(f"{fmt.name} takes exactly {fmt.size} bytes, not {len(value)}")
    return value


def _pack_nothing(fmt: Format, value: Value) -> bytes:
    raise FormatValueError(f"{fmt.name} carries no values, so {value!r} does not fit")


_PACK = {
    FormatKind.BOOLEAN: _pack_boolean,
    FormatKind.SIGNED: _pack_integer,
    FormatKind.UNSIGNED: _pack_integer,
    FormatKind.FLOAT: _pack_float,
    FormatKind.TEXT: _pack_text,
    FormatKind.OCTETS: _pack_octets,
    FormatKind.OPAQUE: _pack_octets,
    FormatKind.ZERO: _pack_nothing,
    FormatKind.ERROR: _pack_integer,
}


def pack_values(fmt: Format, values: Sequence[Value]) -> bytes:
    """Return the values one after the other without a pad byte; FormatValueError if one does not fit.

    Strings: a sequence of ``str`` (VisibleString) or ``bytes`` (OctetString), joined.
    """
    pack = _PACK[fmt.kind]
    if fmt.kind is FormatKind.ERROR:
        fmt = by_code(WORD)
        pack = _pack_integer
    return b"".join(pack(fmt, value) for value in values)


def unpack_values(fmt: Format, count: int, data: bytes) -> list[Value]:
    """Return the ``count`` values in ``data`` (no pad); one value for the string formats.

    FormatValueError if ``data`` has not exactly ``count`` times the format's size.
    """
    if len(data) != count * fmt.size:
        raise FormatValueError(f"{count} x {fmt.name} takes {count * fmt.size} bytes, not {len(data)}")
    if fmt.kind is FormatKind.TEXT:
        return [data.decode("latin-1")]
    if fmt.kind is FormatKind.OCTETS:
        return [data]
    return [_unpack_one(fmt, data[at : at + fmt.size]) for at in range(0, len(data), fmt.size or 1)]


def _unpack_one(fmt: Format, data: bytes) -> Value:
    if fmt.kind is FormatKind.BOOLEAN:
        return data != b"\x00"
    if fmt.kind is FormatKind.OPAQUE:
        return data
    if fmt.kind is FormatKind.FLOAT:
        return _unpack_float(data)
    return int.from_bytes(data, "big", signed=fmt.kind is FormatKind.SIGNED)
