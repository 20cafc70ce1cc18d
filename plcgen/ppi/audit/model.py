"""What is audited: telegrams as start values or assignments form them, calls of serial modules as written."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from plcgen.base.diagnostics import Span
from plcgen.ppi.plan.nouns import PpiJob
from plcgen.ppi.wire.model import Frame, Pdu
from plcgen.proof.audited import AuditFindings
from plcgen.s7.read.buffers import FoundBuffer
from plcgen.s7.read.calls import SourceCall


@dataclass(frozen=True, slots=True)
class Bytes:
    """Memory that may hold telegrams: start values of a DB, or constants that a block assigns to an array.

    ``given`` are the bytes that the source states; what else is in ``data`` comes at run time. ``spans`` says where a
    byte is stated, ``home`` where the whole is. ``buffer`` is the DB if it is one.
    """

    title: str
    data: bytes
    given: frozenset[int]
    home: Span
    spans: Mapping[int, Span]
    buffer: FoundBuffer | None = None

    def span(self, at: int) -> Span:
        """Where byte ``at`` is stated."""
        return self.spans.get(at, self.home)


@dataclass(slots=True)
class FoundTelegram:
    """A telegram that begins at byte ``start`` of its memory and has ``size`` bytes.

    ``data`` are its bytes as checked: what comes at run time is filled in. ``frame`` and ``pdu`` are what could be
    read, ``job`` is the job of the spec that sends the same.
    """

    memory: Bytes
    start: int
    size: int
    data: bytes = b""
    frame: Frame | None = None
    pdu: Pdu | None = None
    job: PpiJob | None = None
    findings: AuditFindings = field(default_factory=AuditFindings)

    @property
    def title(self) -> str:
        """``DB10 "Line" byte 1``."""
        return self.place(0)

    def place(self, offset: int) -> str:
        """Byte ``offset`` of the telegram as a byte of its memory."""
        return f"{self.memory.title} byte {self.start + offset}"

    @property
    def uncertain(self) -> bool:
        """Whether its lengths disagree: nobody knows how long it is to be."""
        return any(problem.code == "PG670" for problem in self.findings.found)

    def span(self, offset: int) -> Span:
        """Where byte ``offset`` of the telegram is stated."""
        return self.memory.span(self.start + offset)


@dataclass(frozen=True, slots=True)
class CallMemory:
    """Memory that a call sends from or receives into: ``size`` bytes of ``buffer`` from ``start``."""

    text: str
    span: Span
    size: int | None
    start: int = 0
    buffer: FoundBuffer | None = None


@dataclass(slots=True)
class ModuleCall:
    """A call that sends or receives; ``room`` is None if nobody knows which memory it means."""

    call: SourceCall
    sends: bool
    name: str
    room: CallMemory | None = None
    telegram: FoundTelegram | None = None
    findings: AuditFindings = field(default_factory=AuditFindings)

    @property
    def title(self) -> str:
        """``P_SND_RK in FB341``."""
        return f"{self.name} in {self.call.block}"
