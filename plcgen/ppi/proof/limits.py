"""How long the block stays in its states: it leaves one in the first call in which its time is over, and not before."""

from __future__ import annotations

from plcgen.ppi.proof.rig import MasterRig
from plcgen.ppi.proof.scenario import LOST_SCANS, PpiScenario
from plcgen.ppi.proof.words import DRAIN_MS, STATES_OF, State
from plcgen.ppi.sim import FaultKind
from plcgen.proof.runner import Run
from plcgen.proof.scenario import ScenarioError


class StateLimits:
    """Follows ``diagnostics.state`` call by call.

    ``begun`` is when the job started; ``state`` holds since ``since``, all in ms of the CPU's clock.
    """

    def __init__(self, rig: MasterRig) -> None:
        self.rig = rig
        self.known = STATES_OF["CP 341" if rig.plan.target.classic else "CM"]
        master = rig.master
        self.limits = {State.ACK: master.ack_timeout, State.REPLY: master.reply_timeout, State.DRAIN: DRAIN_MS}
        self.state = self.begun = self.since = self.retries = 0

    def observe(self, run: Run[PpiScenario]) -> None:
        """What must hold after a call."""
        state, now, busy = self.rig.db.get("state"), self.rig.cpu.clock, run.seen[0]
        lost = run.scenario.clock is not None and not self.rig.plan.target.classic
        slack = LOST_SCANS * run.scenario.scan if lost else 0
        if run.fresh:
            self.begun = now
        if state not in self.known:
            raise ScenarioError(f"diagnostics.state is {state}, which a master with this module does not have")
        if busy and state == State.IDLE and self.rig.port.sent:
            raise ScenarioError("diagnostics.state is 0 while the job runs")
        if busy and state != State.DRAIN and now - self.begun >= self.rig.job.timeout + slack:
            raise ScenarioError(f"still in state {state} when the job's timeout is over")
        if state != self.state:
            refused = any(each.kind is FaultKind.NACK for each in run.scenario.faults)
            self._change(state, now, exact=run.scenario.pace is not None and not refused)
        elif state in self.limits and now - self.since >= self.limits[State(state)] + slack:
            raise ScenarioError(f"still in state {state} {now - self.since} ms after it began")

    def _change(self, state: int, now: int, *, exact: bool) -> None:
        """Another state: it begins, and the one before has not ended too early.

        ``exact``: nothing but its time ends ACK, REPLY and a pause, or the station is not ready.
        """
        retries, passed = self.rig.db.get("retries"), now - self.since
        if exact and (retries > self.retries or self.state == State.WAIT):
            least = self.limits.get(State(self.state), 0)
            if self.state != State.DRAIN and passed < least:
                raise ScenarioError(f"state {self.state} ends {passed} ms after it began, not {least}")
        if state == State.WAIT:
            master = self.rig.master
            self.limits[State.WAIT] = master.retry_pause if retries > self.retries else master.poll_pause
        self.state, self.since, self.retries = state, now, retries
