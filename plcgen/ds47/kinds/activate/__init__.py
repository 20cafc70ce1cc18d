"""Jobs that let a drive object take part or leave it out."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Literal

from pydantic import AfterValidator, BeforeValidator, Field

from plcgen.base.files.validation import StrictModel, problem
from plcgen.ds47.kind import JobKind, ReadItem, StepItem, Wait, WriteItem, short_form, within_limit
from plcgen.project.schema import Duration

ACTIVATES, ACTIVE = 105, 106
"""Drive object: 0 deactivated, 1 activated, 2 deactivated and not there; whether it is active (S120: p0105, r0106)."""


def _state(value: object) -> object:
    if (isinstance(value, str) and value not in {"not_present", "input"}) or type(value) is int:
        raise problem(f'"{value}" is not a state of a drive object', help_="write true, false, not_present or input")
    return {"state": value} if isinstance(value, bool | str) else value


class ActivateSettings(StrictModel):
    """Whether a drive object takes part, how long it may take until it says so, and how often it is asked."""

    state: bool | Literal["not_present", "input"] = Field(
        description="true: activated; false: deactivated; not_present: deactivated, its components are not there; "
        "input: what the block's input state says, 1, 0 or 2"
    )
    limit: Annotated[Duration, Field(ge=1_000)] = Field(
        60_000, description="longest time until r0106 says so, from 1 s; counted from the first poll"
    )
    interval: Annotated[Duration, Field(ge=100, le=60_000), AfterValidator(within_limit)] = Field(
        1_000, description="time between two polls, 100 ms to 1 min"
    )


_STATE = {"en-US": "1: activated, 0: deactivated, 2: deactivated, its components are not there"}


def _activate_steps(settings: ActivateSettings) -> Iterator[StepItem]:
    """Two steps: the drive object is told, and it is waited until it says so."""
    given = settings.state == "input"
    value = {"not_present": 2, "input": 1}.get(str(settings.state), int(settings.state is True))
    told = {"as": "state", "start": value, "comment": _STATE} if given else {"value": value}
    yield StepItem(1, (), WriteItem.model_validate({"parameter": f"P{ACTIVATES}", **told}))
    awaited = Wait("=", None, settings.limit, settings.interval, follows=given)
    yield StepItem(2, (), ReadItem.model_validate({"parameter": f"r{ACTIVE}", "as": "active"}), awaited, value % 2)


def _activate_title(settings: ActivateSettings) -> str:
    words = {"input": "Activate or deactivate", "True": "Activate"}
    return f"{words.get(str(settings.state), 'Deactivate')} the drive object"


ACTIVATE = JobKind(
    key="activate",
    place=90,
    writes=True,
    shape=Annotated[ActivateSettings, BeforeValidator(_state)],
    description="true, false, not_present, input: whether the drive object takes part; or {state, limit, interval}",
    example="activate: true",
    items=lambda settings: tuple(one.item for one in _activate_steps(settings)),
    short=short_form(ActivateSettings, (True, False, "not_present", "input")),
    steps=_activate_steps,
    fixed=True,
    types={f"P{ACTIVATES}": "Integer16", f"r{ACTIVE}": "Integer16"},
    title=_activate_title,
    permits=lambda settings: {ACTIVATES: f"the job says activate: {str(settings.state).lower()}"},
)
KINDS = (ACTIVATE,)
