"""The nouns of a planned project, shared by all protocols: who is asked, what is sent, where it lies, who triggers it.

Everything is frozen. Offsets here come from the telegrams of a protocol, never from S7 layout rules: verification
compares the two.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Generic, TypeVar

from plcgen.project.spec import LoadedSpec, SpecPath
from plcgen.project.target import Target
from plcgen.s7.types.address import Address
from plcgen.s7.types.data_types import DataType


@dataclass(frozen=True, slots=True)
class BlockRef:
    """A block's identity. ``pinned`` says that the spec gave the number; ``path`` where it did.

    ``retain`` is a data block that keeps its values without power.
    """

    kind: str
    name: str
    number: int
    pinned: bool
    path: SpecPath
    retain: bool = False


@dataclass(frozen=True, slots=True)
class Link:
    """Who is at the other end: a drive, a station. ``key`` and ``path`` say where the spec describes it."""

    key: str
    comment: dict[str, str]
    path: SpecPath


@dataclass(frozen=True, slots=True)
class BufferField:
    """One member of a buffer: where it lies in the telegram and what it holds at start.

    ``offset`` and ``size`` in bytes; ``data`` is the start value as wire bytes, zeros for what the partner fills in.
    """

    name: str
    role: str
    type: DataType
    offset: int
    size: int
    data: bytes


F_co = TypeVar("F_co", bound=BufferField, covariant=True)


@dataclass(frozen=True, slots=True, eq=False)
class Buffer(Generic[F_co]):
    """Where one half of an exchange lies in the PLC, with a member for every byte: a user type and its data block.

    Without a data block of its own it lies in the instance of its job. ``size`` is the length of the buffer in bytes.
    ``data`` is the telegram that the start values form, none for a response; ``lead`` are the bytes in front of it.
    """

    db: BlockRef | None
    type: BlockRef
    fields: Sequence[F_co]
    size: int
    data: bytes = b""
    lead: bytes = b""

    @property
    def image(self) -> bytes:
        """The start values of the whole buffer."""
        return self.lead + self.data

    @property
    def home(self) -> BlockRef:
        """The block whose layout is that of the buffer: its data block, else its type."""
        return self.db or self.type


@dataclass(frozen=True, slots=True, eq=False)
class Telegram:
    """One exchange; ``number`` counts from 1.

    ``request_id`` is the byte that tells what is asked, ``response_id`` the one of a good answer. A telegram whose
    answer holds no data has no response buffer.
    """

    number: int
    request_id: int
    response_id: int
    request: Buffer[BufferField]
    response: Buffer[BufferField] | None

    @property
    def buffers(self) -> tuple[Buffer[BufferField], ...]:
        """The request buffer, and the response buffer if there is one."""
        return (self.request,) if self.response is None else (self.request, self.response)


@dataclass(frozen=True, slots=True)
class OwnSymbol:
    """A place in the user's own program: a tag, or a member of a data block; ``members`` with their indexes."""

    name: str
    members: tuple[str, ...] = ()

    def text(self, *, percent: bool = False) -> str:
        """As SCL writes it: ``"Plant".startRamps``; ``percent`` is for addresses."""
        del percent
        return ".".join((f'"{self.name}"', *self.members))

    def __str__(self) -> str:
        return self.text()


Flag = Address | OwnSymbol
"""Where the spec places a signal."""


@dataclass(frozen=True, slots=True)
class PlannedTrigger:
    """Flags and symbols of a call; None where the control DB's member is used."""

    execute: Flag | None = None
    busy: Flag | None = None
    done: Flag | None = None
    error: Flag | None = None
    status: Flag | None = None

    def items(self) -> list[tuple[str, Flag]]:
        """What the spec places, by signal name."""
        pairs = [(name, getattr(self, name)) for name in ("execute", "busy", "done", "error", "status")]
        return [(name, place) for name, place in pairs if place is not None]

    def flags(self) -> list[tuple[str, Address]]:
        """The absolute ones."""
        return [(name, place) for name, place in self.items() if isinstance(place, Address)]

    def symbols(self) -> list[tuple[str, OwnSymbol]]:
        """Those in the user's program."""
        return [(name, place) for name, place in self.items() if isinstance(place, OwnSymbol)]


def flag_name(prefix: str, member: str, signal: str) -> str:
    """Name of the tag that an absolute flag gets; ``member`` is that of its job."""
    return f"{prefix}{member}{signal.capitalize()}"


@dataclass(frozen=True, slots=True, eq=False)
class PlannedJob:
    """What a caller triggers: one ``kind`` of exchange with one partner, in one or more telegrams; times in ms."""

    key: str
    member: str
    kind: str
    link: Link
    telegrams: Sequence[Telegram]
    trigger: PlannedTrigger
    timeout: int
    comment: dict[str, str]
    path: SpecPath


@dataclass(frozen=True, eq=False)
class Frame:
    """What a project and each of its plans have in common; positions are looked up in ``loaded`` on demand."""

    loaded: LoadedSpec
    name: str
    target: Target
    languages: tuple[str, ...]

    @property
    def prefix(self) -> str:
        """What stands in front of every name that plcgen makes."""
        return self.loaded.spec.plc.prefix


@dataclass(frozen=True, eq=False)
class Plan(Frame):
    """What one protocol makes of a spec."""

    protocol: Any
    """What has the face in ``protocols.base``; the rooms above give its parts their types."""
    jobs: Sequence[PlannedJob]
    blocks: tuple[BlockRef, ...]
    """Every block of the plan, in a stable order; their identities, not their contents."""


P = TypeVar("P", bound=Plan)


@dataclass(frozen=True, eq=False)
class Project(Frame):
    """A spec, planned: the PLC and a plan for each protocol that the spec uses."""

    plans: tuple[Plan, ...]

    def plan(self, kind: type[P]) -> P | None:
        """The plan of one protocol, if the spec uses it."""
        return next((plan for plan in self.plans if isinstance(plan, kind)), None)

    @cached_property
    def jobs(self) -> tuple[PlannedJob, ...]:
        """The jobs of all plans."""
        return tuple(job for plan in self.plans for job in plan.jobs)

    @cached_property
    def blocks(self) -> tuple[BlockRef, ...]:
        """Every block of the project, plan by plan."""
        return tuple(block for plan in self.plans for block in plan.blocks)
