"""Which values do not go together, and with which code ``check`` refuses them: everything else must work."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product

from tests.pairs.cover import Possible, Row

Side = tuple[str, tuple[str, ...]]
"""A dimension and some of its values."""
WIDE = ("Integer64", "Unsigned64", "Float64")
TEXTS = ("VisibleString[1]", "VisibleString[5]", "OctetString[1]", "OctetString[4]")
TIMES = ("BinaryDate", "TimeOfDay")
G120 = "sinamics-g110m", "sinamics-g115d", "sinamics-g120", "sinamics-g120c", "sinamics-g120x"
SMALL = ("micromaster-4", *G120, "sinamics-v90")
"""Devices of one drive object."""
WHOLE = ("sinamics-g130", "sinamics-g150", "sinamics-s150", "sinamics-s210")
"""Devices whose lists were read whole: they lack any number that is in none."""
RECIPES = ("write_recipe", "read_recipe", "compare_recipe")
LISTS = (
    "bits", "readback", "saved", "restore", "save", "faults", "alarms", "acknowledge", "compare", "steps", "until",
    "activate", "clock", "untyped", "service", "served", *RECIPES,
)  # fmt: skip
"""Kinds of more than one telegram, or that deliver a list, or whose answers have no fixed places."""
WRITERS = (
    "write", "input", "bits", "readback", "saved", "restore", "save", "acknowledge", "steps", "until", "activate",
    "clock", "write_recipe", "read_recipe",
)  # fmt: skip
"""Kinds that change something, in the drive or in a record."""
OWN = ("buffers", ("db", "numbers", "sizes", "members"))

Refusal = tuple[tuple[Side, ...], str]
DRIVES: tuple[Refusal, ...] = (
    ((("toolchain", ("step7-v5",)), ("family", ("s7-1200", "s7-1500"))), "PG214"),
    ((("device", SMALL), ("drives", ("unit",))), "PG217"),
    ((("trigger", ("inputs",)),), "PG404"),
    ((("trigger", ("bit", "flags", "symbol", "tags")), ("drives", ("list",))), "PG404"),
    ((("type", TEXTS), ("index", ("range", "many", "last", "high"))), "PG206"),
    ((("scale", ("0.5",)), ("type", ("Boolean", "FloatingPoint", "Float64", *TEXTS, *TIMES))), "PG107"),
    ((("kind", ("until",)), ("index", ("range", "many"))), "PG251"),
    ((("kind", ("until",)), ("type", TEXTS)), "PG251"),
    ((("kind", ("until",)), ("type", ("Float64",)), ("family", ("s7-300", "s7-400"))), "PG251"),
    ((("kind", ("compare",)), ("type", (*WIDE, *TIMES, *TEXTS))), "PG249"),
    ((("kind", ("compare_recipe",)), ("type", WIDE)), "PG249"),
    ((("kind", RECIPES), ("type", (*TEXTS, *TIMES))), "PG255"),
    ((("kind", RECIPES), ("type", WIDE), ("family", ("s7-300", "s7-400"))), "PG255"),
    ((("kind", RECIPES), ("type", ("Integer64", "Unsigned64")), ("family", ("s7-1200",))), "PG255"),
    ((("kind", ("restore",)), ("index", ("many",))), "PG258"),
    ((OWN, ("drives", ("list",))), "PG223"),
    ((OWN, ("index", ("many",))), "PG223"),
    ((OWN, ("kind", LISTS)), "PG223"),
    ((OWN, ("kind", ("input",)), ("type", ("Float64",)), ("family", ("s7-1200", "s7-1500"))), "PG223"),
    ((OWN, ("kind", ("input",)), ("type", ("Integer64", "Unsigned64")), ("family", ("s7-1500",))), "PG223"),
    ((("kind", WRITERS), ("cycle", ("100ms", "1s", "1h"))), "PG264"),
    ((("kind", ("service", "served")), ("cycle", ("100ms", "1s", "1h"))), "PG264"),
    ((("kind", ("untyped",)), ("device", WHOLE)), "PG262"),
    ((("kind", ("main_values",)), ("device", ("profidrive", "sinamics-dcp", "./acme.yaml"))), "PG248"),
    ((("kind", ("faults", "alarms", "acknowledge", "activate", "clock")), ("device", ("./acme.yaml",))), "PG248"),
    ((("kind", ("faults",)), ("device", ("micromaster-4", "profidrive", "sinamics-dcp"))), "PG248"),
    ((("kind", ("alarms",)), ("device", ("micromaster-4", "sinamics-dcp"))), "PG248"),
    ((("kind", ("alarms", "acknowledge", "activate", "clock")), ("device", ("profidrive",))), "PG262"),
    ((("kind", ("acknowledge",)), ("device", ("micromaster-4", "sinamics-dcp"))), "PG248"),
    ((("kind", ("activate",)), ("device", ("sinamics-v90", "sinamics-dcm", "sinamics-dcp"))), "PG248"),
    ((("kind", ("activate",)), ("device", ("micromaster-4",))), "PG262"),
    ((("kind", ("clock",)), ("device", ("micromaster-4", "sinamics-v90", "sinamics-dcp"))), "PG248"),
    ((("kind", ("activate", "clock")), ("device", G120)), "PG262"),
    ((("kind", ("acknowledge", "activate", "clock", "save", "saved")), ("device", ("sinamics-s210",))), "PG262"),
)
"""All sides together are refused with the code, whatever else the row says."""


def possible(refusals: Sequence[Refusal]) -> Possible:
    """Whether nothing in a row is refused, by a bit for each side; dimensions that are missing do not count."""
    bits: dict[tuple[str, str], int] = {}
    needs: list[int] = []
    number = 0
    for sides, _ in refusals:
        needs.append(((1 << len(sides)) - 1) << number)
        for name, values in sides:
            for value in values:
                bits[name, value] = bits.get((name, value), 0) | 1 << number
            number += 1

    def looked_up(row: Mapping[str, str]) -> bool:
        has = 0
        for item in row.items():
            has |= bits.get(item, 0)
        return not [need for need in needs if has & need == need]

    return looked_up


def impossible(base: Row, refusals: Sequence[Refusal]) -> list[tuple[Row, str]]:
    """A row for everything that does not go together, with its code; all else is that of the base."""
    found: list[tuple[Row, str]] = []
    for sides, code in refusals:
        names = [name for name, _ in sides]
        every = product(*(values for _, values in sides))
        found += [({**base, **dict(zip(names, values, strict=True))}, code) for values in every]
    return found
