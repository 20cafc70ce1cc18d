"""Scenarios of a service job: every input at the ends of its range and beyond, several values, what a drive refuses."""

from __future__ import annotations

from collections.abc import Iterator

from plcgen.ds47.plan.nouns import DriveJob
from plcgen.ds47.proof.asked import ROOM, Asked
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


def asking(job: DriveJob, _: int) -> Iterator[DriveScenario]:
    """All of them."""
    for name, ends in RANGES.items():
        for number in ends:
            asked = Asked(**{name: number})
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


def _edit(job: DriveJob, asked: Asked, block: bytes, response: int = 1) -> Edit:
    """The drive object that was asked answers."""
    axis = job.drive.drive_object if asked.axis == -1 else asked.axis
    whole = block + bytes(len(block) % 2)
    return lambda answer: bytes((answer[0], response, axis, 1)) + whole


def _outside(name: str, number: int) -> DriveScenario:
    """Nothing is sent."""
    return DriveScenario(
        name=f"{name} is {number}", parts=(Asked(**{name: number}),), status=(WORDS["NO_REQUEST"],), checked=False,
        follow=False,
    )  # fmt: skip


SCENARIOS = (KindScenarios(65, lambda job: job.serves, asking),)
