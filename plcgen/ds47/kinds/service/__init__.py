"""Jobs that read whatever parameter is asked for at run time, from a panel for example; some write, too."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from plcgen.base.files.validation import StrictModel
from plcgen.ds47.kind import JobKind, ReadItem, short_form

IDENTIFICATION = "r964[0]"
"""What the inputs ask for before anybody has changed them: the manufacturer, which every PROFIdrive device has."""


class ServiceSettings(StrictModel):
    """What a service does besides reading."""

    write: bool = Field(
        default=False,
        description="true: it writes, too, if enableWrite is TRUE: harmless parameters and those of allow",
    )


def _items(_: str | ServiceSettings) -> tuple[ReadItem, ...]:
    return (ReadItem.model_validate({"parameter": IDENTIFICATION, "as": "value"}),)


def _changes(value: str | ServiceSettings) -> bool:
    return isinstance(value, ServiceSettings) and value.write


SERVICE = JobKind(
    key="service",
    place=65,
    writes=False,
    shape=Literal["read"] | ServiceSettings,
    description="read: number, index, count and drive object are inputs, and the answer says the type; {write: true}: "
    "it writes, too",
    example="service: read",
    items=_items,
    serves=True,
    changes=_changes,
    short=short_form(ServiceSettings, ("read",)),
    title=lambda value: f"Service: read any parameter{', write harmless ones' if _changes(value) else ''}",
)
KINDS = (SERVICE,)
