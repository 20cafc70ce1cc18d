"""``read``: every parameter is read once, in the order of the spec, and shown by its output."""

from __future__ import annotations

from collections.abc import Iterator

from plcgen.oracles.spec.ds47.accesses import JobReader
from plcgen.oracles.spec.ds47.statement import StatedStep


def read_steps(job: JobReader) -> Iterator[StatedStep]:
    """One step."""
    yield StatedStep("reads", tuple(job.reads(item) for item in job.items("read")))


STATEMENTS = {"read": read_steps}
