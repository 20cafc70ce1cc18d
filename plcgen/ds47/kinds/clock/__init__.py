"""Jobs that set the clock of a control unit."""

from __future__ import annotations

from typing import Literal

from plcgen.ds47.kind import JobKind, WriteItem

UTC = 3100, 3103, 3101
"""Clock of a control unit: time stamps in UTC (1), set by p3101 (2), milliseconds of the day and days since 1970-01-01
(Siemens LAcycCom 2.0.0, LAcycCom_RTCSinamicsAcyclic, which writes them in this order: p3101[1], p3101[0])."""


def _clock_items(_: str) -> tuple[WriteItem, ...]:
    stamps, procedure, time = (f"P{number}" for number in UTC)
    names = (("days", 1), ("milliseconds", 0))
    moment = (WriteItem.model_validate({"parameter": f"{time}[{index}]", "as": name}) for name, index in names)
    return WriteItem(parameter=stamps, value=1), WriteItem(parameter=procedure, value=2), *moment


CLOCK = JobKind(
    key="clock",
    place=100,
    writes=True,
    shape=Literal["utc"],
    description="utc: sets the clock of the control unit to the time at the input utc",
    example="clock: utc",
    items=_clock_items,
    fixed=True,
    types=dict(zip((f"P{number}" for number in UTC), ("Unsigned16", "Integer16", "Unsigned32, array: 2"), strict=True)),
    sets_clock=True,
    runs_on={UTC[-1]: "it is a time, which keeps running"},
    title=lambda _: "Set the clock of the control unit",
)
KINDS = (CLOCK,)
