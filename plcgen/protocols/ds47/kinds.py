"""The kinds of drive jobs: which key of a job says what it does, and which accesses to parameters that means.

A kind is a ``JobKind`` in ``SHIPPED``, or one that another distribution brings by an entry point of the group
``plcgen.kinds``. Everything else follows: schema and completion, telegrams, blocks, proof.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Annotated, Any

from pydantic import Field

from plcgen.input.validation import StrictModel
from plcgen.plugins import plugins
from plcgen.project.schema import (
    COMMENT,
    OF_AN_INPUT,
    ONE_OR_MORE,
    Text,
    Value,
    short_item,
    short_item_schema,
    short_items,
    short_items_schema,
)
from plcgen.protocols.ds47.wire.model import RequestId

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
)


@cache
def kinds() -> tuple[JobKind, ...]:
    """Every kind: the shipped ones first, then others by name."""
    return (*SHIPPED, *plugins(GROUP, JobKind).values())


def kind_called(key: str) -> JobKind:
    """The kind with this key. Raises KeyError."""
    return {kind.key: kind for kind in kinds()}[key]
