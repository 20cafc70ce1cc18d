"""Layout tables of blocks read from sources: members, gaps, folded arrays, and the rules each place rests on.

Without the members of types of libraries no place behind them is known. A block with optimized access has no places, so
it can be shown all the same.
"""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Note, Severity, Span
from plcgen.s7.layout.evidence import NO_DOUBTS, rule
from plcgen.s7.layout.image import StartValueError, image
from plcgen.s7.layout.layout import layout_block, locate, split_path
from plcgen.s7.layout.shapes import NO_MEMORY, union
from plcgen.s7.tables.tables import GAP, MORE, BlockTable, LayoutRow, member_address, size_text
from plcgen.s7.types.blocks import Block, BlockKind, is_numbered
from plcgen.s7.types.data_types import ArrayType, Elementary, NamedType, elementary, innermost, nested
from plcgen.s7.types.literals import type_text
from plcgen.s7.types.system import system_block

if TYPE_CHECKING:
    from plcgen.s7.layout.layout import Layout
    from plcgen.s7.layout.shapes import Shape
    from plcgen.s7.types.data_types import Member

_MARK = "InstructionName"


def with_library_types(block: Block, types: Mapping[str, Block]) -> tuple[dict[str, Block], list[Diagnostic]]:
    """All types, those of libraries that nobody declares without members, and a warning (PG806) for each of these."""
    known, warnings = dict(types), []
    owner = known.get((block.instance_of or "").upper())
    pending, seen = [block] if owner is None else [block, owner], {block.name.upper()}
    while pending:
        for type_, span, library in _used(pending.pop()):
            key = type_.name.upper()
            if key in seen:
                continue
            declared = known.get(key)
            if declared is not None:
                seen.add(key)
                pending.append(declared)
            elif (
                library
                and elementary(type_.name) is None
                and type_.name.upper() not in NO_MEMORY
                and system_block(type_.name) is None
            ):
                seen.add(key)
                known[key] = Block(BlockKind.UDT, type_.name, ())
                warnings.append(_warning(type_.name, span or block.span or Span(block.name)))
    return known, warnings


def _warning(name: str, place: Span) -> Diagnostic:
    message = f"the members of {name} are not known to plcgen: shown without them"
    return Diagnostic("PG806", message, place, Severity.WARNING, help="its instance DB or online view shows them")


def _used(block: Block) -> Iterator[tuple[NamedType, Span | None, bool]]:
    """Named types of all members, in their order, and whether a library of the TIA Portal has them."""
    for member in nested(block.members):
        type_ = innermost(member.type)
        if isinstance(type_, NamedType):
            yield type_, member.span, any(name == _MARK for name, _ in member.attributes)


MAX_ROWS = 200_000
"""Rows of all blocks together; after that structures and arrays are one row."""

_MAX_NOTES = 8
_MAX_SINGLE = 4
_NAME = re.compile(r'#?[^\W\d]\w*|"[^"]+"')
_WITH_MEMORY = frozenset({BlockKind.DB, BlockKind.UDT, BlockKind.FB})


def block_tables(
    blocks: Sequence[Block], types: Mapping[str, Block], *, expand: bool = False
) -> tuple[list[BlockTable], list[Diagnostic]]:
    """Lay out every DB, UDT and FB; blocks without memory of their own are left out.

    Arrays are one row, or their first element and a fold; ``expand`` shows every element.
    """
    tables: list[BlockTable] = []
    found: list[Diagnostic] = []
    room = MAX_ROWS
    for source in blocks:
        if source.kind in _WITH_MEMORY:
            owner = types.get((source.instance_of or "").upper())
            optimized = source.optimized is None and owner is not None and owner.optimized
            block = replace(source, optimized=True) if optimized else source
            try:
                known, warnings = with_library_types(block, types) if block.optimized else (types, [])
                block = _with_places(block, known) if warnings else block
                memory = _memory(block, known, found)
                tables.append(_declared(block, known, room, memory, expand=expand))
                found += warnings
                room -= len(tables[-1].rows)
            except DiagnosticError as problem:
                found += problem.diagnostics
    diagnostics = dict.fromkeys(found)
    # put the uses of one unknown type together: the first is the diagnostic, the others its notes
    groups: dict[tuple[str, str], list[Diagnostic]] = {}
    for diagnostic in diagnostics:
        place = "" if diagnostic.code == "PG806" else str(diagnostic.span)
        groups.setdefault((diagnostic.code, (diagnostic.message + place).upper()), []).append(diagnostic)
    return tables, [_with_uses(group) for group in groups.values()]


def _with_places(block: Block, types: Mapping[str, Block]) -> Block:
    """Without the values inside of library types: nobody knows the members of these."""
    layout = layout_block(block, types)
    return replace(block, assignments=tuple(a for a in block.assignments if _is_place(layout, a.path)))


def _is_place(layout: Layout, path: str) -> bool:
    try:
        locate(layout, path)
    except KeyError:
        return False
    return True


def _with_uses(group: list[Diagnostic]) -> Diagnostic:
    first, *others = group
    if not others:
        return first
    left = len(others) - _MAX_NOTES
    notes = [Note("used here too", other.span) for other in others[:_MAX_NOTES]]
    if left > 0:
        notes.append(Note(f"and in {left} more places, the last one here", others[-1].span))
    return replace(first, notes=(*first.notes, *notes))


def _memory(block: Block, types: Mapping[str, Block], found: list[Diagnostic]) -> _Memory | None:
    """Contents of a block whose lines behind BEGIN say something, as far as they fit."""
    if not block.assignments:
        return None
    try:
        return _Memory(bytes(image(replace(block, assignments=()), types)), bytes(image(block, types)))
    except StartValueError as problem:
        if not _NAME.fullmatch(problem.text):  # a constant of the user is no mistake
            place = problem.span or block.span or Span(block.name)
            found.append(Diagnostic("PG809", str(problem), place, Severity.WARNING))
    return None


def _declared(
    block: Block, types: Mapping[str, Block], room: int, memory: _Memory | None, *, expand: bool
) -> BlockTable:
    layout = layout_block(block, types)
    begin = {_plain(assignment.path): assignment.literal for assignment in block.assignments}
    rows = _Rows(block, begin, room, memory, expand=expand)
    rows.fields(layout.shape, 0, 0, "", NO_DOUBTS)
    keys = sorted({key for row in rows.found for key in row.rules})
    offsets = not block.optimized
    owner = types.get((block.instance_of or "").upper())
    of_type = owner is not None and owner.kind is BlockKind.UDT
    return BlockTable(
        block.kind.value,
        block.name,
        block.number,
        layout.size if offsets else None,
        tuple(rows.found),
        role=f"instance of {block.instance_of}" if block.instance_of else "",
        unused=layout.shape.bits - used_bits(layout.shape) if offsets else 0,
        rules=tuple(rule(key) for key in keys) if offsets else (),
        comment=block.title or block.comment,
        file=block.span.file if block.span else "",
        line=block.span.line if block.span else 0,
        unsaid=offsets and _is_unsaid(block, types),
        inner=block.kind is BlockKind.FB or (bool(block.instance_of) and not of_type),
        shape=layout.shape if offsets else None,
        begin=begin,
    )


def _is_unsaid(block: Block, types: Mapping[str, Block]) -> bool:
    """Whether a text of the TIA Portal says nothing of the block's access; an instance has that of its FB.

    Block numbers stand in sources of STEP 7 V5 only, where every access is standard access.
    """
    owner = types.get((block.instance_of or "").upper())
    said = block.optimized is not None or (owner is not None and owner.optimized is not None)
    is_source = block.span is not None and block.span.file.lower().endswith((".db", ".scl"))
    return is_source and not said and not is_numbered(block) and block.kind is not BlockKind.UDT


def used_bits(shape: Shape) -> int:
    """Bits of a type that hold values: everything but gaps and padding; views over other members do not count."""
    if shape.element is not None and isinstance(shape.type, ArrayType):
        return math.prod(high - low + 1 for low, high in shape.type.bounds) * used_bits(shape.element)
    if shape.fields:
        return sum(used_bits(f.shape) for f in shape.fields if f.member.at is None)
    return shape.bits


def extent(shape: Shape) -> int:
    """Bits from the start of a member to the end of what it holds, without the padding of arrays behind that."""
    element = shape.element
    if element is None or not isinstance(shape.type, ArrayType):
        return shape.bits
    steps = zip(shape.type.bounds, shape.strides, strict=True)
    return sum((high - low) * stride for (low, high), stride in steps) + extent(element)


@dataclass(frozen=True, slots=True)
class _Memory:
    """Bytes of a block as declared, and with the lines behind BEGIN."""

    declared: bytes
    loaded: bytes

    def changed(self, start: int, bits: int) -> bool:
        """Whether BEGIN changes bytes of the ``bits`` at bit ``start``."""
        part = slice(start // 8, -(-(start + bits) // 8))
        return self.declared[part] != self.loaded[part]

    def alike(self, shape: Shape, base: int) -> bool:
        """Whether all elements of the array at bit ``base`` hold the same."""
        bits = shape.element.bits if shape.element is not None else 0
        found = (self.loaded[(base + at) // 8 : (base + at + bits) // 8] for _, at in shape.places())
        first = next(found, b"")
        return all(part == first for part in found)


@dataclass(slots=True)
class _Rows:
    """The rows of one block, in memory order."""

    block: Block
    begin: Mapping[str, str]
    room: int
    memory: _Memory | None
    expand: bool
    found: list[LayoutRow] = field(default_factory=list)
    sorted: dict[frozenset[str], tuple[str, ...]] = field(default_factory=dict)

    def fields(self, shape: Shape, base: int, depth: int, prefix: str, doubts: frozenset[str]) -> None:
        """Members of a structure at bit ``base``, with the gaps before, between and behind them."""
        end = base
        for child in shape.fields:
            start = base + child.offset
            if child.member.at is None:
                if start > end:
                    self.gap(end, start, depth)
                end = start + (extent(child.shape) if child.shape.element else child.shape.bits)
            member, inner = child.member, child.shape
            own = union(doubts, child.doubts) if child.doubts else doubts
            self.row(member.name, _type(member, inner), inner, start, depth, own, prefix + member.name, member)
            if inner.fields or inner.element is not None:
                self.inside(inner, start, depth + 1, prefix + member.name, own)
        self.gap(end, base + shape.bits, depth)

    def gap(self, start: int, end: int, depth: int) -> None:
        """Bits that nothing uses, if there are any."""
        if end > start and not self.block.optimized:
            bit = start % 8 or None
            name = "(unused)"
            self.found.append(LayoutRow(start // 8, bit, end - start, "", name, "", "", depth, kind=GAP))

    def inside(self, shape: Shape, start: int, depth: int, path: str, doubts: frozenset[str]) -> None:
        """Members of a structure, elements of an array, as long as there is room."""
        if len(self.found) >= self.room:
            return
        if shape.fields:
            self.fields(shape, start, depth, f"{path}.", doubts)
        elif shape.element is not None and (self.expand or is_composite(shape)):
            self.elements(shape, start, depth, path, doubts)

    def elements(self, shape: Shape, start: int, depth: int, path: str, doubts: frozenset[str]) -> None:
        """Elements of an array: all with ``expand``, else the first one."""
        element, end = shape.element, start
        if element is None or not isinstance(shape.type, ArrayType):
            return
        total = math.prod(high - low + 1 for low, high in shape.type.bounds)
        for done, (index, offset) in enumerate(shape.places()):
            place = start + offset
            if (done and not self.expand) or len(self.found) >= self.room:
                self.fold(shape, (offset, place), depth, (done, total), index, doubts)
                return
            self.gap(end, place, depth)
            own = union(doubts, shape.stride_doubts) if done else doubts
            name = f"[{index}]"
            self.row(name, type_text(element.type), element, place, depth, own, f"{path}{name}", None)
            self.inside(element, place, depth + 1, f"{path}{name}", own)
            end = place + extent(element)
        self.gap(end, start + extent(shape), depth)

    def fold(
        self,
        shape: Shape,
        at: tuple[int, int],
        depth: int,
        counts: tuple[int, int],
        index: str,
        doubts: frozenset[str],
    ) -> None:
        """One row for the elements that are not shown; ``at`` is the bit in the array and in the block.

        ``counts`` are the elements shown and all of them.
        """
        (offset, place), (done, total) = at, counts
        if not isinstance(shape.type, ArrayType):
            return
        last = ",".join(str(high) for _, high in shape.type.bounds)
        every = f", one every {size_text(shape.strides[-1])}" if len(shape.type.bounds) == 1 else ""
        name = f"[{index}]" if done + 1 == total else f"[{index}] to [{last}]"
        text = f"the same{every}" if done + 1 < total else "the same"
        if not self.expand and self.memory is not None and not self.memory.alike(shape, place - offset):
            text += ", other start values"
        byte, bits = (None, 0) if self.block.optimized else (place // 8, extent(shape) - offset)
        rules = self.rules(union(doubts, shape.stride_doubts))
        self.found.append(LayoutRow(byte, None, bits, "", name, text, "", depth, kind=MORE, rules=rules))

    def row(
        self,
        name: str,
        type_: str,
        shape: Shape,
        place: int,
        depth: int,
        doubts: frozenset[str],
        path: str,
        member: Member | None,
    ) -> None:
        """One member or element."""
        start = (member.start if member else "") or ""
        if self.begin:
            start = self.begin.get(path.lower(), start)
            if self.memory is not None and shape.element is not None and not is_composite(shape):
                start = self.singly(shape, place, path, start)
        comment = member.comment if member else ""
        if self.block.optimized:
            self.found.append(LayoutRow(None, None, 0, "", name, type_, start, depth, comment))
            return
        byte, bit = divmod(place, 8)
        plain = isinstance(shape.type, Elementary)
        shown = bit if plain and shape.bits == 1 else None
        address = ""
        if self.block.kind is BlockKind.DB:
            address = member_address(self.block.number, byte, shown, shape.bits if plain else 8)
        rules = self.rules(union(doubts, shape.doubts) if shape.doubts else doubts)
        bits = shape.bits if plain else extent(shape)
        self.found.append(LayoutRow(byte, shown, bits, address, name, type_, start, depth, comment, rules=rules))

    def singly(self, shape: Shape, place: int, path: str, start: str) -> str:
        """Start value of an array in one row, with those of single elements if they change anything."""
        if self.expand or self.memory is None or not self.memory.changed(place, extent(shape)):
            return start
        names = (index for index, _ in shape.places())
        given = (f"[{n}] := {self.begin[key]}" for n in names if (key := f"{path.lower()}[{n}]") in self.begin)
        listed = list(itertools.islice(given, _MAX_SINGLE))
        if len(listed) == _MAX_SINGLE:
            listed[-1] = ".."
        return ", ".join([start, *listed] if start else listed)

    def rules(self, doubts: frozenset[str]) -> tuple[str, ...]:
        """Keys in a fixed order; rows that rest on the same rules share them."""
        known = self.sorted.get(doubts)
        if known is None:
            known = self.sorted[doubts] = tuple(sorted(doubts))
        return known


def _plain(path: str) -> str:
    """A path of the BEGIN part as the rows spell it: no quotes, no spaces, lower case."""
    try:
        steps = split_path(path)
    except KeyError:
        return path.lower()
    parts = (f".{step}" if isinstance(step, str) else f"[{','.join(map(str, step))}]" for step in steps)
    return "".join(parts).lstrip(".").lower()


def is_composite(shape: Shape) -> bool:
    """Whether one row does not tell what an array holds: structures, arrays, elements with a gap behind them."""
    element = shape.element
    if element is None:
        return False
    return (
        bool(element.fields) or element.element is not None or (element.bits > 1 and shape.strides[-1] != element.bits)
    )


def _type(member: Member, shape: Shape) -> str:
    """Type as declared; what lies in memory if that is only a pointer to it; the target of a view."""
    if member.type is shape.type and isinstance(shape.type, Elementary) and member.at is None:
        return shape.type.name
    declared = type_text(member.type)
    if member.type != shape.type and isinstance(shape.type, Elementary) and shape.type.name == "POINTER":
        return f"POINTER to {declared}"
    return f"{declared} AT {member.at}" if member.at is not None else declared
