"""The idle scan: how many statements the cyclic OB executes while no job runs."""

from __future__ import annotations

from pathlib import Path

from plcgen.project.nouns import Project
from plcgen.proof.checks import Check, Outcome
from plcgen.proof.standins import stand_ins
from plcgen.s7.cpu.cpu import Cpu
from plcgen.s7.cpu.program import Program
from plcgen.s7.cpu.sources import load_folder

_SCANS = 4
"""In the first scans after a start blocks initialise themselves."""


def idle_statements(project: Project, folder: Path) -> int | None:
    """Statements of an idle scan of the blocks in a folder; None if they do not run or have no cyclic OB."""
    proofs = (plan.protocol.proof(plan) for plan in project.plans)
    constants = {name: number for proof in proofs for name, number in proof.constants().items()}
    foreign = stand_ins(project)
    dialect, more = project.target.dialect, foreign.sources.values()
    program = load_folder(folder, dialect, coverage=True, constants=constants, symbols=foreign.tags, more=more)
    return count(program) if program.ok else None


def count(program: Program) -> int | None:
    """Statements of an idle scan of a program on any CPU of its dialect, those of called blocks included.

    The program must have been compiled for coverage.
    """
    if program.main() is None:
        return None
    cpu = Cpu(program)
    cpu.scan(10, _SCANS - 1)
    cpu.forget_coverage()
    cpu.scan(10)
    passed = (n for probe, n in zip(program.probes, cpu.coverage, strict=True) if probe.kind == "statement")
    return None if cpu.faulted else sum(passed)


def idle_check(program: Program) -> Check:
    """What an idle scan takes, for the report."""
    found = count(program)
    if found is None:
        return Check("execution.idle", "idle scan", "no cyclic OB, or it does not end", Outcome.NOT_RUN, "not run")
    return Check("execution.idle", "idle scan", f"{found:,} statements", Outcome.OK, "ok: no job runs")
