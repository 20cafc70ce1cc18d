"""Rules about inputs: what a job writes or compares with if nobody connects them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from plcgen.base.diagnostics import Diagnostic, Severity
from plcgen.base.diagnostics.counting import shortlist
from plcgen.ds47.plan.values import amount_text
from plcgen.ds47.registry import kind_called
from plcgen.ds47.rules.places import given_start, parameter_span

if TYPE_CHECKING:
    from collections.abc import Iterator

    from plcgen.ds47.plan.access import Use
    from plcgen.ds47.plan.nouns import DriveJob, DrivePlan

_SHOWN = 4


def unconnected(plan: DrivePlan) -> Iterator[Diagnostic]:
    """PG226: an input without a value: what is written if nobody connects it is nobody's choice.

    An error for limits and reference values; for others a warning, unless the catalogue has a factory setting that
    is not zero, or what they do is harmless at any value.
    """
    for shape in plan.shapes:
        for use in shape.supplied:
            if not use.writes or given_start(use):
                continue
            found = next((job for job in plan.instances(shape) if use.parameter.pnu in job.drive.device.bases), None)
            where = parameter_span(plan, use)
            if found is not None:
                key, what = found.drive.device.key, "member of the records" if use.recorded else "input"
                message = f"{use.label} is a limit or reference value of {key}, and its {what} has no start value"
                yield Diagnostic("PG226", message, where, help=_choose(use))
            elif not use.recorded and not use.parameter.default and (effect := _effect(plan, shape, use)):
                message = (
                    f'if nothing is connected, "{shape.shape}" writes {_written(plan, use)}, '
                    f"and nobody has chosen that (effect: {effect})"
                )
                yield Diagnostic("PG226", message, where, Severity.WARNING, help=_choose(use))


def _choose(use: Use) -> str:
    form = f"{{parameter: {use.label}, start: ..}}" if use.recorded else f"{use.label}: {{start: ..}}, or a constant"
    return f"write {form}"


def _effect(plan: DrivePlan, shape: DriveJob, use: Use) -> str:
    """Of which class of effect, on the first drive where it matters what is written; empty if it is on none."""
    if kind_called(shape.kind).fixed:
        return ""
    jobs = plan.drive_kinds(shape)
    return next(
        filter(None, (job.drive.device.left_to_chance(use.parameter.pnu, job.drive.object_type) for job in jobs)), ""
    )


def left_open(plan: DrivePlan) -> Iterator[Diagnostic]:
    """PG227, a note for each job with inputs: which values go to which drives if nothing is connected to them."""
    for shape in plan.shapes:
        if not shape.inputs:
            continue
        written = [_written(plan, use) for use in shape.inputs]
        open_ = [use.label for use in shape.inputs if not given_start(use)]
        choose = f", or choose: {open_[0]}: {{start: ..}}" if open_ and not kind_called(shape.kind).fixed else ""
        help_ = f"connect its inputs{choose}" if open_ else ""
        does, to = ("writes", "to") if shape.writes else ("wants", "of")
        yield Diagnostic(
            "PG227",
            f'if nothing is connected, "{shape.shape}" {does} {_list(written)} {to} {_drives(plan, shape)}',
            plan.loaded.key_span(shape.path),
            Severity.NOTE,
            help=help_,
        )


def _written(plan: DrivePlan, use: Use) -> str:
    return f"{use.label} = {amount_text(use, plan.target)}"


def _drives(plan: DrivePlan, shape: DriveJob) -> str:
    names = [job.drive.key for job in plan.instances(shape)]
    return names[0] if len(names) == 1 else f"{names[0]} .. {names[-1]} ({len(names)} drives)"


def _list(texts: list[str]) -> str:
    return shortlist(texts, _SHOWN, f" and {len(texts) - _SHOWN} more")
