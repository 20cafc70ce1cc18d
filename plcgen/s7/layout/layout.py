"""Standard-access (non-optimised) memory layout of blocks: where every member lies, to the bit.

Rules and their evidence: STEP 7 V5 compiled blocks and the S7 manuals; see ``shapes``.
"""

from __future__ import annotations

import itertools
import re
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

from plcgen.base.diagnostics import DiagnosticError, Span
from plcgen.base.frozen import frozen
from plcgen.s7.layout.shapes import MAX_BYTES, MAX_ENTRIES, Field, Shape, ShapeBuilder
from plcgen.s7.types.blocks import Block, SectionKind
from plcgen.s7.types.data_types import ArrayType, DataType, Member, StructType, UnknownPathError
from plcgen.s7.types.names import is_identifier

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

__all__ = ["MAX_BYTES", "Entry", "Layout", "layout_block", "layout_members", "leaves", "locate", "split_path"]


@frozen
class Entry:
    """One member or array element; ``offset`` and ``size`` in bits from the start of the block.

    ``type`` is what lies in memory: a structured IN_OUT is a POINTER here while ``member`` keeps the declared
    type. ``doubts`` are the keys of the rules (``evidence.rule``) that the offset depends on and that no compiled
    block confirms.
    """

    path: str
    offset: int
    size: int
    type: DataType
    member: Member
    depth: int
    doubts: frozenset[str]
    shape: Shape = field(repr=False, compare=False)

    @property
    def confirmed(self) -> bool:
        """Whether the offset rests on compiled blocks only."""
        return not self.doubts

    @property
    def byte(self) -> int:
        """Byte offset."""
        return self.offset // 8

    @property
    def bit(self) -> int:
        """Bit within the byte, 0 to 7."""
        return self.offset % 8


@dataclass(frozen=True)
class Layout:
    """Memory of one block: ``size`` in bytes (even); ``shape`` is its whole content as a structure."""

    size: int
    shape: Shape = field(repr=False, compare=False)

    @cached_property
    def entries(self) -> tuple[Entry, ...]:
        """One entry per declared member in memory order; made when first asked for.

        Members of structures and multi-instances follow their parent, one ``depth`` deeper; arrays are one entry,
        :func:`leaves` takes them apart.
        """
        return tuple(_members(self.shape, None))


def layout_block(block: Block, types: Mapping[str, Block], limit: int = MAX_BYTES) -> Layout:
    """Lay a DB, UDT or FB (instance data) out; FC and OB have no memory of their own.

    ``types`` holds UDTs and FBs by name, in any letter case; ``limit`` is the largest size in bytes.
    Raises DiagnosticError with PG805 (name declared twice), PG806 (unknown type), PG807 (type contains
    itself), PG808 (block too large).
    """
    builder = ShapeBuilder(types, block.span or Span(block.name))
    return _finish(builder, builder.block(block), block.name, limit)


def layout_members(members: Sequence[Member], types: Mapping[str, Block]) -> Layout:
    """Lay bare members out from offset 0, for example the TEMP section of an FC; errors as layout_block."""
    builder = ShapeBuilder(types, Span(""))
    builder.check_names(members)
    shape = builder.struct(StructType(()), ((SectionKind.STATIC, members),))
    return _finish(builder, shape, "the declaration", MAX_BYTES)


def _finish(builder: ShapeBuilder, shape: Shape, name: str, limit: int) -> Layout:
    if shape.bits > 8 * limit:
        builder.report("PG808", f"{name} takes {shape.bits // 8} bytes, the limit is {limit}", None)
    elif shape.count > MAX_ENTRIES:
        builder.report("PG808", f"{name} has {shape.count} members, the limit is {MAX_ENTRIES}", None)
    if builder.diagnostics:
        raise DiagnosticError(dict.fromkeys(builder.diagnostics))
    return Layout(shape.bits // 8, shape)


def leaves(layout: Layout) -> Iterator[Entry]:
    """Every elementary and string entry in memory order, arrays taken apart; lazy, linear in what is read."""
    for child in layout.shape.fields:
        yield from _leaves(_child(child, None))


def locate(layout: Layout, path: str) -> Entry:
    """Find the entry at ``path``, for example ``a.b[1].c`` or ``m[1,2]``; letter case does not matter.

    Raises KeyError with a reason if there is no such member or the index is out of bounds.
    """
    shape = layout.shape
    entry: Entry | None = shape.looked_up.get(path)
    if entry is not None:
        return entry
    looked_up = shape.looked_up
    for step in split_path(path):
        if isinstance(step, tuple):
            if entry is None:
                raise UnknownPathError(f"{path}: an index needs an array before it")
            entry = _index(entry, step, path)
        else:
            found = shape.index.get(step.upper())
            if found is None:
                raise UnknownPathError(f"{path}: there is no member {step}")
            entry = _child(found, entry)
        shape = entry.shape
    if entry is None:
        raise UnknownPathError("the path is empty")
    looked_up[path] = entry
    return entry


_STEP = re.compile(
    r"""\s*(?P<dot>\.)?\s*\#?(?:"(?P<quoted>[^"]+)"|(?P<name>[^\s."\[\],]+))"""
    r"""|\s*\[(?P<index>\s*-?\d+\s*(?:,\s*-?\d+\s*)*)\]"""
)


def split_path(path: str) -> list[str | tuple[int, ...]]:
    """Take a path apart: names as text, indices as tuples. Raises KeyError if it is no path."""
    steps: list[str | tuple[int, ...]] = []
    position = 0
    text = path.strip()
    while position < len(text):
        match = _STEP.match(text, position)
        if match is None or (match["index"] is None and bool(steps) != bool(match["dot"])):
            raise UnknownPathError(f"{path}: not a member path")
        if match["index"] is not None:
            index = tuple(int(part) for part in match["index"].split(","))
            previous = steps[-1] if steps else ""
            if isinstance(previous, tuple):
                steps[-1] = previous + index
            else:
                steps.append(index)
        else:
            steps.append(match["quoted"] or match["name"])
        position = match.end()
    return steps


def _index(entry: Entry, indices: tuple[int, ...], path: str) -> Entry:
    """One element of an array; further indices go on into arrays of arrays."""
    shape = entry.shape
    if not isinstance(shape.type, ArrayType) or shape.element is None:
        raise UnknownPathError(f"{path}: {entry.path} is not an array")
    bounds = shape.type.bounds
    here, rest = indices[: len(bounds)], indices[len(bounds) :]
    if len(here) < len(bounds):
        raise UnknownPathError(f"{path}: {entry.path} needs {len(bounds)} indices")
    for value, (low, high) in zip(here, bounds, strict=True):
        if not low <= value <= high:
            raise UnknownPathError(f"{path}: index {value} is outside {low}..{high}")
    element = _element(entry, here)
    return _index(element, rest, path) if rest else element


def _element(entry: Entry, indices: tuple[int, ...]) -> Entry:
    shape = entry.shape
    if not isinstance(shape.type, ArrayType) or shape.element is None:
        raise TypeError(entry.path)
    steps = [value - low for value, (low, _) in zip(indices, shape.type.bounds, strict=True)]
    offset = entry.offset + sum(step * stride for step, stride in zip(steps, shape.strides, strict=True))
    path = f"{entry.path}[{','.join(map(str, indices))}]"
    doubts = entry.doubts | shape.stride_doubts if shape.stride_doubts and any(steps) else entry.doubts
    element = shape.element
    return Entry(path, offset, element.bits, element.type, entry.member, entry.depth, doubts, element)


def _leaves(entry: Entry) -> Iterator[Entry]:
    shape = entry.shape
    if isinstance(shape.type, ArrayType):
        ranges = (range(low, high + 1) for low, high in shape.type.bounds)
        for indices in itertools.product(*ranges):
            yield from _leaves(_element(entry, indices))
    elif shape.fields:
        for child in shape.fields:
            yield from _leaves(_child(child, entry))
    elif not isinstance(shape.type, StructType):
        yield entry


def _members(shape: Shape, parent: Entry | None) -> Iterator[Entry]:
    for child in shape.fields:
        entry = _child(child, parent)
        yield entry
        if child.shape.fields:
            yield from _members(child.shape, entry)


def _child(child: Field, parent: Entry | None) -> Entry:
    member, shape, name = child.member, child.shape, _quote(child.member.name)
    if parent is None:
        return Entry(name, child.offset, shape.bits, shape.type, member, 0, child.doubts, shape)
    doubts = parent.doubts | child.doubts if child.doubts else parent.doubts
    offset, depth = parent.offset + child.offset, parent.depth + 1
    return Entry(f"{parent.path}.{name}", offset, shape.bits, shape.type, member, depth, doubts, shape)


def _quote(name: str) -> str:
    return name if is_identifier(name) else f'"{name}"'
