"""What goes on around the calls of a job block, and what must hold behind every one of them."""

from __future__ import annotations

from plcgen.proof.runner import MAX_SCANS, Run
from plcgen.proof.scenario import ScenarioError
from plcgen.protocols.ds47.proof.end import End
from plcgen.protocols.ds47.proof.rig import JobRig
from plcgen.protocols.ds47.proof.scenario import DriveScenario
from plcgen.protocols.ds47.proof.times import Times, transitions
from plcgen.protocols.ds47.proof.words import (
    ACQUIRE,
    BUILD,
    DRAIN,
    FOREIGN,
    HEARTBEATS,
    IDLE,
    WAIT,
    WORDS,
    state_name,
)  # fmt: skip

LITTER = (b"\x40\x00", b"\x44\x02\x00\x11\x00\x07", b"\xa5")
"""What the buffers hold before a request is built: good blocks, error blocks, garbage. None of it may count."""
AWAY_MS = 1000
"""Time beside LEASE for which the block is not called when it is ``away``."""


class JobConduct:
    """One job, run by run.

    ``state`` is that behind the last call, ``reference`` the last one before the run, None if it is not known.
    ``stolen`` says that another job has taken the drive, ``lost`` what must follow the loss of a record call.
    """

    def __init__(self, rig: JobRig) -> None:
        self.rig = rig
        self.transitions = transitions(rig.job, classic=rig.plan.target.classic)
        self.late = 0
        """Time in ms for which the drive still works on the answer to the run before."""
        self.state: int = IDLE
        self.stolen = False
        self.lost = ""
        self.reference: int | None = None
        self.times = Times(rig)
        self.heartbeat = self.owner = 0

    def plain(self, name: str) -> DriveScenario:
        """A run of which only the result counts."""
        return DriveScenario(name=name, retries=None, calls=None)

    def title(self, scenario: DriveScenario) -> str:
        """There is one job in the block."""
        return scenario.name

    def outputs(self) -> object:
        """All value outputs."""
        return self.rig.outputs()

    def where(self) -> str:
        """State behind the last call."""
        return state_name(self.state)

    def holds(self) -> bool:
        """The result stays as long as execute does."""
        return True

    def begin(self, run: Run[DriveScenario]) -> int:
        """Set up drive, bus, token and clock."""
        rig, scenario, limits = self.rig, run.scenario, self.rig.limits
        rig.cpu.clock += self.late
        rig.bus.advance(self.late)
        self.late = 0 if scenario.follow else scenario.processing
        rig.next_values(factory=scenario.factory)
        rig.drive.begin(scenario)
        rig.bus.write_busy, rig.bus.read_busy = scenario.busy
        if scenario.clock is not None:
            rig.cpu.clock = scenario.clock
            rig.db.set("execute", 0)
            rig.cpu.call(rig.db.block, 0)
        owner = FOREIGN if scenario.owner is not None else None
        for name, value in (
            ("heartbeat", scenario.heartbeat), ("requestReference", scenario.reference), ("owner", owner),
        ):  # fmt: skip
            if value is not None:
                rig.token.set(name, value)
        self.reference = rig.token.get("requestReference", signed=True)
        self.state, self.stolen, self.lost, self.times = IDLE, False, "", Times(rig)
        slack = 6 * (50 if scenario.jitter else scenario.scan)
        away = limits.lease + AWAY_MS if "away" in scenario.happens.values() else 0
        return limits.timeout + limits.drain + slack + away

    def happen(self, run: Run[DriveScenario], happening: str) -> None:
        """A restart, or what only a drive's job knows."""
        rig = self.rig
        if happening in {"cold", "warm", "reset"}:
            if happening == "reset":
                rig.cpu.clock = 0
            self.state = rig.db.get("state")
            self.times = Times(rig)
            self.times.state = self.state
            self.reference = None
            rig.put_inputs()
        elif happening == "lost":
            self.lost = "call" if rig.cpu.jobs and rig.limits.retries else ""
            rig.cpu.drop_records()
            self.reference = None
        elif happening == "steal":
            rig.token.set("owner", FOREIGN)
            self.stolen = True
        elif happening == "away":
            rig.cpu.clock += rig.limits.lease + AWAY_MS
            rig.bus.advance(rig.limits.lease + AWAY_MS)

    def scan(self, run: Run[DriveScenario]) -> int:
        """The other job, litter for a request that is about to be built."""
        token, scenario, owner = self.rig.token, run.scenario, run.scenario.owner
        if owner is not None and token.get("owner") in {FOREIGN, FOREIGN + 1}:
            if run.scans == owner.follows:
                token.set("owner", FOREIGN + 1)
            if run.scans <= owner.alive:
                token.set("heartbeat", token.get("heartbeat") % HEARTBEATS + 1)
            elif owner.leaves:
                token.set("owner", 0)
        if self.state == BUILD:
            self.rig.litter(scenario.litter or LITTER[run.statistics.runs % len(LITTER)])
        self.heartbeat, self.owner = token.get("heartbeat", signed=True), token.get("owner", signed=True)
        return self.times.length(scenario, run.started)

    # --- every scan -----------------------------------------------------------------------------------

    def start(self, run: Run[DriveScenario]) -> None:
        """Everything of the job before is gone."""
        rig = self.rig
        left = [n for n in ("recordStatus", "retries", "responseLength", "failedParameter") if rig.db.get(n)]
        if rig.db.get("telegram") != 1:
            left.append("telegram")
        left += [name for name in ("errors", "errorInfos") if any(rig.words(name))]
        if left:
            raise ScenarioError(f"{', '.join(left)} still show the job before")

    def observe(self, run: Run[DriveScenario]) -> None:
        """State, owner, heartbeat, record calls and clock."""
        rig, state = self.rig, self.rig.db.get("state")
        busy, done, _, _ = run.seen
        if busy != (state != IDLE):
            raise ScenarioError(f"busy is {busy} in state {state_name(state)}")
        if state != self.state:
            if (self.state, state) not in self.transitions:
                raise ScenarioError(f"state goes from {state_name(self.state)} to {state_name(state)}")
            run.statistics.transitions.add((self.state, state))
        number, owner = rig.job.owner, rig.token.get("owner", signed=True)
        beat = rig.token.get("heartbeat", signed=True)
        self.stolen = self.stolen and owner != number
        if self.state > ACQUIRE and self.owner == number and beat != self.heartbeat % HEARTBEATS + 1:
            raise ScenarioError(f"the heartbeat of the owner goes from {self.heartbeat} to {beat}")
        if busy and rig.cpu.jobs and owner != number and not self.stolen:
            raise ScenarioError("a record call runs while the drive belongs to nobody or to another job")
        if rig.cpu.jobs and done:
            raise ScenarioError("done while a record call is running")
        self.times.observe(state, self.heartbeat, self.owner, owner)
        self.watch_loss(state)
        self.state = state

    def watch_loss(self, state: int) -> None:
        """A lost record call is a temporary error: pause, then a new request. A lost drive ends the job at once."""
        wanted = {"call": WAIT, "pause": BUILD}.get(self.lost)
        if wanted == state:
            self.lost = "pause" if state == WAIT else ""
        elif wanted is not None and (self.lost == "call" or state != WAIT):
            raise ScenarioError(f"after the loss of a record call comes {state_name(state)}, not {state_name(wanted)}")
        if self.stolen and self.state > ACQUIRE and state not in {DRAIN, IDLE}:
            raise ScenarioError(f"the drive belongs to another job and the state is {state_name(state)}")

    # --- the end --------------------------------------------------------------------------------------

    def end(self, run: Run[DriveScenario], status: int) -> None:
        """Values, errors, diagnostics, wire, owner."""
        End(self.rig, run.scenario, self.reference).check(status)
        owner = self.rig.token.get("owner", signed=True)
        if owner not in ((FOREIGN, 0) if run.scenario.owner else (FOREIGN,) if self.stolen else (0,)):
            raise ScenarioError(f"the drive is not released, it belongs to job {owner}")

    def behind(self, run: Run[DriveScenario]) -> None:
        """Nothing goes on that has to be stopped."""

    def rest(self, run: Run[DriveScenario]) -> None:
        """A record call that is left over ends; the other job goes away."""
        if run.scenario.leftover:
            self.still_draining(run)
        if run.scenario.owner is not None or self.stolen:
            self.rig.token.set("owner", 0)

    def still_draining(self, run: Run[DriveScenario]) -> None:
        """A new start is refused while the record call of the job before is active; later it works."""
        rig, scan = self.rig, run.scenario.scan
        if not rig.cpu.jobs:
            raise ScenarioError("the record call has ended before DRAIN_LIMIT")
        run.scans += 1
        run.execute = True
        run.call(scan)
        if run.seen != (False, False, True, WORDS["STILL_DRAINING"]):
            raise ScenarioError(f"a start during a running record call gives 16#{run.seen[-1]:04X}, not 16#8103")
        run.fall()
        for _ in range(MAX_SCANS):
            if not rig.cpu.jobs:
                return
            run.scans += 1
            run.call(scan)
        raise ScenarioError("the record call is not called on after the end of the job")
