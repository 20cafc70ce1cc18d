"""The verbs of the command line as Python functions: check, generate, verify, layout, encode, decode, ...

Every function returns frozen results with their diagnostics; none prints, none exits. A user's mistake is a
diagnostic in the result, never an exception.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from plcgen.diagnostics import Diagnostic, DiagnosticError, Report

if TYPE_CHECKING:
    from plcgen.plan.model import Project
    from plcgen.verify.model import Verification

Progress = Callable[[str, int, int], None]
"""Called as ``progress(what, done, total)`` during long work."""


@dataclass(frozen=True, slots=True)
class CheckResult:
    """A checked spec: the plan (None if the spec is unusable) and everything found."""

    spec: Path
    project: Project | None
    diagnostics: tuple[Diagnostic, ...]

    @property
    def ok(self) -> bool:
        """Whether no diagnostic is an error."""
        return not any(d.severity.label == "error" for d in self.diagnostics)


@dataclass(frozen=True, slots=True)
class GenerateResult:
    """What generation did to the output folder; ``diff`` is the unified diff of ``check=True``."""

    spec: Path
    folder: Path
    written: tuple[str, ...]
    unchanged: tuple[str, ...]
    removed: tuple[str, ...]
    diff: str
    diagnostics: tuple[Diagnostic, ...]

    @property
    def ok(self) -> bool:
        """Whether no diagnostic is an error."""
        return not any(d.severity.label == "error" for d in self.diagnostics)


def check(spec: Path | str) -> CheckResult:
    """Read, validate and plan a spec and apply every rule to it."""
    from plcgen.plan.resolve import resolve
    from plcgen.rules import apply_rules
    from plcgen.spec.load import load_spec

    path = Path(spec)
    report = Report()
    project = None
    try:
        loaded = load_spec(path, report)
        if loaded is not None:
            project = resolve(loaded, report)
            apply_rules(project, report)
    except DiagnosticError as problem:
        report.extend(problem.diagnostics)
    return CheckResult(path, project, tuple(report))


def generate(
    spec: Path | str,
    folder: Path | str,
    *,
    check_only: bool = False,
    force: bool = False,
    progress: Progress | None = None,
) -> GenerateResult:
    """Generate all files of a spec into a folder, atomically; nothing is written if there is an error.

    ``check_only`` writes nothing and compares; ``force`` overwrites files that were changed by hand.
    """
    from plcgen.emit import emit
    from plcgen.render.write import compare_folder, write_folder

    target = Path(folder)
    checked = check(spec)
    if not checked.ok or checked.project is None:
        return GenerateResult(checked.spec, target, (), (), (), "", checked.diagnostics)
    report = Report(list(checked.diagnostics))
    written: Iterable[str] = ()
    unchanged: Iterable[str] = ()
    removed: Iterable[str] = ()
    diff = ""
    try:
        files = emit(checked.project, progress)
        if check_only:
            diff, found = compare_folder(files, target)
            report.extend(found)
        else:
            written, unchanged, removed = write_folder(files, target, force=force, progress=progress)
    except DiagnosticError as problem:
        report.extend(problem.diagnostics)
    return GenerateResult(checked.spec, target, tuple(written), tuple(unchanged), tuple(removed), diff, tuple(report))


def verify(
    spec: Path | str, folder: Path | str, *, drive: Path | str | None = None, progress: Progress | None = None
) -> Verification:
    """Verify what lies in a folder against its spec, DS47 and a simulated drive (optionally from a drive file)."""
    from plcgen.verify import verify as run

    return run(Path(spec), Path(folder), Path(drive) if drive is not None else None, progress)
