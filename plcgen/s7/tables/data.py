"""Memory layouts as plain data."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from plcgen.base.display.data import diagnostic_data, head
from plcgen.s7.tables.tables import GAP, MORE, BlockTable, LayoutResult, LayoutRow


def layout_data(result: LayoutResult) -> dict[str, Any]:
    """Blocks with their members; offsets and sizes as numbers."""
    return {
        **head("layout", ok=result.ok),
        "blocks": [_block(block) for block in result.blocks],
        "diagnostics": [diagnostic_data(d) for d in result.diagnostics],
    }


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
        "members": [_member(row, path) for row, path in zip(block.rows, member_paths(block.rows), strict=True)],
        "unconfirmed_rules": {rule.key: rule.text for rule in block.rules},
    }


def member_paths(rows: Sequence[LayoutRow]) -> Iterator[str]:
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
        "role": row.role,
        "kind": row.kind,
        "unconfirmed": list(row.rules),
    }
