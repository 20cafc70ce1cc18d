"""Error OBs: what calls each one, and which CPUs go to STOP if their program does not have it.

Source: TIA Portal information system: "Organization blocks (S7-300, S7-400)"; "OB start events" of the S7-1500; events
of the S7-1200, which has no OB121 and no OB122.
"""

from __future__ import annotations

from dataclasses import dataclass

PULL_PLUG = 83
"""Of the S7-300, only CPUs 31x PN/DP have it, for PROFINET IO (same help, "Points to note about S7-300")."""
_CLASSIC = frozenset({"s7-300", "s7-400"})


@dataclass(frozen=True, slots=True)
class ErrorOb:
    """An OB by its number: what calls it, families whose CPUs go to STOP without it, and names that tools give it."""

    number: int
    called: str
    stops: frozenset[str]
    names: frozenset[str]


ERROR_OBS = (
    ErrorOb(82, "a device reports a diagnostic event", _CLASSIC, frozenset({"I/O_FLT1", "DIAGNOSTIC ERROR INTERRUPT"})),
    ErrorOb(
        PULL_PLUG,
        "a module or submodule is removed, inserted or does not respond",
        _CLASSIC,
        frozenset({"I/O_FLT2", "PULL OR PLUG OF MODULES"}),
    ),
    ErrorOb(
        86,
        "a device or its network is lost or comes back",
        _CLASSIC,
        frozenset({"RACK_FLT", "RACK OR STATION FAILURE"}),
    ),
    ErrorOb(
        121,
        "a programming error, such as a data block that is not loaded",
        _CLASSIC | {"s7-1500"},
        frozenset({"PROG_ERR", "PROGRAMMING ERROR"}),
    ),
    ErrorOb(
        122,
        "the program accesses inputs or outputs of a device that is lost",
        _CLASSIC,
        frozenset({"MOD_ERR", "IO ACCESS ERROR"}),
    ),
)
"""In the order of their numbers. The names are those that STEP 7 V5 and the TIA Portal give new OBs (recalled)."""
