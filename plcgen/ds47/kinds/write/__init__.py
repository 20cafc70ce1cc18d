"""Jobs that write parameters."""

from __future__ import annotations

from typing import Annotated

from plcgen.ds47.kind import JobKind, WriteItem
from plcgen.project.schema import short_items, short_items_schema

WRITE = JobKind(
    key="write",
    place=20,
    writes=True,
    shape=Annotated[tuple[WriteItem, ...], short_items("parameter")],
    description="parameter: value (without one an input), parameter: {value, as, type, start}, or a list of such",
    example="write: {P50303: 10.0}",
    short=lambda definitions: short_items_schema(definitions, "WriteItem", "parameter", lists=True),
    bits=True,
    read_back=True,
)
KINDS = (WRITE,)
