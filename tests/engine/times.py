"""When a channel must go on: its limits end in the first call in which their time is over, in no other."""

from __future__ import annotations

from plcgen.ds47.proof.words import DRAIN, DRAIN_MS, HOLD, PAUSE, SHORT_PAUSES, STEP_MS, WORDS, state_name
from plcgen.proof.scenario import ScenarioError
from tests.engine.rig import EngineRig
from tests.engine.scenario import EngineScenario

NO_ANSWER_YET = 0x80B5
"""Error_Decode and Error_Code_1 of STATUS."""
TIMED_OUT = frozenset({WORDS["TIMEOUT"], WORDS["NO_PLACE"]})


class ChannelTimes:
    """Clock of one unit in one run; a limit is None as long as it is not known when it began.

    Every time between two calls counts for STEP_LIMIT at most, so that the clock here counts the same.
    """

    def __init__(self, rig: EngineRig, scenario: EngineScenario) -> None:
        self.rig, self.scenario, self.unit = rig, scenario, rig.units[0]
        self.state = self.unit.get("state")
        self.clock = 0
        self.granted: int | None = None
        self.pausing: int | None = None
        self.pause = 0
        """Length of this pause in ms."""
        self.draining: int | None = None
        self.heard = 0
        """Record calls that the drive had answered behind the last call."""
        self.served = 0
        self.early = False
        """Whether the last telegram of the job ended before its timeout."""

    def forget(self) -> None:
        """The CPU has started again: nobody knows what its blocks have counted."""
        self.state = self.unit.get("state")
        self.granted = self.pausing = self.draining = None

    def length(self) -> int:
        """Length of this scan in ms: a pause passes in a long one, the last millisecond of each limit in another."""
        scenario = self.scenario
        begun = ((self.pausing, self.pause), (self.granted, scenario.timeout), (self.draining, DRAIN_MS))
        left = [at + limit - self.clock for at, limit in begun if at is not None and at + limit > self.clock]
        if scenario.happens or not left or scenario.scan > STEP_MS:
            return scenario.scan
        longest = scenario.scan if self.pausing is None or not self.pause else STEP_MS
        return min(max(min(left) - 1, 1), longest)

    def observe(self, passed: int) -> None:
        """Hold the state behind a call to the clock."""
        self.clock += min(max(passed, 0), STEP_MS)
        before, self.state = self.state, self.unit.get("state")
        self.watch_timeout(before)
        self.watch_pause(before)
        self.watch_drain(before)
        self.heard = len(self.rig.drives[0].journal)

    def watch_timeout(self, before: int) -> None:
        """The timeout counts from the call that gives the unit, and ends whatever is done for the job then."""
        if not before and self.state:
            self.granted = self.clock
        if self.granted is None:
            return
        passed = self.clock - self.granted
        served, self.served = self.served, self.unit.get("turn.served")
        if before != DRAIN and (self.state == DRAIN or self.served != served):
            self.early = passed < self.scenario.timeout  # what comes in DRAIN and behind it changes no result
        if HOLD < before < DRAIN and passed >= self.scenario.timeout and self.state not in {DRAIN, HOLD}:
            raise ScenarioError(f"{passed} ms after the start, at a timeout of {self.scenario.timeout}, it goes on")

    def check_end(self, status: int) -> None:
        """No timeout before its time."""
        if self.early and self.granted is not None and status in TIMED_OUT:
            raise ScenarioError(f"16#{status:04X} before the timeout of {self.scenario.timeout} ms")

    def watch_pause(self, before: int) -> None:
        """A retry waits for the pause: no call less and none more."""
        if self.state == PAUSE and before != PAUSE:
            self.pausing, self.pause = self.clock, self.next_pause()
        elif before == PAUSE and self.pausing is not None:
            passed = self.clock - self.pausing
            if self.state != HOLD and (passed >= self.pause) != (self.state != PAUSE):
                name = state_name(self.state)
                raise ScenarioError(f"after {passed} ms of the pause of {self.pause} the state is {name}")
        if self.state != PAUSE:
            self.pausing = None

    def next_pause(self) -> int:
        """The first retries of a telegram that has no answer yet come soon."""
        tried, journal = self.unit.get("retries") - 1, self.rig.drives[0].journal
        came = len(journal) > self.heard and journal[-1].status >> 8 & 0xFFFF == NO_ANSWER_YET
        soon = came and tried < len(SHORT_PAUSES)
        return min(SHORT_PAUSES[tried], self.scenario.pause) if soon else self.scenario.pause

    def watch_drain(self, before: int) -> None:
        """A record call may be active for DRAIN_LIMIT behind the end of a telegram."""
        if self.state == DRAIN and before != DRAIN:
            self.draining = self.clock
        elif before == DRAIN and self.draining is not None:
            passed, active = self.clock - self.draining, self.rig.cpu.jobs > 0
            if (self.state != DRAIN) != (passed >= DRAIN_MS or not active):
                raise ScenarioError(f"after {passed} ms of DRAIN, record call {active}, it is {state_name(self.state)}")
