"""Jobs with a cycle, stated by hand: when the next run begins, who goes first, how old the values are.

``cycle`` is counted from the call in which a run starts. When it is over the next one starts if nobody else has the
unit or asks for it, after two cycles in any case. ``age`` counts from the start of the last run that ended well,
``valid`` says that it is at most three cycles, at least 1 s.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from plcgen.ds47.plan.nouns import DriveJob
from plcgen.ds47.proof.words import STEP_MS
from plcgen.proof.rig import Members

AGE = ("valid", "age")
SINCE = "statSince"
"""Time of a job since its last start: set to 0 by what must not be disturbed by another run."""


SLOW = range(2, 9)


@dataclass(frozen=True, slots=True)
class Repeats:
    """A scenario in which execute stays: the job runs again.

    ``taken``: from the end on another job has the unit for so many ms, with ``late`` from the call on in which the
    cycle is over. ``away``: the drive is not there for the next
    runs, until the values are too old, and comes back. ``given_up``: another instance has asked in vain and is not
    called any more. ``stopped``: execute falls, and for two cycles nothing happens. ``slow``: the run itself takes
    longer than a cycle, as ``SLOW`` scans of half a cycle each are in it, or a whole one.
    """

    goes_on: bool = False
    taken: int = 0
    late: bool = False
    away: bool = False
    given_up: bool = False
    slow: bool = False
    stopped: bool = False


def outlasts(job: DriveJob) -> bool:
    """Whether a run of a job can take longer than ``SLOW`` scans: of each of them its timeout counts a part at most."""
    return job.timeout > (len(SLOW) + 1) * STEP_MS


def slow_scan(job: DriveJob, *, waits: bool) -> int:
    """Length of each of the ``SLOW`` scans in ms; where the first ends a run that has the unit, a whole cycle."""
    return max(1, job.cycle // 2 if waits or outlasts(job) else job.cycle)


def cycle_signals(job: DriveJob) -> tuple[str, ...]:
    """What a job with a cycle has at its block besides."""
    return AGE if job.cycle else ()


def oldest_valid(job: DriveJob) -> int:
    """For how many ms values are valid."""
    return max(1000, 3 * job.cycle)


def hold_back(members: Members, jobs: Iterable[DriveJob]) -> None:
    """No cycle is over in the next call of these instances."""
    for job in jobs:
        if job.cycle:
            members.set(f"{job.member}.{SINCE}", 0)
