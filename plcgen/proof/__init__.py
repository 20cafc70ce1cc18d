"""Verification of what lies on disk: files, offsets, telegrams, exchanges with a partner, execution.

The second way of the data: it knows the files, the spec and the standards, never the generator's output objects.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Literal

from plcgen.diagnostics import Diagnostic, DiagnosticError, Report, Span
from plcgen.proof.checks import CheckGroup, Verification


def verify(
    spec: Path,
    folder: Path,
    drive: Path | None = None,
    progress: Callable[[str, int, int], None] | None = None,
    faults: Literal["none", "quick", "full"] = "quick",
    *,
    engine: bool = False,
    dissector: bool = False,
) -> Verification:
    """Verify a folder against its spec; ``drive`` is a drive file that replaces the profile's simulated drive.

    ``faults`` is how much of the fault matrix the generated SCL runs through. ``engine`` runs the blocks that are the
    same in every project even if they are known to hold, ``dissector`` sends the telegrams through ``tshark``.
    """
    report = Report()
    try:
        return _verify(spec, folder, drive, progress, report, faults, engine=engine, dissector=dissector)
    except DiagnosticError as problem:
        report.extend(problem.diagnostics)
    return Verification(str(spec), str(folder), "", "", (), tuple(report))


def _verify(
    spec: Path,
    folder: Path,
    partner: Path | None,
    progress: Callable[[str, int, int], None] | None,
    report: Report,
    faults: Literal["none", "quick", "full"],
    *,
    engine: bool,
    dissector: bool,
) -> Verification:
    from plcgen.project.opening import open_spec
    from plcgen.proof.delivery import delivered
    from plcgen.proof.execution import check_execution
    from plcgen.proof.folder import read_folder
    from plcgen.proof.layouts import check_layout
    from plcgen.proof.ledger import LAYOUT
    from plcgen.proof.second_layout import check_second_layout

    opened = open_spec(spec)
    project = opened.sound()
    report.extend(opened.diagnostics)
    if not folder.is_dir():
        report.add(Diagnostic("PG507", "there is no such folder", Span(str(folder)), help="run plcgen generate first"))
        report.raise_on_errors()
    files = read_folder(folder, project.target, progress)
    proofs = [plan.protocol.proof(plan) for plan in project.plans]
    layouts = (check_layout(project, files, laid) for proof in proofs for laid in proof.layouts())
    telegrams = (check for proof in proofs for check in proof.telegrams(files))
    exchanges = [proof.exchanges(files, partner, progress) for proof in proofs]
    asked = (check for proof in proofs for check in proof.oracles(files, dissector=dissector))
    oracles = (*check_second_layout(files), *asked)
    said = [assumption for proof in proofs for assumption in proof.ledger()]
    ledger = (*said, LAYOUT) if said else ()
    executed = check_execution(project, folder, faults, progress, partner=partner, engine=engine)
    groups = [
        CheckGroup("files", "Files", delivered(project, files)),
        CheckGroup("layout", "Layout", tuple(layouts)),
        CheckGroup("telegrams", "Telegrams", tuple(telegrams)),
        *(group for group in exchanges if group is not None),
        CheckGroup("oracles", "Independent oracles", oracles),
        CheckGroup("execution", "Execution", tuple(executed)),
    ]
    target = f"{project.target.family} / {project.target.toolchain}"
    return Verification(str(spec), str(folder), project.name, target, tuple(groups), tuple(report), ledger=ledger)
