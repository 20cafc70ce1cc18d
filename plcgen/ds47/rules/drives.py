"""Rules about drives: drive objects and addresses."""

from __future__ import annotations

from typing import TYPE_CHECKING

from plcgen.base.diagnostics import Diagnostic, Note, Severity
from plcgen.base.diagnostics.counting import shortlist
from plcgen.ds47.hardware import PROFIBUS_INDEX
from plcgen.project.rules.places import key_or_value, node_at

if TYPE_CHECKING:
    from collections.abc import Iterator

    from plcgen.ds47.plan.nouns import DrivePlan, PlannedDrive

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


CONTROL_UNIT = 1
"""Its drive object (S120 function manual communication, 3.4)."""


def without_clock(plan: DrivePlan) -> Iterator[Diagnostic]:
    """PG254: a job sets the clock in a drive object that has none."""
    for job in plan.jobs:
        drive = job.drive
        if job.clock is None or drive.device.drive_objects is not None or drive.drive_object == CONTROL_UNIT:
            continue
        yield Diagnostic(
            "PG254",
            f"drive object {drive.drive_object} of {drive.key} has no clock: it is in the control unit",
            key_or_value(plan, (*drive.path, "drive_object")),
            help="add the control unit to the unit as a drive with drive_object: 1, and set its clock",
        )


def no_records_of_a_processor(plan: DrivePlan) -> Iterator[Diagnostic]:
    """PG263, a note: on an S7-300 PROFINET may be that of a communications processor, where SFB 52/53 do not reach.

    The help of the TIA Portal (SIMATIC NET CPs for S7-300) has PNIO_RW_REC for records there.
    """
    drives = [drive for drive in plan.drives if drive.record_index != PROFIBUS_INDEX]
    if plan.target.family != "s7-300" or not drives:
        return
    names = shortlist([drive.key for drive in drives], _SHOWN, f" and {len(drives) - _SHOWN} more")
    yield Diagnostic(
        "PG263",
        f"on PROFINET: {names}; WRREC and RDREC reach what is connected to the CPU itself, nothing at a CP 343-1",
        plan.loaded.key_span(drives[0].path),
        Severity.NOTE,
        help="at a CP 343-1, connect the drives to the CPU or to a PROFIBUS of the CPU",
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


def separate_objects(plan: DrivePlan) -> Iterator[Diagnostic]:
    """PG224: drive objects with identifiers of their own, which may belong to one control unit."""
    if plan.target.classic:
        return
    found: dict[str, list[PlannedDrive]] = {}
    for drive in plan.drives:
        if drive.device.drive_objects is None and drive.path[0] == "drives":
            found.setdefault(drive.device.key, []).append(drive)
    for key, drives in found.items():
        if len({drive.drive_object for drive in drives}) < 2 or len({drive.unit.key for drive in drives}) < 2:
            continue
        names = ", ".join(drive.key for drive in drives[:_SHOWN])
        yield Diagnostic(
            "PG224",
            f"{names} are different drive objects of a {key}: a control unit takes one request at a time",
            plan.loaded.key_span(drives[1].path),
            Severity.WARNING,
            help=f"{_one_unit(*drives[:2])}, with one drive in a unit that has no other",
        )


def _one_unit(first: PlannedDrive, second: PlannedDrive) -> str:
    return f"units: {{cu1: {{device: {first.device.key}, drives: {{{first.key}: {{..}}, {second.key}: {{..}}}}}}}}"


def engine_places(plan: DrivePlan) -> Iterator[Diagnostic]:
    """PG225: the largest engine has no room for so many jobs or units."""
    room = plan.variant
    for unit in plan.units:
        if plan.slots(unit) > room.slots:
            message = f"{plan.slots(unit)} job instances on {unit.key}: a unit has {room.slots} places"
            yield Diagnostic("PG225", message, plan.loaded.key_span(unit.path), help="combine jobs of the unit")
    if len(plan.units) > room.channels:
        unit = plan.units[room.channels]
        message = f"{len(plan.units)} units: a CPU has {room.channels} places"
        yield Diagnostic("PG225", message, plan.loaded.key_span(unit.path), help="split the project")


def divided_device(plan: DrivePlan) -> Iterator[Diagnostic]:
    """PG260: one address belongs to two units, which would ask the device at the same time."""
    first: dict[int, PlannedDrive] = {}
    key = "address" if plan.target.classic else "hardware_id"
    for drive in plan.drives:
        earlier = first.setdefault(drive.id_value, drive)
        given = node_at(plan, (*drive.path, key))
        if earlier.unit is drive.unit or given is None:
            continue
        if drive.device is not earlier.device:
            what = f"different devices, {earlier.device.key} and {drive.device.key}"
            help_ = f"correct the {key} of one of them, or the device"
        elif drive.record_index != earlier.record_index:
            what = f"different records, {earlier.record_index:04X}h and {drive.record_index:04X}h"
            help_ = f"correct the {key} of one of them, or the record_index: a device takes one request at a time"
        else:
            what = f'different units, "{earlier.unit.key}" and "{drive.unit.key}"'
            help_ = f"correct the {key} of one of them, or put both into one unit"
        message = f'drives "{earlier.key}" and "{drive.key}" have the same {key}, but {what}'
        notes = (Note("first use", key_or_value(plan, (*earlier.path, key))),)
        yield Diagnostic("PG260", message, given.span, help=help_, notes=notes)


def shared_address(plan: DrivePlan) -> Iterator[Diagnostic]:
    """PG221: one drive object has two names."""
    first: dict[tuple[int, int], PlannedDrive] = {}
    key = "address" if plan.target.classic else "hardware_id"
    for drive in plan.drives:
        earlier = first.setdefault((drive.id_value, drive.drive_object), drive)
        given = node_at(plan, (*drive.path, key))
        if earlier is drive or earlier.unit is not drive.unit or given is None:
            continue
        axes = "" if drive.device.drive_objects is not None else f"; two axes of it: {_one_unit(earlier, drive)}"
        yield Diagnostic(
            "PG221",
            f'drives "{earlier.key}" and "{drive.key}" have the same {key} and the same drive object',
            given.span,
            Severity.WARNING,
            help=f'use "{earlier.key}" for both, or correct the {key} or the drive_object{axes}',
            notes=(Note("first use", key_or_value(plan, (*earlier.path, key))),),
        )
