"""What verify's group ``execution`` says about a damaged source."""

from __future__ import annotations

import os
import shutil
import time
from dataclasses import dataclass, replace
from pathlib import Path

from plcgen.base.diagnostics import DiagnosticError
from plcgen.proof.execution import Work, coverage, run_job, run_together
from plcgen.proof.results import Result, added
from plcgen.proof.rig import ProgramBench
from plcgen.proof.scenario import Failure
from tests.mutation.cases import Case, encoding_of, golden, project_of, run_folder
from tests.mutation.engine import ENGINE, first_failure


@dataclass(frozen=True, slots=True)
class Verdict:
    """What was noticed, empty if nothing; ``located`` if scenario, scan and line of the source are named.

    ``seconds`` of CPU time it took.
    """

    text: str = ""
    located: bool = False
    seconds: float = 0.0


def notice(case: Case) -> Verdict:
    """What verify says about a mutant, and how long that took."""
    started = time.process_time()
    return replace(said(case), seconds=time.process_time() - started)


def said(case: Case) -> Verdict:
    """What verify says about a mutant."""
    folder = run_folder() / str(os.getpid()) / case.spec
    if not folder.exists():
        shutil.copytree(golden(case.spec), folder)
    path = folder / case.file
    before = path.read_bytes()
    path.write_text(case.mutant.text, encoding=encoding_of(case.spec), newline="")
    try:
        if case.key == ENGINE:
            return engine_verdict(folder, case.spec)
        return executed(Work(ProgramBench(project_of(case.spec), folder), "quick"), case.key)
    finally:
        path.write_bytes(before)


def engine_verdict(folder: Path, spec: str) -> Verdict:
    """What the proof of the engine says."""
    try:
        failure = first_failure(folder, project_of(spec).target.dialect)
    except DiagnosticError as problem:
        first = problem.diagnostics[0]
        return Verdict(f"does not compile: {first.message}", located=first.span.line > 0)
    return Verdict() if failure is None else _of(failure)


def executed(work: Work, key: str) -> Verdict:
    """Run the jobs of a block, then all of them together, then look at its coverage; without a key, only together.

    Every job runs once before one of them meets all faults: most damage shows there already.
    """
    try:
        program = work.bench.program
    except DiagnosticError as problem:
        first = problem.diagnostics[0]
        return Verdict(f"does not compile: {first.message}", located=first.span.line > 0)
    for suite in work.suites:
        blocks = [block for block in suite.blocks() if block.key == key]
        if key and not blocks:
            continue
        jobs = [job for block in blocks for job in block.jobs]
        for job in jobs if len(jobs) > 1 else ():
            plain = run_job(suite, program, job, "none", most=1)
            if plain.failures:
                return _verdict(plain)
        results: dict[str, Result] = {}
        for job in jobs:
            results[job.key] = run_job(suite, program, job, "quick", most=1)
            if results[job.key].failures:
                return _verdict(results[job.key])
        together = run_together(suite, program, most=1)
        if together.failures:
            return _verdict(together)
        counts = added(program, (*results.values(), together))
        for block in blocks:
            missing = coverage(program, block, counts, results).missing
            if missing:
                return Verdict(f"line {missing[0].line} never ran")
    return Verdict()


def _verdict(result: Result) -> Verdict:
    return _of(result.failures[0])


def _of(failure: Failure) -> Verdict:
    place = f"{Path(failure.file).name}:{failure.line}"
    return Verdict(f"{failure} ({place})", located=bool(failure.scenario and failure.scan and failure.line > 0))
