"""The face of a protocol: all that the rest of plcgen knows of it.

A protocol is a package. It owns sections of the spec, plans what stands there, and contributes documents, rules and
proof; the engines loop over ``project.plans`` and never ask which protocol it is. Every method imports what it needs
when it is called, so that naming a protocol costs nothing.
"""

from __future__ import annotations

import typing
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from plcgen.project.part import SpecPart

if TYPE_CHECKING:
    from plcgen.build.nouns import Contribution
    from plcgen.build.sheet import ReviewSheet
    from plcgen.project.nouns import Buffer, BufferField
    from plcgen.proof.audited import Audited
    from plcgen.proof.suite import Proof
    from plcgen.report.trace.face import Recording
    from plcgen.s7.compare.model import DriveState, JobState
    from plcgen.s7.read.blocks import Sources


@typing.runtime_checkable
class Protocol(SpecPart, typing.Protocol):
    """What a protocol package offers."""

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

    def proof(self, plan: Any) -> Proof:
        """What verification must know to prove what was generated from a plan."""

    def audit(self, plan: Any, sources: Sources) -> Audited:
        """What somebody else's program does, held against a plan."""

    def recording(self, plan: Any) -> Recording | None:
        """What can be recorded of a plan while it runs; None if nothing."""
