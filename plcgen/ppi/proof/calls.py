"""What the CPU does to a job of a PPI master: execute dropped, restarts, scan times, the clock starting again."""

from __future__ import annotations

from collections.abc import Iterator

from plcgen.ppi.proof.scenario import PpiScenario, loose
from plcgen.ppi.proof.words import DONE, WORDS

MOMENTS = 60
"""Scans of a job in which something happens to it, unless it is every one: more than a job of one telegram has."""

SENDING, LAST_CALLS = 5, 10
"""A scan in which a module sends; more calls than it takes to end if it is cancelled."""


def spread(first: int, last: int, most: int) -> list[int]:
    """At most so many numbers from ``first`` to ``last``, both among them, evenly far apart."""
    count = min(most, last - first + 1)
    return [first + (last - first) * number // max(1, count - 1) for number in range(count)]


def cpu_scenarios(scans: int, clock_end: int, ob1: int, *, retentive: bool, every: bool) -> Iterator[PpiScenario]:
    """Everything the CPU can do: execute dropped, restarts, scan times, the clock starting again.

    ``every`` takes every scan of a job, or else at most ``MOMENTS`` of them.
    """
    for scan in spread(2, scans, scans if every else MOMENTS):
        yield PpiScenario(name=f"execute dropped in scan {scan}", happens={scan: "drop"})
    for scan in spread(2, scans + 1, scans // 3 if every else min(scans, MOMENTS) // 3):
        yield loose(name=f"cold restart in scan {scan}", happens={scan: "cold"})
        status = (DONE, WORDS["TIMEOUT"], WORDS["NO_ANSWER"]) if retentive else (DONE,)
        yield loose(name=f"warm restart in scan {scan}", happens={scan: "warm"}, status=status)
    for scan in spread(scans // 4, scans * 3 // 4, scans if every else MOMENTS):
        ends = (WORDS["TIMEOUT"],) if scan <= scans // 3 else (WORDS["TIMEOUT"], DONE)  # the job may be over before
        yield loose(name=f"scan {scan} is as long as the timeout", happens={scan: "jump"}, status=ends)
    for scan in spread(2, scans // 3, scans // 6):
        yield loose(
            name=f"scans {scan} and {scan + 1} are as long as the timeout",
            happens={scan: "jump", scan + 1: "jump"},
            status=(WORDS["TIMEOUT"], WORDS["DRAIN_TIMEOUT"]),
        )
    for later in range(2, LAST_CALLS):  # the module's work ends in the very call in which nobody waits any more
        yield loose(
            name=f"scans {SENDING} and {SENDING + later} are as long as the timeout",
            happens={SENDING: "jump", SENDING + later: "jump"},
            status=(WORDS["TIMEOUT"], WORDS["DRAIN_TIMEOUT"]),
        )
    yield PpiScenario(
        name="the second scan is as long as the timeout", happens={2: "jump"}, status=(WORDS["TIMEOUT"],), polls=0
    )
    for length in sorted({1, min(3, ob1), min(20, ob1), ob1}):
        yield loose(name=f"scans of {length} ms", scan=length)
    yield loose(name="two calls in every millisecond", scan=1, twice=True)
    for number in range(5):
        yield loose(name=f"scans of random length {number}", wild=True)
    for before in (5, 60, 150):
        yield PpiScenario(name=f"the clock starts again after {before} ms", clock=clock_end - before)
