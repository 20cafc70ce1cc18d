"""Diagnostics as text for people: what, where, the source line with a caret, how to fix it."""

from __future__ import annotations

from collections.abc import Sequence

from plcgen.base.diagnostics import Diagnostic, Severity, Span
from plcgen.base.diagnostics.counting import quantity
from plcgen.base.display.cells import clean, expand, window, wrap
from plcgen.base.display.view import View

REACH = 2_000
"""So many characters of a line are looked at before and behind the place: exports can have one line of megabytes."""


def diagnostic_text(diagnostic: Diagnostic, view: View) -> str:
    """One diagnostic with its excerpt, help and notes; ends with a line end."""
    spans = [diagnostic.span, *(note.span for note in diagnostic.notes)]
    gutter = len(str(max(span.line for span in spans)))
    label = diagnostic.severity.label
    title = view.paint(f"{label}[{diagnostic.code}]", label)
    out = [f"{title}: {view.paint(clean(diagnostic.message), 'bold')}"]
    out += _place(diagnostic.span, gutter, label, view)
    if diagnostic.help:
        out += _help(clean(diagnostic.help), gutter, view)
    for note in diagnostic.notes:
        head = f"{' ' * gutter} {view.paint('=', 'gutter')} {view.paint('note', 'note')}"
        out.append(f"{head}: {clean(note.message)}")
        out += _place(note.span, gutter, "note", view)
    return "\n".join(out) + "\n"


def diagnostics_text(diagnostics: Sequence[Diagnostic], view: View) -> str:
    """All diagnostics, an empty line between two of them."""
    return "\n".join(diagnostic_text(d, view) for d in diagnostics)


def _place(span: Span, gutter: int, style: str, view: View) -> list[str]:
    if not span.file:
        return []
    arrow = view.paint("-->", "gutter")
    out = [f"{' ' * gutter}{arrow} {clean(str(span))}"]
    source = view.lines(span.file, span.line) if span.line else None
    if source is None:
        return out
    start = max(span.column - 1, 0)
    end = span.end_column - 1 if span.end_line == span.line else len(source.rstrip())
    away = max(0, start - REACH)
    near = source[away : start + REACH]
    shown, first, last = expand(near, start - away, max(end, start + 1) - away)
    shown, first, last = window(shown, first, last, view.columns - gutter - 4)
    bar = view.paint("|", "gutter")
    number = view.paint(f"{span.line:>{gutter}}", "gutter")
    caret = view.paint(("-" if style == "note" else "^") * max(1, last - first), style)
    empty = f"{' ' * gutter} {bar}"
    return [*out, empty, f"{number} {bar} {shown}".rstrip(), f"{empty} {' ' * first}{caret}"]


def _help(text: str, gutter: int, view: View) -> list[str]:
    head = f"{' ' * gutter} {view.paint('=', 'gutter')} {view.paint('help', 'help')}: "
    first, *more = wrap(text, view.columns - gutter - 9)
    return [head + first, *(" " * (gutter + 9) + line for line in more)]


def count_text(diagnostics: Sequence[Diagnostic]) -> str:
    """``2 errors, 1 warning``; ``no problems`` if there is neither (notes are not problems)."""
    parts = []
    for severity in (Severity.ERROR, Severity.WARNING):
        count = sum(d.severity is severity for d in diagnostics)
        if count:
            parts.append(quantity(count, severity.label))
    return ", ".join(parts) or "no problems"


def summary_text(diagnostics: Sequence[Diagnostic], subject: str) -> str:
    """``2 errors, 1 warning in specs/x.yaml``."""
    return f"{count_text(diagnostics)} in {clean(subject)}"
