"""What is done with anyone's sources: layout, convert, diff, lock, audit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from plcgen.api.arguments import expect
from plcgen.api.project import problems_of
from plcgen.base.diagnostics import Diagnostic, Report, Span, has_errors
from plcgen.base.files.files import YAML_SUFFIXES
from plcgen.s7.tables.tables import BlockTable, LayoutResult
from plcgen.s7.types.system import FAMILIES, Family

if TYPE_CHECKING:
    from plcgen.proof.checks import Verification
    from plcgen.report.diff.lock import LockResult
    from plcgen.s7.compare.model import Comparison

SPEC_SUFFIXES = YAML_SUFFIXES


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
        return not has_errors(self.diagnostics)


def layout(*paths: Path | str, family: Family | None = None, block: str = "", expand: bool = False) -> LayoutResult:
    """Lay out the telegram buffers of specs (``.yaml``) and the blocks of PLC sources (all other files, folders).

    Types may stand in any of the files, in any order; UDT and SCL files beside a source (or in ``../udt`` and
    ``../scl``) are looked at too. ``family`` decides what a TON or WRREC inside an FB is (None: as the other
    types in the sources suggest), ``block`` picks blocks by
    name or number (``DB3``), ``expand`` shows every element of every array.

    Raises:
        ArgumentError: if ``family`` is another word.
    """
    from plcgen.base.files.hashes import path_hashes
    from plcgen.report.diff.planned_layout import project_tables

    expect("family", family, FAMILIES)
    tables: list[BlockTable] = []
    report = Report()
    sources: list[Path] = []
    subjects: list[str] = []
    for path in map(Path, paths):
        if path.suffix.lower() in SPEC_SUFFIXES:
            checked = problems_of(path)
            report.extend(checked.diagnostics)
            if checked.project is not None:
                subjects.append(checked.project.name)
                tables += project_tables(checked.project)
        else:
            sources.append(path)
    tables = [table for table in tables if not block or _is_called(table.name, table.kind, table.number, block)]
    agreed = 0
    if sources:
        found, agreed = _source_tables(sources, report, family, block, expand=expand)
        tables += found
    if block and not tables and not report.has_errors:
        report.add(Diagnostic("PG806", f'there is no DB, UDT or FB "{block}" in these files', Span(str(paths[0]))))
    names = subjects if not sources else []
    origins = tuple(path_hashes(list(map(Path, paths))))
    return LayoutResult(tuple(tables), tuple(report), ", ".join(names), origins, agreed)


def _source_tables(
    paths: Sequence[Path], report: Report, family: Family | None, block: str, *, expand: bool
) -> tuple[list[BlockTable], int]:
    """The tables, and how many offsets that the documents state are the same in them."""
    from plcgen.s7.read.files import read_files
    from plcgen.s7.tables.declared import block_tables
    from plcgen.s7.types.system import family_types
    from plcgen.s7.xml.reading.invariants import Stated, compare_offsets, document_offsets

    stated: dict[str, dict[str, list[Stated]]] = {}
    classic = family in {"s7-300", "s7-400"}
    files = read_files(
        paths, classic=classic, seen=lambda file, root: stated.update({file: document_offsets(file, root)})
    )
    report.extend(files.diagnostics)
    known = {(d.code, d.span) for d in files.diagnostics}
    circles = any(d.code == "PG807" for d in files.diagnostics)
    if family is None and files.modern:
        family = "s7-1500"
    tables: list[BlockTable] = []
    agreed = 0
    for plc, part in (files.parts or {"": files}).items():
        for name, system in family_types(family).items():
            part.types.setdefault(name, system)
        chosen = [b for b in part.blocks if not block or _is_called(b.name, b.kind.value, b.number, block)]
        found, problems = block_tables(chosen, part.types, expand=expand)
        tables += [replace(table, name=f"{plc}/{table.name}") if plc else table for table in found]
        differences, same = compare_offsets(chosen, part.types, stated)
        agreed += same
        report.extend(differences)
        report.extend(d for d in problems if (d.code, d.span) not in known and not (circles and d.code == "PG807"))
    return [replace(table, unsaid=False) for table in tables] if classic else tables, agreed


def _is_called(name: str, kind: str, number: int | None, wanted: str) -> bool:
    plain = wanted.strip('"').upper()
    return plain == name.upper() or (number is not None and plain.replace(" ", "") == f"{kind}{number}")


def convert(
    *paths: Path | str,
    to: Literal["scl", "xml", "sd"],
    out: Path | str,
    version: str = "V16",
    classic: bool = False,
    culture: str = "en-US",
    encoding: str | None = None,
    force: bool = False,
    keep_going: bool = False,
) -> ConvertResult:
    """Write the blocks of sources (files or folders) as SCL text, as SimaticML or as SIMATIC SD, one file per block.

    ``version`` is the TIA Portal version of the documents (``V14 SP1``, ``V15`` .. ``V21``), ``culture`` the language
    of their comments, ``encoding`` the code page of ANSI sources. Nothing is written if something is wrong, unless
    ``keep_going`` says to leave that out, or if a file exists and ``force`` is not given.

    Raises:
        ArgumentError: if ``to`` or ``version`` is another word; SIMATIC SD is of V20 and V21.
    """
    from plcgen.build.convert import convert as run
    from plcgen.build.writing import add_files
    from plcgen.s7.xml.reading.source import VERSIONS as SD_VERSIONS
    from plcgen.s7.xml.spelling import VERSIONS

    expect("to", to, ("scl", "xml", "sd"))
    expect("version", version, SD_VERSIONS if to == "sd" else VERSIONS)
    found = run(
        [Path(path) for path in paths],
        to,
        version=version,
        classic=classic,
        culture=culture,
        encoding=encoding,
        keep_going=keep_going,
    )
    report = Report()
    report.extend(found.diagnostics)
    written: tuple[str, ...] = ()
    unchanged: tuple[str, ...] = ()
    if found.files:
        with report.catch():
            done = add_files(found.files, Path(out), force=force)
            written, unchanged = done.written, done.unchanged
    return ConvertResult(Path(out), written, unchanged, tuple(report))


def diff(
    old: Path | str | Sequence[Path | str],
    new: Path | str | Sequence[Path | str],
    *,
    policy: Sequence[str] = (),
    classic: bool = False,
    keep_going: bool = False,
) -> Comparison:
    """Compare two versions of sources (files or folders) or specs from the outside.

    ``policy`` holds ``id=class`` settings and policy files, later ones win; ``classic``: SimaticML documents are
    for S7-300/400; ``keep_going``: files that cannot be read are left out, with a warning.
    """
    from plcgen.report.diff.run import compare

    return compare(_paths(old), _paths(new), policy, classic=classic, keep_going=keep_going)


def lock(
    *paths: Path | str,
    out: Path | str = "plcgen.lock.json",
    classic: bool = False,
    force: bool = False,
    keep_going: bool = False,
) -> LockResult:
    """Write the layout lock of sources (files or folders) or one spec; without paths, of those the lock names."""
    from plcgen.report.diff.lock import write_lock

    return write_lock([Path(path) for path in paths], Path(out), classic=classic, force=force, keep_going=keep_going)


def check_lock(
    *paths: Path | str,
    lock: Path | str = "plcgen.lock.json",
    policy: Sequence[str] = (),
    classic: bool = False,
    keep_going: bool = False,
) -> Comparison:
    """Compare a layout lock with sources or a spec; without paths, with those the lock names."""
    from plcgen.report.diff.lock import check_lock as run

    return run([Path(path) for path in paths], Path(lock), policy, classic=classic, keep_going=keep_going)


def audit(*paths: Path | str, spec: Path | str) -> Verification:
    """Audit hand-written buffers and the calls that send them, in sources against a spec."""
    from plcgen.proof.audited import audit_files as run

    return run([Path(path) for path in paths], Path(spec))


def _paths(given: Path | str | Sequence[Path | str]) -> list[Path]:
    return [Path(given)] if isinstance(given, Path | str) else [Path(path) for path in given]
