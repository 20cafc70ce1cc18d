"""Checks of PPI masters in the group ``execution``: the generated SCL against S7-200 stations, under every fault."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Literal

from plcgen.cpu.linkage import Probe
from plcgen.cpu.program import Program
from plcgen.proof.checks import Check, Outcome
from plcgen.proof.coverage import NO_OTHER, Coverage, cover, measure
from plcgen.proof.failures import diagnostic
from plcgen.proof.workers import shared_out
from plcgen.protocols.ds47.proof.execution import value_text
from plcgen.protocols.ds47.proof.rig import Bench, ScenarioError
from plcgen.protocols.ds47.proof.runner import Failure, Statistics
from plcgen.protocols.ppi.plan.nouns import PlannedMaster, PpiJob, PpiPlan
from plcgen.protocols.ppi.proof.rig import MasterRig
from plcgen.protocols.ppi.proof.runner import MasterRunner
from plcgen.protocols.ppi.proof.scenario import (
    PpiScenario,
    core_scenarios,
    cpu_scenarios,
    line_scenarios,
    module_scenarios,
    pace_scenarios,
)
from plcgen.protocols.ppi.proof.together import ROW, behind, row, together, wrong_number
from plcgen.protocols.ppi.words import CLOCK_END

Level = Literal["none", "quick", "full"]
Progress = Callable[[str, int, int], None]
MAX_FAILURES = 3
SHOWN = 3
RETRIES = frozenset(
    {
        "IF statRetries < MAX_RETRIES THEN",
        "statRetries := statRetries + 1;",
        "IF statState = STATE_SEND OR statState = STATE_ACK THEN",
        "statResume := STATE_SEND;",
        "statResume := STATE_POLL;",
        "statPause := RETRY_PAUSE;",
    }
)
ALTERNATING = frozenset(
    {
        "ELSIF statFunctionCode[statStation] <> B1600 THEN",
        "IF statFunctionCode[statStation] = B165C THEN",
        "statFunctionCode[statStation] := B165C;",
        "statFunctionCode[statStation] := B167C;",
    }
)
"""With one poll per telegram every request has 7C and every poll 5C: the lines without their number signs."""
POLLS = ALTERNATING | {"statPause := POLL_PAUSE;", "statResume := STATE_POLL;"}
PAUSES = frozenset({"IF tempElapsed >= statPause THEN", "statState := statResume;", "statSince := tempNow;"})
SHAPES = {"read": "read", "write": "write", "run": "service", "stop": "service"}
"""Kinds of jobs whose replies are walked alike: one of each runs through the whole matrix."""


@dataclass(slots=True)
class JobResult:
    """What the runs of one job gave."""

    run: str = ""
    values: str = ""
    matrix: str = ""
    failures: list[Failure] = field(default_factory=list)
    counts: list[int] = field(default_factory=list)

    def add(self, counts: list[int]) -> None:
        """Add the coverage of one CPU."""
        self.counts = [a + b for a, b in zip(self.counts, counts, strict=True)] if self.counts else list(counts)


@dataclass(frozen=True, slots=True)
class Work:
    """Every job of a master, and all of them behind the last one, as pieces of work."""

    bench: Bench
    number: int
    level: Level

    def __call__(self, index: int) -> JobResult:
        """One piece."""
        plan, program = self.bench.project.plan(PpiPlan), self.bench.program
        if plan is None:
            raise TypeError("there are no masters")
        master = plan.masters[self.number]
        if index == len(master.jobs):
            return all_jobs(plan, program, master)
        job = master.jobs[index]
        thorough = self.level == "full" or is_first(master, job)
        return run_job(plan, program, master, job, self.level, thorough=thorough)


def check_masters(bench: Bench, level: Level, progress: Progress | None, workers: int | None = None) -> Iterator[Check]:
    """Run every master of the files on disk; ``workers`` None uses every core."""
    plan, program = bench.project.plan(PpiPlan), bench.program
    if plan is None:
        return
    for number, master in enumerate(plan.masters):
        jobs = master.jobs
        tasks = len(jobs) + (level != "none")
        results = shared_out(Work(bench, number, level), tasks, progress, workers if level != "none" else 1)
        for job, result in zip(jobs, results, strict=False):
            yield from _job_checks(master, job, result, level)
        if level != "none":
            yield _together(master, results[-1])
            if not any(result.failures for result in results):
                counts = [sum(column) for column in zip(*(result.counts for result in results), strict=True)]
                yield _coverage(plan, program, master, counts)


def is_first(master: PlannedMaster, job: PpiJob) -> bool:
    """Whether a job is the first of its shape: the quick matrix runs it through everything."""
    return job is next(other for other in master.jobs if SHAPES[other.kind] == SHAPES[job.kind])


def run_job(
    plan: PpiPlan, program: Program, master: PlannedMaster, job: PpiJob, level: Level, *, thorough: bool
) -> JobResult:
    """First run, nominal run and matrix of one job."""
    result = JobResult()
    try:
        runner = MasterRunner(MasterRig(plan, program, master))
    except (ScenarioError, KeyError) as problem:
        result.failures.append(Failure(job.key, 0, f"the block cannot be called: {problem}", "", 0))
        return result
    failure = runner.try_run(job, PpiScenario(name="first run", retries=None, polls=None), follow=False)
    scans = runner.statistics.longest
    before = runner.statistics.scans
    failure = failure or runner.try_run(job, PpiScenario(name="nominal run"), follow=False)
    if failure is not None:
        result.failures.append(failure)
        result.add(runner.rig.cpu.coverage)
        return result
    result.run = f"{runner.statistics.scans - before} scans, {_frames(runner)}"
    result.values = _shown(runner, job)
    if level != "none":
        _matrix(plan, program, runner, job, scenarios(plan, master, job, scans, thorough=thorough), result)
    else:
        result.add(runner.rig.cpu.coverage)
    return result


def _frames(runner: MasterRunner) -> str:
    polls = sum(len(data) == 6 for _, data in runner.rig.port.sent)
    requests = len(runner.rig.port.sent) - polls
    return f"{requests} request{'s' * (requests != 1)}, {polls} poll{'s' * (polls != 1)}"


def _shown(runner: MasterRunner, job: PpiJob) -> str:
    name = runner.rig.master.instance.name
    if job.kind in {"run", "stop"}:
        return f"{job.station.key} in {job.kind.upper()}"
    cpu = runner.rig.cpu
    texts = [f"{value.label} = {value_text(cpu[f'{name}.{job.pin(value.member)}'])}" for value in job.outputs]
    texts = texts or [f"{value.label} written" for value in job.values]
    return ", ".join(texts[:SHOWN]) + (f", .. ({len(texts)})" if len(texts) > SHOWN else "")


def scenarios(
    plan: PpiPlan, master: PlannedMaster, job: PpiJob, scans: int, *, thorough: bool
) -> Iterator[PpiScenario]:
    """The matrix of a job: all of it, or what depends on the job itself and one of each kind of the rest."""
    classic = plan.target.classic
    if not thorough:
        yield from core_scenarios(master, job, scans)
        return
    yield from line_scenarios(master, job)
    yield from pace_scenarios(master, job)
    yield from module_scenarios(master, job, classic=classic)
    yield from cpu_scenarios(scans, CLOCK_END, retentive=plan.target.v5)


def _matrix(
    plan: PpiPlan,
    program: Program,
    runner: MasterRunner,
    job: PpiJob,
    matrix: Iterator[PpiScenario],
    result: JobResult,
) -> None:
    failures, statistics, kinds = result.failures, runner.statistics, 0
    for scenario in matrix:
        kinds += 1
        failure = runner.try_run(job, scenario)
        if failure is None:
            continue
        failures.append(failure)
        result.add(runner.rig.cpu.coverage)
        if len(failures) >= MAX_FAILURES:
            return
        runner = MasterRunner(MasterRig(plan, program, runner.rig.master))
        runner.statistics = statistics
        runner.try_run(job, PpiScenario(name="first run", retries=None, polls=None), follow=False)
    result.add(runner.rig.cpu.coverage)
    result.matrix = _figures(kinds, statistics)


def _figures(kinds: int, statistics: Statistics) -> str:
    return (
        f"{kinds} faults of line, module and CPU: {statistics.runs:,} runs, {statistics.hangs} hangs, "
        f"longest {statistics.longest:,} scans"
    )


# --- reporting ------------------------------------------------------------------------------------------------


def _job_checks(master: PlannedMaster, job: PpiJob, result: JobResult, level: Level) -> Iterator[Check]:
    key = f"{master.key}.{job.key}"
    if not result.run:
        found = diagnostic("PG620", job.key, result.failures)
        yield Check(f"run.{key}", f"run {job.key}", "", Outcome.ERROR, str(result.failures[0]), found)
        return
    yield Check(f"run.{key}", f"run {job.key}", result.run, Outcome.OK, f"-> {result.values}")
    if level == "none":
        yield Check(f"faults.{key}", f"faults {job.key}", "", Outcome.NOT_RUN, "not asked for")
    elif result.failures:
        found = diagnostic("PG621", job.key, result.failures)
        text = str(result.failures[0])
        yield Check(f"faults.{key}", f"faults {job.key}", result.matrix, Outcome.ERROR, text, found)
    else:
        yield Check(f"faults.{key}", f"faults {job.key}", result.matrix, Outcome.OK, "ok")


def all_jobs(plan: PpiPlan, program: Program, master: PlannedMaster) -> JobResult:
    """All jobs at once, 600 in a row, a buffer with a wrong number."""
    result = JobResult()
    for run in (together, behind, row, *([wrong_number] if plan.target.classic else [])):
        failure, counts = run(plan, program, master)
        result.add(counts)
        if failure is not None:
            result.failures.append(failure)
    return result


def _together(master: PlannedMaster, result: JobResult) -> Check:
    stations = f"{len(master.stations)} station{'s' * (len(master.stations) != 1)}"
    text = f"{len(master.jobs)} jobs on {stations} through OB1, {ROW} jobs in a row"
    name, subject = f"together.{master.key}", f"jobs of {master.key}"
    if result.failures:
        found = diagnostic("PG621", f"jobs of {master.key}", result.failures)
        return Check(name, subject, text, Outcome.ERROR, str(result.failures[0]), found)
    return Check(name, subject, text, Outcome.OK, "round robin, one frame at a time, every job gets its turn")


def _coverage(plan: PpiPlan, program: Program, master: PlannedMaster, counts: list[int]) -> Check:
    found: Coverage = cover(
        measure(program, master.block.name, counts), lambda probe, line: explanation(plan, master, probe, line)
    )
    name, subject = f"coverage.{master.key}", f"coverage {master.block.name}"
    if not found.missing:
        return Check(name, subject, found.text, Outcome.OK, found.verdict)
    first = found.missing[0]
    message = f"{master.block.name}: {len(found.missing)} statements or branches were never executed"
    problem = diagnostic("PG622", message, [], first)
    return Check(name, subject, found.text, Outcome.ERROR, f"line {first.line} never ran", problem)


def explanation(plan: PpiPlan, master: PlannedMaster, probe: Probe, line: str) -> str:
    """Why a branch or statement of a master cannot run; empty if it should."""
    text = line.replace("#", "")
    if probe.kind == "else" and text.startswith("CASE "):
        return NO_OTHER
    alone = len(master.jobs) == 1 and plan.target.classic
    occupied = (
        "IF statPhase[tempJob] = PHASE_WAITING THEN",
        "statPhase[tempJob] := PHASE_IDLE;",
        "statStatus[tempJob] := STATUS_PORT_OCCUPIED;",
    )
    if alone and text in occupied and probe.kind != "else":
        return "a single job never waits for the port"
    if not master.retries and text in RETRIES and (probe.kind != "else" or "STATE_ACK" in text):
        return "no retries"
    if master.polls == 1 and text in POLLS:
        return "one poll only"
    if master.polls == 1 and not master.retries and (text in PAUSES or "STATE_WAIT" in text):
        return "neither retries nor further polls"
    if master.polls == 1 and probe.kind == "else" and text == "IF statState = STATE_ACK THEN":
        return "one poll only"
    single = all(len(t.items) < 2 for t in master.telegrams)
    if single and text.startswith(
        ("IF tempItem < tempLastItem", "tempAt := tempAt + tempSize MOD", "IF tempFailed = 0 OR")
    ):
        return "every telegram has one item"
    return ""
