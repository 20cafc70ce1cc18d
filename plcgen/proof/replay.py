"""A scenario that failed, once more and scan by scan: what verification counts, for people to look at."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from plcgen.project.nouns import PlannedJob, Project
from plcgen.proof.execution import Work
from plcgen.proof.rig import ProgramBench
from plcgen.proof.runner import Run, Runner
from plcgen.proof.scenario import Failure, ScenarioError
from plcgen.proof.suite import Suite

MAX_CALLS = 20_000


@dataclass(frozen=True, slots=True)
class Call:
    """One call of the block: number, ms since the start, its signals behind it, and what partners got or gave in it."""

    scan: int
    time: int
    execute: bool
    busy: bool
    done: bool
    error: bool
    status: int
    exchanged: tuple[tuple[str, bytes], ...]


@dataclass(frozen=True, slots=True)
class Replay:
    """The calls of a scenario; ``failure`` None: alone, on a CPU of its own, it does not fail."""

    scenario: str
    calls: tuple[Call, ...]
    failure: Failure | None


def replay(project: Project, folder: Path, check: str, scenario: str = "") -> Replay | None:
    """Run what a check (``run.job``, ``faults.job``) has found again; ``scenario`` "" is the first that fails.

    None if there is no such check or scenario. Raises DiagnosticError if the sources do not compile.
    """
    work = Work(ProgramBench(project, folder), "full")
    kind, _, key = check.partition(".")
    for suite in work.suites:
        for job in suite.jobs:
            if f"{suite.prefix}{job.key}" == key:
                return _tried(suite, work, job, kind, scenario)
    return None


def _tried(suite: Suite[Any], work: Work, job: PlannedJob, kind: str, name: str) -> Replay | None:
    runner = suite.runner(work.bench.program, job)
    first = _watched(runner, suite.first())
    if first.failure is not None or not name:
        return first if first.failure is not None else _watched(runner, suite.nominal(runner))
    longest = runner.statistics.longest
    if kind == "run" or runner.try_run(suite.nominal(runner)) is not None:
        return _watched(runner, suite.nominal(runner))
    found = next((one for one in suite.matrix(runner, longest, "full") if one.name == name), None)
    found = found or next((one for one in suite.matrix(runner, longest, "quick") if one.name == name), None)
    return None if found is None else _watched(runner, found)


def _watched(runner: Runner[Any], scenario: Any) -> Replay:
    """One scenario and, as in the matrix, a plain one behind it."""
    calls: list[Call] = []
    following = runner.conduct.plain(f"the job after: {scenario.name}")
    for each in (scenario, following) if scenario.follow else (scenario,):
        run = _Run(each, runner, calls)
        try:
            run.go()
        except ScenarioError as problem:
            return Replay(scenario.name, tuple(calls), runner.failure(run, str(problem)))
    return Replay(scenario.name, tuple(calls), None)


class _Run(Run[Any]):
    """A run that keeps its calls."""

    def __init__(self, scenario: Any, runner: Runner[Any], calls: list[Call]) -> None:
        super().__init__(scenario, runner.conduct, runner.statistics)
        self._calls, self._seen = calls, {id(one): len(one) for one in self._journals()}

    def call(self, length: int) -> None:
        """One call of the block."""
        super().call(length)
        if len(self._calls) >= MAX_CALLS:
            return
        exchanged: list[tuple[str, bytes]] = []
        for journal in self._journals():
            entries = list(journal)[self._seen.get(id(journal), 0) :]
            exchanged += [(str(entry.direction), bytes(entry.data)) for entry in entries]
            self._seen[id(journal)] = len(journal)
        busy, done, error, status = self.seen
        self._calls.append(
            Call(len(self._calls) + 1, self.passed, self.execute, busy, done, error, status, tuple(exchanged))
        )

    def _journals(self) -> Iterator[Any]:
        bus = self.rig.cpu.bus
        for partner in (*bus.drives.values(), *(port.peer for port in bus.ports.values())):
            journal = getattr(partner, "journal", None)
            if journal is not None:
                yield journal
