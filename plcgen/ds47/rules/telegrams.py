"""Rules about telegrams: pinned buffer sizes, request references, times."""

from __future__ import annotations

from typing import TYPE_CHECKING

from plcgen.base.diagnostics import Diagnostic, Note, Severity
from plcgen.base.diagnostics.counting import quantity
from plcgen.ds47.plan.pack import longest_response
from plcgen.ds47.registry import kind_called
from plcgen.ds47.rules.places import value_span
from plcgen.project.rules.places import key_or_value, owner_span
from plcgen.s7.types.durations import spelled

if TYPE_CHECKING:
    from collections.abc import Iterator

    from plcgen.ds47.plan.nouns import DriveJob, DrivePlan, DriveTelegram
    from plcgen.project.nouns import BlockRef


TELEGRAM_MS = 150
"""What is reckoned for a telegram: it takes four to fourteen calls, 10 ms apart, and a drive some time of its own."""


def response_buffer(plan: DrivePlan) -> Iterator[Diagnostic]:
    """PG303: the pinned response buffer is not fit for every answer the drive may give."""
    for job in plan.shapes:
        for telegram in job.telegrams:
            size = telegram.pinned
            if size is None or len(job.telegrams) > 1:
                continue
            span = key_or_value(plan, (*job.path, "response", "size"))
            block = _label(plan, telegram.response.home)
            needed, answer = _longest_answer(telegram, write=telegram.writes)
            limit = job.drive.device.record_limit
            if size < needed:
                yield Diagnostic(
                    "PG303",
                    f"response buffer {quantity(needed - size, 'byte')} too small: "
                    f"{block} has {quantity(size, 'byte')}, {answer} needs {needed}",
                    span,
                    help=f"set size: {needed}, or leave size out",
                    notes=_why(plan, telegram),
                )
            elif size > limit:
                yield Diagnostic(
                    "PG303",
                    f"response buffer too large: {block} has {size} bytes, a record of this drive at most {limit}",
                    span,
                    help=f"set size to {needed}..{limit}, or leave size out",
                )
            elif size % 2:
                yield Diagnostic(
                    "PG303",
                    f"response buffer has an odd size: {block} has {size} bytes, a data block ends with a whole word",
                    span,
                    help=f"set size: {size + 1}, or leave size out",
                )


def _longest_answer(telegram: DriveTelegram, *, write: bool) -> tuple[int, str]:
    longest = longest_response(telegram.parts, write=write)
    if longest <= telegram.negative_length:
        return telegram.negative_length, "a negative answer"
    if longest <= telegram.positive_length:
        return telegram.positive_length, "a positive answer"
    return longest, "an answer that is negative in part"


def _why(plan: DrivePlan, telegram: DriveTelegram) -> tuple[Note, ...]:
    use = max(telegram.parts, key=lambda part: part.size).use
    figures = f"positive answer {telegram.positive_length} bytes, negative answer {telegram.negative_length}"
    count = len(telegram.parts)
    return (
        Note(
            f"{quantity(count, 'parameter')} in this {'write' if telegram.writes else 'read'}: {figures}",
            value_span(plan, use),
        ),
    )


def request_buffer(plan: DrivePlan) -> Iterator[Diagnostic]:
    """PG304: a pinned size does not go with the telegrams of the job."""
    for job in plan.shapes:
        spec = plan.entry(job)
        for which, size in (("request", spec.request.size), ("response", spec.response.size)):
            if size is None:
                continue
            span = key_or_value(plan, (*job.path, which, "size"))
            if len(job.telegrams) > 1:
                yield Diagnostic(
                    "PG304",
                    f"one {which} size for {len(job.telegrams)} telegrams: this job is split",
                    span,
                    help="leave size out, or split it into several jobs",
                )
            elif which == "request":
                yield from _request_size(plan, job.telegrams[0], size, job)


def _request_size(plan: DrivePlan, telegram: DriveTelegram, size: int, job: DriveJob) -> Iterator[Diagnostic]:
    needed = len(telegram.request.data)
    span = key_or_value(plan, (*job.path, "request", "size"))
    block = _label(plan, telegram.request.home)
    if size < needed:
        yield Diagnostic(
            "PG304",
            f"request buffer {quantity(needed - size, 'byte')} too small: "
            f"{block} has {quantity(size, 'byte')}, the telegram needs {needed}",
            span,
            help=f"set size: {needed}, or leave size out",
        )
    elif size > needed:
        yield Diagnostic(
            "PG304",
            f"request size {size} has no effect: the telegram and {block} have {needed} bytes",
            span,
            Severity.WARNING,
            help="leave size out: a drive refuses bytes after the telegram",
        )


def reference(plan: DrivePlan) -> Iterator[Diagnostic]:
    """PG305: the request reference does not fit its byte, or is the reserved 0."""
    for job in plan.shapes:
        if not 1 <= job.reference <= 255:
            why = "0 is reserved" if job.reference == 0 else "it is one byte"
            yield Diagnostic(
                "PG305",
                f"request reference {job.reference} is outside 1..255: {why}",
                key_or_value(plan, (*job.path, "reference")),
                help="write a number from 1 to 255, or leave reference out",
            )


def timing(plan: DrivePlan) -> Iterator[Diagnostic]:
    """PG306: the job's time is over before its pauses are, or before its telegrams are."""
    for job in plan.shapes:
        span = key_or_value(plan, (*job.path, "timeout"))
        least, pauses = TELEGRAM_MS * (len(job.telegrams) + 1), len(job.telegrams) * job.retry_pause
        if job.retries and job.timeout <= job.retry_pause:
            yield Diagnostic(
                "PG306",
                f"the timeout of {spelled(job.timeout)} ends before the first retry, "
                f"which comes after {spelled(job.retry_pause)}",
                span,
                help="make timeout longer or retry_pause shorter",
                notes=_pause(plan, job),
            )
        elif job.timeout < least:
            yield Diagnostic(
                "PG306",
                f"the timeout of {spelled(job.timeout)} is too short for {quantity(len(job.telegrams), 'telegram')}, "
                "of which each takes up to fourteen calls of the block",
                span,
                help=f"allow {spelled(least)} at least; a drive may need more",
            )
        elif job.retries and job.timeout <= pauses:
            yield Diagnostic(
                "PG306",
                f"the timeout of {spelled(job.timeout)} is too short "
                f"for one retry of each of the {len(job.telegrams)} telegrams",
                span,
                Severity.WARNING,
                help=f"make timeout longer than {spelled(pauses)}",
                notes=_pause(plan, job),
            )


def repeated(plan: DrivePlan) -> Iterator[Diagnostic]:
    """PG264: a job that writes has a cycle."""
    for job in plan.shapes:
        if job.cycle and not kind_called(job.kind).repeatable:
            what = (
                "is asked by hand"
                if job.serves
                else "reads into a record"
                if not kind_called(job.kind).writes
                else "writes"
            )
            yield Diagnostic(
                "PG264",
                f'"{job.shape}" {what}: only jobs that read or compare have a cycle',
                plan.loaded.key_span((*job.path, "cycle")),
                help="remove cycle, and start the job by execute when it is needed",
            )


def _pause(plan: DrivePlan, job: DriveJob) -> tuple[Note, ...]:
    span = key_or_value(plan, (*job.path, "retry_pause"))
    if span == owner_span(plan, job.path):
        return ()
    return (Note("the pause before a retry", span),)


def _label(plan: DrivePlan, block: BlockRef) -> str:
    numbered = block.pinned or plan.target.v5
    return f"{block.kind}{block.number}" if numbered else f'"{block.name}"'
