"""Scenarios of a job that saves: how long the drive takes, and how often it may be asked to."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from plcgen.ds47.kind import Poll
from plcgen.ds47.plan.access import Verify
from plcgen.ds47.plan.nouns import DriveJob
from plcgen.ds47.proof.deviating import another
from plcgen.ds47.proof.pace import SCAN
from plcgen.ds47.proof.poll_results import AnotherSave
from plcgen.ds47.proof.polling import FATAL_WRITE, LOST, before, not_supported, polling
from plcgen.ds47.proof.scenario import DriveScenario, KindScenarios
from plcgen.ds47.proof.words import WORDS
from plcgen.ds47.sim.faults import Fault, FaultKind

CLOCK_MS = 3000
"""What a clock loses when it begins again, once an hour on an S7-1200/1500: three of the longest calls that count."""


def saving(job: DriveJob, _: int) -> Iterator[DriveScenario]:
    """All of them."""
    assert job.poll is not None  # of such jobs only
    yield from polling(job, job.poll, WORDS["NOT_SAVED"])
    yield from _guard(job, job.poll)
    if job.verified:
        yield from _deviation(job)


def _guard(job: DriveJob, poll: Poll) -> Iterator[DriveScenario]:
    """Once in ``distance``: counted from a save that the drive has taken or may have taken, not from a refused one."""
    soon = (WORDS["TOO_SOON"],)
    save = before(job) + 1
    refused = Fault(FaultKind.ERROR, after=save - 1, number=0x11, position=1, words=1)
    near, far = poll.distance - 15, poll.distance + CLOCK_MS
    yield DriveScenario(name="a save before another", follow=False)
    yield DriveScenario(name="at once again", parts=(AnotherSave(since=0),), status=soon, checked=False, follow=False)
    yield DriveScenario(
        name="again just within the distance",
        parts=(AnotherSave(since=near),),
        status=soon,
        checked=False,
        follow=False,
    )
    yield DriveScenario(name="again after the distance", parts=(AnotherSave(since=far),), follow=False)
    yield DriveScenario(
        name="1 ms too soon", parts=(AnotherSave(left=SCAN + 1),), status=soon, checked=False, follow=False
    )
    yield DriveScenario(name="again behind the start that was too soon", parts=(AnotherSave(since=0),), follow=False)
    yield DriveScenario(
        name="a save of which nobody knows whether the drive took it",
        reads={save: LOST}, status=(WORDS["UNKNOWN"],), telegram=save, answered=False, follow=False,
    )  # fmt: skip
    yield DriveScenario(
        name="at once again, it may have", parts=(AnotherSave(since=0),), status=soon, checked=False, follow=False
    )
    for name, how in (
        ("refuses", {"faults": (refused,), "errors": {(save, 1): (0x8011, 0)}, "status": (WORDS["PARAMETER_ERROR"],)}),
        ("does not get", {"writes": {save: FATAL_WRITE}, "answered": False, "status": (WORDS["WRITE_ERROR"],)}),
        ("does not know", {"reads": {save: not_supported}, "answered": False, "status": (WORDS["NOT_SUPPORTED"],)}),
    ):
        yield DriveScenario(name=f"a save that the drive {name}", telegram=save, follow=False, **how)
        yield DriveScenario(
            name=f"at once again: the drive {name} the first", parts=(AnotherSave(since=0),), follow=False
        )


def _deviation(job: DriveJob) -> Iterator[DriveScenario]:
    """What is not as written is not saved; the next start may be at once."""
    telegram = next(one for one in job.telegrams if one.parts[0].use.as_(Verify))
    yield replace(another(telegram, 1), follow=False)
    yield DriveScenario(name="at once again: nothing was saved", parts=(AnotherSave(since=0),), follow=False)


SCENARIOS = (KindScenarios(20, lambda job: job.guarded, saving),)
