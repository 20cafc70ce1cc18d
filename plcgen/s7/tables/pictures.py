"""Memory layouts as pictures in pixels, for the templates of an SVG file and of a page.

A row of a grid has 2, 8 or 16 bytes; within a byte bit 7 stands left, as in S7 manuals. Nothing here knows SVG.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from plcgen.base.display.cells import clean, cut, width
from plcgen.s7.tables.declared import extent, is_composite
from plcgen.s7.tables.tables import MEMBER, BlockTable, member_address, member_paths, size_text
from plcgen.s7.types.literals import type_text

if TYPE_CHECKING:
    from plcgen.s7.layout.shapes import Shape
    from plcgen.s7.tables.tables import BlockTable, LayoutRow
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


TONES = 12
"""Colours; the next top-level member begins again."""

_CELL = {2: 300, 8: 108, 16: 66}
"""Width of a byte in pixels, by the number of bytes in a row."""

_GUTTER, _ROW, HEAD = 62, 26, 22
_CHARACTER = 6.7
"""Width of a character in pixels, 11 px monospace."""

_SHORT = 3
"""Characters that are not worth an ellipsis."""

_UPWARDS = 22
"""Characters of a name that is written upwards in the cell of a bit; the table has the rest."""

_NO_ANCHOR = re.compile(r"[^\w]+", re.ASCII)
_NO_XML = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")
_LONG_TITLE = 300


@dataclass(frozen=True, slots=True)
class Rectangle:
    """One cell in pixels, with the texts that fit into it.

    ``turned`` says that the label is written upwards, ``anchor`` names the row of the table that it belongs to.
    """

    x: float
    y: int
    width: float
    height: int
    style: str
    label: str
    value: str
    title: str
    turned: bool = False
    anchor: str = ""

    @property
    def inset(self) -> float:
        """Where the label begins: a bit of a wide picture has no room for a margin."""
        return min(4.0, max(0.5, (self.width - _CHARACTER * len(self.label)) / 2))


@dataclass(frozen=True, slots=True)
class PictureNote:
    """A line of text inside a picture, for example the bytes that were left out."""

    y: int
    text: str


@dataclass(frozen=True, slots=True)
class Picture:
    """A part of a block's picture: pixels, offsets at the left, cells; ``summary`` names its bytes."""

    width: float
    height: int
    heads: tuple[tuple[float, str], ...]
    offsets: tuple[tuple[int, int], ...]
    rectangles: tuple[Rectangle, ...]
    notes: tuple[PictureNote, ...]
    summary: str


def views(blocks: Sequence[BlockTable], chunk: int = 0, prefix: str = "b") -> list[dict[str, Any]]:
    """What the templates of page and picture show of every block; pictures in parts of ``chunk`` rows (0: whole).

    ``prefix`` begins the anchors of blocks and members.
    """
    return [_view(block, f"{prefix}{number}", chunk) for number, block in enumerate(blocks, 1)]


def _anchors(block: BlockTable, key: str) -> dict[str, str]:
    """Anchor of every member by its path; a fold or gap has none."""
    found: dict[str, str] = {}
    taken: set[str] = set()
    for path in member_paths(block.rows):
        plain = _NO_ANCHOR.sub("-", path).strip("-").lower()[:80]
        anchor = f"{key}-{plain}"
        if path and path not in found:
            found[path] = anchor if anchor not in taken else f"{anchor}-{len(taken)}"
            taken.add(found[path])
    return found


def _view(block: BlockTable, key: str, chunk: int) -> dict[str, Any]:
    picture = grid(block)
    anchors = _anchors(block, key)
    paths = list(member_paths(block.rows))
    missing = picture.size - picture.drawn
    return {
        "id": key,
        "title": _safe(block.title),
        "heading": _safe(f"{block.title}  {block.summary}"),
        "summary": _safe(block.summary),
        "comment": _safe(block.comment),
        "place": _safe(f"{block.file}:{block.line}") if block.file else "",
        "optimized": block.size is None,
        "pictures": list(_pictures(block, picture, chunk, anchors if chunk else {})),
        "end": f"{missing} more bytes are not drawn" if missing > 0 else "",
        "has_addresses": any(row.address for row in block.rows),
        "has_rules": bool(block.rules),
        "has_starts": any(row.start for row in block.rows),
        "has_comments": any(row.comment for row in block.rows),
        "has_roles": any(row.role for row in block.rows),
        "rows": [_row(block, row, anchors.get(path, "")) for row, path in zip(block.rows, paths, strict=True)],
        "footnotes": [(mark, _safe(text)) for mark, text in block.footnotes],
    }


def _row(block: BlockTable, row: LayoutRow, anchor: str) -> dict[str, Any]:
    offset, address, _, type_, size, start, comment = (_safe(cell) for cell in row.cells())
    return {
        "offset": offset, "address": address, "name": _safe(row.name), "type": type_, "size": size, "start": start,
        "comment": comment, "depth": min(row.depth, 20), "kind": row.kind, "marks": block.mark(row),
        "anchor": anchor, "role": row.role,
    }  # fmt: skip


def _pictures(block: BlockTable, picture: Grid, chunk: int, anchors: Mapping[str, str]) -> Iterator[Picture]:
    """Divide a picture into parts of ``chunk`` rows; 0 leaves it whole."""
    step = chunk or max(len(picture.rows), 1)
    for begin in range(0, len(picture.rows), step):
        rows = picture.rows[begin : begin + step]
        following = picture.rows[begin + step].byte if begin + step < len(picture.rows) else picture.drawn
        yield _picture(block, picture, rows, anchors, f"bytes {rows[0].byte} to {max(following, rows[0].byte + 1) - 1}")


def _picture(
    block: BlockTable, picture: Grid, rows: Sequence[GridRow], anchors: Mapping[str, str], summary: str
) -> Picture:
    cell = _CELL[picture.columns]
    rectangles: list[Rectangle] = []
    notes: list[PictureNote] = []
    offsets: list[tuple[int, int]] = []
    y = HEAD
    for row in rows:
        if row.skipped:
            notes.append(PictureNote(y + 15, f"... {row.skipped} more bytes of it ..."))
            y += _ROW
        offsets.append((y + 17, row.byte))
        height = _height(row, cell)
        rectangles += [_rectangle(block, piece, cell, (y, height), anchors) for piece in row.cells]
        y += height
    heads = tuple((_GUTTER + column * cell + 5.0, f"+{column}") for column in range(picture.columns))
    edge = _GUTTER + picture.columns * cell + 2.0
    return Picture(edge, y + 6, heads, tuple(offsets), tuple(rectangles), tuple(notes), summary)


def _height(row: GridRow, cell: int) -> int:
    """A row is as high as the longest name of a bit that has to be written upwards in it."""
    turned = [width(_last(piece)) for piece in row.cells if _is_turned(piece, piece.width * cell / 8)]
    return max(_ROW, int(12 + _CHARACTER * min(max(turned), _UPWARDS))) if turned else _ROW


def _is_turned(piece: Cell, wide: float) -> bool:
    """Whether the name of a bit does not fit into its cell."""
    run = piece.run
    return bool(run.name) and piece.first and run.bits == 1 and width(_last(piece)) > int((wide - 8) / _CHARACTER)


def _last(piece: Cell) -> str:
    """The last part of the name of a cell: what is above it is the same for its neighbours."""
    name = _safe(piece.run.name)
    return name[name.rfind(".") + 1 :]


def _rectangle(
    block: BlockTable, piece: Cell, cell: int, place: tuple[int, int], anchors: Mapping[str, str]
) -> Rectangle:
    run = piece.run
    y, height = place
    wide = piece.width * cell / 8
    text = cell_title(run, block.number, in_db=block.kind == "DB")
    style = (f"r-{run.role}" if run.role else f"t{run.tone % TONES}") if run.name else "gap"
    turned = _is_turned(piece, wide)
    label, value = _texts(block, piece, int((wide - 8) / _CHARACTER))
    if turned:
        label, value = cut(_last(piece), _UPWARDS), ""
    x, shown = _GUTTER + piece.x * cell / 8, cut(_safe(text), _LONG_TITLE)
    return Rectangle(x, y, wide, height, style, label, value, shown, turned, anchors.get(run.name, ""))


def _texts(block: BlockTable, piece: Cell, room: int) -> tuple[str, str]:
    """Name and start value as far as there is room; a further row shows a ditto mark."""
    run = piece.run
    if not run.name or not piece.first:
        return ('"' if run.name and room > 0 else ""), ""
    name = _safe(run.name)
    data = block.data[run.start // 8 : (run.start + run.bits) // 8] if block.data else b""
    value = data.hex(" ").upper() if data else _safe(run.value)
    if width(name) <= room:
        return name, value if width(name) + width(value) + 2 <= room else ""
    last = name[name.rfind(".") + 1 :]
    return (cut(last, room) if room > _SHORT else ""), ""


def _safe(text: str) -> str:
    """Text that XML can hold and that no terminal trick changes."""
    return _NO_XML.sub("\ufffd", clean(text))
