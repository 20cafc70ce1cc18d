"""Rules about inputs: what a job writes or compares with if nobody connects them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from plcgen.base.diagnostics import Diagnostic, Severity
from plcgen.base.diagnostics.counting import shortlist
from plcgen.ds47.plan.values import literals_text
from plcgen.ds47.registry import kind_called
from plcgen.ds47.rules.places import given_start, parameter_span

if TYPE_CHECKING:
    from collections.abc import Iterator

    from plcgen.ds47.plan.access import Use
    from plcgen.ds47.plan.nouns import DriveJob, DrivePlan

_SHOWN = 4


def unconnected(plan: DrivePlan) -> Iterator[Diagnostic]:
    """PG226: a limit or reference without a value: what is written if nobody connects the input is nobody's choice."""
    for shape in plan.shapes:
        instances = plan.instances(shape)
        for use in shape.supplied:
            found = next((job for job in instances if use.parameter.pnu in job.drive.device.bases), None)
            if found is not None and use.writes and not given_start(use):
                device = found.drive.device.key
                what = "member of the records" if use.recorded else "input"
                message = f"{use.label} is a limit or reference value of {device}, and its {what} has no start value"
                help_ = f"write {use.label}: {{start: ..}}, or a constant"
                help_ = f"write {{parameter: {use.label}, start: ..}}" if use.recorded else help_
                yield Diagnostic("PG226", message, parameter_span(plan, use), help=help_)


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
    unit = f" {use.parameter.unit}" if use.parameter.unit else ""
    return f"{use.label} = {literals_text(use, plan.target)}{unit}"


def _drives(plan: DrivePlan, shape: DriveJob) -> str:
    names = [job.drive.key for job in plan.instances(shape)]
    return names[0] if len(names) == 1 else f"{names[0]} .. {names[-1]} ({len(names)} drives)"


def _list(texts: list[str]) -> str:
    return shortlist(texts, _SHOWN, f" and {len(texts) - _SHOWN} more")
