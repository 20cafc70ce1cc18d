"""Run one scenario scan by scan and hold the block to what it must do in every scan and at the end."""

from __future__ import annotations

import random
from dataclasses import dataclass, field

from plcgen.protocols.ds47.proof.end import FOREIGN, EndChecks
from plcgen.protocols.ds47.proof.rig import JobRig, ScenarioError
from plcgen.protocols.ds47.proof.scenario import DONE, WORDS, Scenario
from plcgen.protocols.ds47.proof.times import (
    ACQUIRE,
    BUILD,
    DRAIN,
    IDLE,
    STATE_NAMES,
    WAIT,
    TimeChecks,
    transitions,
)
from plcgen.protocols.ds47.words import HEARTBEATS

MAX_SCANS = 40_000
HOLD_SCANS = 2
LITTER = (b"\x40\x00", b"\x44\x02\x00\x11\x00\x07", b"\xa5")
"""What the buffers hold before a request is built: good blocks, error blocks, garbage. None of it may count."""


@dataclass(slots=True)
class Failure:
    """A scenario that failed: where it was noticed."""

    scenario: str
    scan: int
    message: str
    file: str
    line: int

    def __str__(self) -> str:
        return f"{self.scenario}, scan {self.scan}: {self.message}"


@dataclass(slots=True)
class Statistics:
    """What the runs of a job took."""

    runs: int = 0
    scans: int = 0
    longest: int = 0
    hangs: int = 0
    transitions: set[tuple[int, int]] = field(default_factory=set)


class Runner(EndChecks, TimeChecks):
    """Runs scenarios of one job one after the other on one CPU."""

    def __init__(self, rig: JobRig) -> None:
        self.rig = rig
        self.statistics = Statistics()
        self.transitions = transitions(rig.job, classic=rig.plan.target.classic)
        self.scan = 0
        self.before: list[int] = []
        self.name = ""
        self.scenario = Scenario(name="")

    # --- entry ----------------------------------------------------------------------------------------

    def try_run(self, scenario: Scenario) -> Failure | None:
        """Run a scenario and the one after it; None if everything was right."""
        try:
            self.run(scenario)
            if scenario.follow:
                self.run(Scenario(name=f"the job after: {scenario.name}", retries=None, calls=None))
        except ScenarioError as problem:
            return self.failure(str(problem))
        except Exception as problem:  # noqa: BLE001 - changed sources may make the simulated CPU itself fail
            return self.failure(f"the simulated CPU stopped: {type(problem).__name__} {problem}")
        return None

    def failure(self, message: str) -> Failure:
        """Where the block was: the misuse, or the last statement that not every call executes."""
        misuses = self.rig.cpu.misuses
        if misuses:
            return Failure(self.name, self.scan, str(misuses[0]), misuses[0].file, misuses[0].line)
        probes, counters = self.rig.program.probes, self.rig.cpu.coverage
        found = [
            probes[i]
            for i, old in zip(self.rig.probes, self.before, strict=False)
            if counters[i] > old and probes[i].kind == "statement"
        ]
        margin = min((probe.column for probe in found), default=0)
        inner = [probe for probe in found if probe.column > margin] or found
        line = max((probe.line for probe in inner), default=1)
        return Failure(self.name, self.scan, message, self.rig.file, line)

    # --- one run --------------------------------------------------------------------------------------

    def run(self, scenario: Scenario) -> None:
        """Run a job from the rising edge of execute to idle. Raises ScenarioError."""
        rig = self.rig
        pending = 0 if self.scenario.follow else self.scenario.processing
        self.name, self.scenario, self.scan = scenario.name, scenario, 0
        rig.cpu.clock += pending
        rig.bus.advance(pending)
        self.prepare(scenario)
        self.random = random.Random(scenario.name)  # noqa: S311 - scan lengths
        self.started = rig.cpu.clock
        self.execute = True
        self.state = IDLE
        self.fresh = True
        self.stolen = False
        self.lost = ""
        self.begin_times()
        self.outputs = self.value_bytes()
        limits = rig.limits
        slack = 6 * (50 if scenario.jitter else scenario.scan)
        away = limits.lease + 1000 if "away" in scenario.happens.values() else 0
        latest = limits.timeout + limits.drain + slack + away
        while True:
            self.step()
            if rig.flag("done") or rig.flag("error"):
                break
            if rig.cpu.clock - self.started > latest or self.scan > MAX_SCANS:
                self.statistics.hangs += 1
                raise ScenarioError(f"still {STATE_NAMES.get(self.state, self.state)} after {latest} ms")
        self.statistics.runs += 1
        self.statistics.scans += self.scan
        self.statistics.longest = max(self.statistics.longest, self.scan)
        self.check_end()
        self.hold()

    def prepare(self, scenario: Scenario) -> None:
        """Set up drive, bus, token and clock."""
        rig = self.rig
        rig.next_values(factory=scenario.factory)
        rig.drive.begin(scenario)
        rig.bus.write_busy, rig.bus.read_busy = scenario.busy
        if scenario.clock is not None:
            rig.cpu.clock = scenario.clock
            rig.set_flag("execute", value=False)
            rig.cpu.call(rig.job.instance.name, 0)
        if scenario.heartbeat is not None:
            rig.token_set("heartbeat", scenario.heartbeat)
        if scenario.reference is not None:
            rig.token_set("requestReference", scenario.reference)
        if scenario.owner is not None:
            rig.token_set("owner", FOREIGN)
        self.reference = rig.token_get("requestReference")

    def step(self) -> None:
        """One scan: what happens around the block, its call, and what must hold after every call."""
        rig, scenario = self.rig, self.scenario
        self.scan += 1
        happening = scenario.happens.get(self.scan)
        self.happen(happening)
        self.foreign()
        rig.set_flag("execute", value=self.execute)
        if self.state == BUILD:
            rig.litter(scenario.litter or LITTER[self.statistics.runs % len(LITTER)])
        heartbeat, owner = rig.token_get("heartbeat"), rig.token_get("owner")
        coverage = rig.cpu.coverage
        self.before = [coverage[i] for i in rig.probes]
        rig.cpu.call(rig.job.instance.name, self.length())
        self.observe(heartbeat, owner)

    def happen(self, happening: str | None) -> None:
        """Execute the event of this scan."""
        rig = self.rig
        if happening == "drop":
            self.execute = False
        elif happening in {"cold", "warm", "reset"}:
            rig.cpu.restart("cold" if happening == "cold" else "warm")
            if happening == "reset":
                rig.cpu.clock = 0
            self.state = rig.get("state")
            self.fresh = not rig.flag("busy")
            self.begin_times()
            self.outputs = self.value_bytes()
            self.reference = None
            self.put_inputs()
        elif happening == "lost":
            self.lost = "call" if rig.cpu.jobs and rig.limits.retries else ""
            rig.cpu.drop_records()
            self.reference = None
        elif happening == "steal":
            rig.token_set("owner", FOREIGN)
            self.stolen = True
        elif happening == "away":
            rig.cpu.clock += rig.limits.lease + 1000
            rig.bus.advance(rig.limits.lease + 1000)

    def put_inputs(self) -> None:
        """Supply the inputs again, as a main program does in every scan."""
        rig = self.rig
        for member, data in rig.sets[rig.set_number][1]:
            rig.put(rig.instance, rig.spots[member], data)

    def foreign(self) -> None:
        """Let the other job that owns the drive live, leave or die."""
        rig, owner = self.rig, self.scenario.owner
        if owner is None or rig.token_get("owner") not in {FOREIGN, FOREIGN + 1}:
            return
        if self.scan == owner.follows:
            rig.token_set("owner", FOREIGN + 1)
        if self.scan <= owner.alive:
            rig.token_set("heartbeat", rig.token_get("heartbeat") % HEARTBEATS + 1)
        elif owner.leaves:
            rig.token_set("owner", 0)

    # --- every scan -----------------------------------------------------------------------------------

    def observe(self, heartbeat: int, owner: int) -> None:
        """What must hold after every call."""
        rig = self.rig
        if self.scenario.tolerate:
            rig.cpu.misuses.clear()
        if rig.cpu.misuses or rig.cpu.faulted:
            raise ScenarioError("misuse")
        busy, done, error = rig.flag("busy"), rig.flag("done"), rig.flag("error")
        state, status = rig.get("state"), rig.get("status")
        if busy + done + error != 1:
            raise ScenarioError(f"busy {busy}, done {done}, error {error} at the same time")
        if busy != (state != IDLE):
            raise ScenarioError(f"busy is {busy} in state {STATE_NAMES.get(state, state)}")
        if not error and (done or busy) and self.fresh:
            self.check_start(status)
        elif busy and status != WORDS["RUNNING"]:
            raise ScenarioError(f"status is 16#{status:04X} while the job runs")
        if state != self.state and (self.state, state) not in self.transitions:
            raise ScenarioError(f"state goes from {STATE_NAMES[self.state]} to {STATE_NAMES.get(state, state)}")
        if state != self.state:
            self.statistics.transitions.add((self.state, state))
        if not done and self.value_bytes() != self.outputs:
            raise ScenarioError("a value output changed although the job is not done")
        number = rig.job.owner
        self.stolen = self.stolen and rig.token_get("owner") != number
        beat = rig.token_get("heartbeat")
        if self.state > ACQUIRE and owner == number and beat != heartbeat % HEARTBEATS + 1:
            raise ScenarioError(f"the heartbeat of the owner goes from {heartbeat} to {beat}")
        if busy and rig.cpu.jobs and rig.token_get("owner") != number and not self.stolen:
            raise ScenarioError("a record call runs while the drive belongs to nobody or to another job")
        if rig.cpu.jobs and done:
            raise ScenarioError("done while a record call is running")
        self.watch_pause(state)
        self.watch_timeout(state)
        self.watch_lease(heartbeat, owner)
        self.watch_loss(state)
        self.fresh = False
        self.state = state

    def check_start(self, status: int) -> None:
        """The first call of a job: everything of the job before is gone."""
        rig = self.rig
        if status != WORDS["STARTED"]:
            raise ScenarioError(f"status is 16#{status:04X} in the first call")
        left = [name for name in ("recordStatus", "retries", "responseLength", "failedParameter") if rig.get(name)]
        if rig.get("telegram") != 1:
            left.append("telegram")
        left += [name for name in ("errors", "errorInfos") if any(rig.words(name))]
        if left:
            raise ScenarioError(f"{', '.join(left)} still show the job before")

    def watch_loss(self, state: int) -> None:
        """A lost record call is a temporary error: pause, then a new request. A lost drive ends the job at once."""
        wanted = {"call": WAIT, "pause": BUILD}.get(self.lost)
        if wanted == state:
            self.lost = "pause" if state == WAIT else ""
        elif wanted is not None and (self.lost == "call" or state != WAIT):
            raise ScenarioError(
                f"after the loss of a record call comes {STATE_NAMES[state]}, not {STATE_NAMES[wanted]}"
            )
        if self.stolen and self.state > ACQUIRE and state not in {DRAIN, IDLE}:
            raise ScenarioError(f"the drive belongs to another job and the state is {STATE_NAMES[state]}")

    def value_bytes(self) -> bytes:
        """All value outputs."""
        first, last = self.rig.values_range
        return bytes(self.rig.instance[first:last])

    # --- behind the end -------------------------------------------------------------------------------

    def hold(self) -> None:
        """The result stays until execute falls, for one call at least, then the block is idle."""
        rig, scan = self.rig, self.scenario.scan
        name, status = rig.job.instance.name, rig.get("status")
        result = bytes(rig.instance)
        if self.execute:
            for _ in range(HOLD_SCANS):
                self.scan += 1
                rig.cpu.call(name, scan)
                shown = rig.flag("busy"), rig.flag("done"), rig.flag("error"), rig.get("status")
                if shown != (False, status == DONE, status != DONE, status):
                    raise ScenarioError("the result does not stay while execute is TRUE")
        if self.value_bytes() != bytes(result[slice(*rig.values_range)]):
            raise ScenarioError("a value output changed after the end of the job")
        self.fall()
        if self.scenario.leftover:
            self.still_draining()
        if self.scenario.owner is not None or self.stolen:
            rig.token_set("owner", 0)
        if rig.cpu.misuses:
            raise ScenarioError("misuse")

    def fall(self) -> None:
        """Execute falls: the block is idle after one call."""
        rig = self.rig
        self.scan += 1
        rig.set_flag("execute", value=False)
        rig.cpu.call(rig.job.instance.name, self.scenario.scan)
        if rig.flag("busy") or rig.flag("done") or rig.flag("error") or rig.get("status") != WORDS["IDLE"]:
            raise ScenarioError(f"not idle after execute has fallen: 16#{rig.get('status'):04X}")

    def still_draining(self) -> None:
        """A new start is refused while the record call of the job before is active; later it works."""
        rig, name = self.rig, self.rig.job.instance.name
        if not rig.cpu.jobs:
            raise ScenarioError("the record call has ended before DRAIN_LIMIT")
        self.scan += 1
        rig.set_flag("execute", value=True)
        rig.cpu.call(name, self.scenario.scan)
        shown = rig.flag("busy"), rig.flag("done"), rig.flag("error"), rig.get("status")
        if shown != (False, False, True, WORDS["STILL_DRAINING"]):
            raise ScenarioError(f"a start during a running record call gives 16#{shown[3]:04X}, not 16#8103")
        self.fall()
        for _ in range(MAX_SCANS):
            if not rig.cpu.jobs:
                return
            self.scan += 1
            rig.cpu.call(name, self.scenario.scan)
        raise ScenarioError("the record call is not called on after the end of the job")
