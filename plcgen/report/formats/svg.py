"""All pictures of memory layouts below each other as one SVG document."""

from __future__ import annotations

from typing import TYPE_CHECKING

from plcgen.base.display.cells import width
from plcgen.report.registry import OutputFormat

if TYPE_CHECKING:
    from plcgen.base.display.view import View
    from plcgen.s7.tables.tables import LayoutResult

_TITLE = 34
_BOLD = 8.0
"""Width of a character of a heading in pixels, 13 px bold."""


def _layout(result: LayoutResult, _view: View) -> str:
    from plcgen.build.environment import render_text
    from plcgen.s7.tables.pictures import HEAD, TONES, views

    blocks = views(result.blocks)
    top, wide = 0, 300.0
    for block in blocks:
        block["top"] = top
        top += _TITLE + sum(picture.height for picture in block["pictures"]) + (HEAD if block["end"] else 0)
        wide = max([wide, 16 + _BOLD * width(block["heading"]), *(picture.width for picture in block["pictures"])])
    size = {"width": wide, "height": max(top, 40)}
    return render_text("html/layout.svg.j2", {"blocks": blocks, "tones": range(TONES), **size})


FORMAT = OutputFormat(name="svg", complete=False, comment=("<!-- ", " -->"), layout=_layout)
