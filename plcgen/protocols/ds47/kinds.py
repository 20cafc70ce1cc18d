"""The kinds of drive jobs: which key of a job says what it does, and which accesses to parameters that means.

A kind is a ``JobKind`` in ``SHIPPED``, or one that another distribution brings by an entry point of the group
``plcgen.kinds``. Everything else follows: schema and completion, telegrams, blocks, proof.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache, partial
from typing import Annotated, Any, Literal, get_args

from pydantic import AfterValidator, BeforeValidator, Field, ValidationInfo, model_validator

from plcgen.input.validation import StrictModel, problem
from plcgen.input.yaml import resolve_plain
from plcgen.plugins import plugins
from plcgen.project.schema import (
    COMMENT,
    OF_AN_INPUT,
    ONE_OR_MORE,
    Duration,
    Text,
    Value,
    short_item,
    short_item_schema,
    short_items,
    short_items_schema,
)
from plcgen.s7.names import camel_case

GROUP = "plcgen.kinds"


class ReadItem(StrictModel):
    """One parameter to read."""

    parameter: str = Field(description="P50303, p2155[1..2], r0945[0..7] or a catalogue name")
    as_: str | None = Field(None, alias="as", description="name of the block's output")
    type: str | None = Field(None, description="DS47 data type if the catalogue has none")
    comment: Text | None = Field(None, description=COMMENT)


class WriteItem(StrictModel):
    """One parameter to write or to compare; without a value it becomes an input of the block."""

    parameter: str = Field(description="P50304, p2155[1..2] or a catalogue name")
    value: Value | tuple[Value, ...] | None = Field(None, description="constant; absent: block input")
    as_: str | None = Field(None, alias="as", description="name of the block's input")
    type: str | None = Field(None, description="DS47 data type if the catalogue has none")
    start: Annotated[Value | tuple[Value, ...] | None, OF_AN_INPUT] = Field(
        None, description="start value of the input"
    )
    comment: Text | None = Field(None, description=COMMENT)


def _lasting(value: object) -> object:
    if value == "ram":
        message = "a value is in the RAM of the drive as soon as it is written: there is nothing to save"
        raise problem(message, help_="leave the job out, or choose drive_object or unit")
    return value


def _within_limit(interval: int, info: ValidationInfo) -> int:
    limit = info.data.get("limit")
    if limit is not None and interval > limit:
        raise problem("the first question comes after the limit", help_="make interval shorter or limit longer")
    return interval


class SaveSettings(StrictModel):
    """What a drive saves, how long that may take, and how often it may happen."""

    persist: Annotated[Literal["drive_object", "unit"], BeforeValidator(_lasting)] = Field(
        description="drive_object: p0971, parameters of the job's drive object; unit: p0977, those of the whole unit"
    )
    limit: Annotated[Duration, Field(ge=1_000, le=600_000)] = Field(
        30_000, description="longest time until the parameter returns to 0, 1 s to 10 min"
    )
    interval: Annotated[Duration, Field(ge=100, le=10_000), AfterValidator(_within_limit)] = Field(
        1_000, description="from one question whether it has returned to 0 to the next, 100 ms to 10 s"
    )
    distance: Annotated[Duration, Field(ge=60_000)] = Field(
        600_000, description="shortest time from one save to the next, at least 1 min"
    )
    setting: Literal[10, 11, 12] | None = Field(
        None, description="saves as this setting, beside the one that is loaded at power-on"
    )


def _meant(value: object) -> object:
    if value is False:
        raise problem("a job that shall not acknowledge is none", help_="write true, or leave the job out")
    return {} if value is True else value


class AcknowledgeSettings(StrictModel):
    """How long a drive may take to acknowledge, and how often it is asked."""

    limit: Annotated[Duration, Field(ge=100, le=60_000)] = Field(
        5_000, description="longest time until the drive has no fault any more, 100 ms to 1 min"
    )
    interval: Annotated[Duration, Field(ge=100, le=10_000), AfterValidator(_within_limit)] = Field(
        500, description="from one question to the next, 100 ms to 10 s"
    )


def _state(value: object) -> object:
    if isinstance(value, str) and value not in {"not_present", "input"}:
        raise problem(f'"{value}" is no state of a drive object', help_="write true, false, not_present or input")
    return {"state": value} if isinstance(value, bool | str) else value


class ActivateSettings(StrictModel):
    """Whether a drive object takes part, how long it may take until it says so, and how often it is asked."""

    state: bool | Literal["not_present", "input"] = Field(
        description="true: activated; false: deactivated; not_present: deactivated, its components are not there; "
        "input: what the block's input state says, 1, 0 or 2"
    )
    limit: Annotated[Duration, Field(ge=1_000)] = Field(
        60_000, description="longest time until r0106 says so, from 1 s; counted from the first question"
    )
    interval: Annotated[Duration, Field(ge=100, le=60_000), AfterValidator(_within_limit)] = Field(
        1_000, description="from one question to the next, 100 ms to 1 min"
    )


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
PLACES = 8
"""Messages of a fault case, and alarms that are present."""


WHOLE: Mapping[str, Mapping[str, int]] = {"current": {}, "all": {"history": 7}}
"""Words for how much of a buffer is read."""


def _whole(value: object) -> object:
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
        0, ge=0, le=7, description="so many acknowledged fault cases too, or so many times eight alarms that have gone"
    )
    tries: int = Field(3, ge=1, le=10, description="how often a buffer is read that changes meanwhile")


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


_COMPARISON = re.compile(r"\s*(<>|<=|>=|<|>|=)\s*(.*?)\s*\Z", re.DOTALL)
_BIT = re.compile(r"\s*([A-Za-z_0-9]+(?:\s*\[\s*[0-9]{1,6}\s*\])?)\s*\.\s*([0-9]{1,2})\s*\Z")


class WaitCondition(StrictModel):
    """What a value of the drive must be: ``r722.0: 1``, ``r21: "> 100.0"``; ``place`` counts the keys."""

    parameter: str
    place: int
    bit: int | None
    operator: str
    value: Value


class WaitSettings(StrictModel):
    """A step that waits: conditions that must all be true in one answer, how long, and how often it is asked."""

    conditions: tuple[WaitCondition, ...]
    timeout: Annotated[Duration, Field(ge=100)] = Field(10_000, description="longest time that is waited, from 100 ms")
    interval: Annotated[Duration, Field(ge=100, le=60_000)] = Field(
        500, description="from one question to the next, 100 ms to 1 min"
    )

    @model_validator(mode="after")
    def _in_time(self) -> WaitSettings:
        if self.interval > self.timeout:
            raise problem(
                "the second question comes after the timeout", help_="make interval shorter or timeout longer"
            )
        return self


def _condition(place: int, key: str, value: Any) -> dict[str, Any]:
    if not isinstance(value, bool | int | float | str) or value == "":
        help_ = f'for example {{{key}: 1}} or {{{key}: "> 100.0"}}'
        raise problem(f"it is not said what {key} must be", help_=help_)
    operator = "="
    wanted: bool | int | float | str | None = value
    compared = _COMPARISON.match(value) if isinstance(value, str) else None
    if compared is not None:
        operator, wanted = compared[1], resolve_plain(compared[2])
    if wanted is None or wanted == "":
        raise problem(f'"{value}" compares {key} with nothing', help_=f'for example "{operator} 100.0"')
    found = _BIT.match(key)
    return {
        "parameter": key if found is None else found[1],
        "place": place,
        "bit": None if found is None else int(found[2]),
        "operator": operator,
        "value": wanted,
    }


WAIT_TIMES = ("timeout", "interval")
"""Keys of a step that waits, beside those that name parameters."""


def _conditions(value: object) -> object:
    """``{r722.0: 1, timeout: 5s}`` with its conditions as a list; they stand where their keys do."""
    if not isinstance(value, dict):
        return value
    conditions = tuple(
        _condition(place, str(key), wanted)
        for place, (key, wanted) in enumerate(value.items())
        if key not in WAIT_TIMES
    )
    if not conditions:
        raise problem("it is not said for what the step waits", help_="for example {r722.0: 1, timeout: 5s}")
    return {"conditions": conditions, **{key: value[key] for key in WAIT_TIMES if key in value}}


class SequenceStep(StrictModel):
    """One step of a sequence: it reads, it writes, or it waits for values."""

    read: Annotated[tuple[Annotated[ReadItem, short_item("parameter")], ...] | None, ONE_OR_MORE] = Field(
        None, description="parameters to read, as in a job"
    )
    write: Annotated[tuple[WriteItem, ...] | None, short_items("parameter")] = Field(
        None, description="parameter: value, as in a job"
    )
    until: Annotated[WaitSettings | None, BeforeValidator(_conditions)] = Field(
        None, description="parameter: value, or a bit (r722.0: 1), or a comparison in quotes; timeout, interval"
    )

    @model_validator(mode="after")
    def _one_thing(self) -> SequenceStep:
        given = [key for key in SequenceStep.model_fields if getattr(self, key)]
        if len(given) != 1:
            what = " and ".join(given) if given else "nothing"
            help_ = "a step is one of read, write, until: make a step of each"
            raise problem(f"a step does one thing, this one {what}", help_=help_)
        return self


@dataclass(frozen=True, slots=True)
class Awaited:
    """What a value that is read must be: as ``operator`` says, compared with the value that its use has.

    ``bit`` is the only one that counts, if it is not None; ``limit`` is how long it is waited for, ``interval`` the
    time from one question to the next, both in ms. ``follows``: what is wanted is bit 0 of what the first telegram of
    the job has written.
    """

    operator: str
    bit: int | None
    limit: int
    interval: int
    follows: bool = False


@dataclass(frozen=True, slots=True)
class StepItem:
    """An access of a step: its number from 1, where it stands below the sequence, and what it waits for.

    ``wanted`` is the value with which it is compared.
    """

    step: int
    place: tuple[str | int, ...]
    item: ReadItem | WriteItem
    awaited: Awaited | None = None
    wanted: Value = 0


def step_items(steps: tuple[SequenceStep, ...]) -> Iterator[StepItem]:
    """Every access of a sequence, in order."""
    for number, step in enumerate(steps, 1):
        for place, item in enumerate(step.read or ()):
            yield StepItem(number, (number - 1, "read", place), item)
        for place, written in enumerate(step.write or ()):
            yield StepItem(number, (number - 1, "write", place), written)
        if step.until is None:
            continue
        for one in step.until.conditions:
            awaited = Awaited(one.operator, one.bit, step.until.timeout, step.until.interval)
            asked = ReadItem(parameter=one.parameter)
            yield StepItem(number, (number - 1, "until", one.place), asked, awaited, one.value)


def _steps_schema(definitions: dict[str, Any]) -> dict[str, Any]:
    """A list of steps, whose keys have the short forms of jobs."""
    value = {"type": ["boolean", "integer", "number", "string"]}
    times = {key: definitions["WaitSettings"]["properties"][key] for key in WAIT_TIMES}
    step = definitions["SequenceStep"]["properties"]
    for key, shape in (
        ("read", short_item_schema("ReadItem")),
        ("write", short_items_schema(definitions, "WriteItem", "parameter", lists=True)),
        ("until", {"type": "object", "properties": times, "additionalProperties": value, "minProperties": 1}),
    ):
        step[key] = {**shape, "description": step[key]["description"]}
    for name in ("WaitSettings", "WaitCondition"):
        del definitions[name]
    return {"anyOf": [{"type": "array", "minItems": 1, "items": {"$ref": "#/$defs/SequenceStep"}}, {"type": "null"}]}


@dataclass(frozen=True, slots=True)
class Messages:
    """A buffer of messages: its accesses are the counter, for each group of eight every column, the counter again.

    ``columns`` are those of the buffer's parameters in the order in which they are read; ``latest_last`` says of each
    group whether the drive has the latest message at its end, as all groups of the fault buffer and the alarms that are
    present; ``tries`` how often all of it is read until the counter has not changed.
    """

    columns: tuple[str, ...]
    latest_last: tuple[bool, ...]
    tries: int


@dataclass(frozen=True, slots=True)
class Poll:
    """The last telegram of a job is sent again and again until all its values are 0.

    Times in ms: ``interval`` from one to the next, ``limit`` for all of them, counted from the answer to the telegram
    in front of it; ``distance`` is how long after that telegram was handed over the job refuses to start again, 0 if it
    never does.
    """

    interval: int
    limit: int
    distance: int

    @property
    def saves(self) -> bool:
        """Whether it waits for a drive that saves; else for one that acknowledges its faults."""
        return self.distance > 0


@dataclass(frozen=True, slots=True)
class JobKind:
    """A kind of job.

    ``key`` is its key in a job, ``shape`` the type of the value below it, ``example`` how a spec writes it; ``items``
    are the accesses that the value stands for, in the order of their telegrams, ``writes`` whether any of them changes
    parameters. ``short`` makes the JSON schema of the value, short forms included, from the definitions of the spec's
    schema (None: as ``shape`` says it). ``poll`` says that the last access is a read that is repeated,
    ``messages`` that the accesses are those of a buffer of messages, ``compares`` that the values of ``WriteItem`` are
    not written, but held against those that are read; ``steps`` says which accesses
    belong to which step of a sequence. ``recorded``: the value names a recipe, for which ``items`` are asked.
    """

    key: str
    writes: bool
    shape: Any
    description: str
    example: str
    items: Callable[[Any], tuple[ReadItem | WriteItem, ...]] = tuple
    short: Callable[[dict[str, Any]], dict[str, Any]] | None = None
    poll: Callable[[Any], Poll] | None = None
    messages: Callable[[Any], Messages] | None = None
    compares: bool = False
    steps: Callable[[Any], Iterator[StepItem]] | None = None
    recorded: bool = False


SAVES = {"drive_object": 971, "unit": 977}
"""Set to 1, the parameter starts saving, and returns to 0 when that has ended (S120: p0971, S210: p0977)."""


_SAVING = {
    "en-US": "as last read: 0 when the drive has saved",
    "de-DE": "zuletzt gelesen: 0, wenn der Antrieb gespeichert hat",
    "zh-CN": "最近一次读取值：驱动器保存完成后为 0",
}


def _save_items(settings: SaveSettings) -> tuple[ReadItem | WriteItem, ...]:
    name = f"P{SAVES[settings.persist]}"
    asked = {"parameter": name, "as": "saving", "comment": _SAVING}
    return WriteItem(parameter=name, value=settings.setting or 1), ReadItem.model_validate(asked)


ACKNOWLEDGES = 3981
"""Set to 1, the parameter acknowledges the faults of a drive object, and returns to 0 (S120: p3981)."""


def _acknowledge_items(_: AcknowledgeSettings) -> tuple[ReadItem | WriteItem, ...]:
    name, codes = f"P{ACKNOWLEDGES}", f"r{FAULTS['code']}[0..{PLACES - 1}]"
    asked = (
        ReadItem.model_validate({"parameter": text, "as": member})
        for text, member in ((name, "acknowledging"), (codes, "faultCodes"))
    )
    return WriteItem(parameter=name, value=1), *asked


ACTIVATES, ACTIVE = 105, 106
"""Drive object: 0 deactivated, 1 activated, 2 deactivated and not there; whether it is active (S120: p0105, r0106)."""


_STATE = {
    "en-US": "1: activated, 0: deactivated, 2: deactivated, its components are not there",
    "de-DE": "1: aktiviert, 0: deaktiviert, 2: deaktiviert, seine Komponenten sind nicht da",
    "zh-CN": "1：激活，0：禁用，2：禁用且组件不存在",
}


def _activate_steps(settings: ActivateSettings) -> Iterator[StepItem]:
    """Two steps: the drive object is told, and it is waited until it says so."""
    given = settings.state == "input"
    value = {"not_present": 2, "input": 1}.get(str(settings.state), int(settings.state is True))
    told = {"parameter": f"P{ACTIVATES}", **({"as": "state", "comment": _STATE} if given else {"value": value})}
    yield StepItem(1, (), WriteItem.model_validate(told))
    awaited = Awaited("=", None, settings.limit, settings.interval, follows=given)
    yield StepItem(2, (), ReadItem.model_validate({"parameter": f"r{ACTIVE}", "as": "active"}), awaited, value % 2)


UTC = 3100, 3103, 3101
"""Clock of a control unit: time stamps in UTC (1), set by p3101 (2), milliseconds of the day and days since 1970-01-01
(Siemens LAcycCom 2.0.0, LAcycCom_RTCSinamicsAcyclic, which writes them in this order: p3101[1], p3101[0])."""


def _clock_items(_: str) -> tuple[WriteItem, ...]:
    stamps, procedure, time = (f"P{number}" for number in UTC)
    names = (("days", 1), ("milliseconds", 0))
    moment = (WriteItem.model_validate({"parameter": f"{time}[{index}]", "as": name}) for name, index in names)
    return WriteItem(parameter=stamps, value=1), WriteItem(parameter=procedure, value=2), *moment


def _message_items(counter: int, numbers: Mapping[str, int], settings: Any) -> tuple[ReadItem, ...]:
    """Counter, groups, counter; in a group the columns in the order of the spec."""
    found = [(f"r{counter}", "changes")]
    for group in range(settings.history + 1):
        indexes = f"[{PLACES * group}..{PLACES * group + PLACES - 1}]"
        found += [(f"r{numbers[name]}{indexes}", camel_case(f"{name}_{group + 1}")) for name in settings.columns]
    found.append((f"r{counter}", "changesAgain"))
    return tuple(ReadItem.model_validate({"parameter": text, "as": name}) for text, name in found)


def _messages(settings: Any, *, history: bool) -> Messages:
    """``history``: whether messages that have gone are turned round like the others."""
    return Messages(settings.columns, (True, *(history,) * settings.history), settings.tries)


def _short(settings: type, words: Iterable[object]) -> Callable[[Any], dict[str, Any]]:
    """Schema of a kind that is one of some words, or its settings."""
    return lambda _: {"anyOf": [{"enum": [*words]}, {"$ref": f"#/$defs/{settings.__name__}"}, {"type": "null"}]}


def _buffer_kind(key: str, what: str, shape: Any, counter: int, numbers: Mapping[str, int]) -> JobKind:
    return JobKind(
        key=key,
        writes=False,
        shape=Annotated[shape, BeforeValidator(_whole)],
        description=f"current or all: the {what} buffer of the drive object, or {{history, columns, tries}}",
        example=f"{key}: current",
        items=partial(_message_items, counter, numbers),
        short=_short(shape, WHOLE),
        messages=partial(_messages, history=key == "faults"),
    )


def _members(recipe: Any) -> tuple[WriteItem, ...]:
    """The parameters of a recipe, whatever becomes of them: what they start with is that of the records."""
    return tuple(WriteItem(**item.model_dump(by_alias=True)) for item in recipe.parameters)


def _recipe_kind(key: str, does: str) -> JobKind:
    return JobKind(
        key=f"{key}_recipe",
        writes=key == "write",
        shape=Annotated[str, Field(min_length=1)],
        description=f"key of a recipe: {does}",
        example=f"{key}_recipe: winding",
        items=_members,
        compares=key == "compare",
        recorded=True,
    )


SHIPPED = (
    JobKind(
        key="read",
        writes=False,
        shape=Annotated[tuple[Annotated[ReadItem, short_item("parameter")], ...], ONE_OR_MORE],
        description="parameters to read",
        example="read: [P50303]",
        short=lambda _: short_item_schema("ReadItem"),
    ),
    JobKind(
        key="write",
        writes=True,
        shape=Annotated[tuple[WriteItem, ...], short_items("parameter")],
        description="parameter: value, parameter: {value, as, type, start}, or a list of such",
        example="write: {P50303: 10.0}",
        short=lambda definitions: short_items_schema(definitions, "WriteItem", "parameter", lists=True),
    ),
    JobKind(
        key="compare",
        writes=False,
        shape=Annotated[tuple[WriteItem, ...], short_items("parameter")],
        description="parameter: value that the drive should have, as under write",
        example="compare: {P50303: 10.0}",
        short=lambda definitions: short_items_schema(definitions, "WriteItem", "parameter", lists=True),
        compares=True,
    ),
    JobKind(
        key="save",
        writes=True,
        shape=Annotated[SaveSettings, short_item("persist")],
        description="drive_object or unit: what the drive shall keep without power, or {persist, limit, ..}",
        example="save: drive_object",
        items=_save_items,
        short=_short(SaveSettings, SAVES),
        poll=lambda settings: Poll(settings.interval, settings.limit, settings.distance),
    ),
    _buffer_kind("faults", "fault", FaultSettings, FAULT_COUNTER, FAULTS),
    _buffer_kind("alarms", "alarm", AlarmSettings, ALARM_COUNTER, ALARMS),
    JobKind(
        key="acknowledge",
        writes=True,
        shape=Annotated[AcknowledgeSettings, BeforeValidator(_meant)],
        description="true: acknowledge the faults of the drive object, or {limit, interval}",
        example="acknowledge: true",
        items=_acknowledge_items,
        short=_short(AcknowledgeSettings, (True,)),
        poll=lambda settings: Poll(settings.interval, settings.limit, 0),
    ),
    JobKind(
        key="sequence",
        writes=True,
        shape=Annotated[tuple[SequenceStep, ...], Field(min_length=1, max_length=100)],
        description="steps that read, write, or wait for a value, one after the other",
        example="sequence: [{write: {P1120: 10.0}}, {until: {r722.0: 1}}]",
        items=lambda steps: tuple(one.item for one in step_items(steps)),
        short=_steps_schema,
        steps=step_items,
    ),
    JobKind(
        key="activate",
        writes=True,
        shape=Annotated[ActivateSettings, BeforeValidator(_state)],
        description="true, false, not_present, input: whether the drive object takes part; or {state, limit, interval}",
        example="activate: true",
        items=lambda settings: tuple(one.item for one in _activate_steps(settings)),
        short=_short(ActivateSettings, (True, False, "not_present", "input")),
        steps=_activate_steps,
    ),
    JobKind(
        key="clock",
        writes=True,
        shape=Literal["utc"],
        description="utc: sets the clock of the control unit to the time at the input utc",
        example="clock: utc",
        items=_clock_items,
    ),
    _recipe_kind("write", "the drive gets the values of a record"),
    _recipe_kind("read", "a record gets the values of the drive"),
    _recipe_kind("compare", "a record is held against the drive"),
)


@cache
def kinds() -> tuple[JobKind, ...]:
    """Every kind: the shipped ones first, then others by name."""
    return (*SHIPPED, *plugins(GROUP, JobKind).values())


def kind_called(key: str) -> JobKind:
    """The kind with this key. Raises KeyError."""
    return {kind.key: kind for kind in kinds()}[key]
