"""What every document says about a member of a drive's buffers, worked out once."""

from __future__ import annotations

from functools import partial

from plcgen.build.members import assignments, buffer_member, display_format, initializer, plain
from plcgen.build.nouns import DataBlock, MemberRow, TypeBlock
from plcgen.build.spelling import comment_text, declared_type, literal, one_line
from plcgen.ds47.kind import Wait
from plcgen.ds47.plan.access import Use, Verify
from plcgen.ds47.plan.fields import interface_type
from plcgen.ds47.plan.nouns import DriveField, DriveJob, DrivePlan
from plcgen.ds47.views.texts import field_texts
from plcgen.project.nouns import BlockRef, Buffer
from plcgen.s7.types.data_types import Elementary


def buffer_blocks(plan: DrivePlan, job: DriveJob, title: str) -> list[tuple[TypeBlock, DataBlock | None]]:
    """Types and data blocks of a job's telegrams, request and response in turn."""
    found: list[tuple[TypeBlock, DataBlock | None]] = []
    for telegram in job.telegrams:
        for which, buffer in (("Request", telegram.request), ("Response", telegram.response)):
            members = [_member(plan, buffer, field, response=which == "Response") for field in buffer.fields]
            if starts := which == "Request" and buffer.db is None:
                members = [_started(plan, member, field) for member, field in zip(members, buffer.fields, strict=True)]
            type_ = TypeBlock(buffer.type, members, job.comment, starts=starts)
            found.append((type_, _data(buffer.db, f"{which}: {title}", members, job)))
    return found


def _started(plan: DrivePlan, member: MemberRow, field: DriveField) -> MemberRow:
    """A member of the type of a request that has no data block: its start value is that of every instance."""
    return member._replace(start=initializer(field.type, field.data, v5=plan.target.v5, runs=False))


def interface_row(plan: DrivePlan, use: Use, *, start: bool) -> MemberRow:
    """Declaration of a value at the interface, in the control DB, in a record."""
    where = plan.target
    type_ = interface_type(use.format, use.count, use.subindex, where)
    initial = initializer(type_, use.data, v5=where.v5) if start and any(use.data) else ""
    unit = f" [{use.parameter.unit}]" if use.parameter.unit else ""
    own = comment_text(use.comment, plan.languages, where, use.parameter.title)
    if use.as_(Wait):
        own = f"{own or 'value'}, as last read in step {use.step}"
    elif use.as_(Verify):
        own = f"{own or 'value'}, read back"
    return plain(
        plan, use.member, declared_type(type_, tia=not where.v5), one_line(f"{use.label} {own}{unit}"), start=initial
    )


def _data(db: BlockRef | None, title: str, members: list[MemberRow], job: DriveJob) -> DataBlock | None:
    return None if db is None else DataBlock(db, title, members, assignments(members), job.comment)


def _member(plan: DrivePlan, buffer: Buffer[DriveField], field: DriveField, *, response: bool) -> MemberRow:
    texts = {language: one_line(text) for language, text in field_texts(field, plan.languages, response=response)}
    text = texts[plan.languages[0]]
    if plan.target.v5:
        fallback = dict(field_texts(field, ("en",), response=response))["en"]
        text = comment_text(texts, plan.languages, plan.target, fallback)
    fixed = not response and (field.role != "value" or field.part is None or field.part.use.constant)
    number = field.role == "pnu"
    modify = _number if number else partial(literal, v5=plan.target.v5)
    return buffer_member(
        plan,
        buffer.db,
        field,
        texts,
        text,
        starts=not response,
        shown=None if field.role in {"pad", "reserve"} else _decimal if number else display_format,
        modify=modify if fixed else None,
    )


def _decimal(_: Elementary) -> str:
    return "DEC"


def _number(_: Elementary, data: bytes) -> str:
    """A parameter number, which people know in decimal digits."""
    return str(int.from_bytes(data))
