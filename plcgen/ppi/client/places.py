"""What is to be read or written: an address or a symbol, with a data type after a colon: ``VD100:REAL``, ``level``."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from plcgen.base.diagnostics import PlcgenError
from plcgen.base.diagnostics.suggest import did_you_mean
from plcgen.ppi.client.values import ItemValueError, check_type, default_type, pack_item, parse_item_value, unpack
from plcgen.ppi.wire.address import PpiAddressError, address_text, parse_item
from plcgen.ppi.wire.areas import Area
from plcgen.ppi.wire.model import Item, ItemWrite

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from plcgen.ppi.client.values import Value
    from plcgen.ppi.symbols import SymbolTable

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
