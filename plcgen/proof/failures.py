"""Findings of the execution checks as diagnostics."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from plcgen.cpu.linkage import Probe
from plcgen.diagnostics import Diagnostic, Span
from plcgen.protocols.ds47.proof.runner import Failure


def diagnostic(
    code: str, key: str, failures: Sequence[Failure], probe: Probe | None = None, page: str = "docs/ppi-master.md"
) -> Diagnostic:
    """One diagnostic for the failures of a job, or for a statement that never ran."""
    if probe is not None:
        return Diagnostic(code, key, Span(probe.file, probe.line, probe.column))
    first = failures[0]
    more = f" (and {len(failures) - 1} more)" if len(failures) > 1 else ""
    line = f"; the statement is {Path(first.file).name}:{first.line}" if first.file and first.line else ""
    span = Span(first.file, first.line)
    return Diagnostic(code, f"{key}: {first}{more}", span, help=f"compare this place with {page}{line}")
