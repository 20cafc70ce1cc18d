"""What the stimulus sends: telegrams with their parameters, built by hand from the tables of data set 47."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass, replace

from plcgen.ds47.sim.behaviour import Behaviour
from plcgen.ds47.sim.drive import Drive
from plcgen.ds47.sim.parameters import DriveObject, SimulatedParameter
from plcgen.ds47.wire.formats import FORMATS, Format, FormatKind, by_name, pack_values, padded, unpack_values

HEADER, ADDRESS = 4, 6
REAL, BYTES, WORDS16, LONG = (by_name(name) for name in ("FloatingPoint", "Unsigned8", "Integer16", "Unsigned32"))


@dataclass(frozen=True, slots=True)
class Wanted:
    """One parameter of a telegram: number, format, number of values from subindex 0 on.

    ``most``: its type comes from the answer, and so many bytes of values are kept; 0 if the type is known.
    """

    pnu: int
    format: Format
    count: int = 1
    most: int = 0

    @property
    def size(self) -> int:
        """Bytes of the values."""
        return self.count * self.format.size

    @property
    def expectation(self) -> int:
        """What the job tells the channel: 16#ttnn00bb, type, number of values, bytes."""
        return (0 if self.most else self.format.code) << 24 | self.count << 16 | self.room

    @property
    def room(self) -> int:
        """Bytes of the values that are kept in an answer."""
        return self.most or self.size


@dataclass(frozen=True, slots=True)
class Letter:
    """One telegram: a change (``writes``) or a request of its parameters."""

    writes: bool
    parts: tuple[Wanted, ...]

    @property
    def service(self) -> int:
        """Request id."""
        return 2 if self.writes else 1

    @property
    def length(self) -> int:
        """Bytes of the request."""
        values = sum(2 + padded(part.size) for part in self.parts) if self.writes else 0
        return HEADER + ADDRESS * len(self.parts) + values

    @property
    def answer(self) -> int:
        """Bytes of a good answer."""
        return HEADER if self.writes else HEADER + sum(2 + padded(part.room) for part in self.parts)

    @property
    def blocks(self) -> list[tuple[int, int]]:
        """First byte and length of every value block of a good answer to a request."""
        found, at = [], HEADER
        for part in self.parts:
            size = 2 + padded(part.room)
            found.append((at, size))
            at += size
        return found

    def request(self, drive_object: int, values: Sequence[bytes]) -> bytes:
        """The telegram with reference 0."""
        data = bytes((0, self.service, drive_object, len(self.parts)))
        for part in self.parts:
            data += bytes((0x10, part.count)) + part.pnu.to_bytes(2) + bytes(2)
        for part, value in zip(self.parts, values, strict=True) if self.writes else ():
            data += bytes((part.format.code, part.count)) + value + bytes(len(value) % 2)
        return data


@dataclass(frozen=True, slots=True)
class Errand:
    """What one job does: its telegrams. ``once``: a trigger; ``pinned``: its telegram lies in data blocks."""

    key: str
    letters: tuple[Letter, ...]
    once: bool = False
    pinned: bool = False

    @property
    def writes(self) -> bool:
        """Whether it changes values."""
        return self.letters[0].writes

    def fits(self, last: int) -> bool:
        """Whether all of it fits into records of that many bytes, less one."""
        return all(max(letter.length, letter.answer) <= last + 1 for letter in self.letters)


ONE = (Wanted(1120, REAL),)
THREE = (Wanted(1120, REAL), Wanted(1121, BYTES, 3), Wanted(1122, WORDS16, 2))
REST = (Wanted(1123, LONG), Wanted(1124, BYTES))
READ_ONE = Errand("read one", (Letter(writes=False, parts=ONE),))
WRITE_ONE = Errand("write one", (Letter(writes=True, parts=ONE),))
READ_OPEN = Errand("read without types", (Letter(writes=False, parts=tuple(replace(part, most=8) for part in THREE)),))
READ_SPLIT = Errand("read in two telegrams", (Letter(writes=False, parts=THREE), Letter(writes=False, parts=REST)))
WRITE_SPLIT = Errand("write in two telegrams", (Letter(writes=True, parts=THREE), Letter(writes=True, parts=REST)))
TRIGGER = Errand("trigger", (Letter(writes=True, parts=(Wanted(1125, BYTES),)),), once=True)
READ_PINNED = Errand("read, pinned", (Letter(writes=False, parts=THREE),), pinned=True)
WRITE_PINNED = Errand("write, pinned", (Letter(writes=True, parts=THREE),), pinned=True)
MATRIX = (READ_ONE, WRITE_ONE, READ_SPLIT, WRITE_SPLIT, TRIGGER)
"""Jobs that go through every fault."""


def full(size: int, blocks: int) -> tuple[Errand, Errand]:
    """A read with as many parameters and a write with as many bytes as a record of this size has room for."""
    count = min(blocks, (size - HEADER) // ADDRESS)
    octets = by_name("OctetString")
    rest = size - HEADER - 4 * (count - 1) - 2
    read = (*(Wanted(3000 + number, BYTES) for number in range(1, count)), Wanted(3000, octets, rest))
    write = (Wanted(3100, octets, size - HEADER - ADDRESS - 2),)
    return (
        Errand("read, full record", (Letter(writes=False, parts=read),)),
        Errand("write, full record", (Letter(writes=True, parts=write),)),
    )


def every_format(size: int) -> list[Errand]:
    """A read and a write of every format, with one value and with three, or as many as a record of this size holds."""
    found = []
    for number, fmt in enumerate(fmt for fmt in FORMATS if fmt.writable):
        room = size - HEADER - 2 * (ADDRESS + 2) - padded(fmt.size)
        parts = (Wanted(2000 + number, fmt), Wanted(2100 + number, fmt, min(3, room // fmt.size)))
        for writes in (False, True):
            letters = (Letter(writes=writes, parts=parts), Letter(writes=writes, parts=parts[::-1]))
            found.append(Errand(f"{'write' if writes else 'read'} {fmt.name}", letters))
    return found


def random_values(part: Wanted, draw: random.Random) -> bytes:
    """Wire bytes of some values."""
    if part.format.kind is FormatKind.FLOAT:
        return pack_values(part.format, [float(draw.randint(-(10**6), 10**6)) / 4 for _ in range(part.count)])
    if part.format.kind is FormatKind.BOOLEAN:
        return bytes(draw.getrandbits(1) for _ in range(part.count))
    if part.format.kind is FormatKind.TEXT:
        return bytes(draw.randint(65, 90) for _ in range(part.count))
    return draw.randbytes(part.size)


def store(parameter: SimulatedParameter, part: Wanted, data: bytes) -> None:
    """Put wire bytes into a parameter of the drive."""
    parameter.values = list(unpack_values(part.format, part.count, data))


def parameter_bytes(parameter: SimulatedParameter) -> bytes:
    """Wire bytes of the values of a parameter of the drive."""
    return pack_values(parameter.format, parameter.values)


def drive_for(errands: Sequence[Errand], objects: Sequence[int]) -> Drive:
    """A drive with the parameters of all errands in each of its objects; it takes data record 47."""
    parts = {part.pnu: part for errand in errands for letter in errand.letters for part in letter.parts}
    behaviour = Behaviour(record_indexes=(47,))
    return Drive(behaviour, [DriveObject(number, {p.pnu: _parameter(p) for p in parts.values()}) for number in objects])


def _parameter(part: Wanted) -> SimulatedParameter:
    values = unpack_values(part.format, part.count, random_values(part, random.Random(part.pnu)))  # test values
    array = not part.format.is_string and part.count > 1
    return SimulatedParameter(part.pnu, part.format, list(values), array=array)
