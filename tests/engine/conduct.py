"""What goes on around the calls of the engine, and what must hold behind every one of them."""

from __future__ import annotations

import random

from plcgen.ds47.proof.words import BUILD, HOLD, IDLE, TRANSITIONS, WORDS, state_name
from plcgen.proof.runner import MAX_SCANS, Run
from plcgen.proof.scenario import ScenarioError
from tests.engine.end import Ending, Guards
from tests.engine.errands import Errand
from tests.engine.rig import EngineRig
from tests.engine.scenario import EngineScenario
from tests.engine.times import ChannelTimes

CLOCK_END = 2**31
DIRT = (b"\x40\x00", b"\x44\x02\x00\x11\x00\x07", b"\xa5")
"""What the buffers hold before a request is built: good blocks, error blocks, garbage. None of it may count."""

BY_HAND, AROUND = 4, 2
"""Scans of WRREC and RDREC that are busy in one call each, called by hand; what a run may take more, once."""


class EngineConduct:
    """One job of unit 1, run by run; ``reference`` is the last one before the run, None if it is not known."""

    def __init__(self, rig: EngineRig, errand: Errand) -> None:
        self.rig, self.errand, self.job = rig, errand, rig.jobs[0]
        self.job.give(errand)
        self.job.db.set("slot", 1)
        self.draw = random.Random(errand.key)  # test values
        self.reference: int | None = None
        self.restarted = self.unsure = False
        self.state = IDLE
        self.settled = True
        self.clock = 0
        self.times = ChannelTimes(rig, EngineScenario(name="idle"))
        self.guards: Guards | None = None

    def plain(self, name: str) -> EngineScenario:
        """A run of which only the result counts."""
        return EngineScenario(name=name, retries=None, calls=None)

    def title(self, scenario: EngineScenario) -> str:
        """Job and scenario."""
        return f"{self.errand.key}: {scenario.name}"

    def outputs(self) -> object:
        """What the job got is checked at its end."""
        return None

    def where(self) -> str:
        """State behind the last call."""
        return state_name(self.rig.units[0].get("state"))

    def holds(self) -> bool:
        """The result stays as long as execute does."""
        return True

    def begin(self, run: Run[EngineScenario]) -> int:
        """Set up drives, bus, buffers and clock."""
        rig, scenario = self.rig, run.scenario
        journal = [e.data[0] for e in rig.drives[0].journal if e.direction == "write"]
        self.reference = None if self.restarted else journal[-1] if journal else self.reference
        self.restarted = bool(scenario.happens) or scenario.again is None
        self.unsure = False
        self.job.times(scenario.timeout, scenario.pause, scenario.most)
        self.job.draw(self.draw)
        rig.begin(scenario)
        rig.call(scenario.order)
        if scenario.clock is not None:
            rig.cpu.clock = 0  # TIME_TCK, too
            rig.cpu.clock = scenario.clock
            rig.cpu.call("OB1", 0)
        self.dirty(scenario.litter or DIRT[run.statistics.runs % len(DIRT)])
        self.guards = Guards(rig, self.job)
        self.times = ChannelTimes(rig, scenario)
        self.state, self.settled, self.clock = rig.units[0].get("state"), True, rig.ticks
        return scenario.latest

    def dirty(self, pattern: bytes) -> None:
        """Fill everything that the next request, its answer and its results will overwrite, and what lies behind."""
        results = ("errors", "infos", "failed", "recordStatus")
        for name in ("telegram", *results, *(("record",) if self.rig.classic else ())):
            spot, memory = self.rig.units[0].spots[name], self.rig.units[0].memory
            memory[spot.byte : spot.byte + spot.size] = (pattern * spot.size)[: spot.size]

    def happen(self, run: Run[EngineScenario], happening: str) -> None:
        """A restart, or the loss of the running record calls."""
        self.settled = False
        self.times.forget()
        self.state = self.rig.units[0].get("state")
        if happening == "cold":
            self.job.give(self.errand)
            self.job.times(run.scenario.timeout, run.scenario.pause, run.scenario.most)
            self.job.db.set("slot", 1)
            for number, request in enumerate(self.job.requests(), 1):
                self.job.db.put(f"letters[{number}].request", request)
            self.rig.call(run.scenario.order)
            self.guards = Guards(self.rig, self.job)
            self.rig.drives[0].journal.clear()
            self.reference = None
        elif happening == "lost":
            self.unsure = self.errand.once and any(job.write for job in self.rig.cpu.records.jobs.values())
            self.rig.cpu.drop_records()
        elif happening == "zero":
            self.rig.cpu.clock = 0
        self.clock = self.rig.ticks

    def scan(self, run: Run[EngineScenario]) -> int:
        """Length of the scan."""
        return self.times.length()

    def start(self, run: Run[EngineScenario]) -> None:
        """The first call of a job."""

    def observe(self, run: Run[EngineScenario]) -> None:
        """State, clock, record calls, place."""
        rig, unit = self.rig, self.rig.units[0]
        state = unit.get("state")
        if state != self.state:
            if self.settled and (self.state, state) not in TRANSITIONS:
                raise ScenarioError(f"state goes from {state_name(self.state)} to {state_name(state)}")
            if self.settled:
                run.statistics.transitions.add((self.state, state))
        self.settled = True
        self.state = state
        # TIME_TCK begins again at 0 behind 2147483647 ms: the time of that one call is lost
        wrapped = rig.classic and self.clock // CLOCK_END != rig.ticks // CLOCK_END
        self.times.observe(0 if wrapped else rig.ticks - self.clock)
        self.clock = rig.ticks
        if rig.cpu.jobs > 1:
            raise ScenarioError("two record calls at once")
        if rig.cpu.jobs and not rig.gate.get("channels[1].grant"):
            raise ScenarioError("a record call runs without a place")
        if rig.cpu.jobs and run.seen[1]:
            raise ScenarioError("done while a record call is running")
        grant = unit.get("turn.grant")
        if (grant != 0) != (state >= HOLD):
            raise ScenarioError(f"grant is {grant} in state {state_name(state)}")
        if run.seen[1] and state >= BUILD:
            raise ScenarioError(f"done in state {state_name(state)}")

    # --- the end --------------------------------------------------------------------------------------

    def end(self, run: Run[EngineScenario], status: int) -> None:
        """Results, wire, foreign bytes; of a trigger that was lost on its way nobody knows what the drive did."""
        self.times.check_end(status)
        most = AROUND + BY_HAND * len(self.errand.letters)
        if run.scenario == EngineScenario(name=run.scenario.name) and run.scans > most:
            raise ScenarioError(f"an ordinary run takes {run.scans} scans, which {most} are enough for")
        if self.unsure and status != WORDS["UNKNOWN"]:
            raise ScenarioError(f"a trigger whose WRREC was lost ends with 16#{status:04X}")
        Ending(self.rig, self.job, run.scenario, self.reference).check(status)
        if self.guards is not None:
            self.guards.check()

    def behind(self, run: Run[EngineScenario]) -> None:
        """Nothing goes on that has to be stopped."""

    def rest(self, run: Run[EngineScenario]) -> None:
        """The unit is free again; a record call that is left over ends."""
        if run.scenario.leftover:
            self.still_draining(run)
        unit = self.rig.units[0]
        if unit.get("state") != IDLE:
            run.call(run.scenario.scan)
        if unit.get("state") != IDLE or unit.get("turn.grant"):
            raise ScenarioError(f"the unit is not free after the job: {self.where()}")
        if self.rig.gate.get("channels[1].ask") and not self.rig.cpu.jobs:
            raise ScenarioError("the channel still asks for a place")

    def still_draining(self, run: Run[EngineScenario]) -> None:
        """The next job is refused while the record call of the one before is active; later it works."""
        rig, scan = self.rig, run.scenario.scan
        if not rig.cpu.jobs:
            raise ScenarioError("the record call has ended before DRAIN_LIMIT")
        run.execute = True
        for _ in range(8):
            run.call(scan)
            if run.seen[2]:
                break
        if run.seen != (False, False, True, WORDS["STILL_DRAINING"]):
            raise ScenarioError(f"a start during a running record call gives 16#{run.seen[-1]:04X}, not 16#8103")
        run.fall()
        run.no_misuse()
        rig.bus.write_busy = rig.bus.read_busy = 1
        for _ in range(MAX_SCANS):
            if not rig.cpu.jobs:
                return
            run.call(scan)
        raise ScenarioError("the record call is not called on after the end of the job")
