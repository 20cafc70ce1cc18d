"""Audits: sources of anyone and a spec in, checks out, in the shape of a verification, which reports can show.

Every protocol of the spec says what it finds in the sources; nothing here knows one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Note, Report, Severity, Span
from plcgen.base.diagnostics.counting import shortlist
from plcgen.project.composing import from_disk
from plcgen.project.includes import Read
from plcgen.proof.checks import Check, CheckGroup, Outcome, Verification


@dataclass(frozen=True, slots=True)
class Audited:
    """What a protocol found: what it looked at, and everything that is wrong."""

    groups: tuple[CheckGroup, ...] = ()
    diagnostics: tuple[Diagnostic, ...] = ()


@dataclass(slots=True)
class AuditFindings:
    """What is wrong with one thing that was looked at, and what was not looked at."""

    found: list[Diagnostic] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def report(
        self, code: str, message: str, span: Span, help_: str, *, notes: tuple[Note, ...] = (),
        severity: Severity = Severity.ERROR,
    ) -> None:  # fmt: skip
        """Add one finding."""
        self.found.append(Diagnostic(code, message, span, severity, help=help_, notes=notes))


def audited(id_: str, subject: str, text: str, findings: AuditFindings, good: str) -> Check:
    """Return the check of one thing that was looked at; ``good`` is its verdict if nothing was found."""
    found = findings.found
    errors = [d for d in found if d.severity is Severity.ERROR]
    if found:
        first = (errors or found)[0]
        more = f" (+{len(found) - 1} more)" if len(found) > 1 else ""
        outcome = Outcome.ERROR if errors else Outcome.WARNING
        return Check(id_, subject, text, outcome, f"{first.message}{more}", first)
    return Check(id_, subject, text, Outcome.OK, "; ".join([good, *findings.notes]))


def audit_files(paths: Sequence[Path], spec: Path, read: Read = from_disk) -> Verification:
    """Hold sources against the plan of a spec, whose text ``read`` gives; every finding is a diagnostic."""
    label = shortlist([path.as_posix() for path in paths], 3, f" (+{len(paths) - 3})")
    report = Report()
    try:
        return _audit(paths, spec, label, report, read)
    except DiagnosticError as problem:
        report.extend(problem.diagnostics)
    return Verification(str(spec), label, "", "", (), tuple(report), "audit")


def _audit(paths: Sequence[Path], spec: Path, label: str, report: Report, read: Read) -> Verification:
    from plcgen.project.opening import open_spec
    from plcgen.s7.read.blocks import read_sources

    opened = open_spec(spec, read)
    project = opened.sound()
    report.extend(opened.diagnostics)
    target = f"{project.target.family} / {project.target.toolchain}"
    sources = read_sources(paths, classic=project.target.classic)
    report.extend(sources.diagnostics)
    found = [plan.protocol.audit(plan, sources) for plan in project.plans]
    report.extend(dict.fromkeys(problem for one in found for problem in one.diagnostics))
    groups = tuple(group for one in found for group in one.groups)
    return Verification(str(spec), label, project.name, target, groups, tuple(report), "audit")
