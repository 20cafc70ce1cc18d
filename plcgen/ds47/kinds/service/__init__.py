"""Jobs that read whatever parameter is asked for at run time, from a panel for example."""

from __future__ import annotations

from typing import Literal

from plcgen.ds47.kind import JobKind, ReadItem

IDENTIFICATION = "r964[0]"
"""What the inputs ask for before anybody has changed them: the manufacturer, which every PROFIdrive device has."""


def _items(_: str) -> tuple[ReadItem, ...]:
    return (ReadItem.model_validate({"parameter": IDENTIFICATION, "as": "value"}),)


SERVICE = JobKind(
    key="service",
    place=65,
    writes=False,
    shape=Literal["read"],
    description="read: number, index, count and drive object are inputs, and the answer says the type",
    example="service: read",
    items=_items,
    serves=True,
    title=lambda _: "Service: read any parameter",
)
KINDS = (SERVICE,)
