"""Rules about drive objects and what they have: a parameter exists in those that its list names."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from plcgen.base.diagnostics import Diagnostic, Severity, Span
from plcgen.ds47.objects import CONTROL_UNIT_TYPE, singular, spoken
from plcgen.ds47.registry import kinds
from plcgen.ds47.rules.places import parameter_span, value_span
from plcgen.ds47.wire.bico import SELF, BicoSource, read_bico
from plcgen.project.rules.places import key_or_value

if TYPE_CHECKING:
    from collections.abc import Iterator

    from plcgen.ds47.plan.access import Use
    from plcgen.ds47.plan.nouns import DriveJob, DrivePlan, PlannedDrive


def no_types(plan: DrivePlan) -> Iterator[Diagnostic]:
    """PG217: a type of drive object for a device that has only one."""
    for drive in plan.drives:
        if drive.object_type and drive.device.object_types is None:
            yield Diagnostic(
                "PG217",
                f"{drive.device.title} has no types of drive objects",
                key_or_value(plan, (*drive.path, "object_type")),
                help="remove object_type: the profile does not say which drive objects have a parameter",
            )


def missing(plan: DrivePlan) -> Iterator[Diagnostic]:
    """PG262: the drive object has no such parameter, or none that a source names.

    An error where the list of the object was read whole, else a warning: lists name the parameter for others alone.
    """
    for shape in plan.shapes:
        told: set[tuple[int, int, str]] = set()
        for job in plan.instances(shape):
            own = plan.own_numbers(job.drive)
            for use in job.own if job.clock is None and not job.serves else ():  # PG254 says it of a clock
                for needed in _needed(plan, job, use):
                    if needed.pnu in own and job.drive.device.find(needed.pnu) is None:
                        continue  # the spec says that this drive has it
                    how = job.drive.device.lacks(needed.pnu, needed.object_type)
                    key = (use.position, needed.pnu, needed.object_type)
                    if how and key not in told:
                        told.add(key)
                        yield _missing(plan, job, needed, sure=how == "surely")


@dataclass(frozen=True, slots=True)
class _Needed:
    """A parameter that a drive object must have; ``of`` takes its signal from ``source``, which names the parameter."""

    pnu: int
    drive_object: int
    object_type: str
    drive: PlannedDrive | None
    span: Span
    of: str = ""
    source: BicoSource | None = None


def _needed(plan: DrivePlan, job: DriveJob, use: Use) -> Iterator[_Needed]:
    """The parameter of a use, and those that its constant sources name in drive objects that are known."""
    drive = job.drive
    yield _Needed(use.parameter.pnu, drive.drive_object, drive.object_type, drive, parameter_span(plan, use))
    if not (use.sources and use.constant):
        return
    others = {one.drive_object: one for one in plan.drives if one.unit is drive.unit}
    for at in range(0, len(use.data), use.format.size):
        source = read_bico(int.from_bytes(use.data[at : at + use.format.size]))
        number = drive.drive_object if source.drive_object == SELF else source.drive_object
        other = drive if number == drive.drive_object else others.get(number)
        known = drive.device.object_type(number)
        if other is not None or known == CONTROL_UNIT_TYPE:
            object_type = other.object_type if other is not None else known
            yield _Needed(source.pnu, number, object_type, other, value_span(plan, use), use.label, source)


def _missing(plan: DrivePlan, job: DriveJob, needed: _Needed, *, sure: bool) -> Diagnostic:
    known, has = job.drive.device.find(needed.pnu), "has" if sure else "may have"
    severity = Severity.ERROR if sure else Severity.WARNING
    if known is None:
        source = "; ".join(job.drive.device.absent(needed.pnu, needed.object_type))
        message = f"drive object {needed.drive_object} {has} no P{needed.pnu}: {source}"
        help_ = "the drive would answer error 00h: look for the parameter in its list"
        return Diagnostic("PG262", message, needed.span, severity, help=help_)
    name = known.label
    shown = f" ({needed.drive.key})" if needed.drive is not None else ""
    where = f"drive object {needed.drive_object}{shown} {has} no {name} ({known.title})"
    source = f", from which {needed.of} is to take its signal" if needed.of else ""
    message = f"{where}{source}: lists name it for {spoken(known.objects)}{known.doubt('objects')}"
    return Diagnostic("PG262", message, needed.span, severity, help="; ".join(_helps(plan, job, needed)))


def _helps(plan: DrivePlan, job: DriveJob, needed: _Needed) -> Iterator[str]:
    device, pnu = job.drive.device, needed.pnu
    control = device.object_types.control_unit if device.object_types is not None else 0
    for other, does in (kind.instead[pnu] for kind in kinds() if pnu in kind.instead):
        if not device.lacks(other, needed.object_type):
            yield does.format(drive=job.drive.key)
    others = (one for one in plan.drives if one.unit is job.drive.unit and one.drive_object != needed.drive_object)
    its = next((one for one in others if not device.lacks(pnu, one.object_type)), None)
    if needed.source is not None and not device.lacks(pnu, CONTROL_UNIT_TYPE):
        yield f"{replace(needed.source, drive_object=control)} is that of the control unit"
    elif its is not None:
        yield f'"{its.key}" of the same unit has it'
    elif (known := device.find(pnu)) is not None and known.objects == {CONTROL_UNIT_TYPE}:
        yield f"add the control unit to the unit as a drive, with drive_object: {control}"
    yield f"if drive object {needed.drive_object} is no {singular(needed.object_type)}, say what it is: object_type"
