"""``plcgen check``: every problem of specs and of PLC sources."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from plcgen.api import default_folder
from plcgen.base.diagnostics.counting import quantity
from plcgen.base.files.files import YAML_SUFFIXES
from plcgen.cli.options import PATH, console, format_option, output_option, strict_option, verb
from plcgen.cli.output import OK, PROBLEMS, USAGE, Console
from plcgen.cli.watch import watch_option

if TYPE_CHECKING:
    from plcgen.base.diagnostics import Diagnostic
    from plcgen.base.display.results import Findings
    from plcgen.report.registry import OutputFormat

TARGETS = ("v5", "tia-300", "tia-1500")
IEC_CHECKS = ("on", "off", "as-stated")
_TABLE = "--program takes symbol tables with --tags"
_BESIDE = {
    ".xml": "--program reads documents beside sources, plcgen convert --to scl makes sources of them",
    ".sdf": _TABLE, ".asc": _TABLE, ".csv": _TABLE,
}  # fmt: skip
MAX_READ = 16 * 1024 * 1024
"""So many bytes of a source are searched for what its comments allow."""
Subject = tuple[str, Sequence["Diagnostic"]]


@verb(
    "check",
    "plcgen check job.yaml",
    "plcgen check machines/ --format github",
    "plcgen check job.yaml --format sarif --output plcgen.sarif",
    "plcgen check old/ --format json -o known.json   record what is wrong today",
    "plcgen check old/ --baseline known.json         and fail only on new problems",
    "plcgen check old_project/ --target tia-1500     what TIA would refuse in V5 sources",
    "plcgen check sources/ --program --target v5     compile it: names, types, calls",
)
@click.argument("paths", nargs=-1, type=PATH, metavar="SPEC|SOURCE|FOLDER...")
@click.option(
    "--target",
    type=click.Choice(TARGETS, case_sensitive=False),
    metavar="TARGET",
    help=f"Compiler of the sources: {', '.join(TARGETS)} (S7-1200 too).  [default: any of them]",
)
@click.option("--program", is_flag=True, help="Check sources and documents as one program: names, types, calls.")
@click.option(
    "--tags",
    type=PATH,
    multiple=True,
    metavar="FILE",
    help="With --program: symbols as SDF, ASC, CSV or tag table XML.",
)
@click.option(
    "--iec-check",
    multiple=True,
    metavar="WHEN[:BLOCK]",
    help="With --program: IEC check of all blocks or of one: on, off or as-stated (as the block's document says, "
    "otherwise the tool's default: on for tia-1500, off for tia-300).  [default: as-stated]",
)
@click.option("--encoding", metavar="NAME", help="Code page of ANSI sources, such as cp1252.  [default: guessed]")
@click.option(
    "--baseline",
    type=PATH,
    metavar="FILE",
    help="Leave out the problems in this earlier result of check --format json.",
)
@strict_option
@format_option("findings")
@output_option()
@watch_option(generated=False)
def command(
    *,
    paths: tuple[Path, ...],
    target: str | None,
    program: bool,
    tags: tuple[Path, ...],
    iec_check: tuple[str, ...],
    encoding: str | None,
    baseline: Path | None,
    strict: bool,
    format_: OutputFormat,
    output: Path | None,
) -> int:
    """Check specs (.yaml) and PLC sources (.scl .udt .db .awl), and show every problem at its place.

    Sources are read as the SCL compiler of a target reads them; a folder stands for all specs and sources below it,
    except what was generated from these specs. Nothing is written. Exit code 1 if there is an error anywhere;
    warnings alone give 0.
    """
    from plcgen.base.diagnostics import DiagnosticError, has_errors
    from plcgen.base.display.results import Findings
    from plcgen.cli.baseline import compare_baseline, read_baseline
    from plcgen.cli.specs import named

    out = console()
    _meant(program=program, target=target, of_programs={"--tags": tags, "--iec-check": iec_check})
    try:
        known = read_baseline(baseline) if baseline is not None else None
    except DiagnosticError as problem:
        out.complain(problem.diagnostics)
        return USAGE
    paths = named(paths)
    documents = _documents(paths) if program else []
    specs, sources = _sorted(tuple(path for path in paths if path not in documents), out, program=program)
    if program and not sources:
        raise click.UsageError("--program needs PLC sources (.scl .udt .db)")
    subjects: list[Subject] = _specs(specs, strict=strict)
    blocks = 0
    if program and target is not None:
        tables = (*_symbol_tables(paths), *tags)
        found_sources, blocks = _programs(paths, sources, documents, target, tables, _iec_checks(iec_check), encoding)
        subjects += found_sources
    elif sources:
        found_sources, blocks = _files(sources, target, encoding, out)
        subjects += found_sources
    subjects = [*subjects[: len(specs)], *map(_settled, subjects[len(specs) :])]
    more: dict[str, Any] = {"specs": [subject for subject, _ in subjects]}
    if known is not None:
        compared = compare_baseline(subjects, known)
        subjects = compared.subjects
        more["baseline"] = {"known": compared.known, "gone": compared.gone}
    found = Findings("check", subjects, more)
    if format_.name != "text" or found.diagnostics or output is not None:
        out.show(format_, "findings", found, output)
    if format_.name == "text":
        _summary(out, found, blocks if sources else None, program=program)
    if known is not None:
        gone = f"; {compared.gone} are gone: record it again" if compared.gone else ""
        out.say(f"{compared.known} known of {baseline} left out{gone}")
    return PROBLEMS if has_errors(found.diagnostics) else OK


def _meant(*, program: bool, target: str | None, of_programs: Mapping[str, tuple[object, ...]]) -> None:
    """What --program needs, and the options that mean nothing without it. Raises UsageError."""
    if program and target is None:
        raise click.UsageError(f"--program needs --target: one of {', '.join(TARGETS)}")
    for option, given in of_programs.items():
        if given and not program:
            raise click.UsageError(f"{option} is only for --program")


def _iec_checks(values: tuple[str, ...]) -> dict[str, str]:
    """``off`` and ``on:BLOCK`` by block, an empty name for all others."""
    found: dict[str, str] = {}
    for value in values:
        when, _, block = value.partition(":")
        if when not in IEC_CHECKS:
            raise click.UsageError(f"--iec-check is {', '.join(IEC_CHECKS)}, or one of them with :BLOCK, not {value}")
        found[block.strip('"')] = when
    return found


def _sorted(paths: tuple[Path, ...], out: Console, *, program: bool) -> tuple[list[Path], list[Path]]:
    """Tell specs from sources; what is no known source is taken for a spec. A folder has both, a program no specs."""
    specs: list[Path] = []
    sources: list[Path] = []
    for path in dict.fromkeys(paths):
        folder = path.is_dir()
        suffix = path.suffix.lower()
        if suffix in YAML_SUFFIXES or (not folder and not suffix):
            specs.append(path)
            continue
        from plcgen.cli.specs import tell
        from plcgen.project.below import Below, specs_below
        from plcgen.s7.cpu.sources import SUFFIXES, find_documents, find_sources
        from plcgen.s7.read.texts import SUFFIX as TEXTS

        if folder or suffix in SUFFIXES | {TEXTS}:
            looked = specs_below(path) if folder and not program else Below()
            tell(looked, out)
            below, inside = find_sources(path), looked.specs
            if not below and not inside:
                what = "PLC source (.scl .udt .db .awl)" if program or not folder else "spec and no PLC source"
                documents = folder and find_documents(path)
                better = ": plcgen convert --to scl makes sources of the documents there" if documents else ""
                raise click.UsageError(f"there is no {what} below {path}{better}")
            specs += inside
            made = [default_folder(spec) for spec in inside]  # what plcgen made of these is for verify
            sources += [source for source in below if not any(map(source.is_relative_to, made))]
        elif suffix in _BESIDE:
            raise click.UsageError(f"{path} is no spec and no PLC source (.scl .udt .db .awl): {_BESIDE[suffix]}")
        else:
            specs.append(path)
    return list(dict.fromkeys(specs)), list(dict.fromkeys(sources))


def _specs(specs: list[Path], *, strict: bool) -> list[Subject]:
    if not specs:
        return []
    from plcgen import api
    from plcgen.project.together import same_plc

    together = same_plc(specs)
    results = (api.check(spec, strict=strict) for spec in specs)
    return [(result.spec.as_posix(), (*result.diagnostics, *together.get(result.spec, ()))) for result in results]


def _files(sources: list[Path], target: str | None, encoding: str | None, out: Console) -> tuple[list[Subject], int]:
    """Every source on its own, blocks that are declared twice, and the number of blocks in all of them."""
    from plcgen.s7.cpu.sources import check_source, repeated_blocks
    from plcgen.s7.scl.dialect import BY_NAME

    checks = []
    with out.progress() as progress:
        for number, path in enumerate(sources, 1):
            checks.append(check_source(path, BY_NAME[target] if target else None, encoding=encoding))
            if progress is not None:
                progress(path.name, number, len(sources))
    again: dict[Path, list[Diagnostic]] = {}
    for path, diagnostic in repeated_blocks(checks):
        again.setdefault(path, []).append(diagnostic)
    subjects: list[Subject] = [
        (path.as_posix(), [*c.diagnostics, *again.get(path, ())]) for c in checks for path in c.paths
    ]
    return subjects, sum(c.blocks for c in checks)


def _settled(subject: Subject) -> Subject:
    """The findings of a source with what its comments allow."""
    from plcgen.base.files.files import read_bounded
    from plcgen.project.allowances import allowances, settled

    path, found = subject
    milder = [d for d in found if d.severity.label != "error"]
    if not milder:
        return subject
    try:
        text = read_bounded(Path(path), MAX_READ).decode("utf-8", "replace")
    except OSError:
        return subject
    return path, list(settled(found, allowances(text, milder[0].span.file)))


def _documents(paths: tuple[Path, ...]) -> list[Path]:
    """SimaticML documents that are named or lie in the folders: what they declare is known to a program."""
    from plcgen.s7.cpu.sources import find_documents

    named = [path for path in paths if path.is_dir() or path.suffix.lower() == ".xml"]
    return list(dict.fromkeys(document for path in named for document in find_documents(path)))


def _symbol_tables(paths: Sequence[Path]) -> list[Path]:
    """Symbol tables of STEP 7 V5 below the folders that are named; what only has the suffix is left alone."""
    from plcgen.s7.read.files import MAX_SEEN, SYMBOL_SUFFIXES, read_rows

    below = (file for path in paths if path.is_dir() for file in islice(path.rglob("*"), MAX_SEEN))
    return [
        file for file in sorted(file for file in below if file.suffix.lower() in SYMBOL_SUFFIXES) if read_rows(file)[0]
    ]


def _programs(
    paths: Sequence[Path],
    sources: list[Path],
    documents: list[Path],
    target: str,
    tags: tuple[Path, ...],
    checks: dict[str, str],
    encoding: str | None,
) -> tuple[list[Subject], int]:
    """The sources of each PLC together; what has no place belongs to the first one."""
    from plcgen.s7.cpu.sources import Tags, check_program, read_tag_file
    from plcgen.s7.cpu.type_rules import IecCheck
    from plcgen.s7.read.plcs import by_plc
    from plcgen.s7.scl.dialect import BY_NAME

    known: Tags = {}
    for path in tags:
        known |= read_tag_file(path)
    tables = [path for path in tags if path.suffix.lower() == ".xml"]
    check = IecCheck(checks.get("", IecCheck.AS_STATED))
    stated = {block: when == IecCheck.ON for block, when in checks.items() if block and when != IecCheck.AS_STATED}
    by_file: dict[str, list[Diagnostic]] = {str(path): [] for path in sources}
    groups, blocks = by_plc([*sources, *documents], paths), 0
    for folder, inside in groups.items():
        together = {*inside, *groups.get(None, ())}
        own = [path for path in sources if path in together]
        if not own or (folder is None and len(groups) > 1 and not set(inside) & set(sources)):
            continue
        beside = [*(path for path in documents if path in together), *tables]
        result = check_program(
            own, BY_NAME[target], known, iec_check=check, stated=stated, encoding=encoding, documents=beside
        )
        blocks += result.blocks
        for diagnostic in result.diagnostics:
            by_file.setdefault(diagnostic.span.file or str(own[0]), []).append(diagnostic)
    return [(Path(file).as_posix(), list(dict.fromkeys(found))) for file, found in by_file.items()], blocks


def _summary(out: Console, found: Findings, blocks: int | None, *, program: bool) -> None:
    """Say how it went in one line."""
    from plcgen.base.display.excerpts import summary_text

    if found.diagnostics:
        out.say("")
    kind = "specs" if blocks is None else "files"
    where = found.subjects[0][0] if len(found.subjects) == 1 else f"{len(found.subjects)} {kind}"
    read = "" if program else "; types and names not checked: --program"
    inside = "" if blocks is None else f" ({quantity(blocks, 'block')}{read})"
    out.say(summary_text(found.diagnostics, where + inside))
