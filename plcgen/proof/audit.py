"""``audit_files``: sources of anyone and a spec in, checks out, in the shape of a verification, which reports can show.

Every protocol of the spec says what it finds in the sources; nothing here knows one.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from plcgen.base.diagnostics import DiagnosticError, Report
from plcgen.base.diagnostics.counting import shortlist
from plcgen.proof.checks import Verification


def audit_files(paths: Sequence[Path], spec: Path) -> Verification:
    """Hold sources against the plan of a spec; every finding is a diagnostic."""
    label = shortlist([path.as_posix() for path in paths], 3, f" (+{len(paths) - 3})")
    report = Report()
    try:
        return _audit(paths, spec, label, report)
    except DiagnosticError as problem:
        report.extend(problem.diagnostics)
    return Verification(str(spec), label, "", "", (), tuple(report), "audit")


def _audit(paths: Sequence[Path], spec: Path, label: str, report: Report) -> Verification:
    from plcgen.project.opening import open_spec
    from plcgen.s7.read.blocks import read_sources

    opened = open_spec(spec)
    project = opened.sound()
    report.extend(opened.diagnostics)
    target = f"{project.target.family} / {project.target.toolchain}"
    sources = read_sources(paths, classic=project.target.classic)
    report.extend(sources.diagnostics)
    found = [plan.protocol.audit(plan, sources) for plan in project.plans]
    report.extend(dict.fromkeys(problem for one in found for problem in one.diagnostics))
    groups = tuple(group for one in found for group in one.groups)
    return Verification(str(spec), label, project.name, target, groups, tuple(report), "audit")
