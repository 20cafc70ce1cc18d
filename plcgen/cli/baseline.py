"""Known problems of ``check``: an earlier result as JSON, and what is new beside it."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.base.files.files import read_bounded
from plcgen.base.files.options import USAGE

MAX_BASELINE = 16 * 1024 * 1024
Subject = tuple[str, Sequence[Diagnostic]]
Key = tuple[str, str, str]
"""File, code and message: lines move, what is wrong stays."""


@dataclass(frozen=True, slots=True)
class Compared:
    """``subjects`` with what is new; how many were ``known``, and how many of the known are ``gone``."""

    subjects: list[Subject]
    known: int
    gone: int


def read_baseline(path: Path) -> Counter[Key]:
    """The problems of a result of ``check --format json``, each as often as it stands there.

    Raises:
        DiagnosticError: PG901 if it cannot be read or is no such result.
    """
    try:
        found: Any = json.loads(read_bounded(path, MAX_BASELINE))
        own: Any = found["diagnostics"] if found["kind"] == "check" else None
        return Counter((str(d["file"]), str(d["code"]), str(d["message"])) for d in own)
    except OSError as problem:
        message = f"not readable: {problem.strerror or problem}"
    except (ValueError, KeyError, TypeError, RecursionError):
        message = "this is not a result of plcgen check --format json"
    help_ = "record it: plcgen check PATHS --format json --output FILE"
    raise DiagnosticError([Diagnostic(USAGE, message, Span(path.as_posix()), help=help_)])


def compare_baseline(subjects: Sequence[Subject], baseline: Counter[Key]) -> Compared:
    """Leave out what the baseline has, as often as it has it."""
    left = Counter(baseline)
    new: list[Subject] = []
    for name, diagnostics in subjects:
        fresh: list[Diagnostic] = []
        for diagnostic in diagnostics:
            key = (diagnostic.span.file, diagnostic.code, diagnostic.message)
            if left[key] > 0:
                left[key] -= 1
            else:
                fresh.append(diagnostic)
        new.append((name, fresh))
    gone = left.total()
    return Compared(new, baseline.total() - gone, gone)
