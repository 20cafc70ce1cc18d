"""What an audit of a protocol returns: what it looked at, and what is wrong."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from plcgen.diagnostics import Diagnostic, Severity
from plcgen.proof.checks import Check, CheckGroup, Outcome


@dataclass(frozen=True, slots=True)
class Audited:
    """What a protocol found: what it looked at, and everything that is wrong."""

    groups: tuple[CheckGroup, ...] = ()
    diagnostics: tuple[Diagnostic, ...] = ()


def audited(
    id_: str, subject: str, text: str, findings: Sequence[Diagnostic], notes: Sequence[str], good: str
) -> Check:
    """Return the check of one thing that was looked at; ``good`` is its verdict if nothing was found."""
    errors = [d for d in findings if d.severity is Severity.ERROR]
    if findings:
        first = (errors or list(findings))[0]
        more = f" (+{len(findings) - 1} more)" if len(findings) > 1 else ""
        outcome = Outcome.ERROR if errors else Outcome.WARNING
        return Check(id_, subject, text, outcome, f"{first.message}{more}", first)
    return Check(id_, subject, text, Outcome.OK, "; ".join([good, *notes]))
