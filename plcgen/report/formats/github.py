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
    """A change that fails the run (``--fail-on``) is an error, other breaking ones a warning, the rest notices."""
    return "".join(
        [_changed(change, view.fail_on) for change in comparison.changes]
        + [annotation(diagnostic) for diagnostic in comparison.diagnostics]
    )


def _changed(change: Change, fail_on: str) -> str:
    from plcgen.s7.compare.policy import fails

    command = "error" if fails(change.level, fail_on) else _CHANGE[change.level.value]
    text = "\n".join([f"{change.level.value}: {change.subject}: {change.text}", *change.details])
    return _command(command, change.span or Span(""), change.kind, text)


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
