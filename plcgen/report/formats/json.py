"""JSON for programs: the data of every result in the house style, no time stamps."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from plcgen.base.display.data import diagnostics_data, dump, head
from plcgen.proof.data import verification_data
from plcgen.report.registry import OutputFormat

if TYPE_CHECKING:
    from plcgen.base.display.results import Answer, Findings
    from plcgen.base.display.view import View
    from plcgen.proof.checks import Verification
    from plcgen.report.review.model import Review
    from plcgen.report.trace.model import Trace
    from plcgen.s7.compare.model import Comparison
    from plcgen.s7.tables.tables import LayoutResult


def _findings(found: Findings, _view: View) -> str:
    return dump({**diagnostics_data(found.verb, found.diagnostics), **found.more})


def _verification(verification: Verification, _view: View) -> str:
    return dump(verification_data(verification))


def _verifications(found: Sequence[Verification], _view: View) -> str:
    parts = [verification_data(each) for each in found]
    return dump({**head("verifications", ok=all(each.ok for each in found)), "verifications": parts})


def _layout(result: LayoutResult, _view: View) -> str:
    from plcgen.s7.tables.tables import layout_data

    return dump(layout_data(result))


def _comparison(comparison: Comparison, view: View) -> str:
    from plcgen.s7.compare.text import comparison_data

    return dump(comparison_data(comparison, view.fail_on))


def _trace(trace: Trace, _view: View) -> str:
    from plcgen.report.trace.data import trace_data

    return dump(trace_data(trace))


def _review(review: Review, _view: View) -> str:
    from plcgen.report.review.data import review_data

    return dump(review_data(review))


def _answer(answer: Answer, _view: View) -> str:
    return dump(answer.data)


FORMAT = OutputFormat(
    name="json",
    findings=_findings,
    verification=_verification,
    verifications=_verifications,
    layout=_layout,
    comparison=_comparison,
    trace=_trace,
    review=_review,
    answer=_answer,
)
