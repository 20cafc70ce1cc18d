"""When a job asks whether the drive has saved or acknowledged: to the millisecond, by the clock of the block."""

from __future__ import annotations

from plcgen.ds47.kind import Poll
from plcgen.ds47.proof.block_clock import STANDSTILL_MS, BlockClock
from plcgen.ds47.proof.restoration import CAUSE
from plcgen.ds47.proof.rig import REST, JobRig
from plcgen.ds47.proof.words import STEP_MS, WORDS
from plcgen.proof.scenario import ScenarioError

NOT_TAKEN = tuple(WORDS[name] for name in ("WRITE_ERROR", "PARAMETER_ERROR", "NOT_SUPPORTED"))
"""How a job ends that knows that the drive has not taken the save."""
GIVEN_UP = tuple(WORDS[name] for name in ("NOT_SAVED", "NOT_ACKNOWLEDGED", "FAULTS_REMAIN"))
"""How one ends whose last question said no."""


class PollTimes:
    """The questions of one run: the first an interval behind the answer to the write, each other one behind the last.

    The first that is handed over when the limit is over is the last one.
    """

    def __init__(self, rig: JobRig, poll: Poll) -> None:
        self.rig, self.poll = rig, poll
        self.clock = BlockClock(rig)
        self.telegram = 0
        self.writes = False
        """Whether the telegram handed over last is the write."""
        self.taken: int | None = None
        """When the job heard that the drive has taken the write."""
        self.asked = 0
        """When the last question was handed over, or the write taken."""
        self.served = 0
        """The telegram that had its answer when the job was called last."""
        self.answered = False
        """Whether the telegram handed over last has its answer."""
        self.stood = self.still = False
        """Whether the last scan took no time; whether the CPU has stood still."""

    def observe(self, telegram: int, *, busy: bool) -> None:
        """One call of the job is over, which has handed over this telegram. Raises ScenarioError."""
        self.clock.advance()
        if telegram != self.telegram:
            self.telegram, self.answered = telegram, False
            self._handed_over()
        elif busy and self.served == self.telegram:
            self.answered = True
            if self.taken is None:
                if self.writes:
                    self.taken = self.asked = self.clock.time
            elif self.clock.time - self.asked >= self.poll.interval:
                raise ScenarioError(f"no question {self.clock.time - self.asked} ms after the one before")
        self.served = self.rig.unit.get("turn.served")

    def _handed_over(self) -> None:
        """A telegram: a question must not come too soon, nor behind the last one."""
        if not self.telegram:
            self.writes, self.taken = False, None  # the job has started
            return
        write, question = (request[1:] for request in self.rig.requests()[-2:])
        if self.taken is None and self.writes:
            self.taken = self.asked = self.clock.time
        if self.taken is None:
            self.writes = self.rig.handed_over(1 + len(write))[1:] == write
        elif self.rig.handed_over(1 + len(question))[1:] == question:
            waited, since = self.clock.time - self.asked, self.asked - self.taken
            if waited < self.poll.interval:
                raise ScenarioError(f"a question {waited} ms after the one before")
            if since >= self.poll.limit:
                raise ScenarioError(f"a question behind the one {since} ms after the answer to the write")
            self.writes, self.asked = False, self.clock.time

    def length(self, usual: int, end: int) -> int:
        """Length of the next scan in ms, if calls fall where times are over.

        One falls 1 ms before a question is due, another one at the same time, one when it is due; but the question
        that falls next to the limit falls ``end`` ms behind it. The CPU stands still once; of that ``STEP_MS`` count.
        """
        if self.taken is None or not self.answered:
            return usual
        if self.asked > self.taken and not self.still:
            self.still = True
            return STANDSTILL_MS
        left = self.asked + self.poll.interval - self.clock.time
        if left > 1:
            self.stood = False
            return left - 1
        if left == 1 and not self.stood:
            self.stood = True
            return 0
        last = self.taken + self.poll.limit + end - self.clock.time
        return last if left < last <= min(STEP_MS, self.poll.interval) else left if left > 0 else usual

    def end(self, status: int) -> None:
        """The job has ended: what the drive has not taken counts for nothing. Raises ScenarioError."""
        cause = self.rig.db.get(CAUSE) if self.rig.job.restores else status
        if self.writes and cause in NOT_TAKEN and self.rig.job.guarded and self.rig.db.get(REST, signed=True) > 0:
            raise ScenarioError("the next start has to wait, but nothing was saved")
        if cause in GIVEN_UP and self.taken is not None and self.asked - self.taken < self.poll.limit:
            raise ScenarioError(f"given up after a question {self.asked - self.taken} ms after the answer to the write")
