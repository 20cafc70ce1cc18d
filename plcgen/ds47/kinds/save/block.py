"""What a job adds to its block that repeats its last telegram until the drive has saved."""

from __future__ import annotations

from typing import Any

from plcgen.ds47.plan.nouns import DriveJob, DrivePlan
from plcgen.ds47.plan.pack import BLOCK_HEADER
from plcgen.ds47.views.parts import BlockParts
from plcgen.ds47.wire.model import HEADER_SIZE
from plcgen.ds47.words import SAVE_WORDS, STATUS_WORDS

_REFUSED = {"STATUS_WRITE_ERROR", "STATUS_PARAMETER_ERROR", "STATUS_NOT_SUPPORTED"}
"""Results of a change of one parameter that the drive has not taken."""


def _view(_: DrivePlan, job: DriveJob) -> dict[str, Any]:
    """Where the value lies that becomes 0; ``asked`` is the number of the telegram that saves, ``before`` of the one
    in front of it.
    """
    asked = job.telegrams[-1]
    first = HEADER_SIZE + BLOCK_HEADER
    return {
        "refused": [f"W#16#{value:04X}" for name, value, _ in STATUS_WORDS if name in _REFUSED],
        "bytes": range(first, first + asked.parts[0].size),
        "asked": asked.number - 1,
        "before": asked.number - 2,
    }


def _times(job: DriveJob) -> list[tuple[str, int, str]]:
    assert job.poll is not None  # of such jobs only
    return [
        ("SAVE_LIMIT", job.poll.limit, "ms, the longest time that the drive may take"),
        ("SAVE_INTERVAL", job.poll.interval, "ms, from one question to the next"),
        ("SAVE_DISTANCE", job.poll.distance, "ms, from one save to the next"),
        ("SAVE_STEP", 1000, "ms, the longest time between two calls that counts"),
    ]


PARTS = (
    BlockParts(
        name="save",
        precedence=10,
        has=lambda job: job.poll is not None and job.poll.saves,
        reserved=frozenset({"saves", "save_limit", "save_interval", "save_distance", "save_step"}),
        template="plcgen.ds47.kinds.save:parts.scl.j2",
        view=_view,
        ends=2,
        times=_times,
        words=lambda _: SAVE_WORDS,
        fails=True,
        ends_early=lambda _: True,
    ),
)
