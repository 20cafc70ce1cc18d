"""A spec as a state: its jobs and drives, and the blocks that would be generated from it."""

from __future__ import annotations

from pathlib import Path

from plcgen.diagnostics import DiagnosticError, Report
from plcgen.documents.folder import SOURCES
from plcgen.project.model import PlannedDrive, PlannedJob, Project
from plcgen.protocols.ppi.plan.model import PlannedMaster, PpiTelegram
from plcgen.review.compare.model import DriveState, JobState, Snapshot, TelegramState
from plcgen.review.compare.states import snapshot_of
from plcgen.sources.blocks import read_texts


def spec_snapshot(path: Path) -> Snapshot:
    """State of a spec; its diagnostics are in the snapshot, without blocks if it cannot be planned."""
    from plcgen.project.loading import load_spec
    from plcgen.project.resolve import resolve
    from plcgen.project.rules import apply_rules

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
        drive.key: DriveState(drive.key, "drive", drive.id_value, _settings(drive), project.loaded.key_span(drive.path))
        for drive in project.drives
    }
    for master in project.ppi.masters if project.ppi is not None else ():
        _master(project, master, snapshot)
    return snapshot


def _settings(drive: PlannedDrive) -> tuple[tuple[str, str], ...]:
    index = f"{drive.record_index} (16#{drive.record_index:04X})"
    return (("device", drive.device.key), ("drive object", str(drive.drive_object)), ("record index", index))


def _master(project: Project, master: PlannedMaster, snapshot: Snapshot) -> None:
    """Stations and jobs of a PPI master, under the name of the master."""
    line = (("module", master.module), ("port", str(master.port)), ("baud", str(master.baud)))
    for station in master.stations:
        key = f"{master.key}.{station.key}"
        settings = (("cpu", station.profile.key), *line)
        place = project.loaded.key_span(station.path)
        snapshot.drives[key] = DriveState(key, "station", station.address, settings, place)
    for job in master.jobs:
        key = f"{master.key}.{job.key}"
        telegrams = tuple(_ppi_telegram(telegram) for telegram in job.telegrams)
        timing = (("timeout", f"{job.timeout} ms"), ("cycle", f"{job.cycle} ms"))
        trigger = tuple((name, address.text()) for name, address in job.trigger.items())
        station_key = f"{master.key}.{job.station.key}"
        place = project.loaded.key_span(job.path)
        assert snapshot.jobs is not None  # noqa: S101 - made just before
        snapshot.jobs[key] = JobState(key, station_key, telegrams, timing, trigger, place)
    refs = [ref for t in master.telegrams for ref in (t.request_type, t.response_type) if ref is not None]
    snapshot.mirrored |= {ref.name.upper() for ref in refs}


def _ppi_telegram(telegram: PpiTelegram) -> TelegramState:
    last = telegram.response_fields[-1] if telegram.response_fields else None
    size = 0 if last is None else last.offset + last.size
    return TelegramState(telegram.request, size, 0, size, "ppi")


def _rendered(project: Project, label: str) -> Snapshot:
    """Blocks of the sources that would be generated, read as if they lay on disk."""
    from plcgen.documents.rendering import render_project

    encoding = "cp1252" if project.target.v5 else "utf-8-sig"
    texts = [
        (file.path, file.data.decode(encoding, "replace"))
        for file in render_project(project)
        if file.path.lower().endswith(SOURCES)
    ]
    snapshot = snapshot_of(read_texts(sorted(texts)), label)
    snapshot.diagnostics = [
        d for d in snapshot.diagnostics if d.code != "PG630"
    ]  # nobody can add the types of a library
    return snapshot


def _job(project: Project, job: PlannedJob) -> JobState:
    telegrams = tuple(
        TelegramState(t.request, t.positive_length, t.negative_length, t.response_size) for t in job.telegrams
    )
    timing = (("timeout", f"{job.timeout} ms"), ("retry pause", f"{job.retry_pause} ms"), ("retries", str(job.retries)))
    trigger = tuple((name, address.text()) for name, address in job.trigger.items())
    return JobState(job.key, job.drive.key, telegrams, timing, trigger, project.loaded.key_span(job.path))
