"""What no definition of a parameter lifts: numbers of Safety, of what starts something, and of what can only be read.

A profile or a spec may call a parameter what it likes; its number decides. What else a write can do is in ``effects``.
Sources: Siemens' help on the parameters of S210 (p0009, p0010, p0976, p0977; the displays), S120 (p0971) and G120
(p0015); the others come from general knowledge, and are guarded all the same.
"""

from __future__ import annotations

_NO_SAFETY = frozenset(
    {*range(9904, 9911), 9915, 9916, 9918, 9920, 9921, *range(9930, 9933), *range(9937, 9940), 9942, 9990}
)
"""Topology, licences and logbook, which have numbers between those of Safety (list of the control units)."""

_ALL_SAFETY = frozenset({3117, *range(9300, 9400), *range(9500, 10_300), 60_022})
SAFETY = _ALL_SAFETY - _NO_SAFETY
"""Safety Integrated: monitoring limits in both channels, terminals, brake test, checksums, passwords, PROFIsafe.

Source: lists of parameters in the TIA Portal information system (VECTOR, S210): SI in the title, or the group.
"""

READ_ONLY = frozenset({944, 945, 947, 948, 949, 964, 965, 975})
"""Fault buffer, identification of the device, the profile and the drive object: displays in every family."""

TRIGGERS = frozenset({15, 970, 971, 972, 973, 974, 976, 977, 3900, 3981})
"""Writing these starts something: whether it happened cannot be told by writing again. p3981 acknowledges faults."""

NOT_SERVED = _ALL_SAFETY | TRIGGERS | READ_ONLY
"""What a service never writes: what other kinds of jobs start (save, reset, acknowledge), Safety, displays."""

SET_BACK = TRIGGERS | {10}
"""What a drive sets back automatically, so that a read says nothing about what was written. p0010 returns to 0 when
quick commissioning ends (general knowledge)."""


def why_read_only(key: str, pnu: int, *, catalogued: str = "") -> str:
    """Why a parameter written as ``key`` can only be read; empty if it can be written.

    ``catalogued`` is what the catalogue says about it: r, w, rw, or nothing.
    """
    if key.strip()[:1] in {"r", "R"}:
        return "r marks a read-only parameter"
    if pnu in READ_ONLY:
        return f"PROFIdrive's parameter {pnu} can only be read"
    return "the catalogue says that it can only be read" if catalogued == "r" else ""
