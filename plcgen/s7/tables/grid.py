"""The bytes of a block as a picture: rows of cells, every cell with the member that lies there.

A row has 2, 8 or 16 bytes; within a byte bit 7 stands left, as in S7 manuals. Nothing here knows SVG.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from plcgen.s7.tables.declared import extent, is_composite
from plcgen.s7.tables.tables import MEMBER, BlockTable, member_address, size_text
from plcgen.s7.types.spelling import type_text

if TYPE_CHECKING:
    from plcgen.s7.layout.shapes import Shape
    from plcgen.s7.types.data_types import Member

MAX_CELLS = 12_000
"""Cells of one picture; it ends there and says so."""

_SMALL, _MEDIUM = 32, 1024
_FOLD = 6
"""A member that covers more rows than this is drawn with its first two and its last one."""


@dataclass(frozen=True, slots=True)
class CellRun:
    """Bits ``start`` to ``start + bits`` that hold one value, or nothing (``name`` is empty).

    ``tone`` counts the members of the block: cells of one top-level member share a colour, unless ``role`` gives one.
    """

    start: int
    bits: int
    name: str
    type: str
    tone: int
    value: str = ""
    comment: str = ""
    role: str = ""


@dataclass(frozen=True, slots=True)
class Cell:
    """One rectangle: ``x`` and ``width`` in bits from the left of its row, ``first`` where its member begins."""

    x: int
    width: int
    run: CellRun
    first: bool


@dataclass(frozen=True, slots=True)
class GridRow:
    """Bytes from ``byte`` on; ``skipped`` bytes of one long member were left out before it."""

    byte: int
    cells: tuple[Cell, ...]
    skipped: int = 0


@dataclass(slots=True)
class Grid:
    """The picture of one block; ``drawn`` bytes of its ``size`` are in it."""

    columns: int
    size: int
    rows: list[GridRow] = field(default_factory=list)
    drawn: int = 0


def grid(block: BlockTable, limit: int = MAX_CELLS) -> Grid:
    """Draw a block; those without offsets have an empty picture."""
    size = block.size or 0
    columns = 2 if size <= _SMALL else 8 if size <= _MEDIUM else 16
    picture = Grid(columns, size)
    count = 0
    pending: list[Cell] = []
    byte = skipped = 0
    for run in _with_gaps(_runs(block), 8 * size):
        for place, cells, left_out in _pieces(run, columns):
            if place != byte:
                if pending:
                    picture.rows.append(GridRow(byte, tuple(pending), skipped))
                    if count > limit:
                        picture.drawn = byte + columns
                        return picture
                byte, pending, skipped = place, [], left_out
            pending += cells
            count += len(cells)
    if pending:
        picture.rows.append(GridRow(byte, tuple(pending), skipped))
    picture.drawn = size
    return picture


def _with_gaps(runs: Iterable[CellRun], end: int) -> Iterator[CellRun]:
    """Fill what no run covers."""
    at = 0
    for run in runs:
        if run.start > at:
            yield CellRun(at, run.start - at, "", "", 0)
        yield run
        at = run.start + run.bits
    if end > at:
        yield CellRun(at, end - at, "", "", 0)


def _pieces(run: CellRun, columns: int) -> Iterator[tuple[int, list[Cell], int]]:
    """One item per row that a run touches: first byte of the row, cells, bytes left out before it."""
    width = 8 * columns
    first, last = run.start // width, (run.start + run.bits - 1) // width
    rows: Iterable[int] = range(first, last + 1)
    if last - first >= _FOLD:
        rows = (first, first + 1, last)
    before = first
    for row in rows:
        begin, end = max(run.start, row * width), min(run.start + run.bits, (row + 1) * width)
        skipped = max(0, row - before - 1) * columns
        yield row * columns, list(_cells(run, begin, end, row * width)), skipped
        before = row


def _cells(run: CellRun, begin: int, end: int, origin: int) -> Iterator[Cell]:
    """Rectangles of one run in one row: whole bytes together, single bits of a byte from bit 7 on the left."""
    while begin < end:
        if begin % 8 or end - begin < 8:
            stop = min(end, begin - begin % 8 + 8)
            left = begin - begin % 8 + 8 - (stop - begin // 8 * 8)
        else:
            stop, left = end - end % 8, begin
        yield Cell(left - origin, stop - begin, run, begin == run.start)
        begin = stop


def _runs(block: BlockTable) -> Iterator[CellRun]:
    if block.shape is not None:
        for tone, child in enumerate(block.shape.fields):
            if child.member.at is None:
                yield from _leaves(child.shape, child.offset, child.member.name, tone, child.member, block.begin)
        return
    for tone, row in enumerate(row for row in block.rows if row.kind == MEMBER and row.byte is not None):
        start = 8 * (row.byte or 0) + (row.bit or 0)
        yield CellRun(start, row.bits, row.name, row.type, tone, row.start, row.comment, row.role)


def _leaves(
    shape: Shape, start: int, name: str, tone: int, member: Member | None, begin: Mapping[str, str]
) -> Iterator[CellRun]:
    """What one member holds, in memory order; arrays of plain values are one run."""
    if shape.fields:
        for child in shape.fields:
            if child.member.at is None:
                path, place = f"{name}.{child.member.name}", start + child.offset
                yield from _leaves(child.shape, place, path, tone, child.member, begin)
    elif shape.element is not None and is_composite(shape):
        for index, offset in shape.places():
            yield from _leaves(shape.element, start + offset, f"{name}[{index}]", tone, None, begin)
    elif extent(shape):
        value, comment = (member.start or "", member.comment) if member else ("", "")
        if begin:
            value = begin.get(name.lower(), value)
        yield CellRun(start, extent(shape), name, type_text(shape.type), tone, value, comment)


def cell_title(run: CellRun, db: int | None, *, in_db: bool) -> str:
    """Text to show under the mouse: ``DB3.DBW6  Para_No : WORD := 16#C47F, 2 B``."""
    byte, bit = divmod(run.start, 8)
    size = size_text(run.bits)
    if not run.name:
        return f"{byte}.{bit}  unused, {size}"
    address = f"{byte}.{bit}"
    if in_db:
        address = member_address(db, byte, bit if run.bits == 1 else None, run.bits)
    value = f" := {run.value}" if run.value else ""
    comment = f"  // {run.comment}" if run.comment else ""
    return f"{address}  {run.name} : {run.type}{value}, {size}{comment}"
