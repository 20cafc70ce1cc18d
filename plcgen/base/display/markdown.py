"""Foreign text inside Markdown: it begins no heading, emphasis, link, code, table cell or HTML."""

from __future__ import annotations

import re

from plcgen.base.display.cells import clean

_MARKS = re.compile(r"[\\`<>|~]|(?<=\S)\*|\*(?=\S)|\](?=[(\[:])|(?<!\w)#|(?<![^\W_])_|_(?![^\W_])|&(?=#?\w+;)")
"""Where they mean something: no asterisk between spaces, no underscore inside a word, no bracket without a link."""
_ENTITIES = {"&": "&amp;", "<": "&lt;", ">": "&gt;"}


def escape(text: str) -> str:
    """Text that a viewer shows as it is."""
    return _MARKS.sub(lambda mark: _ENTITIES.get(mark[0], f"\\{mark[0]}"), clean(text))


def code_span(text: str) -> str:
    """Text between backticks, more of them than it has itself."""
    fence = "`" * (1 + max((len(run) for run in re.findall("`+", text)), default=0))
    pad = " " if len(fence) > 1 else ""
    return f"{fence}{pad}{clean(text)}{pad}{fence}"
