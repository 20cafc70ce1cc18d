"""Jobs of several steps that read, write, or wait for values."""

from __future__ import annotations

import re
from collections.abc import Iterator
from types import MappingProxyType
from typing import Annotated, Any

from pydantic import BeforeValidator, Field, model_validator

from plcgen.base.files.printed import Name, Value
from plcgen.base.files.validation import StrictModel, problem
from plcgen.base.files.yaml import resolve_plain
from plcgen.ds47.kind import JobKind, ReadItem, StepItem, Wait, WriteItem
from plcgen.project.schema import ONE_OR_MORE, Duration, short_item, short_item_schema, short_items, short_items_schema

_SHORT = re.compile(r"\s*([^<>=]*[^<>=\s])\s*((?:<>|<=|>=|<|>|=)\s*[^\s].*?)\s*\Z", re.DOTALL)
_COMPARISON = re.compile(r"\s*(<>|<=|>=|<|>|=)\s*(.*?)\s*\Z", re.DOTALL)
_BIT = re.compile(r"\s*([A-Za-z_0-9]+(?:\s*\[\s*[0-9]{1,6}\s*\])?)\s*\.\s*([0-9]{1,2})\s*\Z")


class WaitCondition(StrictModel):
    """What a value of the drive must be: ``r722.0: 1``, ``r21: "> 100.0"``; ``place`` counts the keys."""

    parameter: Name
    place: int
    bit: int | None
    operator: str
    value: Value


class WaitSettings(StrictModel):
    """A step that waits: conditions that must all be true in one answer, how long, and how often it is asked."""

    conditions: tuple[WaitCondition, ...]
    timeout: Annotated[Duration, Field(ge=100)] = Field(10_000, description="longest waiting time, from 100 ms")
    interval: Annotated[Duration, Field(ge=100, le=60_000)] = Field(
        500, description="time between two polls, 100 ms to 1 min"
    )

    @model_validator(mode="after")
    def _in_time(self) -> WaitSettings:
        if self.interval > self.timeout:
            raise problem(
                "the second poll would come after the timeout", help_="make interval shorter or timeout longer"
            )
        return self


def _condition(place: int, key: str, value: Any) -> dict[str, Any]:
    if not isinstance(value, bool | int | float | str) or value == "":
        help_ = f'for example {{{key}: 1}} or {{{key}: "> 100.0"}}'
        raise problem(f"the value that {key} must have is missing", help_=help_)
    operator = "="
    wanted: bool | int | float | str | None = value
    compared = _COMPARISON.match(value) if isinstance(value, str) else None
    if compared is not None:
        operator, wanted = compared[1], resolve_plain(compared[2])
    if wanted is None or wanted == "":
        raise problem(f'"{value}" has no value to compare {key} with', help_=f'for example "{operator} 100.0"')
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
    """``{r722.0: 1, timeout: 5s}`` with its conditions as a list; they stand where their keys do.

    ``r722.0 = 1`` is the same as ``{r722.0: "= 1"}``.
    """
    if isinstance(value, str):
        short = _SHORT.match(value)
        if short is None:
            raise problem(f'"{value}" is not a comparison', help_="for example r722.0 = 1, or {r722.0: 1, timeout: 5s}")
        value = {short[1]: short[2]}
    if not isinstance(value, dict):
        return value
    conditions = tuple(
        _condition(place, str(key), wanted)
        for place, (key, wanted) in enumerate(value.items())
        if key not in WAIT_TIMES
    )
    if not conditions:
        raise problem("the step does not say what it waits for", help_="for example {r722.0: 1, timeout: 5s}")
    return {"conditions": conditions, **{key: value[key] for key in WAIT_TIMES if key in value}}


class SequenceStep(StrictModel):
    """One step of a sequence: it reads, it writes, or it waits for values, and may read others in the same answer."""

    FOREIGN = MappingProxyType(
        dict.fromkeys(("wait", "wait_for", "when"), "until: {r722.0: 1, timeout: 5s} waits for a value")
        | dict.fromkeys(("delay", "pause", "sleep"), "a step waits for a value, not for a time: until: {r722.0: 1}")
    )

    read: Annotated[tuple[Annotated[ReadItem, short_item("parameter")], ...] | None, ONE_OR_MORE] = Field(
        None, description="parameters to read, as in a job"
    )
    write: Annotated[tuple[WriteItem, ...] | None, short_items("parameter")] = Field(
        None, description="parameter: value, as in a job"
    )
    until: Annotated[WaitSettings | None, BeforeValidator(_conditions)] = Field(
        None,
        description="parameter: value, a bit (r722.0: 1), a comparison in quotes; timeout, interval; or r722.0 = 1",
    )

    @model_validator(mode="after")
    def _one_thing(self) -> SequenceStep:
        given = [key for key in SequenceStep.model_fields if getattr(self, key)]
        if len(given) != 1 and given != ["read", "until"]:
            what = " and ".join(given) if given else "nothing"
            help_ = "a step is one of read, write, until, or read with until: make a separate step for each"
            raise problem(f"a step does only one thing, but this one {what}", help_=help_)
        return self


def step_items(steps: tuple[SequenceStep, ...]) -> Iterator[StepItem]:
    """Every access of a sequence, in order."""
    for number, step in enumerate(steps, 1):
        for place, written in enumerate(step.write or ()):
            yield StepItem(number, (number - 1, "write", place), written)
        if step.until is not None:
            yield from _awaited(number, step.until)
        for place, item in enumerate(step.read or ()):
            yield StepItem(number, (number - 1, "read", place), item)


def _awaited(number: int, until: WaitSettings) -> Iterator[StepItem]:
    for one in until.conditions:
        awaited = Wait(one.operator, one.bit, until.timeout, until.interval)
        yield StepItem(number, (number - 1, "until", one.place), ReadItem(parameter=one.parameter), awaited, one.value)


def _steps_schema(definitions: dict[str, Any]) -> dict[str, Any]:
    """A list of steps, whose keys have the short forms of jobs."""
    value = {"type": ["boolean", "integer", "number", "string"]}
    times = {key: definitions["WaitSettings"]["properties"][key] for key in WAIT_TIMES}
    condition = {"type": "object", "properties": times, "additionalProperties": value, "minProperties": 1}
    step = definitions["SequenceStep"]["properties"]
    for key, shape in (
        ("read", short_item_schema("ReadItem")),
        ("write", short_items_schema(definitions, "WriteItem", "parameter", lists=True)),
        ("until", {"anyOf": [{"type": "string", "pattern": "[<>=]"}, condition]}),
    ):
        step[key] = {**shape, "description": step[key]["description"]}
    for name in ("WaitSettings", "WaitCondition"):
        del definitions[name]
    return {"anyOf": [{"type": "array", "minItems": 1, "items": {"$ref": "#/$defs/SequenceStep"}}, {"type": "null"}]}


SEQUENCE = JobKind(
    key="sequence",
    place=80,
    writes=True,
    shape=Annotated[tuple[SequenceStep, ...], Field(min_length=1, max_length=100)],
    description="steps that read, write, or wait for a value, one after the other",
    example="sequence: [{write: {P1120: 10.0}}, {until: {r722.0: 1}}]",
    items=lambda steps: tuple(one.item for one in step_items(steps)),
    short=_steps_schema,
    steps=step_items,
    title=lambda steps: f"Sequence of {len(steps)} steps",
)
KINDS = (SEQUENCE,)
