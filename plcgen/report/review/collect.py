"""Collects what stands on a review page: verification, comparisons, lock, layouts, recorded runs, manifest."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.base.files.files import read_bounded
from plcgen.build.manifest import digest
from plcgen.build.sheet import JobInstance, ReviewSheet
from plcgen.project.composing import from_disk
from plcgen.project.includes import Read
from plcgen.project.nouns import Project
from plcgen.project.opening import open_spec
from plcgen.proof import Asked, verify
from plcgen.proof.effort import Faults
from plcgen.report.diff.lock import DEFAULT, check_lock
from plcgen.report.diff.lockfile import read_lock
from plcgen.report.diff.planned import spec_snapshot
from plcgen.report.diff.planned_layout import project_tables
from plcgen.report.diff.run import compare, compare_snapshots
from plcgen.report.review.excerpts import excerpts, sources_of
from plcgen.report.review.model import LayoutPair, RecordedRun, Review, ReviewedFile, ReviewRequest
from plcgen.report.review.revision import BaseFiles, base_files
from plcgen.report.revision import named
from plcgen.report.trace.run import RunSettings, Simulation
from plcgen.s7.compare.model import Comparison
from plcgen.s7.compare.policy import load_policy
from plcgen.s7.read.generated import MANIFEST, MAX_MANIFEST
from plcgen.s7.tables.tables import BlockTable

Progress = Callable[[str, int, int], None]

MAX_RUNS = 12
"""Jobs whose runs are recorded; instances of one job count once."""
_NO_LEDGER = "a ledger of assumptions: the protocols of this spec keep none"


def collect(request: ReviewRequest, progress: Progress | None = None) -> Review:
    """Collect everything; what is wrong with spec or files is in the result.

    Raises:
        DiagnosticError: PG901 if there is nothing to compare with under that name, or no such fault.
    """
    if request.against:
        lock = _lock_path(request)
        with base_files(request.against, request.spec, request.home or request.folder, lock) as base:
            return _collect(request, base, progress)
    return _collect(request, None, progress)


def _collect(request: ReviewRequest, base: BaseFiles | None, progress: Progress | None) -> Review:
    faults = cast("Faults", request.faults)
    verification = verify(Asked(request.spec, request.folder, faults=faults, read=request.read), progress)
    project = _project(request.spec, request.read)
    sheet = sheet_of(project)
    missing: list[str] = [] if verification.ledger else [_NO_LEDGER]
    files = _files(request.folder)
    if base is None:
        missing.append("what changed: nothing to compare with was named")
    lock = _lock(request)
    if lock is None:
        missing.append(f"a layout lock: there is no {DEFAULT} beside the spec")
    runs = _runs(request, project, sheet.instances, missing, progress) if project is not None else ()
    return Review(
        spec=request.spec.as_posix(),
        folder=request.folder.as_posix(),
        project=project.name if project is not None else verification.project,
        target=f"{project.target.family} / {project.target.toolchain}" if project is not None else verification.target,
        spec_hash=project.loaded.digest if project is not None else "",
        included=project.loaded.included_names if project is not None else (),
        files_hash=digest("".join(f"{file.sha256}  {file.path}\n" for file in files).encode()) if files else "",
        files=files,
        verification=verification,
        sheet=sheet,
        base=base.label if base is not None else "",
        changes=tuple(_changes(request, base)) if base is not None else (),
        lock=lock,
        layouts=_layouts(project, base),
        runs=runs,
        excerpts=tuple(excerpts(sources_of(request.folder), sheet.exchanges)),
        missing=tuple(missing),
        planned=project is not None,
        language=project.languages[0][:2].lower() if project is not None else "en",
        made_now=request.home not in {None, request.folder},
    )


def _project(spec: Path, read: Read = from_disk) -> Project | None:
    """The project, if the spec can be planned; why not is in the verification."""
    return open_spec(spec, read).usable


def sheet_of(project: Project | None) -> ReviewSheet:
    """What a reviewer of a project signs."""
    sheets: list[ReviewSheet] = [] if project is None else [p.protocol.review_sheet(p) for p in project.plans]
    return ReviewSheet(
        tuple(row for sheet in sheets for row in sheet.writes),
        tuple(row for sheet in sheets for row in sheet.exchanges),
        tuple(row for sheet in sheets for row in sheet.instances),
    )


def _files(folder: Path) -> tuple[ReviewedFile, ...]:
    """The files of the manifest as it says them; whether they are so is a check of the verification."""
    try:
        content: Any = json.loads(read_bounded(folder / MANIFEST, MAX_MANIFEST))
        return tuple(
            ReviewedFile(str(f["path"]), str(f["sha256"]), int(f["bytes"]), str(f.get("experimental", "")))
            for f in content["files"]
        )
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return ()


# --- changes -----------------------------------------------------------------------------------------------


def _changes(request: ReviewRequest, base: BaseFiles) -> list[tuple[str, Comparison]]:
    found: list[tuple[str, Comparison]] = []
    if base.spec is not None:
        before, after = spec_snapshot(base.spec), spec_snapshot(request.spec, request.read)
        found.append(
            ("the spec and what follows from it", _named(compare_snapshots(before, after, load_policy(())), base))
        )
    if base.folder is not None and request.folder.is_dir():
        sources = _named(compare([base.folder], [request.folder]), base)
        if request.home in {None, request.folder}:
            found.append(("the generated sources on disk", sources))
        else:
            found.append(("the generated sources, as they are made now", replace(sources, new="made now")))
    if base.lock is not None:
        found.append(("the layout lock", _locks(base.lock, _lock_path(request), base)))
    if not found:
        span = Span(f"--against {base.label}")
        nothing = Diagnostic("PG901", f"the base has neither {request.spec.name} nor generated sources", span)
        found.append(("the base", Comparison(base.label, request.spec.as_posix(), (), (nothing,))))
    return found


def _named(comparison: Comparison, base: BaseFiles) -> Comparison:
    """The same with the paths of the base as people know them."""
    return named(comparison, base.label, base.root)


def _locks(old: Path, new: Path, base: BaseFiles) -> Comparison:
    try:
        before, after = read_lock(old).snapshot, read_lock(new).snapshot
        return _named(compare_snapshots(before, after, load_policy(())), base)
    except DiagnosticError as problem:
        return _named(Comparison(old.as_posix(), new.as_posix(), (), problem.diagnostics), base)


def _lock_path(request: ReviewRequest) -> Path:
    return request.lock if request.lock is not None else request.spec.parent / DEFAULT


def _lock(request: ReviewRequest) -> Comparison | None:
    """What differs from the lock; None if there is none and none was named."""
    path = _lock_path(request)
    if request.lock is None and not path.is_file():
        return None
    return check_lock([], path)


def _layouts(project: Project | None, base: BaseFiles | None) -> tuple[LayoutPair, ...]:
    """Buffers before and after by name; those that are gone stand at the end."""
    after = project_tables(project) if project is not None else []
    old = _project(base.spec) if base is not None and base.spec is not None else None
    before: dict[tuple[str, str], BlockTable] = {}
    if old is not None:
        before = {(table.kind, table.name): table for table in project_tables(old)}
    pairs = [LayoutPair(before.pop((table.kind, table.name), None), table) for table in after]
    return (*pairs, *(LayoutPair(table, None) for table in before.values()))


# --- runs --------------------------------------------------------------------------------------------------


def _runs(
    request: ReviewRequest,
    project: Project,
    instances: Sequence[JobInstance],
    missing: list[str],
    progress: Progress | None,
) -> tuple[RecordedRun, ...]:
    """Every job once without a fault and once with one, on the first of its partners."""
    first: dict[str, str] = {}
    for instance in instances:
        first.setdefault(instance.job, instance.key)
    if len(first) > MAX_RUNS:
        missing.append(f"recorded runs of {len(first) - MAX_RUNS} more jobs: the first {MAX_RUNS} are recorded")
    runs: list[RecordedRun] = []
    chosen = list(first.items())[:MAX_RUNS]
    faults = _faults(request, project)
    simulation = Simulation(request.spec, request.folder, read=request.read)
    for number, (job, key) in enumerate(chosen):
        if progress is not None:
            progress(f"record {job}", number, len(chosen))
        plain = simulation.run(RunSettings(jobs=(key,)))
        if not plain.scans:
            missing.append(f"a recorded run of {job}: {'; '.join(d.message for d in plain.diagnostics[:1])}")
            continue
        runs.append(RecordedRun(job, "", plain))
        fault = faults.get(key, request.fault)
        if fault:
            faulty = simulation.run(RunSettings(jobs=(key,), faults=(fault,)))
            usage = [d for d in faulty.diagnostics if d.code == "PG901"]
            if usage:
                raise DiagnosticError(usage)
            runs.append(RecordedRun(job, fault, faulty))
    return tuple(runs)


def _faults(request: ReviewRequest, project: Project) -> dict[str, str]:
    """What goes wrong in the second run of each job: what was asked for, or what its protocol usually shows."""
    recordings = [found for plan in project.plans if (found := plan.protocol.recording(plan)) is not None]
    asked = request.fault.partition(":")[0]
    known = any(asked in recording.faults for recording in recordings)
    return {
        key: recording.fault if not asked or (known and asked not in recording.faults) else request.fault
        for recording in recordings
        for key in recording.jobs
    }
