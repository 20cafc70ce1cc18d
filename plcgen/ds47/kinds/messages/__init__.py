"""Jobs that list the fault buffer or the alarm buffer of a drive object."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Annotated, Any, Literal, get_args

from pydantic import AfterValidator, BeforeValidator, Field

from plcgen.base.files.validation import StrictModel, problem
from plcgen.ds47.kind import MESSAGE_GROUP, Items, JobKind, Messages, ReadItem, short_form
from plcgen.s7.types.names import camel_case

FaultColumn = Literal[
    "code", "value", "received", "received_days", "removed", "removed_days", "float_value", "component", "drive_object"
]
AlarmColumn = Literal[
    "code", "value", "received", "received_days", "removed", "removed_days", "float_value", "component"
]
FAULTS: Mapping[str, int] = dict(
    zip(get_args(FaultColumn), (945, 949, 948, 2130, 2109, 2136, 2133, 3120, 3115), strict=True)
)
"""Columns of the fault buffer: eight faults of the present case, then those of seven cases that were acknowledged."""
ALARMS: Mapping[str, int] = dict(
    zip(get_args(AlarmColumn), (2122, 2124, 2123, 2145, 2125, 2146, 2134, 3121), strict=True)
)
"""Columns of the alarm buffer: eight alarms that are present, then 56 that have gone."""
FAULT_COUNTER, ALARM_COUNTER = 944, 2121
"""Each change of a buffer raises its counter: to find out whether it was read consistently (S120: r0944)."""
PLACES = MESSAGE_GROUP
COLUMN = ".., array: 64"
"""What a spec says of a column whose type nobody has looked up: it has an element for each place of eight groups."""


WHOLE: Mapping[str, Mapping[str, int]] = {"current": {}, "all": {"history": 7}}
"""Words for how much of a buffer is read."""


def _whole(value: object) -> object:
    if isinstance(value, bool):
        help_ = "current reads those that are present, all their history too"
        raise problem(f'"{str(value).lower()}" does not say how much of the buffer is read', help_=help_)
    if not isinstance(value, str):
        return value
    if value not in WHOLE:
        raise problem(f'"{value}" is neither current nor all', help_="or write a mapping: {history: 2}")
    return WHOLE[value]


def _listed_once(columns: tuple[str, ...]) -> tuple[str, ...]:
    twice = next((name for name in columns if columns.count(name) > 1), None)
    if twice is not None:
        raise problem(f"{twice} is named twice", help_="name every column once")
    if "code" not in columns:
        raise problem("without its code nobody knows what a message says", help_="add code")
    return columns


class MessageSettings(StrictModel):
    """How much of a buffer is read, what of each message, and how often it is tried."""

    history: int = Field(
        0,
        ge=0,
        le=7,
        description="number of acknowledged fault cases to read as well, or of groups of eight alarms that have gone",
    )
    tries: int = Field(3, ge=1, le=10, description="how many times a buffer is read that changes in the meantime")


class FaultSettings(MessageSettings):
    """A job that reads the fault buffer."""

    columns: Annotated[tuple[FaultColumn, ...], AfterValidator(_listed_once)] = Field(
        ("code", "value", "received"), description="what is read of each fault"
    )


class AlarmSettings(MessageSettings):
    """A job that reads the alarm buffer."""

    columns: Annotated[tuple[AlarmColumn, ...], AfterValidator(_listed_once)] = Field(
        ("code", "value", "received"), description="what is read of each alarm"
    )


def _message_items(counter: int, numbers: Mapping[str, int], settings: Any) -> tuple[ReadItem, ...]:
    """Counter, groups, counter; in a group the columns in the order of the spec."""
    found = [(f"r{counter}", "changes")]
    for group in range(settings.history + 1):
        indexes = f"[{PLACES * group}..{PLACES * group + PLACES - 1}]"
        found += [(f"r{numbers[name]}{indexes}", camel_case(f"{name}_{group + 1}")) for name in settings.columns]
    found.append((f"r{counter}", "changesAgain"))
    return tuple(ReadItem.model_validate({"parameter": text, "as": name}) for text, name in found)


def _on_a_drive(items: Items, has: Callable[[str], bool]) -> Items:
    """All of them, if it is known to have the counter; else the columns, and the codes again.

    Siemens' LAcycCom reads messages of G120 and V90 without a counter.
    """
    counter, *columns, _ = items
    if has(counter.parameter):
        return items
    codes = (one for one in columns if (one.as_ or "").startswith("code"))
    return *columns, *(one.model_copy(update={"as_": f"{one.as_}Again"}) for one in codes)


def _messages(settings: Any, *, history: bool) -> Messages:
    """``history``: whether messages that have gone are turned round like the others."""
    return Messages(settings.columns, (True, *(history,) * settings.history), settings.tries)


def _title(key: str, settings: Any) -> str:
    return f"Read the {key} that are present{' and their history' if settings.history else ''}"


def _buffer_kind(key: str, what: str, shape: Any, counter: int, numbers: Mapping[str, int], place: int) -> JobKind:
    return JobKind(
        key=key,
        place=place,
        writes=False,
        shape=Annotated[shape, BeforeValidator(_whole)],
        description=f"current or all: the {what} buffer of the drive object, or {{history, columns, tries}}",
        example=f"{key}: current",
        items=partial(_message_items, counter, numbers),
        short=short_form(shape, WHOLE),
        messages=partial(_messages, history=key == "faults"),
        fixed=True,
        on=_on_a_drive,
        types={f"r{counter}": "Unsigned16", **{f"r{number}": COLUMN for number in numbers.values()}},
        title=partial(_title, key),
    )


KINDS = (
    _buffer_kind("faults", "fault", FaultSettings, FAULT_COUNTER, FAULTS, 50),
    _buffer_kind("alarms", "alarm", AlarmSettings, ALARM_COUNTER, ALARMS, 60),
)
