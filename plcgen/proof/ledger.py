"""The ledger: what a green run rests on, with the source and the grade of each assumption."""

from __future__ import annotations

import enum
from dataclasses import dataclass


class Grade(enum.StrEnum):
    """How well an assumption is known."""

    MANUAL = "manual"
    OBSERVED = "observed"
    SECOND = "second source"
    SPEC = "spec"
    GENERAL = "general knowledge"


GRADES = {
    Grade.MANUAL: "a page of the device's own documents says so",
    Grade.OBSERVED: "seen at a device, in a compiled program or in a capture",
    Grade.SECOND: "another document says so, or the profile's without a page",
    Grade.SPEC: "the spec, or a profile of its own, says so",
    Grade.GENERAL: "nobody has looked it up",
}


@dataclass(frozen=True, slots=True)
class Assumption:
    """One assumption: about what, what is assumed, who says so, how well that is known."""

    subject: str
    text: str
    source: str
    grade: Grade


LAYOUT = Assumption(
    "layout",
    "offsets of standard access",
    "layouts compiled by STEP 7 V5 and the TIA Portal (plcgen.s7.layout.shapes names them)",
    Grade.OBSERVED,
)
"""What every protocol with buffers rests on."""
