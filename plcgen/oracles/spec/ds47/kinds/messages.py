"""``faults`` and ``alarms``: counter, columns, counter; all of it again while the counter changes, ``tries`` at most.

A drive of which nobody knows that it has the counter is asked for the codes twice instead: columns, codes; all of it
again while the codes change.

``list`` has 8 places for what is present and 8 for each group of the history. The drive holds the faults of a case, and
the alarms that are present, in the order in which they came; alarms that have gone latest first.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Any

from plcgen.oracles.spec.ds47.accesses import JobReader
from plcgen.oracles.spec.ds47.statement import StatedList, StatedStep

GROUP, ALL, TRIES = 8, 7, 3
COLUMNS = ("code", "value", "received")
COUNTERS = MappingProxyType({"faults": 944, "alarms": 2121})
NUMBERS: Mapping[str, Mapping[str, int]] = MappingProxyType(
    {
        "faults": {
            "code": 945,
            "value": 949,
            "received": 948,
            "received_days": 2130,
            "removed": 2109,
            "removed_days": 2136,
            "float_value": 2133,
            "component": 3120,
            "drive_object": 3115,
        },
        "alarms": {
            "code": 2122,
            "value": 2124,
            "received": 2123,
            "received_days": 2145,
            "removed": 2125,
            "removed_days": 2146,
            "float_value": 2134,
            "component": 3121,
        },
    }
)
"""TIA Portal information system, parameters of the S120 (firmware 5.2)."""


def stated_list(kind: str, given: Any) -> StatedList:
    """What the list has."""
    own = given if isinstance(given, Mapping) else {"history": given}
    asked = own.get("history", 0)
    history = ALL if asked == "all" else 0 if asked == "current" else int(asked)
    columns = tuple(own.get("columns") or COLUMNS)
    return StatedList(kind, kind.removesuffix("s") + "Count", columns, 1 + history, kind == "faults")


def tries(given: Any) -> int:
    """How often the buffer is read at most."""
    return int(given.get("tries") or TRIES) if isinstance(given, Mapping) else TRIES


def fault_steps(job: JobReader) -> Iterator[StatedStep]:
    """Of ``faults``."""
    return _steps(job, "faults")


def alarm_steps(job: JobReader) -> Iterator[StatedStep]:
    """Of ``alarms``."""
    return _steps(job, "alarms")


def _steps(job: JobReader, kind: str) -> Iterator[StatedStep]:
    asked = stated_list(kind, job.job[kind])
    numbers, last = NUMBERS[kind], GROUP * asked.groups - 1
    columns = {name: job.reads(job.fixed(f"r{numbers[name]}[0..{last}]"), output="") for name in asked.columns}
    if not job.drive.catalogue.has(COUNTERS[kind]):
        yield StatedStep("reads the columns", tuple(columns.values()), ordered=False)
        yield StatedStep("reads the codes again", (columns["code"],))
        return
    counter = job.reads(job.fixed(f"r{COUNTERS[kind]}"), output="")
    yield StatedStep("reads the counter of changes", (counter,))
    yield StatedStep("reads the columns", tuple(columns.values()), ordered=False)
    yield StatedStep("reads the counter again", (counter,))


STATEMENTS = {"faults": fault_steps, "alarms": alarm_steps}
