"""What a name means inside a block, its own declarations first; values, places and symbols that are passed around."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from plcgen.base.diagnostics import DiagnosticError
from plcgen.s7.cpu.compiler.literals import literal_value
from plcgen.s7.cpu.memory import CODECS
from plcgen.s7.cpu.type_rules import INT_CONST, POINTERS, SIGNED_WIDTHS, WIDTHS
from plcgen.s7.layout.layout import layout_members
from plcgen.s7.layout.shapes import Shape, bare_shape
from plcgen.s7.scl import ast
from plcgen.s7.scl.constants import evaluate, integer, is_bits_of_real
from plcgen.s7.scl.parser import parse_value
from plcgen.s7.types.blocks import Block, BlockKind, SectionKind
from plcgen.s7.types.data_types import ArrayType, DataType, Elementary, Member, NamedType, StringType

UNKNOWN = "?"
"""Type of an expression that has been reported already."""


@dataclass(slots=True)
class MemoryPlace:
    """Somewhere in memory.

    ``mem`` is the generated name of the memory, ``off`` the fixed offset in bits; ``dyn`` and ``dynbit`` are
    generated expressions added to it in bytes and bits. ``region`` names the memory for the cache of values, None
    if anything may lie there. ``local`` is set instead for a variable that is a plain Python local.
    """

    shape: Shape
    mem: str = ""
    off: int = 0
    dyn: str = ""
    dynbit: str = ""
    region: str | None = None
    local: str = ""
    section: SectionKind | None = None
    overlay: bool = False
    member: Member | None = None
    """The declaration, of a member of a structure."""

    @property
    def fixed(self) -> bool:
        """Whether the offset is known at compile time."""
        return not self.dyn and not self.dynbit

    def inside(self, offset: int, shape: Shape, *, overlay: bool) -> MemoryPlace:
        """Return a place inside this one, ``offset`` bits behind its start."""
        off = self.off + offset
        return MemoryPlace(shape, self.mem, off, self.dyn, self.dynbit, self.region, self.local, self.section, overlay)


@dataclass(slots=True)
class Val:
    """A compiled expression.

    ``type`` is a canonical elementary type, STRING, a constant type, empty for structures, or UNKNOWN. ``raw``
    says that the integer in ``code`` still has to be wrapped to the type. ``const`` is the value of a constant.
    """

    code: str
    type: str
    const: object = None
    place: MemoryPlace | None = None
    raw: bool = False
    pure: bool = True
    parts: tuple[str, list[str]] | None = None

    @property
    def wrapped(self) -> str:
        """The code with an integer brought into the range of its type."""
        return wrapped(self.code, self.type) if self.raw else self.code


@dataclass(slots=True)
class Symbol:
    """A declared name: a place, a constant, or both None if its declaration was wrong."""

    name: str
    section: SectionKind
    place: MemoryPlace | None = None
    constant: Val | None = None
    type_name: str = ""


def unknown() -> Val:
    """Value of something that has been reported."""
    return Val("0", UNKNOWN)


def whole_constant(number: int) -> Val:
    """Value of a whole number without a type."""
    return Val(repr(number), INT_CONST, number)


def wrapped(code: str, type_: str) -> str:
    """Return code that brings an integer into the range of its type."""
    bits = WIDTHS.get(type_, 16)
    mask = (1 << bits) - 1
    if type_ in SIGNED_WIDTHS:
        half = 1 << bits - 1
        return f"(({code}+{half}&{mask})-{half})"
    return f"(({code})&{mask})"


@dataclass(slots=True, eq=False)
class Expressions:
    """Values and their types; a problem is reported once and gives the type UNKNOWN.

    ``parts`` maps a class of nodes to what compiles it; ``watch`` is shown every value.
    """

    parts: dict[type[ast.Expression], Callable[[Any], Val]] = dataclasses.field(default_factory=dict)
    watch: Callable[[ast.Expression, Val], None] | None = None

    def value(self, node: ast.Expression) -> Val:
        """Compile an expression."""
        return self.shown(node, self.parts[type(node)](node))

    def shown(self, node: ast.Expression, value: Val) -> Val:
        """The value of a node, shown to who watches."""
        if self.watch is not None:
            self.watch(node, value)
        return value


_FIRST = {
    "TIME": "T#0s", "LTIME": "LT#0s", "S5TIME": "S5T#0s", "DATE": "D#1990-01-01", "TIME_OF_DAY": "TOD#0:0:0",
    "LTIME_OF_DAY": "LTOD#0:0:0", "DATE_AND_TIME": "DT#1990-01-01-0:0:0", "LDT": "LDT#1970-01-01-0:0:0",
    "DTL": "DTL#1970-01-01-0:0:0",
}  # fmt: skip
"""What a constant of these types is without a value: the default of the type."""
_PARAMETERS = (SectionKind.INPUT, SectionKind.OUTPUT, SectionKind.IN_OUT, SectionKind.RETURN)


def scalar_name(shape: Shape) -> str:
    """Canonical elementary type of a shape, STRING or WSTRING; empty for structures and arrays."""
    type_ = shape.type
    if isinstance(type_, Elementary | StringType):
        return type_.name
    return "VARIANT" if isinstance(type_, NamedType) and type_.name.upper() == "VARIANT" else ""


def same_type(left: Shape, right: Shape) -> bool:
    """Whether two structures may be assigned: the same name, or the same members."""
    if isinstance(left.type, NamedType) and isinstance(right.type, NamedType):
        return left.type.name.upper() == right.type.name.upper()
    if len(left.fields) != len(right.fields) or (left.element is None) != (right.element is None):
        return False
    if left.element is not None and right.element is not None:
        if is_open(left) or is_open(right):
            return same_type(left.element, right.element)
        return left.strides == right.strides and same_type(left.element, right.element)
    if left.fields:
        return all(same_type(a.shape, b.shape) for a, b in zip(left.fields, right.fields, strict=True))
    return scalar_name(left) == scalar_name(right)


def is_open(shape: Shape) -> bool:
    """Whether an array takes what it is given: ``ARRAY[*]``."""
    return isinstance(shape.type, ArrayType) and not shape.type.bounds


def is_scalar(type_: DataType) -> bool:
    """Whether a value of this type is passed as a Python value."""
    return isinstance(type_, Elementary) and (type_.name in CODECS or type_.name == "BOOL")


def has_parts(type_: DataType) -> bool:
    """Whether the parts of a scalar have names: then a variable of it lies in memory."""
    return isinstance(type_, Elementary) and bool(bare_shape(type_.name).index)


class Scope:
    """The symbols of one block, and which memory they need: ``temp_size`` bytes of local data."""

    def __init__(
        self, block: Block, shape: Shape | None, types: Mapping[str, Block], *, untyped: bool, classic: bool = False
    ) -> None:
        self.block = block
        self.classic = classic
        self.types = types
        self.untyped = untyped
        self.symbols: dict[str, Symbol] = {}
        self.temp_shape: Shape | None = None
        self.locals: list[tuple[str, str]] = []
        self.problems: list[DiagnosticError] = []
        self.copied: list[tuple[str, Symbol]] = []
        self.variants: list[tuple[str, str]] = []
        self._constants(block)
        if block.kind is BlockKind.FB and shape is not None:
            self._instance(shape)
        else:
            self._parameters()
        self._temps()

    def _add(self, symbol: Symbol) -> None:
        self.symbols.setdefault(symbol.name.upper(), symbol)

    def _constants(self, block: Block) -> None:
        """Values of VAR CONSTANT and CONST."""
        known: dict[str, Val] = {}
        for member in block.section(SectionKind.CONSTANT):
            value = self._constant(member, known)
            known[member.name.upper()] = value
            self._add(Symbol(member.name, SectionKind.CONSTANT, constant=value))

    def _constant(self, member: Member, known: dict[str, Val]) -> Val:
        if member.start is None and isinstance(member.type, StringType):
            return Val("''", member.type.name, "")
        if member.start is None and isinstance(member.type, Elementary) and member.type.name in _FIRST:
            return self._constant(replace(member, start=_FIRST[member.type.name]), known)
        text = member.start or "0"
        upper = text.strip().upper()
        if upper in known:
            return known[upper]
        if isinstance(member.type, Elementary | StringType):
            value = literal_value(text, member.type.name)
            if value is not None:
                untyped = self.untyped and not text[:1].isalpha() and isinstance(value, int)
                untyped = untyped and not isinstance(value, bool)
                return Val(repr(value), INT_CONST if untyped else member.type.name, value)
            if is_bits_of_real(text, member.type.name):  # infinite, or no number: what is finite has become one
                return Val(f"bits_real({integer(text)},{64 if member.type.name == 'LREAL' else 32})", member.type.name)
        node = parse_value(text)
        numbers = {name: value.const for name, value in known.items() if isinstance(value.const, int)}
        number = evaluate(node, numbers) if node is not None else None
        return Val(repr(number), INT_CONST, number) if number is not None else unknown()

    def _instance(self, shape: Shape) -> None:
        """Members of an instance: memory ``m`` from ``o`` on."""
        sections = {id(member): section.kind for section in self.block.sections for member in section.members}
        for field in shape.fields:
            section = sections.get(id(field.member), SectionKind.STATIC)
            place = MemoryPlace(field.shape, "m", field.offset, region="m", section=section)
            place.overlay = field.member.at is not None
            self._add(Symbol(field.member.name, section, place))
        # a structured IN_OUT is a pointer in memory, the data lies elsewhere
        for member in (*self.block.section(SectionKind.INPUT), *self.block.section(SectionKind.IN_OUT)):
            symbol = self.symbols[member.name.upper()]
            if symbol.place is not None and scalar_name(symbol.place.shape) == "VARIANT":
                self._by_variant(member, symbol)
        for member in self.block.section(SectionKind.IN_OUT):
            symbol = self.symbols[member.name.upper()]
            if symbol.place is not None and scalar_name(symbol.place.shape) == "POINTER" and not is_pointer(member):
                local = f"p{len(self.locals)}"
                self.locals.append((local, "reference"))
                symbol.type_name = local
                pointer = symbol.place
                symbol.place = MemoryPlace(
                    self.shape_of(member), f"{local}_m", 0, f"{local}_o", section=SectionKind.IN_OUT
                )
                self.copied.append((local, Symbol(member.name, SectionKind.IN_OUT, pointer)))
        self._views(SectionKind.IN_OUT)

    def _by_variant(self, member: Member, symbol: Symbol) -> None:
        local = f"p{len(self.locals)}"
        self.locals.append((local, "reference"))
        self.variants.append((local, member.name.upper()))
        symbol.type_name = local
        section = symbol.place.section if symbol.place is not None else None
        symbol.place = MemoryPlace(Shape(member.type, 0, 1, 0, 1), local=local, section=section)

    def _views(self, section: SectionKind) -> None:
        """AT views over parameters passed by reference."""
        for member in self.block.section(section):
            if member.at is None:
                continue
            target = self.symbols.get(_plain(member.at))
            if target is not None and target.place is not None and target.place.dyn:
                place = MemoryPlace(self.shape_of(member), target.place.mem, 0, target.place.dyn, section=section)
                self.symbols[member.name.upper()] = Symbol(member.name, section, place)

    def shape_of(self, member: Member) -> Shape:
        """Shape of one declared type."""
        if isinstance(member.type, ArrayType) and not member.type.bounds:
            element = self.shape_of(Member(member.name, member.type.element, span=member.span))
            return Shape(member.type, 0, 16, 0, 16, element=element)
        try:
            plain = Member(member.name, member.type, span=member.span)
            return layout_members([plain], self.types).shape.fields[0].shape
        except DiagnosticError as problem:
            self.problems.append(problem)
            return bare_shape("WORD")

    def _parameters(self) -> None:
        """Parameters of an FC or OB: scalars are Python arguments, the rest comes by reference."""
        for kind, member, how in function_parameters(self.block):
            local = f"a{len(self.locals)}"
            name = self.block.name if kind is SectionKind.RETURN else member.name
            self.locals.append((local, _name(member.type) if how == "value" else how))
            if how == "value" and has_parts(member.type):
                place = MemoryPlace(self.shape_of(member), f"{local}_m", section=kind)
            elif how == "value":
                place = MemoryPlace(bare_shape(_name(member.type)), local=local, section=kind)
            elif how == "pointer":
                place = MemoryPlace(Shape(member.type, 0, 1, 0, 1), local=local, section=kind)
            else:
                place = MemoryPlace(self.shape_of(member), f"{local}_m", 0, f"{local}_o", section=kind)
            symbol = Symbol(name, kind, place, type_name=local)
            self._add(symbol)
            if kind is SectionKind.RETURN:
                self.symbols.setdefault("RET_VAL", symbol)
        for kind in _PARAMETERS:
            self._views(kind)

    def _temps(self) -> None:
        """Local data: Python locals, or memory where something needs the bytes, as the start information of an OB."""
        temps = list(self.block.section(SectionKind.TEMP))
        if self.block.kind is not BlockKind.FB:
            temps += self.block.section(SectionKind.STATIC)
        viewed = _viewed(temps)
        in_memory = []
        informed = self.classic and self.block.kind is BlockKind.OB
        for member in temps:
            if is_pointer(member) and isinstance(member.type, NamedType):
                local = f"v{len(self.locals)}"
                self.locals.append((local, "VARIANT"))
                place = MemoryPlace(Shape(member.type, 0, 1, 0, 1), local=local, section=SectionKind.TEMP)
                self._add(Symbol(member.name, SectionKind.TEMP, place))
                continue
            plain = is_scalar(member.type) and not has_parts(member.type)
            if plain and not informed and member.at is None and member.name.upper() not in viewed:
                local = f"v{len(self.locals)}"
                self.locals.append((local, _name(member.type)))
                place = MemoryPlace(bare_shape(_name(member.type)), local=local, section=SectionKind.TEMP)
                self._add(Symbol(member.name, SectionKind.TEMP, place))
            else:
                in_memory.append(member)
        if in_memory:
            self._in_memory(in_memory)

    def _in_memory(self, members: Iterable[Member]) -> None:
        views: list[Member] = []
        own: list[Member] = []
        for member in members:
            target = self.symbols.get(_plain(member.at or ""))
            (views if target is not None and target.place is not None else own).append(member)
        try:
            self.temp_shape = layout_members(own, self.types).shape
        except DiagnosticError as problem:
            self.problems.append(problem)
            return
        for field in self.temp_shape.fields:
            place = MemoryPlace(field.shape, "t", field.offset, region="t", section=SectionKind.TEMP)
            place.overlay = field.member.at is not None
            self._add(Symbol(field.member.name, SectionKind.TEMP, place))
        for member in views:
            target = self.symbols[_plain(member.at or "")]
            if target.place is not None and not target.place.local:
                source = target.place
                place = MemoryPlace(self.shape_of(member), source.mem, source.off, source.dyn, region=source.region)
                place.overlay = True
                place.section = SectionKind.TEMP
                self._add(Symbol(member.name, SectionKind.TEMP, place))


def is_pointer(member: Member) -> bool:
    """Whether a parameter is ANY, POINTER or VARIANT."""
    type_ = member.type
    return isinstance(type_, Elementary | NamedType) and type_.name.upper() in POINTERS


def function_parameters(block: Block) -> list[tuple[SectionKind, Member, str]]:
    """Parameters of an FC in the order of its Python arguments, and how each is passed."""
    rows: list[tuple[SectionKind, Member, str]] = []
    for kind in _PARAMETERS:
        members = block.section(kind)
        viewed = _viewed(members)
        for member in members:
            if member.at is None:
                scalar = is_scalar(member.type) and member.name.upper() not in viewed
                rows.append((kind, member, "value" if scalar else "pointer" if is_pointer(member) else "reference"))
    return rows


def _viewed(members: Iterable[Member]) -> set[str]:
    """Upper-case names of what has views: it lies in memory, whatever its type."""
    return {_plain(member.at) for member in members if member.at is not None}


def _plain(name: str) -> str:
    return name.strip('"#').upper()


def _name(type_: DataType) -> str:
    return type_.name if isinstance(type_, Elementary) else ""
