"""``compare``: every parameter is read once; values that differ from what is wanted are listed, nothing is written.

Floating-point numbers one unit in the last place apart are equal, and so are 0.0 and -0.0.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from plcgen.oracles.spec.ds47.accesses import JobReader
from plcgen.oracles.spec.ds47.statement import StatedStep


def compare_steps(job: JobReader) -> Iterator[StatedStep]:
    """One step: each access has the values that are wanted."""
    found = []
    for item in job.items("compare"):
        parameter = job.parameter(item)
        access = job.access(item, parameter, write=False, output="")
        found.append(replace(access, values=job.wanted(item, parameter)))
    yield StatedStep("compares", tuple(found))


STATEMENTS = {"compare": compare_steps}
