"""PPI: jobs on S7-200 stations over a serial line."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pydantic import BaseModel

    from plcgen.base.diagnostics import Report
    from plcgen.base.display.page import Page
    from plcgen.base.telegrams.dissection import ByteField
    from plcgen.build.nouns import Contribution
    from plcgen.build.sheet import ReviewSheet
    from plcgen.ppi.plan.nouns import PpiPlan
    from plcgen.ppi.proof.suite import PpiProof
    from plcgen.ppi.recording import PpiRecording
    from plcgen.project.nouns import Buffer, BufferField
    from plcgen.project.numbering import Numbering
    from plcgen.project.part import Rules
    from plcgen.project.spec import LoadedSpec
    from plcgen.proof.audited import Audited
    from plcgen.s7.compare.model import DriveState, JobState
    from plcgen.s7.read.blocks import Sources


class Ppi:
    """The face of PPI, see ``protocols.base``."""

    key = "ppi"
    sections = ("ppi",)
    entries = ("stations", "jobs")
    details = ("comment", "cycle", "retries", "retry_pause", "timeout", "trigger")
    length_note = ""

    def section(self, *, alone: bool) -> type[BaseModel]:  # noqa: ARG002 - the same in every company
        """Masters."""
        from plcgen.ppi.schema import PpiSection

        return PpiSection

    def complete(self, schema: dict[str, Any], profiles: Sequence[str]) -> None:  # noqa: ARG002 - stations have none
        """Short forms of jobs."""
        from plcgen.ppi.schema import complete

        complete(schema)

    def pinned(self, loaded: LoadedSpec) -> Iterator[tuple[str, int]]:
        """Numbers of function blocks, instances and tables."""
        from plcgen.ppi.plan.resolve import pinned
        from plcgen.ppi.schema import PpiSection

        return pinned(loaded.sections(PpiSection))

    def plan(self, loaded: LoadedSpec, numbering: Numbering, report: Report) -> PpiPlan:
        """Plan masters, stations and jobs."""
        from plcgen.ppi.plan.resolve import plan_masters

        return plan_masters(self, loaded, numbering, report)

    def rules(self) -> Rules:
        """Rules about masters, stations and telegrams."""
        from plcgen.ppi.rules import RULES

        return RULES

    def documents(self, plan: PpiPlan) -> Contribution:
        """Blocks, tables and pages."""
        from plcgen.ppi.views.program import contribution

        return contribution(plan)

    def buffers(self, plan: PpiPlan) -> Iterator[tuple[Buffer[BufferField], str]]:
        """Buffers with their roles."""
        from plcgen.ppi.review import buffers

        return buffers(plan)

    def link_states(self, plan: PpiPlan) -> Iterator[DriveState]:
        """Stations for a comparison."""
        from plcgen.ppi.review import links

        return links(plan)

    def job_states(self, plan: PpiPlan) -> Iterator[JobState]:
        """Jobs for a comparison."""
        from plcgen.ppi.review import jobs

        return jobs(plan)

    def review_sheet(self, plan: PpiPlan) -> ReviewSheet:
        """What is written, every byte of the telegrams, all stations."""
        from plcgen.ppi.review import review_sheet

        return review_sheet(plan)

    def request_fields(self, data: bytes) -> list[ByteField]:
        """A request field by field."""
        from plcgen.ppi.review import shown_request

        return shown_request(data)

    def explain(self, digits: str) -> Page | None:
        """The status word of a master: some have another meaning than those of drive jobs."""
        from plcgen.base.display.page import Page
        from plcgen.ppi.words import STATUS_WORDS

        for name, word, text in STATUS_WORDS:
            if word and digits.upper() == f"{word:04X}":
                return Page(f"16#{word:04X}", "status of a PPI master", (("Of a PPI master", f"{text} ({name})"),))
        return None

    def proof(self, plan: PpiPlan) -> PpiProof:
        """Scenarios of line, module and stations."""
        from plcgen.ppi.proof.suite import PpiProof

        return PpiProof(plan)

    def audit(self, plan: PpiPlan, sources: Sources) -> Audited:  # noqa: ARG002 - there is nothing to compare
        """Nothing: no hand-written PPI master with its telegrams in data blocks is known."""
        from plcgen.proof.audited import Audited

        return Audited()

    def recording(self, plan: PpiPlan) -> PpiRecording | None:
        """Stations in a simulated run."""
        from plcgen.ppi.recording import PpiRecording

        return PpiRecording(plan) if plan.jobs else None


PROTOCOL = Ppi()
