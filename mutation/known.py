"""The ten faults of other libraries that the generated block must not have: replacements in the generated files."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Known:
    """A fault by name: ``old`` becomes ``new`` in the first file of the folder that has it."""

    name: str
    spec: str
    file: str
    old: str
    new: str


MM4, FAQ = "s7-300_mm440_dp", "s7-300_6ra80_dp_tia"
READ, WRITE = "scl/ReadParams.scl", "scl/WriteParams.scl"
KNOWN = (
    Known("every value of a multi-write from the first parameter", MM4, "db/WriteParams_Request.scl", "22.0", "11.0"),
    Known("subindex ignored", MM4, "db/ReadParams_Request.scl", "W#16#0001", "W#16#0000"),
    Known("reference wraps to 0", MM4, READ, ".requestReference := 1;", ".requestReference := 0;"),
    Known("answers in 41h to 43h taken for errors", MM4, READ, " OR tempWireFormat = B#16#43", ""),
    Known("unsigned values taken for signed ones", MM4, READ, ".requestReference < 255", ".requestReference < 127"),
    Known("no drain", MM4, READ, "IF NOT (statWriteActive OR statReadActive) OR tempDrainOver THEN", "IF TRUE THEN"),
    Known(
        "an old answer is fatal",
        MM4,
        READ,
        "tempResume := STATE_READ;  // the answer",
        "tempResult := STATUS_RETRIES;  //",
    ),
    Known("response length unchecked", MM4, READ, " OR tempPosition <> statLength", ""),
    Known("error blocks of 6 bytes", MM4, WRITE, "tempPosition + 2 + 2 * tempWireCount;", "tempPosition + 6;"),
    Known("the whole buffer is sent", MM4, WRITE, "LEN := 28", "LEN := 240"),
)
