"""Layout tables of the telegram buffers of a plan."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from plcgen.review.layout.tables import BlockTable, LayoutRow, member_address
from plcgen.s7.spelling import type_text
from plcgen.s7.types import Elementary

if TYPE_CHECKING:
    from plcgen.project.model import Field, PlannedJob, Project
    from plcgen.protocols.ppi.plan.model import PlannedMaster, PpiField


def project_tables(project: Project) -> list[BlockTable]:
    """Return request and response buffer of every telegram, offsets as DS47 or PPI demands them."""
    tables = [table for job in project.jobs for table in _job_tables(job, v5=project.target.v5)]
    masters = project.ppi.masters if project.ppi is not None else ()
    return tables + [t for master in masters for t in _master_tables(master, v5=project.target.v5)]


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


def _master_tables(master: PlannedMaster, *, v5: bool) -> Iterator[BlockTable]:
    for telegram in master.telegrams:
        job = next((job for job in master.jobs if telegram in job.telegrams), None)
        which = f" telegram {job.telegrams.index(telegram) + 1}" if job and len(job.telegrams) > 1 else ""
        whose = f"{job.key}{which}" if job else f"the first frame to {telegram.station.key}"
        ref = telegram.request_db
        image = bytes((len(telegram.request),)) + telegram.request
        rows = tuple(_planned(field, ref.number, v5=v5, start=True) for field in telegram.request_fields)
        role = f"telegram table of {whose}: its length, then {len(telegram.request)} bytes"
        yield BlockTable("DB", ref.name, ref.number, len(image), rows, role, image)
        if telegram.response_db is not None:
            ref = telegram.response_db
            rows = tuple(_planned(field, ref.number, v5=v5, start=False) for field in telegram.response_fields)
            size = telegram.response_fields[-1].offset + telegram.response_fields[-1].size
            yield BlockTable("DB", ref.name, ref.number, size, rows, f"response of {whose}, as if every item is good")


def _planned(field: Field | PpiField, db: int, *, v5: bool, start: bool) -> LayoutRow:
    from plcgen.s7.spelling import spell
    from plcgen.s7.values import unpack_value

    text = ""
    if start and isinstance(field.type, Elementary):
        text = spell(unpack_value(field.data, field.type), field.type, v5=v5)
    elif start and any(field.data):
        text = field.data.hex(" ").upper()
    bits = 8 * field.size
    address = member_address(db, field.offset, None, bits if isinstance(field.type, Elementary) else 0)
    return LayoutRow(field.offset, None, bits, address, field.name, type_text(field.type), text)
