"""When a step of a sequence that waits asks again: to the millisecond, by the clock that the block reads."""

from __future__ import annotations

from plcgen.ds47.kind import Wait
from plcgen.ds47.proof.block_clock import STANDSTILL_MS, BlockClock
from plcgen.ds47.proof.rig import JobRig
from plcgen.ds47.proof.words import STEP_MS, WORDS
from plcgen.proof.scenario import ScenarioError

FIRST, LAST_MS = 8, 20 * STEP_MS
"""So many questions fall to the millisecond, and those that long in front of the limit."""


class WaitTimes:
    """The questions of one run: the job asks for the unit when the interval behind the last one is over.

    The first question that is handed over when the limit is over, counted from the first of its step, is the last one.
    """

    def __init__(self, rig: JobRig) -> None:
        self.rig, self.clock = rig, BlockClock(rig)
        self.want, self.telegram = rig.unit.get("asks[1].want", signed=True), rig.telegram
        self.before: int | None = None
        """Telegrams in front of this turn at the unit; None: the job has not started."""
        self.awaited: Wait | None = None
        """Of the telegram that was handed over last."""
        self.first = self.asked = 0
        """When it was handed over first, and last."""
        self.pausing = 0
        """Calls since the job has given the unit back."""
        self.questions = 0
        """Of the step, until now."""
        self.stood = self.still = False
        """Whether the last scan took no time; whether the CPU has stood still."""

    def observe(self, telegram: int, *, busy: bool) -> None:
        """One call of the job is over, which has handed over this telegram. Raises ScenarioError."""
        want = self.rig.unit.get("asks[1].want", signed=True)
        time = self.clock.advance()
        if want > 0 and want != self.want:
            if self.before is None:
                self.before = 0
            else:
                self.before += self.telegram - 1
                self._again(time)
            self.pausing = telegram = self.telegram = 0
        self.want = want
        if telegram != self.telegram and telegram:
            self.telegram = telegram
            self._handed_over(time)
        self.pausing = self.pausing + 1 if busy and want < 0 else 0
        if self.pausing > 2 and self.awaited is not None and time - self.asked >= self.awaited.interval:
            raise ScenarioError(f"the unit is not asked for {time - self.asked} ms after the last question")

    def _again(self, time: int) -> None:
        """The unit is asked for once more: not too soon, nor behind the last question."""
        if self.awaited is None:
            return
        if time - self.asked < self.awaited.interval:
            raise ScenarioError(f"the unit is asked for {time - self.asked} ms after the last question")
        if self.asked - self.first >= self.awaited.limit:
            raise ScenarioError(f"one more question behind the one {self.asked - self.first} ms after the first")

    def _handed_over(self, time: int) -> None:
        """A telegram: in a turn that begins with a question it is one that was asked before."""
        again = self.before and self.telegram == 1
        telegrams, number = self.rig.job.telegrams, (self.before or 0) + self.telegram
        repeated = self.awaited is not None and self.telegram == 1
        self.awaited = telegrams[number - 1].awaited if number <= len(telegrams) else None
        self.asked = time
        if not (again or repeated):
            self.first, self.questions = time, 0
        self.questions += 1

    def length(self, usual: int, end: int) -> int:
        """Length of the next scan in ms, if calls fall where times are over.

        One falls 1 ms before the next question is due, another one at the same time, one when it is due; but the
        question that falls next to the limit falls ``end`` ms behind it. The CPU stands still once; of that ``STEP_MS``
        count. Of many questions those between the first ones and the last ones are asked whenever it suits.
        """
        if self.awaited is None:
            return usual
        if self.want > 0 and not self.telegram:
            last = self.first + self.awaited.limit + end - self.clock.time
            return last if 0 < last <= min(STEP_MS, self.awaited.interval) else 0
        if not self.pausing:
            return usual
        if not self.still:
            self.still = True
            return STANDSTILL_MS
        left = self.asked + self.awaited.interval - self.clock.time
        ends = self.first + self.awaited.limit - 2 * self.awaited.interval - LAST_MS
        if self.questions > FIRST and self.clock.time < ends:
            return STEP_MS
        if left == 1 and not self.stood:
            self.stood = True
            return 0
        self.stood = False
        return min(left - 1, STEP_MS) if left > 1 else max(left, 0)

    def end(self, status: int) -> None:
        """The job has ended. Raises ScenarioError."""
        if status == WORDS["NOT_REACHED"] and self.awaited and self.asked - self.first < self.awaited.limit:
            raise ScenarioError(f"given up after a question {self.asked - self.first} ms after the first")
