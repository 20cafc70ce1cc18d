"""Documents of UDTs, buffer DBs, instance DBs, the drives' tokens, the control DB and the example OB1."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from plcgen.documents.document import Document
from plcgen.documents.spelling import type_words
from plcgen.project.model import BlockRef, PlannedJob, Project
from plcgen.protocols.ds47.views.jobs import interface_row, source, title
from plcgen.protocols.ds47.views.rows import telegram_rows

DIAGNOSTICS: tuple[tuple[str, str, str], ...] = (
    ("recordStatus", "DWORD", "STATUS of the last WRREC or RDREC that ended"),
    ("state", "INT", "state of the block, see its STATE constants"),
    ("telegram", "INT", "telegram of the job, from 1"),
    ("retries", "INT", "retries of this telegram"),
    ("requestReference", "BYTE", "request reference of this telegram"),
    ("responseLength", "INT", "length of the last response in bytes"),
    ("failedParameter", "INT", "first parameter the drive refused, 0 = none"),
)
TOKEN: tuple[tuple[str, str, str], ...] = (
    ("owner", "INT", "number of the job that uses the drive, 0 = free"),
    ("heartbeat", "INT", "counts in every call of the owner"),
    ("requestReference", "INT", "last request reference, 1..255"),
)


def extension(project: Project, kind: str) -> str:
    """File name ending of a source: STEP 7 V5 knows only .scl."""
    return "scl" if project.target.v5 else kind


def document(project: Project, path: str, template: str, view: dict[str, Any]) -> Document:
    """A source document of drive jobs."""
    return source(project, path, template, {"family": "DS47", **view})


def shared_documents(project: Project) -> Iterator[Document]:
    """Types and tokens that every job of the project uses."""
    for block, rows in ((project.diagnostics_type, DIAGNOSTICS), (project.token_type, TOKEN)):
        shared: dict[str, Any] = {"name": block.name, "fields": _rows(project, rows)}
        yield document(project, f"udt/{block.name}.{extension(project, 'udt')}", "shared/type.udt.j2", shared)
    for token, drives in project.tokens:
        view: dict[str, Any] = {
            "name": token.name,
            "title": f"Which job uses {', '.join(drive.key for drive in drives[:3])}",
            "fields": _rows(project, TOKEN),
            "assignments": (),
        }
        yield document(project, f"db/{token.name}.{extension(project, 'db')}", "shared/data.db.j2", view)


def _rows(project: Project, rows: tuple[tuple[str, str, str], ...]) -> list[dict[str, str]]:
    words = type_words(tia=not project.target.v5)
    return [{"name": name, "type": words[type_], "text": text, "start": ""} for name, type_, text in rows]


def job_documents(project: Project, job: PlannedJob) -> Iterator[Document]:
    """Types, buffers and instance DBs of one job."""
    label = title(project, job)
    for telegram in job.telegrams:
        request, response = telegram_rows(project, telegram)
        for which, block, type_block, rows in (
            ("Request", telegram.request_db, telegram.request_type, request),
            ("Response", telegram.response_db, telegram.response_type, response),
        ):
            path = f"udt/{type_block.name}.{extension(project, 'udt')}"
            yield document(project, path, "shared/type.udt.j2", {"name": type_block.name, "fields": rows})
            view = {
                "name": block.name,
                "title": f"{which}: {label}",
                "fields": rows,
                "assignments": [
                    {"path": f"{row.name}[{index}]", "value": text} for row in rows for index, text in row.subs
                ],
            }
            yield document(project, f"db/{block.name}.{extension(project, 'db')}", "shared/data.db.j2", view)
    yield _instance(project, job.instance, f'"{job.block.name}"')
    if job.record_instances:
        yield _instance(project, job.record_instances[0], "SFB53")
        yield _instance(project, job.record_instances[1], "SFB52")


def _instance(project: Project, block: BlockRef, of: str) -> Document:
    path = f"db/{block.name}.{extension(project, 'db')}"
    return document(project, path, instance_template(project), {"name": block.name, "of": of})


def instance_template(project: Project) -> str:
    """Template of an instance DB."""
    return "shared/instance_v5.db.j2" if project.target.v5 else "shared/instance.db.j2"


def control_document(project: Project) -> Document:
    """The control DB: one structure a job, for the caller and the HMI."""
    path = f"db/{project.control_db.name}.{extension(project, 'db')}"
    jobs = [
        {"member": job.member, "title": title(project, job), "fields": control_fields(project, job)}
        for job in project.jobs
    ]
    view = {"name": project.control_db.name, "title": "Commands and results of all drive jobs", "jobs": jobs}
    return document(project, path, "shared/control.db.j2", view)


def control_fields(project: Project, job: PlannedJob) -> list[dict[str, str]]:
    """Members of a job's structure in the control DB: what the trigger does not place in flags, and the values."""
    words = type_words(tia=not project.target.v5)
    absolute = {name for name, _ in job.trigger.items()}
    signals = (
        ("execute", "BOOL", "a rising edge starts the job"),
        ("busy", "BOOL", "the job is running"),
        ("done", "BOOL", "the job ended well"),
        ("error", "BOOL", "the job failed"),
        ("status", "WORD", "result of the job"),
    )
    fields = [
        {"name": name, "type": words[type_], "start": "", "text": text}
        for name, type_, text in signals
        if name not in absolute
    ]
    fields += [interface_row(project, use, start=True) for use in job.inputs]
    return fields + [interface_row(project, use, start=False) for use in job.outputs]


def main_document(project: Project) -> Document:
    """The example OB1 that calls every job."""
    jobs = []
    for job in project.jobs:
        flags = dict(job.trigger.items())

        def place(signal: str, job: PlannedJob = job, flags: dict[str, Any] = flags) -> str:
            if signal in flags:
                return f'"{flag_name(job, signal)}"'
            return f'"{project.control_db.name}".{job.member}.{signal}'

        outputs = ["busy", "done", "error", "status", *(use.member for use in job.outputs)]
        jobs.append(
            {
                "title": title(project, job),
                "block": job.block.name,
                "instance": job.instance.name,
                "begin": "",
                "inputs": [f"{name} := {place(name)}" for name in ("execute", *(use.member for use in job.inputs))],
                "outputs": [(name, place(name)) for name in outputs],
            }
        )
    masters: list[dict[str, Any]] = []
    if project.ppi is not None:
        from plcgen.protocols.ppi.views.blocks import calls

        masters = calls(project)
    view = {
        "block": "OB1" if project.target.v5 else '"Main"',
        "title": f"Example: calls of all {'drive jobs' if not masters else 'jobs'}",
        "family": "DS47" if jobs else "PPI",
        "start_information": project.target.classic,
        "calls": [*jobs, *masters],
        "call_form": "shared/call_v5.scl.j2" if project.target.v5 else "shared/call.scl.j2",
    }
    return document(project, "scl/Main.scl", "shared/main.scl.j2", view)


def flag_name(job: PlannedJob, signal: str) -> str:
    """Tag name of an absolute flag."""
    return f"{job.member}{signal.capitalize()}"
