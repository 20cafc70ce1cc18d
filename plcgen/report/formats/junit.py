"""Results as JUnit XML: one test case per check, with a name that stays the same from run to run."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

from plcgen.base.diagnostics import Diagnostic, Severity
from plcgen.report.registry import OutputFormat

if TYPE_CHECKING:
    from plcgen.base.display.results import Findings
    from plcgen.base.display.view import View
    from plcgen.proof.checks import Check, CheckGroup, Verification
    from plcgen.s7.compare.model import Comparison

_ILLEGAL = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_ESCAPES = {"&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;"}
_LINES = {"\t": "&#9;", "\n": "&#10;", "\r": "&#13;"}


def _text(text: str) -> str:
    """Escape text; characters that XML 1.0 cannot hold become U+FFFD."""
    return re.sub(r'[&<>"]', lambda m: _ESCAPES[m[0]], _ILLEGAL.sub("\ufffd", text))


def _attribute(text: str) -> str:
    return re.sub(r"[\t\n\r]", lambda m: _LINES[m[0]], _text(text))


def _details(diagnostics: Sequence[Diagnostic]) -> str:
    out = []
    for d in diagnostics:
        out.append(f"{d.span}: {d.severity.label}[{d.code}]: {d.message}")
        out += [f"{note.span}: {note.message}" for note in d.notes]
        if d.help:
            out.append(f"help: {d.help}")
    return "\n".join(out)


def _case(classname: str, name: str, body: str = "") -> str:
    start = f'    <testcase classname="{_attribute(classname)}" name="{_attribute(name)}"'
    return f"{start}>{body}</testcase>\n" if body else f"{start}/>\n"


def _failure(kind: str, message: str, details: str) -> str:
    return f'<failure type="{_attribute(kind)}" message="{_attribute(message)}">{_text(details)}</failure>'


def _suite(name: str, cases: Sequence[str]) -> str:
    failures = sum("<failure " in case for case in cases)
    skipped = sum("<skipped " in case for case in cases)
    counts = f'tests="{len(cases)}" failures="{failures}" errors="0" skipped="{skipped}"'
    return f'  <testsuite name="{_attribute(name)}" {counts}>\n{"".join(cases)}  </testsuite>\n'


def _document(name: str, suites: Sequence[str]) -> str:
    body = "".join(suites)
    tests, failures = body.count("<testcase "), body.count("<failure ")
    head = f'<testsuites name="{_attribute(name)}" tests="{tests}" failures="{failures}" errors="0">'
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{head}\n{body}</testsuites>\n'


def _told(diagnostics: Sequence[Diagnostic]) -> str:
    """What stands in a test case: a failure if there is an error, what else there is as output; empty if nothing."""
    first = next((d for d in diagnostics if d.severity is Severity.ERROR), None)
    if first is not None:
        return _failure(first.code, first.message, _details(diagnostics))
    return f"<system-out>{_text(_details(diagnostics))}</system-out>" if diagnostics else ""


def _findings(found: Findings, _view: View) -> str:
    """One test case per subject; warnings alone do not fail it."""
    cases = [_case(f"plcgen.{found.verb}", subject, _told(diagnostics)) for subject, diagnostics in found.subjects]
    return _document(f"plcgen {found.verb}", [_suite(found.verb, cases)])


def _verification(verification: Verification, _view: View) -> str:
    """One suite per group; a last suite holds what belongs to no check."""
    return _document(f"plcgen {verification.verb} {verification.spec}", _suites(verification))


def _verifications(found: Sequence[Verification], _view: View) -> str:
    """The suites of every spec, with its path in their names."""
    return _document("plcgen verify", [suite for each in found for suite in _suites(each, each.spec)])


def _suites(verification: Verification, spec: str = "") -> list[str]:
    """``spec`` tells the checks of one spec from the same ones of another."""
    verb, before = f"{verification.verb}.{spec}" if spec else verification.verb, f"{spec}: " if spec else ""
    suites = [_group(group, verb, before) for group in verification.groups]
    if verification.outside:
        suites.append(_suite(f"{before}problems", [_case(f"plcgen.{verb}", "problems", _told(verification.outside))]))
    return suites


def _comparison(comparison: Comparison, view: View) -> str:
    """One test case for each block, job or drive that changed; it fails if a change fails the run (``--fail-on``)."""
    from plcgen.s7.compare.policy import fails

    cases = []
    for subject, changes in comparison.subjects():
        lines = [f"{change.level.value} {change.kind}: {change.text}" for change in changes]
        if fails(changes[0].level, view.fail_on):
            body = _failure(changes[0].kind, changes[0].text, "\n".join(lines))
        else:
            body = f"<system-out>{_text(chr(10).join(lines))}</system-out>"
        cases.append(_case("plcgen.diff", subject, body))
    if comparison.diagnostics:
        cases.append(_case("plcgen.diff", "problems", _told(comparison.diagnostics)))
    if not cases:
        cases.append(_case("plcgen.diff", "nothing changed"))
    return _document(f"plcgen diff {comparison.old} {comparison.new}", [_suite("changes", cases)])


def _group(group: CheckGroup, verb: str, before: str) -> str:
    seen: dict[str, int] = {}
    cases = []
    for check in group.checks:
        seen[check.id] = seen.get(check.id, 0) + 1
        name = check.id if seen[check.id] == 1 else f"{check.id} ({seen[check.id]})"
        cases.append(_case(f"plcgen.{verb}.{group.name}", name, _body(check)))
    return _suite(f"{before}{group.name}", cases)


def _body(check: Check) -> str:
    line = f"{check.subject}: {check.text}" if check.text else check.subject
    if check.outcome.value == "not run":
        return f'<skipped message="{_attribute(check.verdict)}"/>'
    if check.outcome.value == "error":
        found = check.diagnostic
        kind = found.code if found else check.id
        details = f"{line}\n{_details([found])}" if found else line
        return _failure(kind, check.verdict, details)
    if check.outcome.value == "warning":
        return f"<system-out>{_text(f'{line}: {check.verdict}')}</system-out>"
    return ""


FORMAT = OutputFormat(
    name="junit",
    comment=("<!-- ", " -->"),
    findings=_findings,
    verification=_verification,
    verifications=_verifications,
    comparison=_comparison,
)
