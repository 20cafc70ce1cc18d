"""``clock: utc``: mode, procedure, days and milliseconds of the day, in one telegram and in this order.

LAcycCom 2.0.0 (``LAcycCom_RTCSinamicsAcyclic``); help on the control units: p3100 = 1 is UTC, p3103 = 2 set by p3101.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from plcgen.oracles.spec.ds47.accesses import JobReader
from plcgen.oracles.spec.ds47.statement import FromClock, Source, StatedStep

WRITES: tuple[tuple[str, Source], ...] = (
    ("p3100", 1),
    ("p3103", 2),
    ("p3101[1]", FromClock("days since 1970-01-01")),
    ("p3101[0]", FromClock("milliseconds of the day")),
)


def clock_steps(job: JobReader) -> Iterator[StatedStep]:
    """One telegram."""
    written = []
    for text, source in WRITES:
        access = job.writes(replace(job.fixed(text), value=0))
        written.append(replace(access, values=(source,)))
    yield StatedStep("writes", tuple(written), together=True)


STATEMENTS = {"clock": clock_steps}
