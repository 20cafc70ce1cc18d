"""Verification of what lies on disk: files, offsets, telegrams, exchanges with a partner, execution.

The second way of the data: it knows the files, the spec and the standards, never the generator's output objects.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Report, Severity, Span
from plcgen.proof.checks import Check, CheckGroup, Outcome, Verification
from plcgen.proof.effort import Faults

if TYPE_CHECKING:
    from plcgen.project.includes import Read
    from plcgen.project.nouns import Project
    from plcgen.proof.cache import VerdictCache
    from plcgen.proof.rig import ProgramBench
    from plcgen.proof.sharing import Sharing
    from plcgen.proof.suite import Proof

Progress = Callable[[str, int, int], None]


@dataclass(frozen=True, slots=True)
class Means:
    """What a verification is done with.

    ``executor`` None are processes of this machine; ``cache`` is a folder of verdicts, None if nothing is kept.
    ``notes`` gets what happened on the way.
    """

    executor: Executor | None = None
    cache: Path | None = None
    notes: list[Diagnostic] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class Asked:
    """What is to be verified, and how much of it; ``drive`` replaces the profile's simulated drive.

    ``faults`` is how much of the fault matrix the generated SCL runs through, ``dissector`` sends the telegrams through
    ``tshark``, ``read`` gives the text of the spec (None: the file).
    """

    spec: Path
    folder: Path
    drive: Path | None = None
    faults: Faults = "quick"
    dissector: bool = False
    read: Read | None = None


def verify(asked: Asked, progress: Progress | None = None, means: Means | None = None) -> Verification:
    """Verify a folder against its spec."""
    report = Report()
    try:
        return _verify(asked, progress, means or Means(), report)
    except DiagnosticError as problem:
        report.extend(problem.diagnostics)
    return Verification(str(asked.spec), str(asked.folder), "", "", (), tuple(report))


def _opened(asked: Asked, report: Report) -> Project:
    from plcgen.project.composing import from_disk
    from plcgen.project.opening import open_spec

    opened = open_spec(asked.spec, asked.read or from_disk)
    project = opened.sound()
    report.extend(opened.diagnostics)
    if not asked.folder.is_dir():
        report.add(Diagnostic("PG507", "there is no such folder", Span(str(asked.folder)), help="run plcgen generate"))
        report.raise_on_errors()
    return project


def _sharing(asked: Asked, progress: Progress | None, means: Means) -> tuple[Sharing, VerdictCache | None]:
    """How the parts are run."""
    from plcgen.proof.sharing import Sharing

    cache = _cache(asked, means)
    return Sharing(means.executor, None, cache, progress, means.notes), cache


def _cache(asked: Asked, means: Means) -> VerdictCache | None:
    from plcgen.proof.cache import VerdictCache
    from plcgen.proof.fingerprint import has_plugins

    if means.cache is None or has_plugins():
        return None
    cache = VerdictCache(means.cache, asked.folder)
    try:
        cache.open()
    except OSError as problem:
        message = f"the cache of verdicts is not used: {problem.strerror or problem}"
        help_ = "make it a folder of your own (chmod 700), name another one with --cache, or use --no-cache"
        means.notes.append(Diagnostic("PG624", message, Span(str(means.cache)), Severity.WARNING, help=help_))
        return None
    return cache


def stated_group(proofs: Sequence[Proof], bench: ProgramBench) -> list[CheckGroup]:
    """What the files do against what the spec demands; not run if they do not compile."""
    from plcgen.proof.making import Pending, make_checks

    place = Span(str(bench.folder))

    def stated() -> Iterator[Check]:
        try:
            program = bench.program
        except DiagnosticError:
            yield Check("spec", "spec", "", Outcome.NOT_RUN, "not run: the sources do not compile")
            return
        for proof in proofs:
            yield from proof.stated(program)

    checks = tuple(make_checks((Pending("spec", "spec", lambda: place, stated),), "spec", place))
    return [CheckGroup("spec", "Spec", checks)] if checks else []


def _verify(asked: Asked, progress: Progress | None, means: Means, report: Report) -> Verification:
    from plcgen.proof.execution import check_execution
    from plcgen.proof.files import delivered
    from plcgen.proof.folder import read_folder
    from plcgen.proof.layouts import layout_pending
    from plcgen.proof.ledger import LAYOUT
    from plcgen.proof.making import Pending, make_checks
    from plcgen.proof.rig import ProgramBench
    from plcgen.proof.second_layout import check_second_layout
    from plcgen.proof.versions import check_versions

    project, folder, partner = _opened(asked, report), asked.folder, asked.drive
    share, cache = _sharing(asked, progress, means)
    place = Span(str(folder))
    files = read_folder(folder, project.target, progress)
    proofs = [plan.protocol.proof(plan) for plan in project.plans]
    layouts = (layout_pending(project, files, laid) for proof in proofs for laid in proof.layouts())
    telegrams = (check for proof in proofs for check in proof.telegrams(files))
    exchanges = [proof.exchanges(files, partner, progress) for proof in proofs]
    second = Pending("layouts", "all layouts", lambda: place, partial(check_second_layout, files))
    versions = Pending("versions", "versions", lambda: place, partial(check_versions, project, files))
    oracles = (one for proof in proofs for one in proof.oracles(files, dissector=asked.dissector))
    said = [assumption for proof in proofs for assumption in proof.ledger()]
    ledger = (*said, LAYOUT) if said else ()
    groups = [
        CheckGroup("files", "Files", delivered(project, files)),
        CheckGroup("layout", "Layout", tuple(make_checks(layouts, "layout", place))),
        CheckGroup("telegrams", "Telegrams", tuple(make_checks(telegrams, "telegrams", place))),
        *(group for group in exchanges if group is not None),
        CheckGroup(
            "oracles", "Independent oracles", tuple(make_checks((second, versions, *oracles), "oracles", place))
        ),
    ]
    del files
    bench = ProgramBench(project, folder)
    groups += stated_group(proofs, bench)
    executed = check_execution(project, folder, asked.faults, share, partner=partner, bench=bench)
    groups.append(CheckGroup("execution", "Execution", tuple(executed)))
    if cache is not None:
        cache.close()
    report.extend(means.notes)
    target = f"{project.target.family} / {project.target.toolchain}"
    return Verification(str(asked.spec), str(folder), project.name, target, tuple(groups), tuple(report), ledger=ledger)
