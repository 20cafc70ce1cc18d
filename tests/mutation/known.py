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


MM4, FAQ, PUMP = "s7-300_mm440_dp", "s7-300_6ra80_dp_tia", "s7-1500_g120_pn"
READ, WRITE = "udt/typeReadParams_Request.scl", "udt/typeWriteParams_Request.scl"
CHANNEL = "scl/DriveChannel.scl"
KNOWN = (
    Known("every value of a multi-write from the first parameter", MM4, WRITE, "REAL := 22.0", "REAL := 11.0"),
    Known("subindex ignored", MM4, READ, "WORD := W#16#0001;  // ", "WORD := W#16#0000;  // "),
    Known("reference wraps to 0", MM4, CHANNEL, "statReference MOD 255 + 1", "(statReference + 1) MOD 256"),
    Known("answers in 41h to 43h taken for errors", MM4, CHANNEL, " OR tempCame = B#16#43", ""),
    Known(
        "error numbers without their mark",
        MM4,
        CHANNEL,
        "tempWord := W#16#8000 OR BYTE_TO_WORD(unit.record[tempFrom + 3])",
        "tempWord := BYTE_TO_WORD(unit.record[tempFrom + 3])",
    ),
    Known("no drain", MM4, CHANNEL, "(NOT tempActive OR statTimer", "(TRUE OR statTimer"),
    Known(
        "an old answer is fatal",
        MM4,
        CHANNEL,
        "statForeign := TRUE;  // the answer to an earlier request",
        "tempResult := STATUS_RETRIES;  //",
    ),
    Known("response length unchecked", MM4, CHANNEL, " OR tempFrom <> statLength", ""),
    Known(
        "error blocks of 6 bytes",
        MM4,
        CHANNEL,
        "tempFrom := tempFrom + 2 + tempSize",
        "IF tempCame = B#16#44 THEN tempSize := 4; END_IF; tempFrom := tempFrom + 2 + tempSize",
    ),
    Known("the whole buffer is sent", MM4, CHANNEL, "LEN := statOrder.length", "LEN := SIZE"),
)
