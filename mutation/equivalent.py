"""Mutants that no test can notice, with the reason."""

from __future__ import annotations

import re

from mutation.operators import Mutant

EQUIVALENT = {
    r"^exchanged: #?tempMove := (BLKMOV|SFC20).* / #?tempMove := (BLKMOV|SFC20)": (
        "two copies between four different areas, whose return value nobody reads: their order does not matter"
    ),
    r"^DW#16#7FFFFFFF -> DW#16#7FFFFFFE: CLOCK_MASK": (
        "odd times become 1 ms shorter, and all limits are even: time >= limit stays what it was"
    ),
    r"^\d+ -> \d+: (CALL|EVENT|PHASE)_[A-Z]+ : I(nt|NT) :=": (
        "a number that only the block compares; if another constant had it already, the block would go wrong"
    ),
    r"^< -> <=: IF #?tempFailed = 0 OR #?tempIndex < #?tempFailed": (
        "no two items of a telegram have the same first address"
    ),
}
"""Reasons by the description of a mutant."""


def reason(mutant: Mutant) -> str:
    """Why a mutant behaves like the original; empty if it should be noticed."""
    return next((why for pattern, why in EQUIVALENT.items() if re.search(pattern, mutant.what)), "")
