"""View of a job that sets a clock: the time at its input, and what becomes of it."""

from __future__ import annotations

from typing import Any

from plcgen.build.members import plain
from plcgen.build.nouns import MemberRow
from plcgen.build.spelling import declared_type
from plcgen.ds47.plan.nouns import DriveJob, DrivePlan
from plcgen.ds47.views.parts import BlockParts
from plcgen.ds47.words import CLOCK_WORDS

TIME = "utc"
"""The input."""


def time_inputs(plan: DrivePlan, job: DriveJob) -> list[MemberRow]:
    """The time that the drive is to have, if the job sets a clock."""
    if job.clock is None:
        return []
    return [plain(plan, TIME, declared_type(job.clock, tia=not plan.target.v5), "time that the drive is to have, UTC")]


def clock_view(plan: DrivePlan, job: DriveJob) -> dict[str, Any] | None:
    """What a block needs that makes days and milliseconds of a time."""
    if job.clock is None:
        return None
    fields = job.telegrams[0].request.fields  # their names are not those of the uses where the FAQ names them
    values = {id(field.part.use): field.name for field in fields if field.role == "value" and field.part is not None}
    days, milliseconds = (f"statRequest.{values[id(use)]}" for use in job.timed)
    return {
        "type": declared_type(job.clock, tia=not plan.target.v5),
        "parts": job.clock.name == "DTL",
        "days": days,
        "milliseconds": milliseconds,
        "converted": "DINT_TO_UDINT" if plan.target.t15 else "DINT_TO_DWORD",
    }


PARTS = (
    BlockParts(
        name="clock",
        precedence=70,
        has=lambda job: job.clock is not None,
        reserved=frozenset({"utc"}),
        template="plcgen.ds47.kinds.clock:parts.scl.j2",
        view=clock_view,
        ends=8,
        words=lambda _: CLOCK_WORDS,
        last_inputs=time_inputs,
    ),
)
