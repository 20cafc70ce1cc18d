"""The kinds of drive jobs: which key of a job says what it does, and which accesses to parameters that means.

A kind is a ``JobKind`` in ``SHIPPED``, or one that another distribution brings by an entry point of the group
``plcgen.kinds``. Everything else follows: schema and completion, telegrams, blocks, proof.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Field, ValidationInfo

from plcgen.input.validation import StrictModel, problem
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

GROUP = "plcgen.kinds"


class ReadItem(StrictModel):
    """One parameter to read."""

    parameter: str = Field(description="P50303, p2155[1..2], r0945[0..7] or a catalogue name")
    as_: str | None = Field(None, alias="as", description="name of the block's output")
    type: str | None = Field(None, description="DS47 data type if the catalogue has none")
    comment: Text | None = Field(None, description=COMMENT)


class WriteItem(StrictModel):
    """One parameter to write; without a value it becomes an input of the block."""

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


@dataclass(frozen=True, slots=True)
class Poll:
    """The last telegram of a job is sent again and again until its value is 0.

    Times in ms: ``interval`` from one to the next, ``limit`` for all of them, counted from the answer to the telegram
    in front of it; ``distance`` is how long after that telegram was handed over the job refuses to start again.
    """

    interval: int
    limit: int
    distance: int


@dataclass(frozen=True, slots=True)
class JobKind:
    """A kind of job.

    ``key`` is its key in a job, ``shape`` the type of the value below it, ``example`` how a spec writes it; ``items``
    are the accesses that the value stands for, in the order of their telegrams, ``writes`` whether any of them changes
    parameters. ``short`` makes the JSON schema of the value, short forms included, from the definitions of the spec's
    schema (None: as ``shape`` says it). ``poll`` says that the last access is a read that is repeated.
    """

    key: str
    writes: bool
    shape: Any
    description: str
    example: str
    items: Callable[[Any], tuple[ReadItem | WriteItem, ...]] = tuple
    short: Callable[[dict[str, Any]], dict[str, Any]] | None = None
    poll: Callable[[Any], Poll] | None = None


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
    return WriteItem(parameter=name, value=1), ReadItem.model_validate(asked)


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
        key="save",
        writes=True,
        shape=Annotated[SaveSettings, short_item("persist")],
        description="drive_object or unit: what the drive shall keep without power, or {persist, limit, ..}",
        example="save: drive_object",
        items=_save_items,
        short=lambda _: {"anyOf": [{"enum": list(SAVES)}, {"$ref": "#/$defs/SaveSettings"}, {"type": "null"}]},
        poll=lambda settings: Poll(settings.interval, settings.limit, settings.distance),
    ),
)


@cache
def kinds() -> tuple[JobKind, ...]:
    """Every kind: the shipped ones first, then others by name."""
    return (*SHIPPED, *plugins(GROUP, JobKind).values())


def kind_called(key: str) -> JobKind:
    """The kind with this key. Raises KeyError."""
    return {kind.key: kind for kind in kinds()}[key]
