"""What a kind of drive job is: the accesses to parameters that its value stands for, and how they travel."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any, NamedTuple

from pydantic import Field, ValidationInfo

from plcgen.base.files.printed import Name, Value
from plcgen.base.files.validation import StrictModel, problem
from plcgen.ds47.device import Parameter
from plcgen.project.schema import COMMENT, OF_AN_INPUT, Text


class ReadItem(StrictModel):
    """One parameter to read."""

    parameter: Name = Field(description="P50303, p2155[1..2], r0945[0..7] or a catalogue name")
    as_: Name | None = Field(None, alias="as", description="name of the block's output")
    type: Name | None = Field(None, description="DS47 data type if the catalogue has none")
    comment: Text | None = Field(None, description=COMMENT)


class WriteItem(StrictModel):
    """One parameter to write or to compare; without a value it becomes an input of the block."""

    parameter: Name = Field(description="P50304, p2155[1..2], a bit (P1030.3) or a catalogue name")
    value: Value | tuple[Value, ...] | None = Field(None, description="constant; absent: block input")
    as_: Name | None = Field(None, alias="as", description="name of the block's input")
    type: Name | None = Field(None, description="DS47 data type if the catalogue has none")
    start: Annotated[Value | tuple[Value, ...] | None, OF_AN_INPUT] = Field(
        None, description="start value of the input"
    )
    comment: Text | None = Field(None, description=COMMENT)


@dataclass(frozen=True, slots=True)
class Wait:
    """What a value that is read must be: as ``operator`` says, compared with the value that its use has.

    ``bit`` is the only one that counts, if it is not None; ``limit`` is how long it is waited for, ``interval`` the
    time between two polls, both in ms. ``follows``: what is wanted is bit 0 of what the first telegram of
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
    awaited: Wait | None = None
    wanted: Value = 0


Items = tuple[ReadItem | WriteItem, ...]
"""What a job reads and writes, in the order in which it travels."""
MESSAGE_GROUP = 8
"""Messages of a fault case, and alarms that are present."""


@dataclass(frozen=True, slots=True)
class Messages:
    """A buffer of messages: its accesses are the counter, for each group of eight every column, the counter again.

    Without a counter they are the columns, and the codes of each group again.

    ``columns`` are those of the buffer's parameters in the order in which they are read; ``latest_last`` says of each
    group whether the drive has the latest message at its end, as all groups of the fault buffer and the alarms that are
    present; ``tries`` how often all of it is read until nothing has changed.
    """

    columns: tuple[str, ...]
    latest_last: tuple[bool, ...]
    tries: int

    @property
    def places(self) -> int:
        """Messages for which there is room."""
        return MESSAGE_GROUP * len(self.latest_last)


@dataclass(frozen=True, slots=True)
class Poll:
    """The last telegram of a job is sent again and again until all its values are 0.

    Times in ms: ``interval`` from one to the next, ``limit`` for all of them, counted from the answer to the telegram
    in front of it; ``distance`` is how long after that telegram was handed over the job refuses to start again, 0 if it
    never does. ``effect`` is what it waits for: that the drive has saved what the ``object`` or the whole ``unit`` has,
    or has acknowledged its ``faults``.
    """

    interval: int
    limit: int
    distance: int
    effect: str = ""

    @property
    def saves(self) -> bool:
        """Whether it waits for a drive that saves; else for one that acknowledges its faults."""
        return self.distance > 0


class Unfit(NamedTuple):
    """What is wrong with a parameter, what helps, what else may be said, the key of the value to which it applies."""

    message: str
    help: str
    instead: str = ""
    key: str = ""


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
    ``fixed``: the parameters are the kind's own, which the device must have, ``types`` what a spec that defines them
    itself would say of each; ``bits``: an item may be a bit of a word;
    ``read_back``: a job may have ``verify: readback`` and ``on_error``; ``sets_clock`` says what it does;
    ``serves``: which parameter is read comes from inputs, its type from the answer, and ``items`` say where they begin;
    ``changes``: its inputs may say what is written, too;
    ``on`` makes of the accesses those that a drive takes, of which it asks whether it is known to have a parameter;
    ``unfit`` says what is wrong with the first access, whose parameter is this one, on a device with these parameters.
    ``runs_on`` are parameters of it that are not what was written when they are read, and why; ``instead`` says of a
    parameter that a drive object does not have which other one may do, and what that does.
    ``place`` orders the kinds in tables and messages; ``follows``: it may stand beside a kind that reads back, and
    comes behind it; a value that is ``void`` says nothing beside a kind that writes. ``verb`` and ``subject`` are what
    the title says in place of the key and the parameters; ``title`` is the one line that its block says of itself
    (None: the kind and the parameters). ``permits`` are the
    dangerous parameters that a job of the kind is there to write, each with what the spec says instead of a sign-off;
    none of Safety Integrated.
    """

    key: str
    writes: bool
    shape: Any
    description: str
    example: str
    items: Callable[[Any], Items] = tuple
    short: Callable[[dict[str, Any]], dict[str, Any]] | None = None
    poll: Callable[[Any], Poll] | None = None
    messages: Callable[[Any], Messages] | None = None
    compares: bool = False
    steps: Callable[[Any], Iterator[StepItem]] | None = None
    recorded: bool = False
    fixed: bool = False
    types: Mapping[str, str] = field(default_factory=dict)
    bits: bool = False
    read_back: bool = False
    unfit: Callable[[ReadItem | WriteItem, Parameter | None, Mapping[int, Parameter], str], Unfit | None] | None = None
    on: Callable[[Items, Callable[[str], bool]], Items] | None = None
    sets_clock: bool = False
    serves: bool = False
    changes: Callable[[Any], bool] = lambda _: False
    place: int = 1000
    runs_on: Mapping[int, str] = field(default_factory=dict)
    instead: Mapping[int, tuple[int, str]] = field(default_factory=dict)
    follows: bool = False
    void: Callable[[Any], bool] | None = None
    verb: str = ""
    subject: Callable[[Any], str] | None = None
    title: Callable[[Any], str] | None = None
    permits: Callable[[Any], Mapping[int, str]] | None = None

    @property
    def repeatable(self) -> bool:
        """Whether a job of it can have a cycle: it writes nothing, neither into the drive nor into a record."""
        return not self.writes and not self.serves and (self.compares or not self.recorded)


def within_limit(interval: int, info: ValidationInfo) -> int:
    """The interval of questions, if the first of them does not come after the limit."""
    limit = info.data.get("limit")
    if limit is not None and interval > limit:
        raise problem("the first poll would come after the limit", help_="make interval shorter or limit longer")
    return interval


def short_form(settings: type, words: Iterable[object]) -> Callable[[Any], dict[str, Any]]:
    """Schema of a kind that is one of some words, or its settings."""
    return lambda _: {"anyOf": [{"enum": [*words]}, {"$ref": f"#/$defs/{settings.__name__}"}, {"type": "null"}]}
