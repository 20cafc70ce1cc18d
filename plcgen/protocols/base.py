"""The face of a protocol: all that the rest of plcgen knows of it.

A protocol is a package. It owns sections of the spec, plans what stands there, and contributes documents, rules and
proof; the engines loop over ``project.plans`` and never ask which protocol it is. Every method imports what it needs
when it is called, so that naming a protocol costs nothing.
"""

from __future__ import annotations

import typing
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pydantic import BaseModel

    from plcgen.diagnostics import Diagnostic, Report, Span
    from plcgen.display.page import Page
    from plcgen.documents.nouns import Contribution
    from plcgen.inspection.compare.model import DriveState, JobState
    from plcgen.inspection.sheet import ReviewSheet
    from plcgen.project.nouns import Buffer, BufferField, Plan
    from plcgen.project.numbering import Numbering
    from plcgen.project.spec import LoadedSpec, SpecPath
    from plcgen.proof.audited import Audited
    from plcgen.proof.suite import Proof
    from plcgen.protocols.dissection import ByteField
    from plcgen.sources.blocks import Sources
    from plcgen.trace.face import Recording


@dataclass(frozen=True, slots=True)
class Named:
    """A name of the spec: what it names, its role as in ``s7.names.check_name``, how to find its place."""

    what: str
    name: str
    role: str
    place: Callable[[], Span]


@dataclass(frozen=True, slots=True)
class Rules:
    """What a protocol adds to the rules: checks of its own, and what the shared rules must know.

    ``names`` are all names that reach a source or a file, ``texts`` all comments, ``untranslated`` texts without
    languages, ``taken`` names that blocks must not have: name, what has it, where it stands. ``remarks`` tell what is
    worth knowing of a plan in which nothing is wrong.
    """

    checks: tuple[Callable[[Any], Iterator[Diagnostic]], ...]
    names: Callable[[Any], Iterator[Named]]
    texts: Callable[[Any], Iterator[tuple[SpecPath, dict[str, str]]]]
    untranslated: Callable[[Any], Iterator[tuple[SpecPath, str]]]
    taken: Callable[[Any], Iterator[tuple[str, str, Span | None]]]
    remarks: tuple[Callable[[Any], Iterator[Diagnostic]], ...] = ()


@typing.runtime_checkable
class Protocol(typing.Protocol):
    """What a protocol package offers."""

    @property
    def key(self) -> str:
        """Name of the protocol and of its entry point."""

    @property
    def sections(self) -> tuple[str, ...]:
        """The keys of a spec that belong to the protocol, the one that is always there first."""

    def section(self, *, alone: bool) -> type[BaseModel]:
        """Shape of these keys; ``alone`` if the spec uses no other protocol."""

    def complete(self, schema: dict[str, Any], profiles: Sequence[str]) -> None:
        """Put the short forms into the JSON schema of a spec, and what the user's own device profiles name."""

    def pinned(self, loaded: LoadedSpec) -> Iterable[tuple[str, int]]:
        """Block numbers that the spec fixes: kind and number."""

    def plan(self, loaded: LoadedSpec, numbering: Numbering, report: Report) -> Plan:
        """Plan what the sections describe; what cannot be resolved is a diagnostic, the rest is planned."""

    def rules(self) -> Rules:
        """What may be wrong with such a plan."""

    def documents(self, plan: Any) -> Contribution:
        """What a plan with jobs contributes to the documents; programs are made when they are asked for."""

    def buffers(self, plan: Any) -> Iterator[tuple[Buffer[BufferField], str]]:
        """Every buffer of a plan with its role, for layout tables."""

    def link_states(self, plan: Any) -> Iterator[DriveState]:
        """The partners of a plan, to be compared with those of another version."""

    def job_states(self, plan: Any) -> Iterator[JobState]:
        """The jobs of a plan, likewise."""

    def review_sheet(self, plan: Any) -> ReviewSheet:
        """What a reviewer signs: what is written, what goes over the wire, to whom."""

    def request_fields(self, data: bytes) -> list[ByteField]:
        """A request of the protocol field by field; what follows from other fields may be left out."""

    @property
    def length_note(self) -> str:
        """What the length of a request is called where the block is called, in brackets; may be empty."""

    def explain(self, digits: str) -> Page | None:
        """What a hexadecimal number means in this protocol; None if nothing."""

    def proof(self, plan: Any) -> Proof:
        """What verification must know to prove what was generated from a plan."""

    def audit(self, plan: Any, sources: Sources) -> Audited:
        """What somebody else's program does, held against a plan."""

    def recording(self, plan: Any) -> Recording | None:
        """What can be recorded of a plan while it runs; None if nothing."""
