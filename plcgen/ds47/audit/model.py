"""What is audited: buffers as declared, fields as the telegram needs them, record calls as written."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from plcgen.base.diagnostics import Span
from plcgen.ds47.plan.access import Part
from plcgen.ds47.plan.nouns import DriveJob, DriveTelegram
from plcgen.ds47.wire.formats import Format
from plcgen.project.nouns import BlockRef
from plcgen.proof.audited import AuditFindings
from plcgen.s7.read.buffers import FoundBuffer
from plcgen.s7.read.calls import ConstantArgument, PointedArea

Role = Literal["request", "response"]


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
    findings: AuditFindings = field(default_factory=AuditFindings)

    @property
    def ref(self) -> BlockRef:
        """The block as the spec names it."""
        return self.telegram.request.home if self.role == "request" else self.telegram.response.home

    @property
    def name(self) -> str:
        """``read_ramp_up``, or ``read_recipe 2/3`` if a job needs several telegrams."""
        several = len(self.job.telegrams)
        return self.job.key if several == 1 else f"{self.job.key} {self.telegram.number}/{several}"


@dataclass(frozen=True, slots=True)
class FoundCall:
    """A call of WRREC (``writes``) or RDREC with its constant arguments by upper-case name."""

    writes: bool
    block: str
    span: Span
    arguments: dict[str, ConstantArgument]
    record: PointedArea | None

    @property
    def title(self) -> str:
        """``WRREC in OB1``."""
        return f"{'WRREC' if self.writes else 'RDREC'} in {self.block}"
