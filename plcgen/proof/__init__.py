"""Verification of what lies on disk: files, offsets, telegrams, exchanges with a drive, execution.

The second way of the data: it knows the files, the spec and DS47, never the generator's output objects.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from plcgen.diagnostics import Diagnostic, DiagnosticError, Report, Span
from plcgen.proof.checks import Check, CheckGroup, Verification
from plcgen.protocols.ds47.plan.nouns import DrivePlan
from plcgen.protocols.ppi.plan.nouns import PpiPlan

if TYPE_CHECKING:
    from plcgen.protocols.ds47.sim.drive import Drive


def verify(
    spec: Path,
    folder: Path,
    drive: Path | None = None,
    progress: Callable[[str, int, int], None] | None = None,
    faults: Literal["none", "quick", "full"] = "quick",
) -> Verification:
    """Verify a folder against its spec; ``drive`` is a drive file that replaces the profile's simulated drive.

    ``faults`` is how much of the fault matrix the generated SCL runs through.
    """
    report = Report()
    try:
        return _verify(spec, folder, drive, progress, report, faults)
    except DiagnosticError as problem:
        report.extend(problem.diagnostics)
    return Verification(str(spec), str(folder), "", "", (), tuple(report))


def _verify(
    spec: Path,
    folder: Path,
    drive_file: Path | None,
    progress: Callable[[str, int, int], None] | None,
    report: Report,
    faults: Literal["none", "quick", "full"],
) -> Verification:
    from plcgen.input.text import read_text
    from plcgen.project.opening import open_spec
    from plcgen.proof.files import check_files
    from plcgen.proof.folder import read_folder
    from plcgen.proof.layouts import check_layouts
    from plcgen.proof.twins import check_twins
    from plcgen.protocols.ds47.proof.exchanges import check_drive, check_telegrams
    from plcgen.protocols.ds47.proof.execution import check_execution
    from plcgen.protocols.ds47.sim.load import load_drive

    opened = open_spec(spec)
    project = opened.sound()
    report.extend(opened.diagnostics)
    if not folder.is_dir():
        report.add(Diagnostic("PG507", "there is no such folder", Span(str(folder)), help="run plcgen generate first"))
        report.raise_on_errors()
    own: Callable[[], Drive] | None = None
    if drive_file is not None:
        own = partial(load_drive, read_text(drive_file), str(drive_file))
    files = read_folder(folder, project.target, progress)
    drives, masters = project.plan(DrivePlan), project.plan(PpiPlan)
    layouts: list[Check] = []
    telegrams: list[Check] = []
    if drives is not None:
        layouts += check_layouts(drives, files)
        telegrams += check_telegrams(drives, files)
    if masters is not None:
        from plcgen.protocols.ppi.proof.layouts import check_ppi_layouts, check_ppi_telegrams

        layouts += check_ppi_layouts(masters, files)
        telegrams += check_ppi_telegrams(masters, files)
    groups = [
        CheckGroup("files", "Files", (*check_files(project, files), *check_twins(project, files))),
        CheckGroup("layout", "Layout", tuple(layouts)),
        CheckGroup("telegrams", "Telegrams", tuple(telegrams)),
    ]
    if drives is not None and drives.jobs:
        drive = tuple(check_drive(drives, files, own and own(), progress))
        groups.append(CheckGroup("drive", "Simulated drive", drive))
    ran = tuple(check_execution(project, folder, faults, progress, own=own))
    groups.append(CheckGroup("execution", "Execution", ran))
    target = f"{project.target.family} / {project.target.toolchain}"
    return Verification(str(spec), str(folder), project.name, target, tuple(groups), tuple(report))
