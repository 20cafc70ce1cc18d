"""A comparison as text, Markdown for a pull request, JSON and SARIF."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import TYPE_CHECKING, Any

from plcgen._version import __version__
from plcgen.output.cells import clean, pad, wrap
from plcgen.output.json import diagnostic_data, dump, head, span_data
from plcgen.output.paint import paint
from plcgen.output.text import DEFAULT_WIDTH

if TYPE_CHECKING:
    from plcgen.review.compare.model import Change, Comparison

_STYLE = {"breaking": "error", "compatible": "warning", "documentation": "dim"}
_MARK = {"breaking": ":red_circle:", "compatible": ":yellow_circle:", "documentation": ":white_circle:"}
_LEVEL = {"breaking": "error", "compatible": "warning", "documentation": "note"}
_MARGIN = 2 + 13 + 2 + 18 + 2
_MANY = 12
_ROW = 4
"""So many changes of one kind in one block are shown; --verbose shows the rest."""


def comparison_text(
    comparison: Comparison, fail_on: str, *, verbose: bool = False, color: bool = False, width: int = DEFAULT_WIDTH
) -> str:
    """Changes by block, job and drive, the worst first; ``verbose`` lists every moved member and changed line."""
    lines: list[str] = []
    for subject, changes in comparison.subjects():
        lines += [paint(clean(subject), "bold", color=color)]
        for change, hidden in _shortened(changes, verbose=verbose):
            lines += _change(change, verbose=verbose, color=color, width=width)
            if hidden:
                lines.append(f"{' ' * _MARGIN}.. and {hidden} more {change.kind} (--verbose)")
        lines.append("")
    return "\n".join([*lines, summary(comparison, fail_on, color=color)]) + "\n"


def _shortened(changes: Sequence[Change], *, verbose: bool) -> Iterator[tuple[Change, int]]:
    """The changes to show; behind the last one of a long row of one kind, how many of it are left out."""
    for kind, group in groupby(changes, key=lambda change: (change.level, change.kind)):
        row = list(group)
        shown = row if verbose or len(row) <= _ROW + 1 or kind[1] == "member-moved" else row[:_ROW]
        for number, change in enumerate(shown, 1):
            yield change, len(row) - len(shown) if number == len(shown) else 0


def _change(change: Change, *, verbose: bool, color: bool, width: int) -> list[str]:
    label = change.level.value
    head_ = f"  {paint(pad(label, 13), _STYLE[label], color=color)}  {pad(change.kind, 18)}  "
    first, *more = wrap(clean(_what(change)), max(width - _MARGIN, 40))
    lines = [head_ + first, *(" " * _MARGIN + line for line in more)]
    if verbose:
        lines += [f"{' ' * _MARGIN}  {clean(detail)}" for detail in change.details]
    if verbose and change.span is not None:
        lines.append(f"{' ' * _MARGIN}  {paint(f'at {clean(str(change.span))}', 'dim', color=color)}")
    return lines


def _what(change: Change) -> str:
    """The message, with the member in front where it does not name it."""
    named = change.kind in {"member-added", "member-removed", "member-renamed", "member-spelling", "parameter-required"}
    if not change.path or named or (change.kind == "member-moved" and change.details):
        return change.message
    return f"{change.path}: {change.message}"


def summary(comparison: Comparison, fail_on: str, *, color: bool = False) -> str:
    """``2 breaking, 1 compatible, 3 documentation; 2 at or above breaking``."""
    from plcgen.review.compare.policy import Level

    if not comparison.changes:
        return paint("no semantic differences", "ok", color=color)
    counts = [f"{comparison.count(level)} {level.value}" for level in Level if comparison.count(level)]
    failing = comparison.failing(fail_on)
    verdict = f"fails: --fail-on {fail_on}" if failing else f"passes: --fail-on {fail_on}"
    return f"{', '.join(counts)}; {paint(verdict, 'error' if failing else 'ok', color=color)}"


def comparison_markdown(comparison: Comparison, fail_on: str, *, verbose: bool = False) -> str:
    """Write a comment for a pull request: the verdict, one table, the long lists folded away."""
    lines = ["### Changes of PLC blocks", "", _verdict(comparison, fail_on), ""]
    if not comparison.changes:
        return "\n".join(lines[:-1]) + "\n"
    lines += ["| | where | what | id |", "|---|---|---|---|"]
    for subject, changes in comparison.subjects():
        for number, (change, hidden) in enumerate(_shortened(changes, verbose=verbose)):
            where = f"**{_escape(subject)}**" if number == 0 else ""
            mark = f"{_MARK[change.level.value]} {change.level.value}"
            lines.append(f"| {mark} | {where} | {_escape(_what(change))} | `{change.kind}` |")
            if hidden:
                lines.append(f"| | | .. and {hidden} more | `{change.kind}` |")
    long = [change for change in comparison.changes if change.details]
    for change in long:
        lines += ["", *_folded(change, verbose=verbose)]
    return "\n".join(lines) + "\n"


def _folded(change: Change, *, verbose: bool) -> list[str]:
    shown = change.details if verbose else change.details[:_MANY]
    rest = len(change.details) - len(shown)
    body = [*(clean(detail) for detail in shown), *([f".. and {rest} more"] if rest else [])]
    title = f"{_html(change.subject)}: {len(change.details)} {_count_word(change)}"
    fence = "````" if any("```" in line for line in body) else "```"
    return [f"<details><summary>{title}</summary>", "", f"{fence}text", *body, fence, "", "</details>"]


def _count_word(change: Change) -> str:
    return {"member-moved": "moved members", "code-changed": "changed places"}.get(change.kind, "items")


def _verdict(comparison: Comparison, fail_on: str) -> str:
    from plcgen.review.compare.policy import Level

    if not comparison.changes:
        return "No semantic differences."
    counts = [f"{comparison.count(level)} {level.value}" for level in Level if comparison.count(level)]
    failing = comparison.failing(fail_on)
    result = "**Fails**" if failing else "Passes"
    sides = f"`{clean(comparison.old)}` against `{clean(comparison.new)}`"
    return f"{result} (`--fail-on {fail_on}`): {', '.join(counts)}. {sides}."


def _html(text: str) -> str:
    return clean(text).replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")


def _escape(text: str) -> str:
    safe = _html(text).replace("\\", "\\\\").replace("|", "\\|")
    for mark in "*_`[]":
        safe = safe.replace(mark, f"\\{mark}")
    return safe


def comparison_json(comparison: Comparison, fail_on: str) -> str:
    """Every change with its places and details."""
    from plcgen.review.compare.policy import Level

    ok = comparison.readable and not comparison.failing(fail_on)
    return dump(
        {
            **head("comparison", ok=ok),
            "old": comparison.old,
            "new": comparison.new,
            "fail_on": fail_on,
            "summary": {level.value: comparison.count(level) for level in Level},
            "changes": [_data(change) for change in comparison.changes],
            "diagnostics": [diagnostic_data(d) for d in comparison.diagnostics],
        }
    )


def _data(change: Change) -> dict[str, Any]:
    return {
        "id": change.kind,
        "level": change.level.value,
        "subject": change.subject,
        "path": change.path,
        "message": change.message,
        "old": change.old,
        "new": change.new,
        "old_place": span_data(change.old_span) if change.old_span else None,
        "new_place": span_data(change.new_span) if change.new_span else None,
        "details": list(change.details),
    }


def comparison_sarif(comparison: Comparison, fail_on: str) -> str:
    """SARIF 2.1.0: one rule per kind of change, a fingerprint that stays when lines move."""
    from plcgen.output.sarif import SCHEMA, location, problem_results
    from plcgen.review.compare.policy import KINDS

    used = [kind for kind in KINDS.values() if any(change.kind == kind.id for change in comparison.changes)]
    index = {kind.id: number for number, kind in enumerate(used)}
    rules = [
        {
            "id": kind.id,
            "shortDescription": {"text": kind.title[0].upper() + kind.title[1:]},
            "fullDescription": {"text": f"{kind.why[0].upper()}{kind.why[1:]}."},
            "defaultConfiguration": {"level": _LEVEL[kind.level.value]},
        }
        for kind in used
    ]
    results = [_result(change, index, location) for change in comparison.changes]
    more_rules, problems = problem_results(comparison.diagnostics, len(rules))
    driver = {"name": "plcgen", "version": __version__, "semanticVersion": __version__, "rules": [*rules, *more_rules]}
    run = {
        "tool": {"driver": driver},
        "columnKind": "unicodeCodePoints",
        "properties": {"failOn": fail_on},
        "results": [*results, *problems],
    }
    return dump({"$schema": SCHEMA, "version": "2.1.0", "runs": [run]})


def _result(change: Change, index: dict[str, int], location: Any) -> dict[str, Any]:
    result: dict[str, Any] = {
        "ruleId": change.kind,
        "ruleIndex": index[change.kind],
        "level": _LEVEL[change.level.value],
        "message": {"text": f"{change.subject}: {_what(change)}"},
        "partialFingerprints": {"plcgenChange/v1": f"{change.kind}:{change.subject}:{change.path}"},
    }
    if change.span is not None:
        result["locations"] = [location(change.span)]
    if change.old_span is not None and change.old_span != change.span:
        result["relatedLocations"] = [{"id": 1, **location(change.old_span, "before")}]
    return result


def changes_table() -> list[tuple[str, str, str, str]]:
    """Every kind of change: id, default class, what, why."""
    from plcgen.review.compare.policy import KINDS

    return [(kind.id, kind.level.value, kind.title, kind.why) for kind in KINDS.values()]
