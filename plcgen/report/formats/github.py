"""Results as GitHub workflow commands: annotations on the lines of a pull request."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from plcgen.base.diagnostics import Diagnostic, Severity, Span
from plcgen.report.registry import OutputFormat

if TYPE_CHECKING:
    from plcgen.base.display.results import Findings
    from plcgen.base.display.view import View
    from plcgen.proof.checks import Verification
    from plcgen.s7.compare.model import Change, Comparison
    from plcgen.s7.compare.policy import Level

_CHANGE = {"breaking": "warning", "compatible": "notice", "documentation": "notice"}
_COMMAND = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.NOTE: "notice"}


def _message(text: str) -> str:
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _property(text: str) -> str:
    return _message(text).replace(":", "%3A").replace(",", "%2C")


def annotation(diagnostic: Diagnostic) -> str:
    """One workflow command, with its line end."""
    text = diagnostic.message
    if diagnostic.help:
        text += f"\nhelp: {diagnostic.help}"
    for note in diagnostic.notes:
        text += f"\n{note.span}: {note.message}"
    return _command(_COMMAND[diagnostic.severity], diagnostic.span, diagnostic.code, text)


def _command(command: str, span: Span, title: str, text: str) -> str:
    fields = [("file", span.file.replace("\\", "/"))] if span.file else []
    if span.line:
        fields.append(("line", str(span.line)))
        if span.end_line > span.line:
            fields.append(("endLine", str(span.end_line)))
        fields.append(("col", str(span.column)))
        if span.end_line == span.line and span.end_column > span.column:
            fields.append(("endColumn", str(span.end_column)))
    fields.append(("title", title))
    properties = ",".join(f"{name}={_property(value)}" for name, value in fields)
    return f"::{command} {properties}::{_message(text)}\n"


def _findings(found: Findings, _view: View) -> str:
    return "".join(map(annotation, found.diagnostics))


def _verification(verification: Verification, _view: View) -> str:
    """A failed check without a diagnostic is annotated at the spec."""
    text = "".join(map(annotation, verification.problems))
    for check in verification.checks():
        command = check.outcome.value
        if check.diagnostic is None and command in {"error", "warning"}:
            place = _property(verification.spec.replace("\\", "/"))
            message = _message(f"{check.subject}: {check.verdict}")
            text += f"::{command} file={place},title={_property(check.id)}::{message}\n"
    return text


def _comparison(comparison: Comparison, view: View) -> str:
    """A change that fails the run (``--fail-on``) is an error, other breaking ones a warning, the rest notices.

    Of two specs every job has one, and every drive and block that is not inside of the jobs.
    """
    told = [_told(one.level, one.who, one.text, one.span, "job", view) for one in comparison.sentences]
    jobs = {
        f"job {key}" for one in comparison.sentences for key in (one.job, *(f"{one.job}.{p}" for p in one.partners))
    }
    for subject, changes in comparison.subjects():
        if not comparison.sentences:
            told += [_changed(change, view) for change in changes]
        elif subject not in jobs | comparison.inside:
            first, more = changes[0], f" and {len(changes) - 1} more" if len(changes) > 1 else ""
            told.append(_told(first.level, subject, f"{first.text}{more}", first.span, first.kind, view))
    return "".join(told + [annotation(diagnostic) for diagnostic in comparison.diagnostics])


def _changed(change: Change, view: View) -> str:
    return _told(
        change.level, change.subject, "\n".join([change.text, *change.details]), change.span, change.kind, view
    )


def _told(level: Level, subject: str, text: str, span: Span | None, title: str, view: View) -> str:
    from plcgen.s7.compare.policy import fails

    command = "error" if fails(level, view.fail_on) else _CHANGE[level.value]
    return _command(command, span or Span(""), title, f"{level.value}: {subject}: {text}")


def _verifications(found: Sequence[Verification], view: View) -> str:
    return "".join(_verification(each, view) for each in found)


FORMAT = OutputFormat(
    name="github",
    comment=("# ", ""),
    findings=_findings,
    verification=_verification,
    verifications=_verifications,
    comparison=_comparison,
)
