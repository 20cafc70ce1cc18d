"""What drive jobs contribute to the documents: shared types, tokens, function blocks, parts of the import guide."""

from __future__ import annotations

from functools import partial
from typing import Any

from plcgen.documents.members import fixed
from plcgen.documents.nouns import Contribution, DataBlock, GuidePart, TypeBlock
from plcgen.documents.spelling import literal
from plcgen.protocols.ds47 import guards
from plcgen.protocols.ds47.plan.fields import interface_type
from plcgen.protocols.ds47.plan.nouns import DriveJob, DrivePlan, Use
from plcgen.protocols.ds47.views.program import program
from plcgen.protocols.ds47.wire.bico import read_bico
from plcgen.s7.types import ArrayType, Elementary

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


def contribution(plan: DrivePlan) -> Contribution:
    """Everything of a plan with jobs."""
    token = fixed(plan, TOKEN)
    return Contribution(
        family="DS47",
        jobs="drive jobs",
        types=(TypeBlock(plan.diagnostics_type, fixed(plan, DIAGNOSTICS)), TypeBlock(plan.token_type, token)),
        data=[
            DataBlock(
                block, f"Which job uses {', '.join(drive.key for drive in drives[:3])}", token, (), drives[0].comment
            )
            for block, drives in plan.tokens
        ],
        programs=(program(plan, job) for job in plan.jobs),
        control=plan.control_db,
        control_title="Commands and results of all drive jobs",
        tag_table="DriveJobTags",
        guide=partial(_guide, plan),
        manifest=partial(_manifest, plan),
        system_blocks=("SFB52", "SFB53"),
    )


def _guide(plan: DrivePlan) -> tuple[list[GuidePart], list[GuidePart]]:
    """Numbers of the buffers; what is written."""
    numbered = [buffer.db for job in plan.jobs for telegram in job.telegrams for buffer in telegram.buffers]
    writes = [_write_row(plan, job, use) for job in plan.jobs if job.writes for use in job.uses]
    before: list[GuidePart] = [("ds47/import.md.j2", {"numbered": numbered})]
    return before, [("ds47/import_writes.md.j2", {"writes": writes})] if writes else []


def _write_row(plan: DrivePlan, job: DriveJob, use: Use) -> dict[str, Any]:
    danger = job.drive.device.danger(use.parameter.pnu)
    signed = plan.sign_off(job, use.parameter.pnu) if danger else None
    return {
        "job": job.block.name,
        "drive": job.drive.key,
        "label": use.label,
        "title": use.parameter.title,
        "value": _values(plan, use) if use.constant else "block input",
        "note": f"{danger}; signed off: {signed}".replace("|", "\\|") if danger else "",
        "safety": use.parameter.pnu in guards.SAFETY,
    }


def _values(plan: DrivePlan, use: Use) -> str:
    """A constant as a person reads it: the literals of its values, the first four of many."""
    type_ = interface_type(use.format, use.count, use.subindex, plan.target)
    element = type_.element if isinstance(type_, ArrayType) else type_
    if not isinstance(element, Elementary):
        return use.data.hex(" ")
    step = max(1, element.bits // 8)
    pieces = [use.data[i : i + step] for i in range(0, len(use.data), step)]
    texts = (literal(element, piece, v5=plan.target.v5) for piece in pieces[:4])
    if use.sources:
        texts = (str(read_bico(int.from_bytes(piece))) for piece in pieces[:4])
    shown = ", ".join(texts)
    return shown + (", .." if len(pieces) > 4 else "")


def _manifest(plan: DrivePlan) -> dict[str, Any]:
    """Jobs with their telegrams."""
    jobs = [
        {
            "job": job.key,
            "block": job.block.name,
            "telegrams": [
                {
                    "request": telegram.request.data.hex(" ").upper(),
                    "request_db": f"DB{telegram.request.db.number}",
                    "response_db": f"DB{telegram.response.db.number}",
                    "positive_bytes": telegram.positive_length,
                    "longest_bytes": telegram.response.size,
                }
                for telegram in job.telegrams
            ],
        }
        for job in plan.jobs
    ]
    return {"jobs": jobs}
