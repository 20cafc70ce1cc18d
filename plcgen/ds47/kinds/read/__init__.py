"""Jobs that read parameters."""

from __future__ import annotations

from typing import Annotated

from plcgen.ds47.kind import JobKind, ReadItem
from plcgen.project.schema import ONE_OR_MORE, short_item, short_item_schema

READ = JobKind(
    key="read",
    place=10,
    writes=False,
    shape=Annotated[tuple[Annotated[ReadItem, short_item("parameter")], ...], ONE_OR_MORE],
    description="parameters to read; main_values: speed, current, torque and others that the profile states",
    example="read: [P50303]",
    short=lambda _: short_item_schema("ReadItem"),
)
KINDS = (READ,)
