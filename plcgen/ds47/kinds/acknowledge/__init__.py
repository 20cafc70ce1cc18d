"""Jobs that acknowledge the faults of a drive object."""

from __future__ import annotations

from typing import Annotated

from pydantic import AfterValidator, BeforeValidator, Field

from plcgen.base.files.validation import StrictModel, problem
from plcgen.ds47.kind import JobKind, Poll, ReadItem, WriteItem, short_form, within_limit
from plcgen.ds47.kinds.messages import COLUMN, FAULTS, PLACES
from plcgen.project.schema import Duration

ACKNOWLEDGES = 3981
"""Set to 1, the parameter acknowledges the faults of a drive object, and returns to 0 (S120: p3981)."""


def _meant(value: object) -> object:
    if value is False:
        raise problem("a job that does not acknowledge does nothing", help_="write true, or leave the job out")
    return {} if value is True else value


class AcknowledgeSettings(StrictModel):
    """How long a drive may take to acknowledge, and how often it is asked."""

    limit: Annotated[Duration, Field(ge=100, le=60_000)] = Field(
        5_000, description="longest time until the drive has no fault any more, 100 ms to 1 min"
    )
    interval: Annotated[Duration, Field(ge=100, le=10_000), AfterValidator(within_limit)] = Field(
        500, description="time between two polls, 100 ms to 10 s"
    )


def _acknowledge_items(_: AcknowledgeSettings) -> tuple[ReadItem | WriteItem, ...]:
    name, codes = f"P{ACKNOWLEDGES}", f"r{FAULTS['code']}[0..{PLACES - 1}]"
    asked = (
        ReadItem.model_validate({"parameter": text, "as": member})
        for text, member in ((name, "acknowledging"), (codes, "faultCodes"))
    )
    return WriteItem(parameter=name, value=1), *asked


ACKNOWLEDGE = JobKind(
    key="acknowledge",
    place=70,
    writes=True,
    shape=Annotated[AcknowledgeSettings, BeforeValidator(_meant)],
    description="true: acknowledge the faults of the drive object, or {limit, interval}",
    example="acknowledge: true",
    items=_acknowledge_items,
    short=short_form(AcknowledgeSettings, (True,)),
    poll=lambda settings: Poll(settings.interval, settings.limit, 0, "faults"),
    fixed=True,
    types={f"P{ACKNOWLEDGES}": "Unsigned8", f"r{FAULTS['code']}": COLUMN},
    title=lambda _: "Acknowledge the faults of the drive object",
)
KINDS = (ACKNOWLEDGE,)
