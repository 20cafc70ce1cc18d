"""What an audit of a protocol returns: what it looked at, and what is wrong."""

from __future__ import annotations

from dataclasses import dataclass, field

from plcgen.base.diagnostics import Diagnostic, Note, Severity, Span
from plcgen.proof.checks import Check, CheckGroup, Outcome


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
