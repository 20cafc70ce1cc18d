"""Lists of deviations, stated by hand: what counts as another value, how it is listed, in which order.

Each value is held against the one that is wanted, in the order of the job and within an array by index. REAL values
that are neighbours, and both zeros, are the same: a drive that computes in other units may come back to the neighbour.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping

from plcgen.ds47.plan.nouns import DriveJob
from plcgen.ds47.wire.formats import Format, pack_values, unpack_values

MEMBERS = ("parameter", "index", "wanted", "found", "wantedBits", "foundBits")
"""Of an entry: DINT, DINT, REAL, REAL, DWORD, DWORD."""
PLACES = 32
"""Entries of a list, if that many values are compared."""
SIGN = 0x80000000


def deviation_members(job: DriveJob) -> Iterator[str]:
    """Members of the block that have the list."""
    for place in range(1, _places(job) + 1):
        for name in MEMBERS:
            yield f"deviations[{place}].{name}"
    yield "deviationCount"
    yield "equal"


def _places(job: DriveJob) -> int:
    """Entries of the list."""
    return min(PLACES, sum(use.count for use in job.uses))


def deviation_list(job: DriveJob, given: Mapping[int, bytes], held: Mapping[int, bytes]) -> bytes:
    """The list that wire bytes make, what is wanted and what there is, by position of the use."""
    found = []
    for use in job.uses:
        size = use.format.size
        for at in range(use.count):
            wanted, there = (one[use.position][at * size :][:size] for one in (given, held))
            if _another(use.format, wanted, there):
                number = use.parameter.pnu.to_bytes(4) + (use.subindex + at).to_bytes(4)
                found.append(number + _real(use.format, wanted) + _real(use.format, there) + _bits(wanted, there))
    listed = b"".join(found[: _places(job)]).ljust(24 * _places(job), b"\0")
    return listed + len(found).to_bytes(2) + bytes((not found,))


def _another(format_: Format, wanted: bytes, there: bytes) -> bool:
    """Whether a value is not the one that is wanted."""
    one, two = int.from_bytes(wanted), int.from_bytes(there)
    if format_.name != "FloatingPoint":
        return one != two
    if (one ^ two) & SIGN:
        return bool((one | two) & ~SIGN)
    return abs(one - two) > 1


def _real(format_: Format, data: bytes) -> bytes:
    """The number as a REAL; of a REAL all its bits."""
    if format_.name == "FloatingPoint":
        return data
    return struct.pack(">f", float(unpack_values(format_, 1, data)[0]))


def _bits(*values: bytes) -> bytes:
    return b"".join(data.rjust(4, b"\0") for data in values)


def swapped(format_: Format, data: bytes) -> bytes:
    """The number with the other sign; of what has none, all bits turned round."""
    value = unpack_values(format_, 1, data)[0]
    if format_.name == "FloatingPoint":
        return (int.from_bytes(data) ^ SIGN).to_bytes(4)
    signed = isinstance(value, int) and pack_values(format_, [value])[0] >> 7
    return bytes(byte ^ 0xFF for byte in data) if not signed else data
