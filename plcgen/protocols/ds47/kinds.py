"""The kinds of drive jobs: which key of a job says what it does, and which accesses to parameters that means.

A kind is a ``JobKind`` in ``SHIPPED``, or one that another distribution brings by an entry point of the group
``plcgen.kinds``. Everything else follows: schema and completion, telegrams, blocks, proof.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Annotated, Any

from pydantic import BeforeValidator, Field

from plcgen.input.validation import StrictModel
from plcgen.plugins import plugins
from plcgen.project.schema import OF_AN_INPUT, Text, Value
from plcgen.protocols.ds47.wire.model import RequestId

GROUP = "plcgen.kinds"


class ReadItem(StrictModel):
    """One parameter to read."""

    parameter: str = Field(description="P50303, p2155[1..2], r0945[0..7] or a catalogue name")
    as_: str | None = Field(None, alias="as", description="name of the block's output")
    type: str | None = Field(None, description="DS47 data type if the catalogue has none")
    comment: Text | None = None


class WriteItem(StrictModel):
    """One parameter to write; without a value it becomes an input of the block."""

    parameter: str = Field(description="P50304, p2155[1..2] or a catalogue name")
    value: Value | tuple[Value, ...] | None = Field(None, description="constant; absent: block input")
    as_: str | None = Field(None, alias="as", description="name of the block's input")
    type: str | None = Field(None, description="DS47 data type if the catalogue has none")
    start: Annotated[Value | tuple[Value, ...] | None, OF_AN_INPUT] = Field(
        None, description="start value of the input"
    )
    comment: Text | None = None


@dataclass(frozen=True, slots=True)
class JobKind:
    """A kind of job.

    ``key`` is its key in a job, ``shape`` the type of the value below it, ``example`` how a spec writes it; ``items``
    are the accesses that the value stands for, ``writes`` whether they change parameters. ``short`` makes the JSON
    schema of the value, short forms included, from the definitions of the spec's schema (None: as ``shape`` says it).
    """

    key: str
    writes: bool
    shape: Any
    description: str
    example: str
    items: Callable[[Any], tuple[ReadItem | WriteItem, ...]] = tuple
    short: Callable[[dict[str, Any]], dict[str, Any]] | None = None

    @property
    def request_id(self) -> RequestId:
        """The request ID of its telegrams."""
        return RequestId.CHANGE if self.writes else RequestId.READ


def _read_item(value: object) -> object:
    return {"parameter": value} if isinstance(value, str) else value


def _write_items(value: object) -> object:
    if not isinstance(value, dict):
        return value
    items: list[dict[str, Any]] = []
    for key, entry in value.items():
        if isinstance(entry, dict):
            items.append({**entry, "parameter": str(key)})
        else:
            items.append({"parameter": str(key), "value": entry})
    return tuple(items)


def _read_schema(definitions: dict[str, Any]) -> dict[str, Any]:  # noqa: ARG001 - needs none of them
    return {"type": "array", "items": {"anyOf": [{"type": "string"}, {"$ref": "#/$defs/ReadItem"}]}}


def _write_schema(definitions: dict[str, Any]) -> dict[str, Any]:
    value = {"type": ["boolean", "integer", "number", "string", "null"]}
    entry = {**definitions["WriteItem"], "required": [], "title": "WriteEntry"}
    entry["properties"] = {name: what for name, what in entry["properties"].items() if name != "parameter"}
    definitions["WriteEntry"] = entry
    by_parameter = {"anyOf": [value, {"type": "array", "items": value}, {"$ref": "#/$defs/WriteEntry"}]}
    return {
        "anyOf": [
            {"type": "object", "additionalProperties": by_parameter},
            {"type": "array", "items": {"$ref": "#/$defs/WriteItem"}},
        ]
    }


SHIPPED = (
    JobKind(
        key="read",
        writes=False,
        shape=tuple[Annotated[ReadItem, BeforeValidator(_read_item)], ...],
        description="parameters to read",
        example="read: [P50303]",
        short=_read_schema,
    ),
    JobKind(
        key="write",
        writes=True,
        shape=Annotated[tuple[WriteItem, ...], BeforeValidator(_write_items)],
        description="parameter: value, parameter: {value, as, type, start}, or a list of such",
        example="write: {P50303: 10.0}",
        short=_write_schema,
    ),
)


@cache
def kinds() -> tuple[JobKind, ...]:
    """Every kind: the shipped ones first, then others by name."""
    return (*SHIPPED, *plugins(GROUP, JobKind).values())


def kind_called(key: str) -> JobKind:
    """The kind with this key. Raises KeyError."""
    return {kind.key: kind for kind in kinds()}[key]
