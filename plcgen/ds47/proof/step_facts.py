"""What must hold of a sequence: which telegrams it sends and how long it may wait; by hand."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from plcgen.ds47.kind import Wait
from plcgen.ds47.plan.access import Use
from plcgen.ds47.plan.nouns import DriveJob, DriveTelegram
from plcgen.ds47.proof.message_lists import Messages
from plcgen.ds47.proof.scenario import DriveScenario

TRIGGERS = {15, 970, 971, 972, 973, 974, 976, 977, 3900, 3981}
"""What starts something when it is written, as docs/generated-code.md lists them."""
FAILED = ("failedStep", "failedParameter")
"""Of a sequence: which step has failed, and which parameter."""


@dataclass(frozen=True, slots=True)
class Steps:
    """A scenario of a job whose steps wait.

    ``questions`` is how often a telegram is asked that waits, by its number; once if it is not there. ``missed`` is
    the parameter for which it has waited in vain; ``taken`` is for how many ms another job has the unit from the
    first time on that it is free while the job waits. Another job lives in the slot when the telegram ``robbed`` ends;
    0: none does. The CPU stands still for 1 s when the telegram ``still`` ends.
    """

    questions: Mapping[int, int] = field(default_factory=dict)
    missed: int = 0
    taken: int = 0
    robbed: int = 0
    still: int = 0


def triggers(use: Use) -> bool:
    """Whether a use starts something."""
    return use.writes and use.parameter.pnu in TRIGGERS


def overwritten(job: DriveJob, use: Use) -> bool:
    """Whether a later step of a sequence writes the parameter too, or waits for another value of it."""
    later = (one for one in job.uses if one.step > use.step and one.parameter.pnu == use.parameter.pnu)
    return any(one.writes or one.as_(Wait) is not None for one in later)


def longest_waits(job: DriveJob) -> int:
    """Time in ms that the steps of a sequence may wait, their last questions and other jobs in between included."""
    found = [telegram.awaited for telegram in job.telegrams if telegram.awaited is not None]
    return sum(awaited.limit + 2 * awaited.interval + job.timeout for awaited in found)


def route(job: DriveJob, scenario: DriveScenario) -> list[DriveTelegram]:
    """The telegrams of a run in the order in which they are handed over; each once where a restart may come between."""
    if not job.in_steps:
        return list(job.telegrams) * scenario.of(Messages).rounds
    questions = scenario.of(Steps).questions if scenario.again is not None else {}
    return [one for one in job.telegrams for _ in range(questions.get(one.number, 1))]
