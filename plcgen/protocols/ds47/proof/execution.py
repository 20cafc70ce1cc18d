"""Checks of the group ``execution``: the generated SCL runs in the simulated CPU, under every fault."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path
from typing import Literal

from plcgen.cpu.program import Program
from plcgen.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.project.nouns import Project
from plcgen.proof.checks import Check, Outcome
from plcgen.proof.coverage import Coverage, measure, merge
from plcgen.proof.workers import shared_out
from plcgen.protocols.ds47.plan.nouns import DriveJob, DrivePlan
from plcgen.protocols.ds47.proof.answer_scenarios import answer_scenarios, error_matrix
from plcgen.protocols.ds47.proof.own_drive import own_checks
from plcgen.protocols.ds47.proof.record_scenarios import STATE_CONFLICT, cpu_scenarios, record_scenarios
from plcgen.protocols.ds47.proof.rig import Bench, JobRig, ScenarioError
from plcgen.protocols.ds47.proof.runner import Failure, Runner, Statistics
from plcgen.protocols.ds47.proof.scenario import Scenario
from plcgen.protocols.ds47.proof.times import STATE_NAMES, transitions
from plcgen.protocols.ds47.proof.together import program_scenarios, row, try_program, wrong_numbers
from plcgen.protocols.ds47.sim.drive import Drive
from plcgen.protocols.ds47.wire.errors import known_numbers
from plcgen.protocols.ppi.plan.nouns import PpiPlan
from plcgen.s7.image import Tree

Level = Literal["none", "quick", "full"]
"""How much of the fault matrix runs: nothing, everything once, or every combination of error number and position."""
Progress = Callable[[str, int, int], None]

MAX_FAILURES = 3
QUICK_ERRORS = 600
SHOWN_VALUES = 3
POLLS = 2
"""State conflicts of the nominal run, if the job has time for them."""


@dataclass(slots=True)
class JobResult:
    """What the runs of one job gave; ``kinds`` is how many different faults there were."""

    key: str
    nominal: str = ""
    values: str = ""
    matrix: str = ""
    failures: list[Failure] = field(default_factory=list)
    statistics: Statistics = field(default_factory=Statistics)
    counts: list[int] = field(default_factory=list)
    broken: bool = False


def check_execution(
    project: Project,
    folder: Path,
    level: Level = "quick",
    progress: Progress | None = None,
    workers: int | None = None,
    own: Callable[[], Drive] | None = None,
) -> Iterator[Check]:
    """Run every job of the files on disk; ``workers`` None uses every core.

    ``own`` makes the drive of the user's drive file: every job runs once against it too.
    """
    bench = Bench(project, folder)
    try:
        program = bench.program
    except DiagnosticError as problem:
        first = problem.diagnostics[0]
        yield Check("execution.scl", "sources", "SCL in the simulated CPU", Outcome.ERROR, first.message, first)
        return
    masters = project.plan(PpiPlan)
    if masters is not None:
        from plcgen.protocols.ppi.proof.execution import check_masters

        yield from check_masters(bench, level, progress, workers)
    plan = project.plan(DrivePlan)
    if plan is None or not plan.jobs:
        return
    total = len(plan.jobs) + (level != "none")
    results = shared_out(Work(bench, level), total, progress, workers if level != "none" else 1)
    program_result = results.pop() if level != "none" else None
    for job, result in zip(plan.jobs, results, strict=True):
        yield from _job_checks(job, result, level)
    if own is not None:
        yield from own_checks(plan, program, own)
    if program_result is None:
        return
    yield _program_check(plan, program_result)
    counts = [sum(column) for column in zip(*(result.counts for result in (*results, program_result)), strict=True)]
    if not any(result.failures for result in (*results, program_result)):
        for job, result in zip(plan.jobs, results, strict=True):
            steps = transitions(job, classic=plan.target.classic) - result.statistics.transitions
            yield _coverage_check(plan, job, merge(job, measure(program, job.block.name, counts), steps))


# --- running ----------------------------------------------------------------------------------------------


def run_job(plan: DrivePlan, program: Program, job: DriveJob, level: Level) -> JobResult:
    """Nominal run and matrix of one job."""
    result = JobResult(job.key)
    try:
        rig = JobRig(plan, program, job)
    except (ScenarioError, KeyError) as problem:
        result.failures.append(Failure("nominal run", 0, f"the block cannot be called: {problem}", "", 0))
        result.broken = True
        return result
    runner = Runner(rig)
    failure = runner.try_run(Scenario(name="first run"))
    scans = runner.statistics.longest
    failure = failure or _nominal(runner, result)
    result.counts = list(rig.cpu.coverage)
    if failure is not None:
        result.failures.append(failure)
        result.broken = True
    elif level != "none":
        _matrix(plan, program, runner, result, scans, level)
    return result


def _nominal(runner: Runner, result: JobResult) -> Failure | None:
    rig, job = runner.rig, runner.rig.job
    before = runner.statistics.scans
    polls = next((n for n in range(POLLS, 0, -1) if rig.limits.fits(n, len(job.telegrams))), 0)
    failure = runner.try_run(
        Scenario(
            name="nominal run",
            busy=(3, 1),
            reads=dict.fromkeys(range(1, polls + 1), STATE_CONFLICT),
            factory=True,
            retries=None,
            calls=(0, polls),
            follow=False,
        )
    )
    if failure is None:
        tail = f", RDREC B5 x{polls}" if polls else ""
        result.nominal = f"{runner.statistics.scans - before} scans, WRREC busy 3{tail}"
        name = job.instance.name
        shown = [f"{use.label} = {_shown(rig.cpu[f'{name}.{use.member}'], use.parameter.unit)}" for use in job.outputs]
        shown = shown or [f"{use.label} written" for use in job.uses]
        more = f", .. ({len(shown)})" if len(shown) > SHOWN_VALUES else ""
        result.values = ", ".join(shown[:SHOWN_VALUES]) + more
    return failure


def scenarios(job: DriveJob, runner: Runner, scans: int, level: Level) -> Iterator[Scenario]:
    """The matrix of a job: the quick part first."""
    target = runner.rig.plan.target
    yield from answer_scenarios(job, classic=target.classic)
    yield from record_scenarios(job, runner.rig.limits)
    yield from cpu_scenarios(job, runner.rig.limits, scans, retentive=target.v5)
    yield from errors_of(job, level)


def errors_of(job: DriveJob, level: Level) -> Iterator[Scenario]:
    """Error numbers: every combination, or in a large quick matrix every number and every position."""
    positions = sum(len(telegram.parts) for telegram in job.telegrams)
    total = len(known_numbers()) * positions * 2
    if level == "full" or total <= QUICK_ERRORS:
        return error_matrix(job)
    step = positions * 2 + 1
    chosen = (scenario for number, scenario in enumerate(error_matrix(job)) if number % step == number // step % step)
    return chain(chosen, error_matrix(job, (0x11,)))


def _matrix(plan: DrivePlan, program: Program, runner: Runner, result: JobResult, scans: int, level: Level) -> None:
    job, kinds = runner.rig.job, 0
    statistics = runner.statistics
    for scenario in scenarios(job, runner, scans, level):
        kinds += 1
        failure = runner.try_run(scenario)
        if failure is not None:
            result.failures.append(failure)
            if len(result.failures) >= MAX_FAILURES:
                break
            result.counts = [a + b for a, b in zip(result.counts, runner.rig.cpu.coverage, strict=True)]
            runner = Runner(JobRig(plan, program, job))
            runner.statistics = statistics
    if not result.failures:
        failure = row(runner)
        result.failures += [failure] if failure is not None else []
    result.counts = [a + b for a, b in zip(result.counts, runner.rig.cpu.coverage, strict=True)]
    if plan.target.classic and not result.failures:
        for failure, other in wrong_numbers(plan, program, job):
            result.failures += [failure] if failure is not None else []
            result.counts = [a + b for a, b in zip(result.counts, other.rig.cpu.coverage, strict=True)]
            statistics.transitions |= other.statistics.transitions
    errors = sum(1 for _ in errors_of(job, level))
    positions = sum(len(telegram.parts) for telegram in job.telegrams)
    result.matrix = (
        f"{len(known_numbers())} error numbers x {positions} positions, {kinds - errors} other faults: "
        f"{statistics.runs:,} runs, {statistics.hangs} hangs, longest {statistics.longest:,} scans"
    )
    result.statistics = statistics


def run_program(plan: DrivePlan, program: Program) -> JobResult:
    """What the jobs do to each other, through OB1."""
    result = JobResult("program", counts=[0] * len(program.probes))
    for scenario in program_scenarios(plan):
        failure, counts = try_program(plan, program, scenario)
        result.statistics.runs += 1
        result.counts = [a + b for a, b in zip(result.counts, counts, strict=True)]
        if failure is not None:
            result.failures.append(failure)
            if len(result.failures) >= MAX_FAILURES:
                break
    return result


@dataclass(frozen=True, slots=True)
class Work:
    """Every job, and the program behind the last one, as pieces of work."""

    bench: Bench
    level: Level

    def __call__(self, index: int) -> JobResult:
        """One piece."""
        plan, program = self.bench.project.plan(DrivePlan), self.bench.program
        if plan is None:
            raise TypeError("there are no drives")
        if index == len(plan.jobs):
            return run_program(plan, program)
        return run_job(plan, program, plan.jobs[index], self.level)


# --- reporting --------------------------------------------------------------------------------------------


def _diagnostic(code: str, key: str, failures: list[Failure]) -> Diagnostic:
    first = failures[0]
    more = f" (and {len(failures) - 1} more)" if len(failures) > 1 else ""
    line = f"; the statement is {Path(first.file).name}:{first.line}" if first.file and first.line else ""
    return Diagnostic(
        code,
        f"{key}: {first}{more}",
        Span(first.file, first.line),
        help=f"compare this place with docs/generated-code.md{line}",
    )


def _job_checks(job: DriveJob, result: JobResult, level: Level) -> Iterator[Check]:
    if result.broken:
        found = _diagnostic("PG620", job.key, result.failures)
        yield Check(f"run.{job.key}", f"run {job.key}", "", Outcome.ERROR, str(result.failures[0]), found)
        return
    yield Check(f"run.{job.key}", f"run {job.key}", result.nominal, Outcome.OK, f"-> {result.values}")
    name, subject = f"faults.{job.key}", f"faults {job.key}"
    if level == "none":
        yield Check(name, subject, "", Outcome.NOT_RUN, "not asked for")
    elif result.failures:
        found = _diagnostic("PG621", job.key, result.failures)
        yield Check(name, subject, result.matrix, Outcome.ERROR, str(result.failures[0]), found)
    else:
        yield Check(name, subject, result.matrix, Outcome.OK, "ok")


def _program_check(plan: DrivePlan, result: JobResult) -> Check:
    text = f"{len(plan.jobs)} jobs on {len(plan.tokens)} drives through OB1: {result.statistics.runs} scenarios"
    if not result.failures:
        return Check("together", "all jobs", text, Outcome.OK, "never two requests at once, every job gets its turn")
    found = _diagnostic("PG621", "all jobs", result.failures)
    return Check("together", "all jobs", text, Outcome.ERROR, str(result.failures[0]), found)


def _coverage_check(plan: DrivePlan, job: DriveJob, coverage: Coverage) -> Check:
    name, subject, text = f"coverage.{job.key}", f"coverage {job.key}", coverage.text
    if coverage.steps:
        steps = ", ".join(f"{STATE_NAMES[one]} to {STATE_NAMES[two]}" for one, two in sorted(coverage.steps))
        message = f"{job.key}: the block never goes from {steps}"
        return Check(
            name, subject, text, Outcome.ERROR, message, Diagnostic("PG622", message, plan.loaded.key_span(job.path))
        )
    if not coverage.missing:
        return Check(name, subject, text, Outcome.OK, coverage.verdict)
    first = coverage.missing[0]
    message = f"{job.key}: {len(coverage.missing)} statements or branches were never executed"
    found = Diagnostic("PG622", message, Span(first.file, first.line, first.column))
    return Check(name, subject, text, Outcome.ERROR, f"line {first.line} never ran", found)


def _shown(value: Tree, unit: str) -> str:
    text = value_text(value)
    return f"{text} {unit}" if unit else text


def value_text(value: Tree) -> str:
    """A value as a line of the report shows it: four elements of an array."""
    if isinstance(value, list):
        return f"[{', '.join(value_text(item) for item in value[:4])}{', ..' if len(value) > 4 else ''}]"
    if isinstance(value, float):
        return f"{value:.7g}.0" if value.is_integer() and abs(value) < 1e7 else f"{value:.7g}"
    return str(value)
