"""Layout tables of the telegram buffers of a plan."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from plcgen.build.sheet import Role
from plcgen.s7.tables.tables import BlockTable, LayoutRow, member_address
from plcgen.s7.types.data_types import Elementary
from plcgen.s7.types.literals import spell, type_text
from plcgen.s7.types.values import unpack_value

if TYPE_CHECKING:
    from plcgen.build.sheet import ExchangeSheet, MessageField
    from plcgen.project.nouns import Buffer, BufferField, Project


def project_tables(project: Project) -> list[BlockTable]:
    """Every buffer of every telegram, offsets as the protocol demands them, with what its members mean."""
    return [
        buffer_table(buffer, role, _explained(sheet.exchanges, buffer), v5=project.target.v5)
        for plan in project.plans
        for sheet in [plan.protocol.review_sheet(plan)]
        for buffer, role in plan.protocol.buffers(plan)
    ]


def _explained(exchanges: Sequence[ExchangeSheet], buffer: Buffer[BufferField]) -> dict[int, MessageField]:
    """What the protocol says about the members of a buffer, by offset; the first telegram in it counts."""
    found: dict[int, MessageField] = {}
    for exchange in exchanges:
        for message in (exchange.request, *exchange.answers):
            if message.home == buffer.home:
                found = {field.offset: field for field in message.fields} | found
    return found


def buffer_table(
    buffer: Buffer[BufferField], role: str, explained: Mapping[int, MessageField] | None = None, *, v5: bool
) -> BlockTable:
    """One buffer; the start values of a request are shown, those of a response are filled in by the partner."""
    starts = bool(buffer.data)
    rows = tuple(
        _row(field, buffer, (explained or {}).get(field.offset), v5=v5, start=starts) for field in buffer.fields
    )
    data = buffer.image if buffer.data else None
    return BlockTable(buffer.home.kind, buffer.home.name, buffer.home.number, buffer.size, rows, role, data)


def _row(
    field: BufferField, buffer: Buffer[BufferField], told: MessageField | None, *, v5: bool, start: bool
) -> LayoutRow:
    text = ""
    if start and isinstance(field.type, Elementary):
        text = spell(unpack_value(field.data, field.type), field.type, v5=v5)
    elif start and any(field.data):
        text = field.data.hex(" ").upper()
    bits = 8 * field.size
    width = bits if isinstance(field.type, Elementary) else 0
    address = member_address(buffer.db.number, field.offset, None, width) if buffer.db is not None else ""
    meaning, role = (told.meaning, told.role) if told is not None and told.name == field.name else ("", Role.SPARE)
    return LayoutRow(
        field.offset, None, bits, address, field.name, type_text(field.type), text, comment=meaning, role=role.value
    )
