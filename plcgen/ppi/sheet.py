"""PPI jobs as a reviewer signs them: what is written to which station, every byte of tables and replies."""

from __future__ import annotations

from collections.abc import Iterator

from plcgen.build.sheet import ExchangeSheet, JobInstance, Message, MessageField, ReviewSheet, Role, WriteEntry
from plcgen.ppi.plan.nouns import LEAD, PlannedMaster, PpiField, PpiJob, PpiPlan, PpiTelegram
from plcgen.ppi.views.documents import written_value
from plcgen.ppi.views.texts import FIELD_TEXTS
from plcgen.ppi.wire.dissect import dissect
from plcgen.project.nouns import Buffer
from plcgen.s7.tables.tables import member_address
from plcgen.s7.types.data_types import Elementary

_ROLES = {
    "value": Role.VALUE, "pad": Role.SPARE, "reserved": Role.SPARE, "return_code": Role.FORMAT,
    "size_code": Role.FORMAT, "value_length": Role.FORMAT,
    **dict.fromkeys(
        ("specification", "address_length", "syntax", "transport_size", "count", "db", "area", "address_high",
         "address", "program", "service_mark", "argument_length"),
        Role.ADDRESS,
    ),
}  # fmt: skip
"""All other members belong to the frame."""


def review_sheet(plan: PpiPlan) -> ReviewSheet:
    """Everything of a plan."""
    writes = [row for master in plan.masters for job in master.jobs for row in _writes(plan, master, job)]
    exchanges = [
        _exchange(master, job, telegram, number)
        for master in plan.masters
        for job in master.jobs
        for number, telegram in enumerate(job.telegrams, 1)
    ]
    instances = [_instance(plan, master, job) for master in plan.masters for job in master.jobs]
    return ReviewSheet(tuple(writes), tuple(exchanges), tuple(instances))


def _key(master: PlannedMaster, job: PpiJob) -> str:
    return f"{master.key}.{job.key}"


def _trigger(plan: PpiPlan, job: PpiJob) -> str:
    if job.cycle:
        return f"every {job.cycle} ms"
    flag = job.trigger.execute
    return flag.text() if flag is not None else f'"{plan.control_db.name}".{job.member}.execute'


def _instance(plan: PpiPlan, master: PlannedMaster, job: PpiJob) -> JobInstance:
    address = f"station {job.station.address}, {master.module} port {master.port}, {master.baud} baud"
    return JobInstance(_key(master, job), plan.key(master, job), job.station.key, address, _trigger(plan, job))


def _writes(plan: PpiPlan, master: PlannedMaster, job: PpiJob) -> Iterator[WriteEntry]:
    def entry(parameter: str, text: str, value: str, danger: str = "", *, given: bool = False) -> WriteEntry:
        return WriteEntry(
            _key(master, job), master.block.name, (job.station.key,), parameter, text, value, given, "", "",
            _trigger(plan, job), "memory of the station" if not danger else "operating mode", danger,
            f"by the key {job.kind} of the job" if danger else "",
        )  # fmt: skip

    if job.kind in {"run", "stop"}:
        yield entry("CPU", "operating mode", job.kind.upper(), f"switches the CPU to {job.kind.upper()}")
    for value in job.values if job.kind == "write" else ():
        yield entry(value.label, value.title, written_value(plan, value), given=not value.constant)


def _exchange(master: PlannedMaster, job: PpiJob, telegram: PpiTelegram, number: int) -> ExchangeSheet:
    request, response = telegram.request, telegram.response
    answers: list[Message] = []
    lengths = [("telegram", f"{len(request.data)} bytes"), ("table", f"{request.size} bytes")]
    if response is not None:
        answers.append(Message("reply, every item good", response.home, response.size, _reply(response)))
        lengths.append(("response DB", f"{response.size} bytes"))
    table = Message("telegram table", request.home, request.size, _table(request))
    key, block, count = _key(master, job), master.block.name, len(job.telegrams)
    return ExchangeSheet(key, block, number, count, table, tuple(answers), tuple(lengths))


def _table(buffer: Buffer[PpiField]) -> tuple[MessageField, ...]:
    values = {LEAD + found.offset: found.value for found in dissect(buffer.data)}
    image = buffer.image
    return tuple(
        _field(buffer, field, tuple(image[field.offset : field.offset + field.size]), values.get(field.offset, ""))
        for field in buffer.fields
    )


def _reply(buffer: Buffer[PpiField]) -> tuple[MessageField, ...]:
    return tuple(_field(buffer, field, (None,) * field.size, "") for field in buffer.fields)


def _field(buffer: Buffer[PpiField], field: PpiField, data: tuple[int | None, ...], value: str) -> MessageField:
    address = ""
    if buffer.db is not None:
        bits = 8 * field.size if isinstance(field.type, Elementary) else 0
        address = member_address(buffer.db.number, field.offset, None, bits)
    meaning = FIELD_TEXTS.get(field.role, ("", "", ""))[0]
    return MessageField(field.offset, field.name, _ROLES.get(field.role, Role.HEADER), address, data, value, meaning)
