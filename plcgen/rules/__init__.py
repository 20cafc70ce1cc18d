"""Rules: what is wrong with a planned project, one function per code."""

from __future__ import annotations

from plcgen.diagnostics import Report
from plcgen.plan.model import Project


def apply_rules(project: Project, report: Report) -> None:
    """Apply every rule; the functions are independent of each other."""
