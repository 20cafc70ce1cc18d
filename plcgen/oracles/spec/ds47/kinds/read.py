"""``read``: every parameter is read once, in the order of the spec, and shown by its output.

``main_values`` stands for those that the profile of the device states, each shown by the output that it names.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from plcgen.oracles.spec.ds47.accesses import JobReader, SpecItem, camel
from plcgen.oracles.spec.ds47.statement import StatedStep

MAIN_VALUES = "main_values"


def read_steps(job: JobReader) -> Iterator[StatedStep]:
    """One step."""
    yield StatedStep("reads", tuple(job.reads(one) for item in job.items("read") for one in named(job, item)))


def named(job: JobReader, item: SpecItem) -> Iterator[SpecItem]:
    """The parameters for which an item stands."""
    if item.text != MAIN_VALUES:
        yield item
        return
    for name, text in job.drive.catalogue.main_values.items():
        settings = {"as": camel(name), "comment": item.settings.get("comment")}
        yield replace(item, text=text, settings=settings)


STATEMENTS = {"read": read_steps}
