"""View of a job that reads back what it has written: which bytes of its answers are compared with which it has sent."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from plcgen.ds47.plan.access import Use, Verify
from plcgen.ds47.plan.nouns import DriveJob, DriveTelegram
from plcgen.ds47.views.parts import BlockParts
from plcgen.ds47.wire.formats import FormatKind, unpack_values
from plcgen.ds47.words import ERROR_DEVIATES, VERIFY_WORDS


def readback_view(job: DriveJob) -> dict[str, Any]:
    """What a block needs that reads back: which bytes of each telegram belong to which of a request."""
    read = _read_back(job)
    found: list[dict[str, Any]] = [
        {
            "number": telegram.number,
            "compared": list(_comparisons(job, telegram)),
            "stops": telegram is not job.telegrams[-1] and not job.restores,
        }
        for telegram in read
    ]
    values = [value for telegram in found for value in telegram["compared"]]
    return {
        "telegrams": found,
        "many": len(found) > 1,
        "stops": stops(job),
        "ends": stops(job) and job.poll is None and not job.restores,
        "floats": any(value["float"] for value in values),
        "zeros": any(value["zero"] for value in values),
    }


def _read_back(job: DriveJob) -> list[DriveTelegram]:
    """Telegrams that ask for what was written."""
    return [telegram for telegram in job.telegrams if any(part.use.as_(Verify) for part in telegram.parts)]


def stops(job: DriveJob) -> bool:
    """Whether something would be sent behind a difference."""
    return job.verified and _read_back(job)[0] is not job.telegrams[-1]


def _comparisons(job: DriveJob, answer: DriveTelegram) -> Iterator[dict[str, Any]]:
    """The values of an answer that one request has sent: where both begin, how many of which size.

    ``opens``: the first ones of their parameter.
    """
    asked = [(telegram, field) for telegram in job.telegrams if telegram.writes for field in telegram.request.fields]
    blocks = {id(part): number for number, part in enumerate(answer.parts, 1)}
    for came in answer.response.fields:
        if came.role != "value" or came.part is None:
            continue
        found, size, opens = came.part, came.part.use.format.size, True
        back = found.use.as_(Verify)
        for telegram, sent in asked:
            if sent.role != "value" or sent.part is None or back is None or sent.part.use is not back.of:
                continue
            start = max(found.start, sent.part.start)
            count = min(found.start + found.count, sent.part.start + sent.part.count) - start
            if count > 0:
                yield {
                    "label": found.use.label,
                    "opens": opens,
                    "block": blocks[id(found)],
                    "request": f"statRequestBytes{job.suffix(telegram)}",
                    "sent": sent.offset + (start - sent.part.start) * size,
                    "found": came.offset + (start - found.start) * size,
                    "size": size,
                    "last_byte": size - 1,
                    "last": count - 1,
                    "first": found.use.subindex + start,
                    "shift": f" + {found.use.subindex + start}" if found.use.subindex + start else "",
                    "first_word": f"W#16#{found.use.subindex + start:04X}",
                    "float": found.use.format.kind is FormatKind.FLOAT,
                    "zero": _may_be_zero(sent.part.use, start, count),
                }
                opens = False


def _may_be_zero(use: Use, start: int, count: int) -> bool:
    """Whether a number in floating point among those that are sent may be 0, which has two signs."""
    if use.format.kind is not FormatKind.FLOAT:
        return False
    if use.constant:
        size = use.format.size
        return 0 in unpack_values(use.format, count, use.data[start * size : (start + count) * size])
    low, high = use.parameter.minimum, use.parameter.maximum
    return (low is None or low <= 0) and (high is None or high >= 0)


PARTS = (
    BlockParts(
        name="readback",
        precedence=30,
        has=lambda job: job.verified,
        reserved=frozenset({"error_deviates"}),
        template="plcgen.ds47.kinds.readback:parts.scl.j2",
        view=lambda _, job: readback_view(job),
        ends=7,
        words=lambda _: (
            ("ERROR_DEVIATES", ERROR_DEVIATES, "of a parameter: the drive has another value"),
            *VERIFY_WORDS,
        ),
        results=(
            "per parameter: 0 good, 16#80nn error nn, 16#81ff type ff came, 16#8200 another value, 16#FFFF no answer",
            "second error word, number of values that came, or index of the first other value",
        ),
        fails=True,
        ends_early=stops,
    ),
)
