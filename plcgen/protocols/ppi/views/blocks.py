"""Documents of PPI masters: types, telegram tables, response DBs, buffer, instance and control DB, watch tables."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from plcgen.documents.code import block_twins
from plcgen.documents.document import RAW, Document
from plcgen.documents.spelling import type_words
from plcgen.project.nouns import BlockRef
from plcgen.protocols.ds47.views.blocks import document, extension, instance_template
from plcgen.protocols.ds47.views.rows import Row
from plcgen.protocols.ds47.views.tables import csv_text
from plcgen.protocols.ppi.plan.nouns import PlannedMaster, PpiJob, PpiPlan, PpiTelegram
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


def ppi_documents(plan: PpiPlan) -> Iterator[Document]:
    """Every source and table of every master."""
    words = type_words(tia=not plan.target.v5)
    fields = [{"name": name, "type": words[type_], "text": text, "start": ""} for name, type_, text in DIAGNOSTICS]
    name = plan.diagnostics_type.name
    yield document(plan, f"udt/{name}.{extension(plan, 'udt')}", "shared/type.udt.j2", {"name": name, "fields": fields})
    for master in plan.masters:
        for telegram in master.telegrams:
            yield from _telegram_documents(plan, master, telegram)
        yield from _own_documents(plan, master)
        twins = block_twins(plan, master.block, master.instance, SERIAL_NOTE)
        yield replace(master_document(plan, master), twins=twins)
        yield Document(f"watch/{master.block.name}.csv", RAW, {"text": _watch_csv(plan, master)})
    yield control_document(plan)


def telegram_title(plan: PpiPlan, master: PlannedMaster, telegram: PpiTelegram, which: str) -> str:
    """Title of a table or response DB."""
    job = next((job for job in master.jobs if telegram in job.telegrams), None)
    label = job_title(plan, job) if job is not None else f"first frame to {telegram.station.key}"
    return f"{which}: {label}"


def _telegram_documents(plan: PpiPlan, master: PlannedMaster, telegram: PpiTelegram) -> Iterator[Document]:
    rows = table_rows(plan, telegram)
    type_ = telegram.request.type.name
    udt, db = extension(plan, "udt"), extension(plan, "db")
    yield document(plan, f"udt/{type_}.{udt}", "shared/type.udt.j2", {"name": type_, "fields": rows})
    block = telegram.request.db.name
    title = telegram_title(plan, master, telegram, "Telegram table")
    view: dict[str, Any] = {"name": block, "title": title, "type": type_, "assignments": start_values(rows)}
    yield document(plan, f"db/{block}.{db}", "ppi/table.db.j2", {**view, "family": "PPI"})
    if telegram.response is None:
        return
    rows = answer_rows(plan, telegram)
    type_, block = telegram.response.type.name, telegram.response.db.name
    yield document(plan, f"udt/{type_}.{udt}", "shared/type.udt.j2", {"name": type_, "fields": rows})
    view = {"name": block, "title": telegram_title(plan, master, telegram, "Response"), "fields": rows}
    yield document(plan, f"db/{block}.{db}", "shared/data.db.j2", {**view, "assignments": (), "family": "PPI"})


def start_values(rows: list[Row]) -> list[dict[str, str]]:
    """Assignments of a table's start values: member below ``telegram``, literal, comment."""
    lines = []
    for row in rows:
        if row.start:
            lines.append({"path": row.name, "value": row.start, "text": row.text})
        lines += [{"path": f"{row.name}[{index}]", "value": text, "text": row.text} for index, text in row.subs]
    return lines


def _own_documents(plan: PpiPlan, master: PlannedMaster) -> Iterator[Document]:
    """Buffer of the CP, instance DBs."""
    db = extension(plan, "db")
    if master.buffer is not None:
        view = {"name": master.buffer.name, "title": f"Frames: {master_title(plan, master)}", "assignments": ()}
        fields = [{**row, "start": ""} for row in buffer_rows(plan)]
        path = f"db/{master.buffer.name}.{db}"
        yield document(plan, path, "shared/data.db.j2", {**view, "fields": fields, "family": "PPI"})
    yield _instance(plan, master.instance, f'"{master.block.name}"')
    if master.module_instances is not None:
        yield _instance(plan, master.module_instances[0], '"P_SND_RK"')
        yield _instance(plan, master.module_instances[1], '"P_RCV_RK"')


def buffer_rows(plan: PpiPlan) -> list[dict[str, str]]:
    """Members of the buffer DB of a CP 341."""
    t = type_words(tia=not plan.target.v5)
    kind = f"{t['ARRAY']}[0..{{}}] {t['OF']} {t['BYTE']}"
    return [
        {"name": "send", "type": kind.format(SEND_BYTES - 1), "text": "length and frame that P_SND_RK sends"},
        {"name": "receive", "type": kind.format(RECEIVE_LAST), "text": "frame that P_RCV_RK received"},
    ]


def _instance(plan: PpiPlan, block: BlockRef, of: str) -> Document:
    path = f"db/{block.name}.{extension(plan, 'db')}"
    return document(plan, path, instance_template(plan), {"name": block.name, "of": of, "family": "PPI"})


def control_document(plan: PpiPlan) -> Document:
    """The control DB of all masters: one structure a job."""
    name = plan.control_db.name
    jobs = [
        {"member": member, "title": job_title(plan, job), "fields": control_fields(plan, job)}
        for _, job, member in control_jobs(plan)
    ]
    view = {"name": name, "jobs": jobs, "title": "Commands and results of all PPI jobs", "family": "PPI"}
    return document(plan, f"db/{name}.{extension(plan, 'db')}", "shared/control.db.j2", view)


def control_jobs(plan: PpiPlan) -> list[tuple[PlannedMaster, PpiJob, str]]:
    """Jobs of all masters with their member of the control DB; with several masters it begins with the master."""
    masters = plan.masters
    many = len(masters) > 1
    return [
        (master, job, f"{master.member}{job.member[:1].upper()}{job.member[1:]}" if many else job.member)
        for master in masters
        for job in master.jobs
    ]


def control_fields(plan: PpiPlan, job: PpiJob) -> list[dict[str, str]]:
    """Members of a job's structure in the control DB: what no flag has, the values, the errors per address."""
    words = type_words(tia=not plan.target.v5)
    absolute = {name for name, _ in job.trigger.items()}
    fields = []
    for name, type_, text in SIGNALS:
        if name in absolute:
            continue
        start = " := TRUE" if name == "execute" and job.cycle else ""
        shown = f"TRUE: the job runs every {job.cycle} ms" if name == "execute" and job.cycle else text
        fields.append({"name": name, "type": words[type_], "start": start, "text": shown})
    values = (*job.inputs, *job.outputs)
    fields += [dict(interface_row(plan, job, value)) for value in values]
    if job.values:
        kind = f"{words['ARRAY']}[1..{len(job.values)}] {words['OF']} {words['WORD']}"
        fields.append(
            {"name": "errors", "type": kind, "start": "", "text": "per address: 0 = good, 16#80nn = return code nn"}
        )
    return fields


# --- calls, flags, watch tables -------------------------------------------------------------------------------


def flag_name(job: PpiJob, signal: str) -> str:
    """Tag name of an absolute flag."""
    return f"{job.member}{signal.capitalize()}"


def place(plan: PpiPlan, job: PpiJob, member: str, signal: str) -> str:
    """Operand of a signal or value: its flag, else its member of the control DB."""
    if signal in dict(job.trigger.items()):
        return f'"{flag_name(job, signal)}"'
    return f'"{plan.control_db.name}".{member}.{signal}'


def calls(plan: PpiPlan) -> list[dict[str, Any]]:
    """Calls of all masters for the example OB1."""
    found = []
    for master in plan.masters:
        inputs, outputs = [], []
        for owner, job, member in control_jobs(plan):
            if owner is not master:
                continue
            names = ["execute", *(value.member for value in job.inputs)]
            inputs += [f"{job.pin(name)} := {place(plan, job, member, name)}" for name in names]
            names = ["busy", "done", "error", "status", *(value.member for value in job.outputs)]
            names += ["errors"] if job.values else []
            outputs += [(job.pin(name), place(plan, job, member, name)) for name in names]
        found.append(
            {
                "title": master_title(plan, master),
                "block": master.block.name,
                "instance": master.instance.name,
                "begin": "\n    ",
                "inputs": inputs,
                "outputs": outputs,
            }
        )
    return found


def ppi_tags(plan: PpiPlan) -> list[dict[str, Any]]:
    """Absolute flags of all PPI jobs as tags."""
    return [
        {
            "name": flag_name(job, signal),
            "type": "Word" if address.width_bits > 1 else "Bool",
            "address": address.text(percent=False),
            "text": f"{signal}: {job_title(plan, job)}",
        }
        for _, job, _ in control_jobs(plan)
        for signal, address in job.trigger.items()
    ]


def watch_rows(plan: PpiPlan, master: PlannedMaster) -> list[dict[str, str]]:
    """Rows of a master's watch table: every job's command and results, then tables and responses."""
    rows: list[dict[str, str]] = []

    def add(name: str, address: str, shown: str, modify: str = "") -> None:
        rows.append({"name": name, "address": address, "format": shown, "modify": modify})

    for owner, job, member in control_jobs(plan):
        if owner is not master:
            continue
        flags = dict(job.trigger.items())
        for signal, _, _ in SIGNALS:
            address = flags.get(signal)
            shown = "Hex" if signal == "status" else "Bool"
            text = "" if address is None else address.text(percent=False)
            add(place(plan, job, member, signal), text, shown, "TRUE" if signal == "execute" else "")
        for value in (*job.inputs, *job.outputs):
            if isinstance(value.type, Elementary):
                names = {"REAL": "FloatingPoint", "BOOL": "Bool", "BYTE": "Hex", "WORD": "Hex", "DWORD": "Hex"}
                add(place(plan, job, member, value.member), "", names.get(value.type.name, "DEC"))
        for number in range(1, len(job.values) + 1):
            add(f"{place(plan, job, member, 'errors')}[{number}]", "", "Hex")
    for telegram in master.telegrams:
        for row in (*table_rows(plan, telegram), *answer_rows(plan, telegram)):
            for line in row.watch:
                add(*line)
    return rows


def _watch_csv(plan: PpiPlan, master: PlannedMaster) -> str:
    header = ("name", "address", "display format", "modify value")
    return csv_text(header, [list(row.values()) for row in watch_rows(plan, master)])


def import_order(plan: PpiPlan) -> tuple[list[str], list[str], list[str], list[str]]:
    """Source files of the masters: types, data, blocks, instance DBs."""
    udt, db = extension(plan, "udt"), extension(plan, "db")
    own = [block for master in plan.masters for block in master.module_instances or ()]
    return (
        [f"udt/{block.name}.{udt}" for block in master_types(plan)],
        [f"db/{block.name}.{db}" for block in (*own, *master_data(plan))],
        [f"scl/{master.block.name}.scl" for master in plan.masters],
        [f"db/{master.instance.name}.{db}" for master in plan.masters],
    )


def master_types(plan: PpiPlan) -> list[BlockRef]:
    """Types of all masters."""
    buffers = [buffer for master in plan.masters for t in master.telegrams for buffer in t.buffers]
    return [plan.diagnostics_type, *(buffer.type for buffer in buffers)]


def master_data(plan: PpiPlan) -> list[BlockRef]:
    """Global data blocks of all masters."""
    found: list[BlockRef] = []
    for master in plan.masters:
        for telegram in master.telegrams:
            found += [buffer.db for buffer in telegram.buffers]
        found += [master.buffer] if master.buffer is not None else []
    return [*found, plan.control_db]
