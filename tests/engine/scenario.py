"""Scenarios of the engine: what drive and CPU do to one job, and what must come of it.

Expectations come from docs/generated-code.md and DS47, never from a run.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from math import ceil

from plcgen.ds47.proof.words import DRAIN_MS, STEP_MS
from plcgen.ds47.sim.faults import Fault
from plcgen.proof.scenario import Scenario

Edit = Callable[[bytes], bytes]
"""What becomes of the bytes of an answer on its way."""
TIMEOUT, PAUSE, RETRIES = 9000, 200, 10
"""Times in ms and retries of an ordinary order."""
CALLS = (1, 5, 2)
"""What OB1 calls: the gate, the job, the channel."""


@dataclass(frozen=True, slots=True, kw_only=True)
class EngineScenario(Scenario):
    """One run of a job.

    ``writes`` and ``reads`` act on the n-th WRREC or RDREC that reaches the drive (0: on every one): a STATUS, or for
    a read an edit of the answer. ``stale`` reads deliver an older answer first, ``swallowed`` requests are taken and
    never answered, before ``away`` reads the drive is switched off and on. ``busy`` is how many calls of WRREC and
    RDREC answer BUSY, None forever. Besides what every scenario knows, ``lost`` forgets the running record calls.

    ``telegram`` is the one that ends the job, 0 the last. ``calls`` are WRREC and RDREC on the wire besides one for
    each telegram, ``again`` how many requests were built again; None is not checked. ``errors`` are stated by hand:
    (errors, infos) by parameter; those of all other parameters follow from the answer. ``leftover`` says that a record
    call is still active at the end, ``litter`` fills the buffers before a request is built. ``order``: what OB1 calls.
    """

    faults: tuple[Fault, ...] = ()
    writes: Mapping[int, int] = field(default_factory=dict)
    reads: Mapping[int, int | Edit] = field(default_factory=dict)
    stale: range = range(0)
    swallowed: range = range(0)
    away: range = range(0)
    busy: tuple[int | None, int | None] = (1, 1)
    processing: int = 0
    generic: bool = False
    errors: Mapping[int, tuple[int, int]] = field(default_factory=dict)
    telegram: int | None = 0
    calls: tuple[int, int] | None = (0, 0)
    again: int | None = 0
    leftover: bool = False
    litter: bytes | None = None
    timeout: int = TIMEOUT
    pause: int = PAUSE
    most: int = RETRIES
    order: tuple[int, ...] = CALLS

    def over(self, limit: int) -> int:
        """Time from the start of a limit to the first call in which it is over."""
        return ceil(limit / self.scan) * self.scan

    @property
    def latest(self) -> int:
        """After how many ms at the latest a job that has its unit at once must have ended."""
        limits = self.timeout + DRAIN_MS
        return limits * max(1, ceil(self.scan / STEP_MS)) + 12 * (50 if self.jitter else self.scan)
