"""Memory layouts as text, and a telegram as a picture: two bytes a row, every byte with its name."""

from __future__ import annotations

from collections.abc import Sequence

from plcgen.base.display.cells import clean, cut, pad
from plcgen.base.display.table import text_table
from plcgen.base.display.view import View
from plcgen.s7.tables.tables import HEADER, MEMBER, BlockTable, LayoutRow

_RIGHT = frozenset({0, 4})
_LONG = 6
"""Rows after which the picture shortens a member to its first and last two bytes."""

_CELL = 31
"""Columns of a byte in the picture."""
_START = 36
"""Columns of start values on a screen; files have them whole."""


def layout_text(blocks: Sequence[BlockTable], view: View) -> str:
    """Tables for people; telegram buffers get their picture below the table.

    A screen cuts long lines with ``...``; files have them whole.
    """
    return "\n".join(_block(block, view) for block in blocks)


def _block(block: BlockTable, view: View) -> str:
    width = view.width if view.target == "screen" else 0
    lines = [f"{view.paint(block.title, 'bold')}  {block.summary}"]
    if block.comment:
        lines.append(view.paint(f"  {cut(clean(block.comment), width or 160)}", "dim"))
    shown, right = shown_columns(block, _START if width else 0)
    header, *rows = text_table(shown[0], shown[1:], right=right)
    if width:
        header, *rows = [cut(line, width) for line in (header, *rows)]
    lines.append(view.paint(header, "dim"))
    lines += [view.paint(text, "dim" if row.kind != MEMBER else "") for row, text in zip(block.rows, rows, strict=True)]
    lines += [f"  {mark}  {text}" for mark, text in block.footnotes]
    if view.grid and block.data is not None:
        lines += ["", *picture(block)]
    return "\n".join(lines) + "\n"


def shown_columns(block: BlockTable, start: int = 0) -> tuple[list[tuple[str, ...]], frozenset[int]]:
    """Header and rows, without columns that are empty in every row; the numbers of the right-aligned ones.

    ``start`` (0: none) cuts the start values to so many columns.
    """
    table: list[tuple[str, ...]] = [(*HEADER[:5], "rule", *HEADER[5:])]
    for row in block.rows:
        *cells, value, comment = row.cells()
        table.append((*cells, block.mark(row), cut(clean(value), start) if start else value, comment))
    kept = [n for n in range(len(table[0])) if n in {2, 3} or any(row[n] for row in table[1:])]
    right = frozenset(kept.index(n) for n in _RIGHT if n in kept)
    return [tuple(row[n] for n in kept) for row in table], right


def picture(block: BlockTable) -> list[str]:
    """Draw the bytes of a telegram, two to a row, with the member each belongs to."""
    data = block.data or b""
    rule = f"       +{'-' * _CELL}+{'-' * _CELL}+"
    lines = [f"  byte  {pad('+0', _CELL)} +1", rule]
    byte = 0
    for row in block.rows:
        if row.byte is None or row.bits < 8:
            continue
        size = row.bits // 8
        if byte == 4:
            lines.append(rule)
        for step in _steps(row.byte, size):
            if step is None:
                lines.append(f"       |{pad(' ...', 2 * _CELL + 1)}|")
            else:
                _draw(lines, row, data, step)
        byte = row.byte + size
    if lines[-1].count("|") == 2 and byte % 2:
        lines[-1] += f"{' ' * _CELL}|"
    return [*lines, rule]


def _steps(start: int, size: int) -> list[tuple[int, int] | None]:
    """Rows of one member as (first byte, number of bytes); None where rows are left out."""
    first = start - start % 2
    pieces: list[tuple[int, int] | None] = []
    for word in range(first, start + size, 2):
        begin = max(word, start)
        pieces.append((begin, min(word + 2, start + size) - begin))
    return [*pieces[:2], None, *pieces[-2:]] if len(pieces) > _LONG else pieces


def _draw(lines: list[str], row: LayoutRow, data: bytes, step: tuple[int, int]) -> None:
    begin, count = step
    values = " ".join(f"{value:02X}" for value in data[begin : begin + count])
    name = clean(row.name) if begin == row.byte else '"'
    text = cut(f" {values}  {name}", _CELL * count + count - 1)
    drawn = pad(text, _CELL * count + count - 1)
    if begin % 2:
        lines[-1] += f"{drawn}|"
    else:
        lines.append(f"{begin:6d} |{drawn}|")
