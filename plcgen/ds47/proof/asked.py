"""What a job asks for whose inputs name the parameter, stated by hand: as its request must have it.

Bytes of a request (data set 47): 1 read or change, 2 drive object, 5 number of elements, 6 and 7 number, 8 and 9
subindex; of a change 10 type, 11 number of values, from 12 on the value, with 00h behind a single byte.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

from plcgen.ds47.plan.nouns import DriveJob

ROOM = 8
"""Bytes of values that are kept."""
TYPES = {"number": "DINT", "index": "DINT", "count": "INT", "axis": "INT"}
SWITCHES = ("enableWrite", "write")
VALUES = {"writeFormat": 1, "writeReal": 4, "writeDint": 4, "writeDword": 4}
"""Further inputs of a service that writes; bytes of each."""
SHOWN = "Dword"
"""Behind the name of what is read: the bits of its first value."""
SOURCES = {
    0x02: ("writeDint", 1), 0x03: ("writeDint", 2), 0x04: ("writeDint", 4), 0x05: ("writeDint", 1),
    0x06: ("writeDint", 2), 0x07: ("writeDword", 4), 0x08: ("writeReal", 4), 0x41: ("writeDword", 1),
    0x42: ("writeDword", 2), 0x43: ("writeDword", 4),
}  # fmt: skip
"""Types that are written: the input that has the value, and the bytes of it that are sent, from the right."""


@dataclass(frozen=True, slots=True)
class Asked:
    """The inputs of a run, and before anybody has changed them; ``axis`` -1 is the drive object of the spec.

    ``writes`` is what a write has beside: its type, the bytes of the three inputs REAL, DINT and DWORD; ``enabled``
    the switch that lets it pass.
    """

    number: int = 964
    index: int = 0
    count: int = 1
    axis: int = -1
    writes: tuple[int, bytes, bytes, bytes] | None = None
    enabled: bool = False

    def inputs(self) -> dict[str, int]:
        """By the names of the inputs."""
        return {name: getattr(self, name) for name in TYPES}

    def more(self) -> dict[str, bytes]:
        """What a service that writes has besides, as bytes."""
        format_, real, dint, dword = self.writes or (0, bytes(4), bytes(4), bytes(4))
        given = (bytes((self.enabled,)), bytes((self.writes is not None,)), bytes((format_,)), real, dint, dword)
        return dict(zip((*SWITCHES, *VALUES), given, strict=True))

    def request(self, plain: bytes) -> bytes:
        """What is sent; ``plain`` is the request of the spec."""
        axis = plain[2] if self.axis == -1 else self.axis & 0xFF
        asked = (self.number & 0xFFFF).to_bytes(2) + (self.index & 0xFFFF).to_bytes(2)
        head = bytes((0, 1 if self.writes is None else 2, axis, 1, 0x10, self.count & 0xFF)) + asked
        if self.writes is None or self.writes[0] not in SOURCES:
            return head
        name, size = SOURCES[self.writes[0]]
        return head + bytes((self.writes[0], 1)) + self.more()[name][-size:] + bytes(size % 2)

    @property
    def expected(self) -> bytes:
        """What the channel must expect: any type, the number of values, room for them."""
        return bytes((0, max(self.count, 1), 0, ROOM))


@cache
def names(job: DriveJob) -> tuple[str, ...]:
    """Members that no other job has."""
    if not job.serves:
        return ()
    more = (*SWITCHES, *VALUES) if job.permitted is not None else ()
    return (*TYPES, f"{job.uses[0].member}{SHOWN}", *more)
