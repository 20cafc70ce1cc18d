"""What is audited: buffers as declared, fields as the telegram needs them, record calls as written."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from plcgen.diagnostics import Diagnostic, Note, Severity, Span
from plcgen.project.nouns import BlockRef
from plcgen.protocols.ds47.plan.nouns import DriveJob, DriveTelegram, Part
from plcgen.protocols.ds47.wire.formats import Format
from plcgen.s7.blocks import Block
from plcgen.s7.types import DataType

Role = Literal["request", "response"]


def block_title(block: Block) -> str:
    """``DB3 "WR_DataBuffer"``, or the name alone if it is the number."""
    number = f"{block.kind}{'' if block.number is None else block.number}"
    return number if block.name.upper() == number else f'{number} "{block.name}"'


@dataclass(frozen=True, slots=True)
class Slot:
    """One elementary member, or one element of an array: place in bytes, type, declaration.

    ``given`` says that the source gives it a start value of its own; ``bits`` is 1 for a BOOL.
    """

    path: str
    offset: int
    size: int
    bits: int
    type: DataType
    span: Span
    given: bool

    @property
    def end(self) -> int:
        """First byte behind it."""
        return self.offset + self.size


@dataclass(frozen=True, slots=True)
class FoundBuffer:
    """A data block with its members in memory order; ``memory`` is its start image, None if that has errors."""

    block: Block
    file: str
    size: int
    slots: tuple[Slot, ...]
    memory: bytes | None

    @property
    def title(self) -> str:
        """``DB3 "WR_DataBuffer"``, or the name alone if the source gives no number."""
        return block_title(self.block)

    @property
    def span(self) -> Span:
        """Where the block begins."""
        return self.block.span or Span(self.file)


@dataclass(frozen=True, slots=True)
class Expected:
    """One field of a telegram: what it is called, where it lies, what it must hold (None: anything)."""

    role: str
    label: str
    offset: int
    size: int
    data: bytes | None
    part: Part | None = None
    format: Format | None = None


@dataclass(slots=True)
class Match:
    """One buffer of a job: the telegram it belongs to, the DB that plays this role, and how it was found."""

    job: DriveJob
    telegram: DriveTelegram
    role: Role
    buffer: FoundBuffer | None = None
    how: str = ""
    findings: list[Diagnostic] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    @property
    def ref(self) -> BlockRef:
        """The block as the spec names it."""
        return self.telegram.request.home if self.role == "request" else self.telegram.response.home

    @property
    def name(self) -> str:
        """``read_ramp_up``, or ``read_recipe 2/3`` if a job needs several telegrams."""
        several = len(self.job.telegrams)
        return self.job.key if several == 1 else f"{self.job.key} {self.telegram.number}/{several}"

    def report(
        self,
        code: str,
        message: str,
        span: Span,
        help_: str,
        *,
        notes: tuple[Note, ...] = (),
        severity: Severity = Severity.ERROR,
    ) -> None:
        """Add one finding."""
        self.findings.append(Diagnostic(code, message, span, severity, help=help_, notes=notes))


@dataclass(frozen=True, slots=True)
class ConstantArgument:
    """One argument of a call: its text, its value if it is a constant, and where it stands."""

    text: str
    value: int | None
    span: Span


@dataclass(frozen=True, slots=True)
class Record:
    """What RECORD points to: a DB by name or number, or a variable (``local``), from ``start``, ``length`` bytes.

    ``length`` is None if the whole DB or a part of unknown length is meant.
    """

    text: str
    span: Span
    db: str = ""
    number: int | None = None
    start: int = 0
    length: int | None = None
    local: bool = False
    path: str = ""


@dataclass(frozen=True, slots=True)
class FoundCall:
    """A call of WRREC (``writes``) or RDREC with its constant arguments by upper-case name."""

    writes: bool
    block: str
    span: Span
    arguments: dict[str, ConstantArgument]
    record: Record | None

    @property
    def title(self) -> str:
        """``WRREC in OB1``."""
        return f"{'WRREC' if self.writes else 'RDREC'} in {self.block}"
