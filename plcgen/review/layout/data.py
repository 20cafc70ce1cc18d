"""Memory layouts for other programs: CSV for a spreadsheet, JSON for tools."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from plcgen.output.json import dump, head
from plcgen.output.table import csv_table
from plcgen.review.layout.tables import GAP, MORE, BlockTable, LayoutRow

COLUMNS = (
    "block", "byte", "bit", "address", "level", "name", "type", "bits", "start value", "comment", "kind", "unconfirmed"
)  # fmt: skip


def layout_csv(blocks: Sequence[BlockTable], separator: str = ",") -> str:
    """One table for all blocks, the block in the first column, offsets and sizes as whole numbers.

    Byte and bit stand in columns of their own: a spreadsheet takes ``12.3`` for a date.
    """
    rows = [_csv_row(block, row) for block in blocks for row in block.rows]
    return csv_table(COLUMNS, rows, separator)


def _csv_row(block: BlockTable, row: LayoutRow) -> tuple[str, ...]:
    byte = "" if row.byte is None else str(row.byte)
    bit = "" if row.bit is None else str(row.bit)
    bits = "" if row.byte is None else str(row.bits)
    texts = {rule.key: rule.text for rule in block.rules}
    unconfirmed = ", ".join(texts.get(key, key) for key in row.rules)
    place = (block.title, byte, bit, row.address, str(row.depth))
    return (*place, row.name, row.type, bits, row.start, row.comment, row.kind, unconfirmed)


def layout_json(blocks: Sequence[BlockTable], diagnostics: Sequence[dict[str, Any]], *, ok: bool) -> str:
    """Blocks with their members; offsets and sizes as numbers."""
    return dump(
        {
            **head("layout", ok=ok),
            "blocks": [_block(block) for block in blocks],
            "diagnostics": list(diagnostics),
        }
    )


def _block(block: BlockTable) -> dict[str, Any]:
    return {
        "kind": block.kind,
        "name": block.name,
        "number": block.number,
        "size": block.size,
        "unused_bits": block.unused,
        "optimized": block.size is None,
        "role": block.role,
        "comment": block.comment,
        "file": block.file,
        "line": block.line,
        "data": None if block.data is None else block.data.hex().upper(),
        "members": [_member(row, path) for row, path in zip(block.rows, _paths(block.rows), strict=True)],
        "unconfirmed_rules": {rule.key: rule.text for rule in block.rules},
    }


def _paths(rows: Sequence[LayoutRow]) -> Iterator[str]:
    """``drive[1].speed`` for every member and element, empty for gaps and folds."""
    above: list[str] = []
    for row in rows:
        del above[row.depth :]
        if row.kind in {GAP, MORE}:
            yield ""
            continue
        parent = above[-1] if above else ""
        above.append(parent + row.name if row.name.startswith("[") or not parent else f"{parent}.{row.name}")
        yield above[-1]


def _member(row: LayoutRow, path: str) -> dict[str, Any]:
    return {
        "name": row.name,
        "path": path,
        "byte": row.byte,
        "bit": row.bit,
        "bits": None if row.byte is None else row.bits,
        "address": row.address,
        "type": row.type,
        "start": row.start,
        "depth": row.depth,
        "comment": row.comment,
        "kind": row.kind,
        "unconfirmed": list(row.rules),
    }
