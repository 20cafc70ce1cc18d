"""Python values to big-endian bytes and back, for every elementary type and string.

BOOL is bool; bit strings and integers are int; REAL and LREAL float; characters and strings str;
TIME, S5TIME and TIME_OF_DAY int milliseconds; LTIME and LTIME_OF_DAY int nanoseconds;
LDT and DTL int nanoseconds since 1970; DATE ``datetime.date``; DATE_AND_TIME ``datetime.datetime``;
POINTER and ANY ``Pointer`` or None.
"""

from __future__ import annotations

import datetime as dt
import struct
from types import MappingProxyType
from typing import TypeAlias

from plcgen.s7.types import durations
from plcgen.s7.types.address import Pointer, unpack_pointer
from plcgen.s7.types.data_types import ELEMENTARY, HARDWARE, Elementary, StringType, UnfitValueError

Value: TypeAlias = "bool | int | float | str | dt.date | dt.datetime | Pointer | None"

SIGNED = frozenset({"SINT", "INT", "DINT", "LINT"})
BIT_STRINGS = frozenset({"BYTE", "WORD", "DWORD", "LWORD"})
UNSIGNED = frozenset({"USINT", "UINT", "UDINT", "ULINT"})
NUMBERS = HARDWARE | {"TIMER", "COUNTER", "BLOCK_DB", "BLOCK_FB", "BLOCK_FC", "BLOCK_SDB", "BLOCK_SFB", "BLOCK_SFC"}
_LONG = 1 << 63
_TICKS = {"TIME": (-(1 << 31), (1 << 31) - 1), "TIME_OF_DAY": (0, 86_399_999)}
_TICKS |= {"LTIME": (-_LONG, _LONG - 1), "LTIME_OF_DAY": (0, durations.NS_PER_DAY - 1), "LDT": (0, _LONG - 1)}
_TICKS |= {"S5TIME": (0, 9_990_000)}


def _range(name: str) -> tuple[int, int]:
    if name in _TICKS:
        return _TICKS[name]
    bits = ELEMENTARY[name].bits
    return (-(1 << bits - 1), (1 << bits - 1) - 1) if name in SIGNED else (0, (1 << bits) - 1)


RANGES = MappingProxyType({name: _range(name) for name in SIGNED | BIT_STRINGS | UNSIGNED | NUMBERS | set(_TICKS)})
"""Lowest and highest integer value by type name."""


def pack_value(value: Value, type_: Elementary | StringType) -> bytes:
    """Bytes of a value; BOOL gives one byte 00 or 01. Raises ValueError with a reason if it does not fit."""
    if isinstance(type_, StringType):
        return _pack_string(_text(value), type_)
    name, size = type_.name, type_.bits // 8
    if name == "BOOL":
        return b"\x01" if value else b"\x00"
    if name in RANGES:
        return _pack_int(_integer(value, name), name, size)
    if name in ("REAL", "LREAL"):
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise UnfitValueError(f"{value!r} is not a value for {name}")
        try:
            return struct.pack(">f" if name == "REAL" else ">d", value)
        except OverflowError:
            raise UnfitValueError(f"{value} is too large for {name}") from None
    if name in ("CHAR", "WCHAR"):
        text = _text(value)
        data = _encode(text, wide=name == "WCHAR")
        if len(data) != (2 if name == "WCHAR" else 1):
            raise UnfitValueError(f"{name} holds exactly one character")
        return data
    if name == "DTL":
        return durations.pack_dtl(_integer(value, name))
    if name in ("ANY", "POINTER"):
        if not isinstance(value, Pointer):
            return bytes(size)
        return value.pack_any() if name == "ANY" else value.pack_pointer()
    if name == "DATE_AND_TIME" and isinstance(value, dt.datetime):
        return durations.pack_dt(value)
    if name == "DATE" and isinstance(value, dt.date):
        days = (value - durations.DAY_ZERO).days
        if not 0 <= days <= 0xFFFF:
            raise UnfitValueError("DATE runs from 1990-01-01 to 2169-06-06")
        return days.to_bytes(2)
    raise UnfitValueError(f"{value!r} is not a value for {name}")


def unpack_value(data: bytes, type_: Elementary | StringType) -> Value:
    """Value of exactly the bytes of one type; BOOL takes one byte and looks at bit 0.

    Raises ValueError for bytes that mean nothing, for example a DATE_AND_TIME with a month 13.
    """
    if isinstance(type_, StringType):
        unit = 2 if type_.name == "WSTRING" else 1
        length = min(int.from_bytes(data[unit : 2 * unit]), type_.length)
        used = data[2 * unit : (2 + length) * unit]
        return used.decode("utf-16-be" if unit == 2 else "latin-1", "surrogatepass")
    name = type_.name
    if name == "BOOL":
        return bool(data[0] & 1)
    if name == "S5TIME":
        return durations.from_s5time(int.from_bytes(data))
    if name in RANGES:
        return int.from_bytes(data, signed=name in SIGNED or name in ("TIME", "LTIME"))
    if name in ("REAL", "LREAL"):
        result: float = struct.unpack(">f" if name == "REAL" else ">d", data)[0]
        return result
    if name in ("CHAR", "WCHAR"):
        return data.decode("latin-1" if name == "CHAR" else "utf-16-be", "surrogatepass")
    if name == "DTL":
        return durations.unpack_dtl(data)
    if name == "DATE_AND_TIME":
        return durations.unpack_dt(data)
    if name == "DATE":
        return durations.DAY_ZERO + dt.timedelta(days=int.from_bytes(data))
    return unpack_pointer(data)


def _integer(value: Value, name: str) -> int:
    if isinstance(value, bool) or not isinstance(value, int):
        raise UnfitValueError(f"{value!r} is not a value for {name}")
    return value


def _text(value: Value) -> str:
    if not isinstance(value, str):
        raise UnfitValueError(f"{value!r} is not text")
    return value


def _pack_int(value: int, name: str, size: int) -> bytes:
    low, high = RANGES[name]
    if not low <= value <= high:
        raise UnfitValueError(f"{value} is outside {low}..{high}")
    return (durations.to_s5time(value) if name == "S5TIME" else value).to_bytes(size, signed=low < 0)


def keeps(nearest: float, value: float) -> bool:
    """Whether ``nearest``, what a REAL or LREAL makes of a number, is the number that was meant.

    A whole number has to be exact, a fraction right to the last digit of a REAL: 16777217 and 1.0e-46 are no REALs.
    """
    return nearest == value if isinstance(value, int) else abs(nearest - value) <= abs(value) * 2.0**-24


def _encode(text: str, *, wide: bool) -> bytes:
    try:
        return text.encode("utf-16-be", "surrogatepass") if wide else text.encode("latin-1")
    except UnicodeEncodeError as error:
        raise UnfitValueError(f"character {text[error.start]!r} needs a WSTRING") from None


def _pack_string(text: str, type_: StringType) -> bytes:
    wide = type_.name == "WSTRING"
    data = _encode(text, wide=wide)
    length = len(data) // 2 if wide else len(data)
    if length > type_.length:
        raise UnfitValueError(f"{length} characters do not fit {type_.name}[{type_.length}]")
    unit = 2 if wide else 1
    return type_.length.to_bytes(unit) + length.to_bytes(unit) + data.ljust(type_.length * unit, b"\x00")
