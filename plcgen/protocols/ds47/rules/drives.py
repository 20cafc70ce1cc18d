"""Rules about drives: drive objects and addresses."""

from __future__ import annotations

from typing import TYPE_CHECKING

from plcgen.diagnostics import Diagnostic, Note, Severity
from plcgen.project.rules.places import key_or_value, node_at

if TYPE_CHECKING:
    from collections.abc import Iterator

    from plcgen.protocols.ds47.plan.nouns import DrivePlan, PlannedDrive

_SHOWN = 12


def drive_object(plan: DrivePlan) -> Iterator[Diagnostic]:
    """PG217: the device has no such drive object."""
    for drive in plan.drives:
        allowed = drive.device.drive_objects
        if allowed is None or drive.drive_object in allowed:
            continue
        numbers = ", ".join(map(str, allowed[:_SHOWN]))
        yield Diagnostic(
            "PG217",
            f"{drive.device.title} has no drive object {drive.drive_object}",
            key_or_value(plan, (*drive.path, "drive_object")),
            help=f"its drive objects: {numbers} ({drive.device.drive_object_rule})",
        )


def unused_address(plan: DrivePlan) -> Iterator[Diagnostic]:
    """PG215: the kind of address that only the other CPU families use has no effect."""
    classic = plan.target.classic
    useless, used = ("hardware_id", "address") if classic else ("address", "hardware_id")
    for drive in plan.drives:
        spec = plan.settings(drive)
        if getattr(spec, useless) is None or getattr(spec, used) is None:
            continue
        yield Diagnostic(
            "PG215",
            f"{useless} has no effect: an {plan.target.family.upper()} uses {used}",
            plan.loaded.key_span((*drive.path, useless)),
            Severity.WARNING,
            help=f"remove {useless}",
        )


def shared_address(plan: DrivePlan) -> Iterator[Diagnostic]:
    """PG221: one drive object has two names."""
    first: dict[tuple[int, int], PlannedDrive] = {}
    key = "address" if plan.target.classic else "hardware_id"
    for drive in plan.drives:
        earlier = first.setdefault((drive.id_value, drive.drive_object), drive)
        given = node_at(plan, (*drive.path, key))
        if earlier is drive or given is None:
            continue
        yield Diagnostic(
            "PG221",
            f'drives "{earlier.key}" and "{drive.key}" are the same: one {key}, one drive object',
            given.span,
            Severity.WARNING,
            help=f'use "{earlier.key}" for both, or correct the {key} or the drive_object',
            notes=(Note("first use", key_or_value(plan, (*earlier.path, key))),),
        )
