"""One page with pictures and tables that needs nothing else."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

from plcgen.report.registry import OutputFormat

if TYPE_CHECKING:
    from plcgen.base.display.view import View
    from plcgen.report.review.model import Review
    from plcgen.s7.tables.tables import BlockTable, LayoutResult

_POINTER = "POINTER to "
_QUOTED = re.compile(r'"([^"]+)"')
CHUNK = 32
"""Rows of a picture that are shown at once, about a printed page; those that follow are folded."""


def _layout(result: LayoutResult, _view: View) -> str:
    from plcgen.build.environment import render_text
    from plcgen.report.review.page import ROLES, script_view
    from plcgen.s7.tables.pictures import TONES, views

    outer = _addressed(result.blocks)
    inner = [one for one in result.blocks if one not in outer]
    made = views([*outer, *inner], CHUNK)
    view = {
        "blocks": made,
        "inner": {one["id"] for one in made[len(outer) :]} if outer else set(),
        "tones": range(TONES),
        "roles": ROLES,
        "subject": result.subject,
        "origins": result.origins,
        **script_view(render_text("html/page.js.j2", {})),
    }
    return render_text("html/layout.html.j2", view)


def _addressed(blocks: Sequence[BlockTable]) -> list[BlockTable]:
    """What others address: data blocks, then the types in them; without any data block every type.

    A data block of nothing but structures that function blocks have as IN_OUT is handed to them, and left to them.
    """
    rows = (row for one in blocks if one.kind == "FB" for row in one.rows)
    handed = {row.type.removeprefix(_POINTER) for row in rows if row.type.startswith(_POINTER)}
    data = [
        one
        for one in blocks
        if one.kind == "DB" and not one.inner and {row.type for row in one.rows if not row.depth} - handed
    ]
    types = {one.name: one for one in blocks if one.kind == "UDT"}
    if not data:
        return [*types.values()]
    found: dict[str, BlockTable] = {}
    waiting = [*data]
    while waiting:
        named = _QUOTED.findall(" ".join(row.type for row in waiting.pop().rows))
        fresh = {name: types[name] for name in named if name in types and name not in found}
        found |= fresh
        waiting += fresh.values()
    return [*data, *(one for name, one in types.items() if name in found)]


def _review(review: Review, _view: View) -> str:
    from plcgen._version import __version__
    from plcgen.build.environment import render_text
    from plcgen.report.review.page import page_view
    from plcgen.s7.tables.pictures import TONES

    view = page_view(review, render_text("html/page.js.j2", {}))
    return render_text("html/review.html.j2", {**view, "tones": range(TONES), "version": __version__})


FORMAT = OutputFormat(name="html", complete=False, comment=("<!-- ", " -->"), layout=_layout, review=_review)
