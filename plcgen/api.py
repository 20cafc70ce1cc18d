"""The verbs of the command line as Python functions: check, generate, verify, simulate, layout, encode, ...

Every function returns frozen results with their diagnostics; none prints, none exits. A user's mistake is a
diagnostic in the result, never an exception.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from plcgen.diagnostics import Diagnostic, DiagnosticError, Report, Severity, Span
from plcgen.resources import collector_paused

if TYPE_CHECKING:
    from collections.abc import Sequence

    from plcgen.compare.lock import LockResult
    from plcgen.compare.model import Comparison
    from plcgen.ds47.model import ParameterAddress, ValueBlock
    from plcgen.ds47.status import Status
    from plcgen.plan.model import Project
    from plcgen.report.layout import BlockTable
    from plcgen.report.page import Page
    from plcgen.report.telegram import DecodedTelegram
    from plcgen.trace.model import Trace
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
    progress: Progress | None = None,
) -> GenerateResult:
    """Generate all files of a spec into a folder, atomically; nothing is written if there is an error.

    Without ``folder`` it is ``<spec>_generated`` beside the spec.

    ``check_only`` writes nothing and compares; ``force`` overwrites files that were changed by hand.
    """
    from plcgen.render.project import render_project
    from plcgen.render.write import compare_folder, write_folder

    target = _folder(spec, folder)
    with collector_paused():
        checked = check(spec)
    if not checked.ok or checked.project is None:
        return GenerateResult(checked.spec, target, (), (), (), "", checked.diagnostics)
    report = Report(list(checked.diagnostics))
    written: Iterable[str] = ()
    unchanged: Iterable[str] = ()
    removed: Iterable[str] = ()
    diff = ""
    try:
        files = render_project(checked.project, progress)
        if check_only:
            diff, found = compare_folder(files, target)
            report.extend(found)
        else:
            result = write_folder(files, target, force=force, progress=progress)
            written, unchanged, removed = result.written, result.unchanged, result.removed
            for name in result.kept:
                message = "kept: it is no longer generated, but was changed by hand"
                place = Span(str(target / name))
                report.add(Diagnostic("PG502", message, place, Severity.WARNING, help="delete it if it is not needed"))
            if result.recovered:
                note = "an earlier generation was interrupted: its files were completed or discarded"
                report.add(Diagnostic("PG505", note, Span(str(target)), Severity.NOTE))
    except DiagnosticError as problem:
        report.extend(problem.diagnostics)
    return GenerateResult(checked.spec, target, tuple(written), tuple(unchanged), tuple(removed), diff, tuple(report))


def verify(
    spec: Path | str,
    folder: Path | str | None = None,
    *,
    drive: Path | str | None = None,
    faults: Literal["none", "quick", "full"] = "quick",
    progress: Progress | None = None,
) -> Verification:
    """Verify what lies in a folder against its spec, DS47 and a simulated drive (optionally from a drive file).

    The generated SCL is executed; ``faults`` is how much of the fault matrix runs.
    """
    from plcgen.verify import verify as run

    return run(Path(spec), _folder(spec, folder), Path(drive) if drive is not None else None, progress, faults)


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
    own: Sequence[Path | str] = (),
    progress: Progress | None = None,
) -> Trace:
    """Run the generated files in a folder in the soft CPU and record every scan; see ``docs/simulate.md``.

    The arguments are spelled as on the command line: ``sets`` ``MEMBER=VALUE``, ``faults`` ``KIND:KEY=VALUE``,
    ``drives`` ``FILE`` or ``DRIVE=FILE``; ``own`` are SCL files of the user, ``scan_time`` is in ms or a text
    like ``10ms``.
    """
    from plcgen.trace.run import Settings
    from plcgen.trace.run import simulate as run

    chosen = Path(fault_file) if fault_file is not None else None
    sources = tuple(Path(path) for path in own)
    settings = Settings(jobs, scans, scan_time, sets, watches, faults, chosen, drives, sources)
    return run(Path(spec), _folder(spec, folder), settings, progress)


@dataclass(frozen=True, slots=True)
class LayoutResult:
    """Memory layouts: of a spec's telegram buffers, or of the blocks in source files."""

    blocks: tuple[BlockTable, ...]
    diagnostics: tuple[Diagnostic, ...]

    @property
    def ok(self) -> bool:
        """Whether no diagnostic is an error."""
        return not any(d.severity.label == "error" for d in self.diagnostics)


@dataclass(frozen=True, slots=True)
class ConvertResult:
    """What a conversion wrote: names in the folder, and what could not be converted."""

    folder: Path
    written: tuple[str, ...]
    unchanged: tuple[str, ...]
    diagnostics: tuple[Diagnostic, ...]

    @property
    def ok(self) -> bool:
        """Whether no diagnostic is an error."""
        return not any(d.severity.label == "error" for d in self.diagnostics)


@dataclass(frozen=True, slots=True)
class EncodedTelegram:
    """A request as bytes: which job, which of its telegrams (from 1), the data block it lies in."""

    job: str
    index: int
    block: str
    data: bytes


@dataclass(frozen=True, slots=True)
class EncodeResult:
    """Requests as bytes, in the order in which they are sent."""

    telegrams: tuple[EncodedTelegram, ...]
    diagnostics: tuple[Diagnostic, ...]

    @property
    def ok(self) -> bool:
        """Whether no diagnostic is an error."""
        return not any(d.severity.label == "error" for d in self.diagnostics)


SPEC_SUFFIXES = frozenset({".yaml", ".yml"})


Family = Literal["s7-300", "s7-400", "s7-1200", "s7-1500"]


def layout(*paths: Path | str, family: Family | None = None, block: str = "", expand: bool = False) -> LayoutResult:
    """Lay out the telegram buffers of specs (``.yaml``) and the blocks of PLC sources (all other files, folders).

    Types may stand in any of the files, in any order; UDT and SCL files beside a source (or in ``../udt`` and
    ``../scl``) are looked at too. ``family`` decides what a TON or WRREC inside an FB is (None: as the other
    types in the sources suggest), ``block`` picks blocks by
    name or number (``DB3``), ``expand`` shows every element of every array.
    """
    with collector_paused():
        return _layout([Path(path) for path in paths], family, block, expand=expand)


def _layout(paths: Sequence[Path], family: Family | None, block: str, *, expand: bool) -> LayoutResult:
    from plcgen.report.planned import project_tables

    tables: list[BlockTable] = []
    report = Report()
    sources: list[Path] = []
    for path in paths:
        if path.suffix.lower() in SPEC_SUFFIXES:
            checked = check(path)
            report.extend(checked.diagnostics)
            if checked.project is not None:
                tables += project_tables(checked.project)
        else:
            sources.append(path)
    tables = [table for table in tables if not block or _is_called(table.name, table.kind, table.number, block)]
    if sources:
        tables += _source_tables(sources, report, family, block, expand=expand)
    if block and not tables and not report.has_errors:
        report.add(Diagnostic("PG806", f'there is no DB, UDT or FB "{block}" in these files', Span(str(paths[0]))))
    return LayoutResult(tuple(tables), tuple(report))


def convert(
    *paths: Path | str,
    to: Literal["scl", "xml"],
    out: Path | str,
    version: str = "V16",
    classic: bool = False,
    culture: str = "en-US",
    encoding: str | None = None,
    force: bool = False,
) -> ConvertResult:
    """Write the blocks of sources (files or folders) as SCL text or as SimaticML, one file per block.

    ``version`` is the TIA Portal version of the documents (``V14 SP1``, ``V15`` .. ``V21``), ``culture`` the language
    of their comments, ``encoding`` the code page of ANSI sources. Nothing is written if something is wrong, or if a
    file exists and ``force`` is not given.
    """
    from plcgen.render.convert import convert as run
    from plcgen.render.write import add_files

    found = run(
        [Path(path) for path in paths], to, version=version, classic=classic, culture=culture, encoding=encoding
    )
    report = Report()
    report.extend(found.diagnostics)
    written: tuple[str, ...] = ()
    unchanged: tuple[str, ...] = ()
    if found.ok:
        try:
            done = add_files(found.files, Path(out), force=force)
            written, unchanged = done.written, done.unchanged
        except DiagnosticError as problem:
            report.extend(problem.diagnostics)
    return ConvertResult(Path(out), written, unchanged, tuple(report))


def diff(
    old: Path | str | Sequence[Path | str],
    new: Path | str | Sequence[Path | str],
    *,
    policy: Sequence[str] = (),
    classic: bool = False,
) -> Comparison:
    """Compare two versions of sources (files or folders) or specs by what others notice.

    ``policy`` holds ``id=class`` settings and policy files, later ones win; ``classic``: SimaticML documents are
    for S7-300/400.
    """
    from plcgen.compare.run import compare

    return compare(_paths(old), _paths(new), policy, classic=classic)


def lock(
    *paths: Path | str, out: Path | str = "plcgen.lock.yaml", classic: bool = False, force: bool = False
) -> LockResult:
    """Write the layout lock of sources (files or folders) or one spec; without paths, of those the lock names."""
    from plcgen.compare.lock import write_lock

    return write_lock([Path(path) for path in paths], Path(out), classic=classic, force=force)


def check_lock(
    *paths: Path | str,
    lock: Path | str = "plcgen.lock.yaml",
    policy: Sequence[str] = (),
    classic: bool = False,
) -> Comparison:
    """Compare a layout lock with sources or a spec; without paths, with those the lock names."""
    from plcgen.compare.lock import check_lock as run

    return run([Path(path) for path in paths], Path(lock), policy, classic=classic)


def audit(*paths: Path | str, spec: Path | str) -> Verification:
    """Audit hand-written request and response DBs, and the record calls, in sources against a spec and DS47."""
    from plcgen.audit.run import audit as run

    return run([Path(path) for path in paths], Path(spec))


def _paths(given: Path | str | Sequence[Path | str]) -> list[Path]:
    return [Path(given)] if isinstance(given, Path | str) else [Path(path) for path in given]


def _source_tables(
    paths: Sequence[Path], report: Report, family: Family | None, block: str, *, expand: bool
) -> list[BlockTable]:
    from plcgen.read.files import read_files
    from plcgen.report.declared import block_tables
    from plcgen.s7.system import family_types

    classic = family in {"s7-300", "s7-400"}
    files = read_files(paths, classic=classic)
    report.extend(files.diagnostics)
    known = {(d.code, d.span) for d in files.diagnostics}
    circles = any(d.code == "PG807" for d in files.diagnostics)
    types = files.types
    if family is None and files.modern:
        family = "s7-1500"
    for name, system in family_types(family).items():
        types.setdefault(name, system)
    chosen = [b for b in files.blocks if not block or _is_called(b.name, b.kind.value, b.number, block)]
    tables, problems = block_tables(chosen, types, expand=expand)
    report.extend(d for d in problems if (d.code, d.span) not in known and not (circles and d.code == "PG807"))
    return tables


def _is_called(name: str, kind: str, number: int | None, wanted: str) -> bool:
    plain = wanted.strip('"').upper()
    return plain == name.upper() or (number is not None and plain.replace(" ", "") == f"{kind}{number}")


def encode(spec: Path | str, job: str | None = None) -> EncodeResult:
    """Return the requests of all jobs of a spec, or of one job, with their start values."""
    from plcgen.diagnostics.suggest import did_you_mean

    checked = check(spec)
    if checked.project is None or not checked.ok:
        return EncodeResult((), checked.diagnostics)
    jobs = [planned for planned in checked.project.jobs if job in {None, planned.key}]
    if not jobs:
        names = [planned.key for planned in checked.project.jobs]
        hint = f"{did_you_mean(job or '', names)} jobs of this spec: {', '.join(names)}".strip()
        span = checked.project.loaded.key_span(("jobs",))
        unknown = Diagnostic("PG703", f'the spec has no job "{job}"', span, help=hint)
        return EncodeResult((), (*checked.diagnostics, unknown))
    telegrams = [
        EncodedTelegram(planned.key, number, _block_text(telegram.request_db), telegram.request)
        for planned in jobs
        for number, telegram in enumerate(planned.telegrams, 1)
    ]
    return EncodeResult(tuple(telegrams), checked.diagnostics)


def _block_text(ref: Any) -> str:
    return f'{ref.kind}{ref.number} "{ref.name}"'


def encode_read(addresses: Sequence[ParameterAddress], *, drive_object: int = 1, reference: int = 1) -> bytes:
    """Return a read request. Raises TelegramError if a field does not fit or the record is too long."""
    from plcgen.ds47.codec import encode_request
    from plcgen.ds47.model import read_request

    return encode_request(read_request(reference, drive_object, addresses))


def encode_write(
    changes: Sequence[tuple[ParameterAddress, ValueBlock]], *, drive_object: int = 1, reference: int = 1
) -> bytes:
    """Return a change request. Raises TelegramError if a field does not fit or the record is too long."""
    from plcgen.ds47.codec import encode_request
    from plcgen.ds47.model import change_request

    return encode_request(change_request(reference, drive_object, changes))


def decode(
    data: bytes, *, kind: Literal["request", "response"] | None = None, request: bytes | None = None
) -> DecodedTelegram:
    """Take a telegram apart, as far as it goes; ``request`` gives a response its context."""
    from plcgen.report.telegram import dissect

    return dissect(data, kind, request)


def decode_status(value: int) -> Status:
    """Explain a STATUS double word of WRREC or RDREC."""
    from plcgen.ds47.status import explain

    return explain(value)


def explain(key: str) -> Page | None:
    """Explain a diagnostic code, DS47 error number, status word or STATUS; None if it is none of these."""
    from plcgen.report.explain import explain_page

    return explain_page(key)


def schema() -> dict[str, Any]:
    """JSON schema of a spec, for editors."""
    from plcgen.spec.schema import json_schema

    return json_schema()
