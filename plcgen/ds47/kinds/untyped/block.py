"""What a job adds to its block that reads parameters whose type comes from the answer."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from plcgen.build.nouns import CallerValue
from plcgen.ds47.plan.access import Form
from plcgen.ds47.plan.nouns import DriveJob, DrivePlan, DriveTelegram
from plcgen.ds47.views.parts import BlockParts
from plcgen.ds47.views.rows import interface_row

_SHOWN = {"format": "HEX", "dint": "DEC", "real": "FloatingPoint"}


def form_values(plan: DrivePlan, job: DriveJob) -> Iterator[CallerValue]:
    """Format and numbers, behind the bytes that they belong to."""
    for _, one in job.shown:
        if form := one.as_(Form):
            yield CallerValue(interface_row(plan, one, start=False), (("", _SHOWN[form.name]),))


def _telegram(_: DrivePlan, job: DriveJob, telegram: DriveTelegram) -> list[dict[str, Any]]:
    """Where each block of an answer begins, and what shows it."""
    return [
        {
            "label": field.part.use.label,
            "use": field.part.use.position,
            "bytes": field.part.use.member,
            "at": f"statResponseBytes{job.suffix(telegram)}[{field.offset - 2}]",
            **{form.name: one.member for one in field.part.use.shown if (form := one.as_(Form))},
        }
        for field in telegram.response.fields
        if field.role == "value" and field.part is not None and field.part.use.untyped
    ]


PARTS = (
    BlockParts(
        name="untyped",
        precedence=9,
        has=lambda job: job.untyped,
        template="plcgen.ds47.kinds.untyped:parts.scl.j2",
        view=lambda *_: True,
        telegram=_telegram,
        last_outputs=form_values,
    ),
)
