"""Layout tables of a plan's telegram buffers and of blocks read from sources."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from plcgen.diagnostics import Diagnostic, DiagnosticError
from plcgen.report.layout import BlockTable, LayoutRow
from plcgen.s7.address import Address
from plcgen.s7.blocks import BlockKind
from plcgen.s7.layout import layout_block
from plcgen.s7.spelling import type_text
from plcgen.s7.types import ArrayType, Elementary, StructType

if TYPE_CHECKING:
    from plcgen.plan.model import Field, PlannedJob, Project
    from plcgen.s7.blocks import Block
    from plcgen.s7.layout import Entry


def project_tables(project: Project) -> list[BlockTable]:
    """Return request and response buffer of every telegram, offsets as DS47 demands them."""
    return [table for job in project.jobs for table in _job_tables(job, v5=project.target.v5)]


def _job_tables(job: PlannedJob, *, v5: bool) -> Iterator[BlockTable]:
    for number, telegram in enumerate(job.telegrams, 1):
        which = f" telegram {number}" if len(job.telegrams) > 1 else ""
        ref = telegram.request_db
        rows = tuple(_planned(field, ref.number, v5=v5, start=True) for field in telegram.request_fields)
        role = f"request of {job.key}{which}, LEN {len(telegram.request)}"
        yield BlockTable("DB", ref.name, ref.number, len(telegram.request), rows, role, telegram.request)
        ref = telegram.response_db
        rows = tuple(_planned(field, ref.number, v5=v5, start=False) for field in telegram.response_fields)
        lengths = f"positive {telegram.positive_length}, negative {telegram.negative_length} bytes"
        role = f"response of {job.key}{which}, {lengths}"
        yield BlockTable("DB", ref.name, ref.number, telegram.response_size, rows, role)


def _planned(field: Field, db: int, *, v5: bool, start: bool) -> LayoutRow:
    from plcgen.s7.spelling import spell
    from plcgen.s7.values import unpack_value

    text = ""
    if start and isinstance(field.type, Elementary):
        text = spell(unpack_value(field.data, field.type), field.type, v5=v5)
    elif start and any(field.data):
        text = field.data.hex(" ").upper()
    bits = 8 * field.size
    address = _address(db, field.offset, None, bits if isinstance(field.type, Elementary) else 0)
    return LayoutRow(field.offset, None, bits, address, field.name, type_text(field.type), text)


def _address(db: int | None, byte: int, bit: int | None, bits: int) -> str:
    """``DB3.DBW6``; ``DBW6`` without a number; larger members show their first byte."""
    place = Address("DB", db, byte, bit, bits if bits in {1, 8, 16, 32} else 8).text()
    return place if db is not None else place.partition(".")[2]


def block_tables(blocks: Sequence[Block], types: Mapping[str, Block]) -> tuple[list[BlockTable], list[Diagnostic]]:
    """Lay out every DB, UDT and FB; blocks without memory of their own are left out."""
    tables: list[BlockTable] = []
    found: list[Diagnostic] = []
    for block in blocks:
        if block.kind in {BlockKind.DB, BlockKind.UDT, BlockKind.FB}:
            try:
                tables.append(_declared(block, types))
            except DiagnosticError as problem:
                found += problem.diagnostics
    return tables, list(dict.fromkeys(found))


def _declared(block: Block, types: Mapping[str, Block]) -> BlockTable:
    layout = layout_block(block, types)
    begin = {assignment.path.lower(): assignment.literal for assignment in block.assignments}
    in_db = block.kind is BlockKind.DB
    rows = tuple(_entry(entry, block.number, begin, in_db=in_db) for entry in layout.entries)
    role = "optimised access: the CPU arranges it differently" if block.optimized else ""
    return BlockTable(block.kind.value, block.name, block.number, layout.size, rows, role)


def _entry(entry: Entry, db: int | None, begin: Mapping[str, str], *, in_db: bool) -> LayoutRow:
    bit = entry.bit if entry.size == 1 and not isinstance(entry.type, ArrayType | StructType) else None
    name = entry.path if entry.depth == 0 else entry.path.rpartition(".")[2]
    width = entry.size if isinstance(entry.type, Elementary) else 0
    address = _address(db, entry.byte, bit, width) if in_db else ""
    start = begin.get(entry.path.lower(), entry.member.start or "")
    return LayoutRow(entry.byte, bit, entry.size, address, name, type_text(entry.type), start, entry.depth)
