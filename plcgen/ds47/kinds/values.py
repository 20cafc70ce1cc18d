"""Jobs that read, write or compare parameters that the spec names."""

from __future__ import annotations

from typing import Annotated

from plcgen.ds47.kinds.kind import JobKind, ReadItem, WriteItem
from plcgen.project.schema import ONE_OR_MORE, short_item, short_item_schema, short_items, short_items_schema

READ = JobKind(
    key="read",
    writes=False,
    shape=Annotated[tuple[Annotated[ReadItem, short_item("parameter")], ...], ONE_OR_MORE],
    description="parameters to read",
    example="read: [P50303]",
    short=lambda _: short_item_schema("ReadItem"),
)

WRITE = JobKind(
    key="write",
    writes=True,
    shape=Annotated[tuple[WriteItem, ...], short_items("parameter")],
    description="parameter: value, parameter: {value, as, type, start}, or a list of such",
    example="write: {P50303: 10.0}",
    short=lambda definitions: short_items_schema(definitions, "WriteItem", "parameter", lists=True),
    bits=True,
    read_back=True,
)

COMPARE = JobKind(
    key="compare",
    writes=False,
    shape=Annotated[tuple[WriteItem, ...], short_items("parameter")],
    description="parameter: value that the drive should have, as under write",
    example="compare: {P50303: 10.0}",
    short=lambda definitions: short_items_schema(definitions, "WriteItem", "parameter", lists=True),
    compares=True,
)
