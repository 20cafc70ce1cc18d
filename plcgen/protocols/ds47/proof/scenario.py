"""Scenarios: what a drive and a CPU do to a job block, and what the block must report.

Expectations come from docs/generated-code.md and DS47, never from a run.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from math import ceil, gcd
from typing import Any

from plcgen.proof.scenario import Scenario
from plcgen.protocols.ds47.proof.words import WORDS
from plcgen.protocols.ds47.sim.faults import Fault

Edit = Callable[[bytes], bytes]
"""What becomes of the bytes of an answer on its way."""


@dataclass(frozen=True, slots=True)
class Foreign:
    """Another job that owns the drive when this one starts: ``alive`` for so many scans, then ``leaves`` or is dead.

    In scan ``follows`` a third job gets the drive, which is dead as well.
    """

    alive: int
    leaves: bool = False
    follows: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveScenario(Scenario):
    """One run of a job on a drive.

    ``writes`` and ``reads`` act on the n-th WRREC or RDREC that reaches the drive (0: on every one): a STATUS, or
    for a read an edit of the answer. ``stale`` reads deliver an older answer first. ``busy`` is how many calls of
    WRREC and RDREC answer BUSY. Besides what every scenario knows, ``reset`` restarts the clock of the CPU as well,
    ``lost`` forgets the running record calls, ``steal`` gives the drive to another job, ``away`` leaves the block
    uncalled. ``telegram`` and ``calls`` None are not checked. ``leftover`` says that a record call is still active at
    the end, ``factory`` that the drive has its factory settings. ``litter`` fills the buffers before a request is
    built, None with changing bytes.
    """

    faults: tuple[Fault, ...] = ()
    writes: Mapping[int, int] = field(default_factory=dict)
    reads: Mapping[int, int | Edit] = field(default_factory=dict)
    stale: range = range(0)
    silent: bool = False
    busy: tuple[int, int] = (1, 1)
    processing: int = 0
    generic: bool | None = None
    owner: Foreign | None = None
    heartbeat: int | None = None
    reference: int | None = None
    errors: Mapping[int, tuple[int, int]] = field(default_factory=dict)
    telegram: int | None = 0
    calls: tuple[int, int] | None = (0, 0)
    leftover: bool = False
    litter: bytes | None = None
    factory: bool = False


@dataclass(frozen=True, slots=True)
class TimeLimits:
    """Times of a block in ms as its head comment states them, and its retries.

    ``late`` is by how many calls its timers start later than its clock: 1 with IEC timers.
    """

    timeout: int
    pause: int
    retries: int
    drain: int
    lease: int
    late: int = 0

    def fits(self, waits: int, telegrams: int = 1) -> bool:
        """Whether a job with so many pauses, all in one telegram, ends well at scans of 10 ms."""
        return waits <= self.retries and waits * (self.pause + 60) + 150 * telegrams + 100 < self.timeout

    def after(self, waits: int, telegrams: int = 1, *, least: int | None = None, **good: Any) -> dict[str, Any]:
        """What is expected after so many pauses: ``good``, or that retries or time have run out.

        ``least`` is how many pauses it takes at least, if that may be fewer.
        """
        if self.fits(waits, telegrams):
            return good
        ends = {"TIMEOUT"} | ({"RETRIES"} if waits > self.retries else {"DONE"})
        if least is not None and least <= self.retries:
            ends.add("DONE")
        return {"status": tuple(WORDS[word] for word in sorted(ends)), "retries": None, "telegram": None, "calls": None}

    def timed_out(self, scan: int) -> int:
        """Time of a run in ms when TIMEOUT is noticed: in the first call in which it is over.

        The first call comes one scan after the start; the clock of S7-300/400 runs from that call on, an IEC timer
        from the next one (``late`` = 1).
        """
        return scan * (1 + self.late) + ceil(self.timeout / scan) * scan

    def drained(self, scan: int) -> int:
        """Time of a run in ms when DRAIN_LIMIT behind TIMEOUT is noticed."""
        return self.timed_out(scan) + scan * self.late + ceil(self.drain / scan) * scan

    def even(self, least: int) -> int:
        """The shortest scan of that length or longer that TIMEOUT and DRAIN_LIMIT are multiples of, if there is one."""
        common = gcd(self.timeout, self.drain)
        return next((scan for scan in range(least, 3 * least) if not common % scan), least)

    def repeated(self, scan: int, calls: int) -> tuple[int, ...]:
        """Result of a temporary error forever: retries run out, or the time does.

        ``calls`` is how many scans one try takes at least besides the pause.
        """
        fastest = self.retries * (self.pause + calls * scan)
        slowest = self.retries * (self.pause + (calls + 2) * scan) + 10 * scan
        if slowest < self.timeout:
            return (WORDS["RETRIES"],)
        if fastest > self.timeout + 2 * scan:
            return (WORDS["TIMEOUT"],)
        return WORDS["RETRIES"], WORDS["TIMEOUT"]
