"""When a channel must go on: its limits end in the first call in which their time is over, in no other."""

from __future__ import annotations

from plcgen.proof.scenario import ScenarioError
from plcgen.protocols.ds47.proof.engine.rig import EngineRig
from plcgen.protocols.ds47.proof.engine.scenario import EngineScenario
from plcgen.protocols.ds47.proof.words import BUILD, DRAIN, DRAIN_MS, PAUSE, STEP_MS, state_name


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
        self.draining: int | None = None

    def forget(self) -> None:
        """The CPU has started again: nobody knows what its blocks have counted."""
        self.state = self.unit.get("state")
        self.granted = self.pausing = self.draining = None

    def length(self) -> int:
        """Length of this scan in ms; a pause passes in one long scan and ends with a short one."""
        scenario = self.scenario
        if self.pausing is None or scenario.happens:
            return scenario.scan
        ends = [self.pausing + scenario.pause]
        if self.granted is not None:
            ends.append(self.granted + scenario.timeout)
        left = min(ends) - self.clock
        return min(left - scenario.scan, STEP_MS) if left > scenario.scan else max(left, 1)

    def observe(self, passed: int) -> None:
        """Hold the state behind a call to the clock."""
        self.clock += min(max(passed, 0), STEP_MS)
        before, self.state = self.state, self.unit.get("state")
        self.watch_timeout(before)
        self.watch_pause(before)
        self.watch_drain(before)

    def watch_timeout(self, before: int) -> None:
        """The timeout counts from the call that gives the unit, and ends whatever is done for the job then."""
        if not before and self.state:
            self.granted = self.clock
        if self.granted is None or not BUILD <= before <= PAUSE:
            return
        passed = self.clock - self.granted
        if passed >= self.scenario.timeout and self.state != DRAIN:
            raise ScenarioError(f"{passed} ms after the start, at a timeout of {self.scenario.timeout}, it goes on")

    def watch_pause(self, before: int) -> None:
        """A retry waits for the pause: no call less and none more."""
        if self.state == PAUSE and before != PAUSE:
            self.pausing = self.clock
        elif before == PAUSE and self.pausing is not None:
            passed = self.clock - self.pausing
            if self.state != DRAIN and (passed >= self.scenario.pause) != (self.state != PAUSE):
                name = state_name(self.state)
                raise ScenarioError(f"after {passed} ms of the pause of {self.scenario.pause} the state is {name}")
        if self.state != PAUSE:
            self.pausing = None

    def watch_drain(self, before: int) -> None:
        """A record call may be active for DRAIN_LIMIT behind the end of a telegram."""
        if self.state == DRAIN and before != DRAIN:
            self.draining = self.clock
        elif before == DRAIN and self.draining is not None:
            passed, active = self.clock - self.draining, self.rig.cpu.jobs > 0
            if (self.state != DRAIN) != (passed >= DRAIN_MS or not active):
                raise ScenarioError(f"after {passed} ms of DRAIN, record call {active}, it is {state_name(self.state)}")
