"""The rows of a report about the statement: one for each master."""

from __future__ import annotations

from collections.abc import Iterator

from plcgen.base.diagnostics import Diagnostic, DiagnosticError
from plcgen.base.diagnostics.counting import quantity
from plcgen.oracles.spec.place import NotStatedError
from plcgen.ppi.plan.nouns import PlannedMaster, PpiPlan
from plcgen.ppi.proof.stated.rig import PAGE, StatedBed, ports_of
from plcgen.ppi.proof.stated.times import hold_times
from plcgen.ppi.proof.stated.values import hold_values
from plcgen.proof.checks import Check, Outcome
from plcgen.proof.scenario import ScenarioError
from plcgen.s7.cpu.program import Program


def stated_checks(plan: PpiPlan, program: Program) -> Iterator[Check]:
    """Every master of the spec: what the files do against what it demands."""
    for master in plan.masters:
        problem = _problem(plan, program, master)
        text = f"{quantity(len(master.jobs), 'job')}: what is on the line, start values, outputs, times"
        name, subject = f"spec.ppi.{master.key}", f"spec {master.key}"
        if problem is None:
            yield Check(name, subject, text, Outcome.OK, "as the spec says, read a second time")
        else:
            yield Check(name, subject, text, Outcome.ERROR, problem.message, problem)


def _problem(plan: PpiPlan, program: Program, master: PlannedMaster) -> Diagnostic | None:
    place = plan.loaded.key_span(master.path)
    try:
        port = ports_of(plan.loaded)
        for check in (hold_values, hold_times):
            check(StatedBed(plan, program, master, port))
    except DiagnosticError as problem:
        return problem.diagnostics[0]
    except (NotStatedError, ScenarioError) as problem:
        return Diagnostic("PG641", f"{master.key}: {problem}", place, help=PAGE)
    except Exception as problem:  # noqa: BLE001 - changed sources may make the simulated CPU itself fail
        message = f"{master.key}: the simulated CPU stopped: {type(problem).__name__} {problem}"
        return Diagnostic("PG641", message, place, help=PAGE)
    return None
