"""Diagnostics as text for people: what, where, the source line with a caret, how to fix it."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from plcgen.diagnostics import Diagnostic, Severity, Span
from plcgen.output.cells import clean, expand, window, wrap
from plcgen.output.paint import paint

SourceLine = Callable[[str, int], str | None]
"""``lines(file, number)`` gives a line (from 1) without its end, None if it is not known."""

DEFAULT_WIDTH = 100
MIN_WIDTH = 40


def no_source(_file: str, _line: int) -> None:
    """Know no line of any file: diagnostics without excerpts."""


def diagnostic_text(
    diagnostic: Diagnostic, lines: SourceLine, *, color: bool = False, width: int = DEFAULT_WIDTH
) -> str:
    """One diagnostic with its excerpt, help and notes; ends with a line end."""
    width = max(width, MIN_WIDTH)
    spans = [diagnostic.span, *(note.span for note in diagnostic.notes)]
    gutter = len(str(max(span.line for span in spans)))
    label = diagnostic.severity.label
    title = paint(f"{label}[{diagnostic.code}]", label, color=color)
    out = [f"{title}: {paint(clean(diagnostic.message), 'bold', color=color)}"]
    out += _place(diagnostic.span, lines, gutter, label, color=color, width=width)
    if diagnostic.help:
        out += _help(clean(diagnostic.help), gutter, color=color, width=width)
    for note in diagnostic.notes:
        head = f"{' ' * gutter} {paint('=', 'gutter', color=color)} {paint('note', 'note', color=color)}"
        out.append(f"{head}: {clean(note.message)}")
        out += _place(note.span, lines, gutter, "note", color=color, width=width)
    return "\n".join(out) + "\n"


def diagnostics_text(
    diagnostics: Sequence[Diagnostic], lines: SourceLine, *, color: bool = False, width: int = DEFAULT_WIDTH
) -> str:
    """All diagnostics, an empty line between two of them."""
    return "\n".join(diagnostic_text(d, lines, color=color, width=width) for d in diagnostics)


def _place(span: Span, lines: SourceLine, gutter: int, style: str, *, color: bool, width: int) -> list[str]:
    if not span.file:
        return []
    arrow = paint("-->", "gutter", color=color)
    out = [f"{' ' * gutter}{arrow} {clean(str(span))}"]
    source = lines(span.file, span.line) if span.line else None
    if source is None:
        return out
    start = max(span.column - 1, 0)
    end = span.end_column - 1 if span.end_line == span.line else len(source.rstrip())
    shown, first, last = expand(source, start, max(end, start + 1))
    shown, first, last = window(shown, first, last, width - gutter - 4)
    bar = paint("|", "gutter", color=color)
    number = paint(f"{span.line:>{gutter}}", "gutter", color=color)
    caret = paint(("-" if style == "note" else "^") * max(1, last - first), style, color=color)
    empty = f"{' ' * gutter} {bar}"
    return [*out, empty, f"{number} {bar} {shown}".rstrip(), f"{empty} {' ' * first}{caret}"]


def _help(text: str, gutter: int, *, color: bool, width: int) -> list[str]:
    head = f"{' ' * gutter} {paint('=', 'gutter', color=color)} {paint('help', 'help', color=color)}: "
    first, *more = wrap(text, width - gutter - 9)
    return [head + first, *(" " * (gutter + 9) + line for line in more)]


def count_text(diagnostics: Sequence[Diagnostic]) -> str:
    """``2 errors, 1 warning``; ``no problems`` if there is neither (notes are not problems)."""
    parts = []
    for severity in (Severity.ERROR, Severity.WARNING):
        count = sum(d.severity is severity for d in diagnostics)
        if count:
            parts.append(f"{count} {severity.label}{'' if count == 1 else 's'}")
    return ", ".join(parts) or "no problems"


def summary_text(diagnostics: Sequence[Diagnostic], subject: str, *, color: bool = False) -> str:
    """``2 errors, 1 warning in specs/x.yaml``."""
    errors = any(d.severity is Severity.ERROR for d in diagnostics)
    warnings = any(d.severity is Severity.WARNING for d in diagnostics)
    style = "error" if errors else "warning" if warnings else "ok"
    return f"{paint(count_text(diagnostics), style, color=color)} in {clean(subject)}"
