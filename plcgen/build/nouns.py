"""The nouns of documents: what a protocol says about its plan, without a word about how files look.

A protocol fills them, the engine writes them: sources, SimaticML twins, watch and tag tables, calls, import order,
guide and layout sheet all come from the same nouns. Types, literals and operands are texts in the target's spelling.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from plcgen.project.nouns import BlockRef, Flag


class WatchRow(NamedTuple):
    """A line of a watch table; ``address`` is absolute without %, or empty; ``modify`` a value to be written."""

    name: str
    address: str
    format: str
    modify: str


class MemberRow(NamedTuple):
    """A member of a type or data block.

    ``start`` is the literal of a start value other than zero, ``subs`` those of array elements, by index or by a path
    of several; ``text`` the comment for sources, ``comments`` the same per culture; ``members`` those of a structure,
    ``expanded`` those of a user type whose start values are written out. ``offset`` and ``size`` in bytes, ``address``
    and ``watch`` are those of a buffer's member.
    """

    name: str
    type: str
    text: str = ""
    start: str = ""
    subs: tuple[tuple[int | str, str], ...] = ()
    comments: tuple[tuple[str, str], ...] = ()
    members: tuple[MemberRow, ...] = ()
    expanded: tuple[MemberRow, ...] = ()
    offset: int = 0
    size: int = 0
    address: str = ""
    watch: tuple[WatchRow, ...] = ()


class StartAssignment(NamedTuple):
    """A start value of a data block behind BEGIN; ``text`` is its comment."""

    path: str
    value: str
    text: str = ""


@dataclass(frozen=True, slots=True)
class TypeBlock:
    """A user type; ``comment`` by language is that of its document, ``starts``: its members have start values.

    ``notes`` are lines above its part of the layout sheet; without one it has none there.
    """

    block: BlockRef
    members: Sequence[MemberRow]
    comment: Mapping[str, str] = field(default_factory=dict)
    starts: bool = False
    notes: Sequence[str] = ()


@dataclass(frozen=True, slots=True)
class DataBlock:
    """A global data block."""

    block: BlockRef
    title: str
    members: Sequence[MemberRow]
    assignments: Sequence[StartAssignment] = ()
    comment: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class LibraryInstance:
    """Instance DB of a block that the compiler brings: ``of`` in a source, ``symbol`` in a symbol table."""

    block: BlockRef
    of: str
    symbol: str


@dataclass(frozen=True, slots=True)
class CallerValue:
    """A value of a job at its caller; ``shown`` are its watched parts: suffix of the name, display format."""

    member: MemberRow
    shown: tuple[tuple[str, str], ...]


def _same(name: str) -> str:
    return name


@dataclass(frozen=True, slots=True)
class Command:
    """A job as its caller sees it: a structure ``member`` of the DB ``control``, or where else the spec places signals.

    ``shared`` are values that the block works on where they lie, in the DB ``control``. ``pin`` gives the name of a
    signal or value at the block, ``prefix`` stands in front of the names of its tags.
    """

    control: BlockRef
    member: str
    title: str
    flags: Mapping[str, Flag]
    signals: Sequence[MemberRow]
    inputs: Sequence[CallerValue]
    outputs: Sequence[CallerValue]
    pin: Callable[[str], str] = _same
    prefix: str = ""
    shared: Sequence[CallerValue] = ()


@dataclass(frozen=True, slots=True)
class FunctionBlock:
    """A function block and what belongs to it alone.

    A block without an ``instance`` DB has its instances in another block, which calls it. ``buffers`` are the types of
    its telegrams, with their data blocks where they have any, ``data`` its other data blocks; ``telegrams`` lines for
    the layout sheet; ``open_call`` stands between the parenthesis of a call and the first pin; ``note`` why its
    document is experimental.
    """

    block: BlockRef
    instance: BlockRef | None
    title: str
    template: str
    view: Mapping[str, Any]
    note: str
    buffers: Sequence[tuple[TypeBlock, DataBlock | None]]
    commands: Sequence[Command]
    telegrams: Sequence[str]
    data: Sequence[DataBlock | LibraryInstance] = ()
    open_call: str = ""


class TagRow(NamedTuple):
    """A tag: ``address`` without %."""

    name: str
    type: str
    address: str
    text: str


class Call(NamedTuple):
    """A call for the example OB: ``inputs`` as assignments, ``outputs`` as pin and operand."""

    title: str
    block: str
    instance: str
    begin: str
    inputs: list[str]
    outputs: list[tuple[str, str]]


GuidePart = tuple[str, Mapping[str, Any]]
"""A template and its view."""


@dataclass(frozen=True, slots=True)
class Contribution:
    """All that a plan contributes to the documents, in import order.

    ``family`` is the block family, ``jobs`` what its jobs are called. ``types`` and ``data`` come before the programs,
    which are made one at a time; the DBs ``controls`` behind them, each with its title, hold their commands.
    ``symbols`` are names that a symbol table must have besides (symbol, address, data type, comment),
    ``system_blocks`` those that must be in the block folder; ``guide`` gives the parts of the import guide before and
    behind the order, ``manifest`` its entries.
    """

    family: str
    jobs: str
    types: Sequence[TypeBlock]
    data: Sequence[DataBlock | LibraryInstance]
    programs: Iterable[FunctionBlock]
    controls: Mapping[BlockRef, str]
    tag_table: str
    guide: Callable[[], tuple[Sequence[GuidePart], Sequence[GuidePart]]]
    manifest: Callable[[], Mapping[str, Any]]
    symbols: Sequence[tuple[str, str, str, str]] = ()
    system_blocks: Sequence[str] = ()
