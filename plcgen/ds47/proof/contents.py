"""Values of a job: what drives hold, what inputs are given, and the telegrams that follow from them."""

from __future__ import annotations

import math
import random
import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import timedelta

from plcgen.ds47.plan.access import Part, Use
from plcgen.ds47.plan.nouns import DriveJob, DriveTelegram
from plcgen.ds47.proof import clock_input
from plcgen.ds47.proof.scenario import Contents
from plcgen.ds47.sim.bench import DRAWN, repeated
from plcgen.ds47.sim.drive import Drive
from plcgen.ds47.sim.parameters import Keeps
from plcgen.ds47.wire.formats import Format, FormatKind, Value, find, integer_range, pack_values, padded, unpack_values

SEARCHED = 4096
"""Words that are tried until one is found in which bits may be written."""
ERROR = 0x44
"""A block of an answer that is an error."""
_NUMERIC = {FormatKind.SIGNED, FormatKind.UNSIGNED}


@dataclass(frozen=True, slots=True)
class ValueSet:
    """``held``: the values of the drive's parameters by number; ``given``: wire bytes of every use by position."""

    held: Mapping[int, Sequence[Value]]
    given: Mapping[int, bytes]

    def inputs(self, job: DriveJob) -> list[tuple[str, bytes]]:
        """Members of the block and their wire bytes, a time as the CPU has it."""
        found = [(use.member, self.given[use.position]) for use in job.inputs]
        if job.timed:
            numbers = (int.from_bytes(self.given[use.position]) for use in job.timed)
            found.append((clock_input.TIME, clock_input.clock_bytes(job, *numbers)))
        return found

    def at(self, job: DriveJob, moment: clock_input.Moment) -> ValueSet:
        """The same at another time."""
        numbers = zip(job.timed, clock_input.values(moment), strict=False)
        return ValueSet(self.held, {**self.given, **{use.position: n.to_bytes(4) for use, n in numbers}})

    def requests(self, job: DriveJob, drive_object: int) -> list[bytes]:
        """The telegrams a job must send, with reference 0."""
        return [request(telegram, drive_object, self.given, write=telegram.writes) for telegram in job.telegrams]

    def put(self, drive: Drive, drive_object: int) -> None:
        """Give the drive its values."""
        for pnu, values in self.held.items():
            drive.objects[drive_object].parameters[pnu].values = list(values)


def value_set(job: DriveJob, drive: Drive, drive_object: int, kind: Contents, seed: str, turn: int = 0) -> ValueSet:
    """Values of one kind; ``seed`` tells the random ones apart, ``turn`` says with which odd one to begin."""
    draw = random.Random(seed)  # noqa: S311 - test values
    found = with_bits(job, _value_set(job, drive, drive_object, kind, draw, turn))
    return found if not job.timed else found.at(job, _moment(kind, draw))


def with_bits(job: DriveJob, values: ValueSet) -> ValueSet:
    """The same with words as they must be written: what the drive has, in which only the bits are others.

    Where limits do not allow such a word, the drive has another one.
    """
    held, given = {pnu: list(there) for pnu, there in values.held.items()}, dict(values.given)
    for use in job.uses:
        if not use.bits:
            continue
        low, high = _limits(use, *(integer_range(use.format) or (0, 0)))
        there = held[use.parameter.pnu]
        for old in (there[use.subindex], *range(int(low), int(min(high, low + SEARCHED)))):
            there[use.subindex] = old
            given[use.position] = written(use, taken_values(use, there), given)
            if low <= int(unpack_values(use.format, 1, given[use.position])[0]) <= high:
                break
    return ValueSet(held, given)


def written(word: Use, old: bytes, given: Mapping[int, bytes]) -> bytes:
    """A word in which bits are written: bit 0 is the last one of the last octet."""
    digits = list(f"{int.from_bytes(old):0{8 * len(old)}b}")
    for one in word.bits:
        digits[-1 - (one.bit or 0)] = "1" if given.get(one.position, one.data) == b"\x01" else "0"
    return int("".join(digits), 2).to_bytes(len(old))


def masked(data: bytes, mask: bytes) -> bytes:
    """Those bits that are in a mask."""
    return bytes(octet & own for octet, own in zip(data, mask, strict=True))


def alike(telegram: DriveTelegram, sent: bytes, wanted: bytes) -> bool:
    """Whether a request is the wanted one; its reference and, beside bits that are written, other bits do not count."""
    if not any(part.use.bits for part in telegram.parts):
        return sent[1:] == wanted[1:]
    mask = b"\0" + b"\xff" * (3 + 6 * len(telegram.parts))
    for part in telegram.parts:
        mask += b"\xff\xff" + (part.use.mask if part.use.bits else b"\xff" * part.size) + b"\xff" * (part.size % 2)
    return len(sent) == len(wanted) == len(mask) and masked(sent, mask) == masked(wanted, mask)


def _moment(kind: Contents, draw: random.Random) -> clock_input.Moment:
    """A time that a job may be given."""
    if kind in {"low", "high"}:
        return (clock_input.FIRST, 0) if kind == "low" else (clock_input.LAST, clock_input.DAY_MS - 1)
    days = draw.randint(0, (clock_input.LAST - clock_input.FIRST).days)
    return clock_input.FIRST + timedelta(days=days), draw.randrange(clock_input.DAY_MS)


def _value_set(
    job: DriveJob, drive: Drive, drive_object: int, kind: Contents, draw: random.Random, turn: int
) -> ValueSet:
    parameters = drive.objects[drive_object].parameters
    uses = {use.parameter.pnu: use for use in job.uses}
    if kind == "factory":
        held = {pnu: list(parameters[pnu].defaults) for pnu in uses}
        return ValueSet(held, {use.position: use.data for use in (*job.uses, *job.supplied)})
    if kind == "odd":
        held = {pnu: odd(use, len(parameters[pnu].values), turn) for pnu, use in uses.items()}
        given = {
            use.position: pack_values(use.format, odd(use, _elements(use), turn, given=True)) for use in job.supplied
        }
        return ValueSet(held, {use.position: use.data for use in job.uses} | given)
    held = {}
    for pnu, use in uses.items():
        count = len(parameters[pnu].values)
        held[pnu] = repeated(_sample(use, min(count, DRAWN), draw, kind), count)
    given = {use.position: use.data for use in job.uses}
    given |= {use.position: pack_values(use.format, _sample(use, _elements(use), draw, kind)) for use in job.supplied}
    return ValueSet(held, given)


def request(telegram: DriveTelegram, drive_object: int, given: Mapping[int, bytes], *, write: bool) -> bytes:
    """A request byte by byte, as data set 47 has it: header, addresses, and in a change the values."""
    parts = telegram.parts
    data = bytearray((0, 2 if write else 1, drive_object, len(parts)))
    for part in parts:
        data += bytes((0x10, part.elements)) + part.use.parameter.pnu.to_bytes(2) + part.subindex.to_bytes(2)
    for part in parts if write else ():
        values = piece(part, given[part.use.position])
        data += bytes((part.use.format.code, part.count)) + values + bytes(len(values) % 2)
    return bytes(data)


def piece(part: Part, data: bytes) -> bytes:
    """The wire bytes of a part of a use."""
    size = part.use.format.size
    return data[part.start * size : (part.start + part.count) * size]


def values_of(telegram: DriveTelegram, answer: bytes) -> list[bytes]:
    """Bytes of the values of an answer: 4 bytes of header, then for each part format, count, values, a pad."""
    found, at = [], 4
    for part in telegram.parts:
        found.append(answer[at + 2 : at + 2 + part.size])
        at += 2 + padded(part.size)
    return found


def told(telegram: DriveTelegram, answer: bytes) -> list[tuple[int, bytes]]:
    """Values by place, from 0, of an answer to a read; an error block ends nothing, what is no block does."""
    found: list[tuple[int, bytes]] = []
    if len(answer) < 4 or answer[1] not in {1, 0x81} or answer[3] != len(telegram.parts):
        return found
    at = 4
    for place, part in enumerate(telegram.parts):
        if at + 2 > len(answer):
            return []
        fmt, count = find(answer[at]), answer[at + 1]
        size = 2 * count if answer[at] == ERROR else fmt.size * count if fmt is not None else 0
        fits = fmt is not None and count == part.count and size == part.size
        if part.use.untyped and fmt is not None and fmt.writable and count == 1:
            found.append((place, answer[at + 2 : at + 2 + size].ljust(part.size, b"\0")))
        elif fits and answer[at] in {part.use.format.code, {1: 0x41, 2: 0x42, 4: 0x43}.get(part.use.format.size)}:
            found.append((place, answer[at + 2 : at + 2 + size]))
        at += 2 + padded(size)
    return found if at == len(answer) else []


def held(drive: Drive, drive_object: int, use: Use) -> bytes:
    """Wire bytes of the values of a use in a drive. Raises KeyError."""
    return taken_values(use, drive.objects[drive_object].parameters[use.parameter.pnu].values)


def taken_values(use: Use, values: Sequence[Value]) -> bytes:
    """Wire bytes of those values of a parameter that a use has."""
    return pack_values(use.format, [values[0]] if use.format.is_string else values[use.subindex :][: use.count])


def kept(use: Use, data: bytes, keeps: Sequence[Mapping[int, Keeps]]) -> bytes:
    """What a drive has of the wire bytes of a use, from which it makes others, one after the other."""
    fmt, count = use.format, use.count
    values = list(unpack_values(fmt, count, data))
    for one in keeps:
        if use.parameter.pnu in one:
            first = 0 if fmt.is_string else use.subindex
            values = [one[use.parameter.pnu](index, value) for index, value in enumerate(values, first)]
    return pack_values(fmt, values)


def _sample(use: Use, count: int, draw: random.Random, kind: Contents) -> list[Value]:
    """Values within the limits of a parameter, or the whole range of the type if it has none."""
    fmt, definition = use.format, use.parameter
    if kind in {"low", "high"}:
        return _ends(use, count, high=kind == "high")
    if fmt.is_string:
        least, most = (65, 90) if fmt.kind is FormatKind.TEXT else (0, 255)
        return list(unpack_values(fmt, use.count, bytes(draw.randint(least, most) for _ in range(use.count))))
    if fmt.kind is FormatKind.BOOLEAN:
        return [bool(draw.getrandbits(1)) for _ in range(count)]
    if fmt.kind is FormatKind.FLOAT:
        low, high = _limits(use, -1e6, 1e6)
        packed = b"".join(pack_values(fmt, [draw.uniform(low, high)]) for _ in range(count))
        return list(unpack_values(fmt, count, packed))
    if fmt.kind in _NUMERIC and (definition.minimum is not None or definition.maximum is not None):
        least, most = integer_range(fmt) or (0, 0)
        low, high = _limits(use, least, most)
        return [draw.randint(int(low), int(high)) for _ in range(count)]
    return list(unpack_values(fmt, count, draw.randbytes(fmt.size * count)))


def _limits(use: Use, low: float, high: float) -> tuple[float, float]:
    minimum, maximum = use.parameter.minimum, use.parameter.maximum
    return (low if minimum is None else minimum), (high if maximum is None else maximum)


def _ends(use: Use, count: int, *, high: bool) -> list[Value]:
    """The ends of the range of a parameter; for what has none, bytes 00h or FFh, or the largest number."""
    fmt = use.format
    if fmt.is_string:
        return list(unpack_values(fmt, use.count, (b"\xff" if high else b"\0") * use.count))
    if fmt.kind is FormatKind.BOOLEAN:
        return [high] * count
    if fmt.kind is FormatKind.FLOAT:
        most = 3.4028234663852886e38 if fmt.size == 4 else 1.7976931348623157e308
        return [_inside(fmt, _limits(use, -most, most)[high], high=high)] * count
    ends = integer_range(fmt)
    if ends is not None:
        return [int(_limits(use, *ends)[high])] * count
    return list(unpack_values(fmt, count, (b"\xff" if high else b"\0") * (fmt.size * count)))


def _elements(use: Use) -> int:
    """Values of a use; a string is one."""
    return 1 if use.format.is_string else use.count


def odd(use: Use, count: int, turn: int, *, given: bool = False) -> list[Value]:
    """Values that a detour over arithmetic or another type loses. What is given must lie within the limits: where they
    leave one only, the highest value is the other, so that a zero is behind a number that is none.
    """
    fmt = use.format
    range_ = integer_range(fmt)
    if fmt.kind is FormatKind.FLOAT:
        tried: tuple[float, ...] = (-0.0, float(2**31), -1.0)
        low, high = _limits(use, -math.inf, math.inf) if given else (-math.inf, math.inf)
    elif fmt.kind in _NUMERIC and range_ is not None:
        tried = (-1, 2 ** (8 * fmt.size - 1), 2**15)
        low, high = _limits(use, *range_) if given else range_
    else:
        return _ends(use, count, high=True)
    fit: list[Value] = [value for value in tried if low <= value <= high]
    fit += _ends(use, 1, high=True) if len(fit) == 1 else []
    first = use.position + turn
    return [fit[(first + index) % len(fit)] for index in range(count)] if fit else _ends(use, count, high=True)


def _inside(fmt: Format, limit: float, *, high: bool) -> Value:
    """The number of a format next to a limit, on the right side of it."""
    layout = ">f" if fmt.size == 4 else ">d"
    data = struct.pack(layout, limit)
    found = float(struct.unpack(layout, data)[0])
    if found > limit if high else found < limit:
        step = 1 if (found < 0) == high else -1
        found = float(struct.unpack(layout, (int.from_bytes(data) + step).to_bytes(fmt.size))[0])
    return found
