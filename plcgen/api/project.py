"""What is done with a spec: check, generate, verify, simulate."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from plcgen.api.arguments import expect
from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Report, Severity, Span, has_errors
from plcgen.proof.effort import FAULTS, Faults

if TYPE_CHECKING:
    from collections.abc import Sequence
    from concurrent.futures import Executor

    from plcgen.build.writing import WrittenFolder
    from plcgen.project.fit import ProgramSize
    from plcgen.project.includes import Read
    from plcgen.project.nouns import Project
    from plcgen.project.target import Target
    from plcgen.proof import Asked, Means
    from plcgen.proof.checks import Verification
    from plcgen.report.review.model import Review
    from plcgen.report.trace.model import Trace

MAX_SIZED = 16 * 1024 * 1024
"""Larger sources are not estimated: it would take longer than making them."""
SOURCE_SUFFIXES = (".scl", ".udt", ".db")

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
        return not has_errors(self.diagnostics)


@dataclass(frozen=True, slots=True)
class GenerateResult:
    """What generation did to the output folder; ``diff`` is the unified diff of ``check=True``.

    ``idle_statements`` are those of an idle scan, if they were asked for and the blocks run.
    """

    spec: Path
    folder: Path
    written: tuple[str, ...]
    unchanged: tuple[str, ...]
    removed: tuple[str, ...]
    diff: str
    diagnostics: tuple[Diagnostic, ...]
    target: Target | None = None
    idle_statements: int | None = None

    @property
    def ok(self) -> bool:
        """Whether no diagnostic is an error."""
        return not has_errors(self.diagnostics)

    def size(self) -> ProgramSize | None:
        """What the files in the folder take of the PLC; None if there are none, or more than 16 MB of sources."""
        from plcgen.project.fit import ProgramSize
        from plcgen.s7.memory.estimate import estimate
        from plcgen.s7.read.blocks import read_sources
        from plcgen.s7.read.generated import generated_sources

        target = self.target
        if target is None or not self.folder.is_dir():
            return None
        paths = generated_sources(self.folder)
        if not paths or sum(path.stat().st_size for path in paths) > MAX_SIZED:
            return None
        symbols = [path for path in (self.folder / "symbols.sdf",) if path.is_file()]
        sources = read_sources([*paths, *symbols], classic=target.classic)
        return ProgramSize(estimate(sources, target.dialect), target.cpu, self.idle_statements)


STRICT = frozenset({"PG228", "PG261"})
"""Warnings that are errors if somebody wants to be sure: what a green run would otherwise rest on unseen."""


def hardened(diagnostics: Iterable[Diagnostic]) -> tuple[Diagnostic, ...]:
    """The same, with what ``strict`` makes an error, unless a comment of the spec allows it."""
    return tuple(
        replace(d, severity=Severity.ERROR) if d.code in STRICT and d.severity is Severity.WARNING else d
        for d in diagnostics
    )


def check(spec: Path | str, *, strict: bool = False, read: Read | None = None) -> CheckResult:
    """Read, validate and plan a spec and apply every rule to it; notes tell what is written to inputs left open.

    ``strict`` makes errors of what is not known; ``read`` gives the text of a file in place of the one on disk.

    If it names a CPU, its blocks are made, though not written: what does not fit the CPU is a warning.
    """
    from plcgen.project.allowances import idle, settled
    from plcgen.project.opening import allowed_in
    from plcgen.project.rules import remarks

    found = problems_of(spec, read)
    if strict:
        found = replace(found, diagnostics=hardened(found.diagnostics))
    if found.project is None or not found.ok:
        return found
    more, allowed = list(remarks(found.project)), allowed_in(found.project)
    own = tuple(each for each in allowed if each.span.file == found.project.loaded.file or not each.has_reason)
    told = [*found.diagnostics, *settled(more, allowed), *idle([*found.diagnostics, *more], own)]
    return replace(found, diagnostics=tuple(Report(told)))


def problems_of(spec: Path | str, read: Read | None = None) -> CheckResult:
    """What is wrong with a spec, and what does not fit its CPU."""
    from plcgen.project.allowances import settled
    from plcgen.project.opening import allowed_in

    found = _planned(spec, read)
    project = found.project
    if (
        project is None
        or project.target.cpu is None
        or not found.ok
        or any(d.code == "PG411" for d in found.diagnostics)
    ):
        return found
    report = Report([*found.diagnostics, *settled(_misfits(project), allowed_in(project))])
    return replace(found, diagnostics=tuple(report))


def _planned(spec: Path | str, read: Read | None) -> CheckResult:
    from plcgen.project.composing import from_disk
    from plcgen.project.opening import open_spec

    path = Path(spec)
    opened = open_spec(path, read or from_disk)
    return CheckResult(path, opened.project, opened.diagnostics)


def _misfits(project: Project) -> tuple[Diagnostic, ...]:
    """What of the project's blocks does not fit its CPU, by an estimate of their texts."""
    from plcgen.build.engine import emit
    from plcgen.build.environment import render_all
    from plcgen.project.fit import ProgramSize
    from plcgen.s7.memory.estimate import estimate
    from plcgen.s7.read.blocks import read_texts
    from plcgen.s7.read.text import decode_source

    texts: list[tuple[str, str]] = []
    length = 0
    documents = (replace(document, twins=None) for document in emit(project) if document.path.endswith(SOURCE_SUFFIXES))
    for file in render_all(documents):
        length += len(file.data)
        text = decode_source(file.data, file.path)
        if length > MAX_SIZED or not isinstance(text, str):
            return ()
        texts.append((file.path, text))
    size = ProgramSize(estimate(read_texts(texts), project.target.dialect), project.target.cpu)
    return tuple(size.misfits(project.loaded.span(("plc", "cpu"))))


def default_folder(spec: Path) -> Path:
    """Output folder of a spec if none is given: ``machines/press.yaml`` -> ``machines/press_generated``."""
    return spec.with_name(f"{spec.stem}_generated")


def _folder(spec: Path | str, folder: Path | str | None) -> Path:
    return default_folder(Path(spec)) if folder is None else Path(folder)


def generate(
    spec: Path | str,
    folder: Path | str | None = None,
    *,
    check_only: bool = False,
    force: bool = False,
    stats: bool = False,
    progress: Progress | None = None,
) -> GenerateResult:
    """Generate all files of a spec into a folder, atomically; nothing is written if there is an error.

    Without ``folder`` it is ``<spec>_generated`` beside the spec.

    ``check_only`` writes nothing and compares; ``force`` overwrites files that were changed by hand; ``stats`` runs an
    idle scan of the blocks and counts its statements.
    """
    from plcgen.build.rendering import render_project
    from plcgen.build.writing import compare_folder, write_folder

    target = _folder(spec, folder)
    checked = problems_of(spec)
    if not checked.ok or checked.project is None:
        return GenerateResult(checked.spec, target, (), (), (), "", checked.diagnostics)
    report = Report(list(checked.diagnostics))
    written: Iterable[str] = ()
    unchanged: Iterable[str] = ()
    removed: Iterable[str] = ()
    diff = ""
    with report.catch():
        files = render_project(checked.project, progress)
        owned = checked.project.loaded.spec.plc.user_owned
        if check_only:
            diff, found = compare_folder(files, target, owned)
            report.extend(found)
        else:
            result = write_folder(files, target, force=force, owned=owned)
            written, unchanged, removed = result.written, result.unchanged, result.removed
            report.extend(_left_behind(result, target))
    idle = None
    if stats and target.is_dir():
        from plcgen.proof.idle import idle_statements

        idle = idle_statements(checked.project, target)
    return GenerateResult(
        checked.spec,
        target,
        tuple(written),
        tuple(unchanged),
        tuple(removed),
        diff,
        tuple(report),
        checked.project.target,
        idle,
    )


def _left_behind(result: WrittenFolder, target: Path) -> Iterator[Diagnostic]:
    """PG502: what writing did not remove. PG505: what an earlier generation had left half-way."""
    for name in result.kept:
        message = "kept: it is no longer generated, but was changed by hand"
        place = Span(str(target / name))
        yield Diagnostic("PG502", message, place, Severity.WARNING, help="delete it if it is not needed")
    if result.recovered:
        note = "an earlier generation was interrupted: its files were completed or discarded"
        yield Diagnostic("PG505", note, Span(str(target)), Severity.NOTE)


def verify(
    spec: Path | str,
    folder: Path | str | None = None,
    *,
    drive: Path | str | None = None,
    faults: Faults = "quick",
    oracle: Literal["tshark"] | None = None,
    strict: bool = False,
    progress: Progress | None = None,
    executor: Executor | None = None,
    scheduler: str | None = None,
    cache: Path | str | None = None,
) -> Verification:
    """Verify what lies in a folder against its spec, DS47 and a simulated drive (optionally from a drive file).

    The generated SCL is executed; ``faults`` is how much of the fault matrix runs. ``oracle`` asks Wireshark about
    every telegram, ``strict`` makes errors of what is not known.

    The parts of the execution run on ``executor``, or on the Dask cluster of a ``scheduler``, else in processes of this
    machine; ``cache`` is a folder of verdicts of the user's own.

    Raises:
        ArgumentError: if ``faults`` or ``oracle`` is another word.
    """
    from plcgen.proof import Asked, Means
    from plcgen.proof import verify as run

    expect("faults", faults, FAULTS)
    expect("oracle", oracle, ("tshark",))
    asked = Asked(
        Path(spec),
        _folder(spec, folder),
        Path(drive) if drive is not None else None,
        faults,
        oracle == "tshark",
    )
    kept = Path(cache) if cache is not None else None
    means = Means(executor, kept)
    found = run(asked, progress, means) if scheduler is None else _on_cluster(scheduler, asked, progress, means)
    return replace(found, diagnostics=hardened(found.diagnostics)) if strict else found


def _on_cluster(scheduler: str, asked: Asked, progress: Progress | None, means: Means) -> Verification:
    from plcgen.proof import verify as run
    from plcgen.proof.checks import Verification
    from plcgen.proof.cluster import cluster

    lost: list[Diagnostic] = []
    try:
        with cluster(scheduler, lost) as executor:
            found = run(asked, progress, replace(means, executor=executor))
    except DiagnosticError as problem:
        return Verification(str(asked.spec), str(asked.folder), "", "", (), tuple(problem.diagnostics))
    return replace(found, diagnostics=(*found.diagnostics, *lost))


def simulate(
    spec: Path | str,
    folder: Path | str | None = None,
    *,
    jobs: Sequence[str] = (),
    scans: int | None = None,
    scan_time: int | str = 10,
    sets: Sequence[str] = (),
    watches: Sequence[str] = (),
    faults: Sequence[str] = (),
    fault_file: Path | str | None = None,
    drives: Sequence[str] = (),
    inputs: Path | str | None = None,
    own: Sequence[Path | str] = (),
    progress: Progress | None = None,
) -> Trace:
    """Run the generated files in a folder in the soft CPU and record every scan; see ``docs/simulate.md``.

    The arguments are spelled as on the command line: ``sets`` ``MEMBER=VALUE``, ``faults`` ``KIND:KEY=VALUE``,
    ``drives`` ``FILE`` or ``DRIVE=FILE``; ``own`` are SCL files of the user, ``scan_time`` is in ms or a text
    like ``10ms``, ``inputs`` a file with more ``sets``.
    """
    from plcgen.report.trace.run import RunSettings, Simulation

    chosen = Path(fault_file) if fault_file is not None else None
    sources = tuple(Path(path) for path in own)
    given = Path(inputs) if inputs is not None else None
    settings = RunSettings(jobs, scans, scan_time, sets, watches, faults, chosen, drives, given)
    return Simulation(Path(spec), _folder(spec, folder), sources).run(settings, progress)


def review(
    spec: Path | str,
    folder: Path | str | None = None,
    *,
    against: str = "",
    lock: Path | str | None = None,
    faults: Faults = "quick",
    fault: str = "",
    progress: Progress | None = None,
) -> Review:
    """Collect what a reviewer must see of a spec and its generated folder; see ``docs/review.md``.

    ``against`` is a folder, a spec, or a git revision of the repository that the spec lies in.

    Raises:
        DiagnosticError: PG901 if there is nothing of that name, or ``fault`` makes no sense.
        ArgumentError: if ``faults`` is another word.
    """
    from plcgen.report.review.collect import collect
    from plcgen.report.review.model import ReviewRequest

    expect("faults", faults, FAULTS)
    own = Path(lock) if lock is not None else None
    return collect(ReviewRequest(Path(spec), _folder(spec, folder), against, faults, fault, own), progress)
