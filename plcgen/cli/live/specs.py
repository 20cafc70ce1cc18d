"""The drives of a spec, for the verbs that compare."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from plcgen.base.diagnostics import DiagnosticError

if TYPE_CHECKING:
    from plcgen.ds47.plan.nouns import DrivePlan
    from plcgen.project.nouns import Project


def drive_plan(spec: Path) -> DrivePlan:
    """The plan of a spec without errors. Raises DiagnosticError with what is wrong."""
    return drive_project(spec)[1]


def drive_project(spec: Path) -> tuple[Project, DrivePlan]:
    """The project of a spec, too. Raises as ``drive_plan`` does."""
    from plcgen import api
    from plcgen.ds47.plan.nouns import DrivePlan

    checked = api.check(spec)
    if checked.project is None or not checked.ok:
        raise DiagnosticError(list(checked.diagnostics))
    plan = checked.project.plan(DrivePlan)
    if plan is None or not plan.jobs:
        raise click.UsageError(f"{spec} has no drive jobs")
    return checked.project, plan


def choose_drive(plan: DrivePlan, key: str | None, remedy: str) -> str:
    """The key of a drive that the spec has; without one that of its only drive. Raises UsageError."""
    keys = [drive.key for drive in plan.drives]
    shown = ", ".join(keys[:8])
    if key is None and len(keys) != 1:
        raise click.UsageError(f"the spec has the drives {shown}: {remedy}")
    if key is not None and key not in keys:
        raise click.UsageError(f'the spec has no drive "{key}", only {shown}')
    return key or keys[0]
