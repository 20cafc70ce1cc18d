"""View of a job's function block: every name, number and table row the template writes."""

from __future__ import annotations

from typing import Any

from plcgen.documents.control import signals
from plcgen.documents.members import initializer, plain
from plcgen.documents.nouns import CallerValue, Command, FunctionBlock, LibraryInstance, MemberRow
from plcgen.documents.simaticml import RECORD_NOTE
from plcgen.documents.spelling import clean_title, comment_text, encodable, literal, one_line, type_text
from plcgen.protocols.ds47.plan.fields import interface_type
from plcgen.protocols.ds47.plan.nouns import DriveField, DriveJob, DrivePlan, DriveTelegram, Part, Use
from plcgen.protocols.ds47.plan.types import element_type
from plcgen.protocols.ds47.views.rows import buffer_blocks
from plcgen.protocols.ds47.wire.formats import answers, padded
from plcgen.protocols.ds47.wire.model import RequestId
from plcgen.protocols.ds47.words import DRAIN_MS, HEARTBEATS, LEASE_MS, STATES, STATUS_WORDS
from plcgen.s7.types import ArrayType, Elementary


def program(plan: DrivePlan, job: DriveJob) -> FunctionBlock:
    """The function block of a job with its buffers and the command of its caller."""
    label = title(plan, job)
    records = job.record_instances
    names = (("SFB53", "SFB 53"), ("SFB52", "SFB 52"))
    return FunctionBlock(
        block=job.block,
        instance=job.instance,
        title=label,
        template="ds47/job.scl.j2",
        view=_view(plan, job, label),
        note=RECORD_NOTE,
        buffers=buffer_blocks(plan, job, label),
        commands=(_command(plan, job, label),),
        telegrams=[
            f"request `{telegram.request.data.hex(' ').upper()}` (LEN {len(telegram.request.data)}), "
            f"good answer {telegram.positive_length} bytes, longest answer {telegram.response.size} bytes"
            for telegram in job.telegrams
        ],
        data=[LibraryInstance(block, *name) for block, name in zip(records or (), names, strict=False)],
    )


def _command(plan: DrivePlan, job: DriveJob, label: str) -> Command:
    return Command(
        member=job.member,
        stem=job.member,
        title=label,
        flags=dict(job.trigger.items()),
        signals=signals(plan),
        inputs=[_value(plan, use, start=True) for use in job.inputs],
        outputs=[_value(plan, use, start=False) for use in job.outputs],
    )


def _value(plan: DrivePlan, use: Use, *, start: bool) -> CallerValue:
    type_ = interface_type(use.format, use.count, use.subindex, plan.target)
    if not isinstance(type_, Elementary):
        return CallerValue(_interface(plan, use, start=start), ())
    shown = {"REAL": "FloatingPoint", "LREAL": "FloatingPoint", "BOOL": "Bool"}.get(type_.name, "DEC")
    return CallerValue(_interface(plan, use, start=start), (("", shown),))


def _view(plan: DrivePlan, job: DriveJob, label: str) -> dict[str, Any]:
    where = plan.target
    made = _job(plan, job, label)
    return {
        "job": made,
        "telegram": made["telegrams"][0],
        "record_index_type": "DInt" if where.t15 else "Int",
        "token": job.drive.token.name,
        "input_id": "hardwareId" if where.t15 else "driveAddress",
        "stat_id": "statHardwareId" if where.t15 else "statDriveAddress",
        "diagnostics_type": plan.diagnostics_type.name,
        "states": STATES,
        "statuses": [(n, f"W#16#{v:04X}", text) for n, v, text in STATUS_WORDS if n not in _unused(plan, job)],
    }


def title(plan: DrivePlan, job: DriveJob) -> str:
    """One-line title of a job."""
    verb = job.kind.capitalize()
    labels = ", ".join(use.label for use in job.uses[:4]) + (", .." if len(job.uses) > 4 else "")
    return clean_title(comment_text(job.comment, plan.languages, plan.target, f"{verb} {labels}"))


def _job(plan: DrivePlan, job: DriveJob, label: str) -> dict[str, Any]:
    where = plan.target
    parts = [part for telegram in job.telegrams for part in telegram.parts]
    comments = [job.comment[lang] for lang in plan.languages if job.comment.get(lang)]
    records = job.record_instances
    copies = _copies(plan, job, response=False), _copies(plan, job, response=True)
    return {
        "block": job.block,
        "write": job.writes,
        "many": len(job.telegrams) > 1,
        "single": len(parts) == 1,
        "aligned": len(parts) == len(job.uses),
        "refusable": _refusable(job),
        "gaps": _gaps(job),
        "mixed": _refusable(job) and any(len(telegram.parts) == 1 for telegram in job.telegrams),
        "owner": job.owner,
        "title": label,
        "comment_lines": [one_line(text) for text in comments[1:] if encodable(text, where)],
        "labels": [_label(job, use) for use in job.uses],
        "drive": _drive(job),
        "timeout_ms": job.timeout,
        "drain_ms": DRAIN_MS,
        "pause_ms": job.retry_pause,
        "lease_ms": LEASE_MS,
        "heartbeats": HEARTBEATS,
        "retries": job.retries,
        "use_count": len(job.uses),
        "inputs": [_interface(plan, use, start=True) for use in job.inputs],
        "outputs": [_interface(plan, use, start=False) for use in job.outputs],
        "request_last": max(len(t.request.data) for t in job.telegrams) - 1,
        "response_last": max(t.response.size for t in job.telegrams) - 1,
        "positive_id": f"B#16#{RequestId.CHANGE if job.writes else RequestId.READ:02X}",
        "negative_id": f"B#16#{0x80 | (RequestId.CHANGE if job.writes else RequestId.READ):02X}",
        "telegrams": _telegrams(plan, job),
        "blocks": [_block(index, part) for index, part in enumerate(parts, 1)],
        "input_copies": copies[0],
        "output_copies": copies[1],
        "uses_index": len(job.uses) > 1 or any(copy["loop"] for side in copies for copy in side),
        "write_instance": records[0].name if records else "",
        "read_instance": records[1].name if records else "",
    }


def _refusable(job: DriveJob) -> bool:
    """Whether one error block may stand for several parameters."""
    return any(len(telegram.parts) > 1 for telegram in job.telegrams)


def _gaps(job: DriveJob) -> bool:
    """Whether an answer that lacks a block can have the right length.

    With two parameters written it cannot: one error block alone is the refusal of the whole request.
    """
    return not job.writes or any(len(telegram.parts) > 2 for telegram in job.telegrams)


def _unused(plan: DrivePlan, job: DriveJob) -> set[str]:
    """Status words a block cannot report."""
    unused = set() if _refusable(job) else {"STATUS_REFUSED"}
    return unused | {"STATUS_WRONG_DB"} if plan.target.t15 else unused


def _label(job: DriveJob, use: Use) -> str:
    """Line of the header: which index of ``errors`` belongs to which parameter."""
    text = f"{use.position}: {'writes' if job.writes else 'reads'} {use.label} {use.parameter.title}"
    return one_line(text)


def _drive(job: DriveJob) -> dict[str, Any]:
    drive = job.drive
    signed = drive.record_index - 0x10000 if drive.record_index > 0x7FFF else drive.record_index
    return {
        "key": drive.key,
        "title": drive.device.title,
        "drive_object": drive.drive_object,
        "object_literal": f"B#16#{drive.drive_object:02X}",
        "id_value": drive.id_value,
        "id_literal": f"DW#16#{drive.id_value:08X}",
        "record_index_hex": f"16#{drive.record_index:04X}",
        "record_index_literal": drive.record_index if drive.record_index <= 0x7FFF else signed,
    }


def _interface(plan: DrivePlan, use: Use, *, start: bool) -> MemberRow:
    """Declaration of a value at the interface and in the control DB."""
    where = plan.target
    type_ = interface_type(use.format, use.count, use.subindex, where)
    initial = initializer(type_, use.data, v5=where.v5) if start and any(use.data) else ""
    unit = f" [{use.parameter.unit}]" if use.parameter.unit else ""
    own = comment_text(use.comment, plan.languages, where, use.parameter.title)
    return plain(
        plan, use.member, type_text(type_, tia=not where.v5), one_line(f"{use.label} {own}{unit}"), start=initial
    )


def _single_bool(use: Use) -> bool:
    return use.format.name == "Boolean" and use.count == 1


def _block(index: int, part: Part) -> dict[str, Any]:
    own, *others = (f"B#16#{code:02X}" for code in answers(part.use.format))
    return {
        "index": index,
        "label": part.use.label if part.whole else f"{part.use.label} from index {part.subindex}",
        "use": part.use.position,
        "format": own,
        "others": others,
        "count": part.count,
        "size": padded(part.size),
    }


def _telegrams(plan: DrivePlan, job: DriveJob) -> list[dict[str, Any]]:
    views = []
    first = 1
    for telegram in job.telegrams:
        views.append(_telegram(plan, telegram, first, many=len(job.telegrams) > 1))
        first += len(telegram.parts)
    return views


def _telegram(plan: DrivePlan, telegram: DriveTelegram, first: int, *, many: bool) -> dict[str, Any]:
    request_db, response_db = telegram.request.db, telegram.response.db
    suffix = str(telegram.number) if many else ""
    reference = next(f.name for f in telegram.request.fields if f.role == "reference")
    mirror = next(f.name for f in telegram.response.fields if f.role == "reference")
    build = [
        {
            "target": f'"{request_db.name}".{reference}',
            "source": "#statReference",
        }
    ]
    store: list[dict[str, str]] = []
    if plan.target.t15:
        view = f"#statRequestView{suffix}"
        build += [_move(f"{view}.{f.name}", f'"{request_db.name}".{f.name}') for f in telegram.request.fields]
        view = f"#statResponseView{suffix}"
        store = [_move(f'"{response_db.name}".{f.name}', f"{view}.{f.name}") for f in telegram.response.fields]
    return {
        "index": telegram.number,
        "suffix": suffix,
        "request_type": telegram.request.type.name,
        "response_type": telegram.response.type.name,
        "request_length": len(telegram.request.data),
        "response_size": telegram.response.size,
        "request_pointer": f"P#DB{request_db.number}.DBX0.0 BYTE {len(telegram.request.data)}",
        "response_pointer": f"P#DB{response_db.number}.DBX0.0 BYTE {telegram.response.size}",
        "reference": f'"{request_db.name}".{reference}',
        "mirror": f'"{response_db.name}".{mirror}',
        "count": len(telegram.parts),
        "count_literal": f"B#16#{len(telegram.parts):02X}",
        "first_block": first,
        "last_block": first + len(telegram.parts) - 1,
        "first_use": telegram.parts[0].use.position,
        "last_use": telegram.parts[-1].use.position,
        "build": build,
        "store": store,
    }


def _move(target: str, source: str) -> dict[str, str]:
    return {"target": target, "source": source}


def _copies(plan: DrivePlan, job: DriveJob, *, response: bool) -> list[dict[str, Any]]:
    """Moves between the block's interface and the value members of its buffer DBs."""
    if response == job.writes:
        return []
    copies = []
    for telegram in job.telegrams:
        db = telegram.response.db if response else telegram.request.db
        for field in telegram.response.fields if response else telegram.request.fields:
            if field.role != "value" or field.part is None or (not response and field.part.use.constant):
                continue
            copies.append(_copy(plan, field, field.part, f'"{db.name}".{field.name}', response=response))
    return copies


def _copy(plan: DrivePlan, field: DriveField, part: Part, member: str, *, response: bool) -> dict[str, Any]:
    """One move; ``shift`` is what the interface's index is ahead of the buffer's index in a split array."""
    own = part.use.member
    view: dict[str, Any] = {"bool": _single_bool(part.use), "loop": False, "shift": ""}
    if isinstance(field.type, Elementary) and part.use.count > 1:
        own = f"{own}[{part.subindex}]"
    if view["bool"] and isinstance(field.type, Elementary):
        view["one"] = literal(field.type, b"\x01", v5=plan.target.v5)
        view["zero"] = literal(field.type, b"\x00", v5=plan.target.v5)
    if isinstance(field.type, ArrayType):
        low = field.type.bounds[0][0]
        bytewise = not part.use.format.is_string and element_type(part.use.format, plan.target) is None
        view["loop"] = True
        view["first"], view["last"] = low, low + (part.size if bytewise else part.count) - 1
        if bytewise and part.start:
            view["shift"] = f" + {part.start * part.use.format.size}"
    return {**view, "interface": own, "member": member, "response": response}
