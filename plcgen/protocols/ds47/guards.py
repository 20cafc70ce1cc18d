"""What no definition of a parameter lifts: numbers that can do harm, and numbers that can only be read.

A profile or a spec may call a parameter what it likes; its number decides. Sources: Siemens' help on the parameters of
S210 (p0009, p0010, p0976, p0977, p1215; the displays), S120 (p0971) and G120 (p0015); the others come from
general knowledge, and are guarded all the same.
"""

from __future__ import annotations

SAFETY = frozenset({3117, *range(9300, 9400), *range(9500, 10_300), 60_022})
"""Safety Integrated: monitoring limits in both channels, terminals, brake test, checksums, passwords, PROFIsafe.

Source: lists of parameters in the TIA Portal information system (VECTOR, S210): SI in the title, or the group.
"""

READ_ONLY = frozenset({944, 945, 947, 948, 949, 964, 965, 975})
"""Fault buffer, identification of the device, the profile and the drive object: displays in every family."""

_DANGERS: dict[int, str] = {
    9: "switches the whole unit to a commissioning state, in which no drive runs",
    10: "switches the drive to a commissioning state, in which it does not run",
    15: "runs a macro that overwrites interconnections and settings",
    970: "resets parameters to their factory settings",
    971: "writes the non-volatile memory; cyclic use wears it out",
    972: "restarts the unit",
    973: "belongs to the functions that reset, restart and save a unit (p0970..p0977)",
    974: "belongs to the functions that reset, restart and save a unit (p0970..p0977)",
    976: "resets the parameters of the whole unit",
    977: "writes the non-volatile memory; cyclic use wears it out",
    1215: "configures the motor holding brake: a load may drop",
    3900: "ends quick commissioning, which computes other parameters again",
}


TRIGGERS = frozenset({15, 970, 971, 972, 973, 974, 976, 977, 3900, 3981})
"""Writing these starts something: whether it happened cannot be told by writing again. p3981 acknowledges faults."""


SET_BACK = TRIGGERS | {10}
"""What a drive sets back automatically, so that a read says nothing about what was written. p0010 returns to 0 when
quick commissioning ends (general knowledge)."""


def danger(pnu: int) -> str:
    """Why a write of this number needs a sign-off; empty if it needs none."""
    return "it belongs to Safety Integrated, which protects people" if pnu in SAFETY else _DANGERS.get(pnu, "")


def why_read_only(key: str, pnu: int, *, catalogued: str = "") -> str:
    """Why a parameter written as ``key`` can only be read; empty if it can be written.

    ``catalogued`` is what the catalogue says about it: r, w, rw, or nothing.
    """
    if key.strip()[:1] in {"r", "R"}:
        return "r marks a read-only parameter"
    if pnu in READ_ONLY:
        return f"PROFIdrive's parameter {pnu} can only be read"
    return "the catalogue says that it can only be read" if catalogued == "r" else ""
