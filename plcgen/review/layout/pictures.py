"""Memory layouts as pictures in pixels, for the templates of an SVG file and of a page."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from plcgen.display.cells import clean, cut, width
from plcgen.review.layout.grid import Cell, Grid, GridRow, grid, title

if TYPE_CHECKING:
    from plcgen.review.layout.tables import BlockTable, LayoutRow

TONES = 12
"""Colours; the next top-level member begins again."""

_CELL = {2: 300, 8: 108, 16: 66}
"""Width of a byte in pixels, by the number of bytes in a row."""

_GUTTER, _ROW, HEAD = 62, 26, 22
_CHARACTER = 6.7
"""Width of a character in pixels, 11 px monospace."""

_SHORT = 3
"""Characters that are not worth an ellipsis."""

_NO_XML = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")
_LONG_TITLE = 300


@dataclass(frozen=True, slots=True)
class Rectangle:
    """One cell in pixels, with the texts that fit into it."""

    x: float
    y: int
    width: float
    style: str
    label: str
    value: str
    title: str

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


def views(blocks: Sequence[BlockTable], chunk: int = 0) -> list[dict[str, Any]]:
    """What the templates of page and picture show of every block; pictures in parts of ``chunk`` rows (0: whole)."""
    return [_view(block, number, chunk) for number, block in enumerate(blocks, 1)]


def _view(block: BlockTable, number: int, chunk: int) -> dict[str, Any]:
    picture = grid(block)
    missing = picture.size - picture.drawn
    return {
        "id": f"b{number}",
        "title": _safe(block.title),
        "heading": _safe(f"{block.title}  {block.summary}"),
        "summary": _safe(block.summary),
        "comment": _safe(block.comment),
        "place": _safe(f"{block.file}:{block.line}") if block.file else "",
        "optimized": block.size is None,
        "pictures": list(_pictures(block, picture, chunk)),
        "end": f"{missing} more bytes are not drawn" if missing > 0 else "",
        "has_rules": bool(block.rules),
        "has_starts": any(row.start for row in block.rows),
        "has_comments": any(row.comment for row in block.rows),
        "rows": [_row(block, row) for row in block.rows],
        "footnotes": [(mark, _safe(text)) for mark, text in block.footnotes],
    }


def _row(block: BlockTable, row: LayoutRow) -> dict[str, Any]:
    offset, address, _, type_, size, start, comment = (_safe(cell) for cell in row.cells())
    return {
        "offset": offset, "address": address, "name": _safe(row.name), "type": type_, "size": size, "start": start,
        "comment": comment, "depth": min(row.depth, 20), "kind": row.kind, "marks": block.mark(row),
    }  # fmt: skip


def _pictures(block: BlockTable, picture: Grid, chunk: int) -> Iterator[Picture]:
    """Divide a picture into parts of ``chunk`` rows; 0 leaves it whole."""
    step = chunk or max(len(picture.rows), 1)
    for begin in range(0, len(picture.rows), step):
        rows = picture.rows[begin : begin + step]
        following = picture.rows[begin + step].byte if begin + step < len(picture.rows) else picture.drawn
        yield _picture(block, picture, rows, f"bytes {rows[0].byte} to {max(following, rows[0].byte + 1) - 1}")


def _picture(block: BlockTable, picture: Grid, rows: Sequence[GridRow], summary: str) -> Picture:
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
        rectangles += [_rectangle(block, piece, cell, y) for piece in row.cells]
        y += _ROW
    heads = tuple((_GUTTER + column * cell + 5.0, f"+{column}") for column in range(picture.columns))
    edge = _GUTTER + picture.columns * cell + 2.0
    return Picture(edge, y + 6, heads, tuple(offsets), tuple(rectangles), tuple(notes), summary)


def _rectangle(block: BlockTable, piece: Cell, cell: int, y: int) -> Rectangle:
    run = piece.run
    wide = piece.width * cell / 8
    text = title(run, block.number, in_db=block.kind == "DB")
    style = f"t{run.tone % TONES}" if run.name else "gap"
    label, value = _texts(block, piece, int((wide - 8) / _CHARACTER))
    return Rectangle(_GUTTER + piece.x * cell / 8, y, wide, style, label, value, cut(_safe(text), _LONG_TITLE))


def _texts(block: BlockTable, piece: Cell, room: int) -> tuple[str, str]:
    """Name and start value as far as there is room; a narrow bit shows its number, a further row a ditto mark."""
    run = piece.run
    if not run.name or not piece.first:
        return ('"' if run.name and room > 0 else ""), ""
    name = _safe(run.name)
    data = block.data[run.start // 8 : (run.start + run.bits) // 8] if block.data else b""
    value = data.hex(" ").upper() if data else _safe(run.value)
    if width(name) <= room:
        return name, value if width(name) + width(value) + 2 <= room else ""
    last = name[name.rfind(".") + 1 :]
    if run.bits == 1 and width(last) > room:
        return str(run.start % 8), ""
    return (cut(last, room) if room > _SHORT else ""), ""


def _safe(text: str) -> str:
    """Text that XML can hold and that no terminal trick changes."""
    return _NO_XML.sub("\ufffd", clean(text))
