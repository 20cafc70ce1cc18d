"""Tables around the blocks: tags, watch tables, V5 symbols, import order, import guide and layout sheet."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator
from typing import Any

from plcgen.documents.document import RAW, Document
from plcgen.documents.spelling import encodable, literal
from plcgen.project.model import PlannedJob, Project, Telegram, Use
from plcgen.protocols.ds47.plan.fields import interface_type
from plcgen.protocols.ds47.views.blocks import extension, flag_name
from plcgen.protocols.ds47.views.jobs import newline, title
from plcgen.protocols.ds47.views.rows import telegram_rows
from plcgen.s7.types import ArrayType, Elementary


def tags(project: Project) -> list[dict[str, Any]]:
    """Absolute flags of all jobs as tags: name, type, address without %, comment."""
    return [
        {
            "name": flag_name(job, signal),
            "type": "Word" if address.width_bits > 1 else "Bool",
            "address": address.text(percent=False),
            "text": f"{signal}: {title(project, job)}",
        }
        for job in project.jobs
        for signal, address in job.trigger.items()
    ]


def all_tags(project: Project) -> list[dict[str, Any]]:
    """Flags of the drive jobs and of the PPI jobs."""
    if project.ppi is None:
        return tags(project)
    from plcgen.protocols.ppi.views.blocks import ppi_tags

    return [*tags(project), *ppi_tags(project)]


def watch_rows(project: Project, job: PlannedJob) -> list[dict[str, str]]:
    """Rows of a job's watch table: its command and results, then every member of its buffers."""
    rows: list[dict[str, str]] = []
    flags = dict(job.trigger.items())
    for signal in ("execute", "busy", "done", "error", "status"):
        address = flags.get(signal)
        name = (
            f'"{project.control_db.name}".{job.member}.{signal}' if address is None else f'"{flag_name(job, signal)}"'
        )
        rows.append(
            {
                "name": name,
                "address": "" if address is None else address.text(percent=False),
                "format": "Hex" if signal == "status" else "Bool",
                "modify": "TRUE" if signal == "execute" else "",
            }
        )
    for use in (*job.inputs, *job.outputs):
        type_ = interface_type(use.format, use.count, use.subindex, project.target)
        if isinstance(type_, Elementary):
            shown = {"REAL": "FloatingPoint", "LREAL": "FloatingPoint", "BOOL": "Bool"}.get(type_.name, "DEC")
            name = f'"{project.control_db.name}".{job.member}.{use.member}'
            rows.append({"name": name, "address": "", "format": shown, "modify": ""})
    for telegram in job.telegrams:
        for row in (row for side in telegram_rows(project, telegram) for row in side):
            rows += [dict(zip(("name", "address", "format", "modify"), line, strict=True)) for line in row.watch]
    return rows


def import_order(project: Project) -> list[str]:
    """Source files in the order a compiler wants them: types, data, called blocks, callers."""
    udt, db = extension(project, "udt"), extension(project, "db")
    types = [project.diagnostics_type, project.token_type] if project.jobs else []
    data = [token for token, _ in project.tokens]
    for job in project.jobs:
        for telegram in job.telegrams:
            types += [telegram.request_type, telegram.response_type]
            data += [telegram.request_db, telegram.response_db]
        data += list(job.record_instances or ())
    files = [f"udt/{block.name}.{udt}" for block in types] + [f"db/{block.name}.{db}" for block in data]
    if project.jobs:
        files.append(f"db/{project.control_db.name}.{db}")
    blocks = [f"scl/{job.block.name}.scl" for job in project.jobs]
    instances = [f"db/{job.instance.name}.{db}" for job in project.jobs]
    if project.ppi is not None:
        from plcgen.protocols.ppi.views import blocks as ppi_documents

        own_types, own_data, own_blocks, own_instances = ppi_documents.import_order(project)
        files = [*files[: len(types)], *own_types, *files[len(types) :], *own_data]
        blocks += own_blocks
        instances += own_instances
    return [*files, *blocks, *instances, "scl/Main.scl"]


def watch_document(job: PlannedJob, rows: list[dict[str, str]]) -> Document:
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
    if project.ppi is not None:
        from plcgen.protocols.ppi.views.tables import sheets as ppi_sheets

        masters = ppi_sheets(project)
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
    kinds = {job.instance: f"FB {job.block.number}" for job in project.jobs}
    for job in project.jobs:
        if job.record_instances:
            kinds[job.record_instances[0]], kinds[job.record_instances[1]] = "SFB 53", "SFB 52"
    if project.ppi is not None:
        from plcgen.protocols.ppi.views.tables import symbol_kinds

        kinds |= symbol_kinds(project)
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
    masters: dict[str, Any] = {"masters": [], "ppi_writes": [], "ppi_tags": [], "ppi_numbered": []}
    if project.ppi is not None:
        from plcgen.protocols.ppi.views.tables import import_view

        masters = import_view(project)
    return {
        **masters,
        "drives": bool(project.jobs),
        "project": project.name,
        "v5": where.v5,
        "t15": where.t15,
        "xml": where.xml_version,
        "toolchain": where.toolchain,
        "order": import_order(project),
        "tags": tags(project),
        "numbered": [block for job in project.jobs for t in job.telegrams for block in (t.request_db, t.response_db)],
        "writes": [_write_row(project, job, use) for job in project.jobs if job.write for use in job.uses],
    }


def _write_row(project: Project, job: PlannedJob, use: Use) -> dict[str, str]:
    return {
        "job": job.block.name,
        "drive": job.drive.key,
        "label": use.label,
        "title": use.parameter.title,
        "value": _values(project, use) if use.constant else "block input",
        "danger": use.parameter.dangerous,
    }


def _values(project: Project, use: Use) -> str:
    """A constant as a person reads it: the literals of its values, the first four of many."""
    type_ = interface_type(use.format, use.count, use.subindex, project.target)
    element = type_.element if isinstance(type_, ArrayType) else type_
    if not isinstance(element, Elementary):
        return use.data.hex(" ")
    step = max(1, element.bits // 8)
    pieces = [use.data[i : i + step] for i in range(0, len(use.data), step)]
    shown = ", ".join(literal(element, piece, v5=project.target.v5) for piece in pieces[:4])
    return shown + (", .." if len(pieces) > 4 else "")


def sheet(project: Project, job: PlannedJob) -> dict[str, Any]:
    """A job's part of the layout sheet."""
    blocks = []
    for telegram in job.telegrams:
        request, response = telegram_rows(project, telegram)
        for db, rows in ((telegram.request_db, request), (telegram.response_db, response)):
            blocks.append({"db": db, "rows": rows, "size": rows[-1].offset + rows[-1].size})
    return {
        "title": title(project, job),
        "block": job.block,
        "telegrams": [_telegram(telegram) for telegram in job.telegrams],
        "blocks": blocks,
    }


def _telegram(telegram: Telegram) -> dict[str, Any]:
    return {
        "hex": telegram.request.hex(" ").upper(),
        "length": len(telegram.request),
        "positive": telegram.positive_length,
        "longest": telegram.response_size,
    }
