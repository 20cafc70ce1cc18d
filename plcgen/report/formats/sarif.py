"""Results as SARIF 2.1.0 (OASIS standard): rules from the code table, places in characters.

What GitHub asks of a file for code scanning is there, too (docs.github.com, "SARIF support for code scanning"): every
rule has its texts and help, every result a place with a whole region, every fingerprint is of one result.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from plcgen._version import __version__
from plcgen.base.diagnostics import Diagnostic, Severity, Span
from plcgen.base.diagnostics.codes import code as code_info
from plcgen.base.display.data import dump
from plcgen.report.registry import OutputFormat

if TYPE_CHECKING:
    from plcgen.base.display.results import Findings
    from plcgen.base.display.view import View
    from plcgen.proof.checks import Check, Verification
    from plcgen.s7.compare.model import Change, Comparison

SCHEMA = "https://json.schemastore.org/sarif-2.1.0.json"
_LEVEL = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.NOTE: "note"}
_CHANGE = {"breaking": "error", "compatible": "warning", "documentation": "note"}
_UNRESERVED = frozenset(b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~/")


def uri(path: str) -> str:
    """Turn a file path of any system into a URI reference (RFC 3986)."""
    path = path.replace("\\", "/")
    drive = len(path) > 1 and path[1] == ":" and path[0].isalpha()
    data = path.encode("utf-8", "surrogateescape")
    quoted = "".join(chr(byte) if byte in _UNRESERVED else f"%{byte:02X}" for byte in data)
    if drive:
        return f"file:///{path[0]}:{quoted[4:]}"
    return f"file://{quoted}" if path.startswith("/") else quoted


def location(span: Span, message: str = "") -> dict[str, Any]:
    """A SARIF location object; ``message`` says what the place has to do with the result."""
    line, column = max(span.line, 1), max(span.column, 1)
    end = (span.end_line, max(span.end_column, 1)) if span.line and span.end_line else (line, column)
    region = {"startLine": line, "startColumn": column, "endLine": end[0], "endColumn": end[1]}
    found: dict[str, Any] = {"physicalLocation": {"artifactLocation": {"uri": uri(span.file)}, "region": region}}
    if message:
        found["message"] = {"text": message}
    return found


def _texts(id_: str, title: str, why: str, fix: str = "") -> dict[str, Any]:
    return {
        "id": id_,
        "shortDescription": {"text": title},
        "fullDescription": {"text": why},
        "help": {"text": f"{why}\n\n{fix}".strip()},
    }


def _rule(code: str) -> dict[str, Any]:
    try:
        info = code_info(code)
    except KeyError:
        return _texts(code, code, "A check of plcgen.")
    return {
        **_texts(code, info.title, info.why, info.fix),
        "defaultConfiguration": {"level": _LEVEL[Severity[info.severity.label.upper()]]},
    }


def _result(diagnostic: Diagnostic, index: dict[str, int], file: str) -> dict[str, Any]:
    text = f"{diagnostic.message}\nhelp: {diagnostic.help}" if diagnostic.help else diagnostic.message
    result: dict[str, Any] = {
        "ruleId": diagnostic.code,
        "ruleIndex": index[diagnostic.code],
        "level": _LEVEL[diagnostic.severity],
        "message": {"text": text},
    }
    result["locations"] = [location(diagnostic.span if diagnostic.span.file else Span(file))]
    if diagnostic.notes:
        notes = enumerate(diagnostic.notes, 1)
        result["relatedLocations"] = [{"id": n, **location(note.span, note.message)} for n, note in notes]
    return result


def _check(check: Check, spec: str, index: dict[str, int]) -> dict[str, Any]:
    return {
        "ruleId": check.id,
        "ruleIndex": index[check.id],
        "level": check.outcome.value,
        "message": {"text": f"{check.subject}: {check.verdict}"},
        "locations": [location(Span(spec))],
    }


def _problems(
    diagnostics: Sequence[Diagnostic], file: str, first: int = 0
) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """Rules and results of diagnostics, behind ``first`` rules of the run; ``file`` is for those without a place."""
    codes = sorted({d.code for d in diagnostics})
    index = {code: first + position for position, code in enumerate(codes)}
    return [_rule(code) for code in codes], [_result(d, index, file) for d in diagnostics]


def _log(rules: Sequence[dict[str, Any]], results: Sequence[dict[str, Any]], **properties: str) -> str:
    driver = {"name": "plcgen", "version": __version__, "semanticVersion": __version__, "rules": rules}
    run = {
        "tool": {"driver": driver},
        "columnKind": "unicodeCodePoints",
        **({"properties": properties} if properties else {}),
        "results": results,
    }
    return dump({"$schema": SCHEMA, "version": "2.1.0", "runs": [run]})


def _findings(found: Findings, _view: View) -> str:
    return _log(*_problems(list(dict.fromkeys(found.diagnostics)), found.subjects[0][0] if found.subjects else "."))


def _verification(verification: Verification, _view: View) -> str:
    return _verifications([verification], _view)


def _verifications(found: Sequence[Verification], _view: View) -> str:
    """The diagnostics, and failed checks that have none."""
    rules, results = _problems(
        list(dict.fromkeys(d for verification in found for d in verification.problems)), found[0].spec
    )
    bare = [
        (check, verification.spec)
        for verification in found
        for check in verification.checks()
        if check.diagnostic is None and check.outcome.value in {"error", "warning"}
    ]
    index = {id_: number for number, id_ in enumerate(dict.fromkeys(check.id for check, _ in bare), len(rules))}
    return _log([*rules, *map(_rule, index)], [*results, *(_check(check, spec, index) for check, spec in bare)])


def _comparison(comparison: Comparison, view: View) -> str:
    """One rule per kind of change, a fingerprint that stays when lines move."""
    from plcgen.s7.compare.policy import KINDS

    used = [kind for kind in KINDS.values() if any(change.kind == kind.id for change in comparison.changes)]
    index = {kind.id: number for number, kind in enumerate(used)}
    rules = [
        {
            **_texts(kind.id, kind.title[0].upper() + kind.title[1:], f"{kind.why[0].upper()}{kind.why[1:]}."),
            "defaultConfiguration": {"level": _CHANGE[kind.level.value]},
        }
        for kind in used
    ]
    file = comparison.new or comparison.old
    more, found = _problems(comparison.diagnostics, file, len(rules))
    seen = Counter[str]()
    changes = [_change(change, index, file, seen) for change in comparison.changes]
    return _log([*rules, *more], [*changes, *found], failOn=view.fail_on)


def _change(change: Change, index: dict[str, int], file: str, seen: Counter[str]) -> dict[str, Any]:
    """``seen`` counts the fingerprints: equal ones would be one alert."""
    fingerprint = f"{change.kind}:{change.subject}:{change.path}"
    seen[fingerprint] += 1
    fingerprint += f":{seen[fingerprint]}" if seen[fingerprint] > 1 else ""
    place = change.span or change.old_span or Span(file)
    result: dict[str, Any] = {
        "ruleId": change.kind,
        "ruleIndex": index[change.kind],
        "level": _CHANGE[change.level.value],
        "message": {"text": f"{change.subject}: {change.text}"},
        "partialFingerprints": {"plcgenChange/v1": fingerprint},
        "locations": [location(place)],
    }
    if change.old_span is not None and change.old_span != place:
        result["relatedLocations"] = [{"id": 1, **location(change.old_span, "before")}]
    return result


FORMAT = OutputFormat(
    name="sarif", findings=_findings, verification=_verification, verifications=_verifications, comparison=_comparison
)
