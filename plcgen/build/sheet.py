"""What a reviewer signs, as protocols tell it: what is written, what goes over the wire byte by byte, to whom.

Nothing here knows a protocol or a format. Texts are plain; whoever shows them escapes them.
"""

from __future__ import annotations

import enum
from dataclasses import dataclass

from plcgen.project.nouns import BlockRef


class Role(enum.StrEnum):
    """What a byte of a telegram is for; every role has a colour of its own."""

    HEADER = "header"
    ADDRESS = "address"
    FORMAT = "format"
    VALUE = "value"
    ERROR = "error"
    SPARE = "spare"


@dataclass(frozen=True, slots=True)
class WriteEntry:
    """One thing that a job changes on its partners.

    ``job`` is the key of the job in the spec, ``block`` what writes, ``partners`` are all drives or stations with this
    job. ``value`` is a constant, or what an input holds while nothing is connected (``input`` says which); ``limits``
    and ``unit`` are the catalogue's. ``trigger`` says who starts it, ``memory`` where the value ends up. ``danger`` why
    it needs a sign-off, ``signed`` the reason that the spec gives, ``safety`` that it belongs to a safety function.
    ``doubts`` are facts about it that were not read in a manual.
    """

    job: str
    block: str
    partners: tuple[str, ...]
    parameter: str
    text: str
    value: str
    input: bool
    limits: str
    unit: str
    trigger: str
    memory: str
    danger: str = ""
    signed: str = ""
    safety: bool = False
    doubts: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class JobInstance:
    """A job on one partner, ``key`` in the project: how the partner is addressed, and what starts the job."""

    job: str
    key: str
    partner: str
    address: str
    trigger: str


@dataclass(frozen=True, slots=True)
class MessageField:
    """One member of a buffer: ``data`` holds None where the partner decides, ``address`` is that in the PLC."""

    offset: int
    name: str
    role: Role
    address: str
    data: tuple[int | None, ...]
    value: str
    meaning: str


@dataclass(frozen=True, slots=True)
class Message:
    """A telegram where it lies: ``home`` is the block whose layout it has, ``size`` the bytes of the buffer."""

    title: str
    home: BlockRef
    size: int
    fields: tuple[MessageField, ...]

    @property
    def length(self) -> int:
        """Bytes of the telegram."""
        return sum(len(field.data) for field in self.fields)


@dataclass(frozen=True, slots=True)
class ExchangeSheet:
    """One request of a job and its answers; ``lengths`` are named figures: what the call passes, what may come."""

    job: str
    block: str
    number: int
    count: int
    request: Message
    answers: tuple[Message, ...]
    lengths: tuple[tuple[str, str], ...]


@dataclass(frozen=True, slots=True)
class ReviewSheet:
    """Everything of a plan; jobs with many partners appear once, their partners as ``instances``."""

    writes: tuple[WriteEntry, ...] = ()
    exchanges: tuple[ExchangeSheet, ...] = ()
    instances: tuple[JobInstance, ...] = ()
