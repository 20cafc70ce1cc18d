"""Scenarios of reads without a type: an answer of every format, negative numbers, one that is no value."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import cycle

from plcgen.ds47.plan.nouns import DriveJob, DriveTelegram
from plcgen.ds47.proof.forms import FORMATS, ROOM, Came, size
from plcgen.ds47.proof.points import value_at
from plcgen.ds47.proof.scenario import DriveScenario, Edit, KindScenarios

OCTETS = bytes.fromhex("8192A3B4C5D6E7F8")
"""Octets of an answer, negative where there is a sign; positive without the highest bit."""


def every_format(job: DriveJob, _: int) -> Iterator[DriveScenario]:
    """Each format at each place, in turn with the sign set and not set."""
    signs = cycle((0x80, 0x00))
    for telegram in job.telegrams:
        for place, part in enumerate(telegram.parts, 1):
            for code in FORMATS if part.use.untyped else ():
                octets = bytes((OCTETS[0] & 0x7F | next(signs), *OCTETS[1:]))[: size(code)]
                yield DriveScenario(
                    name=f"{part.use.label} comes in format {code:02X}h",
                    reads={telegram.number: _answered(telegram, place, code, octets)},
                    delivers={(telegram.number, place): octets.ljust(ROOM, b"\0")},
                    generic=False,
                    follow=False,
                    parts=(Came({part.use.position: code}),),
                )


def _answered(telegram: DriveTelegram, place: int, code: int, octets: bytes) -> Edit:
    """A good answer with one value of this format in the place of the drive's 8 octets."""
    at = value_at(telegram, place) - 2

    def edit(answer: bytes) -> bytes:
        block = bytes((code, 1)) + octets + bytes(len(octets) % 2)
        return answer[:at] + block + answer[at + 2 + ROOM :]

    return edit


SCENARIOS = (KindScenarios(7, lambda job: job.untyped, every_format),)
