"""A spec as a state: its jobs and drives, and the blocks that would be generated from it."""

from __future__ import annotations

from pathlib import Path

from plcgen.compare.model import DriveState, JobState, Snapshot, TelegramState
from plcgen.compare.states import snapshot_of
from plcgen.diagnostics import DiagnosticError, Report
from plcgen.plan.model import PlannedJob, Project
from plcgen.read.output import SOURCES
from plcgen.read.sources import read_texts


def spec_snapshot(path: Path) -> Snapshot:
    """State of a spec; its diagnostics are in the snapshot, without blocks if it cannot be planned."""
    from plcgen.plan.resolve import resolve
    from plcgen.rules import apply_rules
    from plcgen.spec.load import load_spec

    report = Report()
    project: Project | None = None
    try:
        loaded = load_spec(path, report)
        if loaded is not None:
            project = resolve(loaded, report)
            apply_rules(project, report)
    except DiagnosticError as problem:
        report.extend(problem.diagnostics)
    if project is None or report.has_errors:
        return Snapshot(path.as_posix(), diagnostics=list(report), jobs={})
    snapshot = _rendered(project, path.as_posix())
    snapshot.jobs = {job.key: _job(project, job) for job in project.jobs}
    buffers = [ref for job in project.jobs for t in job.telegrams for ref in (t.request_type, t.response_type)]
    snapshot.mirrored = frozenset(ref.name.upper() for ref in buffers)
    snapshot.drives = {
        drive.key: DriveState(
            drive.key, drive.id_value, drive.device.key, drive.drive_object, drive.record_index,
            project.loaded.key_span(drive.path),
        )
        for drive in project.drives
    }  # fmt: skip
    return snapshot


def _rendered(project: Project, label: str) -> Snapshot:
    """Blocks of the sources that would be generated, read as if they lay on disk."""
    from plcgen.render.project import render_project

    encoding = "cp1252" if project.target.v5 else "utf-8-sig"
    texts = [
        (file.path, file.data.decode(encoding, "replace"))
        for file in render_project(project)
        if file.path.lower().endswith(SOURCES)
    ]
    return snapshot_of(read_texts(sorted(texts)), label)


def _job(project: Project, job: PlannedJob) -> JobState:
    telegrams = tuple(
        TelegramState(t.request, t.positive_length, t.negative_length, t.response_size) for t in job.telegrams
    )
    timing = (("timeout", f"{job.timeout} ms"), ("retry pause", f"{job.retry_pause} ms"), ("retries", str(job.retries)))
    trigger = tuple((name, address.text()) for name, address in job.trigger.items())
    return JobState(job.key, job.drive.key, telegrams, timing, trigger, project.loaded.key_span(job.path))
