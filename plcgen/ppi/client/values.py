"""Values of S7-200 items by data type, bytes <-> Python values <-> text, and what people type to name them.

Types: BOOL, BYTE, WORD, DWORD (unsigned), INT, DINT (signed), REAL, CHAR (text of fixed length), STRING (a length byte,
then the characters; SIMATIC S7-200 system manual, "Format of the STRING data type"). Everything is big-endian.
"""

from __future__ import annotations

import math
import re
import struct
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

from plcgen.base.diagnostics import PlcgenError
from plcgen.base.diagnostics.counting import quantity
from plcgen.base.diagnostics.suggest import did_you_mean
from plcgen.ppi.wire.address import PpiAddressError, address_text, parse_item
from plcgen.ppi.wire.areas import OCTETS, Area, TransportSize
from plcgen.ppi.wire.model import Item, ItemWrite

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from plcgen.ppi.symbols import SymbolTable

Value: TypeAlias = bool | int | float | str | tuple[bool, ...] | tuple[int, ...] | tuple[float, ...]
"""One value, or one per element of an item with a count; texts for CHAR and STRING."""

_WIDTHS = {"BOOL": 0, "BYTE": 1, "WORD": 2, "INT": 2, "DWORD": 4, "DINT": 4, "REAL": 4, "CHAR": 1, "STRING": 1}
TYPES = tuple(_WIDTHS)
_DEFAULTS: dict[int, str] = {
    TransportSize.BIT: "BOOL", TransportSize.BYTE: "BYTE", TransportSize.CHAR: "CHAR", TransportSize.WORD: "WORD",
    TransportSize.INT: "INT", TransportSize.DWORD: "DWORD", TransportSize.DINT: "DINT", TransportSize.REAL: "REAL",
}  # fmt: skip
_ELEMENTS = {Area.C: "INT", Area.T: "DWORD", Area.HC: "DINT"}
"""Counters count to -32768..32767, high-speed counters have 32 bits with sign; a status byte stands before."""

_RANGES = {
    "BYTE": (0, 0xFF), "WORD": (0, 0xFFFF), "DWORD": (0, 0xFFFFFFFF),
    "INT": (-0x8000, 0x7FFF), "DINT": (-0x80000000, 0x7FFFFFFF),
}  # fmt: skip
_SIGNED = {"BYTE": "BYTE", "WORD": "INT", "DWORD": "DINT"}
_BOOLS = {"1": True, "0": False, "true": True, "false": False, "on": True, "off": False}
_FORMATS = {"BYTE": "B", "WORD": "H", "INT": "h", "DWORD": "I", "DINT": "i", "REAL": "f"}
_LONGEST = 40
"""Digits of a number; more are not even converted."""

_PREFIXES = (("16#", 16), ("0x", 16), ("8#", 8), ("2#", 2), ("$", 16))


class ItemValueError(PlcgenError, ValueError):
    """A value or a type that does not suit an item: what is wrong and how to write it."""

    def __init__(self, message: str, help_: str = "") -> None:
        self.message, self.help = message, help_
        super().__init__(message)


def default_type(item: Item) -> str:
    """Type that an item has if none is given: BOOL, BYTE, WORD, DWORD; INT for C, DINT for HC, CHAR for SYS."""
    if item.by_element:
        return _ELEMENTS[Area(item.area)]
    if item.area == Area.SYS and item.size == TransportSize.BYTE and item.count > 1:
        return "CHAR"
    return _DEFAULTS.get(item.size, "DWORD")


def check_type(item: Item, name: str) -> str:
    """Return the type in upper case; ItemValueError if it is unknown or has another width than the item."""
    type_ = name.upper()
    if type_ not in _WIDTHS:
        raise ItemValueError(
            f'"{name}" is not a data type', f"{did_you_mean(type_, TYPES)} types: {', '.join(TYPES)}".strip()
        )
    width = _WIDTHS[type_]
    bit = item.size == TransportSize.BIT
    if item.by_element and type_ != default_type(item):
        raise ItemValueError(f"{address_text(item)} has a type of its own, not {type_}")
    if not item.by_element and (bit != (width == 0) or (not bit and OCTETS[item.size] != width)):
        ways = {0: "V100.0", 1: "VB100", 2: "VW100", 4: "VD100"}
        raise ItemValueError(f"{type_} does not suit {address_text(item)}", f"{type_} is written {ways[width]}:{type_}")
    return type_


def unpack(item: Item, data: bytes, type_: str = "") -> Value:
    """Return the value in the bytes of an item; of timers and counters the current value without the status."""
    kind = type_ or default_type(item)
    if item.by_element:
        step, width = len(data) // item.count, _WIDTHS[_ELEMENTS[Area(item.area)]]
        chunks = (data[at - width : at] for at in range(step, len(data) + 1, step))
        numbers = tuple(int.from_bytes(chunk, "big", signed=item.area != Area.T) for chunk in chunks)
        return numbers[0] if item.count == 1 else numbers
    if kind == "BOOL":
        return bool(data[0])
    if kind == "CHAR":
        return data.decode("latin-1")
    if kind == "STRING":
        return data[1 : 1 + data[0]].decode("latin-1")
    values = struct.unpack(f">{len(data) // _WIDTHS[kind]}{_FORMATS[kind]}", data)
    return values[0] if item.count == 1 else values


def pack_item(item: Item, value: Value | Sequence[bool | int | float], type_: str = "") -> bytes:
    """Return the bytes of a value for an item; ItemValueError if it does not fit."""
    kind = type_ or default_type(item)
    if isinstance(value, str):
        return _text(item, value, kind)
    values = (value,) if isinstance(value, int | float) else tuple(value)
    if len(values) != item.count:
        raise ItemValueError(f"{address_text(item)} takes {quantity(item.count, 'value')}, not {len(values)}")
    if item.by_element:
        return b"".join(b"\x00" + _whole(entry, _ELEMENTS[Area(item.area)]) for entry in values)
    if kind in {"CHAR", "STRING"}:
        raise ItemValueError(f"{kind} takes a text", f"for example {address_text(item)}:{kind}='abc'")
    return b"".join(_pack_one(entry, kind) for entry in values)


def _pack_one(value: float, kind: str) -> bytes:
    if kind == "BOOL":
        if value not in {0, 1}:
            raise ItemValueError(f"a bit is 0 or 1, not {value}")
        return bytes((int(value),))
    if kind != "REAL":
        return _whole(value, kind)
    try:
        return struct.pack(">f", value)
    except OverflowError:
        raise ItemValueError(f"{value} is too large for a REAL") from None


def _whole(value: float, kind: str) -> bytes:
    """An integer of its type; unsigned types take negative numbers of the same width as well."""
    if not isinstance(value, int):
        raise ItemValueError(
            f"{value} is not a whole number", "give the type REAL for a floating-point number: VD100:REAL=1.5"
        )
    low, high = _RANGES[kind]
    low = min(low, _RANGES[_SIGNED.get(kind, kind)][0])
    if not low <= value <= high:
        raise ItemValueError(f"{value} is outside {low}..{high} of a {kind}")
    return (value & ((1 << 8 * _WIDTHS[kind]) - 1)).to_bytes(_WIDTHS[kind], "big")


def _text(item: Item, text: str, kind: str) -> bytes:
    if kind not in {"CHAR", "STRING"}:
        raise ItemValueError(f"{kind} takes a number, not a text", f"write {address_text(item)}:CHAR for a text")
    try:
        data = text.encode("latin-1")
    except UnicodeEncodeError:
        raise ItemValueError("the text has characters that an S7-200 cannot hold", "use Latin-1 characters") from None
    room = item.octets - (kind == "STRING")
    if len(data) > room:
        raise ItemValueError(f"the text has {len(data)} characters, {address_text(item)} holds {room}")
    if kind == "CHAR":
        return data.ljust(room)
    return bytes((len(data),)) + data.ljust(room, b"\x00")


def parse_item_value(item: Item, text: str, type_: str = "") -> tuple[bytes, str]:
    """Return the bytes of what people type for an item, and the type they are of.

    Numbers: ``1234``, ``-5``, ``16#04D2``, ``0x4D2``, ``2#1010``, ``1.5``, several with commas; bits ``0 1
    true false``; texts with or without quotes for CHAR and STRING. A number with a point makes a double word a REAL.
    """
    kind = type_ or default_type(item)
    if kind in {"CHAR", "STRING"}:
        quoted = len(text) > 1 and text[0] == text[-1] and text[0] in "'\""
        return _text(item, text[1:-1] if quoted else text, kind), kind
    if not text.strip():
        raise ItemValueError(f"{address_text(item)} has no value")
    pieces = [piece.strip() for piece in text.split(",")]
    if len(pieces) != item.count:
        raise ItemValueError(f"{address_text(item)} takes {quantity(item.count, 'value')}, not {len(pieces)}")
    if not type_ and kind == "DWORD" and not item.by_element and any(_is_real(piece) for piece in pieces):
        kind = "REAL"
    if kind == "BOOL":
        return pack_item(item, _bool(pieces[0]), kind), kind
    values = [_real(piece) if kind == "REAL" else _integer(piece) for piece in pieces]
    return pack_item(item, values, kind), kind


def _bool(text: str) -> bool:
    value = _BOOLS.get(text.lower())
    if value is None:
        raise ItemValueError(f'"{text}" is not a bit', "a bit is 0 or 1")
    return value


_REAL = re.compile(r"[+-]?([0-9]+\.[0-9]*|\.[0-9]+|[0-9]+)([eE][+-]?[0-9]+)?")


def _is_real(text: str) -> bool:
    return _REAL.fullmatch(text) is not None and not re.fullmatch(r"[+-]?[0-9]+", text)


def _real(text: str) -> float:
    if _REAL.fullmatch(text) is None:
        raise ItemValueError(f'"{text}" is not a number', "for example 1.5, -2 or 1e3")
    number = float(text)
    if not math.isfinite(number):
        raise ItemValueError(f"{text} is too large for a REAL")
    return number


def _integer(text: str) -> int:
    body, sign = (text[1:], -1) if text.startswith("-") else (text.removeprefix("+"), 1)
    base = 10
    for prefix, radix in _PREFIXES:
        if body.lower().startswith(prefix):
            body, base = body[len(prefix) :], radix
            break
    digits = body.replace("_", "").lower()
    if not digits or len(digits) > _LONGEST or not set(digits) <= set("0123456789abcdef"[:base]):
        help_ = (
            "give the type REAL for a floating-point number" if _is_real(text) else "for example 1234, -5 or 16#04D2"
        )
        raise ItemValueError(f'"{text[:40]}" is not a whole number', help_)
    return sign * int(digits, base)


def text_of(value: Value, type_: str = "") -> str:
    """Write a value as people read it: ``1``, ``1234``, ``1.5``, ``'abc'``, elements with commas."""
    if isinstance(value, tuple):
        return ", ".join(text_of(entry, type_) for entry in value)
    if isinstance(value, bool):
        return "1" if value else "0"
    if isinstance(value, float):
        from plcgen.s7.types.literals import format_real

        return format_real(value) if math.isfinite(value) else str(value)
    return f"'{value}'" if isinstance(value, str) else str(value)


ADDRESS, VALUE, LIMIT = "PG711", "PG716", "PG715"
BEYOND = "PG713"


class PlaceError(PlcgenError, ValueError):
    """A place or a value that cannot be used: diagnostic code, what is wrong, how to write it."""

    def __init__(self, code: str, message: str, help_: str = "") -> None:
        self.code, self.message, self.help = code, message, help_
        super().__init__(message)


@dataclass(frozen=True, slots=True)
class Place:
    """An item with the name the user gave it and the data type of its values (empty: what the address says)."""

    name: str
    item: Item
    type: str = ""

    @property
    def address(self) -> str:
        """Its address, in international mnemonics."""
        return address_text(self.item)

    @property
    def type_name(self) -> str:
        """Data type of its values."""
        return self.type or default_type(self.item)

    def value(self, data: bytes) -> Value:
        """Value in the bytes of its item."""
        return unpack(self.item, data, self.type)

    def write(self, value: Value | Sequence[bool | int | float]) -> ItemWrite:
        """Item and bytes that write a Python value. Raises PlaceError."""
        try:
            return ItemWrite(self.item, pack_item(self.item, value, self.type))
        except ItemValueError as problem:
            raise PlaceError(VALUE, problem.message, problem.help) from problem


def parse_place(text: str, symbols: SymbolTable | None = None) -> Place:
    """Read ``VB100``, ``VD100:REAL``, ``VB100[21]:STRING`` or a symbol with or without a type. Raises PlaceError."""
    name, colon, type_ = text.rpartition(":")
    if not colon:
        name, type_ = text, ""
    item = _item(name.strip(), symbols)
    if colon and not type_:
        raise PlaceError(VALUE, f'"{text}": the data type is missing', "for example VD100:REAL")
    try:
        known = check_type(item, type_.strip()) if type_ else ""
    except ItemValueError as problem:
        raise PlaceError(VALUE, f'"{text}": {problem.message}', problem.help) from problem
    if known == "STRING" and item.count == 1:
        help_ = f"for 20 characters write {address_text(item)}[21]:STRING, length byte included"
        raise PlaceError(VALUE, f'"{text}": a STRING has more than one byte', help_)
    return Place(text.strip(), item, known)


def _item(name: str, symbols: SymbolTable | None) -> Item:
    found = symbols.find(name) if symbols is not None else None
    if found is not None:
        return found.item
    try:
        return parse_item(name)
    except PpiAddressError as problem:
        if symbols is None or any(char in "0123456789" for char in name):
            raise PlaceError(problem.code, problem.message, problem.help) from problem
        hint = did_you_mean(name, symbols.names) or "upper and lower case are the same in symbols"
        raise PlaceError(problem.code, f'"{name}" is neither a symbol of the table nor an address', hint) from problem


def parse_assignment(text: str, symbols: SymbolTable | None = None) -> tuple[Place, ItemWrite]:
    """Read ``VW100=1234``, ``VD100:REAL=1.5``, ``VD100=1.5:REAL`` or ``level=3``. Raises PlaceError."""
    name, equals, rest = text.partition("=")
    if not equals or not rest:
        raise PlaceError(VALUE, f'"{text}" has no value', "for example VW100=1234")
    if ":" not in name:
        value, colon, type_ = rest.rpartition(":")
        if colon and type_.isalpha() and not value.endswith(("'", '"')) ^ value.startswith(("'", '"')):
            name, rest = f"{name}:{type_}", value
    place = parse_place(name, symbols)
    try:
        data, kind = parse_item_value(place.item, rest, place.type)
    except ItemValueError as problem:
        raise PlaceError(VALUE, f'"{text}": {problem.message}', problem.help) from problem
    return Place(place.name, place.item, kind), ItemWrite(place.item, data)


def beyond(item: Item, sizes: Mapping[Area, int], cpu: str) -> PlaceError | None:
    """Return the error of an item that ends behind the memory of a CPU; ``sizes`` counts bytes or elements."""
    area = Area(item.area)
    size = sizes.get(area, 0)
    last = item.address + item.count - 1 if item.by_element else item.byte + item.octets - 1
    if last < size:
        return None
    first, name = address_text(item), area.name
    if size == 0:
        return PlaceError(BEYOND, f"{first}: {cpu} has no {area.title}")
    unit = "" if item.by_element or area is Area.SYS else "B"
    reach = f"reaches {name}{unit}{last}" if item.count > 1 or item.octets > 1 else "does not exist"
    return PlaceError(
        BEYOND, f"{first} {reach}, {cpu} ends at {name}{unit}{size - 1}", f"the last is {name}{unit}{size - 1}"
    )


def too_long(item: Item, limit: int) -> PlaceError | None:
    """Return the error of an item that is longer than one telegram carries."""
    if item.octets <= limit:
        return None
    text = f"{address_text(item)} has {item.octets} bytes; one telegram carries {limit}"
    return PlaceError(LIMIT, text, "plcgen ppi read and write, and encode --pack, use as many telegrams as needed")
