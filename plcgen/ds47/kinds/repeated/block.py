"""What a cycle adds to the block of a job: its times, and how old the values are."""

from __future__ import annotations

from collections.abc import Iterator

from plcgen.build.members import plain
from plcgen.build.nouns import CallerValue
from plcgen.build.spelling import type_words
from plcgen.ds47.kinds.repeated import LEAST_VALID_MS, OLDEST_MS, VALID, WAITS
from plcgen.ds47.plan.nouns import DriveJob, DrivePlan
from plcgen.ds47.views.parts import BlockParts


def age_values(plan: DrivePlan, _: DriveJob) -> Iterator[CallerValue]:
    """Whether the values are new enough, and how old they are."""
    words = type_words(tia=not plan.target.v5)
    valid = plain(plan, "valid", words["BOOL"], f"the values are at most {VALID} cycles old")
    age = plain(plan, "age", words["TIME"], "time since the start of the last run that ended well")
    yield CallerValue(valid, (("", "Bool"),))
    yield CallerValue(age, (("", "Time"),))


def _times(job: DriveJob) -> list[tuple[str, int, str]]:
    return [
        ("CYCLE", job.cycle, "ms, from one start to the next"),
        ("CYCLE_WAITS", WAITS * job.cycle, "ms since the last start, until then other jobs of the unit go first"),
        ("VALID_LIMIT", max(LEAST_VALID_MS, VALID * job.cycle), "ms, values that are older are not valid"),
        ("OLDEST", OLDEST_MS, "ms, so old or older, or no values yet"),
    ]


PARTS = (
    BlockParts(
        name="cycle",
        precedence=5,
        has=lambda job: job.cycle > 0,
        members=frozenset({"valid", "age"}),
        reserved=frozenset({"cycle", "cycle_waits", "valid_limit", "oldest"}),
        template="plcgen.ds47.kinds.repeated:parts.scl.j2",
        view=lambda _, job: job.cycle,
        times=_times,
        outputs=age_values,
    ),
)
