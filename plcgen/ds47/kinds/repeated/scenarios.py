"""Scenarios of a job with a cycle: it runs again, others go first, the drive is lost and comes back."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from plcgen.ds47.plan.nouns import DriveJob
from plcgen.ds47.proof.cycles import Repeats, outlasts
from plcgen.ds47.proof.scenario import DriveScenario, KindScenarios
from plcgen.ds47.proof.words import DONE, WORDS


def repeating(job: DriveJob, _: int) -> Iterator[DriveScenario]:
    """All of them."""
    scan = max(1, min(10, job.cycle // 100))  # so that a run takes no longer than a cycle
    half, long = max(1, job.cycle // 2), 2 * job.cycle
    for name, repeats in (
        ("the job runs again", Repeats(goes_on=True, stopped=True)),
        ("another job has the unit when the cycle is over", Repeats(taken=half)),
        ("another job keeps the unit for longer than a cycle", Repeats(taken=long)),
        ("another job has asked in vain and is not called any more", Repeats(goes_on=True, given_up=True)),
        ("the drive is lost and comes back", Repeats(away=True)),
    ):
        yield DriveScenario(name=name, scan=scan, parts=(repeats,), follow=False)
    slow = Repeats(goes_on=True, slow=True)
    enough = outlasts(job)
    if enough:
        yield DriveScenario(name="a run takes longer than a cycle", busy=(20, 1), parts=(slow,), follow=False)
    yield DriveScenario(
        name="execute rises after a run that takes longer than a cycle",
        busy=(20, 1),
        status=(DONE,) if enough else (DONE, WORDS["TIMEOUT"], WORDS["DRAIN_TIMEOUT"], WORDS["NO_PLACE"]),
        happens={2: "drop"},
        at_once=enough,
        checked=False,
        again=None,
        parts=(replace(slow, goes_on=False),),
        follow=False,
    )


SCENARIOS = (KindScenarios(5, lambda job: job.cycle > 0, repeating),)
