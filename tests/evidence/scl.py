"""SCL sources of a folder: which are refused, what is said about their types, and which seeded faults are found.

Every subfolder is a repository or project, called ``OWNER+NAME``. Nobody can ask the compilers of STEP 7 here: what is
valid was decided by reading, against the manuals and against what the tools write themselves. Each decision is a row
of ``scl.toml``: a place, a code, a verdict and why, without any text of the source.

The SCL of SimaticML documents is checked as well, with the IEC check as they state it: the TIA Portal exports only
blocks that it has compiled. There a place is the text that a block becomes, and a line of that.
"""

from __future__ import annotations

import re
import tomllib
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from plcgen.base.diagnostics import Diagnostic, Severity
from plcgen.build.convert import convert
from plcgen.s7.cpu.program import Program
from plcgen.s7.cpu.sources import (
    SourceCheck,
    Tags,
    check_program,
    check_source,
    find_documents,
    find_sources,
    read_tag_file,
)
from plcgen.s7.cpu.surroundings import Surroundings
from plcgen.s7.cpu.type_rules import IecCheck
from plcgen.s7.read.files import SYMBOL_SUFFIXES
from plcgen.s7.read.plcs import by_plc
from plcgen.s7.read.text import load_text
from plcgen.s7.scl.dialect import BY_NAME, Dialect
from plcgen.s7.scl.parser import ParseResult, parse
from tests.evidence.faults import TOKEN, TYPE, faults
from tests.evidence.faults import found as is_found

KEPT = Path(__file__).with_name("scl.toml")
NAMES = frozenset({"PG806", "PG820", "PG825"})
"""Something has a name that no file of the folder declares."""
TYPES = frozenset({"PG821", "PG822", "PG823", "PG824"})
"""Something has a type, a value or a place that does not go where it stands."""
OPEN = "not judged"
_TIA = re.compile(r"S7_Optimized_Access|(?m:^\s*REGION\b)|(?m:^[^/'(]*#[A-Za-z_\"])")
"""What STEP 7 V5 does not have, outside of comments and texts."""
_CODE = re.compile(r"(?mi:^\s*(?:FUNCTION_BLOCK|FUNCTION|ORGANIZATION_BLOCK)\b)")
_FAULTS = 2
_LARGEST = 120_000


@dataclass(slots=True)
class Judged:
    """What was decided by reading, by repository."""

    repositories: dict[str, dict[str, Any]] = field(default_factory=dict)
    refused: dict[tuple[str, str], str] = field(default_factory=dict)
    verdicts: dict[tuple[str, str, int, str], tuple[str, str]] = field(default_factory=dict)

    @classmethod
    def read(cls, path: Path = KEPT) -> Judged:
        """Rows of ``scl.toml``; nothing if there is no such file."""
        if not path.is_file():
            return cls()
        data = tomllib.loads(path.read_text(encoding="utf-8"))
        return cls(
            {row["name"]: row for row in data.get("repository", ())},
            {(row["repository"], row["path"]): row["why"] for row in data.get("refused", ())},
            {
                (row["repository"], row["path"], line, row["code"]): (row["verdict"], row["why"])
                for row in data.get("judged", ())
                for line in row["lines"]
            },
        )


@dataclass(slots=True)
class Figures:
    """What is counted over all repositories."""

    files: Counter[str] = field(default_factory=Counter)
    fresh: Counter[str] = field(default_factory=Counter)
    refused: list[tuple[str, str, str]] = field(default_factory=list)
    names: Counter[str] = field(default_factory=Counter)
    types: Counter[str] = field(default_factory=Counter)
    strict: Counter[str] = field(default_factory=Counter)
    """What the IEC check of the target adds, by verdict; ``check`` compiles where it is off."""
    compiled: Counter[str] = field(default_factory=Counter)
    unjudged: list[tuple[str, str, Diagnostic]] = field(default_factory=list)
    ended: dict[tuple[str, str], str] = field(default_factory=dict)
    """Files that plcgen could not check, because of a mistake of its own, and what that was."""
    seeded: Counter[str] = field(default_factory=Counter)
    missed: list[tuple[str, str, str]] = field(default_factory=list)
    documents: Counter[str] = field(default_factory=Counter)
    """Blocks in SCL of documents by repository."""
    in_documents: Counter[str] = field(default_factory=Counter)
    """What is said about their types, by verdict, and about names."""


def report(folder: Path, *, save: bool = False) -> Iterator[str]:
    """Print the figures; ``save`` means nothing here: what is kept was decided by people."""
    del save
    judged, figures = Judged.read(), Figures()
    for place in sorted(path for path in folder.iterdir() if path.is_dir()):
        if any(path.suffix.lower() == ".scl" for path in find_sources(place)):
            measure(place, judged, figures)
        measure_documents(place, judged, figures)
    yield from _lines(figures)


def measure(place: Path, judged: Judged, figures: Figures) -> None:
    """Count one repository."""
    name = place.name.replace("+", "/")
    known = judged.repositories.get(name, {})
    paths = find_sources(place)
    own = [path for path in paths if path.suffix.lower() == ".scl"]
    figures.files[name] += len(own)
    seen = known.get("seen", 0)
    fresh = 0 if seen is True else len(own) - seen
    if fresh:
        figures.fresh[name] += fresh
    refused = {path for path in own if _is_refused(check_source(path))}
    for path in sorted(refused):
        short = path.relative_to(place).as_posix()
        figures.refused.append((name, short, judged.refused.get((name, short), OPEN)))
    invalid = {path for path in refused if (name, path.relative_to(place).as_posix()) in judged.refused}
    targets = _targets(paths, place, known)
    for target in set(targets.values()):
        chosen = [path for path in paths if targets[path] is target and path not in invalid]
        _programs(place, chosen, target, judged, figures)
    for path in own:
        if path not in refused:
            try:
                _seed(path, targets[path], place, figures)
            except Exception as problem:  # noqa: BLE001 - see _problems
                _told(place, path.relative_to(place).as_posix(), problem, figures)


def measure_documents(place: Path, judged: Judged, figures: Figures) -> None:
    """Check the code in SCL of the documents of one repository, each PLC by itself."""
    name, groups = place.name.replace("+", "/"), by_plc(find_documents(place))
    for folder, own in groups.items():
        paths = own if folder is None else [*own, *groups.get(None, ())]
        if not any(b"StructuredText" in path.read_bytes() for path in paths):
            continue
        made = [file for file in convert(paths, "scl", keep_going=True).files if file.path.endswith(".scl")]
        texts = [(file.path, file.data.decode("utf-8-sig")) for file in made]
        beside = Surroundings.read(paths, Dialect.TIA_1200_1500)
        try:
            program = Program.load(texts, Dialect.TIA_1200_1500, beside=beside)
        except Exception as problem:  # noqa: BLE001 - see _problems
            _told(place, f"documents in {folder or '.'}", problem, figures)
            continue
        figures.documents[name] += len(texts)
        for problem in _chosen(program.diagnostics):
            verdict = judged.verdicts.get((name, problem.span.file, problem.span.line, problem.code), ("", ""))[0]
            figures.in_documents["names" if problem.code in NAMES else verdict or OPEN] += 1
            if problem.code in TYPES and not verdict:
                figures.unjudged.append((name, problem.span.file, problem))


def _is_refused(check: SourceCheck) -> bool:
    """Whether a file is no source, rather than one with start values that do not fit."""
    return any(d.severity is Severity.ERROR and d.code not in TYPES for d in check.diagnostics)


def _targets(paths: list[Path], place: Path, known: dict[str, Any]) -> dict[Path, Dialect]:
    """Target of every file: what was decided, or what its code looks like; types and data are for that of most code."""
    found: dict[Path, Dialect] = {}
    plain: list[Path] = []
    for path in paths:
        short = path.relative_to(place).as_posix()
        decided = [target for prefix, target in known.get("targets", {}).items() if short.startswith(prefix)]
        text = _text(path)
        if decided:
            found[path] = BY_NAME[decided[0]]
        elif _TIA.search(text):
            found[path] = Dialect.TIA_1200_1500
        elif _CODE.search(text):
            found[path] = Dialect.STEP7_V5
        else:
            plain.append(path)
    most = Counter(found.values()).most_common(1)
    return found | dict.fromkeys(plain, most[0][0] if most else Dialect.TIA_1200_1500)


def _text(path: Path) -> str:
    loaded = load_text(path)
    return "" if isinstance(loaded, Diagnostic) else loaded[0]


def _programs(place: Path, paths: list[Path], target: Dialect, judged: Judged, figures: Figures) -> None:
    """Check the files of one target; a block that is there twice makes another program of the files that repeat it."""
    name = place.name.replace("+", "/")
    known = judged.repositories.get(name, {})
    documents = find_documents(place)
    tags: Tags = {}
    for table in sorted(path for path in place.rglob("*") if path.suffix.lower() in SYMBOL_SUFFIXES):
        tags |= read_tag_file(table)
    checked = partial(check_program, target=target, tags=tags, documents=documents)
    documented = Surroundings.read(documents, target).stated
    check_of_target = IecCheck.OFF if target.classic else IecCheck.ON
    rest = paths
    while rest:
        program, rest = _without_twins(rest)
        strict, free = (
            _problems(place, program, figures, partial(checked, iec_check=check, stated=stated))
            for check, stated in ((check_of_target, documented), (IecCheck.OFF, None))
        )
        said = {(d.span, d.code, d.message) for d in free}
        for problem in strict:
            if problem.code in TYPES and (problem.span, problem.code, problem.message) not in said:
                short = Path(problem.span.file).relative_to(place).as_posix()
                verdict = judged.verdicts.get((name, short, problem.span.line, problem.code), ("", ""))[0]
                figures.strict[verdict or OPEN] += 1
        for problem in free:
            short = Path(problem.span.file).relative_to(place).as_posix()
            verdict = judged.verdicts.get((name, short, problem.span.line, problem.code), ("", ""))[0]
            if problem.code in NAMES:
                figures.names[verdict or "missing"] += 1
                continue
            figures.types[verdict or OPEN] += 1
            if known.get("compiled", False):
                figures.compiled[verdict or OPEN] += 1
            if not verdict:
                figures.unjudged.append((name, short, problem))


def _without_twins(paths: list[Path]) -> tuple[list[Path], list[Path]]:
    """The files that go together, and those that declare a block of them again."""
    seen: set[tuple[str, str]] = set()
    together: list[Path] = []
    again: list[Path] = []
    for path in paths:
        blocks = {(kind, block.upper()) for kind, block, _ in check_source(path).declared}
        (again if blocks & seen else together).append(path)
        if not blocks & seen:
            seen |= blocks
    return together, again


def _problems(
    place: Path, paths: list[Path], figures: Figures, check: Callable[[list[Path]], SourceCheck]
) -> list[Diagnostic]:
    """What is said about files that belong together; those that end the check are left out and told."""
    try:
        return _chosen(check(paths).diagnostics)
    except Exception as problem:  # noqa: BLE001 - a mistake of plcgen in one file must not end the measurement
        ending = [path for path in paths if _ends(path, check)] or paths
        for path in ending:
            _told(place, path.relative_to(place).as_posix(), problem, figures)
        rest = [path for path in paths if path not in ending]
        return _problems(place, rest, figures, check) if rest else []


def _ends(path: Path, check: Callable[[list[Path]], SourceCheck]) -> bool:
    """Whether a file alone ends a check."""
    try:
        check([path])
    except Exception:  # noqa: BLE001 - see above
        return True
    return False


def _told(place: Path, what: str, problem: Exception, figures: Figures) -> None:
    figures.ended[place.name.replace("+", "/"), what] = f"{type(problem).__name__}: {problem}"


def _chosen(found: Iterable[Diagnostic]) -> list[Diagnostic]:
    return [d for d in found if d.severity is Severity.ERROR and d.code in NAMES | TYPES]


def _seed(path: Path, target: Dialect, place: Path, figures: Figures) -> None:
    """Put faults into a file, one at a time, and see which are found."""
    text = _text(path).replace("\r\n", "\n").replace("\r", "\n")
    if len(text) > _LARGEST:
        return
    result: ParseResult = parse(text, path.name, target)

    def check(source: str) -> frozenset[tuple[str, str]]:
        program = Program.load([(path.name, source)], target, iec_check=IecCheck.OFF)
        return frozenset((d.code, d.message) for d in program.diagnostics if d.code != "PG827")

    short = path.relative_to(place).as_posix()
    chosen = faults(result, _FAULTS, short)
    before = check(text) if chosen else frozenset()
    for fault in chosen:
        hit = is_found(text, fault, before, check)
        figures.seeded[f"{fault.kind} {'found' if hit else 'missed'}"] += 1
        if not hit:
            figures.missed.append((place.name, f"{short}:{text.count(chr(10), 0, fault.start) + 1}", fault.name))


def _lines(figures: Figures) -> Iterator[str]:
    files, fresh = sum(figures.files.values()), sum(figures.fresh.values())
    yield f"SCL sources: {files} files of {len(figures.files)} repositories"
    yield f"  never looked at before: {fresh} files of {len(figures.fresh)} repositories"
    reasons = Counter(why for _, _, why in figures.refused)
    yield f"  refused: {len(figures.refused)}, {reasons[OPEN]} of them valid as far as anybody knows"
    for repository, path, why in figures.refused:
        yield f"    {repository} {path}: {why}"
    if figures.ended:
        yield f"  not checked, a mistake of plcgen: {len(figures.ended)}"
    for (repository, path), why in figures.ended.items():
        yield f"    {repository} {path}: {why}"
    yield f"  names that no file declares: {sum(figures.names.values())}"
    for verdict, count in figures.names.most_common():
        yield f"    {verdict}: {count}"
    types = sum(figures.types.values())
    more = sum(figures.strict.values())
    yield f"  types: {types} without IEC check, {more} more with the IEC check of the target"
    for verdict, count in figures.strict.most_common():
        yield f"    more, {verdict}: {count}"
    for verdict, count in figures.types.most_common():
        yield f"    {verdict}: {count}"
    yield f"  of these in sources that are known to compile: {sum(figures.compiled.values())}"
    for verdict, count in figures.compiled.most_common():
        yield f"    {verdict}: {count}"
    blocks, types = sum(figures.documents.values()), sum(figures.in_documents.values()) - figures.in_documents["names"]
    yield f"  documents of compiled blocks: {blocks} blocks in SCL of {len(+figures.documents)} repositories"
    yield f"    types: {types}, names: {figures.in_documents['names']}"
    for verdict, count in figures.in_documents.most_common():
        if verdict != "names":
            yield f"    {verdict}: {count}"
    for repository, path, problem in figures.unjudged:
        yield f"    {OPEN}: {repository} {path}:{problem.span.line} {problem.code}"
    for kind in (TOKEN, TYPE):
        hit, miss = figures.seeded[f"{kind} found"], figures.seeded[f"{kind} missed"]
        if hit + miss:
            yield f"  seeded {kind} faults: {hit} of {hit + miss} found, {100 * hit / (hit + miss):.1f} %"
    for repository, where, what in figures.missed:
        yield f"    missed: {repository} {where} {what}"
