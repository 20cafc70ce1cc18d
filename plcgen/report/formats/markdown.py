"""GitHub Markdown: comments for a pull request, tables for a wiki."""

from __future__ import annotations

from typing import TYPE_CHECKING

from plcgen.base.display.cells import clean
from plcgen.base.display.markdown import escape
from plcgen.base.display.table import markdown_table
from plcgen.report.registry import OutputFormat

if TYPE_CHECKING:
    from plcgen.base.display.view import View
    from plcgen.report.review.model import Review
    from plcgen.s7.compare.model import Change, Comparison
    from plcgen.s7.tables.tables import LayoutResult

_MARK = {"breaking": ":red_circle:", "compatible": ":yellow_circle:", "documentation": ":white_circle:"}
LIMIT = 18_000
"""Bytes of a comparison without --verbose."""
_MANY = 12
"""So many items of a long list are shown; --verbose shows the rest."""


def _layout(result: LayoutResult, _view: View) -> str:
    """One heading and one table a block, its footnotes below."""
    from plcgen.s7.tables.tables import shown_columns

    parts = []
    for block in result.blocks:
        shown, right = shown_columns(block)
        table = markdown_table(shown[0], [[_indented(cell) for cell in row] for row in shown[1:]], right=right)
        notes = [f"- {mark}: {text}".replace("*", "\\*") for mark, text in block.footnotes]
        lines = [f"### {escape(block.title)}", "", block.summary, "", *table, *([""] if notes else []), *notes]
        parts.append("\n".join(lines) + "\n")
    return "\n".join(parts)


def _indented(cell: str) -> str:
    """A cell whose leading blanks a Markdown viewer keeps."""
    text = cell.lstrip(" ")
    return "\N{NO-BREAK SPACE}" * (len(cell) - len(text)) + text


def _comparison(comparison: Comparison, view: View) -> str:
    """The verdict, one table, the long lists folded away."""
    from plcgen.s7.compare.text import shortened

    lines = ["### Changes of PLC blocks", "", _verdict(comparison, view), ""]
    if not comparison.changes:
        return "\n".join(lines[:-1]) + "\n"
    told = [f"- {_MARK[one.level.value]} **{_escape(one.who)}**: {_escape(one.text)}" for one in comparison.sentences]
    table = ["| | where | what | id |", "|---|---|---|---|"]
    for subject, changes in comparison.folded(everything=view.verbose):
        for number, (change, hidden) in enumerate(shortened(changes, view)):
            where = f"**{_escape(subject)}**" if number == 0 else ""
            mark = f"{_MARK[change.level.value]} {change.level.value}"
            table.append(f"| {mark} | {where} | {_escape(change.text)} | `{change.kind}` |")
            if hidden:
                table.append(f"| | | .. and {hidden} more | `{change.kind}` |")
    long = [] if told and not view.verbose else [change for change in comparison.changes if change.details]
    if told:
        table = ["", "<details><summary>Telegrams, drives and data blocks</summary>", "", *table, "", "</details>"]
    parts = [*told, *table, *(line for change in long for line in ["", *_folded(change, view)])]
    return "\n".join([*lines, *_bounded(parts, view)]) + "\n"


def _bounded(lines: list[str], view: View) -> list[str]:
    """As much as a comment of a pull request should have; --verbose leaves nothing out."""
    left = LIMIT
    for number, line in enumerate(lines):
        left -= len(line.encode()) + 1
        if left < 0 and not view.verbose:
            return [*lines[:number], "", f".. and {len(lines) - number} lines more: plcgen diff --verbose"]
    return lines


def _folded(change: Change, view: View) -> list[str]:
    shown = change.details if view.verbose else change.details[:_MANY]
    rest = len(change.details) - len(shown)
    body = [*(clean(detail) for detail in shown), *([f".. and {rest} more"] if rest else [])]
    title = f"{_html(change.subject)}: {len(change.details)} {_count_word(change)}"
    fence = "````" if any("```" in line for line in body) else "```"
    return [f"<details><summary>{title}</summary>", "", f"{fence}text", *body, fence, "", "</details>"]


def _count_word(change: Change) -> str:
    return {"member-moved": "moved members", "code-changed": "changed places"}.get(change.kind, "items")


def _verdict(comparison: Comparison, view: View) -> str:
    if not comparison.changes:
        return "No semantic differences."
    result = "**Fails**" if comparison.failing(view.fail_on) else "Passes"
    sides = f"`{clean(comparison.old)}` against `{clean(comparison.new)}`"
    return f"{result} (`--fail-on {view.fail_on}`): {comparison.counts}. {sides}."


def _html(text: str) -> str:
    return clean(text).replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")


def _escape(text: str) -> str:
    safe = _html(text).replace("\\", "\\\\").replace("|", "\\|")
    for mark in "*_`[]":
        safe = safe.replace(mark, f"\\{mark}")
    return safe


def _review(review: Review, _view: View) -> str:
    from plcgen.report.review.markdown import review_markdown

    return review_markdown(review)


FORMAT = OutputFormat(
    name="markdown", complete=False, comment=("<!-- ", " -->"), layout=_layout, comparison=_comparison, review=_review
)
