"""A simulated drive object with every parameter that the lists of a device name for it."""

from __future__ import annotations

from plcgen.ds47.catalogue.own_list import LISTS
from plcgen.ds47.device import Device, Parameter
from plcgen.ds47.sim.bench import behaviour_of
from plcgen.ds47.sim.drive import Drive
from plcgen.ds47.sim.parameters import DriveObject, SimulatedParameter
from plcgen.ds47.types import read_type
from plcgen.ds47.wire import formats
from plcgen.ds47.wire.bico import parse_bico
from plcgen.ds47.wire.formats import FormatKind, Value, integer_range

SETS = {"CDS": 2, "DDS": 2, "EDS": 1, "MDS": 1, "PDS": 1}
"""Data sets that it has: r0050 to r0054 and p0170 to p0187 say so in a drive."""
_OWN = 300
"""Elements of r0980 (S210: 300, the last one leads to the next list)."""


def listed_drive(device: Device, drive_object: int, object_type: str) -> Drive:
    """A drive with that object: factory settings where the list has one, else the value nearest to 0; r0980 as well."""
    numbers = [one for one in device.listed(object_type) if one not in LISTS]
    known = [(number, device.find(number, object_type)) for number in numbers]
    parameters = {number: _simulated(one) for number, one in known if one is not None}
    parameters |= {one.pnu: one for one in _own_lists(sorted(parameters))}
    return Drive(behaviour_of(device), [DriveObject(drive_object, parameters)])


def _simulated(one: Parameter) -> SimulatedParameter:
    fmt, octets = read_type(one.type or "Unsigned32")
    count = one.array or SETS.get(one.indexes, 1)
    value: Value
    if fmt.kind is FormatKind.TEXT:
        value = "".ljust(octets)
    elif fmt.kind in {FormatKind.OCTETS, FormatKind.OPAQUE}:
        value = bytes(octets or fmt.size)
    elif fmt.kind is FormatKind.BOOLEAN:
        value = bool(one.default)
    else:
        value = _number(one, fmt)
    return SimulatedParameter(
        pnu=one.pnu,
        format=fmt,
        values=[value] * (1 if octets else count),
        name=one.title[:16],
        array=one.array is not None or one.indexes in SETS,
        read_only=one.access == "r",
    )


def _number(one: Parameter, fmt: formats.Format) -> float:
    source = parse_bico(one.default) if isinstance(one.default, str) else None
    known = source.value if source else one.default if isinstance(one.default, int | float) else 0
    low, high = integer_range(fmt) or (-3e38, 3e38)
    low, high = max(low, one.minimum or low), min(high, one.maximum or high)
    value = min(max(known, low), high)
    return float(value) if fmt.kind is FormatKind.FLOAT else int(value)


def _own_lists(numbers: list[int]) -> list[SimulatedParameter]:
    """r0980 and those it leads to: 299 numbers each and that of the next one, zeros at the end."""
    room = _OWN - 1
    parts = [numbers[at : at + room] for at in range(0, len(numbers), room)]
    found = []
    for at, part in enumerate(parts):
        values: list[Value] = [*part, *([LISTS[at + 1]] if at + 1 < len(parts) else [])]
        values += [0] * (_OWN - len(values))
        found.append(SimulatedParameter(LISTS[at], formats.by_name("Unsigned16"), values, array=True, read_only=True))
    return found
