"""Both sides of a comparison as frozen states, and the changes between them.

A state holds what others can notice of a block: it is made from sources, from a rendered spec, or from a lock file.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

from plcgen.base.diagnostics import Diagnostic, Span, has_errors
from plcgen.base.frozen import frozen
from plcgen.s7.compare.policy import Level, fails
from plcgen.s7.read.code import Code
from plcgen.s7.types.blocks import block_title

_STEP = re.compile(r'(?:"[^"]*"|[^."])+')
_NAMED = frozenset({"member-added", "member-removed", "member-renamed", "member-spelling", "parameter-required"})
"""Kinds of changes whose message names the member."""

TAG_TABLE = "tag table"
"""Kind of the state of a tag table."""
ADDRESS = "address"
"""Attribute of a tag."""


def path_step(name: str) -> str:
    """A name as a step of a path: in quotes if it has what separates or ends steps."""
    return f'"{name}"' if any(mark in name for mark in ".[]") else name


def path_steps(path: str) -> list[str]:
    """Steps of a path as they stand there, indices and quotes included."""
    return _STEP.findall(path)


def path_name(path: str) -> str:
    """Name of the member at the end of a path."""
    return path_steps(path)[-1].strip('"') if path else ""


@frozen
class MemberState:
    """One declared member with what is nested in it.

    ``offset`` and ``bits`` in bits, None if the block has no memory or its layout is unknown; ``start`` is the
    canonical start value, empty for the type's default. ``inner`` members of a named type are ``foreign``:
    they are declared elsewhere and matter here for their place only.
    """

    name: str
    path: str
    type: str
    section: str = ""
    offset: int | None = None
    bits: int | None = None
    start: str = ""
    comment: str = ""
    attributes: tuple[tuple[str, str], ...] = ()
    inner: tuple[MemberState, ...] = ()
    foreign: bool = False
    span: Span | None = field(default=None, compare=False)


@dataclass(frozen=True, slots=True)
class BlockState:
    """One block. ``size`` in bytes, None if unknown; ``locals`` are temporary variables and constants."""

    kind: str
    name: str
    number: int | None = None
    size: int | None = None
    optimized: bool | None = None
    instance_of: str = ""
    instance_kind: str = ""
    non_retain: bool = False
    texts: tuple[tuple[str, str], ...] = ()
    attributes: tuple[tuple[str, str], ...] = ()
    members: tuple[MemberState, ...] = ()
    locals: tuple[MemberState, ...] = ()
    assignments: tuple[tuple[str, str], ...] = ()
    code: Code = field(default_factory=Code)
    code_hash: str = ""
    span: Span | None = field(default=None, compare=False)

    @property
    def title(self) -> str:
        """``DB3 "WR_DataBuffer"``."""
        return block_title(self.kind, self.number, self.name)


@dataclass(frozen=True, slots=True)
class TelegramState:
    """One request with its answer: bytes, lengths and the size of the response buffer.

    ``protocol`` (``ds47`` or ``ppi``) says how the bytes of the request are read.
    """

    request: bytes
    positive: int
    negative: int
    buffer: int
    protocol: str = "ds47"


class JobItem(NamedTuple):
    """What a job does with one parameter or address: ``value`` is what it writes or compares, empty if it reads."""

    label: str
    does: str
    value: str = ""


@dataclass(frozen=True, slots=True)
class JobState:
    """One job of a spec; ``timing`` and ``trigger`` are names with their values as text.

    ``group`` is what jobs of several drives have in common, ``items`` what they do, ``place`` the data block and the
    member in which the caller finds the job, ``block`` its function block: empty in a lock that was written without.
    """

    key: str
    drive: str
    telegrams: tuple[TelegramState, ...]
    timing: tuple[tuple[str, str], ...] = ()
    trigger: tuple[tuple[str, str], ...] = ()
    span: Span | None = field(default=None, compare=False)
    group: str = field(default="", compare=False)
    items: tuple[JobItem, ...] = field(default=(), compare=False)
    place: tuple[str, str] = field(default=("", ""), compare=False)
    block: str = field(default="", compare=False)


@dataclass(frozen=True, slots=True)
class DriveState:
    """A drive or a station on a line: its address, and the ``settings`` it is talked to with, by name."""

    key: str
    what: str
    address: int
    settings: tuple[tuple[str, str], ...]
    span: Span | None = field(default=None, compare=False)


@dataclass(slots=True)
class Snapshot:
    """One side. ``label`` names it for people; ``complete`` is False where comments were not kept (a lock)."""

    label: str
    blocks: list[BlockState] = field(default_factory=list)
    jobs: dict[str, JobState] | None = None
    drives: dict[str, DriveState] = field(default_factory=dict)
    diagnostics: list[Diagnostic] = field(default_factory=list)
    complete: bool = True
    mirrored: frozenset[str] = frozenset()


class Found(NamedTuple):
    """One difference inside a block, before it is classified; see :class:`Change`."""

    kind: str
    path: str
    message: str
    old: str = ""
    new: str = ""
    old_span: Span | None = None
    new_span: Span | None = None
    details: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Change:
    """One difference: kind (an id of the policy table), level, where, what.

    ``subject`` is the block, job or drive, ``path`` the member; ``message`` says it in one line; ``details`` are
    the single items of a change that is reported once.
    """

    kind: str
    level: Level
    subject: str
    path: str
    message: str
    old: str = ""
    new: str = ""
    old_span: Span | None = None
    new_span: Span | None = None
    details: tuple[str, ...] = ()

    @property
    def span(self) -> Span | None:
        """The new place if there is one, else the old one."""
        return self.new_span or self.old_span

    @property
    def text(self) -> str:
        """The message, with the member in front where it does not name it."""
        if not self.path or self.kind in _NAMED or (self.kind == "member-moved" and self.details):
            return self.message
        return f"{self.path}: {self.message}"


@dataclass(frozen=True, slots=True)
class Sentence:
    """What has changed of one job, in words: ``partners`` are its drives that this is true of."""

    job: str
    level: Level
    text: str
    partners: tuple[str, ...] = ()
    span: Span | None = None

    @property
    def who(self) -> str:
        """``actual, 20 drives``."""
        count = len(self.partners)
        return self.job if count < 2 else f"{self.job}, {count} drives"


@dataclass(frozen=True, slots=True)
class Comparison:
    """All changes by subject in a stable order, and everything that could not be read.

    ``sentences`` say of two specs what has changed by job; ``inside`` are the blocks in which follows from it what no
    one but they themselves notices.
    """

    old: str
    new: str
    changes: tuple[Change, ...]
    diagnostics: tuple[Diagnostic, ...] = ()
    compared: int = 0
    sentences: tuple[Sentence, ...] = ()
    inside: frozenset[str] = frozenset()

    def count(self, level: Level) -> int:
        """How many changes have this level."""
        return sum(change.level is level for change in self.changes)

    @property
    def counts(self) -> str:
        """``2 breaking, 1 compatible``."""
        return ", ".join(f"{count} {level.value}" for level in Level if (count := self.count(level)))

    def subjects(self) -> Iterator[tuple[str, list[Change]]]:
        """Changes by subject, the worst first."""
        groups: dict[str, list[Change]] = {}
        for change in self.changes:
            groups.setdefault(change.subject, []).append(change)
        for subject, changes in groups.items():
            yield subject, sorted(changes, key=lambda change: change.level.rank)

    def folded(self, *, everything: bool = False) -> Iterator[tuple[str, list[Change]]]:
        """The same without what is inside, with one of the subjects of which the same is told."""
        told: dict[tuple[tuple[str, str], ...], list[str]] = {}
        first: dict[str, list[Change]] = {}
        for subject, changes in self.subjects():
            if everything:
                yield subject, changes
            elif subject not in self.inside:
                alike = tuple((change.kind, change.text) for change in changes)
                told.setdefault((("", subject.partition(".")[0]), *alike), []).append(subject)
                first[subject] = changes
        for subjects in told.values():
            more = f" .. {subjects[-1].rpartition(' ')[2]} ({len(subjects)} alike)" if len(subjects) > 1 else ""
            yield f"{subjects[0]}{more}", first[subjects[0]]

    def failing(self, fail_on: str) -> int:
        """How many changes fail a run with this ``--fail-on``."""
        return sum(fails(change.level, fail_on) for change in self.changes)

    @property
    def readable(self) -> bool:
        """Whether everything could be read: no diagnostic is an error."""
        return not has_errors(self.diagnostics)
