"""Documents of UDTs, buffer DBs, instance DBs, the drives' tokens, the control DB and the example OB1."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from plcgen.documents.document import Document
from plcgen.documents.spelling import type_words
from plcgen.project.nouns import BlockRef, Frame, Project
from plcgen.protocols.ds47.plan.nouns import DriveJob, DrivePlan
from plcgen.protocols.ds47.views.jobs import interface_row, source, title
from plcgen.protocols.ds47.views.rows import telegram_rows
from plcgen.protocols.ppi.plan.nouns import PpiPlan

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


def extension(plan: Frame, kind: str) -> str:
    """File name ending of a source: STEP 7 V5 knows only .scl."""
    return "scl" if plan.target.v5 else kind


def document(plan: Frame, path: str, template: str, view: dict[str, Any]) -> Document:
    """A source document of drive jobs."""
    return source(plan, path, template, {"family": "DS47", **view})


def shared_documents(plan: DrivePlan) -> Iterator[Document]:
    """Types and tokens that every job of the project uses."""
    for block, rows in ((plan.diagnostics_type, DIAGNOSTICS), (plan.token_type, TOKEN)):
        shared: dict[str, Any] = {"name": block.name, "fields": _rows(plan, rows)}
        yield document(plan, f"udt/{block.name}.{extension(plan, 'udt')}", "shared/type.udt.j2", shared)
    for token, drives in plan.tokens:
        view: dict[str, Any] = {
            "name": token.name,
            "title": f"Which job uses {', '.join(drive.key for drive in drives[:3])}",
            "fields": _rows(plan, TOKEN),
            "assignments": (),
        }
        yield document(plan, f"db/{token.name}.{extension(plan, 'db')}", "shared/data.db.j2", view)


def _rows(plan: DrivePlan, rows: tuple[tuple[str, str, str], ...]) -> list[dict[str, str]]:
    words = type_words(tia=not plan.target.v5)
    return [{"name": name, "type": words[type_], "text": text, "start": ""} for name, type_, text in rows]


def job_documents(plan: DrivePlan, job: DriveJob) -> Iterator[Document]:
    """Types, buffers and instance DBs of one job."""
    label = title(plan, job)
    for telegram in job.telegrams:
        request, response = telegram_rows(plan, telegram)
        for which, block, type_block, rows in (
            ("Request", telegram.request.db, telegram.request.type, request),
            ("Response", telegram.response.db, telegram.response.type, response),
        ):
            path = f"udt/{type_block.name}.{extension(plan, 'udt')}"
            yield document(plan, path, "shared/type.udt.j2", {"name": type_block.name, "fields": rows})
            view = {
                "name": block.name,
                "title": f"{which}: {label}",
                "fields": rows,
                "assignments": [
                    {"path": f"{row.name}[{index}]", "value": text} for row in rows for index, text in row.subs
                ],
            }
            yield document(plan, f"db/{block.name}.{extension(plan, 'db')}", "shared/data.db.j2", view)
    yield _instance(plan, job.instance, f'"{job.block.name}"')
    if job.record_instances:
        yield _instance(plan, job.record_instances[0], "SFB53")
        yield _instance(plan, job.record_instances[1], "SFB52")


def _instance(plan: DrivePlan, block: BlockRef, of: str) -> Document:
    path = f"db/{block.name}.{extension(plan, 'db')}"
    return document(plan, path, instance_template(plan), {"name": block.name, "of": of})


def instance_template(plan: Frame) -> str:
    """Template of an instance DB."""
    return "shared/instance_v5.db.j2" if plan.target.v5 else "shared/instance.db.j2"


def control_document(plan: DrivePlan) -> Document:
    """The control DB: one structure a job, for the caller and the HMI."""
    path = f"db/{plan.control_db.name}.{extension(plan, 'db')}"
    jobs = [{"member": job.member, "title": title(plan, job), "fields": control_fields(plan, job)} for job in plan.jobs]
    view = {"name": plan.control_db.name, "title": "Commands and results of all drive jobs", "jobs": jobs}
    return document(plan, path, "shared/control.db.j2", view)


def control_fields(plan: DrivePlan, job: DriveJob) -> list[dict[str, str]]:
    """Members of a job's structure in the control DB: what the trigger does not place in flags, and the values."""
    words = type_words(tia=not plan.target.v5)
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
    fields += [interface_row(plan, use, start=True) for use in job.inputs]
    return fields + [interface_row(plan, use, start=False) for use in job.outputs]


def main_document(project: Project) -> Document:
    """The example OB1 that calls every job."""
    plan, ppi = project.plan(DrivePlan), project.plan(PpiPlan)
    control = plan.control_db.name if plan else ""
    jobs = []
    for job in plan.jobs if plan else ():
        flags = dict(job.trigger.items())

        def place(signal: str, job: DriveJob = job, flags: dict[str, Any] = flags) -> str:
            if signal in flags:
                return f'"{flag_name(job, signal)}"'
            return f'"{control}".{job.member}.{signal}'

        outputs = ["busy", "done", "error", "status", *(use.member for use in job.outputs)]
        jobs.append(
            {
                "title": title(plan, job) if plan else "",
                "block": job.block.name,
                "instance": job.instance.name,
                "begin": "",
                "inputs": [f"{name} := {place(name)}" for name in ("execute", *(use.member for use in job.inputs))],
                "outputs": [(name, place(name)) for name in outputs],
            }
        )
    masters: list[dict[str, Any]] = []
    if ppi is not None:
        from plcgen.protocols.ppi.views.blocks import calls

        masters = calls(ppi)
    view = {
        "block": "OB1" if project.target.v5 else '"Main"',
        "title": f"Example: calls of all {'drive jobs' if not masters else 'jobs'}",
        "family": "DS47" if jobs else "PPI",
        "start_information": project.target.classic,
        "calls": [*jobs, *masters],
        "call_form": "shared/call_v5.scl.j2" if project.target.v5 else "shared/call.scl.j2",
    }
    return document(project, "scl/Main.scl", "shared/main.scl.j2", view)


def flag_name(job: DriveJob, signal: str) -> str:
    """Tag name of an absolute flag."""
    return f"{job.member}{signal.capitalize()}"
