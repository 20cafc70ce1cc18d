"""What a job adds to its block that repeats its last telegram until the drive has acknowledged its faults."""

from __future__ import annotations

from typing import Any

from plcgen.ds47.plan.nouns import DriveJob, DrivePlan
from plcgen.ds47.plan.pack import BLOCK_HEADER
from plcgen.ds47.views.parts import BlockParts
from plcgen.ds47.wire.model import HEADER_SIZE
from plcgen.ds47.words import ACKNOWLEDGE_WORDS


def _view(_: DrivePlan, job: DriveJob) -> dict[str, Any]:
    """Where the value lies that becomes 0, and where the codes of the faults lie."""
    asked, first = job.telegrams[-1], HEADER_SIZE + BLOCK_HEADER
    codes = next(f for f in asked.response.fields if f.role == "value" and f.part is asked.parts[-1])
    return {
        "bytes": range(first, first + asked.parts[0].size),
        "first_code": codes.offset,
        "last_code": codes.offset + asked.parts[-1].size - 1,
    }


def _times(job: DriveJob) -> list[tuple[str, int, str]]:
    assert job.poll is not None  # of such jobs only
    return [
        ("ACKNOWLEDGE_LIMIT", job.poll.limit, "ms, the longest time that the drive may take"),
        ("ACKNOWLEDGE_INTERVAL", job.poll.interval, "ms, from one question to the next"),
        ("ACKNOWLEDGE_STEP", 1000, "ms, the longest time between two calls that counts"),
    ]


PARTS = (
    BlockParts(
        name="acknowledge",
        precedence=20,
        has=lambda job: job.poll is not None and not job.poll.saves,
        template="plcgen.ds47.kinds.acknowledge:parts.scl.j2",
        view=_view,
        ends=3,
        times=_times,
        words=lambda _: ACKNOWLEDGE_WORDS,
        fails=True,
        ends_early=lambda _: True,
    ),
)
