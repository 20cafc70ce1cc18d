"""Rules about jobs that read back what they write: whether that can be, and whether it says anything."""

from __future__ import annotations

from typing import TYPE_CHECKING

from plcgen.base.diagnostics import Diagnostic
from plcgen.ds47 import guards
from plcgen.ds47.plan.access import Verify
from plcgen.ds47.registry import kind_called, kinds
from plcgen.ds47.rules.places import of_drive, on_any_drive, parameter_span

if TYPE_CHECKING:
    from collections.abc import Iterator

    from plcgen.ds47.device import Parameter
    from plcgen.ds47.plan.nouns import DrivePlan


def readable(plan: DrivePlan) -> Iterator[Diagnostic]:
    """PG246: what is written cannot be read, or is not what the drive has afterwards."""
    for job, use, why in on_any_drive(plan, lambda _, use: _why_not(use.parameter) if use.as_(Verify) else ""):
        yield Diagnostic(
            "PG246",
            f"{use.label}{of_drive(plan, job)} cannot be read back: {why}",
            parameter_span(plan, use),
            help="write it in a separate job, without verify",
        )


def _why_not(parameter: Parameter) -> str:
    if parameter.access == "w":
        return f"it can only be written{parameter.doubt('access')}"
    why = next((kind.runs_on[parameter.pnu] for kind in kinds() if parameter.pnu in kind.runs_on), "")
    if why:
        return why
    return "the drive sets it back automatically" if parameter.pnu in guards.SET_BACK else ""


def not_restored(plan: DrivePlan) -> Iterator[Diagnostic]:
    """PG258: a job that is told to restore cannot."""
    for job in plan.shapes:
        if plan.entry(job).on_error is None:
            continue
        place = plan.loaded.key_span((*job.path, "on_error"))
        own = len(job.telegrams) - len(job.saving)
        if job.restores and own > _EACH_WAY:
            message = f'"{job.shape}" needs {own} telegrams: restoring takes one telegram in each direction'
            yield Diagnostic("PG258", message, place, help="split it into several jobs")
        elif not job.verified and kind_called(job.kind).read_back:
            message = f'"{job.shape}" does not read back: it would not know what to restore'
            yield Diagnostic("PG258", message, place, help="add verify: readback")
        elif not job.restores:
            message = f'"{job.shape}" has nothing that could be restored'
            yield Diagnostic("PG258", message, place, help="on_error is for jobs with write and verify: readback")


_EACH_WAY = 3
"""Telegrams of a job that restores: old values, the write, what is read back."""


def nothing_written(plan: DrivePlan) -> Iterator[Diagnostic]:
    """PG247: a job that writes no values is told to read them back."""
    for job in plan.shapes:
        if plan.entry(job).verify is not None and not job.verified:
            yield Diagnostic(
                "PG247",
                f'"{job.shape}" writes no values: there is nothing to read back',
                plan.loaded.key_span((*job.path, "verify")),
                help="remove verify" if job.poll is None else "remove verify: save is done when the drive says so",
            )
