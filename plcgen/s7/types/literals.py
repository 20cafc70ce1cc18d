"""S7 constants: text to value to bytes, and back to the spelling of a tool chain; start values of structures."""

from __future__ import annotations

import datetime as dt
import math
import re
import struct
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

from plcgen.base.diagnostics import PlcgenError
from plcgen.s7.types import durations
from plcgen.s7.types.address import Pointer, parse_pointer
from plcgen.s7.types.data_types import (
    ALIASES,
    ELEMENTARY,
    ArrayType,
    DataType,
    Elementary,
    NamedType,
    StringType,
    elementary,
)
from plcgen.s7.types.values import BIT_STRINGS, NUMBERS, RANGES, SIGNED, UNSIGNED, Value, pack_value

if TYPE_CHECKING:
    from collections.abc import Iterator

_SHORT = {
    "B": "BYTE", "W": "WORD", "DW": "DWORD", "LW": "LWORD", "I": "INT", "L": "DINT",
    "T": "TIME", "S5T": "S5TIME", "LT": "LTIME", "D": "DATE", **ALIASES,
}  # fmt: skip
_TYPED = re.compile(r"([A-Za-z][A-Za-z0-9_]*)#(.*)", re.DOTALL)
_BASED = re.compile(r"(2|8|16)#([0-9A-Fa-f_]+)")
_DECIMAL = re.compile(r"[+-]?\d[\d_]*", re.ASCII)
_REAL = re.compile(r"[+-]?\d[\d_]*(?:\.\d[\d_]*)?(?:[eE][+-]?\d+)?", re.ASCII)
_BYTES = re.compile(r"\(\s*(\d+(?:\s*,\s*\d+)*)\s*\)", re.ASCII)
_WITHIN = re.compile(r"P#\s*(\d{1,5})\.([0-7])", re.IGNORECASE | re.ASCII)
"""A pointer inside an area: bits 3..18 are the byte, 0..2 the bit."""
_PLACE = {
    "TIMER": re.compile(r"T\s*(\d{1,5})", re.IGNORECASE | re.ASCII),
    "COUNTER": re.compile(r"[CZ]\s*(\d{1,5})", re.IGNORECASE | re.ASCII),
    **{
        name: re.compile(rf"{name.removeprefix('BLOCK_')}\s*(\d{{1,5}})", re.IGNORECASE | re.ASCII)
        for name in NUMBERS
        if name.startswith("BLOCK_")
    },
}
"""A timer, counter or block by its number: ``T 5``, ``Z 5`` of German STEP 7, ``FB 12`` as TIA Portal exports it."""
_ESCAPE = re.compile(r"\$(?:([$'\"LNPRT])|([0-9A-F]{4})|([0-9A-F]{2})|(.?))", re.IGNORECASE | re.DOTALL)
_CONTROL = {"L": "\n", "N": "\r\n", "P": "\f", "R": "\r", "T": "\t"}
_TEXT = frozenset({"CHAR", "WCHAR"})
_INTEGERS = SIGNED | UNSIGNED | NUMBERS


class LiteralError(PlcgenError, ValueError):
    """A text that is no constant of the wanted type; ``reason`` says why."""

    def __init__(self, text: str, type_name: str, reason: str) -> None:
        self.text = text
        self.type_name = type_name
        self.reason = reason
        super().__init__(f"{text} is not a valid {type_name} constant: {reason}")


def as_type(type_: Elementary | StringType | str) -> Elementary | StringType:
    """Resolve a type name; ``STRING`` and ``WSTRING`` have 254 characters. Raises KeyError if unknown."""
    if not isinstance(type_, str):
        return type_
    if type_.upper() in ("STRING", "WSTRING"):
        return StringType(type_.upper(), 254)
    found = elementary(type_)
    if found is None:
        raise KeyError(type_)
    return found


def parse_literal(text: str, type_: Elementary | StringType | str) -> Value:
    """Value of a constant as ``values`` describes it. Raises LiteralError with a reason."""
    wanted = as_type(type_)
    try:
        value = _parse(text.strip(), wanted)
        pack_value(value, wanted)
    except (ValueError, OverflowError) as error:
        reason = error.reason if isinstance(error, LiteralError) else str(error)
        raise LiteralError(text, wanted.name, reason) from None
    if wanted.name == "REAL" and isinstance(value, float):
        return rounded_single(value)
    if wanted.name == "S5TIME" and isinstance(value, int):
        return durations.from_s5time(durations.to_s5time(value))
    return value


def pack_literal(text: str, type_: Elementary | StringType | str) -> bytes:
    """Big-endian bytes of a constant (BOOL: one byte 00 or 01). Raises LiteralError with a reason."""
    wanted = as_type(type_)
    return pack_value(parse_literal(text, wanted), wanted)


def _parse(text: str, type_: Elementary | StringType) -> Value:
    name = type_.name
    prefix, body = _prefix(text)
    if isinstance(type_, StringType):
        _expect(prefix, {"", "STRING", name})
        return _unquote(body, wide=name == "WSTRING")
    if name in ("ANY", "POINTER"):
        return None if body.upper() in ("NIL", "NULL") else parse_pointer(text)
    if name == "BOOL":
        _expect(prefix, {"", "BOOL"})
        upper = body.upper()
        if upper in ("TRUE", "FALSE"):
            return upper == "TRUE"
        if _DECIMAL.fullmatch(body) or _BASED.fullmatch(body):
            value, _ = _number(body)
            if value in (0, 1):
                return value == 1
        raise ValueError("TRUE, FALSE, 1 or 0")
    if name in BIT_STRINGS or name in _INTEGERS:
        return _whole(prefix, body, name)
    if name in ("REAL", "LREAL"):
        _expect(prefix, {"", "REAL", name})
        return _real(body)
    if name in _TEXT:
        _expect(prefix, {"", "CHAR", name})
        return _unquote(body, wide=name == "WCHAR")
    # S7-SCL converts a TIME constant where S5TIME is wanted: TV := T#5s
    _expect(prefix, {name, "TIME"} if name == "S5TIME" else {name})
    if name in ("TIME", "S5TIME", "LTIME"):
        return _ticks(durations.parse_duration(body), name)
    if name == "DATE":
        return durations.parse_date(body)
    if name in ("TIME_OF_DAY", "LTIME_OF_DAY"):
        return _ticks(durations.parse_clock(body, 9 if name[0] == "L" else 3), name)
    date, clock = durations.parse_moment(body, 3 if name == "DATE_AND_TIME" else 9)
    if name == "DATE_AND_TIME":
        start = dt.datetime.combine(date, dt.time())
        return start + dt.timedelta(microseconds=clock // 1000)
    return durations.since_epoch(date, clock)


def _prefix(text: str) -> tuple[str, str]:
    """Canonical type name and the rest; no name for ``16#..`` and plain text."""
    match = None if text[:1] in ("'", '"') else _TYPED.fullmatch(text)
    if match is None:
        return "", text
    upper = match[1].upper()
    return _SHORT.get(upper, upper), match[2]


def _expect(prefix: str, allowed: set[str]) -> None:
    if prefix in allowed:
        return
    wanted = " or ".join(sorted(f"{name}#" for name in allowed if name))
    if prefix:
        raise ValueError(f"{prefix}# does not fit this type")
    raise ValueError(f"it needs the prefix {wanted}")


def _whole(prefix: str, body: str, name: str) -> int:
    place = _PLACE[name].fullmatch(body) if name in _PLACE else None
    if place is not None:
        return int(place[1])
    if prefix == "C" and name == "WORD":
        if not (body.isascii() and body.isdecimal()) or int(body) > 999:
            raise ValueError("C# counts from 0 to 999")
        return durations.to_bcd(int(body))
    within = _WITHIN.fullmatch(f"P#{body}") if prefix == "P" and name == "DWORD" else None
    if within is not None and int(within[1]) < 1 << 16:
        return int(within[1]) << 3 | int(within[2])
    if prefix in _TEXT and name in BIT_STRINGS:
        return ord(_unquote(body, wide=False))
    if prefix:
        _widening(prefix, name)
    tuple_ = _BYTES.fullmatch(body) if prefix == "BYTE" else None
    bits = ELEMENTARY[name].bits
    if tuple_ is not None:
        parts = [int(part) for part in tuple_[1].split(",")]
        if len(parts) * 8 != bits or max(parts) > 255:
            raise ValueError(f"{bits // 8} bytes from 0 to 255")
        return int.from_bytes(bytes(parts))
    value, plain = _number(body)
    low, high = RANGES[prefix if prefix in RANGES else name]
    if name in BIT_STRINGS and plain and not prefix:
        low = -(1 << bits - 1)
    if not low <= value <= high:
        raise ValueError(f"outside {low}..{high}")
    return value & (1 << bits) - 1 if name in BIT_STRINGS else value


def _widening(prefix: str, name: str) -> None:
    """Refuse a typed constant unless the type is its own or a wider one of its family."""
    if prefix == name:
        return
    for family in (BIT_STRINGS, SIGNED | UNSIGNED):
        if prefix in family and name in family:
            low, high = RANGES[name]
            own_low, own_high = RANGES[prefix]
            if low <= own_low and own_high <= high:
                return
    if prefix in ("INT", "UINT", "WORD") and name in NUMBERS:
        return
    raise ValueError(f"{prefix}# does not fit this type")


def _number(body: str) -> tuple[int, bool]:
    """Value and whether it is written in plain decimal."""
    if _DECIMAL.fullmatch(body):
        return int(body.replace("_", "")), True
    match = _BASED.fullmatch(body)
    if match is None:
        raise ValueError("not a whole number")
    return int(match[2].replace("_", "") or "x", int(match[1])), False


def _real(body: str) -> float:
    if _REAL.fullmatch(body) is None:
        raise ValueError("a real number looks like 10.0 or 1.0E+1")
    value = float(body.replace("_", ""))
    if math.isinf(value):
        raise ValueError("too large")
    return value


def _ticks(nanoseconds: int, name: str) -> int:
    if name.startswith("L"):
        return nanoseconds
    milliseconds, rest = divmod(nanoseconds, durations.NS_PER_MS)
    if rest:
        raise ValueError("the resolution is 1 ms")
    return milliseconds


def _unquote(body: str, *, wide: bool) -> str:
    if len(body) < 2 or body[0] != "'" or body[-1] != "'":
        raise ValueError("a text must be in single quotes")
    inner = body[1:-1]
    if re.search(r"(?<!\$)(?:\$\$)*'", inner) or re.search(r"(?<!\$)(?:\$\$)*\$$", inner):
        raise ValueError("a quote inside a text is written $'")

    def escape(match: re.Match[str]) -> str:
        special, four, two, other = match.groups()
        if special:
            return _CONTROL.get(special.upper(), special)
        if four and wide:
            return chr(int(four, 16))
        if (two or four) and not wide:
            digits = two or four[:2]
            return chr(int(digits, 16)) + (four[2:] if four else "")
        raise ValueError(f"${other or two} is no escape")

    return _ESCAPE.sub(escape, inner)


def format_literal(value: Value, type_name: str, dialect_v5: bool = False) -> str:  # noqa: FBT001, FBT002 - fixed signature
    """Spell a value canonically: STEP 7 V5 with ``B#16#``, ``L#``; TIA Portal with ``16#``, plain numbers.

    Inverse of :func:`parse_literal`. Raises LiteralError for values without a literal.
    """
    type_ = as_type(type_name)
    try:
        pack_value(value, type_)
        return spell(value, type_, v5=dialect_v5)
    except (ValueError, OverflowError) as error:
        raise LiteralError(repr(value), type_.name, str(error)) from None


_V5_PREFIX = {"BYTE": "B#", "WORD": "W#", "DWORD": "DW#", "LWORD": "LWORD#"}
_DIGITS = {"BYTE": 2, "WORD": 4, "DWORD": 8, "LWORD": 16}


def spell(value: Value, type_: Elementary | StringType, *, v5: bool) -> str:
    """Spell a value that fits its type: STEP 7 V5 with ``B#16#`` and ``L#``, TIA Portal without.

    Raises ValueError for infinities and NaN: they have no literal.
    """
    name = type_.name
    if isinstance(type_, StringType) or name in ("CHAR", "WCHAR"):
        wide = name.startswith("W")
        quoted = "'" + "".join(_character(char, wide=wide) for char in str(value)) + "'"
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
    return "NIL" if v5 else "NULL"


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


@dataclass(frozen=True, slots=True)
class Group:
    """A bracketed list; ``kind`` is ``[`` or ``(``, or empty for a bare list."""

    kind: str
    items: tuple[InitialItem, ...]


@dataclass(frozen=True, slots=True)
class InitialItem:
    """One value of a list, ``count`` times, for the member ``name`` if given; None keeps the default."""

    value: Node
    name: str | None = None
    count: int = 1


Node: TypeAlias = "Group | str | None"

MAX_DEPTH = 32
_REPEAT = re.compile(r"(\d[\d_]*)\s*\(", re.ASCII)
_NAME = re.compile(r'(?:"([^"]+)"|([^\W\d]\w*))\s*:=\s*')
_PLAIN_TEXT = re.compile(r"'(?:[^'$]|\$.)*'", re.DOTALL)


class _Reader:
    def __init__(self, text: str) -> None:
        self.text = text
        self.position = 0

    def fail(self, reason: str) -> LiteralError:
        return LiteralError(self.text, "start value", reason)

    def skip(self) -> str:
        while self.position < len(self.text) and self.text[self.position].isspace():
            self.position += 1
        return self.text[self.position : self.position + 1]

    def items(self, closing: str, depth: int) -> tuple[InitialItem, ...]:
        if depth > MAX_DEPTH:
            raise self.fail("nested too deeply")
        items: list[InitialItem] = []
        while True:
            items.append(self.item(closing, depth))
            char = self.skip()
            self.position += 1
            if char == closing:
                return () if items == [InitialItem(None)] else tuple(items)
            if char != ",":
                raise self.fail(f"expected , or {closing or 'the end'}")

    def item(self, closing: str, depth: int) -> InitialItem:
        char = self.skip()
        name = _NAME.match(self.text, self.position)
        if name is not None:
            self.position = name.end()
            return InitialItem(self.value(closing, depth), name[1] or name[2])
        repeat = _REPEAT.match(self.text, self.position)
        if repeat is not None:
            self.position = repeat.end()
            items = self.items(")", depth + 1)
            value = items[0].value if len(items) == 1 and items[0].count == 1 else Group("", items)
            return InitialItem(value, count=int(repeat[1].replace("_", "")))
        if char in ("", ",") or char == closing:
            return InitialItem(None)
        return InitialItem(self.value(closing, depth))

    def value(self, closing: str, depth: int) -> Node:
        char = self.skip()
        if char in ("[", "("):
            self.position += 1
            return Group(char, self.items("]" if char == "[" else ")", depth + 1))
        return self.literal(closing)

    def literal(self, closing: str) -> str:
        start, level = self.position, 0
        while self.position < len(self.text):
            text = _PLAIN_TEXT.match(self.text, self.position)
            if text is not None:
                self.position = text.end()
                continue
            char = self.text[self.position]
            if not level and char in (",", closing):
                break
            level += (char == "(") - (char == ")")
            self.position += 1
        return self.text[start : self.position].strip()


def parse_initializer(text: str) -> tuple[InitialItem, ...]:
    """Take a start value apart. Raises LiteralError with a reason if brackets or commas are wrong."""
    return _Reader(text).items("", 0)


def flatten(items: tuple[InitialItem, ...], limit: int, kinds: str = "[") -> Iterator[Node]:
    """Values in order, repetitions written out, groups of ``kinds`` opened; ends one after ``limit``."""
    produced = 0
    for item in items:
        opened = isinstance(item.value, Group) and (item.value.kind == "" or item.value.kind in kinds)
        for _ in range(min(item.count, limit + 1)):
            if produced > limit:
                return
            if opened and isinstance(item.value, Group):
                before = produced
                for node in flatten(item.value.items, limit - produced, kinds):
                    produced += 1
                    yield node
                    if produced > limit:
                        return
                if produced == before:
                    break
            else:
                produced += 1
                yield item.value
