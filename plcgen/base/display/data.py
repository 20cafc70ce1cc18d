"""Results as plain data for programs: stable keys, everything a text report says, no time stamps."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

from plcgen._version import __version__
from plcgen.base.diagnostics import Diagnostic, Severity, Span

FORMAT = 1
"""Version of the JSON shapes; it grows when a key changes its meaning or goes away."""


def dump(data: Mapping[str, Any]) -> str:
    """Serialise with the house style: two spaces, text unescaped, one final line end."""
    return json.dumps(data, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def span_data(span: Span) -> dict[str, Any]:
    """Keys of a place; a place without a line is the file as a whole."""
    data: dict[str, Any] = {"file": span.file}
    if span.line:
        data |= {"line": span.line, "column": span.column}
    if span.end_line:
        data |= {"end_line": span.end_line, "end_column": span.end_column}
    return data


def diagnostic_data(diagnostic: Diagnostic) -> dict[str, Any]:
    """One diagnostic with its notes."""
    return {
        "code": diagnostic.code,
        "severity": diagnostic.severity.label,
        "message": diagnostic.message,
        **span_data(diagnostic.span),
        "help": diagnostic.help,
        "notes": [{"message": note.message, **span_data(note.span)} for note in diagnostic.notes],
    }


def head(kind: str, *, ok: bool) -> dict[str, Any]:
    """Opening keys of every JSON result."""
    return {"tool": "plcgen", "version": __version__, "format": FORMAT, "kind": kind, "ok": ok}


def diagnostics_data(kind: str, diagnostics: Sequence[Diagnostic], *, ok: bool | None = None) -> dict[str, Any]:
    """Head, counts and diagnostics; ``ok`` defaults to "no errors"."""
    counts = {f"{s.label}s": sum(d.severity is s for d in diagnostics) for s in reversed(Severity)}
    good = not counts["errors"] if ok is None else ok
    found = [diagnostic_data(d) for d in diagnostics]
    return {**head(kind, ok=good), "summary": counts, "diagnostics": found}
