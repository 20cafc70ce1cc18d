"""One page with pictures and tables that needs nothing else."""

from __future__ import annotations

from typing import TYPE_CHECKING

from plcgen.output.registry import OutputFormat

if TYPE_CHECKING:
    from plcgen.display.view import View
    from plcgen.review.layout.tables import LayoutResult

CHUNK = 32
"""Rows of a picture that are shown at once, about a printed page; those that follow are folded."""


def _layout(result: LayoutResult, _view: View) -> str:
    from plcgen.documents.environment import render_text
    from plcgen.review.layout.pictures import TONES, views

    return render_text("html/layout.html.j2", {"blocks": views(result.blocks, CHUNK), "tones": range(TONES)})


FORMAT = OutputFormat(name="html", complete=False, layout=_layout)
