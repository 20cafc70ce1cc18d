"""When a block must go on: pauses and leases end in the first call in which their time is over, in no other."""

from __future__ import annotations

from plcgen.proof.scenario import ScenarioError
from plcgen.protocols.ds47.plan.nouns import DriveJob
from plcgen.protocols.ds47.proof.rig import JobRig
from plcgen.protocols.ds47.proof.scenario import DriveScenario
from plcgen.protocols.ds47.proof.words import (
    ACQUIRE,
    BUILD,
    CHECK,
    DRAIN,
    IDLE,
    READ,
    WAIT,
    WORDS,
    WRITE,
    state_name,
)  # fmt: skip


def transitions(job: DriveJob, *, classic: bool) -> frozenset[tuple[int, int]]:
    """From one call to the next, as docs/generated-code.md draws them; a CPU restart may lead anywhere.

    An end without a running record call drains and reports in one call: nothing runs in WAIT, and BUILD drains only
    if it finds a wrong DB number.
    """
    found = {(IDLE, ACQUIRE), (ACQUIRE, BUILD), (BUILD, WRITE), (WRITE, READ), (READ, CHECK), (DRAIN, IDLE)}
    found |= {(state, WAIT) for state in (WRITE, READ, CHECK)} | {(WAIT, state) for state in (BUILD, WRITE, READ)}
    found |= {(state, DRAIN) for state in (WRITE, READ, CHECK)}
    found |= {(state, IDLE) for state in (ACQUIRE, BUILD, WRITE, READ, CHECK, WAIT)}
    if not job.retries:
        found = {step for step in found if WAIT not in step}
    found |= {(CHECK, BUILD)} if len(job.telegrams) > 1 else set()
    return frozenset(found | {(BUILD, DRAIN)} if classic else found)


class Times:
    """Clock of a run. ``since`` are the calls in which pause and lease began, None if that is not known."""

    def __init__(self, rig: JobRig) -> None:
        self.rig = rig
        self.state: int = IDLE
        self.pausing = False
        self.pause_since: int | None = None
        self.lease_since: int | None = None
        self.timing: int | None = None
        self.seen: tuple[int, int] | None = None

    def length(self, scenario: DriveScenario, started: int) -> int:
        """Length of this scan in ms; a pause passes in one long scan and ends with a short one."""
        if self.pausing and self.pause_since is not None and not scenario.happens:
            limits = self.rig.limits
            over = self.pause_since + limits.pause, started + limits.timed_out(scenario.scan)
            left = min(over) - self.rig.cpu.clock
            return left - scenario.scan if left > scenario.scan else max(left, 1)
        return scenario.scan

    def observe(self, state: int, heartbeat: int, owner: int, now: int) -> None:
        """Hold the state behind a call to the clock; heartbeat and owner are those before it, ``now`` is the owner."""
        self.watch_pause(state)
        self.watch_timeout(state)
        self.watch_lease(heartbeat, owner, now)
        self.state = state

    def watch_pause(self, state: int) -> None:
        """A retry waits RETRY_PAUSE: no call less and none more."""
        limits, clock = self.rig.limits, self.rig.cpu.clock
        if state == WAIT and self.state != WAIT:
            self.pausing = True
            self.pause_since = None if limits.late else clock
            return
        if self.pausing and self.pause_since is None:
            self.pause_since = clock
        elif self.pausing and self.pause_since is not None and state in {BUILD, WRITE, READ, WAIT}:
            passed = clock - self.pause_since
            if (passed >= limits.pause) != (state != WAIT):
                raise ScenarioError(
                    f"after {passed} ms of the pause of {limits.pause} the state is {state_name(state)}"
                )
        self.pausing = self.pausing and state == WAIT

    def watch_timeout(self, state: int) -> None:
        """TIMEOUT ends a job in the first call in which it is over."""
        limits, clock = self.rig.limits, self.rig.cpu.clock
        begins = self.state == ACQUIRE and self.timing is None if limits.late else self.state == IDLE
        if begins:
            self.timing = clock
        if self.timing is None or self.state in {IDLE, DRAIN}:
            return
        passed = clock - self.timing
        if passed >= limits.timeout and state not in {IDLE, DRAIN}:
            raise ScenarioError(f"{passed} ms after the start, with a TIMEOUT of {limits.timeout}, the job goes on")
        if passed < limits.timeout and self.rig.db.get("status") == WORDS["TIMEOUT"]:
            raise ScenarioError(f"timeout {passed} ms after the start, TIMEOUT is {limits.timeout}")

    def watch_lease(self, heartbeat: int, owner: int, now: int) -> None:
        """A foreign owner keeps the drive as long as it shows itself, and LEASE longer."""
        limits, clock, own = self.rig.limits, self.rig.cpu.clock, self.rig.job.owner
        if self.state != ACQUIRE or (heartbeat, owner) != self.seen:
            self.lease_since = None if limits.late else clock
        elif self.lease_since is None:
            self.lease_since = clock
        self.seen = heartbeat, owner
        if self.state != ACQUIRE or owner in {0, own}:
            return
        passed = clock - self.lease_since if self.lease_since is not None else 0
        claimed = now == own
        if claimed != (passed >= limits.lease):
            verb = "claimed" if claimed else "not claimed"
            raise ScenarioError(f"the drive of a dead owner is {verb} after {passed} ms, LEASE is {limits.lease}")
