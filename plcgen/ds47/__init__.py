"""PROFIdrive, data set 47: parameter jobs on drives."""

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
    from plcgen.ds47.plan.nouns import DrivePlan
    from plcgen.ds47.proof.suite import DriveProof
    from plcgen.ds47.recording.recording import DriveRecording
    from plcgen.project.nouns import Buffer, BufferField
    from plcgen.project.numbering import Numbering
    from plcgen.project.part import Rules
    from plcgen.project.spec import LoadedSpec
    from plcgen.proof.audited import Audited
    from plcgen.s7.compare.model import DriveState, JobState
    from plcgen.s7.read.blocks import Sources


class Ds47:
    """The face of the parameter channel, see ``protocols.base``."""

    key = "ds47"
    sections = ("jobs", "drives", "units", "recipes")
    entries = ("units", "drives", "jobs")
    details = ("comment", "cycle", "reference", "retries", "retry_pause", "split", "timeout", "trigger")
    length_note = " (LEN of WRREC)"

    def section(self, *, alone: bool) -> type[BaseModel]:
        """Drives and jobs; both may be missing beside another protocol."""
        from plcgen.ds47.schema import drive_sections

        return drive_sections(alone=alone)

    def complete(self, schema: dict[str, Any], profiles: Sequence[str]) -> None:
        """Short forms of jobs, names of parameters."""
        from plcgen.ds47.schema import complete

        complete(schema, profiles)

    def pinned(self, loaded: LoadedSpec) -> Iterator[tuple[str, int]]:
        """Numbers of function blocks, instances and buffers."""
        from plcgen.ds47.plan.resolve import pinned
        from plcgen.ds47.schema import DriveSections

        return pinned(loaded.sections(DriveSections))

    def plan(self, loaded: LoadedSpec, numbering: Numbering, report: Report) -> DrivePlan:
        """Plan drives and jobs."""
        from plcgen.ds47.plan.resolve import plan_drives

        return plan_drives(self, loaded, numbering, report)

    def rules(self) -> Rules:
        """Rules about drives, parameters and telegrams."""
        from plcgen.ds47.rules import RULES

        return RULES

    def documents(self, plan: DrivePlan) -> Contribution:
        """Blocks, tables and pages."""
        from plcgen.ds47.views.documents import contribution

        return contribution(plan)

    def buffers(self, plan: DrivePlan) -> Iterator[tuple[Buffer[BufferField], str]]:
        """Buffers with their roles."""
        from plcgen.ds47.review import buffers

        return buffers(plan)

    def link_states(self, plan: DrivePlan) -> Iterator[DriveState]:
        """Drives for a comparison."""
        from plcgen.ds47.review import links

        return links(plan)

    def job_states(self, plan: DrivePlan) -> Iterator[JobState]:
        """Jobs for a comparison."""
        from plcgen.ds47.review import jobs

        return jobs(plan)

    def review_sheet(self, plan: DrivePlan) -> ReviewSheet:
        """What is written, every byte of the telegrams, all drives."""
        from plcgen.ds47.sheet import review_sheet

        return review_sheet(plan)

    def request_fields(self, data: bytes) -> list[ByteField]:
        """A request field by field."""
        from plcgen.ds47.review import shown_request

        return shown_request(data)

    def explain(self, digits: str) -> Page | None:
        """Error numbers of drives, status words of job blocks, STATUS of WRREC and RDREC."""
        from plcgen.ds47.explanation import explain

        return explain(digits)

    def proof(self, plan: DrivePlan) -> DriveProof:
        """Scenarios of drives and record calls."""
        from plcgen.ds47.proof.suite import DriveProof

        return DriveProof(plan)

    def audit(self, plan: DrivePlan, sources: Sources) -> Audited:
        """Hand-written request and response DBs and record calls."""
        from plcgen.ds47.audit.run import audit

        return audit(plan, sources)

    def recording(self, plan: DrivePlan) -> DriveRecording | None:
        """Drives in a simulated run."""
        from plcgen.ds47.recording.recording import DriveRecording

        return DriveRecording(plan) if plan.jobs else None


PROTOCOL = Ds47()
