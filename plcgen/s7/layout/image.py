"""The load-memory image of a data block: start values and BEGIN assignments as big-endian bytes."""

from __future__ import annotations

import datetime as dt
import math
from typing import TYPE_CHECKING, TypeAlias

from plcgen.s7.layout.layout import Entry, Layout, layout_block, leaves, locate
from plcgen.s7.types.data_types import ELEMENTARY, ArrayType, Elementary, StringType, UnfitValueError
from plcgen.s7.types.literals import Group, InitialItem, LiteralError, flatten, pack_literal, parse_initializer
from plcgen.s7.types.values import Value, pack_value, unpack_value

if TYPE_CHECKING:
    from collections.abc import Mapping

    from plcgen.base.diagnostics import Span
    from plcgen.s7.layout.shapes import Shape
    from plcgen.s7.types.blocks import Block

Tree: TypeAlias = "Value | list[Tree] | dict[str, Tree]"

_POINTER = ELEMENTARY["POINTER"]
_DEFAULTS: dict[str, Value] = {
    "CHAR": " ",
    "WCHAR": " ",
    "DATE_AND_TIME": dt.datetime(1990, 1, 1),  # noqa: DTZ001 - PLC clocks carry no time zone
    "DTL": 0,
}
"""Default start values that are not all zero bytes."""
MAX_UNFIT = 100
"""So many values that do not fit are noted of one initialiser."""


class StartValueError(LiteralError):
    """A start value that does not fit: ``path`` names the member, ``span`` the place in the source."""

    def __init__(self, error: LiteralError, path: str, span: Span | None) -> None:
        super().__init__(error.text, error.type_name, error.reason)
        self.path = path
        self.span = span
        self.args = (f"{path}: {self.args[0]}",)


def image(block: Block, types: Mapping[str, Block], unfit: list[StartValueError] | None = None) -> bytearray:
    """Bytes of a DB (or of an FB's instance data) after a download; ``len`` is the layout's size.

    Declared start values first, then the BEGIN assignments. Every value and assignment that does not fit goes into
    ``unfit``; without such a list the first one is raised, a StartValueError. Raises DiagnosticError like
    ``layout_block``.
    """
    layout = layout_block(block, types)
    memory = bytearray(layout.size)
    builder = _Builder()
    builder.fill(memory, layout.shape, 0)
    for assignment in block.assignments:
        found: list[LiteralError] = []
        try:
            entry = locate(layout, assignment.path)
            _initialize(memory, entry.shape, entry.offset, assignment.literal, found)
        except KeyError as error:
            found.append(LiteralError(assignment.literal, "start value", str(error.args[0])))
        builder.unfit += (StartValueError(error, assignment.path, assignment.span) for error in found)
    if unfit is None:
        _raise_first(builder)
    else:
        unfit += builder.unfit
    return memory


def start_place(block: Block, types: Mapping[str, Block], byte: int) -> Span | None:
    """Where the start value of a byte is said: in the last assignment, or where its member is declared."""
    layout = layout_block(block, types)
    said = ((locate(layout, one.path), one.span) for one in reversed(block.assignments))
    declared = ((one, one.member.span) for one in leaves(layout))  # a view of the same bytes comes later
    for entry, span in (*said, *declared):
        if span is not None and entry.offset <= 8 * byte < entry.offset + entry.size:
            return span
    return block.span


def default_bytes(shape: Shape) -> bytes:
    """Bytes of a type after a download, with the start values that the type declares; one byte for a BOOL.

    Raises StartValueError for a declared value that does not fit.
    """
    builder = _Builder()
    made = builder.default(shape)
    _raise_first(builder)
    return made


def read_member(memory: bytes | bytearray, layout: Layout, path: str) -> Tree:
    """Value at ``path``: a Python value, a list for an array (row by row), a dict for a structure.

    Raises KeyError for an unknown path and ValueError for bytes that mean nothing in the member's type.
    """
    return read_entry(memory, locate(layout, path))


def read_entry(memory: bytes | bytearray, entry: Entry) -> Tree:
    """As :func:`read_member`, of a member that was located."""
    return _read(memory, entry.shape, entry.offset)


def write_member(memory: bytearray, layout: Layout, path: str, value: Value) -> None:
    """Store one elementary value or text.

    Raises KeyError for an unknown path, ValueError if the value does not fit.
    """
    entry = locate(layout, path)
    _put(memory, entry.offset, pack_value(value, _scalar(entry)), entry.size)


def _scalar(entry: Entry) -> Elementary | StringType:
    if isinstance(entry.type, Elementary | StringType):
        return entry.type
    raise UnfitValueError(f"{entry.path} is not elementary")


class _Builder:
    """Default contents; the bytes of a type are made once and copied. ``unfit`` are the values that do not fit."""

    def __init__(self) -> None:
        self._made: dict[int, bytes] = {}
        self.unfit: list[StartValueError] = []

    def default(self, shape: Shape) -> bytes:
        key = id(shape)
        if key not in self._made:
            self._made[key] = self._make(shape)
        return self._made[key]

    def _make(self, shape: Shape) -> bytes:
        if isinstance(shape.type, StringType):
            return pack_value("", shape.type)
        if isinstance(shape.type, Elementary):
            default = _DEFAULTS.get(shape.type.name)
            return bytes(-(-shape.bits // 8)) if default is None else pack_value(default, shape.type)
        if shape.element is not None:
            if shape.element.bits == 1:
                return bytes(shape.bits // 8)
            element = self.default(shape.element).ljust(shape.strides[-1] // 8, b"\x00")
            return (element * math.prod(h - low + 1 for low, h in _bounds(shape))).ljust(shape.bits // 8, b"\x00")
        memory = bytearray(shape.bits // 8)
        self.fill(memory, shape, 0)
        return bytes(memory)

    def fill(self, memory: bytearray, shape: Shape, offset: int) -> None:
        """Write the members of a structure with their start values; AT views and pointers hold none."""
        for child in shape.fields:
            if child.member.at is not None:
                continue
            start = offset + child.offset
            if child.shape.bits != 1:
                data = self.default(child.shape)
                memory[start // 8 : start // 8 + len(data)] = data
            by_pointer = child.shape.type is _POINTER and child.member.type is not _POINTER
            if child.member.start is None or by_pointer:
                continue
            found: list[LiteralError] = []
            _initialize(memory, child.shape, start, child.member.start, found)
            self.unfit += (StartValueError(error, child.member.name, child.member.span) for error in found)


def _raise_first(builder: _Builder) -> None:
    if builder.unfit:
        raise builder.unfit[0]


def _bounds(shape: Shape) -> tuple[tuple[int, int], ...]:
    return shape.type.bounds if isinstance(shape.type, ArrayType) else ()


def _put(memory: bytearray, offset: int, data: bytes, bits: int) -> None:
    if bits == 1:
        mask = 1 << offset % 8
        memory[offset // 8] = memory[offset // 8] & ~mask | (mask if data[0] else 0)
    else:
        memory[offset // 8 : offset // 8 + len(data)] = data


def _add(unfit: list[LiteralError], error: LiteralError) -> None:
    """Note a value that does not fit; a repeated one is noted once."""
    if len(unfit) < MAX_UNFIT and (not unfit or unfit[-1].args != error.args):
        unfit.append(error)


def _initialize(memory: bytearray, shape: Shape, offset: int, text: str, unfit: list[LiteralError]) -> None:
    """Write the value of ``text`` at a place; what does not fit goes into ``unfit``."""
    try:
        items = parse_initializer(text)
    except LiteralError as error:
        _add(unfit, error)
    else:
        _store(memory, shape, offset, items, unfit)


def _store(
    memory: bytearray, shape: Shape, offset: int, items: tuple[InitialItem, ...], unfit: list[LiteralError]
) -> None:
    """Write an initialiser at a place; an empty value keeps what is there."""
    if isinstance(shape.type, Elementary | StringType):
        if len(items) != 1 or items[0].name or items[0].count != 1 or not isinstance(items[0].value, str):
            empty = not items or (len(items) == 1 and isinstance(items[0].value, Group) and not items[0].value.items)
            if not empty:
                _add(unfit, LiteralError("(..)", shape.type.name, "a single value is needed"))
            return
        try:
            _put(memory, offset, pack_literal(items[0].value, shape.type), shape.bits)
        except LiteralError as error:
            _add(unfit, error)
    elif shape.element is not None:
        element = shape.element
        total = math.prod(high - low + 1 for low, high in _bounds(shape))
        nested = element.element is not None
        for position, node in enumerate(flatten(_unwrap(items), total, "" if nested else "[")):
            if position >= total:
                _add(unfit, LiteralError("[..]", "ARRAY", f"more than {total} values"))
            elif node is not None:
                _store(memory, element, offset + _element_offset(shape, position), (InitialItem(node),), unfit)
    else:
        _store_struct(memory, shape, offset, items, unfit)


def _unwrap(items: tuple[InitialItem, ...]) -> tuple[InitialItem, ...]:
    """Drop the brackets around a whole list; an array of arrays keeps those of its rows."""
    if len(items) == 1 and items[0].count == 1 and items[0].name is None:
        node = items[0].value
        if isinstance(node, Group) and node.kind == "[":
            return node.items
    return items


def _element_offset(shape: Shape, position: int) -> int:
    """Offset in bits of the n-th element, the last index counting fastest."""
    offset = 0
    for (low, high), stride in zip(reversed(_bounds(shape)), reversed(shape.strides), strict=True):
        position, step = divmod(position, high - low + 1)
        offset += step * stride
    return offset


def _store_struct(
    memory: bytearray, shape: Shape, offset: int, items: tuple[InitialItem, ...], unfit: list[LiteralError]
) -> None:
    """The members by position or name; of a type whose members nobody knows, nothing is said."""
    if len(items) == 1 and items[0].name is None and isinstance(items[0].value, Group):
        items = items[0].value.items
    own = [child for child in shape.fields if child.member.at is None]
    if not own:
        return
    if len(items) > len(own):
        _add(unfit, LiteralError("(..)", "STRUCT", f"more than {len(own)} values"))
        return
    for position, item in enumerate(items):
        child = own[position] if item.name is None else shape.index.get(item.name.upper())
        if child is None:
            _add(unfit, LiteralError(item.name or "", "STRUCT", "no such member"))
        elif item.value is not None:
            _store(memory, child.shape, offset + child.offset, (InitialItem(item.value),), unfit)


def _read(memory: bytes | bytearray, shape: Shape, offset: int) -> Tree:
    if isinstance(shape.type, Elementary | StringType):
        if shape.bits == 1:
            return bool(memory[offset // 8] >> offset % 8 & 1)
        return unpack_value(bytes(memory[offset // 8 : (offset + shape.bits) // 8]), shape.type)
    if shape.element is not None:
        element, total = shape.element, math.prod(high - low + 1 for low, high in _bounds(shape))
        return [_read(memory, element, offset + _element_offset(shape, n)) for n in range(total)]
    return {f.member.name: _read(memory, f.shape, offset + f.offset) for f in shape.fields}
