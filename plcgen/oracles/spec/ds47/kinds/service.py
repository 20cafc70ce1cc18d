"""``service: read``: what the inputs name is read, at first r964[0], the manufacturer; the answer tells its type.

PROFIdrive's parameter 964 is the identification of the device: its first element is the number of the manufacturer.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from plcgen.oracles.spec.ds47.accesses import JobReader
from plcgen.oracles.spec.ds47.statement import StatedStep
from plcgen.oracles.spec.ds47.types import ANY, ROOM

FIRST = "r964[0]"


def service_steps(job: JobReader) -> Iterator[StatedStep]:
    """One access."""
    access = job.reads(job.fixed(FIRST), output="value", free=True)
    yield StatedStep("reads", (replace(access, type=ANY, size=ROOM, title="", unit="", letter="r"),))


STATEMENTS = {"service": service_steps}
