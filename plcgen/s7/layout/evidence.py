"""What every rule of the standard-access layout rests on: blocks compiled by STEP 7, or the manuals alone.

A layout carries the keys of the *literature* rules that an offset depends on (its doubts); ``rule`` gives the
sentence for one of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType

from plcgen.s7.types.data_types import ELEMENTARY, HARDWARE

COMPILED = "compiled"
LITERATURE = "literature"

COMPOSITE_START = "composite-start"
ARRAY_END = "array-end"
STRING_STRIDE = "string-stride"
BIT_ROWS = "bit-rows"

NO_DOUBTS: frozenset[str] = frozenset()


@dataclass(frozen=True, slots=True)
class Rule:
    """One rule: ``vectors`` are the compiled blocks of ``tests/vectors/layouts.yaml`` whose length or start values
    another rule in its place would not give. The rule was checked against more blocks than the vectors are.
    """

    key: str
    text: str
    evidence: str
    source: str
    vectors: tuple[str, ...] = ()


_V5 = "blocks compiled by STEP 7 V5: length and start values in the load memory image"
_MANUAL = "Siemens, STEP 7 Programming manual, appendix data types"
_TABLE = (
    Rule("bit", "BOOL takes the next free bit, eight to a byte; ARRAY OF BOOL packs bits", COMPILED, _V5,
         ("c004", "c017", "c026", "c044", "c046", "c057", "c068", "c080", "c086", "c097", "c119", "c132")),
    Rule("bit-array-end", "after an ARRAY OF BOOL nothing starts before the next whole byte", COMPILED, _V5,
         ("c086",)),
    Rule("byte", "types of 8 bits take the next whole byte, odd or even", COMPILED, _V5,
         ("c046", "c057", "c058", "c067", "c068", "c086", "c092", "c097")),
    Rule("word", "wider types start at an even byte and are never aligned to 4 or 8", COMPILED, _V5,
         ("c001", "c002", "c015", "c017", "c026", "c035", "c068", "c080", "c092", "c093", "c097", "c113", "c116",
          "c132")),
    Rule("string", "STRING[n] takes n + 2 bytes, starts at an even byte and is not padded at its end", COMPILED, _V5,
         ("c035", "c089")),
    Rule("struct-end", "STRUCT, UDT and multi-instance are padded to an even byte", COMPILED, _V5, ("c086",)),
    Rule("sections", "Input, Output, InOut and Static follow in that order and each starts at an even byte; "
         "Temp and Constant take none", COMPILED, _V5, ("c026",)),
    Rule("in-out", "a structured IN_OUT is a POINTER of 6 bytes, ANY takes 10", COMPILED, _V5,
         ("c049", "c052", "c062")),
    Rule("block-end", "the length of a block is even", COMPILED, _V5, ("c042", "c067", "c068", "c113", "c132")),
    Rule(COMPOSITE_START, "STRUCT and ARRAY start at an even byte", LITERATURE, _MANUAL),
    Rule(ARRAY_END, "an ARRAY is padded to an even byte at its end", LITERATURE, _MANUAL),
    Rule(STRING_STRIDE, "the elements of an ARRAY OF STRING[odd] start at even bytes", LITERATURE, _MANUAL),
    Rule(BIT_ROWS, "every row of a multi-dimensional ARRAY OF BOOL starts at a whole byte", LITERATURE, _MANUAL),
)  # fmt: skip
RULES = MappingProxyType({entry.key: entry for entry in _TABLE})
"""Every rule of the layout by key, in the order of the manual; sizes of single types are not among them."""

SIZES = HARDWARE | {
    "DTL", "LREAL", "LINT", "ULINT", "LWORD", "LTIME", "LTIME_OF_DAY", "LDT", "WCHAR", "WSTRING", "POINTER",
    "COUNTER", "BLOCK_DB", "BLOCK_FB", "BLOCK_FC", "BLOCK_SDB", "BLOCK_SFB", "BLOCK_SFC",
}  # fmt: skip
"""Types whose size no compiled block confirms."""


def rule(key: str) -> Rule:
    """The rule behind a doubt: a key of ``RULES``, or the name of a type whose size or members are literature."""
    if key in RULES:
        return RULES[key]
    known = ELEMENTARY.get(key)
    if known is not None:
        text = f"{key} takes {known.bits // 8} bytes"
    elif key == "WSTRING":
        text = "WSTRING[n] takes 2n + 4 bytes"
    elif key == "VARIANT":
        text = "VARIANT takes no room in an instance"
    else:
        text = f"{key} has the members that Siemens' documentation lists"
    return Rule(key, text, LITERATURE, _MANUAL)
