"""Checks of the group ``execution``: the generated SCL runs in the simulated CPU, under every fault."""

from __future__ import annotations

import operator
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from plcgen.cpu.program import Program
from plcgen.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.project.nouns import PlannedJob, Project
from plcgen.project.ownership import is_owned
from plcgen.proof.checks import Check, Outcome, Trial
from plcgen.proof.coverage import Coverage, cover
from plcgen.proof.idle import idle_check
from plcgen.proof.rig import ProgramBench
from plcgen.proof.runner import Runner
from plcgen.proof.scenario import Failure, ScenarioError, Statistics, diagnostic
from plcgen.proof.suite import CodeBlock, Level, Procedure, Progress, Suite
from plcgen.proof.workers import shared_out

MAX_FAILURES = 3


@dataclass(slots=True)
class Result:
    """What the runs of one job, or of all together, gave; ``broken`` says that not even the nominal run worked."""

    run: str = ""
    values: str = ""
    matrix: str = ""
    failures: list[Failure] = field(default_factory=list)
    statistics: Statistics = field(default_factory=Statistics)
    trials: list[Trial] = field(default_factory=list)
    counts: list[int] = field(default_factory=list)
    broken: bool = False

    def add(self, failure: Failure | None, counts: list[int]) -> None:
        """Add what one CPU did."""
        self.failures += [failure] if failure is not None else []
        if counts:
            self.counts = list(map(operator.add, self.counts, counts)) if self.counts else list(counts)


def added(counts: list[list[int]]) -> list[int]:
    """Counters of coverage of several CPUs; an empty list is one that ran nothing."""
    return [sum(column) for column in zip(*(each for each in counts if each), strict=True)]


class Work:
    """Every job of every suite, and what they do together, as pieces of work."""

    def __init__(self, bench: ProgramBench, level: Level) -> None:
        self.bench, self.level = bench, level

    def __reduce__(self) -> tuple[type[Work], tuple[ProgramBench, Level]]:
        """A worker makes the suites again."""
        return Work, (self.bench, self.level)

    @cached_property
    def suites(self) -> list[Suite[Any]]:
        """The suites of all protocols."""
        return [s for plan in self.bench.project.plans for s in plan.protocol.proof(plan).suites()]

    @cached_property
    def pieces(self) -> list[tuple[Suite[Any], PlannedJob | None]]:
        """Jobs, and None for the procedures of a suite."""
        together = () if self.level == "none" else (None,)
        return [(suite, job) for suite in self.suites for job in (*suite.jobs, *together)]

    def __call__(self, index: int) -> Result:
        """One piece."""
        suite, job = self.pieces[index]
        if job is None:
            return run_together(suite, self.bench.program)
        return run_job(suite, self.bench.program, job, self.level)


def check_execution(
    project: Project,
    folder: Path,
    level: Level = "quick",
    progress: Progress | None = None,
    workers: int | None = None,
    partner: Path | None = None,
    *,
    engine: bool = False,
) -> Iterator[Check]:
    """Run every job of the files on disk; ``workers`` None uses every core.

    ``partner`` is the user's file of a partner: every job runs once against it too. ``engine`` runs what is the same in
    every project even if it is known to hold.
    """
    work = Work(ProgramBench(project, folder), level)
    try:
        program = work.bench.program
    except DiagnosticError as problem:
        first = problem.diagnostics[0]
        yield Check("execution.scl", "sources", "SCL in the simulated CPU", Outcome.ERROR, first.message, first)
        return
    if level != "none" or engine:
        for plan in project.plans:
            yield from plan.protocol.proof(plan).foundation(folder, run=engine, progress=progress)
    if level != "none":
        yield idle_check(program)
    every: list[Result] = []
    found = iter(shared_out(work, len(work.pieces), progress, workers if level != "none" else 1))
    for suite in work.suites:
        results = {job.key: next(found) for job in suite.jobs}
        for key, result in results.items():
            yield from job_checks(suite, key, result, level)
        if partner is not None:
            yield from suite.own(program, partner)
        if level == "none":
            continue
        together = next(found)
        yield together_check(suite, together)
        yield from suite.left_out()
        every += [*results.values(), together]
        if not any(result.failures for result in (*results.values(), together)):
            counts = added([result.counts for result in (*results.values(), together)])
            for block in suite.blocks():
                yield coverage_check(block, coverage(program, block, counts, results))
    if every and not any(result.failures for result in every):
        yield from main_coverage(project, program, added([result.counts for result in every]))


def main_coverage(project: Project, program: Program, counts: list[int]) -> Iterator[Check]:
    """The check of the cyclic OB, which calls what all protocols have made; one that is the user's own is not ours."""
    main = program.main()
    if main is not None and not is_owned(main.result.tokens.file, project.loaded.spec.plc.user_owned):
        block = CodeBlock(main.name, main.name, main.name, (), lambda: project.loaded.key_span(("plc",)))
        yield coverage_check(block, cover(program, main.name, counts))


# --- running ----------------------------------------------------------------------------------------------


def run_job(suite: Suite[Any], program: Program, job: PlannedJob, level: Level, most: int = MAX_FAILURES) -> Result:
    """First run, nominal run and matrix of one job; the matrix ends with the ``most``-th failure."""
    try:
        runner = suite.runner(program, job)
    except (ScenarioError, KeyError) as problem:
        found = Failure("nominal run", 0, f"the block cannot be called: {problem}", "", 0)
        return Result(failures=[found], broken=True)
    statistics = runner.statistics
    result = Result(statistics=statistics)
    failure = runner.try_run(suite.first())
    longest, scans = statistics.longest, statistics.scans
    failure = failure or runner.try_run(suite.nominal(runner))
    if failure is not None:
        result.add(failure, runner.conduct.rig.cpu.coverage)
        result.broken = True
        return result
    result.run, result.values = suite.shown(runner, statistics.scans - scans)
    if level != "none":
        runner = run_matrix(suite, program, job, runner, result, longest, level, most)
    result.add(None, runner.conduct.rig.cpu.coverage)
    return result


def run_matrix(
    suite: Suite[Any],
    program: Program,
    job: PlannedJob,
    runner: Runner[Any],
    result: Result,
    scans: int,
    level: Level,
    most: int,
) -> Runner[Any]:
    """Every fault; behind a failure on another CPU. Returns the last runner."""
    kinds = 0
    for scenario in suite.matrix(runner, scans, level):
        kinds += 1
        before = result.statistics.scans
        failure = runner.try_run(scenario)
        result.trials.append(Trial(scenario.name, result.statistics.scans - before, failure is None))
        if failure is not None:
            result.add(failure, runner.conduct.rig.cpu.coverage)
            runner = suite.runner(program, job, result.statistics)
            if len(result.failures) >= most:
                break
            runner.try_run(suite.first())
    if not result.failures:
        for failure, other in suite.behind(program, runner):
            result.add(failure, other.conduct.rig.cpu.coverage if other is not runner else [])
    result.matrix = f"{suite.faults(job, level, kinds)}: {result.statistics}"
    return runner


def run_together(suite: Suite[Any], program: Program, most: int = MAX_FAILURES) -> Result:
    """What the jobs of a suite do to each other."""
    result = Result(counts=[0] * len(program.probes))
    for procedure in suite.procedures(program):
        result.statistics.runs += 1
        result.add(*attempt(procedure))
        if len(result.failures) >= most:
            break
    return result


def attempt(procedure: Procedure) -> tuple[Failure | None, list[int]]:
    """Run a procedure on a CPU of its own; what failed, and the counters of coverage."""
    bed = procedure.bed()
    try:
        procedure.run(bed)
    except ScenarioError as problem:
        message = str(problem)
    except Exception as problem:  # noqa: BLE001 - changed sources may make the simulated CPU itself fail
        message = f"the simulated CPU stopped: {type(problem).__name__} {problem}"
    else:
        return None, bed.cpu.coverage
    place = bed.place
    if bed.cpu.misuses:
        misuse = bed.cpu.misuses[0]
        message, place = str(misuse), (misuse.file, misuse.line)
    return Failure(procedure.name, bed.scans, message, *place), bed.cpu.coverage


def coverage(program: Program, block: CodeBlock, counts: list[int], results: dict[str, Result]) -> Coverage:
    """Coverage of a block, with the ways from state to state that its jobs went."""
    steps = block.steps
    if steps is not None:
        steps = steps.difference(*(results[job.key].statistics.transitions for job in block.jobs))
    return cover(program, block.block, counts, block.premises, block.opened, steps)


# --- reporting --------------------------------------------------------------------------------------------


def failed(name: str, subject: str, text: str, found: Diagnostic, verdict: str = "") -> Check:
    """A check that failed."""
    return Check(name, subject, text, Outcome.ERROR, verdict or found.message, found)


def job_checks(suite: Suite[Any], key: str, result: Result, level: Level) -> Iterator[Check]:
    """The checks of one job: nominal run and matrix."""
    name, subject = f"run.{suite.prefix}{key}", f"run {key}"
    if result.broken:
        found = diagnostic("PG620", key, result.failures, suite.page)
        yield failed(name, subject, "", found, str(result.failures[0]))
        return
    yield Check(name, subject, result.run, Outcome.OK, f"-> {result.values}")
    name, subject = f"faults.{suite.prefix}{key}", f"faults {key}"
    if level == "none":
        yield Check(name, subject, "", Outcome.NOT_RUN, "not asked for")
    elif result.failures:
        found = diagnostic("PG621", key, result.failures, suite.page)
        yield replace(failed(name, subject, result.matrix, found, str(result.failures[0])), trials=tuple(result.trials))
    else:
        yield Check(name, subject, result.matrix, Outcome.OK, "ok", trials=tuple(result.trials))


def together_check(suite: Suite[Any], result: Result) -> Check:
    """The check of all jobs of a suite."""
    good = suite.together(result.statistics.runs)
    if not result.failures:
        return good
    found = diagnostic("PG621", good.subject, result.failures, suite.page)
    return failed(good.id, good.subject, good.text, found, str(result.failures[0]))


def coverage_check(block: CodeBlock, found: Coverage) -> Check:
    """The check of the coverage of a block."""
    name, subject = f"coverage.{block.key}", f"coverage {block.name}"
    if found.steps:
        steps = ", ".join(f"{block.state(one)} to {block.state(two)}" for one, two in sorted(found.steps))
        message = f"{block.name}: the block never goes from {steps}"
        return failed(name, subject, found.text, Diagnostic("PG622", message, block.span()))
    if not found.missing:
        return Check(name, subject, found.text, Outcome.OK, found.verdict)
    first = found.missing[0]
    message = f"{block.name}: {len(found.missing)} statements or branches were never executed"
    problem = Diagnostic("PG622", message, Span(first.file, first.line, first.column))
    return failed(name, subject, found.text, problem, f"line {first.line} never ran")
