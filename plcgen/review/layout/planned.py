"""Layout tables of the telegram buffers of a plan."""

from __future__ import annotations

from typing import TYPE_CHECKING

from plcgen.review.layout.tables import BlockTable, LayoutRow, member_address
from plcgen.s7.spelling import spell, type_text
from plcgen.s7.types import Elementary
from plcgen.s7.values import unpack_value

if TYPE_CHECKING:
    from plcgen.project.nouns import Buffer, BufferField, Project


def project_tables(project: Project) -> list[BlockTable]:
    """Every buffer of every telegram, offsets as the protocol demands them."""
    return [
        buffer_table(buffer, role, v5=project.target.v5)
        for plan in project.plans
        for buffer, role in plan.protocol.buffers(plan)
    ]


def buffer_table(buffer: Buffer[BufferField], role: str, *, v5: bool) -> BlockTable:
    """One buffer; the start values of a request are shown, those of a response are filled in by the partner."""
    rows = tuple(_row(field, buffer.home.number, v5=v5, start=bool(buffer.data)) for field in buffer.fields)
    data = buffer.image if buffer.data else None
    return BlockTable(buffer.home.kind, buffer.home.name, buffer.home.number, buffer.size, rows, role, data)


def _row(field: BufferField, db: int, *, v5: bool, start: bool) -> LayoutRow:
    text = ""
    if start and isinstance(field.type, Elementary):
        text = spell(unpack_value(field.data, field.type), field.type, v5=v5)
    elif start and any(field.data):
        text = field.data.hex(" ").upper()
    bits = 8 * field.size
    address = member_address(db, field.offset, None, bits if isinstance(field.type, Elementary) else 0)
    return LayoutRow(field.offset, None, bits, address, field.name, type_text(field.type), text)
