"""Text for people: columns, colours, excerpts of sources. The large reports stand beside the results they show."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from plcgen.report.registry import OutputFormat

if TYPE_CHECKING:
    from plcgen.base.display.results import Answer, Findings
    from plcgen.base.display.view import View
    from plcgen.proof.checks import Verification
    from plcgen.report.trace.model import Trace
    from plcgen.s7.compare.model import Comparison
    from plcgen.s7.tables.tables import LayoutResult


def _findings(found: Findings, view: View) -> str:
    from plcgen.base.display.excerpts import diagnostics_text

    return diagnostics_text(found.diagnostics, view)


def _verification(verification: Verification, view: View) -> str:
    from plcgen.report.verification import verification_text

    return verification_text(verification, view)


def _verifications(found: Sequence[Verification], view: View) -> str:
    from plcgen.report.verification import verifications_text

    return verifications_text(found, view)


def _layout(result: LayoutResult, view: View) -> str:
    from plcgen.s7.tables.tables import layout_text

    return layout_text(result.blocks, view)


def _comparison(comparison: Comparison, view: View) -> str:
    from plcgen.s7.compare.text import comparison_text

    return comparison_text(comparison, view)


def _trace(trace: Trace, view: View) -> str:
    from plcgen.report.trace.text import trace_text

    return trace_text(trace, view)


def _answer(answer: Answer, view: View) -> str:
    return answer.text(view)


FORMAT = OutputFormat(
    name="text",
    comment=("# ", ""),
    complete=False,
    findings=_findings,
    verification=_verification,
    verifications=_verifications,
    layout=_layout,
    comparison=_comparison,
    trace=_trace,
    answer=_answer,
)
