"""The clock of a job that waits, as the block reads it: what it loses when it begins again is lost here too."""

from __future__ import annotations

from plcgen.ds47.proof.rig import CLOCK, JobRig
from plcgen.ds47.proof.words import STEP_MS

STANDSTILL_MS = 3000
"""So long the CPU stands still once."""


class BlockClock:
    """``time`` of a run in ms: what the block must count of it."""

    def __init__(self, rig: JobRig) -> None:
        self.rig, self.time = rig, 0
        self._now = rig.db.get(CLOCK, signed=True)

    def advance(self) -> int:
        """The time behind one more call; of the time between two calls ``STEP_MS`` count at most."""
        now = self.rig.db.get(CLOCK, signed=True)
        self.time += min(max(now - self._now, 0), STEP_MS)
        self._now = now
        return self.time
