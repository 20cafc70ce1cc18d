"""PPI masters in the tables around the blocks: symbols, import guide, layout sheet, SimaticML."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from plcgen.documents.document import Document
from plcgen.documents.simaticml import db_document, fixed_members, plain_member, tag_document, type_document, watch_xml
from plcgen.documents.spelling import literal
from plcgen.protocols.ds47.views.rows import Row
from plcgen.protocols.ppi.plan.nouns import PlannedMaster, PpiPlan, PpiTelegram
from plcgen.protocols.ppi.views.blocks import (
    buffer_rows,
    control_fields,
    control_jobs,
    ppi_tags,
    telegram_title,
    watch_rows,
)
from plcgen.protocols.ppi.views.masters import MODULES, job_title, master_title
from plcgen.protocols.ppi.views.rows import answer_rows, table_rows
from plcgen.protocols.ppi.words import DIAGNOSTICS
from plcgen.s7.types import Elementary

PPI_TAG_TABLE = "PpiJobTags"


def ppi_xml(plan: PpiPlan) -> Iterator[Document]:
    """Types, data blocks, watch and tag tables of all masters as SimaticML."""
    yield type_document(plan, plan.diagnostics_type, fixed_members(plan, DIAGNOSTICS), {})
    for master in plan.masters:
        for telegram in master.telegrams:
            rows = table_rows(plan, telegram)
            yield type_document(plan, telegram.request.type, rows, {})
            yield db_document(plan, telegram.request.db, [_expanded(plan, telegram, rows)], {})
            if telegram.response is not None:
                answer = answer_rows(plan, telegram)
                yield type_document(plan, telegram.response.type, answer, {})
                yield db_document(plan, telegram.response.db, answer, {})
        if master.buffer is not None:
            members = [plain_member(plan, r["name"], r["type"], r["text"]) for r in buffer_rows(plan)]
            yield db_document(plan, master.buffer, members, {})
        yield watch_xml(plan, master.block.name, watch_rows(plan, master))
    members = []
    for _, job, member in control_jobs(plan):
        inner = [
            plain_member(plan, row["name"], row["type"], row["text"], row["start"].removeprefix(" := "))
            for row in control_fields(plan, job)
        ]
        members.append({**plain_member(plan, member, "Struct", job_title(plan, job)), "members": inner})
    yield db_document(plan, plan.control_db, members, {})
    rows_of_tags = ppi_tags(plan)
    if rows_of_tags:
        yield tag_document(plan, PPI_TAG_TABLE, rows_of_tags)


def _expanded(plan: PpiPlan, telegram: PpiTelegram, rows: list[Row]) -> dict[str, Any]:
    """The member ``telegram`` of a table: a user type with the start values written out."""
    member = plain_member(plan, "telegram", f'"{telegram.request.type.name}"', "the telegram behind its length")
    return {**member, "expanded": rows}


def sheets(plan: PpiPlan) -> list[dict[str, Any]]:
    """Parts of the layout sheet, one a master."""
    found = []
    for master in plan.masters:
        blocks: list[dict[str, Any]] = []
        for telegram in master.telegrams:
            rows = table_rows(plan, telegram)
            blocks.append({"db": telegram.request.db, "rows": rows, "size": _size(rows)})
            if telegram.response is not None:
                rows = answer_rows(plan, telegram)
                blocks.append({"db": telegram.response.db, "rows": rows, "size": _size(rows)})
        telegrams = [
            {
                "title": telegram_title(plan, master, telegram, f"telegram {telegram.number}"),
                "hex": telegram.request.data.hex(" ").upper(),
                "length": len(telegram.request.data),
            }
            for telegram in master.telegrams
        ]
        found.append(
            {"title": master_title(plan, master), "block": master.block, "telegrams": telegrams, "blocks": blocks}
        )
    return found


def _size(rows: list[Row]) -> int:
    return rows[-1].offset + rows[-1].size


def symbol_kinds(plan: PpiPlan) -> dict[Any, str]:
    """What the instance DBs of the masters are instances of, as a STEP 7 V5 symbol table says it."""
    kinds: dict[Any, str] = {}
    for master in plan.masters:
        kinds[master.instance] = f"FB {master.block.number}"
        if master.module_instances is not None:
            kinds[master.module_instances[0]], kinds[master.module_instances[1]] = "FB 8", "FB 7"
    return kinds


def import_view(plan: PpiPlan) -> dict[str, Any]:
    """What the import guide says about masters."""
    masters = plan.masters
    return {
        "masters": [
            {
                "block": master.block.name,
                "module": MODULES[master.module],
                "baud": master.baud,
                "port": master.port,
                "gap_ms": max(4, -(-35_000 // master.baud)),
                "buffer": master.buffer,
            }
            for master in masters
        ],
        "ppi_writes": [row for master in masters for row in _writes(plan, master)],
        "ppi_tags": ppi_tags(plan),
        "ppi_numbered": [master.buffer for master in masters if master.buffer is not None],
    }


def _writes(plan: PpiPlan, master: PlannedMaster) -> Iterator[dict[str, str]]:
    for job in master.jobs:
        row = {"job": f"{master.block.name}, job {job.key}", "station": f"{job.station.key} ({job.station.address})"}
        if job.kind in {"run", "stop"}:
            yield {**row, "label": "CPU", "value": job.kind.upper()}
        for value in job.values if job.kind == "write" else ():
            text = "block input"
            if value.constant and isinstance(value.element, Elementary):
                text = literal(value.element, value.data[: value.size], v5=plan.target.v5)
            yield {**row, "label": value.label, "value": text}
