"""Canonical spelling of constants in the two tool chains; the inverse of ``literals``."""

from __future__ import annotations

import datetime as dt
import math
import struct

from plcgen.s7.types import durations
from plcgen.s7.types.address import Pointer
from plcgen.s7.types.data_types import ArrayType, DataType, Elementary, NamedType, StringType
from plcgen.s7.types.values import BIT_STRINGS, Value

_V5_PREFIX = {"BYTE": "B#", "WORD": "W#", "DWORD": "DW#", "LWORD": "LWORD#"}
_DIGITS = {"BYTE": 2, "WORD": 4, "DWORD": 8, "LWORD": 16}


def spell(value: Value, type_: Elementary | StringType, *, v5: bool) -> str:
    """Spell a value that fits its type: STEP 7 V5 with ``B#16#`` and ``L#``, TIA Portal without.

    Raises ValueError for infinities and NaN: they have no literal.
    """
    name = type_.name
    if isinstance(type_, StringType) or name in ("CHAR", "WCHAR"):
        wide = name.startswith("W")
        quoted = _quote(str(value), wide=wide)
        return f"{name}#{quoted}" if wide else quoted
    if name == "BOOL":
        return "TRUE" if value else "FALSE"
    if name in ("REAL", "LREAL") and isinstance(value, int | float):
        return format_real(float(value), short=name == "REAL")
    if isinstance(value, Pointer):
        return str(value)
    if isinstance(value, dt.datetime):
        clock = ((value.hour * 60 + value.minute) * 60 + value.second) * 1000 + value.microsecond // 1000
        return f"DT#{value.date().isoformat()}-{durations.format_clock(clock * durations.NS_PER_MS, 3)}"
    if isinstance(value, dt.date):
        return f"D#{value.isoformat()}"
    if isinstance(value, int):
        return _spell_int(value, name, v5=v5)
    return "NIL" if v5 else "NULL"


def _spell_int(value: int, name: str, *, v5: bool) -> str:
    if name in BIT_STRINGS:
        return f"{_V5_PREFIX[name] if v5 else ''}16#{value:0{_DIGITS[name]}X}"
    if name in ("TIME", "S5TIME", "LTIME"):
        prefix = {"TIME": "T#", "S5TIME": "S5T#", "LTIME": "LT#"}[name]
        nanoseconds = value if name == "LTIME" else value * durations.NS_PER_MS
        return prefix + durations.format_duration(nanoseconds)
    if name == "TIME_OF_DAY":
        return f"TOD#{durations.format_clock(value * durations.NS_PER_MS, 3)}"
    if name == "LTIME_OF_DAY":
        return f"LTOD#{durations.format_clock(value, 9)}"
    if name in ("LDT", "DTL"):
        return f"{name}#{durations.format_moment(value, 9)}"
    return f"L#{value}" if v5 and name == "DINT" else str(value)


def rounded_single(value: float) -> float:
    """Round to a 32-bit REAL."""
    result: float = struct.unpack(">f", struct.pack(">f", value))[0]
    return result


def format_real(value: float, *, short: bool = True) -> str:
    """Shortest decimal with a point that reads back to the same REAL (LREAL): ``10.0``, ``1.0E+20``.

    Raises ValueError for infinities and NaN: they have no literal.
    """
    if not math.isfinite(value):
        raise ValueError(f"{value} has no literal")
    if short:
        wanted = rounded_single(value)
        spellings = (float(f"{wanted:.{digits}g}") for digits in range(1, 18))
        value = next(number for number in spellings if abs(number) < 3.4028236e38 and rounded_single(number) == wanted)
    mantissa, _, exponent = repr(value).partition("e")
    if "." not in mantissa:
        mantissa += ".0"
    return f"{mantissa}E{int(exponent):+d}" if exponent else mantissa


def _quote(text: str, *, wide: bool) -> str:
    return "'" + "".join(_character(char, wide=wide) for char in text) + "'"


def _character(char: str, *, wide: bool) -> str:
    if char in "$'":
        return f"${char}"
    if char.isprintable():
        return char
    codes = char.encode("utf-16-be", "surrogatepass").hex().upper() if wide else f"{ord(char):02X}"
    return "".join(f"${codes[i : i + 4]}" for i in range(0, len(codes), 4))


def type_text(type_: DataType) -> str:
    """Type in the spelling of STEP 7 V5, which every S7 engineer reads: ``ARRAY[0..3] OF BYTE``."""
    if isinstance(type_, ArrayType):
        return f"ARRAY[{type_.bounds_text}] OF {type_text(type_.element)}"
    if isinstance(type_, StringType):
        return f"{type_.name}[{type_.length}]"
    if isinstance(type_, NamedType):
        return f'"{type_.name}"' if type_.quoted else type_.name
    return type_.name if isinstance(type_, Elementary) else "STRUCT"
