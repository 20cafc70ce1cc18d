"""One address of a PPI job: find the symbol, settle area, type and value, or say what is wrong."""

from __future__ import annotations

import re
from dataclasses import dataclass

from plcgen.base.diagnostics import Diagnostic, Report
from plcgen.base.diagnostics.suggest import did_you_mean
from plcgen.ppi.plan.nouns import PlannedStation, PpiValue
from plcgen.ppi.schema import PpiReadItem, PpiWriteItem
from plcgen.ppi.symbols import PpiSymbol, SymbolTable
from plcgen.ppi.wire.address import PpiAddressError, address_text, parse_item
from plcgen.ppi.wire.areas import OCTETS, Area, TransportSize
from plcgen.ppi.wire.model import Item
from plcgen.project.spec import LoadedSpec, SpecPath
from plcgen.project.target import Target
from plcgen.s7.types.data_types import ELEMENTARY, ArrayType, DataType, Elementary, UnfitValueError
from plcgen.s7.types.names import RESERVED, TIA_LIMIT, V5_LIMIT, camel_case, shorten
from plcgen.s7.types.values import keeps, pack_value, unpack_value

WRITABLE = frozenset({Area.Q, Area.S, Area.M, Area.V, Area.AQ})
"""Areas that function 05 writes; inputs can only be forced, timers and counters are not confirmed."""
_DEFAULT = {1: "BYTE", 2: "WORD", 4: "DWORD"}
_SAME_SIZE = {
    1: ("BYTE", "CHAR", "USINT", "SINT"), 2: ("WORD", "INT", "UINT"), 4: ("DWORD", "DINT", "UDINT", "REAL"),
}  # fmt: skip
_NEW = frozenset({"USINT", "SINT", "UINT", "UDINT"})
_ADDRESS = re.compile(r"(?i)(?:P?[IQEA][BWDX]?|[ML][BWDX]?|[TCZ]|D[BI][BWDX]?|[FO][BC]|SF[BC]|UDT)[0-9]+\Z")
_ELEMENTS = {Area.T: ("DINT", 5, 1), Area.C: ("INT", 3, 1), Area.HC: ("DINT", 5, 1)}
"""Type of the current value, bytes of an element on the wire, bytes in front of the value."""


@dataclass(slots=True)
class ValueResolver:
    """Resolves the addresses of one station's jobs; problems go to the report, the value is then left out."""

    loaded: LoadedSpec
    where: Target
    station: PlannedStation
    symbols: SymbolTable
    report: Report

    def problem(self, code: str, message: str, path: SpecPath, help_: str = "") -> None:
        """Report an error at a place of the spec."""
        self.report.add(Diagnostic(code, message, self.loaded.span(path), help=help_))

    def resolve(self, given: PpiReadItem | PpiWriteItem, position: int, number: int, path: SpecPath) -> PpiValue | None:
        """Turn one entry of a job into a value; None if something about it is wrong."""
        place: SpecPath = (*path, "item")
        found = self._item(given.item, place)
        if found is None:
            return None
        item, symbol = found
        write = isinstance(given, PpiWriteItem)
        if not self._exists(item, given.item, place) or (write and not self._writable(item, given.item, place)):
            return None
        settled = self._type(item, given.type, path)
        if settled is None:
            return None
        element, count, stride, skip = settled
        data = b""
        constant = False
        if isinstance(given, PpiWriteItem):
            constant = given.value is not None
            packed = self._pack(given, element, count, path)
            if packed is None:
                return None
            data = packed
        name = symbol.name if symbol is not None else address_text(item)
        return PpiValue(
            position=position,
            number=number,
            label=name if symbol is None else f"{symbol.name} ({address_text(item)})",
            item=item,
            type=_type_of(element, count),
            element=element,
            count=count,
            stride=stride,
            skip=skip,
            member=given.as_ or self._member(symbol, item),
            data=data,
            constant=constant,
            title=symbol.comment if symbol is not None else "",
            comment=given.comment or {},
            path=path,
        )

    # --- address --------------------------------------------------------------------------------------

    def _item(self, text: str, place: SpecPath) -> tuple[Item, PpiSymbol | None] | None:
        symbol = self.symbols.find(text)
        if symbol is not None:
            return symbol.item, symbol
        try:
            return parse_item(text), None
        except PpiAddressError as problem:
            message, help_ = problem.message, problem.help
        known = self.symbols.names
        near = did_you_mean(text, known)
        if near or (known and not any(char.isdigit() for char in text)):
            help_ = f"{near} or write an address such as VB100".strip()
            self.problem("PG237", f'station "{self.station.key}" has no symbol "{text}"', place, help_)
        elif not known and re.fullmatch(r"[^\W\d][\w ]*", text) and not re.search(r"\d", text):
            self.problem("PG230", message, place, f"for symbols give the station its table: symbols: {text}.csv")
        else:
            self.problem("PG230", message, place, help_)
        return None

    def _exists(self, item: Item, text: str, place: SpecPath) -> bool:
        area, profile = Area(item.area), self.station.profile
        size = profile.sizes.get(area, 0)
        last = item.byte + (item.count if item.by_element else item.octets) - 1
        if last < size:
            return True
        if not size:
            self.problem("PG231", f"{text}: the {profile.title} has no {area.title}", place)
            return False
        what = "elements" if item.by_element else "bytes"
        first, end = (f"{area.name}{n}" if item.by_element else f"{area.name}B{n}" for n in (0, size - 1))
        message = f"{text} lies beyond the {profile.title}, which has {size} {what} of {area.title}: {first} to {end}"
        self.problem("PG231", message, place, "use a lower address, or give the station another cpu:")
        return False

    def _writable(self, item: Item, text: str, place: SpecPath) -> bool:
        area = Area(item.area)
        if area in WRITABLE:
            return True
        why = {
            Area.I: "inputs follow the terminals: they can only be forced, which PPI clients do not confirm",
            Area.AI: "analog inputs follow the terminals",
            Area.SM: "special memory belongs to the operating system",
            Area.SYS: "system information is fixed",
        }.get(area, f"writing {area.title} is not confirmed by any capture")
        places = "Q, M, V, S or AQ"
        self.problem("PG232", f"{text} cannot be written: {why}", place, f"write to {places}, and let the CPU copy it")
        return False

    # --- type and value -------------------------------------------------------------------------------

    def _type(self, item: Item, given: str | None, path: SpecPath) -> tuple[Elementary, int, int, int] | None:
        """Element type, count, bytes from one to the next on the wire, bytes in front of the value."""
        area = Area(item.area)
        if item.size == TransportSize.BIT:
            default, stride, skip = "BOOL", 1, 0
            allowed: tuple[str, ...] = ("BOOL",)
        elif area in _ELEMENTS:
            default, stride, skip = _ELEMENTS[area]
            allowed = _SAME_SIZE[ELEMENTARY[default].bits // 8]
        else:
            stride, skip = OCTETS[item.size], 0
            default = "CHAR" if area is Area.SYS else _DEFAULT[stride]
            allowed = _SAME_SIZE[stride]
        if not self.where.t15:
            allowed = tuple(name for name in allowed if name not in _NEW)
        name = default if given is None else given.upper()
        if name not in allowed:
            words = ", ".join(_title(word) for word in allowed)
            message = f"{address_text(item)} cannot be {given}"
            hint = did_you_mean(given or "", [_title(word) for word in allowed])
            self.problem("PG240", message, (*path, "type"), f"{hint} possible here: {words}".strip())
            return None
        return ELEMENTARY[name], item.count, stride, skip

    def _pack(self, given: PpiWriteItem, element: Elementary, count: int, path: SpecPath) -> bytes | None:
        """Wire bytes of the constant or start value; one value fills an array. Without one: 0, of a CHAR a blank."""
        value = given.value if given.value is not None else given.start
        place = (*path, "value" if given.value is not None else "start")
        name = element.name
        if value is None:
            return b" " * count if name == "CHAR" else bytes(count * max(1, element.bits // 8))
        if name == "BOOL" and not isinstance(value, bool) and value in {0, 1}:
            value = bool(value)
        whole = isinstance(value, int) and not isinstance(value, bool)
        right = (
            isinstance(value, bool) if name == "BOOL" else isinstance(value, str) if name == "CHAR" else False
        ) or (whole and name not in {"BOOL", "CHAR"}) or (isinstance(value, float) and name == "REAL")  # fmt: skip
        if not right:
            self.problem(
                "PG211", f'"{value}" is not a value of type {_title(name)}', place, "write a number, true or false"
            )
            return None
        try:
            data = pack_value(float(value) if name == "REAL" and not isinstance(value, str) else value, element)
            nearest = unpack_value(data, element)
            if isinstance(nearest, float) and not isinstance(value, str) and not keeps(nearest, value):
                raise UnfitValueError(f"Real does not have {value!r}: the nearest is {nearest!r}")
        except (ValueError, OverflowError) as problem:
            help_ = "write a value that it holds, or a wider address: VW for VB, VD for VW"
            self.problem("PG208", f"{given.item}: {problem}", place, help_)
            return None
        return data * count

    def _member(self, symbol: PpiSymbol | None, item: Item) -> str:
        """Default member name: the symbol, else the address."""
        if symbol is not None:
            name = camel_case(symbol.name)
        else:
            name = re.sub(r"[^a-z0-9]+", "_", address_text(item).partition("[")[0].lower())
        if not name or _ADDRESS.match(name) or name.upper() in RESERVED or name[0].isdigit():
            name = f"{name or 'item'}Value" if not name[:1].isdigit() else f"value{name}"
        return shorten(name, V5_LIMIT if self.where.v5 else TIA_LIMIT)


def _type_of(element: Elementary, count: int) -> DataType:
    return element if count == 1 else ArrayType(((0, count - 1),), element)


def _title(name: str) -> str:
    """Spelling of a type in messages: ``Int``, ``DWord``."""
    return {"DWORD": "DWord", "DINT": "DInt", "USINT": "USInt", "SINT": "SInt", "UINT": "UInt", "UDINT": "UDInt"}.get(
        name, name.capitalize()
    )
