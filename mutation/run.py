"""What verify's group ``execution`` says about a damaged source."""

from __future__ import annotations

import os
import shutil
import tempfile
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from mutation.cases import Case, encoding_of, golden, project_of
from plcgen.cpu.program import Program
from plcgen.diagnostics import DiagnosticError
from plcgen.project.nouns import Project
from plcgen.proof.coverage import cover, measure, merge
from plcgen.protocols.ds47.plan.nouns import DrivePlan
from plcgen.protocols.ds47.proof import execution
from plcgen.protocols.ds47.proof.rig import load_program
from plcgen.protocols.ppi.plan.nouns import PpiPlan
from plcgen.protocols.ppi.proof import execution as ppi_execution

FOLDERS = "plcgen-mutation-"


@dataclass(frozen=True, slots=True)
class Verdict:
    """What was noticed, empty if nothing; ``located`` if scenario, scan and line of the source are named."""

    text: str = ""
    located: bool = False


def notice(case: Case) -> Verdict:
    """What verify says about a mutant."""
    folder = Path(tempfile.gettempdir()) / f"{FOLDERS}{os.getpid()}" / case.spec
    if not folder.exists():
        shutil.copytree(golden(case.spec), folder)
    path = folder / case.file
    before = path.read_bytes()
    path.write_text(case.mutant.text, encoding=encoding_of(case.spec), newline="")
    try:
        return executed(project_of(case.spec), folder, case.job)
    finally:
        path.write_bytes(before)


def executed(project: Project, folder: Path, key: str) -> Verdict:
    """Run one job, then all of them together, then look at coverage."""
    try:
        program = load_program(project, folder)
    except DiagnosticError as problem:
        first = problem.diagnostics[0]
        return Verdict(f"does not compile: {first.message}", located=first.span.line > 0)
    execution.MAX_FAILURES = 1
    plan = project.plan(DrivePlan)
    chosen = [job for job in plan.jobs if job.key == key] if plan else []
    counts = [0] * len(program.probes)
    for job in chosen:
        result = execution.run_job(plan, program, job, "quick")
        if result.failures:
            return _verdict(result)
        counts = [a + b for a, b in zip(counts, result.counts, strict=True)]
    found = _masters(project, program, key)
    if found.text or plan is None:
        return found
    result = execution.run_program(plan, program)
    if result.failures:
        return _verdict(result)
    counts = [a + b for a, b in zip(counts, result.counts, strict=True)]
    for job in chosen:
        missing = merge(job, measure(program, job.block.name, counts)).missing
        if missing:
            return Verdict(f"line {missing[0].line} never ran")
    return Verdict()


def _masters(project: Project, program: Program, key: str) -> Verdict:
    """Every job of the damaged master, or what the masters do through OB1."""
    plan = project.plan(PpiPlan)
    for master in plan.masters if plan is not None else ():
        if key not in {"", master.key}:
            continue
        counts = [0] * len(program.probes)
        for job in master.jobs if key else ():
            thorough = ppi_execution.is_first(master, job)
            result = ppi_execution.run_job(plan, program, master, job, "quick", thorough=thorough)
            if result.failures:
                return _verdict(result)
            counts = [a + b for a, b in zip(counts, result.counts, strict=True)]
        result = ppi_execution.all_jobs(plan, program, master)
        if result.failures:
            return _verdict(result)
        counts = [a + b for a, b in zip(counts, result.counts, strict=True)]
        reason = partial(ppi_execution.explanation, plan, master)
        missing = cover(measure(program, master.block.name, counts), reason).missing
        if key and missing:
            return Verdict(f"line {missing[0].line} never ran")
    return Verdict()


def _verdict(result: execution.JobResult | ppi_execution.JobResult) -> Verdict:
    failure = result.failures[0]
    place = f"{Path(failure.file).name}:{failure.line}"
    return Verdict(f"{failure} ({place})", located=bool(failure.scenario and failure.scan and failure.line > 0))


def clean() -> None:
    """Remove the folders of all processes."""
    for folder in Path(tempfile.gettempdir()).glob(f"{FOLDERS}*"):
        shutil.rmtree(folder, ignore_errors=True)
