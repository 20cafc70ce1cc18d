"""``activate``: p0105 is written, then r0106 is read until the drive object is, or is no longer, active."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from types import MappingProxyType

from plcgen.oracles.spec.ds47.accesses import JobReader
from plcgen.oracles.spec.ds47.statement import FromInput, StatedCondition, StatedStep
from plcgen.oracles.spec.place import milliseconds

COMMAND, ANSWER = "p105", "r106"
"""TIA Portal information system, TM41; LAcycCom, DriveActDeact."""
STATES: Mapping[str, int] = MappingProxyType({"false": 0, "true": 1, "not_present": 2})
ACTIVE = 1
LIMIT_MS, INTERVAL_MS = 60_000, 1000
NOT_REACHED = 0x8510


def activate_steps(job: JobReader) -> Iterator[StatedStep]:
    """Write and question."""
    given = job.job["activate"]
    own = given if isinstance(given, Mapping) else {}
    state = str(own.get("state") if own else given).lower()
    source = FromInput("state", None, ACTIVE) if state == "input" else STATES[state]
    command = job.writes(replace(job.fixed(COMMAND), value=0))
    wanted = source if isinstance(source, FromInput) else int(source == ACTIVE)
    yield StatedStep("writes", (replace(command, values=(source,)),), number=1)
    yield StatedStep(
        "asks",
        (job.reads(job.fixed(ANSWER), output="active"),),
        until=(StatedCondition(0, "=", wanted),),
        limit_ms=milliseconds(own.get("limit"), LIMIT_MS),
        interval_ms=milliseconds(own.get("interval"), INTERVAL_MS),
        late=NOT_REACHED,
        number=2,
    )


STATEMENTS = {"activate": activate_steps}
