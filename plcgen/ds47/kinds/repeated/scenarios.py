"""Scenarios of a job with a cycle: it runs again, others go first, the drive is lost and comes back."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from plcgen.ds47.plan.nouns import DriveJob
from plcgen.ds47.proof.cycles import SLOW, Repeats, outlasts
from plcgen.ds47.proof.scenario import DriveScenario, KindScenarios


def repeating(job: DriveJob, _: int) -> Iterator[DriveScenario]:
    """All of them."""
    scan = max(1, min(10, job.cycle // 100))  # so that a run takes no longer than a cycle
    half, long = max(1, job.cycle // 2), 2 * job.cycle
    for name, repeats in (
        ("the job runs again", Repeats(goes_on=True, stopped=True)),
        ("another job has the unit when the cycle is over", Repeats(taken=half)),
        ("another job asks in the call in which the cycle is over", Repeats(taken=half, late=True)),
        ("another job keeps the unit for longer than a cycle", Repeats(taken=long)),
        ("another job has asked in vain and is not called any more", Repeats(goes_on=True, given_up=True)),
        ("the drive is lost and comes back", Repeats(away=True)),
    ):
        yield DriveScenario(name=name, scan=scan, parts=(repeats,), follow=False)
    slow = Repeats(goes_on=True, slow=True)
    long_run = DriveScenario(name="a run takes longer than a cycle", busy=(20, 1), parts=(slow,), follow=False)
    if not outlasts(job):  # its timeout ends a run before: it waits for the unit, of which the timeout does not count
        long_run = replace(long_run, busy=(1, 1), scan=scan, occupied=scan * (SLOW.stop + 1))
    yield long_run
    yield replace(
        long_run,
        name="execute rises after a run that takes longer than a cycle",
        happens={2: "drop"},
        at_once=True,
        checked=False,
        again=None,
        parts=(replace(slow, goes_on=False),),
    )


SCENARIOS = (KindScenarios(5, lambda job: job.cycle > 0, repeating),)
