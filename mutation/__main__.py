"""Damage the generated SCL of the two seeds and count what verify notices: ``python -m mutation [SPEC..]``."""

from __future__ import annotations

import argparse
import multiprocessing
import os
import shutil
import sys
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from mutation.equivalent import reason
from mutation.known import FAQ, KNOWN, MM4
from mutation.operators import Mutant, mutants
from plcgen.diagnostics import DiagnosticError, Report
from plcgen.plan.model import PlannedJob, Project
from plcgen.plan.resolve import resolve
from plcgen.spec.load import load_spec
from plcgen.verify import execution
from plcgen.verify.coverage import measure, merge
from plcgen.verify.execution_rig import load_program

ROOT = Path(__file__).resolve().parent.parent
GOAL = 98.0


@dataclass(frozen=True, slots=True)
class Case:
    """A mutant in its place."""

    spec: str
    file: str
    job: str
    mutant: Mutant


_projects: dict[str, Project] = {}


def project_of(spec: str) -> Project:
    """The plan of a shipped spec."""
    if spec not in _projects:
        loaded = load_spec(ROOT / "specs" / f"{spec}.yaml", Report())
        if loaded is None:
            raise SystemExit(f"{spec} cannot be read")
        _projects[spec] = resolve(loaded, Report())
    return _projects[spec]


def golden(spec: str) -> Path:
    """The generated files of a shipped spec."""
    return ROOT / "examples" / spec / "expected"


def notice(case: Case) -> str:
    """What verify says about a mutant; empty if it notices nothing."""
    project = project_of(case.spec)
    folder = Path(tempfile.gettempdir()) / f"plcgen-mutation-{os.getpid()}" / case.spec
    if not folder.exists():
        shutil.copytree(golden(case.spec), folder)
    path = folder / case.file
    before = path.read_bytes()
    encoding = "cp1252" if project.target.v5 else "utf-8-sig"
    path.write_text(case.mutant.text, encoding=encoding, newline="")
    try:
        return executed(project, folder, case.job)
    finally:
        path.write_bytes(before)


def executed(project: Project, folder: Path, key: str) -> str:
    """Run one job, then all of them together, then look at coverage."""
    try:
        program = load_program(project, folder)
    except DiagnosticError as problem:
        return f"does not compile: {problem.diagnostics[0].message}"
    job: PlannedJob = next(job for job in project.jobs if job.key == key)
    execution.MAX_FAILURES = 1
    first = execution.run_job(project, program, job, "quick")
    if first.failures:
        return str(first.failures[0])
    second = execution.run_program(project, program)
    if second.failures:
        return str(second.failures[0])
    counts = [a + b for a, b in zip(first.counts, second.counts, strict=True)]
    missing = merge(job, measure(program, job.block.name, counts)).missing
    return f"line {missing[0].line} never ran" if missing else ""


def cases(specs: list[str], every: int) -> Iterator[Case]:
    """Every mutant of every block; every n-th one for a quick look."""
    for spec in specs:
        project = project_of(spec)
        for job in project.jobs:
            file = f"scl/{job.block.name}.scl"
            encoding = "cp1252" if project.target.v5 else "utf-8-sig"
            text = (golden(spec) / file).read_text(encoding=encoding)
            for number, mutant in enumerate(mutants(text)):
                if number % every == 0:
                    yield Case(spec, file, job.key, mutant)


def known_cases() -> Iterator[Case]:
    """The ten faults of other libraries."""
    for known in KNOWN:
        project = project_of(known.spec)
        encoding = "cp1252" if project.target.v5 else "utf-8-sig"
        text = (golden(known.spec) / known.file).read_text(encoding=encoding)
        if known.old not in text:
            raise SystemExit(f"{known.name}: {known.old!r} is not in {known.file}")
        key = next(job.key for job in project.jobs if job.block.name in known.file)
        yield Case(known.spec, known.file, key, Mutant(known.name, 0, text.replace(known.old, known.new)))


def is_single(case: Case) -> bool:
    """Whether the job has one parameter."""
    return next(len(job.uses) == 1 for job in project_of(case.spec).jobs if job.key == case.job)


def say(line: str) -> None:
    """One line of the report."""
    sys.stdout.write(f"{line}\n")


def main() -> int:
    """Print the figures and every survivor; 1 if the goal is missed."""
    parser = argparse.ArgumentParser(prog="mutation")
    parser.add_argument("specs", nargs="*", default=[FAQ, MM4])
    parser.add_argument("--every", type=int, default=1, help="take every n-th mutant only")
    parser.add_argument("--file", default="", help="only files with this in their name")
    options = parser.parse_args()
    started = time.monotonic()
    work = [*known_cases(), *(case for case in cases(options.specs, options.every) if options.file in case.file)]
    with ProcessPoolExecutor(os.cpu_count(), multiprocessing.get_context("fork")) as pool:
        verdicts = list(pool.map(notice, work, chunksize=8))
    for folder in Path(tempfile.gettempdir()).glob("plcgen-mutation-*"):
        shutil.rmtree(folder, ignore_errors=True)
    noticed = equivalent = 0
    for case, verdict in zip(work, verdicts, strict=True):
        why = "" if verdict else reason(case.mutant, single=is_single(case))
        noticed += bool(verdict)
        equivalent += bool(why)
        if not verdict:
            say(f"{case.spec}/{case.file}:{case.mutant.line}: {case.mutant.what}: {why or 'NOT NOTICED'}")
    share = 100.0 * noticed / (len(work) - equivalent)
    say(f"{len(work)} mutants, {noticed} noticed, {equivalent} change nothing that can be seen: {share:.2f} %")
    say(f"all {len(KNOWN)} known faults noticed: {all(verdicts[: len(KNOWN)])}; {time.monotonic() - started:.0f} s")
    return 0 if share >= GOAL and all(verdicts[: len(KNOWN)]) else 1


if __name__ == "__main__":
    sys.exit(main())
