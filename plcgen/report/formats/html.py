"""One page with pictures and tables that needs nothing else."""

from __future__ import annotations

from typing import TYPE_CHECKING

from plcgen.report.registry import OutputFormat

if TYPE_CHECKING:
    from plcgen.base.display.view import View
    from plcgen.report.review.model import Review
    from plcgen.s7.tables.tables import LayoutResult

CHUNK = 32
"""Rows of a picture that are shown at once, about a printed page; those that follow are folded."""


def _layout(result: LayoutResult, _view: View) -> str:
    from plcgen.build.environment import render_text
    from plcgen.report.review.page import ROLES, script_view
    from plcgen.s7.tables.pictures import TONES, views

    view = {
        "blocks": views(result.blocks, CHUNK),
        "tones": range(TONES),
        "roles": ROLES,
        "subject": result.subject,
        "origins": result.origins,
        **script_view(render_text("html/page.js.j2", {})),
    }
    return render_text("html/layout.html.j2", view)


def _review(review: Review, _view: View) -> str:
    from plcgen._version import __version__
    from plcgen.build.environment import render_text
    from plcgen.report.review.page import page_view
    from plcgen.s7.tables.pictures import TONES

    view = page_view(review, render_text("html/page.js.j2", {}))
    return render_text("html/review.html.j2", {**view, "tones": range(TONES), "version": __version__})


FORMAT = OutputFormat(name="html", complete=False, comment=("<!-- ", " -->"), layout=_layout, review=_review)
