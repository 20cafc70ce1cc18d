"""Spec -> frozen project. What cannot be resolved is a diagnostic; the rest is planned all the same."""

from __future__ import annotations

from typing import TYPE_CHECKING

from plcgen.base.diagnostics import Diagnostic, Report
from plcgen.base.diagnostics.suggest import did_you_mean
from plcgen.project.loading import used_protocols
from plcgen.project.nouns import Project
from plcgen.project.numbering import Numbering
from plcgen.project.spec import LoadedSpec
from plcgen.project.target import combination_problem, target

if TYPE_CHECKING:
    from plcgen.project.cpus import CpuType


def resolve(loaded: LoadedSpec, report: Report) -> Project:
    """Plan a whole spec, protocol by protocol."""
    plc = loaded.spec.plc
    used = used_protocols(loaded.root)
    problem = combination_problem(plc.family, plc.toolchain)
    if problem:
        report.add(Diagnostic("PG214", problem, loaded.span(("plc", "toolchain")), help="use a tia-v.. toolchain"))
    where = target(plc.family, plc.toolchain, _cpu(loaded, report))
    first = {"FB": plc.numbers.fb, "DB": plc.numbers.db, "UDT": plc.numbers.udt}
    pinned = [number for protocol in used for number in protocol.pinned(loaded)]
    numbering = Numbering(where, first, pinned, plc.prefix)
    plans = tuple(protocol.plan(loaded, numbering, report) for protocol in used)
    return Project(loaded, plc.name, where, plc.languages, plans)


def _cpu(loaded: LoadedSpec, report: Report) -> CpuType | None:
    """The CPU type that a spec names; None after a diagnostic if it makes no sense."""
    plc = loaded.spec.plc
    if plc.cpu is None:
        return None
    from plcgen.project.cpus import cpu_names, find_cpu

    place = loaded.span(("plc", "cpu"))
    found = find_cpu(plc.cpu)
    if found is None:
        known = cpu_names(plc.family)
        hint = f"{did_you_mean(plc.cpu, known)} known: {', '.join(known)}; or leave cpu out".strip()
        report.add(Diagnostic("PG409", f'unknown CPU type "{plc.cpu}"', place, help=hint))
    elif found.family != plc.family:
        message = f"a CPU {found.name} is an {found.family.upper()}, but the family is {plc.family}"
        report.add(Diagnostic("PG410", message, place, help=f"write family: {found.family}, or another CPU type"))
        return None
    return found
