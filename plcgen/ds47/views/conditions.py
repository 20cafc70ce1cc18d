"""What a step waits for, in words."""

from __future__ import annotations

from plcgen.ds47.kind import Wait
from plcgen.ds47.plan.access import Use
from plcgen.ds47.plan.nouns import DriveJob, DrivePlan
from plcgen.ds47.plan.types import element_type
from plcgen.ds47.plan.values import literals_text
from plcgen.ds47.wire.formats import FormatKind, unpack_values


def condition_text(plan: DrivePlan, job: DriveJob, use: Use) -> str:
    """``r722.0 = 1`` or ``r21 > 100.0``."""
    awaited = use.as_(Wait)
    assert awaited is not None  # only uses that wait come here
    if awaited.follows:
        return f"{use.label} = bit 0 of {job.uses[0].label}"
    if awaited.bit is None:
        return f"{use.label} {awaited.operator} {_wanted_text(plan, use)}"
    return f"{use.label}.{awaited.bit} {awaited.operator} {int(any(use.data))}"


def _wanted_text(plan: DrivePlan, use: Use) -> str:
    """What is waited for; of a type that the CPU does not have, the number."""
    if element_type(use.format, plan.target) is not None:
        return literals_text(use, plan.target)
    if use.format.kind is FormatKind.OPAQUE:
        return f"16#{use.data.hex().upper()}"
    return str(unpack_values(use.format, 1, use.data)[0])
