"""Drive jobs as a reviewer signs them: what is written to which drive, every byte of request and answers."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from plcgen.build.sheet import ExchangeSheet, JobInstance, Message, MessageField, ReviewSheet, Role, WriteEntry
from plcgen.ds47 import guards
from plcgen.ds47.device import Parameter
from plcgen.ds47.effects import UNCLASSIFIED
from plcgen.ds47.plan.access import Part, Running, Use
from plcgen.ds47.plan.nouns import DriveField, DriveJob, DrivePlan, DriveTelegram
from plcgen.ds47.plan.values import amount_text, literals_text
from plcgen.ds47.views.texts import field_texts
from plcgen.ds47.wire.dissect import dissect_request
from plcgen.ds47.wire.formats import ERROR, padded
from plcgen.project.nouns import Buffer
from plcgen.s7.tables.tables import member_address
from plcgen.s7.types.data_types import Elementary

_ROLES = {
    "reference": Role.HEADER, "request_id": Role.HEADER, "drive_object": Role.HEADER, "count": Role.HEADER,
    "attribute": Role.ADDRESS, "elements": Role.ADDRESS, "pnu": Role.ADDRESS, "subindex": Role.ADDRESS,
    "format": Role.FORMAT, "value_count": Role.FORMAT, "value": Role.VALUE,
    "error_format": Role.ERROR, "error_count": Role.ERROR, "error_number": Role.ERROR, "error_info": Role.ERROR,
    "pad": Role.SPARE, "reserve": Role.SPARE,
}  # fmt: skip
_STORES = frozenset({971, 977})
"""Writing these copies RAM to the non-volatile memory: p0971 of a drive object, p0977 of the whole unit."""
_NEGATIVE = 0x80
_MAX_VALUE = 40

Bytes = Sequence[int | None]


def review_sheet(plan: DrivePlan) -> ReviewSheet:
    """Everything of a plan."""
    writes = [_write(plan, shape, use) for shape in plan.shapes for use in shape.uses if use.writes]
    exchanges = [_exchange(shape, telegram) for shape in plan.shapes for telegram in shape.telegrams]
    return ReviewSheet(tuple(writes), tuple(exchanges), tuple(_instance(job) for job in plan.jobs))


def _trigger(job: DriveJob) -> str:
    flag = job.trigger.execute
    return flag.text() if flag is not None else f'"{job.caller.control.name}".{job.member}.execute'


def _instance(job: DriveJob) -> JobInstance:
    drive = job.drive
    number = f"{drive.id_value} (16#{drive.id_value:04X})"
    address = f"{drive.id_name or number}, object {drive.drive_object}, unit {drive.unit.key}, slot {job.slot}"
    return JobInstance(job.shape, job.key, drive.key, address, _trigger(job))


def _write(plan: DrivePlan, shape: DriveJob, use: Use) -> WriteEntry:
    jobs, parameter = plan.instances(shape), use.parameter
    kinds = plan.drive_kinds(shape)
    at = shape.uses.index(use)
    danger = next((why for job in kinds if (why := plan.danger(job, job.own[at]))), "")
    if not danger and any(plan.unclassified(job, job.own[at]) for job in kinds):
        danger = UNCLASSIFIED
    triggers = [_trigger(job) for job in jobs]
    source = _source(shape, use)
    return WriteEntry(
        job=shape.shape,
        block=shape.block.name,
        partners=tuple(job.drive.key for job in jobs),
        parameter=use.label,
        text=parameter.title,
        value=source or (amount_text if parameter.scale else literals_text)(use, plan.target),
        input=any(not one.constant for one in (use.bits or (use,))) and not source,
        limits="" if use.bits else _limits(parameter.minimum, parameter.maximum),
        unit=parameter.unit,
        trigger=triggers[0] if len(triggers) == 1 else "execute of each drive, see its row",
        memory=_memory(shape, use),
        danger=danger,
        signed=(plan.sign_off(shape, parameter.pnu) or "") if danger else "",
        safety=parameter.pnu in guards.SAFETY,
        doubts=tuple(dict.fromkeys(doubt for job in kinds for doubt in _doubts(job.own[at].parameter))),
    )


def _source(shape: DriveJob, use: Use) -> str:
    """Where a value comes from that is neither in the spec nor at an input of its own."""
    if shape.recipe is not None and use.recorded:
        return f"a record of {shape.recipe.db.name}, chosen by recordNumber"
    return "made of the time at the input utc" if use in shape.timed else ""


def _memory(shape: DriveJob, use: Use) -> str:
    """Where a value is written, and whether it stays there if the job fails."""
    stored = "RAM, lost at power-off"
    if use.parameter.pnu in _STORES:
        stored = "copies RAM to non-volatile memory"
    elif use.parameter.pnu in guards.TRIGGERS:
        stored = "starts something, keeps no value"
    state = "while the drive does not run" if any(use.as_(Running) for use in shape.uses) else "while it runs, too"
    return (
        f"{stored}; the old value comes back if the job fails, {state}"
        if shape.restores and use not in shape.saving
        else stored
    )


def _doubts(parameter: Parameter) -> Iterator[str]:
    """Type and limits that were concluded or remembered, with what the catalogue says of them."""
    if doubt := parameter.type_note:
        yield doubt
    least, most = parameter.doubted.get("min"), parameter.doubted.get("max")
    if least is not None or most is not None:
        grades = sorted({g for fact, g in parameter.grades.items() if fact in {"min", "max"} and g != "read"})
        yield f"limits {_limits(least, most)}: {' and '.join(grades)}, not read in a manual, not enforced"


def _limits(least: float | None, most: float | None) -> str:
    if least is None and most is None:
        return ""
    return f"{'' if least is None else f'{least:g}'} .. {'' if most is None else f'{most:g}'}".strip()


def _exchange(shape: DriveJob, telegram: DriveTelegram) -> ExchangeSheet:
    request = telegram.request
    values = {found.offset: found.value for found in dissect_request(request.data)}
    positive, negative = _positive(shape, telegram), _negative(shape, telegram)
    pairs = (
        ("LEN of WRREC", f"{len(request.data)} bytes"),
        ("MLEN of RDREC", f"{telegram.response.size} bytes"),
        ("good answer", f"{len(positive)} bytes"),
        ("worst bad answer", f"{len(negative)} bytes"),
    )
    answer = _fields(telegram.response, positive, lambda _: "", response=True)
    asked = _fields(request, request.data, lambda field: values.get(field.offset, ""), response=False)
    return ExchangeSheet(
        job=shape.shape,
        block=shape.block.name,
        number=telegram.number,
        count=len(shape.telegrams),
        request=Message("request", request.home, request.size, tuple(asked)),
        answers=(
            Message("good answer", telegram.response.home, telegram.response.size, tuple(answer)),
            Message("worst bad answer", telegram.response.home, telegram.response.size, _errors(telegram, negative)),
        ),
        lengths=pairs,
    )


def _fields(
    buffer: Buffer[DriveField], data: Bytes, value: Callable[[DriveField], str], *, response: bool
) -> Iterator[MessageField]:
    for field in buffer.fields:
        covered = tuple(data[field.offset : field.offset + field.size])
        if covered:
            meaning = dict(field_texts(field, ("en",), response=response))["en"]
            shown = value(field)[:_MAX_VALUE]
            yield MessageField(
                field.offset, field.name, _ROLES[field.role], _address(buffer, field), covered, shown, meaning
            )


def _address(buffer: Buffer[DriveField], field: DriveField) -> str:
    if buffer.db is None:
        return ""
    bits = 8 * field.size if isinstance(field.type, Elementary) else 0
    return member_address(buffer.db.number, field.offset, None, bits)


def _positive(shape: DriveJob, telegram: DriveTelegram) -> list[int | None]:
    """The good answer; the drive decides reference and values, and may answer in the generic type of a size."""
    answer: list[int | None] = [None, telegram.response_id, shape.drive.drive_object, len(telegram.parts)]
    for part in telegram.parts if not telegram.writes else ():
        answer += _block(part)
    return answer


def _block(part: Part) -> list[int | None]:
    pad: list[int | None] = [0] * (padded(part.size) - part.size)
    values: list[int | None] = [None] * part.size
    return [part.use.format.code, part.count, *values, *pad]


def _negative(shape: DriveJob, telegram: DriveTelegram) -> list[int | None]:
    """Every parameter refused with two error words: 4 + 6 bytes a parameter."""
    answer: list[int | None] = [None, telegram.request_id | _NEGATIVE, shape.drive.drive_object, len(telegram.parts)]
    for _ in telegram.parts:
        answer += [ERROR, 2, None, None, None, None]
    return answer


def _errors(telegram: DriveTelegram, data: Bytes) -> tuple[MessageField, ...]:
    """The bad answer field by field; members have the names of the good one, so the fields are named by meaning."""
    buffer = telegram.response
    number = None if buffer.db is None else buffer.db.number
    found: list[MessageField] = []

    def add(size: int, role: Role, meaning: str) -> None:
        offset = sum(len(field.data) for field in found)
        there = (field for field in buffer.fields if (field.offset, field.size) == (offset, size))
        member = next((field.name for field in there if field.role != "reserve"), "")
        address = "" if number is None else member_address(number, offset, None, 8 * size)
        found.append(MessageField(offset, member, role, address, tuple(data[offset : offset + size]), "", meaning))

    bad = f"{data[1]:02X}h = bad answer"
    for meaning in ("mirrored request reference", bad, "mirrored drive object", "number of parameters"):
        add(1, Role.HEADER, meaning)
    for part in telegram.parts:
        label = part.use.label
        add(1, Role.ERROR, f"{label} 44h = error")
        add(1, Role.ERROR, f"{label} number of error words")
        add(2, Role.ERROR, f"{label} error number")
        add(2, Role.ERROR, f"{label} second error word")
    return tuple(found)
