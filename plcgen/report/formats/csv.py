"""CSV for a spreadsheet."""

from __future__ import annotations

from typing import TYPE_CHECKING

from plcgen.base.display.table import csv_table
from plcgen.report.registry import OutputFormat

if TYPE_CHECKING:
    from plcgen.base.display.view import View
    from plcgen.s7.tables.tables import BlockTable, LayoutResult, LayoutRow

_BOM = "\ufeff"
COLUMNS = (
    "block", "byte", "bit", "address", "level", "name", "type", "bits", "start value", "comment", "kind", "unconfirmed"
)  # fmt: skip


def _layout(result: LayoutResult, view: View) -> str:
    """One table for all blocks, the block in the first column, offsets and sizes as whole numbers.

    Byte and bit stand in columns of their own: a spreadsheet takes ``12.3`` for a date, and a file without a mark
    for text of its own code page.
    """
    rows = [_csv_row(block, row) for block in result.blocks for row in block.rows]
    mark = _BOM if view.target == "file" else ""
    return mark + csv_table(COLUMNS, rows, view.separator)


def _csv_row(block: BlockTable, row: LayoutRow) -> tuple[str, ...]:
    byte = "" if row.byte is None else str(row.byte)
    bit = "" if row.bit is None else str(row.bit)
    bits = "" if row.byte is None else str(row.bits)
    texts = {rule.key: rule.text for rule in block.rules}
    unconfirmed = ", ".join(texts.get(key, key) for key in row.rules)
    place = (block.title, byte, bit, row.address, str(row.depth))
    return (*place, row.name, row.type, bits, row.start, row.comment, row.kind, unconfirmed)


FORMAT = OutputFormat(name="csv", complete=False, layout=_layout)
