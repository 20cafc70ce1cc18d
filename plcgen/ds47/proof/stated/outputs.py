"""What the block shows after a run: numbers in their declared types, lists, records."""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping
from typing import Any

from plcgen.ds47.proof.stated.rig import StatedRig
from plcgen.ds47.proof.stated.supply import BIT_STRINGS, declared, flat, octets_only
from plcgen.oracles.spec.ds47.course import Difference, StatedCourse, value_bytes
from plcgen.oracles.spec.ds47.statement import FromRecord, Number, StatedAccess, StatedJob, StatedList
from plcgen.oracles.spec.ds47.types import ANY, ROOM, code_of, packed, unpacked

GROUP, PLACES = 8, 32
REAL = struct.Struct(">f")


def shown_numbers(rig: StatedRig, path: str, access: StatedAccess) -> list[Number | str]:
    """The values of a member; octets of a type that the CPU does not have are put together."""
    _, member, _, _ = rig.cpu.symbols.find(path)
    values = list(flat(rig.cpu[path]))
    if member is not None and octets_only(member[2], access):
        data = bytes(values)
        size = access.size
        return [unpacked(access.type, data[at : at + size]) for at in range(0, len(data), size)]
    return [ord(value) if isinstance(value, str) else value for value in values]


def expected_numbers(rig: StatedRig, path: str, access: StatedAccess, data: list[bytes]) -> list[Number | str]:
    """What the values of the answer are in the declared type: bit strings have no sign."""
    _, member, _, _ = rig.cpu.symbols.find(path)
    entry = member[2] if member is not None else None
    pattern = entry is not None and not octets_only(entry, access) and declared(entry) in BIT_STRINGS
    numbers = [unpacked(access.type, one) for one in data]
    return [n & ((1 << 8 * access.size) - 1) if pattern and isinstance(n, int) else n for n in numbers]


def output_differences(rig: StatedRig, job: StatedJob, course: StatedCourse) -> Iterator[Difference]:
    """Outputs that do not show what the device answered."""
    for step_number, step in enumerate(course.steps):
        for number, access in enumerate(step.accesses):
            data = course.answer(step_number, number)
            if access.type == ANY and access.output and data[0]:
                type_ = rig.answered_type(job, access)
                yield from _untyped(rig, f"{rig.member(job)}.{access.output}", access, type_, data[0])
            elif access.output and not access.write and all(data):
                yield from _output(rig, f"{rig.member(job)}.{access.output}", access, data)
            for bit, name in access.shown if all(data) else ():
                path, wanted = f"{rig.member(job)}.{name}", bool(int.from_bytes(data[0]) >> bit & 1)
                if rig.cpu[path] is not wanted:
                    yield Difference(access.place, f"{path} = {wanted}", f"{rig.cpu[path]}")


def _output(rig: StatedRig, path: str, access: StatedAccess, data: list[bytes]) -> Iterator[Difference]:
    try:
        found, wanted = shown_numbers(rig, path, access), expected_numbers(rig, path, access, data)
    except KeyError:
        yield Difference(access.place, f"an output {path} for {access.written}", "none")
        return
    if found != wanted:
        yield Difference(access.place, f"{path} = {few_shown(wanted)}", few_shown(found))


def _untyped(rig: StatedRig, path: str, access: StatedAccess, type_: str, data: bytes) -> Iterator[Difference]:
    """A value whose type only the answer tells: octets, format, and the number as DINT and as REAL."""
    number = unpacked(type_, data)
    whole = int.from_bytes(data) if type_ in {"FloatingPoint", "DoubleWord"} else int(number)
    dint = 0 if len(data) > REAL.size else (whole + (1 << 31)) % (1 << 32) - (1 << 31)
    wanted = {"": list(data.ljust(ROOM, b"\0")), "Format": code_of(type_), "Dint": dint}
    for name, value in wanted.items():
        found = list(flat(rig.cpu[path])) if not name else rig.cpu[f"{path}{name}"]
        if found != value:
            yield Difference(access.place, f"{path}{name} = {value} of {type_}", f"{found}")
    real = data if type_ in {"FloatingPoint", "DoubleWord"} else REAL.pack(dint)
    shown = REAL.pack(rig.cpu[f"{path}Real"])
    if shown != real:
        yield Difference(access.place, f"{path}Real as {real.hex(' ')} of {type_}", shown.hex(" "))


def few_shown(values: list[Number | str]) -> str:
    """A few values."""
    shown = ", ".join(map(str, values[:4]))
    return f"{shown}, .." if len(values) > 4 else shown


# --- records --------------------------------------------------------------------------------------------------


def record_differences(rig: StatedRig, job: StatedJob, course: StatedCourse, number: int) -> Iterator[Difference]:
    """A job that reads into a record fills this one."""
    for place, access in enumerate(course.steps[0].accesses):
        data = course.answer(0, place)
        if all(data):
            yield from _output(rig, rig.record_path(job.recipe, number, access.output), access, data)


def delivered_records(rig: StatedRig, access: StatedAccess, source: FromRecord) -> Iterator[Difference]:
    """Start values of one member of all records."""
    for number, value in enumerate(source.values, 1):
        path = rig.record_path(source.recipe, number, source.member)
        yield from start_difference(rig, path, source.index, value, access)


def start_difference(
    rig: StatedRig, path: str, index: int | None, value: Number | str, access: StatedAccess
) -> Iterator[Difference]:
    """A start value that is not the one of the spec."""
    try:
        values = shown_numbers(rig, path, access)
    except KeyError:
        yield Difference(access.place, f"a member {path}", "none")
        return
    at = index - access.index if index is not None and not access.string else index or 0
    found = values[at if at < len(values) else 0]
    if isinstance(value, str):
        return  # what a text is filled up with nobody says
    wanted = value if access.bits else expected_numbers(rig, path, access, [packed(access.type, value)])[0]
    if found != wanted:
        yield Difference(access.place, f"{path} = {wanted} as delivered", f"{found}")


# --- lists ----------------------------------------------------------------------------------------------------


def deviation_differences(
    rig: StatedRig, job: StatedJob, course: StatedCourse, supplied: Mapping[Any, Number | bytes]
) -> Iterator[Difference]:
    """The list of a job that compares."""
    rows = list(deviating(course, supplied))
    member = rig.member(job)
    count, equal = rig.cpu[f"{member}.deviationCount"], rig.cpu[f"{member}.equal"]
    if (count, bool(equal)) != (len(rows), not rows):
        yield Difference(job.place, f"{len(rows)} deviations", f"deviationCount {count}, equal {equal}")
        return
    shown: Any = rig.cpu[f"{member}.deviations"]
    for place, (access, wanted) in enumerate(rows[:PLACES]):
        found = tuple(flat(shown[place])) if place < len(shown) else ()
        if found != wanted:
            yield Difference(access.place, f"deviations[{place + 1}] = {wanted}", f"{found}")
    for place in range(len(rows), len(shown)):
        if any(flat(shown[place])):
            yield Difference(job.place, f"an empty place deviations[{place + 1}]", f"{tuple(flat(shown[place]))}")


Row = tuple[int, int, float, float, int, int]


def deviating(course: StatedCourse, supplied: Mapping[Any, Number | bytes]) -> Iterator[tuple[StatedAccess, Row]]:
    """Values that differ: number, index, both as REAL, both as they are on the wire."""
    for number, access in enumerate(course.steps[0].accesses):
        for at, data in enumerate(course.answer(0, number)):
            wanted = value_bytes(access, at, supplied)
            if not as_good_as(access.type, wanted, data):
                real = [REAL.unpack(REAL.pack(unpacked(access.type, one)))[0] for one in (wanted, data)]
                bits = (int.from_bytes(wanted), int.from_bytes(data))
                yield access, (access.number, access.index + at, real[0], real[1], *bits)


def as_good_as(type_: str, one: bytes, other: bytes) -> bool:
    """Equal, or for floating-point numbers one unit in the last place apart, or both zero."""
    if one == other or type_ not in {"FloatingPoint", "Float64"}:
        return one == other
    top = 1 << (8 * len(one) - 1)
    a, b = (n if n < top else top - n for n in (int.from_bytes(one), int.from_bytes(other)))
    return ((a < 0) == (b < 0) and abs(a - b) <= 1) or {a, b} == {0}


def message_differences(rig: StatedRig, job: StatedJob, course: StatedCourse) -> Iterator[Difference]:
    """The list of messages: latest first, empty places behind, and how many are present."""
    asked = job.listing
    if asked is None:
        return
    step = next(n for n in reversed(range(len(course.steps))) if len(course.steps[n].accesses) == len(asked.columns))
    if course.steps[step].title != "reads the columns":
        step = next(n for n in reversed(range(len(course.steps))) if course.steps[n].title == "reads the columns")
    columns = []
    for number, access in enumerate(course.steps[step].accesses):
        columns.append([unpacked(access.type, data) for data in course.answer(step, number) if data])
    if not all(columns):
        return
    wanted = list(messages(asked, [tuple(row) for row in zip(*columns, strict=True)]))
    member = rig.member(job)
    shown: Any = rig.cpu[f"{member}.{asked.name}"]
    found = [tuple(flat(row)) for row in shown]
    if found != wanted:
        place = next((n for n, (a, b) in enumerate(zip(found, wanted, strict=False)) if a != b), 0)
        rows = [f"{one[place] if place < len(one) else 'no place'}" for one in (wanted, found)]
        yield Difference(job.place, f"{asked.name}[{place + 1}] = {rows[0]}", rows[1])
    present = sum(1 for row in wanted[:GROUP] if row[asked.columns.index("code")])
    if rig.cpu[f"{member}.{asked.count}"] != present:
        yield Difference(job.place, f"{asked.count} = {present}", f"{rig.cpu[f'{member}.{asked.count}']}")


def messages(asked: StatedList, rows: list[tuple[Number, ...]]) -> Iterator[tuple[Number, ...]]:
    """Rows as they are to be shown."""
    code = asked.columns.index("code")
    empty = (0,) * len(asked.columns)
    for group in range(asked.groups):
        own = rows[group * GROUP : (group + 1) * GROUP]
        if asked.every_group or not group:
            own = own[::-1]
        kept = [row for row in own if row[code]]
        yield from (*kept, *[empty] * (GROUP - len(kept)))
