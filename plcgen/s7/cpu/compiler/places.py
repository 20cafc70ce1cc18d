"""Names, members, indices, slices and absolute addresses to places in memory."""

from __future__ import annotations

import re
from dataclasses import dataclass

from plcgen.base.diagnostics.suggest import did_you_mean
from plcgen.s7.cpu.compiler.access import Access
from plcgen.s7.cpu.compiler.context import Context, Listing
from plcgen.s7.cpu.compiler.conversions import integer_code
from plcgen.s7.cpu.compiler.literals import literal_value
from plcgen.s7.cpu.compiler.scope import (
    UNKNOWN,
    Expressions,
    MemoryPlace,
    Symbol,
    Val,
    scalar_name,
    unknown,
    whole_constant,
)
from plcgen.s7.cpu.linkage import ProgramBlock
from plcgen.s7.cpu.system.interfaces import system_fbs
from plcgen.s7.cpu.type_rules import BITS, INT_CONST, INTEGERS, NUMBERED, POINTERS, REALS, WIDTHS, canonical
from plcgen.s7.layout.shapes import Shape, bare_shape
from plcgen.s7.scl import ast
from plcgen.s7.scl.declarations import keys_of
from plcgen.s7.scl.instructions import is_type_name
from plcgen.s7.types.address import Address, AddressError, parse_address
from plcgen.s7.types.blocks import BlockKind, SectionKind
from plcgen.s7.types.data_types import ELEMENTARY, ArrayType, Member, NamedType, StringType

_AREA_WIDTHS = {"X": "BOOL", "B": "BYTE", "W": "WORD", "D": "DWORD"}
_OPENED = re.compile(r"(?:DB|D)([XBWD])([0-9]{1,5})?(?:\.([0-7]))?", re.IGNORECASE)
_LAST = 65535


@dataclass(slots=True, eq=False)
class OpenedBlocks:
    """Absolute access to a data block whose number is known when the code runs.

    Sources: S7-SCL V5.3 manual, "Indexed access to data blocks"; help of the TIA Portal, "Indirect addressing of data
    blocks" (S7-300/400).
    """

    context: Context
    expressions: Expressions

    def is_number(self, node: ast.Expression) -> bool:
        """Whether an expression is the number of a data block: a parameter or variable, or WORD_TO_BLOCK_DB."""
        if isinstance(node, ast.Call):
            target = node.target
            return isinstance(target, ast.Name) and target.name.upper() == "WORD_TO_BLOCK_DB"
        if not isinstance(node, ast.Name) or node.scope == "quoted":
            return False
        symbol = self.context.scope.symbols.get(node.name.upper())
        return symbol is not None and symbol.place is not None and scalar_name(symbol.place.shape) in NUMBERED

    def place(self, node: ast.Expression) -> MemoryPlace | None:
        """Place of such an access; None if the expression is none."""
        target: ast.Expression = node
        indices: tuple[ast.Expression, ...] = ()
        bit = ""
        if isinstance(node, ast.Index):
            target, indices = node.base, node.indices
        elif isinstance(node, ast.Call):
            target, indices = node.target, tuple(argument.value for argument in node.arguments)
        elif isinstance(node, ast.Member) and isinstance(node.base, ast.Member) and node.name.isdecimal():
            target, bit = node.base, f".{node.name}"
        if not isinstance(target, ast.Member) or not self.is_number(target.base):
            return None
        match = _OPENED.fullmatch(target.name + bit)
        if match is None or (match[2] is None) != bool(indices):
            return None
        return self.at(target.base, match, indices)

    def at(self, base: ast.Expression, match: re.Match[str], indices: tuple[ast.Expression, ...]) -> MemoryPlace:
        """Place in the block that ``base`` numbers, at fixed or computed addresses."""
        shape = bare_shape(_AREA_WIDTHS[match[1].upper()])
        memory = f"opened({self.expressions.value(base).wrapped})"
        if match[2] is not None:
            return MemoryPlace(shape, memory, int(match[2]) * 8 + int(match[3] or 0))
        codes = [self.address(index) for index in indices]
        if match[1] not in "Xx":
            return MemoryPlace(shape, memory, 0, f"ck({codes[0]},{_LAST})")
        bit = codes[1] if len(codes) > 1 else "0"
        return MemoryPlace(shape, memory, 0, dynbit=f"ck({codes[0]},{_LAST})*8+ck({bit},7)")

    def address(self, node: ast.Expression) -> str:
        """Code of a computed address."""
        value = self.expressions.value(node)
        if value.type not in INTEGERS and value.type not in {INT_CONST, UNKNOWN, *BITS}:
            self.context.error("PG821", "an address index is an integer", node)
        return integer_code(value)


_TYPES = frozenset({BlockKind.UDT, BlockKind.FB})
_SHORT = re.compile(r"(%?DB\d+\.)D([XBWD])?(?=\d)", re.IGNORECASE)
_INDEXED = re.compile(r"(?:DB|D)([XBWD])", re.IGNORECASE)
_PLAIN_INDEXED = re.compile(r"(P?[IEQAM])([XBWD]?)", re.IGNORECASE)
_START = frozenset(
    """INITIAL_CALL REMANENCE EVENT_COUNT LADDR USI ICHANNEL EVENTTYPE CAUGHTUP SECONDTIME SIGN FAULT_ID CSG_OBNR
    CSG_PRIO IO_STATE CHANNEL MULTIERROR EVENT_CLASS LOSTRETENTIVE LOSTRTC SLOT SPECIFIER PIP_INPUT PIP_OUTPUT
    SYNCCYCLETIME BLOCKNR REACTION BLOCKTYPE AREA DBNR WIDTH""".split()
)
"""Inputs of the organization blocks of the S7-1200/1500: sources do not declare them (help of RD_SINFO)."""
AREAS = {"I": "I", "E": "I", "Q": "Q", "A": "Q", "M": "M", "PI": "P", "PE": "P", "PQ": "P", "PA": "P"}


@dataclass(slots=True, eq=False)
class Places:
    """Everything that can stand left of an assignment."""

    context: Context
    out: Listing
    access: Access
    expressions: Expressions
    opened: OpenedBlocks

    def place(self, node: ast.Expression) -> MemoryPlace | None:
        """Place of a variable; a problem is reported and gives None."""
        if isinstance(node, ast.Member | ast.Index | ast.Call):
            opened = self.opened.place(node)
            if opened is not None:
                return opened
        if isinstance(node, ast.Name):
            return self.named(node)
        if isinstance(node, ast.Member):
            return self.member(node)
        if isinstance(node, ast.Index):
            return self.indexed(node)
        if isinstance(node, ast.Address):
            return self.absolute(node)
        if isinstance(node, ast.Peripheral):
            return self.place(node.base)
        if isinstance(node, ast.Call) and isinstance(node.target, ast.Address | ast.Name | ast.Member):
            # ``%DB100.DW(5)``, ``%DB1.DW(IDX := #i)``, ``%IB(#i)``.
            text = self.context.text(node.target).upper().lstrip("%")
            head, _, tail = text.partition(".")
            plain = _PLAIN_INDEXED.fullmatch(text)
            if plain is not None and node.arguments:
                indices = tuple(argument.value for argument in node.arguments)
                return self.computed(AREAS[plain[1].upper()], (plain[2] or "X").upper(), indices, 65536)
            match = _INDEXED.fullmatch(tail)
            block = self.context.link.find(head.strip('"'))
            if match is None or block is None or block.shape is None or not node.arguments:
                self.context.error("PG823", f"{self.context.text(node)} is not a variable", node)
                return None
            indices = tuple(argument.value for argument in node.arguments)
            return self.computed(f"d{block.index}", match[1].upper(), indices, block.shape.bits // 8)
        if isinstance(node, ast.Dereference):
            self.context.error("PG827", "the soft CPU does not follow REF_TO references", node)
            return None
        self.context.error("PG823", f"{self.context.text(node)} is not a variable", node)
        return None

    def symbol(self, node: ast.Name) -> Symbol | None:
        """Local symbol of a name, if it has one."""
        if node.scope == "quoted":
            name = node.name
            # A system constant or a user constant of a tag table
            number = self.context.link.constants.get(name.upper())
            if number is not None:
                return Symbol(name, SectionKind.CONSTANT, constant=whole_constant(number))
            type_, literal = self.context.link.user_constants.get(name.upper(), ("", ""))
            value = literal_value(literal, type_.upper())
            if type_ and value is None:
                return Symbol(name, SectionKind.CONSTANT, constant=unknown())
            if isinstance(value, int) and not isinstance(value, bool) and type_.upper() in {*INTEGERS, *BITS}:
                return Symbol(name, SectionKind.CONSTANT, constant=whole_constant(value))
            return (
                Symbol(name, SectionKind.CONSTANT, constant=Val(repr(value), canonical(type_), value))
                if type_
                else None
            )
        return self.context.scope.symbols.get(node.name.upper())

    def undeclared(self, node: ast.Name) -> bool:
        """Whether a name without ``#`` and quotes is none of the block: then it may be a word of the language."""
        return node.scope == "bare" and node.name.upper() not in self.context.scope.symbols

    def named(self, node: ast.Name) -> MemoryPlace | None:
        """Place of a local variable, tag or data block."""
        symbol = self.symbol(node)
        if symbol is not None:
            if symbol.place is None:
                self.context.error("PG823", f"{node.name} is a constant", node)
            return symbol.place
        if node.scope != "local":
            upper = node.name.upper()
            tag = self.context.link.tags.get(upper)
            if tag is not None:
                return self.tag(*tag, node)
            block = self.context.link.find(upper)
            if block is not None and block.block.kind is BlockKind.DB and block.shape is not None:
                return self.data_block(block)
            if block is not None and block.block.kind is BlockKind.DB:
                return None  # its declarations are wrong, and that has been reported
            if block is self.context.owner and upper in self.context.scope.symbols:
                return self.context.scope.symbols[upper].place
            if block is not None and not (block.block.kind in _TYPES and not self.context.classic):
                self.context.error("PG820", f"{node.name} is {block.block.kind.value}, not data", node)
                return None
        self.undefined(node)
        return None

    def type_named(self, node: ast.Name) -> str:
        """Name of the type that a name without declaration means, in upper case: ``TypeOf(#v) = Int``."""
        upper = node.name.upper()
        if (
            self.context.classic
            or node.scope == "local"
            or self.symbol(node) is not None
            or upper in self.context.link.tags
        ):
            return ""
        block = self.context.link.find(upper)
        if block is not None:
            return block.name.upper() if block.block.kind in _TYPES else ""
        return canonical(upper) if node.scope == "bare" and is_type_name(upper) else ""

    def pointer_type(self, value: Val) -> str:
        """ANY, POINTER or VARIANT if the value is a variable of such a type, otherwise an empty text."""
        if value.type in POINTERS:
            return value.type
        type_ = scalar_name(value.place.shape) if value.place is not None else ""
        return type_ if type_ in POINTERS else ""

    def undefined(self, node: ast.Name) -> None:
        """PG820 with the nearest known name."""
        is_ob = self.context.owner.block.kind is BlockKind.OB and not self.context.classic
        if is_ob and node.scope != "quoted" and node.name.upper() in _START:
            self.context.error("PG827", f"the soft CPU has no start information {node.name}", node)
            return
        near = did_you_mean(node.name, [s.name for s in self.context.scope.symbols.values()])
        if node.scope == "quoted":
            known = [block.name for block in self.context.link.blocks.values()]
            near = did_you_mean(node.name, [*known, *self.context.link.tags])
        keys = keys_of(node, self.context.owner.name)
        self.context.unknown("PG820", f"{node.name} is not defined", keys, node, near)

    def data_block(self, block: ProgramBlock) -> MemoryPlace:
        """Whole memory of a data block."""
        shape = block.shape
        assert shape is not None  # the caller looked
        region = f"d{block.index}"
        if region in self.context.link.instance_regions:
            self.access.aliased = True
        return MemoryPlace(shape, region, 0, region=region)

    def member(self, node: ast.Member) -> MemoryPlace | None:
        """``base.name``; a base that is ``DB3`` and a name ``DBW6`` cannot meet here, the lexer joins them."""
        if isinstance(node.base, ast.Name) and self.symbol(node.base) is None:
            block = self.context.link.find(node.base.name)
            if block is not None and block.block.kind is BlockKind.FB:
                return self.named(ast.Name(node.start, node.end, node.name, "quoted"))
        base = self.place(node.base)
        if base is None:
            return None
        if node.name.upper() in {"Q", "ET"}:
            # bring the data of an IEC timer of an S7-1200/1500 up to date before a member of it is looked at
            members = base.shape.index
            if "RU" in members and "RESERVED" in members:  # no other structure has them
                self.out.emit(f"query{members['ET'].shape.bits}({base.mem},{self.access.address(base)})")
                self.access.touched(base.region if base.fixed else None, base.off, base.shape.bits)
        return self.field(base, node.name, node)

    def field(self, base: MemoryPlace, name: str, node: ast.Expression) -> MemoryPlace | None:
        """Return a member of a structure."""
        if self.context.is_opaque(base.shape):
            return None
        found = base.shape.index.get(name.upper())
        if found is None:
            self.no_member(base, name, node)
            return None
        place = base.inside(
            found.offset, found.shape, overlay=base.overlay or found.member.at is not None or not base.shape.fields
        )
        place.member = found.member
        if isinstance(base.shape.type, NamedType) or base.mem.startswith("d"):
            self.watch_status(base, name, node)
        return place

    def no_member(self, base: MemoryPlace, name: str, node: ast.Expression) -> None:
        """PG820 about a member that is not there; of a named type once."""
        near = did_you_mean(name, [f.member.name for f in base.shape.fields])
        message = f"there is no member {name}"
        type_ = base.shape.type
        if isinstance(type_, NamedType):
            self.context.unknown("PG820", f"{message} in {type_.name}", (f"{type_.name}.{name}",), node, near)
        else:
            self.context.error("PG820", message, node, near)

    def indexed(self, node: ast.Index) -> MemoryPlace | None:
        """``base[i, j]`` with a check of every index."""
        special = self.indexed_area(node)
        if special is not None:
            return special
        place = self.place(node.base)
        if place is None:
            return None
        position = 0
        while position < len(node.indices):
            if isinstance(place.shape.type, StringType) and not place.local:
                place = characters(place)
            shape = place.shape
            if self.context.is_opaque(shape):
                for index in node.indices[position:]:
                    self.expressions.value(index)
                return None
            if isinstance(shape.type, ArrayType) and not shape.type.bounds and shape.element is not None:
                return self.open_element(place, shape.element, node.indices[position:])
            if not isinstance(shape.type, ArrayType) or shape.element is None or place.local:
                self.context.error("PG821", f"{self.context.text(node.base)} is not an array", node)
                return None
            bounds = shape.type.bounds
            indices = node.indices[position : position + len(bounds)]
            if len(indices) < len(bounds):
                shape = _rows(shape, len(indices))
            place = self.element(place, shape, indices)
            position += len(bounds)
        return place

    def element(self, base: MemoryPlace, shape: Shape, indices: tuple[ast.Expression, ...]) -> MemoryPlace:
        """One element of an array."""
        assert isinstance(shape.type, ArrayType)  # the caller looked
        assert shape.element is not None
        offset, codes = 0, []
        for index, (low, high), stride in zip(indices, shape.type.bounds, shape.strides, strict=True):
            value = self.expressions.value(index)
            if isinstance(value.const, int) and not isinstance(value.const, bool):
                guessed = low == high and self.context.link.guessed_bounds
                if not low <= value.const <= high and not guessed:
                    self.context.error("PG824", f"index {value.const} is outside {low}..{high}", index)
                offset += (value.const - low) * stride
                continue
            free = value.type in BITS and not self.context.rules.checked and self.context.rules.dialect.is_tia
            if value.type not in INTEGERS and value.type != UNKNOWN and not free:
                self.context.error("PG821", f"an index is an integer, not {value.type or 'a structure'}", index)
            name = self.out.temporary()
            code = integer_code(value)
            self.out.checks += 1
            checked = f"({name} if {low}<=({name}:={code})<={high} else ix({name},{low},{high}))"
            codes.append((checked, stride))
            offset -= low * stride
        place = base.inside(offset, shape.element, overlay=base.overlay)
        if not codes:
            return place
        if shape.element.bits == 1:
            terms = "+".join(code if stride == 1 else f"{code}*{stride}" for code, stride in codes)
            place.dynbit = f"{base.dynbit}+{terms}" if base.dynbit else terms
        else:
            terms = "+".join(code if stride == 8 else f"{code}*{stride // 8}" for code, stride in codes)
            if place.off < 0:
                terms = f"{terms}-{-place.off // 8}"
                place.off = 0
            place.dyn = f"{base.dyn}+{terms}" if base.dyn else terms
        return place

    def open_element(self, base: MemoryPlace, shape: Shape, indices: tuple[ast.Expression, ...]) -> MemoryPlace:
        """One element of an ``ARRAY[*]``: what was handed over says where it lies."""
        place = base.inside(0, shape, overlay=True)
        codes = [integer_code(self.expressions.value(index)) for index in indices]
        self.out.checks += 1
        offset = f"element_at({base.mem.removesuffix('_m')}_r,{','.join(codes)})"
        if shape.bits == 1:
            place.dynbit = offset
        else:
            place.dyn = f"{base.dyn}+{offset}//8" if base.dyn else f"{offset}//8"
        return place

    def slice_type(self, node: ast.Slice, value: Val) -> tuple[int, str] | None:
        """Width and type of a slice; PG824 if it lies outside."""
        if value.type == UNKNOWN:
            return None
        bits, type_ = {"X": (1, "BOOL"), "B": (8, "BYTE"), "W": (16, "WORD"), "D": (32, "DWORD")}[node.width]
        whole = WIDTHS.get(value.type, 0)
        if (node.index + 1) * bits > whole or value.type in REALS:
            self.context.error("PG824", f".%{node.width}{node.index} is outside {value.type or 'a structure'}", node)
            return None
        return bits, type_

    def absolute(self, node: ast.Address) -> MemoryPlace | None:
        """``%DB3.DBW6``, ``M50.0``."""
        text = _SHORT.sub(lambda match: f"{match[1]}DB{match[2] or 'X'}", node.text)
        try:
            address = parse_address(text)
        except AddressError as problem:
            self.context.error("PG827", str(problem), node)
            return None
        return self.at_address(address, address.type_name or "BYTE", node)

    def tag(self, address: Address, type_: str, node: ast.Expression) -> MemoryPlace | None:
        """Place of a tag; one of a user type has the members of that."""
        place = self.at_address(address, type_, node)
        known = self.context.link.types.get(type_.strip('"'))
        if place is None or known is None or canonical(type_) in ELEMENTARY:
            return place
        member = Member(known.name, NamedType(known.name, quoted=True))
        return place.inside(0, self.context.scope.shape_of(member), overlay=True)

    def at_address(self, address: Address, type_: str, node: ast.Expression) -> MemoryPlace | None:
        """Place of an address with a type."""
        name = canonical(type_)
        shape = bare_shape(name if name in ELEMENTARY else "WORD")
        if address.area == "DB":
            block = self.context.link.data_block(address.db or 0)
            if block is None or block.shape is None:
                text = "give the number of the data block"
                self.context.unknown("PG825", f"there is no DB{address.db}", (f"DB{address.db}",), node, text)
                return None
            base = self.data_block(block)
            if address.offset + address.width_bits > block.shape.bits:
                self.context.error("PG824", f"DB{address.db} has {block.shape.bits // 8} bytes only", node)
            return base.inside(address.offset, shape, overlay=True)
        area = AREAS[address.area]
        region = None if area == "P" else area
        return MemoryPlace(shape, area, address.offset, region=region, overlay=True)

    def indexed_area(self, node: ast.Index) -> MemoryPlace | None:
        """``DB100.DW[i]``, ``MW[i]``: an index that counts bytes, for bits bytes and bits."""
        base = node.base
        if isinstance(base, ast.Member) and isinstance(base.base, ast.Name):
            match = _INDEXED.fullmatch(base.name)
            block = self.context.link.find(base.base.name) if match and base.base.scope != "local" else None
            if match and block is not None and block.block.kind is BlockKind.DB and block.shape is not None:
                return self.computed(f"d{block.index}", match[1].upper(), node.indices, block.shape.bits // 8)
        if isinstance(base, ast.Name) and self.symbol(base) is None and base.scope == "bare":
            match = _PLAIN_INDEXED.fullmatch(base.name)
            if match:
                area = AREAS[match[1].upper()]
                return self.computed(area, (match[2] or "X").upper(), node.indices, 65536)
        return None

    def computed(self, mem: str, letter: str, indices: tuple[ast.Expression, ...], limit: int) -> MemoryPlace:
        """Absolute access with a computed address."""
        codes = [self.opened.address(index) for index in indices]
        shape = bare_shape(_AREA_WIDTHS[letter])
        last = limit - max(1, shape.bits // 8)
        if letter == "X":
            bit = codes[1] if len(codes) > 1 else "0"
            return MemoryPlace(shape, mem, 0, dynbit=f"ck({codes[0]},{last})*8+ck({bit},7)")
        return MemoryPlace(shape, mem, 0, f"ck({codes[0]},{last})")

    def watch_status(self, base: MemoryPlace, name: str, node: ast.Expression) -> None:
        """Note reads of STATUS of a record block: it counts in the scan of its call only."""
        if name.upper() != "STATUS" or not isinstance(node, ast.Member):
            return
        type_ = base.shape.type.name if isinstance(base.shape.type, NamedType) else ""
        if isinstance(node.base, ast.Name) and base.mem.startswith("d"):
            found = self.context.link.find(node.base.name)
            type_ = self.context.link.instance_type(found) if found is not None else type_
        system = system_fbs(classic=self.context.classic).get(type_.upper())
        if system is not None and system.watched and self.context.link.find(type_) is None:
            self.out.emit(f"st({base.mem},{self.access.address(base)})")


def _rows(array: Shape, count: int) -> Shape:
    """Return an array of several dimensions as one of ``count`` dimensions whose elements are arrays."""
    assert isinstance(array.type, ArrayType)  # the caller looked
    bounds, bits = array.type.bounds, array.strides[count - 1]
    type_ = ArrayType(bounds[count:], array.type.element)
    row = Shape(type_, bits, 16, bits, 16, element=array.element, strides=array.strides[count:])
    outer = ArrayType(bounds[:count], type_)
    return Shape(outer, array.bits, 16, array.bits, 16, element=row, strides=array.strides[:count])


def characters(text: MemoryPlace) -> MemoryPlace:
    """Return the characters of a STRING or WSTRING as an array: ``s[1]`` is the first one."""
    type_ = text.shape.type
    assert isinstance(type_, StringType)  # the caller looked
    wide = type_.name == "WSTRING"
    element = bare_shape("WCHAR" if wide else "CHAR")
    array = ArrayType(((1, type_.length),), element.type)
    bits = element.bits * type_.length
    shape = Shape(array, bits, 16, bits, 16, element=element, strides=(element.bits,))
    header = 32 if wide else 16
    return text.inside(header, shape, overlay=True)
