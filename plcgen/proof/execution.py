"""Checks of the group ``execution``: the generated SCL runs in the simulated CPU, under every fault."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cached_property, partial
from pathlib import Path
from typing import Any

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.base.diagnostics.counting import quantity
from plcgen.project.nouns import PlannedJob, Project
from plcgen.project.ownership import is_owned
from plcgen.proof.checks import Check, Outcome, Trial
from plcgen.proof.coverage import Coverage, cover
from plcgen.proof.dependence import part_keys
from plcgen.proof.effort import Faults
from plcgen.proof.idle import idle_check
from plcgen.proof.making import Pending, make_checks, unexpected
from plcgen.proof.results import Result, added
from plcgen.proof.rig import ProgramBench, file_of
from plcgen.proof.runner import Runner
from plcgen.proof.scenario import Failure, ScenarioError, Statistics, diagnostic
from plcgen.proof.sharing import Sharing
from plcgen.proof.suite import CodeBlock, Procedure, Suite, WorkPart
from plcgen.s7.cpu.program import Program
from plcgen.s7.scl.logic import DECIDES

MAX_FAILURES = 3


class Work:
    """Every job of every suite, and what they do together, as parts of work."""

    def __init__(self, bench: ProgramBench, level: Faults) -> None:
        self.bench, self.level = bench, level

    def __reduce__(self) -> tuple[type[Work], tuple[ProgramBench, Faults]]:
        """A worker makes the suites again."""
        return Work, (self.bench, self.level)

    @cached_property
    def suites(self) -> list[Suite[Any]]:
        """The suites of all protocols."""
        return [s for plan in self.bench.project.plans for s in plan.protocol.proof(plan).suites()]

    @cached_property
    def procedures(self) -> list[list[Procedure]]:
        """What the jobs of each suite do to each other."""
        every = self.suites if self.level != "none" else ()
        return [list(suite.procedures(self.bench.program)) for suite in every]

    @cached_property
    def parts(self) -> list[WorkPart]:
        """Jobs, then procedures, suite by suite."""
        found = []
        for number, suite in enumerate(self.suites):
            found += [WorkPart(number, job) for job in range(len(suite.jobs))]
            if self.level != "none":
                found += [WorkPart(number, None, each) for each in range(len(self.procedures[number]))]
        return found

    def __call__(self, index: int) -> Result:
        """One part."""
        part = self.parts[index]
        suite = self.suites[part.suite]
        job = suite.jobs[part.job] if part.job is not None else None
        try:
            if job is None:
                return run_procedure(self.bench.program, self.procedures[part.suite][part.procedure])
            return run_job(suite, self.bench.program, job, self.level)
        except DiagnosticError:
            raise
        except Exception as problem:  # noqa: BLE001 - becomes the result, in a worker too
            blocks = suite.blocks() if job is None else [one for one in suite.blocks() if job in one.jobs]
            file = file_of(self.bench.program, blocks[0].block) if blocks else str(self.bench.folder)
            message = unexpected(problem, Span(file)).message
            return Result(failures=[Failure("", 0, message, file, 1, stopped=True)], broken=True)


def check_execution(
    project: Project,
    folder: Path,
    level: Faults = "quick",
    share: Sharing | None = None,
    partner: Path | None = None,
    *,
    bench: ProgramBench | None = None,
) -> Iterator[Check]:
    """Run every job of the files on disk; ``share`` None uses every core, ``bench`` has the program if it is read.

    ``partner`` is the user's file of a partner: every job runs once against it too.
    """
    checks = _executed(bench or ProgramBench(project, folder), level, share or Sharing(), partner)
    return make_checks(checks, "execution", Span(str(folder)))


def _executed(bench: ProgramBench, level: Faults, share: Sharing, partner: Path | None) -> Iterator[Check | Pending]:
    project, folder = bench.project, bench.folder
    place = Span(str(folder))
    work = Work(bench, level)
    try:
        program = work.bench.program
    except DiagnosticError as problem:
        first = problem.diagnostics[0]
        yield Check("execution.scl", "sources", "SCL in the simulated CPU", Outcome.ERROR, first.message, first)
        return
    if level != "none":
        for plan in project.plans:
            checks = partial(plan.protocol.proof(plan).foundation, folder)
            yield Pending("engine", "engine", lambda: place, checks)
        yield Pending("execution.idle", "idle scan", lambda: place, partial(idle_check, program))
    every: list[Result] = []
    one = Sharing(workers=1, progress=share.progress) if level == "none" and share.plain else share
    found = iter(one.results(work, len(work.parts), part_keys(work)))
    for number, suite in enumerate(work.suites):
        results = {job.key: next(found) for job in suite.jobs}
        for job in suite.jobs:
            yield from job_checks(suite, job, results[job.key], level)
        if partner is not None:
            own = partial(suite.own, program, partner)
            yield Pending("own", "your partner", lambda: Span(str(partner)), own)
        if level == "none":
            continue
        together = _joined([next(found) for _ in work.procedures[number]])
        yield together_check(suite, together)
        yield from suite.left_out()
        every += [*results.values(), together]
        if not any(result.failures for result in (*results.values(), together)):
            counts = added(program, (*results.values(), together))
            for block in suite.blocks():
                make = partial(_covered, program, block, counts, results)
                yield Pending(f"coverage.{block.key}", f"coverage {block.name}", block.span, make)
    if every and not any(result.failures for result in every):
        yield from main_coverage(project, program, added(program, every))


def _covered(program: Program, block: CodeBlock, counts: list[int], results: dict[str, Result]) -> Check:
    return coverage_check(block, coverage(program, block, counts, results))


def main_coverage(project: Project, program: Program, counts: list[int]) -> Iterator[Check]:
    """The check of the cyclic OB, which calls what all protocols have made; one that is the user's own is not ours."""
    main = program.main()
    if main is not None and not is_owned(main.result.tokens.file, project.loaded.spec.plc.user_owned):
        block = CodeBlock(main.name, main.name, main.name, (), lambda: project.loaded.key_span(("plc",)))
        yield coverage_check(block, cover(program, main.name, counts))


# --- running ----------------------------------------------------------------------------------------------


def run_job(suite: Suite[Any], program: Program, job: PlannedJob, level: Faults, most: int = MAX_FAILURES) -> Result:
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
        result.add(failure, program, runner.conduct.rig.cpu.coverage)
        result.broken = True
        return result
    result.run, result.values = suite.shown(runner, statistics.scans - scans)
    if level != "none":
        runner = run_matrix(suite, program, job, runner, result, longest, level, most)
    result.add(None, program, runner.conduct.rig.cpu.coverage)
    return result


def run_matrix(
    suite: Suite[Any],
    program: Program,
    job: PlannedJob,
    runner: Runner[Any],
    result: Result,
    scans: int,
    level: Faults,
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
            result.add(failure, program, runner.conduct.rig.cpu.coverage)
            runner = suite.runner(program, job, result.statistics)
            if len(result.failures) >= most:
                break
            runner.try_run(suite.first())
    if not result.failures:
        for failure, other in suite.behind(program, runner):
            result.add(failure, program, other.conduct.rig.cpu.coverage if other is not runner else [])
    result.matrix = f"{suite.faults(job, level, kinds)}: {result.statistics}"
    return runner


def run_procedure(program: Program, procedure: Procedure) -> Result:
    """Something that the jobs of a suite do to each other."""
    result = Result(statistics=Statistics(runs=1))
    failure, counts = attempt(procedure)
    result.add(failure, program, counts)
    return result


def run_together(suite: Suite[Any], program: Program, most: int = MAX_FAILURES) -> Result:
    """What the jobs of a suite do to each other, until something has failed so often."""
    results: list[Result] = []
    for procedure in suite.procedures(program):
        results.append(run_procedure(program, procedure))
        if sum(len(result.failures) for result in results) >= most:
            break
    return _joined(results)


def _joined(results: Sequence[Result]) -> Result:
    """The results of all procedures of a suite as one; the first failures stand for all."""
    whole = Result(made=made(results, "scenarios"))
    for result in results:
        whole.failures += result.failures
        whole.statistics.runs += result.statistics.runs
        whole.count(result.counts)
    del whole.failures[MAX_FAILURES:]
    return whole


def attempt(procedure: Procedure) -> tuple[Failure | None, list[int]]:
    """Run a procedure on a CPU of its own; what failed, and the counters of coverage."""
    try:
        bed = procedure.bed()
    except (ScenarioError, KeyError) as problem:
        return Failure(procedure.name, 0, f"the blocks cannot be called: {problem}", "", 0), []
    try:
        procedure.run(bed)
    except ScenarioError as problem:
        message, stopped = str(problem), False
    except Exception as problem:  # noqa: BLE001 - changed sources may make the simulated CPU itself fail
        message, stopped = unexpected(problem, Span("")).message, True
    else:
        return None, bed.cpu.coverage
    place = bed.place
    if bed.cpu.misuses:
        misuse = bed.cpu.misuses[0]
        message, place, stopped = str(misuse), (misuse.file, misuse.line), False
    return Failure(procedure.name, bed.scans, message, *place, stopped=stopped), bed.cpu.coverage


def coverage(program: Program, block: CodeBlock, counts: list[int], results: dict[str, Result]) -> Coverage:
    """Coverage of a block, with the ways from state to state that its jobs went."""
    steps = block.steps
    if steps is not None:
        steps = steps.difference(*(results[job.key].statistics.transitions for job in block.jobs))
    return cover(program, block.block, counts, block.premises, block.opened, steps)


def made(results: Sequence[Result], what: str) -> str:
    """How many of several results come from the cache, and when the oldest was made."""
    times = [result.made for result in results if result.made]
    return f"{len(times)} of {len(results)} {what} from the cache, the oldest of {min(times)}" if times else ""


# --- reporting --------------------------------------------------------------------------------------------


def failed(name: str, subject: str, text: str, found: Diagnostic, verdict: str = "") -> Check:
    """A check that failed."""
    return Check(name, subject, text, Outcome.ERROR, verdict or found.message, found)


def job_checks(suite: Suite[Any], job: PlannedJob, result: Result, level: Faults) -> Iterator[Check]:
    """The checks of one job: nominal run and matrix."""
    shown = suite.shown_name(job)
    name, subject = f"run.{suite.prefix}{job.key}", f"run {shown}"
    if result.broken:
        found = diagnostic("PG620", shown, result.failures, suite.page)
        yield failed(name, subject, "", found, str(result.failures[0]))
        return
    cached = f"; from the cache, made {result.made}" if result.made else ""
    yield Check(name, subject, f"{result.run}{cached}", Outcome.OK, f"-> {result.values}")
    name, subject = f"faults.{suite.prefix}{job.key}", f"faults {shown}"
    if level == "none":
        yield Check(name, subject, "", Outcome.NOT_RUN, "not asked for")
    elif result.failures:
        found = diagnostic("PG621", shown, result.failures, suite.page)
        yield replace(failed(name, subject, result.matrix, found, str(result.failures[0])), trials=tuple(result.trials))
    else:
        yield Check(name, subject, f"{result.matrix}{cached}", Outcome.OK, "ok", trials=tuple(result.trials))


def together_check(suite: Suite[Any], result: Result) -> Check:
    """The check of all jobs of a suite."""
    good = suite.together(result.statistics.runs)
    if not result.failures:
        return replace(good, text=f"{good.text}; {result.made}") if result.made else good
    found = diagnostic("PG621", good.subject, result.failures, suite.page)
    trials = tuple(Trial(one.scenario, one.scan, ok=False) for one in result.failures)
    return replace(failed(good.id, good.subject, good.text, found, str(result.failures[0])), trials=trials)


def coverage_check(block: CodeBlock, found: Coverage) -> Check:
    """The check of the coverage of a block."""
    name, subject = f"coverage.{block.key}", f"coverage {block.name}"
    if found.steps:
        steps = ", ".join(f"{block.state(one)} to {block.state(two)}" for one, two in sorted(found.steps))
        message = f"{block.name}: the block never goes from {steps}"
        return failed(name, subject, found.text, Diagnostic("PG622", message, block.span()))
    if not found.missing:
        return Check(name, subject, found.text, Outcome.OK, found.verdict)
    sides = tuple(probe for probe in found.missing if probe.kind in DECIDES.values())
    ran = len(found.missing) - len(sides)
    first = next((probe for probe in found.missing if probe not in sides), found.missing[0])
    said = [quantity(ran, "statement or branch was", "statements or branches were") + " never executed"] if ran else []
    if sides:
        said.append(f"an operand never {sides[0].kind} ({len(sides)} such in all)")
    problem = Diagnostic("PG622", f"{block.name}: {', '.join(said)}", Span(first.file, first.line, first.column))
    verdict = f"line {first.line} never ran" if ran else f"line {first.line} has an operand that never {first.kind}"
    return failed(name, subject, found.text, problem, verdict)
