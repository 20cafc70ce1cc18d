"""Jobs that compare what the drive has with what it should have."""

from __future__ import annotations

from typing import Annotated

from plcgen.ds47.kind import JobKind, WriteItem
from plcgen.project.schema import short_items, short_items_schema

COMPARE = JobKind(
    key="compare",
    place=30,
    writes=False,
    shape=Annotated[tuple[WriteItem, ...], short_items("parameter")],
    description="parameter: value that the drive should have, as under write",
    example="compare: {P50303: 10.0}",
    short=lambda definitions: short_items_schema(definitions, "WriteItem", "parameter", lists=True),
    compares=True,
)
KINDS = (COMPARE,)
