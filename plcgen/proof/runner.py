"""Run scenarios scan by scan and hold the block to what it must do in every scan and at the end."""

from __future__ import annotations

import random
from dataclasses import replace
from typing import Generic, Protocol, TypeVar

from plcgen.base.diagnostics import Span
from plcgen.proof.making import unexpected
from plcgen.proof.rig import Members, Source
from plcgen.proof.scenario import DONE, IDLE, RUNNING, STARTED, Failure, Scenario, ScenarioError, Statistics
from plcgen.s7.cpu.cpu import Cpu
from plcgen.s7.cpu.program import Program

MAX_SCANS = 40_000
HOLD_SCANS = 2

S = TypeVar("S", bound=Scenario)


class Rig(Protocol):
    """A block on a CPU of its own, with everything around it."""

    @property
    def cpu(self) -> Cpu:
        """The CPU."""

    @property
    def program(self) -> Program:
        """What it runs."""

    @property
    def source(self) -> Source:
        """The source of the block."""

    @property
    def db(self) -> Members:
        """Signals and values of the block, by their names at the block."""

    def pin(self, name: str) -> str:
        """Name at the block of a signal of the job that runs."""


class Conduct(Protocol[S]):
    """What a protocol does around the calls of a block, and what it demands of them. All of it raises ScenarioError."""

    @property
    def rig(self) -> Rig:
        """Where the block runs."""

    def plain(self, name: str) -> S:
        """A scenario without any fault, of which only the result is checked."""

    def title(self, scenario: S) -> str:
        """How a failure of a scenario is called."""

    def begin(self, run: Run[S]) -> int:
        """Set everything up; after how many ms at the latest the job must have ended."""

    def happen(self, run: Run[S], happening: str) -> None:
        """Something other than the end of execute happens before a scan."""

    def scan(self, run: Run[S]) -> int:
        """What goes on around the block in every scan; the length of the scan in ms."""

    def start(self, run: Run[S]) -> None:
        """The first call of a job: everything of the job before is gone."""

    def observe(self, run: Run[S]) -> None:
        """What must hold after every call."""

    def outputs(self) -> object:
        """The values that must not change before the job is done."""

    def where(self) -> str:
        """Where a job that does not end stands."""

    def end(self, run: Run[S], status: int) -> None:
        """What must hold at the end."""

    def holds(self) -> bool:
        """Whether the result stays as long as execute does."""

    def behind(self, run: Run[S]) -> None:
        """Execute is about to fall: no more faults."""

    def rest(self, run: Run[S]) -> None:
        """What must hold behind the fall of execute."""


class Run(Generic[S]):
    """One run of a scenario: where it stands. ``fresh`` says that the next call is the first one of a job."""

    def __init__(self, scenario: S, conduct: Conduct[S], statistics: Statistics) -> None:
        self.scenario, self.conduct, self.rig, self.statistics = scenario, conduct, conduct.rig, statistics
        self.scans = 0
        self.execute = self.fresh = True
        self.random = random.Random(scenario.name)  # noqa: S311 - scan lengths
        self.before: list[int] = []
        self.seen = (False, False, False, 0)
        """The signals behind the last call."""
        self.spots = [self.rig.db.spots[self.rig.pin(name)] for name in ("execute", "busy", "done", "error", "status")]
        self.outputs: object = None
        self.started = 0

    @property
    def passed(self) -> int:
        """Time of this run in ms."""
        return self.rig.cpu.clock - self.started

    def go(self) -> None:
        """From the rising edge of execute to idle. Raises ScenarioError."""
        latest = self.conduct.begin(self)
        self.started = self.rig.cpu.clock
        self.outputs = self.conduct.outputs()
        while True:
            self.step()
            _, done, error, _ = self.seen
            if done or error:
                break
            if self.passed > latest or self.scans > MAX_SCANS + latest:
                self.statistics.hangs += 1
                raise ScenarioError(f"still {self.conduct.where()} after {latest} ms")
        self.statistics.runs += 1
        self.statistics.scans += self.scans
        self.statistics.longest = max(self.statistics.longest, self.scans)
        self.end()
        self.hold()

    def signals(self) -> tuple[bool, bool, bool, int]:
        """Busy, done, error, status of the job as they are now."""
        memory = self.rig.db.memory
        _, busy, done, error, word = self.spots
        status = memory[word.byte] << 8 | memory[word.byte + 1]
        return (
            bool(memory[busy.byte] >> busy.bit & 1),
            bool(memory[done.byte] >> done.bit & 1),
            bool(memory[error.byte] >> error.bit & 1),
            status,
        )

    def call(self, length: int) -> None:
        """One call of the block."""
        spot, memory = self.spots[0], self.rig.db.memory
        memory[spot.byte] = memory[spot.byte] & ~(1 << spot.bit) | self.execute << spot.bit
        self.rig.cpu.call(self.rig.db.block, length)
        self.seen = self.signals()

    def step(self) -> None:
        """One scan: what happens around the block, its call, and what must hold after every call."""
        self.scans += 1
        happening = self.scenario.happens.get(self.scans)
        if happening == "drop":
            self.execute = False
        elif happening is not None:
            if happening in {"cold", "warm", "reset"}:
                # what TIME_TCK does at a restart is a happening of its own ("reset")
                self.rig.cpu.restart("cold" if happening == "cold" else "warm", keep_ticks=happening == "warm")
                self.fresh = not self.signals()[0]
                self.outputs = self.conduct.outputs()
            self.conduct.happen(self, happening)
        length = self.conduct.scan(self)
        self.before = self.rig.cpu.counters[self.rig.source.probes]
        self.call(self.random.randint(1, 50) if self.scenario.jitter else length)
        self.observe()

    def observe(self) -> None:
        """What must hold after every call."""
        if self.scenario.tolerate:
            self.rig.cpu.misuses.clear()
        self.no_misuse()
        busy, done, error, status = self.seen
        if busy + done + error != 1:
            raise ScenarioError(f"busy {busy}, done {done}, error {error} at the same time")
        if self.fresh and not error:
            if status != STARTED:
                raise ScenarioError(f"status is 16#{status:04X} in the first call")
            self.conduct.start(self)
        elif busy and status != RUNNING:
            raise ScenarioError(f"status is 16#{status:04X} while the job runs")
        if not done and self.conduct.outputs() != self.outputs:
            raise ScenarioError("a value output changed although the job is not done")
        self.conduct.observe(self)
        self.fresh = False

    def no_misuse(self) -> None:
        """The block did nothing that a CPU does not forgive."""
        if self.rig.cpu.misuses or self.rig.cpu.faulted:
            raise ScenarioError("misuse")

    def end(self) -> None:
        """The result, and what the protocol demands of the end."""
        _, done, _, status = self.seen
        took = self.scenario.took
        if status not in self.scenario.status:
            wanted = " or ".join(f"16#{word:04X}" for word in self.scenario.status)
            raise ScenarioError(f"status is 16#{status:04X} instead of {wanted}")
        if done != (status == DONE):
            raise ScenarioError(f"done is {done} with status 16#{status:04X}")
        if took is not None and not took[0] <= self.passed <= took[1]:
            raise ScenarioError(f"took {self.passed} ms instead of {took[0]} to {took[1]}")
        self.conduct.end(self, status)

    def hold(self) -> None:
        """The result stays until execute falls, for one call at least, then the job is idle."""
        status, values = self.seen[-1], self.conduct.outputs()
        for _ in range(HOLD_SCANS if self.execute and self.conduct.holds() else 0):
            self.scans += 1
            self.call(self.scenario.scan)
            if self.seen != (False, status == DONE, status != DONE, status):
                raise ScenarioError("the result does not stay while execute is TRUE")
        self.conduct.behind(self)
        self.fall()
        if self.conduct.outputs() != values:
            raise ScenarioError("a value output changed after the end of the job")
        self.conduct.rest(self)
        self.no_misuse()

    def fall(self) -> None:
        """Execute falls: the job is idle after one call."""
        self.execute = False
        self.scans += 1
        self.call(self.scenario.scan)
        if self.seen != (False, False, False, IDLE):
            raise ScenarioError(f"not idle after execute has fallen: 16#{self.seen[-1]:04X}")


class Runner(Generic[S]):
    """Runs scenarios of one block one after the other on one CPU."""

    def __init__(self, conduct: Conduct[S], statistics: Statistics | None = None) -> None:
        self.conduct = conduct
        self.statistics = statistics or Statistics()

    def try_run(self, scenario: S) -> Failure | None:
        """Run a scenario and a plain one after it; None if everything was right."""
        following = self.conduct.plain(f"the job after: {scenario.name}")
        for each in (scenario, following) if scenario.follow else (scenario,):
            run = Run(each, self.conduct, self.statistics)
            try:
                run.go()
            except ScenarioError as problem:
                return self.failure(run, str(problem))
            except Exception as problem:  # noqa: BLE001 - changed sources may make the simulated CPU itself fail
                return replace(self.failure(run, unexpected(problem, Span("")).message), stopped=True)
        return None

    def failure(self, run: Run[S], message: str) -> Failure:
        """Where the block was: the misuse, or the last statement that not every call executes."""
        rig, title = self.conduct.rig, self.conduct.title(run.scenario)
        if rig.cpu.misuses:
            misuse = rig.cpu.misuses[0]
            return Failure(title, run.scans, str(misuse), misuse.file, misuse.line)
        place = rig.source.probes
        passed, before = (rig.program.passed(one, place.start) for one in (rig.cpu.counters[place], run.before))
        counted = zip(rig.program.probes[place], passed, before, strict=False)
        found = [
            probe
            for probe, count, before in counted
            if count > before and probe.kind == "statement" and probe.block == rig.source.block
        ]
        margin = min((probe.column for probe in found), default=0)
        inner = [probe for probe in found if probe.column > margin] or found
        line = max((probe.line for probe in inner), default=rig.source.line)
        return Failure(title, run.scans, message, rig.source.file, line)
