"""Memory layouts as tables, and a telegram as a picture: two bytes a row, every byte with its name."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from plcgen.report.cells import clean, cut, pad
from plcgen.report.json import dump, head
from plcgen.report.paint import paint
from plcgen.report.table import csv_table, markdown_table, text_table

HEADER = ("offset", "address", "name", "type", "size", "start value")
_RIGHT = frozenset({0, 4})
_LONG = 6
"""Rows after which the picture shortens a member to its first and last two bytes."""


@dataclass(frozen=True, slots=True)
class LayoutRow:
    """One member: ``byte``.``bit`` from the start of the block (bit None for whole bytes), size in ``bits``."""

    byte: int
    bit: int | None
    bits: int
    address: str
    name: str
    type: str
    start: str
    depth: int = 0

    @property
    def offset(self) -> str:
        """Offset as S7 editors write it: ``6.0``."""
        return f"{self.byte}.{self.bit or 0}"

    @property
    def size(self) -> str:
        """``2 B`` or ``1 bit``."""
        return f"{self.bits // 8} B" if self.bits % 8 == 0 else f"{self.bits} bit"

    def cells(self) -> tuple[str, ...]:
        """Texts of the table's columns."""
        return (self.offset, self.address, "  " * self.depth + self.name, self.type, self.size, self.start)


@dataclass(frozen=True, slots=True)
class BlockTable:
    """One block: identity, size in bytes, members; ``data`` and ``role`` if it is a telegram's buffer."""

    kind: str
    name: str
    number: int | None
    size: int
    rows: tuple[LayoutRow, ...]
    role: str = ""
    data: bytes | None = None

    @property
    def title(self) -> str:
        """``DB3 "WR_DataBuffer"``."""
        return f'{self.kind}{"" if self.number is None else self.number} "{clean(self.name)}"'


def layout_text(blocks: Sequence[BlockTable], *, color: bool = False, grid: bool = True, width: int = 0) -> str:
    """Tables for people; telegram buffers get their picture below the table."""
    return "\n".join(_block(block, color=color, grid=grid, width=width) for block in blocks)


def _block(block: BlockTable, *, color: bool, grid: bool, width: int) -> str:
    role = f", {clean(block.role)}" if block.role else ""
    lines = [f"{paint(block.title, 'bold', color=color)}  {block.size} bytes{role}"]
    header, *rows = text_table(HEADER, [row.cells() for row in block.rows], right=_RIGHT, limit=width)
    lines += [paint(header, "dim", color=color), *rows]
    if grid and block.data is not None:
        lines += ["", *picture(block)]
    return "\n".join(lines) + "\n"


def picture(block: BlockTable, columns: int = 72) -> list[str]:
    """Draw the bytes of a telegram, two to a row, with the member each belongs to."""
    data = block.data or b""
    cell = (columns - 10) // 2
    rule = f"       +{'-' * cell}+{'-' * cell}+"
    lines = [f"  byte  {pad('+0', cell)} +1", rule]
    byte = 0
    rows = [row for row in block.rows if row.bits >= 8]
    for row in rows:
        size = row.bits // 8
        if byte == 4:
            lines.append(rule)
        for step in _steps(row.byte, size):
            if step is None:
                lines.append(f"       |{pad(' ...', 2 * cell + 1)}|")
            else:
                _draw(lines, row, data, step, cell)
        byte = row.byte + size
    if lines[-1].count("|") == 2 and byte % 2:
        lines[-1] += f"{' ' * cell}|"
    return [*lines, rule]


def _steps(start: int, size: int) -> list[tuple[int, int] | None]:
    """Rows of one member as (first byte, number of bytes); None where rows are left out."""
    first = start - start % 2
    pieces: list[tuple[int, int] | None] = []
    for word in range(first, start + size, 2):
        begin = max(word, start)
        pieces.append((begin, min(word + 2, start + size) - begin))
    return [*pieces[:2], None, *pieces[-2:]] if len(pieces) > _LONG else pieces


def _draw(lines: list[str], row: LayoutRow, data: bytes, step: tuple[int, int], cell: int) -> None:
    begin, count = step
    values = " ".join(f"{value:02X}" for value in data[begin : begin + count])
    name = clean(row.name) if begin == row.byte else '"'
    text = cut(f" {values}  {name}", cell * count + count - 1)
    drawn = pad(text, cell * count + count - 1)
    if begin % 2:
        lines[-1] += f"{drawn}|"
    else:
        lines.append(f"{begin:6d} |{drawn}|")


def layout_markdown(blocks: Sequence[BlockTable]) -> str:
    """Write one heading and one table a block."""
    parts = []
    for block in blocks:
        role = f", {clean(block.role)}" if block.role else ""
        table = markdown_table(HEADER, [row.cells() for row in block.rows], right=_RIGHT)
        title = block.title.replace("_", "\\_")
        parts.append("\n".join([f"### {title}", "", f"{block.size} bytes{role}", "", *table]) + "\n")
    return "\n".join(parts)


def layout_csv(blocks: Sequence[BlockTable]) -> str:
    """One table for all blocks, the block in the first column."""
    rows = [(block.title, *row.cells()[:2], row.name, *row.cells()[3:]) for block in blocks for row in block.rows]
    return csv_table(("block", *HEADER), rows)


def layout_json(blocks: Sequence[BlockTable], diagnostics: Sequence[dict[str, Any]], *, ok: bool) -> str:
    """Blocks with their members; offsets and sizes as numbers."""
    return dump(
        {
            **head("layout", ok=ok),
            "blocks": [
                {
                    "kind": block.kind,
                    "name": block.name,
                    "number": block.number,
                    "size": block.size,
                    "role": block.role,
                    "data": None if block.data is None else block.data.hex().upper(),
                    "members": [
                        {
                            "name": row.name,
                            "byte": row.byte,
                            "bit": row.bit,
                            "bits": row.bits,
                            "address": row.address,
                            "type": row.type,
                            "start": row.start,
                            "depth": row.depth,
                        }
                        for row in block.rows
                    ],
                }
                for block in blocks
            ],
            "diagnostics": list(diagnostics),
        }
    )
