"""Drive jobs as reviewers see them: their buffers, and what two versions of a spec have different."""

from __future__ import annotations

from collections.abc import Iterator

from plcgen.base.telegrams.dissection import ByteField
from plcgen.ds47.plan.access import Compare, Read, Use, Write
from plcgen.ds47.plan.nouns import DriveJob, DrivePlan, PlannedDrive
from plcgen.ds47.plan.values import amount_text, literals_text
from plcgen.ds47.wire.dissect import dissect_request
from plcgen.project.nouns import Buffer, BufferField
from plcgen.s7.compare.model import DriveState, JobItem, JobState, TelegramState


def buffers(plan: DrivePlan) -> Iterator[tuple[Buffer[BufferField], str]]:
    """Every request and response buffer with what it is for."""
    for job in plan.shapes:
        for telegram in job.telegrams:
            which = f" telegram {telegram.number}" if len(job.telegrams) > 1 else ""
            yield telegram.request, f"request of {job.key}{which}, LEN {len(telegram.request.data)}"
            lengths = f"positive {telegram.positive_length}, negative {telegram.negative_length} bytes"
            yield telegram.response, f"response of {job.key}{which}, {lengths}"


def links(plan: DrivePlan) -> Iterator[DriveState]:
    """The drives."""
    for drive in plan.drives:
        yield DriveState(drive.key, "drive", drive.id_value, _settings(drive), plan.loaded.key_span(drive.path))


def _settings(drive: PlannedDrive) -> tuple[tuple[str, str], ...]:
    index = f"{drive.record_index} (16#{drive.record_index:04X})"
    return (("device", drive.device.key), ("drive object", str(drive.drive_object)), ("record index", index))


def jobs(plan: DrivePlan) -> Iterator[JobState]:
    """The jobs with their telegrams."""
    for job in plan.jobs:
        telegrams = tuple(
            TelegramState(t.request.data, t.positive_length, t.negative_length, t.response.size) for t in job.telegrams
        )
        timing = (
            ("timeout", f"{job.timeout} ms"),
            ("retry pause", f"{job.retry_pause} ms"),
            ("retries", str(job.retries)),
        )
        trigger = tuple((name, address.text()) for name, address in job.trigger.items())
        span, place = plan.loaded.key_span(job.path), (job.caller.control.name, job.member)
        items = tuple(_item(plan, use) for use in job.uses if isinstance(use.role, Read | Write | Compare))
        yield JobState(
            job.key, job.drive.key, telegrams, timing, trigger, span, _group(job), items, place, job.block.name
        )


def _group(job: DriveJob) -> str:
    """The key of a job in the spec: behind it stands the drive, if there are several."""
    return job.key.removesuffix(f".{job.drive.key}")


def _item(plan: DrivePlan, use: Use) -> JobItem:
    does = {Read: "reads", Write: "writes", Compare: "compares"}[type(use.role)]
    if not use.supplied:
        return JobItem(use.label, does)
    constant = all(one.constant for one in (use.bits or (use,)))
    return JobItem(
        use.label,
        does,
        f"{(amount_text if use.parameter.scale else literals_text)(use, plan.target)}{'' if constant else ' (input)'}",
    )


def shown_request(data: bytes) -> list[ByteField]:
    """A request field by field."""
    return dissect_request(data)
