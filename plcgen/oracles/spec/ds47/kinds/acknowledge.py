"""``acknowledge``: 1 is written to p3981, then it and the present fault case are read until all of them are 0.

The write is never sent twice. Whether p3981 or faults were left at the limit tells how it ends.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

from plcgen.oracles.spec.ds47.accesses import JobReader
from plcgen.oracles.spec.ds47.statement import StatedCondition, StatedStep
from plcgen.oracles.spec.place import milliseconds

COMMAND, CODES, PRESENT = "p3981", "r945[0..7]", 8
LIMIT_MS, INTERVAL_MS = 5000, 500
NOT_ACKNOWLEDGED, FAULTS_REMAIN = 0x8505, 0x8506


def acknowledge_steps(job: JobReader) -> Iterator[StatedStep]:
    """Write and question."""
    given = job.job["acknowledge"]
    own = given if isinstance(given, Mapping) else {}
    command = replace(job.fixed(COMMAND), value=1)
    yield StatedStep("acknowledges", (job.writes(command),), once=True)
    yield StatedStep(
        "asks whether it has",
        (job.reads(command, output="acknowledging"), job.reads(job.fixed(CODES), output="faultCodes")),
        until=(
            StatedCondition(0, "=", 0),
            *(StatedCondition(1, "=", 0, element=place, late=FAULTS_REMAIN) for place in range(PRESENT)),
        ),
        limit_ms=milliseconds(own.get("limit"), LIMIT_MS),
        interval_ms=milliseconds(own.get("interval"), INTERVAL_MS),
        pause_first=True,
        late=NOT_ACKNOWLEDGED,
    )


STATEMENTS = {"acknowledge": acknowledge_steps}
