"""Reads without a type: what an answer must become, for every format that a document prints."""

from __future__ import annotations

import struct
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from plcgen.ds47.plan.access import Form, Use
from plcgen.ds47.proof.asked import SHOWN
from plcgen.proof.scenario import ScenarioError

if TYPE_CHECKING:
    from plcgen.ds47.proof.rig import JobRig

ROOM = 8
"""Bytes that are kept of such a value."""
FORMATS: dict[int, str] = {
    0x01: "B", 0x02: "b", 0x03: "h", 0x04: "i", 0x05: "B", 0x06: "H", 0x07: "I", 0x08: "f", 0x09: "B", 0x0A: "B",
    0x0C: "6s", 0x0D: "I", 0x0F: "8s", 0x32: "7s", 0x34: "I", 0x35: "6s", 0x36: "I", 0x37: "8s", 0x38: "8s",
    0x71: "h", 0x72: "i", 0x73: "H", 0x74: "H", 0x75: "H", 0x76: "H", 0x77: "I", 0x78: "H", 0x79: "h", 0x7A: "i",
    0x7B: "h", 0x7C: "i", 0x41: "B", 0x42: "H", 0x43: "I",
    0x21: "h", 0x22: "i", 0x23: "H", 0x24: "H", 0x25: "H", 0x26: "H", 0x27: "I", 0x28: "H", 0x29: "h", 0x2A: "i",
    0x2B: "h", 0x2C: "i",
}  # fmt: skip
"""Codes of formats with how :mod:`struct` writes one value; ``s`` are octets. 21h to 2Ch are the older 71h to 7Ch."""


@dataclass(frozen=True, slots=True)
class Came:
    """Formats that an answer brings in a scenario, by the position of what is read; all others bring Unsigned64."""

    codes: Mapping[int, int] = field(default_factory=dict)


UNSIGNED64 = 0x38
"""The simulated drive has a value of 8 bytes."""


def size(code: int) -> int:
    """Bytes of one value."""
    return struct.calcsize(f">{FORMATS[code]}")


def numbers(code: int, octets: bytes) -> tuple[int, float]:
    """The value as DINT and as REAL: bits of a REAL as DINT, 43h as both, octets that are no number as 0."""
    layout = FORMATS[code]
    data = octets[: size(code)]
    if layout.endswith("s"):
        return 0, 0.0
    if code in {0x08, 0x43}:
        return struct.unpack(">i", data)[0], struct.unpack(">f", data)[0]
    number = struct.unpack(f">{layout}", data)[0]
    number -= (number >> 31) << 32 if number >= 1 << 31 else 0
    return number, struct.unpack(">f", struct.pack(">f", number))[0]


def check_forms(rig: JobRig) -> None:
    """Format and numbers belong to the bytes that are shown; all of it is 0 before the first answer."""
    for use in rig.job.uses:
        if use.untyped:
            _check(rig, use)


def check_formats(rig: JobRig, came: Came) -> None:
    """After a run that is done, the format is that of the answer."""
    for use in rig.job.uses:
        for one in use.shown:
            if one.as_(Form) == Form("format"):
                found, wanted = rig.db.bytes(one.member, 1)[0], came.codes.get(use.position, UNSIGNED64)
                if found != wanted:
                    raise ScenarioError(f"{one.member} is {found:02X}h, the answer had {wanted:02X}h")


def _check(rig: JobRig, use: Use) -> None:
    names = {form.name: one.member for one in use.shown if (form := one.as_(Form))}
    octets, code = rig.db.bytes(use.member, ROOM), rig.db.bytes(names["format"], 1)[0]
    if code and code not in FORMATS:
        raise ScenarioError(f"{names['format']} is {code:02X}h, which no answer had")
    dint, real = numbers(code, octets) if code else (0, 0.0)
    wanted = struct.pack(">if", dint, real) if code not in {0x08, 0x43} else octets[:4] * 2
    found = rig.db.bytes(names["dint"], 4) + rig.db.bytes(names["real"], 4)
    if rig.job.serves and rig.db.bytes(f"{use.member}{SHOWN}") != struct.pack(">i", dint):
        raise ScenarioError(f"{use.member}{SHOWN} has other bits than {dint}")
    if found != wanted:
        shown = f"{found.hex(' ')} instead of {wanted.hex(' ')}"
        raise ScenarioError(f"{names['dint']} and {names['real']} of format {code:02X}h are {shown}")
    if code and not rig.job.serves and any(octets[size(code) :]):
        raise ScenarioError(f"{use.member} has octets after its value: {octets.hex(' ')}")
