"""Tables around the blocks: tags, watch tables, V5 symbols, import order, import guide and layout sheet."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator
from typing import Any

from plcgen.documents.document import RAW, Document
from plcgen.documents.spelling import encodable, literal
from plcgen.project.nouns import Project
from plcgen.protocols.ds47.plan.fields import interface_type
from plcgen.protocols.ds47.plan.nouns import DriveJob, DrivePlan, DriveTelegram, Use
from plcgen.protocols.ds47.views.blocks import extension, flag_name
from plcgen.protocols.ds47.views.jobs import newline, title
from plcgen.protocols.ds47.views.rows import telegram_rows
from plcgen.protocols.ppi.plan.nouns import PpiPlan
from plcgen.s7.types import ArrayType, Elementary


def tags(plan: DrivePlan) -> list[dict[str, Any]]:
    """Absolute flags of all jobs as tags: name, type, address without %, comment."""
    return [
        {
            "name": flag_name(job, signal),
            "type": "Word" if address.width_bits > 1 else "Bool",
            "address": address.text(percent=False),
            "text": f"{signal}: {title(plan, job)}",
        }
        for job in plan.jobs
        for signal, address in job.trigger.items()
    ]


def all_tags(project: Project) -> list[dict[str, Any]]:
    """Flags of the drive jobs and of the PPI jobs."""
    from plcgen.protocols.ppi.views.blocks import ppi_tags

    drives, ppi = project.plan(DrivePlan), project.plan(PpiPlan)
    return [*(tags(drives) if drives else ()), *(ppi_tags(ppi) if ppi else ())]


def watch_rows(plan: DrivePlan, job: DriveJob) -> list[dict[str, str]]:
    """Rows of a job's watch table: its command and results, then every member of its buffers."""
    rows: list[dict[str, str]] = []
    flags = dict(job.trigger.items())
    for signal in ("execute", "busy", "done", "error", "status"):
        address = flags.get(signal)
        name = f'"{plan.control_db.name}".{job.member}.{signal}' if address is None else f'"{flag_name(job, signal)}"'
        rows.append(
            {
                "name": name,
                "address": "" if address is None else address.text(percent=False),
                "format": "Hex" if signal == "status" else "Bool",
                "modify": "TRUE" if signal == "execute" else "",
            }
        )
    for use in (*job.inputs, *job.outputs):
        type_ = interface_type(use.format, use.count, use.subindex, plan.target)
        if isinstance(type_, Elementary):
            shown = {"REAL": "FloatingPoint", "LREAL": "FloatingPoint", "BOOL": "Bool"}.get(type_.name, "DEC")
            name = f'"{plan.control_db.name}".{job.member}.{use.member}'
            rows.append({"name": name, "address": "", "format": shown, "modify": ""})
    for telegram in job.telegrams:
        for row in (row for side in telegram_rows(plan, telegram) for row in side):
            rows += [dict(zip(("name", "address", "format", "modify"), line, strict=True)) for line in row.watch]
    return rows


def import_order(project: Project) -> list[str]:
    """Source files in the order a compiler wants them: types, data, called blocks, callers."""
    plan, ppi = project.plan(DrivePlan), project.plan(PpiPlan)
    udt, db = extension(project, "udt"), extension(project, "db")
    jobs = plan.jobs if plan else ()
    types = [plan.diagnostics_type, plan.token_type] if plan and jobs else []
    data = [token for token, _ in plan.tokens] if plan else []
    for job in jobs:
        for telegram in job.telegrams:
            types += [telegram.request.type, telegram.response.type]
            data += [telegram.request.db, telegram.response.db]
        data += list(job.record_instances or ())
    files = [f"udt/{block.name}.{udt}" for block in types] + [f"db/{block.name}.{db}" for block in data]
    if plan and jobs:
        files.append(f"db/{plan.control_db.name}.{db}")
    blocks = [f"scl/{job.block.name}.scl" for job in jobs]
    instances = [f"db/{job.instance.name}.{db}" for job in jobs]
    if ppi is not None:
        from plcgen.protocols.ppi.views import blocks as ppi_documents

        own_types, own_data, own_blocks, own_instances = ppi_documents.import_order(ppi)
        files = [*files[: len(types)], *own_types, *files[len(types) :], *own_data]
        blocks += own_blocks
        instances += own_instances
    return [*files, *blocks, *instances, "scl/Main.scl"]


def watch_document(job: DriveJob, rows: list[dict[str, str]]) -> Document:
    """A job's watch table as CSV."""
    text = csv_text(("name", "address", "display format", "modify value"), [list(row.values()) for row in rows])
    return Document(f"watch/{job.block.name}.csv", RAW, {"text": text})


def table_documents(project: Project, sheets: list[dict[str, Any]]) -> Iterator[Document]:
    """The STEP 7 V5 symbol table and compile order, the import guide and the layout sheet."""
    if project.target.v5:
        yield Document("symbols.sdf", RAW, {"text": _symbols(project)}, project.target.encoding, newline(project))
        sources = (path for path in import_order(project) if not path.endswith("/Main.scl"))
        order = "".join(f"{path.rsplit('/', 1)[1].removesuffix('.scl')}\n" for path in sources)
        yield Document("compile.inp", RAW, {"text": order}, project.target.encoding, newline(project))
    elif rows := all_tags(project):
        table = [[row["name"], row["type"], f"%{row['address']}", row["text"]] for row in rows]
        yield Document("tags.csv", RAW, {"text": csv_text(("Name", "Data Type", "Logical Address", "Comment"), table)})
    yield Document("IMPORT.md", "text/import.md.j2", _import_view(project))
    masters: list[dict[str, Any]] = []
    ppi = project.plan(PpiPlan)
    if ppi is not None:
        from plcgen.protocols.ppi.views.tables import sheets as ppi_sheets

        masters = ppi_sheets(ppi)
    view = {"project": project.name, "jobs": sheets, "masters": masters}
    yield Document("LAYOUT.md", "text/layout.md.j2", view)


def csv_text(header: tuple[str, ...], rows: list[list[str]]) -> str:
    """Rows as CSV with LF."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(header)
    writer.writerows(rows)
    return out.getvalue()


def _symbols(project: Project) -> str:
    out = io.StringIO()
    writer = csv.writer(out, quoting=csv.QUOTE_ALL, lineterminator="\n")
    plan, ppi = project.plan(DrivePlan), project.plan(PpiPlan)
    jobs = plan.jobs if plan else ()
    kinds = {job.instance: f"FB {job.block.number}" for job in jobs}
    for job in jobs:
        if job.record_instances:
            kinds[job.record_instances[0]], kinds[job.record_instances[1]] = "SFB 53", "SFB 52"
    if ppi is not None:
        from plcgen.protocols.ppi.views.tables import symbol_kinds

        kinds |= symbol_kinds(ppi)
        writer.writerow(("P_RCV_RK", "FB 7", "FB 7", "CP 341: receive"))
        writer.writerow(("P_SND_RK", "FB 8", "FB 8", "CP 341: send"))
    for block in project.blocks:
        address = f"{block.kind} {block.number}"
        writer.writerow((block.name, address, kinds.get(block, address), ""))
    for tag in all_tags(project):
        address = tag["address"]
        area = address.rstrip("0123456789.")
        text = tag["text"] if encodable(tag["text"], project.target) else ""
        writer.writerow((tag["name"], f"{area} {address[len(area) :]}", tag["type"].upper(), text[:80]))
    return out.getvalue()


def _import_view(project: Project) -> dict[str, Any]:
    where = project.target
    plan, ppi = project.plan(DrivePlan), project.plan(PpiPlan)
    jobs = plan.jobs if plan else ()
    masters: dict[str, Any] = {"masters": [], "ppi_writes": [], "ppi_tags": [], "ppi_numbered": []}
    if ppi is not None:
        from plcgen.protocols.ppi.views.tables import import_view

        masters = import_view(ppi)
    return {
        **masters,
        "drives": bool(jobs),
        "project": project.name,
        "v5": where.v5,
        "t15": where.t15,
        "xml": where.xml_version,
        "toolchain": where.toolchain,
        "order": import_order(project),
        "tags": tags(plan) if plan else [],
        "numbered": [block for job in jobs for t in job.telegrams for block in (t.request.db, t.response.db)],
        "writes": [_write_row(plan, job, use) for job in jobs if plan and job.writes for use in job.uses],
    }


def _write_row(plan: DrivePlan, job: DriveJob, use: Use) -> dict[str, str]:
    return {
        "job": job.block.name,
        "drive": job.drive.key,
        "label": use.label,
        "title": use.parameter.title,
        "value": _values(plan, use) if use.constant else "block input",
        "danger": use.parameter.dangerous,
    }


def _values(plan: DrivePlan, use: Use) -> str:
    """A constant as a person reads it: the literals of its values, the first four of many."""
    type_ = interface_type(use.format, use.count, use.subindex, plan.target)
    element = type_.element if isinstance(type_, ArrayType) else type_
    if not isinstance(element, Elementary):
        return use.data.hex(" ")
    step = max(1, element.bits // 8)
    pieces = [use.data[i : i + step] for i in range(0, len(use.data), step)]
    shown = ", ".join(literal(element, piece, v5=plan.target.v5) for piece in pieces[:4])
    return shown + (", .." if len(pieces) > 4 else "")


def sheet(plan: DrivePlan, job: DriveJob) -> dict[str, Any]:
    """A job's part of the layout sheet."""
    blocks = []
    for telegram in job.telegrams:
        request, response = telegram_rows(plan, telegram)
        for db, rows in ((telegram.request.db, request), (telegram.response.db, response)):
            blocks.append({"db": db, "rows": rows, "size": rows[-1].offset + rows[-1].size})
    return {
        "title": title(plan, job),
        "block": job.block,
        "telegrams": [_telegram(telegram) for telegram in job.telegrams],
        "blocks": blocks,
    }


def _telegram(telegram: DriveTelegram) -> dict[str, Any]:
    return {
        "hex": telegram.request.data.hex(" ").upper(),
        "length": len(telegram.request.data),
        "positive": telegram.positive_length,
        "longest": telegram.response.size,
    }
