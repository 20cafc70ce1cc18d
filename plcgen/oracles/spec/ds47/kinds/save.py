"""``save``: 1 (or the number of a setting) is written to p0971 or p0977, then it is read until it is 0.

The write is never sent twice, and from one save to the next ``distance`` must pass.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

from plcgen.oracles.spec.ds47.accesses import JobReader
from plcgen.oracles.spec.ds47.statement import StatedCondition, StatedStep
from plcgen.oracles.spec.place import milliseconds

NUMBERS = {"drive_object": "P971", "unit": "P977"}
"""S120 Function Manual Communication 12/2018; LAcycCom, DriveRamToRom."""
LIMIT_MS, INTERVAL_MS, DISTANCE_MS = 30_000, 1000, 600_000
NOT_SAVED = 0x8501


def saves(given: Any) -> bool:
    """Whether the drive is to save: ``ram`` says that it is not."""
    return given is not None and _persist(given) != "ram"


def _persist(given: Any) -> str:
    return str(given["persist"] if isinstance(given, Mapping) else given)


def command(given: Any) -> str:
    """The parameter that is written."""
    return NUMBERS[_persist(given)]


def settings(given: Any) -> Mapping[str, Any]:
    """The keys of the long form."""
    return given if isinstance(given, Mapping) else {}


def distance_ms(given: Any) -> int:
    """Shortest time from one save to the next."""
    return milliseconds(settings(given).get("distance"), DISTANCE_MS)


def save_steps(job: JobReader) -> Iterator[StatedStep]:
    """Write and question."""
    yield from save_steps_of(job, job.job["save"])


def save_steps_of(job: JobReader, given: Any) -> Iterator[StatedStep]:
    """The same at the end of a job that writes."""
    if not saves(given):
        return
    own = settings(given)
    item = replace(job.fixed(command(given)), value=own.get("setting") or 1)
    yield StatedStep("saves", (job.writes(item),), once=True)
    yield StatedStep(
        "asks whether it has saved",
        (job.reads(item, output="saving"),),
        until=(StatedCondition(0, "=", 0),),
        limit_ms=milliseconds(own.get("limit"), LIMIT_MS),
        interval_ms=milliseconds(own.get("interval"), INTERVAL_MS),
        pause_first=True,
        late=NOT_SAVED,
    )


STATEMENTS = {"save": save_steps}
