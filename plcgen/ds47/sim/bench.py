"""The test bench: a simulated drive that has exactly the parameters the jobs of a project use."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from plcgen.ds47.device import Device
from plcgen.ds47.device import Parameter as CatalogueParameter
from plcgen.ds47.kind import Poll
from plcgen.ds47.messages import CODES, all_messages
from plcgen.ds47.plan.access import Use
from plcgen.ds47.plan.nouns import DrivePlan, PlannedDrive
from plcgen.ds47.sim.behaviour import Behaviour
from plcgen.ds47.sim.drive import Drive
from plcgen.ds47.sim.faults import Fault
from plcgen.ds47.sim.parameters import DriveObject, SimulatedParameter, ValueLimits
from plcgen.ds47.wire.bico import parse_bico
from plcgen.ds47.wire.formats import Format, FormatKind, Value, unpack_values

DRAWN = 997
"""So many values of a parameter are drawn: a prime, so that none repeats at a distance of a wrong index."""
SAVING_MS = 300
"""How long the simulated drive saves."""


def build_drive(plan: DrivePlan, drive: PlannedDrive, faults: Iterable[Fault] = (), *, distinct: bool = False) -> Drive:
    """A drive with the profile's behaviour. ``distinct`` gives every value another content."""
    return build_unit(drive.device, {drive.drive_object: used_of(plan, drive)}, faults, distinct=distinct)


def used_of(plan: DrivePlan, drive: PlannedDrive) -> list[Use]:
    """What the jobs use of a drive object, but for what it does not have: it answers 00h."""
    uses = (use for job in plan.jobs if job.drive is drive for use in job.own)
    own = plan.own_numbers(drive)
    return [
        use
        for use in uses
        if drive.device.lacks(use.parameter.pnu, drive.object_type) != "surely"
        or (use.parameter.pnu in own and drive.device.find(use.parameter.pnu) is None)
    ]


def build_unit(
    device: Device, uses: Mapping[int, Iterable[Use]], faults: Iterable[Fault] = (), *, distinct: bool = False
) -> Drive:
    """A unit with the parameters that are used of each of its drive objects."""
    objects = [DriveObject(number, _parameters(used, device, distinct=distinct)) for number, used in uses.items()]
    local = objects[0].number if len(objects) == 1 else None
    return Drive(behaviour_of(device, local), objects, faults)


def behaviour_of(device: Device, local_object: int | None = None) -> Behaviour:
    """How the device of a profile behaves; ``local_object`` is the one that record B02Eh addresses."""
    return Behaviour(
        error_words=device.error_words,
        answer_format=device.answer_format,
        takes=device.takes,
        record_indexes=tuple(device.record_index.values()),
        local_object=local_object,
        max_parameters=device.max_parameters,
        max_elements=device.max_elements,
        record_limit=device.record_limit,
        strict_length=device.strict_length,
        error_table=device.error_table,
    )


def _parameters(uses: Iterable[Use], device: Device, *, distinct: bool) -> dict[int, SimulatedParameter]:
    by_pnu: dict[int, list[Use]] = {}
    for use in uses:
        by_pnu.setdefault(use.parameter.pnu, []).append(use)
    return {
        pnu: _parameter(group, device, seed, distinct=distinct) for seed, (pnu, group) in enumerate(by_pnu.items(), 1)
    }


def _parameter(group: list[Use], device: Device, seed: int, *, distinct: bool) -> SimulatedParameter:
    use = group[0]
    fmt, definition = use.format, use.parameter
    highest = max(u.subindex + (1 if fmt.is_string else u.count) for u in group)
    array = definition.array is not None or highest > 1
    count = max(definition.array or 1, highest)
    drawn = [_value(use, definition, seed * 16 + index, distinct=distinct) for index in range(min(count, DRAWN))]
    if definition.pnu in CODES and device.messages and not distinct:
        drawn = _codes(device, CODES[definition.pnu], count)
    effect = next((poll.effect for one in group if (poll := one.as_(Poll))), None)
    limits = ValueLimits(definition.minimum, definition.maximum) if fmt.kind in _NUMERIC else ValueLimits()
    return SimulatedParameter(
        pnu=definition.pnu,
        format=fmt,
        values=repeated(drawn, count),
        name=definition.name[:16],
        array=array,
        limits=limits,
        read_only=definition.access == "r",
        clears_after=None if effect is None else SAVING_MS,
        saves=effect if effect in {"unit", "object"} else "",
        acknowledges=effect == "faults",
    )


def _codes(device: Device, kind: str, count: int) -> list[Value]:
    """A buffer with two messages that the drive can have; where only one fits, the first of them."""
    known: list[Value] = [one.number for one in all_messages(device.messages) if one.kind == kind]
    return [known[len(known) // 2], known[len(known) // 3], *[0] * (count - 2)][:count]


def repeated(drawn: list[Value], count: int) -> list[Value]:
    """Values of ``count`` indexes out of those that were drawn; a string is one value, however many octets it has."""
    return (drawn * -(-count // DRAWN))[:count] if len(drawn) == DRAWN else drawn


_NUMERIC = {FormatKind.SIGNED, FormatKind.UNSIGNED, FormatKind.FLOAT}


def _value(use: Use, definition: CatalogueParameter, number: int, *, distinct: bool) -> Value:
    """Content of one element: a value that a drive had, the factory setting, or a number within the limits."""
    fmt = use.format
    if fmt.is_string or fmt.kind is FormatKind.OPAQUE:
        octets = use.count if fmt.is_string else fmt.size
        return _octets(fmt, definition, number, octets, distinct=distinct)
    known = definition.default if definition.observed is None else definition.observed
    if fmt.kind is FormatKind.BOOLEAN:
        return bool(number % 2) if distinct else bool(known)
    if not distinct and isinstance(known, int | float) and not isinstance(known, bool):
        return known
    if not distinct and isinstance(known, str):
        source = parse_bico(known)
        return source.value if source else 0
    low = definition.minimum if definition.minimum is not None else 0.0
    high = definition.maximum if definition.maximum is not None else low + 100.0
    if fmt.kind is FormatKind.FLOAT:
        return low + (high - low) * (number % 97) / 128.0
    return int(low) + number % (int(min(high - low, 100.0)) + 1)


def _octets(fmt: Format, definition: CatalogueParameter, number: int, count: int, *, distinct: bool) -> Value:
    text = definition.default if isinstance(definition.default, str) and not distinct else ""
    if fmt.kind is FormatKind.TEXT:
        return (text or "".join(chr(65 + (number + i) % 26) for i in range(count))).ljust(count)[:count]
    data = bytes.fromhex(text) if text else bytes((number + i) % 256 for i in range(count))
    return unpack_values(fmt, count if fmt.is_string else 1, data.ljust(count, b"\0")[:count])[0]
