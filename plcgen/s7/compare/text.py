"""A comparison as text for people and as plain data."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import TYPE_CHECKING, Any

from plcgen.base.display.cells import clean, pad, wrap
from plcgen.base.display.data import diagnostic_data, head, span_data
from plcgen.base.display.view import View
from plcgen.s7.compare.model import Change, Comparison
from plcgen.s7.compare.policy import Level

if TYPE_CHECKING:
    from plcgen.s7.compare.model import Change, Comparison, Sentence


def comparison_data(comparison: Comparison, fail_on: str) -> dict[str, Any]:
    """Every change with its places and details."""
    ok = comparison.readable and not comparison.failing(fail_on)
    return {
        **head("comparison", ok=ok),
        "old": comparison.old,
        "new": comparison.new,
        "fail_on": fail_on,
        "summary": {level.value: comparison.count(level) for level in Level},
        "sentences": [
            {
                "job": one.job,
                "level": one.level.value,
                "text": one.text,
                "partners": list(one.partners),
                "place": span_data(one.span) if one.span else None,
            }
            for one in comparison.sentences
        ],
        "changes": [_data(change) for change in comparison.changes],
        "diagnostics": [diagnostic_data(d) for d in comparison.diagnostics],
    }


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


_STYLE = {"breaking": "error", "compatible": "warning", "documentation": "dim"}
_MARGIN = 2 + 13 + 2 + 18 + 2
_ROW = 4
"""So many changes of one kind in one block are shown; --verbose shows the rest."""


def comparison_text(comparison: Comparison, view: View) -> str:
    """Sentences by job, then changes by block, job and drive, the worst first.

    ``verbose`` lists every moved member and changed line, and what is inside of blocks.
    """
    lines = [line for one in comparison.sentences for line in _sentence(one, view)]
    lines += [""] if lines else []
    for subject, changes in comparison.folded(everything=view.verbose):
        lines += [view.paint(clean(subject), "bold")]
        for change, hidden in shortened(changes, view):
            lines += _change(change, view)
            if hidden:
                lines.append(f"{' ' * _MARGIN}.. and {hidden} more {change.kind} (--verbose)")
        lines.append("")
    if comparison.inside and not view.verbose:
        lines += [*wrap(f"inside of {', '.join(sorted(comparison.inside))}: --verbose", view.width), ""]
    return "\n".join([*lines, _summary(comparison, view)]) + "\n"


def _sentence(one: Sentence, view: View) -> list[str]:
    label = one.level.value
    first, *more = wrap(clean(f"{one.who}: {one.text}"), max(view.width - 15, 40))
    return [f"{view.paint(pad(label, 13), _STYLE[label])}  {first}", *(" " * 15 + line for line in more)]


def shortened(changes: Sequence[Change], view: View) -> Iterator[tuple[Change, int]]:
    """The changes to show; behind the last one of a long row of one kind, how many of it are left out."""
    for kind, group in groupby(changes, key=lambda change: (change.level, change.kind)):
        row = list(group)
        shown = row if view.verbose or len(row) <= _ROW + 1 or kind[1] == "member-moved" else row[:_ROW]
        for number, change in enumerate(shown, 1):
            yield change, len(row) - len(shown) if number == len(shown) else 0


def _change(change: Change, view: View) -> list[str]:
    label = change.level.value
    head_ = f"  {view.paint(pad(label, 13), _STYLE[label])}  {pad(change.kind, 18)}  "
    first, *more = wrap(clean(change.text), max(view.width - _MARGIN, 40))
    lines = [head_ + first, *(" " * _MARGIN + line for line in more)]
    if view.verbose:
        lines += [f"{' ' * _MARGIN}  {clean(detail)}" for detail in change.details]
    if view.verbose and change.span is not None:
        lines.append(f"{' ' * _MARGIN}  {view.paint(f'at {clean(str(change.span))}', 'dim')}")
    return lines


def _summary(comparison: Comparison, view: View) -> str:
    """``2 breaking, 1 compatible, 3 documentation; 2 at or above breaking``."""
    if not comparison.changes:
        return view.paint("no semantic differences", "ok")
    failing = comparison.failing(view.fail_on)
    verdict = f"fails: --fail-on {view.fail_on}" if failing else f"passes: --fail-on {view.fail_on}"
    return f"{comparison.counts}; {view.paint(verdict, 'error' if failing else 'ok')}"


def changes_table() -> list[tuple[str, str, str, str]]:
    """Every kind of change: id, default class, what, why."""
    from plcgen.s7.compare.policy import KINDS

    return [(kind.id, kind.level.value, kind.title, kind.why) for kind in KINDS.values()]
