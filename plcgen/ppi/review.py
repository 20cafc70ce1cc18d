"""PPI masters as reviewers see them: their tables, what two versions of a spec have different, and what they sign."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace

from plcgen.base.telegrams.dissection import ByteField
from plcgen.build.sheet import ExchangeSheet, JobInstance, Message, MessageField, ReviewSheet, Role, WriteEntry
from plcgen.ppi.plan.nouns import LEAD, PlannedMaster, PpiField, PpiJob, PpiPlan, PpiTelegram, PpiValue
from plcgen.ppi.views.program import written_value
from plcgen.ppi.views.values import FIELD_TEXTS
from plcgen.ppi.wire.dissect import dissect
from plcgen.project.nouns import Buffer, BufferField
from plcgen.s7.compare.model import DriveState, JobItem, JobState, TelegramState
from plcgen.s7.tables.tables import member_address
from plcgen.s7.types.data_types import Elementary


def buffers(plan: PpiPlan) -> Iterator[tuple[Buffer[BufferField], str]]:
    """Every telegram table and response DB with what it is for."""
    for master in plan.masters:
        for telegram in master.telegrams:
            job = next((job for job in master.jobs if telegram in job.telegrams), None)
            which = f" telegram {job.telegrams.index(telegram) + 1}" if job and len(job.telegrams) > 1 else ""
            whose = f"the first frame to {plan.station_key(master, telegram.station)}"
            if job is not None:
                whose = f"{plan.key(master, job)}{which}"
            size = len(telegram.request.data)
            yield telegram.request, f"telegram table of {whose}: its length, then {size} bytes"
            if telegram.response is not None:
                yield telegram.response, f"response of {whose}, as if every item is good"


def links(plan: PpiPlan) -> Iterator[DriveState]:
    """The stations, under the name of their master."""
    for master in plan.masters:
        line = (("module", master.module), ("port", str(master.port)), ("baud", str(master.baud)))
        for station in master.stations:
            settings = (("cpu", station.profile.key), *line)
            place = plan.loaded.key_span(station.path)
            yield DriveState(f"{master.key}.{station.key}", "station", station.address, settings, place)


def jobs(plan: PpiPlan) -> Iterator[JobState]:
    """The jobs with their telegrams, under the name of their master."""
    for master in plan.masters:
        for job in master.jobs:
            sizes = [(t.request.data, 0 if t.response is None else t.response.size) for t in job.telegrams]
            telegrams = tuple(TelegramState(data, size, 0, size, "ppi") for data, size in sizes)
            timing = (("timeout", f"{job.timeout} ms"), ("cycle", f"{job.cycle} ms"))
            trigger = tuple((name, address.text()) for name, address in job.trigger.items())
            station, span = f"{master.key}.{job.station.key}", plan.loaded.key_span(job.path)
            key, place = f"{master.key}.{job.key}", (plan.control_db.name, job.member)
            items = tuple(_item(plan, job, value) for value in job.values)
            yield JobState(key, station, telegrams, timing, trigger, span, key, items, place, master.block.name)


def _item(plan: PpiPlan, job: PpiJob, value: PpiValue) -> JobItem:
    if job.kind != "write":
        return JobItem(value.label, "reads")
    return JobItem(value.label, "writes", written_value(plan, value))


_DERIVED = ("checksum", "length LE", "parameter length", "data length")
_REMARK = re.compile(r" \([^)]*\)")


def shown_request(data: bytes) -> list[ByteField]:
    """A frame field by field, without lengths and checksum: they follow from the others."""
    named = (replace(field, name=_REMARK.sub("", field.name)) for field in dissect(data))
    return [field for field in named if not field.name.startswith(_DERIVED)]


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
        answers.append(
            Message(
                "reply, every item good",
                response.home,
                response.size,
                tuple(_field(response, field, (None,) * field.size, "") for field in response.fields),
            )
        )
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


def _field(buffer: Buffer[PpiField], field: PpiField, data: tuple[int | None, ...], value: str) -> MessageField:
    address = ""
    if buffer.db is not None:
        bits = 8 * field.size if isinstance(field.type, Elementary) else 0
        address = member_address(buffer.db.number, field.offset, None, bits)
    meaning = FIELD_TEXTS.get(field.role, ("", "", ""))[0]
    return MessageField(field.offset, field.name, _ROLES.get(field.role, Role.HEADER), address, data, value, meaning)
