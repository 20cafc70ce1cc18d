"""A comparison as plain data."""

from __future__ import annotations

from typing import Any

from plcgen.base.display.data import diagnostic_data, head, span_data
from plcgen.s7.compare.model import Change, Comparison
from plcgen.s7.compare.policy import Level


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
