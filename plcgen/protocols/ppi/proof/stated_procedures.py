"""The procedures that hold a master against the statement of its spec."""

from __future__ import annotations

from collections.abc import Iterator

from plcgen.cpu.program import Program
from plcgen.diagnostics.counting import quantity
from plcgen.proof.checks import Check, Outcome
from plcgen.proof.suite import Procedure
from plcgen.protocols.ppi.plan.nouns import PlannedMaster, PpiPlan
from plcgen.protocols.ppi.proof.stated import StatedBed
from plcgen.protocols.ppi.proof.stated_times import times
from plcgen.protocols.ppi.proof.stated_values import values


def stated_procedures(plan: PpiPlan, program: Program, master: PlannedMaster) -> Iterator[Procedure]:
    """Values and times of a master."""

    def bed() -> StatedBed:
        return StatedBed(plan, program, master)

    text = f"{quantity(len(master.jobs), 'job')}: what is on the line, start values, outputs, times"
    check = Check(f"spec.{master.key}", f"spec {master.key}", text, Outcome.OK, "as the spec says, read a second time")
    yield Procedure("values on the line", bed, values, check=check)
    yield Procedure("times on the line", bed, times, check=check)
