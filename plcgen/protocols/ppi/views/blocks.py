"""Documents of PPI masters: types, telegram tables, response DBs, buffer, instance and control DB, watch tables."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from plcgen.documents.code import block_twins
from plcgen.documents.document import RAW, Document
from plcgen.documents.spelling import type_words
from plcgen.project.model import BlockRef, Project
from plcgen.protocols.ds47.views.blocks import document, extension, instance_template
from plcgen.protocols.ds47.views.rows import Row
from plcgen.protocols.ds47.views.tables import csv_text
from plcgen.protocols.ppi.plan.model import PlannedMaster, PlannedPpiJob, PpiTelegram
from plcgen.protocols.ppi.views.masters import (
    RECEIVE_LAST,
    SEND_BYTES,
    interface_row,
    job_title,
    master_document,
    master_title,
)
from plcgen.protocols.ppi.views.rows import answer_rows, table_rows
from plcgen.protocols.ppi.words import DIAGNOSTICS
from plcgen.s7.types import Elementary

SERIAL_NOTE = (
    "the call form of the blocks for serial modules is inferred; no genuine export was at hand to compare with"
)
SIGNALS = (
    ("execute", "BOOL", "a rising edge starts the job"),
    ("busy", "BOOL", "the job is running or waits for the port"),
    ("done", "BOOL", "the job ended well"),
    ("error", "BOOL", "the job failed"),
    ("status", "WORD", "result of the job"),
)


def ppi_documents(project: Project) -> Iterator[Document]:
    """Every source and table of every master."""
    plan = project.ppi
    if plan is None:
        return
    words = type_words(tia=not project.target.v5)
    fields = [{"name": name, "type": words[type_], "text": text, "start": ""} for name, type_, text in DIAGNOSTICS]
    name = plan.diagnostics_type.name
    yield document(
        project, f"udt/{name}.{extension(project, 'udt')}", "shared/type.udt.j2", {"name": name, "fields": fields}
    )
    for master in plan.masters:
        for telegram in master.telegrams:
            yield from _telegram_documents(project, master, telegram)
        yield from _own_documents(project, master)
        twins = block_twins(project, master.block, master.instance, SERIAL_NOTE)
        yield replace(master_document(project, master), twins=twins)
        yield Document(f"watch/{master.block.name}.csv", RAW, {"text": _watch_csv(project, master)})
    yield control_document(project)


def telegram_title(project: Project, master: PlannedMaster, telegram: PpiTelegram, which: str) -> str:
    """Title of a table or response DB."""
    job = next((job for job in master.jobs if telegram in job.telegrams), None)
    label = job_title(project, job) if job is not None else f"first frame to {telegram.station.key}"
    return f"{which}: {label}"


def _telegram_documents(project: Project, master: PlannedMaster, telegram: PpiTelegram) -> Iterator[Document]:
    rows = table_rows(project, telegram)
    type_ = telegram.request_type.name
    udt, db = extension(project, "udt"), extension(project, "db")
    yield document(project, f"udt/{type_}.{udt}", "shared/type.udt.j2", {"name": type_, "fields": rows})
    block = telegram.request_db.name
    title = telegram_title(project, master, telegram, "Telegram table")
    view: dict[str, Any] = {"name": block, "title": title, "type": type_, "assignments": start_values(rows)}
    yield document(project, f"db/{block}.{db}", "ppi/table.db.j2", {**view, "family": "PPI"})
    if telegram.response_db is None or telegram.response_type is None:
        return
    rows = answer_rows(project, telegram)
    type_, block = telegram.response_type.name, telegram.response_db.name
    yield document(project, f"udt/{type_}.{udt}", "shared/type.udt.j2", {"name": type_, "fields": rows})
    view = {"name": block, "title": telegram_title(project, master, telegram, "Response"), "fields": rows}
    yield document(project, f"db/{block}.{db}", "shared/data.db.j2", {**view, "assignments": (), "family": "PPI"})


def start_values(rows: list[Row]) -> list[dict[str, str]]:
    """Assignments of a table's start values: member below ``telegram``, literal, comment."""
    lines = []
    for row in rows:
        if row.start:
            lines.append({"path": row.name, "value": row.start, "text": row.text})
        lines += [{"path": f"{row.name}[{index}]", "value": text, "text": row.text} for index, text in row.subs]
    return lines


def _own_documents(project: Project, master: PlannedMaster) -> Iterator[Document]:
    """Buffer of the CP, instance DBs."""
    db = extension(project, "db")
    if master.buffer is not None:
        view = {"name": master.buffer.name, "title": f"Frames: {master_title(project, master)}", "assignments": ()}
        fields = [{**row, "start": ""} for row in buffer_rows(project)]
        path = f"db/{master.buffer.name}.{db}"
        yield document(project, path, "shared/data.db.j2", {**view, "fields": fields, "family": "PPI"})
    yield _instance(project, master.instance, f'"{master.block.name}"')
    if master.module_instances is not None:
        yield _instance(project, master.module_instances[0], '"P_SND_RK"')
        yield _instance(project, master.module_instances[1], '"P_RCV_RK"')


def buffer_rows(project: Project) -> list[dict[str, str]]:
    """Members of the buffer DB of a CP 341."""
    t = type_words(tia=not project.target.v5)
    kind = f"{t['ARRAY']}[0..{{}}] {t['OF']} {t['BYTE']}"
    return [
        {"name": "send", "type": kind.format(SEND_BYTES - 1), "text": "length and frame that P_SND_RK sends"},
        {"name": "receive", "type": kind.format(RECEIVE_LAST), "text": "frame that P_RCV_RK received"},
    ]


def _instance(project: Project, block: BlockRef, of: str) -> Document:
    path = f"db/{block.name}.{extension(project, 'db')}"
    return document(project, path, instance_template(project), {"name": block.name, "of": of, "family": "PPI"})


def control_document(project: Project) -> Document:
    """The control DB of all masters: one structure a job."""
    assert project.ppi is not None  # noqa: S101 - there is a master
    name = project.ppi.control_db.name
    jobs = [
        {"member": member, "title": job_title(project, job), "fields": control_fields(project, job)}
        for _, job, member in control_jobs(project)
    ]
    view = {"name": name, "jobs": jobs, "title": "Commands and results of all PPI jobs", "family": "PPI"}
    return document(project, f"db/{name}.{extension(project, 'db')}", "shared/control.db.j2", view)


def control_jobs(project: Project) -> list[tuple[PlannedMaster, PlannedPpiJob, str]]:
    """Jobs of all masters with their member of the control DB; with several masters it begins with the master."""
    masters = project.ppi.masters if project.ppi is not None else ()
    many = len(masters) > 1
    return [
        (master, job, f"{master.member}{job.member[:1].upper()}{job.member[1:]}" if many else job.member)
        for master in masters
        for job in master.jobs
    ]


def control_fields(project: Project, job: PlannedPpiJob) -> list[dict[str, str]]:
    """Members of a job's structure in the control DB: what no flag has, the values, the errors per address."""
    words = type_words(tia=not project.target.v5)
    absolute = {name for name, _ in job.trigger.items()}
    fields = []
    for name, type_, text in SIGNALS:
        if name in absolute:
            continue
        start = " := TRUE" if name == "execute" and job.cycle else ""
        shown = f"TRUE: the job runs every {job.cycle} ms" if name == "execute" and job.cycle else text
        fields.append({"name": name, "type": words[type_], "start": start, "text": shown})
    values = (*job.inputs, *job.outputs)
    fields += [dict(interface_row(project, job, value)) for value in values]
    if job.values:
        kind = f"{words['ARRAY']}[1..{len(job.values)}] {words['OF']} {words['WORD']}"
        fields.append(
            {"name": "errors", "type": kind, "start": "", "text": "per address: 0 = good, 16#80nn = return code nn"}
        )
    return fields


# --- calls, flags, watch tables -------------------------------------------------------------------------------


def flag_name(job: PlannedPpiJob, signal: str) -> str:
    """Tag name of an absolute flag."""
    return f"{job.member}{signal.capitalize()}"


def place(project: Project, job: PlannedPpiJob, member: str, signal: str) -> str:
    """Operand of a signal or value: its flag, else its member of the control DB."""
    assert project.ppi is not None  # noqa: S101 - there is a master
    if signal in dict(job.trigger.items()):
        return f'"{flag_name(job, signal)}"'
    return f'"{project.ppi.control_db.name}".{member}.{signal}'


def calls(project: Project) -> list[dict[str, Any]]:
    """Calls of all masters for the example OB1."""
    found = []
    for master in project.ppi.masters if project.ppi is not None else ():
        inputs, outputs = [], []
        for owner, job, member in control_jobs(project):
            if owner is not master:
                continue
            names = ["execute", *(value.member for value in job.inputs)]
            inputs += [f"{job.pin(name)} := {place(project, job, member, name)}" for name in names]
            names = ["busy", "done", "error", "status", *(value.member for value in job.outputs)]
            names += ["errors"] if job.values else []
            outputs += [(job.pin(name), place(project, job, member, name)) for name in names]
        found.append(
            {
                "title": master_title(project, master),
                "block": master.block.name,
                "instance": master.instance.name,
                "begin": "\n    ",
                "inputs": inputs,
                "outputs": outputs,
            }
        )
    return found


def ppi_tags(project: Project) -> list[dict[str, Any]]:
    """Absolute flags of all PPI jobs as tags."""
    return [
        {
            "name": flag_name(job, signal),
            "type": "Word" if address.width_bits > 1 else "Bool",
            "address": address.text(percent=False),
            "text": f"{signal}: {job_title(project, job)}",
        }
        for _, job, _ in control_jobs(project)
        for signal, address in job.trigger.items()
    ]


def watch_rows(project: Project, master: PlannedMaster) -> list[dict[str, str]]:
    """Rows of a master's watch table: every job's command and results, then tables and responses."""
    rows: list[dict[str, str]] = []

    def add(name: str, address: str, shown: str, modify: str = "") -> None:
        rows.append({"name": name, "address": address, "format": shown, "modify": modify})

    for owner, job, member in control_jobs(project):
        if owner is not master:
            continue
        flags = dict(job.trigger.items())
        for signal, _, _ in SIGNALS:
            address = flags.get(signal)
            shown = "Hex" if signal == "status" else "Bool"
            text = "" if address is None else address.text(percent=False)
            add(place(project, job, member, signal), text, shown, "TRUE" if signal == "execute" else "")
        for value in (*job.inputs, *job.outputs):
            if isinstance(value.type, Elementary):
                names = {"REAL": "FloatingPoint", "BOOL": "Bool", "BYTE": "Hex", "WORD": "Hex", "DWORD": "Hex"}
                add(place(project, job, member, value.member), "", names.get(value.type.name, "DEC"))
        for number in range(1, len(job.values) + 1):
            add(f"{place(project, job, member, 'errors')}[{number}]", "", "Hex")
    for telegram in master.telegrams:
        for row in (*table_rows(project, telegram), *answer_rows(project, telegram)):
            for line in row.watch:
                add(*line)
    return rows


def _watch_csv(project: Project, master: PlannedMaster) -> str:
    header = ("name", "address", "display format", "modify value")
    return csv_text(header, [list(row.values()) for row in watch_rows(project, master)])


def import_order(project: Project) -> tuple[list[str], list[str], list[str], list[str]]:
    """Source files of the masters: types, data, blocks, instance DBs."""
    plan = project.ppi
    if plan is None:
        return [], [], [], []
    udt, db = extension(project, "udt"), extension(project, "db")
    own = [block for master in plan.masters for block in master.module_instances or ()]
    return (
        [f"udt/{block.name}.{udt}" for block in master_types(project)],
        [f"db/{block.name}.{db}" for block in (*own, *master_data(project))],
        [f"scl/{master.block.name}.scl" for master in plan.masters],
        [f"db/{master.instance.name}.{db}" for master in plan.masters],
    )


def master_types(project: Project) -> list[BlockRef]:
    """Types of all masters."""
    plan = project.ppi
    if plan is None:
        return []
    pairs = [(t.request_type, t.response_type) for master in plan.masters for t in master.telegrams]
    return [plan.diagnostics_type, *(block for pair in pairs for block in pair if block is not None)]


def master_data(project: Project) -> list[BlockRef]:
    """Global data blocks of all masters."""
    plan = project.ppi
    if plan is None:
        return []
    found: list[BlockRef] = []
    for master in plan.masters:
        for telegram in master.telegrams:
            found += [ref for ref in (telegram.request_db, telegram.response_db) if ref is not None]
        found += [master.buffer] if master.buffer is not None else []
    return [*found, plan.control_db]
