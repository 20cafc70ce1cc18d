"""Spec -> frozen project. What cannot be resolved is a diagnostic; the rest is planned all the same."""

from __future__ import annotations

from plcgen.diagnostics import Diagnostic, Report
from plcgen.project.loading import used_protocols
from plcgen.project.nouns import Project
from plcgen.project.numbering import Numbering
from plcgen.project.spec import LoadedSpec
from plcgen.project.target import combination_problem, target


def resolve(loaded: LoadedSpec, report: Report) -> Project:
    """Plan a whole spec, protocol by protocol."""
    plc = loaded.spec.plc
    used = used_protocols(loaded.root)
    problem = combination_problem(plc.family, plc.toolchain)
    if problem:
        report.add(Diagnostic("PG214", problem, loaded.span(("plc", "toolchain")), help="use a tia-v.. toolchain"))
    where = target(plc.family, plc.toolchain)
    first = {"FB": plc.numbers.fb, "DB": plc.numbers.db, "UDT": plc.numbers.udt}
    pinned = [number for protocol in used for number in protocol.pinned(loaded)]
    numbering = Numbering(where, first, pinned)
    plans = tuple(protocol.plan(loaded, numbering, report) for protocol in used)
    return Project(loaded, plc.name, where, plc.languages, plans)
