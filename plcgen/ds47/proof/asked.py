"""What a job asks for whose inputs name the parameter, stated by hand: as its request must have it.

Bytes of a request (data set 47): 2 drive object, 5 number of elements, 6 and 7 number, 8 and 9 subindex.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import cache

from plcgen.ds47.plan.nouns import DriveJob

ROOM = 8
"""Bytes of values that are kept."""
TYPES = {"number": "DINT", "index": "DINT", "count": "INT", "axis": "INT"}
SHOWN = "Dword"
"""Behind the name of what is read: the bits of its first value."""


@dataclass(frozen=True, slots=True)
class Asked:
    """The inputs of a run, and before anybody has changed them; ``axis`` -1 is the drive object of the spec."""

    number: int = 964
    index: int = 0
    count: int = 1
    axis: int = -1

    def inputs(self) -> dict[str, int]:
        """By the names of the inputs."""
        return {name: getattr(self, name) for name in TYPES}

    def request(self, plain: bytes) -> bytes:
        """What is sent; ``plain`` is the request of the spec."""
        axis = plain[2] if self.axis == -1 else self.axis & 0xFF
        asked = (self.number & 0xFFFF).to_bytes(2) + (self.index & 0xFFFF).to_bytes(2)
        return bytes((0, 1, axis, 1, 0x10, self.count & 0xFF)) + asked

    @property
    def expected(self) -> bytes:
        """What the channel must expect: any type, the number of values, room for them."""
        return bytes((0, max(self.count, 1), 0, ROOM))


@cache
def names(job: DriveJob) -> tuple[str, ...]:
    """Members that no other job has."""
    return (*(field.name for field in fields(Asked)), f"{job.uses[0].member}{SHOWN}") if job.serves else ()
