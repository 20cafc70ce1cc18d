"""A scenario that failed, once more and scan by scan: what verification counts, for people to look at."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

from plcgen.project.nouns import PlannedJob, Project
from plcgen.proof.execution import Work, attempt
from plcgen.proof.rig import ProgramBench
from plcgen.proof.runner import Run, Runner
from plcgen.proof.scenario import Failure, OtherTelegramError, ScenarioError
from plcgen.proof.suite import Bed, Procedure, Suite
from plcgen.s7.cpu.cpu import Cpu

MAX_CALLS = 20_000
"""Scans that are kept."""
MAX_EXCHANGES = 2_000


class Signals(NamedTuple):
    """Signals of a job behind a scan."""

    execute: bool
    busy: bool
    done: bool
    error: bool
    status: int


class Exchanged(NamedTuple):
    """What a partner got or gave in a scan."""

    scan: int
    direction: str
    data: bytes


@dataclass(slots=True)
class Replay:
    """The scans of a scenario, which count from 1; ``failure`` None: alone, on a CPU of its own, it does not fail.

    ``jobs`` are the signals of each job by the scan in which they became so, ``telegrams`` what was sent in the last
    scan and what is stated, if the failure is that they differ.
    """

    scenario: str
    scans: int = 0
    jobs: dict[str, dict[int, Signals]] = field(default_factory=dict)
    exchanges: list[Exchanged] = field(default_factory=list)
    failure: Failure | None = None
    telegrams: tuple[bytes, ...] = ()
    _seen: dict[int, int] = field(default_factory=dict)

    def scan(self, cpu: Cpu, signals: Mapping[str, Signals]) -> None:
        """One more scan has passed."""
        self.scans += 1
        for key, now in signals.items() if self.scans <= MAX_CALLS else ():
            known = self.jobs.setdefault(key, {})
            if not known or next(reversed(known.values())) != now:
                known[self.scans] = now
        for journal in _journals(cpu):
            fresh = list(journal)[self._seen.get(id(journal), 0) :] if len(self.exchanges) < MAX_EXCHANGES else ()
            self.exchanges += [Exchanged(self.scans, str(one.direction), bytes(one.data)) for one in fresh]
            self._seen[id(journal)] = len(journal)

    def begin(self, cpu: Cpu) -> None:
        """What partners know by now was in no scan of it."""
        self._seen = {id(journal): len(journal) for journal in _journals(cpu)}


def _journals(cpu: Cpu) -> Iterator[Any]:
    for partner in (*cpu.bus.drives.values(), *(port.peer for port in cpu.bus.ports.values())):
        journal = getattr(partner, "journal", None)
        if journal is not None:
            yield journal


def replay(project: Project, folder: Path, check: str, scenario: str = "") -> Replay | None:
    """Run what a check (``run.job``, ``faults.job``, ``together``) has found again; ``scenario`` "" is the first.

    None if there is no such check or scenario. Raises DiagnosticError if the sources do not compile.
    """
    work = Work(ProgramBench(project, folder), "full")
    kind, _, key = check.partition(".")
    for suite in work.suites:
        if check == suite.together(0).id:
            found = (one for one in suite.procedures(work.bench.program) if scenario in {"", one.name})
            tried = (_rehearsed(suite, procedure) for procedure in found)
            return next((one for one in tried if one.failure is not None or scenario), None)
        for job in suite.jobs:
            if f"{suite.prefix}{job.key}" == key:
                return _tried(suite, work, job, kind, scenario)
    return None


def _rehearsed(suite: Suite[Any], procedure: Procedure) -> Replay:
    """What all jobs do to each other, on a CPU of its own."""
    found = Replay(procedure.name)
    pins = {job.key: suite.pins(job) for job in suite.jobs}

    def look(cpu: Cpu) -> None:
        found.scan(cpu, {key: _signals(cpu, paths) for key, paths in pins.items()})

    def bed() -> Bed:
        made = procedure.bed()
        found.begin(made.cpu)
        made.cpu.watchers.append(partial(look, made.cpu))
        return made

    def run(made: Bed) -> None:
        try:
            procedure.run(made)
        finally:
            made.cpu.watchers.clear()
            look(made.cpu)

    found.failure, _ = attempt(Procedure(procedure.name, bed, run))
    return found


def _signals(cpu: Cpu, pins: Mapping[str, str]) -> Signals:
    execute, busy, done, error, status = (cpu[pins[name]] for name in Signals._fields)
    return Signals(bool(execute), bool(busy), bool(done), bool(error), status if isinstance(status, int) else 0)


def _tried(suite: Suite[Any], work: Work, job: PlannedJob, kind: str, name: str) -> Replay | None:
    runner = suite.runner(work.bench.program, job)
    first = _watched(runner, suite.first(), job)
    if first.failure is not None or not name:
        return first if first.failure is not None else _watched(runner, suite.nominal(runner), job)
    longest = runner.statistics.longest
    if kind == "run" or runner.try_run(suite.nominal(runner)) is not None:
        return _watched(runner, suite.nominal(runner), job)
    found = next((one for one in suite.matrix(runner, longest, "full") if one.name == name), None)
    found = found or next((one for one in suite.matrix(runner, longest, "quick") if one.name == name), None)
    return None if found is None else _watched(runner, found, job)


def _watched(runner: Runner[Any], scenario: Any, job: PlannedJob) -> Replay:
    """One scenario and, as in the matrix, a plain one behind it."""
    found = Replay(scenario.name)
    following = runner.conduct.plain(f"the job after: {scenario.name}")
    for each in (scenario, following) if scenario.follow else (scenario,):
        run = _Run(each, runner, found, job.key)
        try:
            run.go()
        except ScenarioError as problem:
            found.failure = runner.failure(run, str(problem))
            found.telegrams = (problem.found, problem.stated) if isinstance(problem, OtherTelegramError) else ()
            break
    return found


class _Run(Run[Any]):
    """A run that keeps its calls."""

    def __init__(self, scenario: Any, runner: Runner[Any], found: Replay, job: str) -> None:
        super().__init__(scenario, runner.conduct, runner.statistics)
        self._found, self._job = found, job
        found.begin(self.rig.cpu)

    def call(self, length: int) -> None:
        """One call of the block."""
        super().call(length)
        self._found.scan(self.rig.cpu, {self._job: Signals(bool(self.execute), *self.seen)})
