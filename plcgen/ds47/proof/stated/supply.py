"""Values that occur nowhere else: of inputs, records and what the device holds."""

from __future__ import annotations

import datetime as dt
import itertools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

from plcgen.ds47.proof.stated.rig import StatedRig
from plcgen.oracles.spec.ds47.course import Difference
from plcgen.oracles.spec.ds47.statement import FromClock, FromInput, FromRecord, Number, Source, StatedAccess, StatedJob
from plcgen.oracles.spec.ds47.types import is_float, is_signed, packed, size_of, unpacked
from plcgen.s7.layout.layout import Entry
from plcgen.s7.types.data_types import ArrayType, Elementary

BOOLEAN = "Boolean"
BIT_STRINGS: Mapping[str, int] = MappingProxyType({"BYTE": 8, "WORD": 16, "DWORD": 32, "LWORD": 64})
"""Types without a sign, with their bits."""
SPACING = 1.5
DAYS = "days since 1970-01-01"
DTL_BYTES = 12
"""A DATE_AND_TIME has 8."""
EPOCH = dt.date(1970, 1, 1)
MOMENTS = (
    (dt.date(2031, 7, 17), 43_200_017),
    (dt.date(2000, 1, 1), 0),
    (dt.date(2024, 2, 29), 86_399_999),
    (dt.date(2026, 3, 1), 1),
    (dt.date(2089, 12, 31), 3_600_000),
)
"""Days and milliseconds: ends of what a drive takes, of months and of days."""


def sources(job: StatedJob) -> dict[Source, StatedAccess]:
    """Every input and record member of a job with the access that it supplies; bits of words are of type Boolean."""
    found: dict[Source, StatedAccess] = {}
    for step in job.steps:
        for access in step.accesses:
            for source in (*access.values, *(value for _, value in access.bits)):
                if isinstance(source, FromInput | FromRecord | FromClock):
                    found.setdefault(source, access)
    return found


def two_valued(job: StatedJob) -> list[Source]:
    """Inputs that have two values only."""
    found = {value: None for s in job.steps for a in s.accesses for _, value in a.bits if isinstance(value, FromInput)}
    plain = (
        v for s in job.steps for a in s.accesses if a.type == BOOLEAN for v in a.values if isinstance(v, FromInput)
    )
    return list(dict.fromkeys([*found, *plain]))


class Unique:
    """Numbers of a type, none of them twice as far as the type allows: negative if there is a sign, else large."""

    def __init__(self) -> None:
        self._count = itertools.count(1)
        self._moments = itertools.cycle(MOMENTS)

    def moment(self) -> tuple[dt.date, int]:
        """A day that was not used a moment ago, and milliseconds of it."""
        return next(self._moments)

    def number(self, type_: str, low: Number | None = None, high: Number | None = None) -> Number:
        """The next one, between two limits."""
        count = next(self._count)
        if low is not None or high is not None:
            return limited(type_, count, low, high)
        if is_float(type_):
            return float(unpacked(type_, packed(type_, SPACING * count + 0.25)))
        bits = 8 * size_of(type_)
        if is_signed(type_):
            return -(count % (1 << min(bits - 1, 20))) - 1
        if type_ == BOOLEAN:
            return count % 2
        top = 1 << (bits - 1)
        return top + count % top


def limited(type_: str, count: int, low: Number | None, high: Number | None) -> Number:
    """Number ``count`` inside limits, another one for each count as far as there are so many."""
    if is_float(type_):
        first = float(low) if low is not None else float(high or 0.0) - 1000.0
        last = float(high) if high is not None else first + 1000.0
        return float(unpacked(type_, packed(type_, first + (last - first) * (0.1 + 0.8 * (count * 0.61803 % 1.0)))))
    bits = 8 * size_of(type_)
    bottom, top = (-(1 << (bits - 1)), (1 << (bits - 1)) - 1) if is_signed(type_) else (0, (1 << bits) - 1)
    first = int(low) if low is not None else bottom
    last = int(high) if high is not None else top
    return first + count % (last - first + 1)


@dataclass
class Supply:
    """What the inputs of a job stand at, and how they get there."""

    rig: StatedRig
    job: StatedJob
    unique: Unique
    record: int = 1
    values: dict[Source, Number | bytes] = field(default_factory=dict)
    missing: list[Difference] = field(default_factory=list)
    """Members that should be there and are not."""

    def draw(self, bits: Mapping[Source, int] | None = None) -> dict[Source, Number | bytes]:
        """Another value for everything; ``bits`` of those that have only two."""
        self.values.clear()
        moment = None
        for source, access in sources(self.job).items():
            if isinstance(source, FromClock):
                moment = moment or self.unique.moment()
                self.values[source] = (moment[0] - EPOCH).days if source.part == DAYS else moment[1]
            elif bits is not None and source in bits:
                self.values[source] = bits[source]
            elif isinstance(source, FromRecord):
                self.values[source] = self.unique.number(access.type, source.minimum, source.maximum)
            elif access.string:
                self.values[source] = bytes((0x41 + len(self.values) % 26,))
            else:
                self.values[source] = self.unique.number(access.type)
        return self.values

    def as_delivered(self) -> dict[Source, Number | bytes]:
        """Start values of inputs and of the first record."""
        self.values.clear()
        for source in sources(self.job):
            if isinstance(source, FromInput) and isinstance(source.start, int | float):
                self.values[source] = source.start
            elif isinstance(source, FromRecord) and isinstance(source.values[self.record - 1], int | float):
                self.values[source] = source.values[self.record - 1]  # type: ignore[assignment]
        return self.values

    def store(self) -> None:
        """Write the values where the program would."""
        self.missing.clear()
        for source, access in sources(self.job).items():
            value = self.values[source]
            if isinstance(source, FromInput):
                self.put(f"{self.rig.member(self.job)}.{source.name}", source.index, value, access)
            elif isinstance(source, FromRecord):
                self.put(self.rig.record_path(source.recipe, self.record, source.member), source.index, value, access)
        if self.job.recipe:
            self.rig.cpu[f"{self.rig.member(self.job)}.recordNumber"] = self.record
        clock = {source.part: value for source, value in self.values.items() if isinstance(source, FromClock)}
        if clock:
            self._set_clock(int(clock[DAYS]), int(next(v for part, v in clock.items() if part != DAYS)))

    def put(self, path: str, index: int | None, value: Number | bytes, access: StatedAccess) -> None:
        """Store one value as a number of the declared type, octets where the CPU has no such type."""
        try:
            self._put(path, self.entry(path), index, value, access)
        except (KeyError, ValueError, TypeError):
            self.missing.append(Difference(access.place, f"a member {path} for {access.written}", "none"))

    def _put(self, path: str, entry: Entry, index: int | None, value: Number | bytes, access: StatedAccess) -> None:
        if isinstance(entry.type, ArrayType) and index is not None and not octets_only(entry, access):
            first = entry.type.bounds[0][0] if access.string else 0  # the octets of a text are counted from 1
            path = f"{path}[{first + index}]"
        elif isinstance(entry.type, ArrayType):
            self._put_octets(entry, path, 0 if index is None else index - access.index, value, access)
            return
        self.rig.cpu[path] = to_plc(value, declared(entry))

    def _put_octets(self, entry: Entry, path: str, at: int, value: Number | bytes, access: StatedAccess) -> None:
        data = value if isinstance(value, bytes) else packed(access.type, value)
        memory = self.rig.cpu.db(path.split('"')[1])
        start = entry.byte + at * len(data)
        memory[start : start + len(data)] = data

    def entry(self, path: str) -> Entry:
        """Where a path leads. Raises KeyError."""
        _, member, _, _ = self.rig.cpu.symbols.find(path)
        if member is None:
            raise KeyError(path)
        return member[2]

    def _set_clock(self, days: int, milliseconds: int) -> None:
        """The time as a DTL or DATE_AND_TIME."""
        path = f"{self.rig.member(self.job)}.utc"
        entry, date = self.entry(path), EPOCH + dt.timedelta(days=days)
        seconds, rest = divmod(milliseconds, 1000)
        clock = seconds // 3600, seconds // 60 % 60, seconds % 60
        weekday = date.isoweekday() % 7 + 1
        if entry.size // 8 == DTL_BYTES:
            data = bytes((*divmod(date.year, 256), date.month, date.day, weekday, *clock))
            data += (rest * 1_000_000).to_bytes(4)
        else:
            text = f"{date.year % 100:02}{date.month:02}{date.day:02}{clock[0]:02}{clock[1]:02}{clock[2]:02}"
            data = bytes.fromhex(f"{text}{rest:03}{weekday}")
        memory = self.rig.cpu.db(path.split('"')[1])
        memory[entry.byte : entry.byte + len(data)] = data


def declared(entry: Entry) -> str:
    """Name of the elementary type of a member or of its elements."""
    type_ = entry.type.element if isinstance(entry.type, ArrayType) else entry.type
    return type_.name.upper() if isinstance(type_, Elementary) else ""


def octets_only(entry: Entry, access: StatedAccess) -> bool:
    """Whether an array stands for values of a type that the CPU does not have."""
    if not isinstance(entry.type, ArrayType) or access.size == 1:
        return False
    ((first, last),) = entry.type.bounds[:1]
    return declared(entry) == "BYTE" and last - first + 1 == access.size * access.count


def to_plc(value: Number | bytes, type_: str) -> Any:
    """A number for a member of a declared type; a bit string takes the pattern of a negative one."""
    if isinstance(value, bytes):
        return value.decode("latin-1") if type_ == "CHAR" else value[0]
    if type_ in BIT_STRINGS:
        return int(value) & ((1 << BIT_STRINGS[type_]) - 1)
    return bool(value) if type_ == "BOOL" else value


def flat(value: Any) -> Iterator[Any]:
    """The values of a tree in their order."""
    if isinstance(value, dict):
        for one in value.values():
            yield from flat(one)
    elif isinstance(value, list | tuple):
        for one in value:
            yield from flat(one)
    else:
        yield value
