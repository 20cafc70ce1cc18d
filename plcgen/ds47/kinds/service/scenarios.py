"""Scenarios of a service job: every input at the ends of its range and beyond, several values, what a drive refuses."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from plcgen.ds47.plan.nouns import DriveJob
from plcgen.ds47.proof.asked import ROOM, SOURCES, Asked
from plcgen.ds47.proof.forms import Came
from plcgen.ds47.proof.scenario import DriveScenario, Edit, KindScenarios
from plcgen.ds47.proof.words import WORDS

RANGES = {"number": (1, 65535), "index": (0, 65535), "count": (0, ROOM), "axis": (0, 255)}
NO_SUCH, NO_INDEX = 0x00, 0x03
"""Error numbers of a drive: there is no such parameter, no such subindex."""
SEVERAL = (
    (2, "0802 41200000 C1200000"), (3, "0203 80 01 FF 00"), (4, "0304 8000 0001 7FFF FFFF"),
    (8, "4108 0102030405060708"), (2, "2302 8001 0001"), (5, "0905 4265656C74 00"),
    (8, "0A08 00FF00FF00FF00FF"), (0, "0801 3F800000"),
)  # fmt: skip
"""How many values are asked for, and a block of the answer: REAL, Integer8, Integer16, 41h, the older 73h, strings."""

WRITTEN = (
    (0x02, -128, 127), (0x03, -32768, 32767), (0x04, -(1 << 31), (1 << 31) - 1), (0x05, 0, 255), (0x06, 0, 65535),
    (0x07, 0, (1 << 32) - 1), (0x41, 0, 255), (0x42, 0, 65535), (0x43, 0, (1 << 32) - 1),
)  # fmt: skip
"""Types of whole numbers with their ends: integers of 1, 2, 4 bytes with and without a sign, bit patterns."""
REALS = ("00000000", "80000000", "C2F6E979", "7F7FFFFF", "FF7FFFFF")
"""0.0, -0.0, -123.456, the largest and the smallest REAL."""
NO_REALS = ("7F800000", "FF800000", "7FC00000", "FF800001")
"""Infinities and what is no number."""
NEVER = (0x00, 0x01, 0x09, 0x0A, 0x0D, 0x32, 0x36, 0x38, 0x40, 0x44, 0x71, 0x80, 0xFF)
"""Types of which nothing is written: none, Boolean, strings, times, eight bytes, no value, an error, fixed point."""
DANGEROUS = (10, 840, 971, 977, 1082, 3981, 9501, 60000, 65535)
"""Numbers that no family lets pass of itself: commissioning, sources, saving, limits, Safety, what nobody knows."""


def asking(job: DriveJob, _: int) -> Iterator[DriveScenario]:
    """All of them."""
    for name, ends in RANGES.items():
        for number in ends:
            asked = _only(name, number)
            block = bytes.fromhex("0601 1234") if asked.count < 2 else bytes((0x05, asked.count, *range(asked.count)))
            yield _answered(job, f"{name} is {number}", asked, block)
        for number in (ends[0] - 1 - (name == "axis"), ends[1] + 1, 30_000 if name in {"count", "axis"} else 1 << 20):
            yield _outside(name, number)
    yield _outside("number", -(1 << 31))
    yield _outside("index", -(1 << 31))
    for count, text in SEVERAL:
        yield _answered(job, f"{count} values come as {text}", Asked(2000, 0x1234, count, 5), bytes.fromhex(text))
    for count, text in ((3, "0403 00000001 00000002 00000003"), (2, "0801 41200000"), (1, "0802 41200000 41200000")):
        block = bytes.fromhex(text)
        asked = Asked(2000, 0, count)
        yield DriveScenario(
            name=f"{count} values come as {text}", reads={1: _edit(job, asked, block)}, parts=(asked,), telegram=1,
            status=(WORDS["RESPONSE_FORMAT"],), errors={(1, 1): (0x8100 | block[0], block[1])},
        )  # fmt: skip
    for number in (NO_SUCH, NO_INDEX):
        asked = Asked(60000, 9, 1)
        yield DriveScenario(
            name=f"the drive refuses it with {number:02X}h", status=(WORDS["PARAMETER_ERROR"],), telegram=1,
            parts=(asked,), reads={1: _edit(job, asked, bytes((0x44, 1, 0, number)), 0x81)},
            errors={(1, 1): (0x8000 | number, 0)},
        )  # fmt: skip
    yield DriveScenario(name="inputs change behind the start", parts=(Asked(964, 0, 1, -1),), meddle=True)


def _answered(job: DriveJob, name: str, asked: Asked, block: bytes) -> DriveScenario:
    """A good answer with this block."""
    size = {0x02: 1, 0x03: 2, 0x05: 1, 0x06: 2, 0x08: 4, 0x09: 1, 0x0A: 1, 0x23: 2, 0x41: 1}[block[0]] * block[1]
    return DriveScenario(
        name=name, reads={1: _edit(job, asked, block)}, delivers={(1, 1): block[2 : 2 + size].ljust(ROOM, b"\0")},
        parts=(asked, Came({1: block[0]})), generic=False,
    )  # fmt: skip


def writing(job: DriveJob, _: int) -> Iterator[DriveScenario]:
    """A service that writes: what passes and what does not, every type at its ends and beyond."""
    assert job.permitted is not None  # of such jobs only
    ranges = job.permitted.ranges
    inside = {number for first, last in ranges for number in (first, last)}
    step = max(1, len(ranges) // 12)
    tried = {*ranges[::step], *ranges[:2], *ranges[-2:]}
    number = ranges[0][0]
    for one in sorted({edge for pair in tried for edge in pair}):
        yield _written(job, f"{one} is written", Asked(one, 3, writes=_value(0x06, 0x1234), enabled=True))
    beside = {edge for first, last in tried for edge in (first - 1, last + 1) if 0 < edge < 1 << 16}
    within = {one for one in (*beside, *DANGEROUS) if not any(first <= one <= last for first, last in ranges)}
    for one in sorted(within - inside):
        yield _refused(
            f"{one} is no number that may be written", "NOT_PERMITTED", Asked(one, writes=_value(6, 1), enabled=True)
        )
    for code, low, high in WRITTEN:
        for value in (low, low + 1, high):
            asked = Asked(number, writes=_value(code, value), enabled=True)
            yield _written(job, f"{value} is written as {code:02X}h", asked)
        size = SOURCES[code][1]
        for value in (low - 1, high + 1) if size < 4 else ():
            asked = Asked(number, writes=_value(code, value), enabled=True)
            yield _refused(f"{value} does not fit {code:02X}h", "NO_VALUE", asked)
    for text in REALS:
        asked = Asked(number, 0xFFFF, 0, writes=(0x08, bytes.fromhex(text), bytes(4), bytes(4)), enabled=True)
        yield _written(job, f"{text} is written as REAL", asked)
    for text in NO_REALS:
        asked = Asked(number, writes=(0x08, bytes.fromhex(text), bytes(4), bytes(4)), enabled=True)
        yield _refused(f"{text} is no REAL that is written", "NO_VALUE", asked)
    for code in NEVER:
        asked = Asked(number, writes=(code, *(bytes.fromhex("3F800000"),) * 3), enabled=True)
        yield _refused(f"type {code:02X}h is not written", "NOT_WRITABLE", asked)
    plain = Asked(number, writes=_value(0x06, 7), enabled=True)
    own = job.drive.drive_object
    for one in (number, 971):
        yield _refused(
            f"a write of {one} that is not enabled", "NOT_ENABLED", replace(plain, number=one, enabled=False)
        )
    yield _written(job, "its own drive object is written", replace(plain, axis=own))
    for axis in {own ^ 1, 0 if own else 2, 255 - own}:
        yield _refused(f"drive object {axis} is another's", "NOT_PERMITTED", replace(plain, axis=axis))
    yield _refused("two values are not written", "NO_REQUEST", replace(plain, count=2))
    yield _refused("number 0 is not written", "NO_REQUEST", replace(plain, number=0))
    yield replace(_written(job, "inputs change behind the start of a write", plain), meddle=True, busy=(3, 3))
    for text, word in (("440100110000", 0), ("440200021234", 0x1234)):
        block = bytes.fromhex(text)[: 4 if word == 0 else 6]
        yield DriveScenario(
            name=f"the drive refuses the write with {block.hex()}", status=(WORDS["PARAMETER_ERROR"],), telegram=1,
            parts=(plain,), reads={1: _edit(job, plain, block, 0x82)}, errors={(1, 1): (0x8000 | block[3], word)},
        )  # fmt: skip
    yield DriveScenario(name="what is enabled reads as ever", parts=(Asked(enabled=True),))


def _value(code: int, value: int) -> tuple[int, bytes, bytes, bytes]:
    """A whole number of a type at the input that this has; others at the two that it has not."""
    own, other = (value & 0xFFFFFFFF).to_bytes(4), bytes.fromhex("01020304")
    return code, other, *((own, other) if SOURCES[code][0] == "writeDint" else (other, own))


def _written(job: DriveJob, name: str, asked: Asked) -> DriveScenario:
    """A good answer to a change: nothing but a header."""
    return DriveScenario(name=name, parts=(asked,), reads={1: _edit(job, asked, b"", 2)})


def _refused(name: str, word: str, asked: Asked) -> DriveScenario:
    """Nothing is sent."""
    return DriveScenario(name=name, parts=(asked,), status=(WORDS[word],), checked=False, follow=False)


def _edit(job: DriveJob, asked: Asked, block: bytes, response: int = 1) -> Edit:
    """The drive object that was asked answers."""
    axis = job.drive.drive_object if asked.axis == -1 else asked.axis
    whole = block + bytes(len(block) % 2)
    head = bytes((response, axis, 1))
    return lambda answer: answer[:1] + head + whole


def _only(name: str, number: int) -> Asked:
    """One input is set, all others are as they begin."""
    first, index, count, axis = (number if one == name else start for one, start in Asked().inputs().items())
    return Asked(first, index, count, axis)


def _outside(name: str, number: int) -> DriveScenario:
    """Nothing is sent."""
    return DriveScenario(
        name=f"{name} is {number}", parts=(_only(name, number),), status=(WORDS["NO_REQUEST"],), checked=False,
        follow=False,
    )  # fmt: skip


SCENARIOS = (
    KindScenarios(65, lambda job: job.serves, asking),
    KindScenarios(66, lambda job: job.permitted is not None, writing),
)
