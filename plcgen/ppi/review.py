"""PPI masters as reviewers see them: their tables, and what two versions of a spec have different."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace

from plcgen.base.telegrams.dissection import ByteField
from plcgen.ppi.plan.nouns import PpiJob, PpiPlan, PpiValue
from plcgen.ppi.views.documents import written_value
from plcgen.ppi.wire.dissect import dissect
from plcgen.project.nouns import Buffer, BufferField
from plcgen.s7.compare.model import DriveState, JobItem, JobState, TelegramState


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
