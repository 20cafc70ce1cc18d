"""Sources as a compiler sees them: one file for its syntax and target, a whole program folder, a generated folder."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import islice
from pathlib import Path

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Note, Severity, Span, has_errors
from plcgen.base.diagnostics.counting import quantity
from plcgen.base.files.files import read_bounded, walk
from plcgen.s7.cpu.program import Program, Source, unfit_start_values
from plcgen.s7.cpu.sharing import sharing
from plcgen.s7.cpu.surroundings import Surroundings
from plcgen.s7.cpu.type_rules import IecCheck
from plcgen.s7.read.files import MAX_BYTES, MAX_FILES, MAX_SEEN, SYMBOL_SUFFIXES, TEXT_SUFFIXES, read_rows
from plcgen.s7.read.generated import foreign_files, generated_documents, generated_sources
from plcgen.s7.read.text import decode_source, has_bodies, is_binary_file, load_text, parse_source, read_source
from plcgen.s7.read.texts import read_texts
from plcgen.s7.scl.dialect import Dialect
from plcgen.s7.scl.grammar.documents import is_document
from plcgen.s7.scl.parser import ParseResult
from plcgen.s7.types.blocks import Block, BlockKind
from plcgen.s7.xml.reading.documents import read_simaticml, read_tag_table

Tags = dict[str, str | tuple[str, str]]
_COLUMNS = ("name", "data type", "logical address")
_HEAD = 1000
_LARGE = 1024 * 1024
"""Characters of sources beyond which their trees are not kept: they take more than ten times as much memory."""
_CODE, _DATA = re.compile(rb"<SW\.Blocks\.(FB|FC|OB) "), re.compile(rb"<SW\.(Tags|Blocks\.(GlobalDB|InstanceDB))")

_NUMBERED = re.compile(r"^\| (\S{1,125}) \| DB(\d{1,5}) \|$", re.MULTILINE)
"""A row of IMPORT.md that gives a data block its number."""


@dataclass(frozen=True, slots=True)
class FolderParts:
    """What a program is made of, read once: sources (file name and text), tags, numbers of data blocks, constants.

    A file that cannot be read stands there as its path.
    """

    sources: tuple[Source, ...]
    tags: Tags
    numbers: dict[str, int]
    constants: dict[str, int]

    @property
    def large(self) -> bool:
        """Whether memory counts for more than the time to parse every block twice."""
        return sum(len(source[1]) for source in self.sources if isinstance(source, tuple)) > _LARGE

    def load(
        self,
        dialect: Dialect,
        *,
        coverage: bool = False,
        litter: bool = False,
        iec_check: IecCheck = IecCheck.AS_STATED,
        lean: bool = False,
    ) -> Program:
        """Compile them."""
        return Program.load(
            self.sources,
            dialect,
            tags=self.tags,
            numbers=self.numbers,
            constants=self.constants,
            coverage=coverage,
            litter=litter,
            iec_check=iec_check,
            lean=lean,
        )


def load_folder(
    folder: Path | str,
    dialect: Dialect,
    *,
    coverage: bool = False,
    iec_check: IecCheck = IecCheck.AS_STATED,
    constants: Mapping[str, int] | None = None,
    symbols: Mapping[str, tuple[str, str]] | None = None,
    more: Iterable[Source] = (),
) -> Program:
    """Load the generated sources of a folder; symbols come from ``*.sdf``, tags and numbers from ``xml/*.xml``,
    without documents the numbers from IMPORT.md.

    ``constants`` are system constants by their names; ``symbols`` (address and type by name) and ``more`` are tags and
    sources that do not lie in the folder.
    """
    parts = read_parts(Path(folder), dialect, constants=constants, symbols=symbols, more=more)
    return parts.load(dialect, coverage=coverage, iec_check=iec_check)


def read_parts(
    folder: Path,
    dialect: Dialect,
    *,
    constants: Mapping[str, int] | None = None,
    symbols: Mapping[str, tuple[str, str]] | None = None,
    more: Iterable[Source] = (),
) -> FolderParts:
    """What :func:`load_folder` compiles."""
    tags: Tags = dict(symbols or {})
    numbers: dict[str, int] = {}
    for table in sorted(folder.glob("*.sdf")):
        tags |= read_tag_file(table)
    if (folder / "tags.csv").is_file():
        tags |= read_tags(folder / "tags.csv")
    for document in generated_documents(folder):
        # whether a document has nothing but a code block, by its head: those of callers are large
        with document.open("rb") as file:
            head = file.read(_HEAD)
        if not (_CODE.search(head) is not None and _DATA.search(head) is None):
            found, _ = read_tag_table(document)
            for tag_table in found:
                tags |= {tag.name: (tag.address, tag.type) for tag in tag_table.tags}
            for block in () if found else read_simaticml(document, classic=dialect.classic)[0]:
                if block.kind is BlockKind.DB and block.number is not None:
                    numbers[block.name] = block.number
    guide = folder / "IMPORT.md"
    if not numbers and guide.is_file():  # without documents, whoever imports gives the numbers that matter by hand
        rows = _NUMBERED.findall(read_bounded(guide, MAX_BYTES).decode("utf-8", "replace"))
        numbers = {name: int(number) for name, number in rows}
    return FolderParts((*map(_text, generated_sources(folder)), *more), tags, numbers, dict(constants or {}))


def _text(path: Path) -> Source:
    loaded = load_text(path)
    return path if isinstance(loaded, Diagnostic) else (str(path), loaded[0])


def read_tag_file(path: Path | str) -> Tags:
    """Symbols of any file that holds some: a table of STEP 7 V5, CSV, or an exported tag table (``.xml``)."""
    path = Path(path)
    if path.suffix.lower() in SYMBOL_SUFFIXES:
        rows, found = read_rows(path)
        if found:
            raise DiagnosticError(found)
        return {symbol: (address, type_) for symbol, address, type_ in rows if type_}
    if path.suffix.lower() != ".xml":
        tags = read_tags(path)
        if not tags:
            message = "there is no tag in this file: expected name, data type, logical address"
            raise DiagnosticError([Diagnostic("PG804", message, Span(str(path)))])
        return tags
    tables, problems = read_tag_table(path)
    if has_errors(problems):
        raise DiagnosticError(problems)
    return {tag.name: (tag.address, tag.type) for table in tables for tag in table.tags}


def read_tags(path: Path | str) -> Tags:
    """Tag table as CSV: name, data type, logical address, in this order or as the titles of the first line say.

    What separates the columns is told by the first line. Raises DiagnosticError (PG802, PG804) for what is no text.
    """
    path = Path(path)
    data = read_bounded(path, MAX_BYTES)
    if data.startswith(b"PK\x03\x04"):
        text: str | Diagnostic = Diagnostic("PG804", "a workbook, not text", Span(str(path)), help="save it as CSV")
    elif len(data) > MAX_BYTES:
        text = Diagnostic("PG802", f"the tag table has more than {MAX_BYTES} bytes", Span(str(path)))
    else:
        text = decode_source(data, str(path))
    if isinstance(text, Diagnostic):
        raise DiagnosticError([text])
    header = text.partition("\n")[0]
    separator = ";" if header.count(";") > header.count(",") else ","
    rows = [row for row in csv.reader(io.StringIO(text, newline=""), delimiter=separator) if len(row) >= len(_COLUMNS)]
    titles = [cell.strip().lower() for cell in rows[0]] if rows else []
    name, type_, address = (titles.index(title) if title in titles else n for n, title in enumerate(_COLUMNS))
    titled = bool(rows) and not any(map(str.isdigit, rows[0][address]))
    return {
        row[name].strip(): (row[address].strip().removeprefix("%"), row[type_].strip())
        for row in rows[titled:]
        if len(row) > max(name, type_, address)
    }


SUFFIXES = TEXT_SUFFIXES | {".st"}
"""What counts as a PLC source when a folder is searched."""

_TYPED = frozenset({"PG821", "PG824"})
"""What depends on the IEC check."""
MAX_DIGITS = 10
"""Digits of the largest constant, an UDINT."""


@dataclass(frozen=True, slots=True)
class SourceCheck:
    """What was read (a file, or the files of a program), how many blocks are in it, and everything found."""

    paths: tuple[Path, ...]
    blocks: int
    diagnostics: tuple[Diagnostic, ...]
    declared: tuple[tuple[str, str, Span], ...] = ()
    """Kind, name and place of every block of a file."""

    @property
    def ok(self) -> bool:
        """Whether no diagnostic is an error."""
        return not has_errors(self.diagnostics)


def check_source(path: Path | str, target: Dialect | None = None, *, encoding: str | None = None) -> SourceCheck:
    """Read one file (.scl .udt .db .awl): its syntax, its declarations, and what ``target`` does not compile.

    Start values must fit as well, as far as the file declares their types. Without a target everything is right that
    one of the three compilers accepts.
    """
    kept: list[ParseResult] = []
    found, problems = read_source(path, target, encoding=encoding, keep=kept.append)
    problems = with_start_values(kept, problems, target)
    declared = tuple((block.kind.value, block.name, block.span or Span(str(path))) for block in found)
    return SourceCheck((Path(path),), len(found), tuple(problems), declared)


def read_shown(
    text: str, path: Path, file: str, *, keep: Callable[[ParseResult], object]
) -> tuple[list[Block], list[Diagnostic]]:
    """The blocks of a text that an editor shows, and what is wrong with it apart from start values.

    ``path`` says how it is read, ``file`` what spans call it.
    """
    texts = read_texts(path)[0] if is_document(path.name) else {}
    return parse_source(text, file, bodies=has_bodies(path), keep=keep, texts=texts)


def with_start_values(
    kept: Sequence[ParseResult], problems: list[Diagnostic], target: Dialect | None = None
) -> list[Diagnostic]:
    """The problems of a file, with those of its start values if it can be read."""
    if has_errors(problems):
        return problems
    return sorted([*problems, *unfit_start_values(kept, target or Dialect.TIA_1200_1500)], key=lambda d: d.sort_key)


def repeated_blocks(checks: Iterable[SourceCheck]) -> Iterator[tuple[Path, Diagnostic]]:
    """PG805, a warning, forevery block that one of the files declares again, with the file it stands in."""
    first: dict[tuple[str, str], Span] = {}
    for check in checks:
        for kind, name, place in check.declared:
            known = first.setdefault((kind, name.upper()), place)
            if known is not place:
                message = f'{kind} "{name}" is declared a second time'
                notes = (Note("first declared here", known),)
                help_ = "name the files of one version only"
                yield check.paths[0], Diagnostic("PG805", message, place, Severity.WARNING, help=help_, notes=notes)


def check_program(
    paths: Sequence[Path | str],
    target: Dialect,
    tags: Mapping[str, str | tuple[str, str]] | None = None,
    *,
    iec_check: IecCheck = IecCheck.AS_STATED,
    stated: Mapping[str, bool] | None = None,
    encoding: str | None = None,
    documents: Iterable[Path] = (),
) -> SourceCheck:
    """Compile files that together are a program: names, types, calls, assignments and start values as well.

    Then look for what two of its parts share and must not (``plcgen.s7.cpu.sharing``).

    ``tags`` maps names to address and type, see ``Program.load``; a number instead of an address is the value of a
    system constant. What the soft CPU cannot execute (PG827) is no mistake here: nothing is run. ``documents`` are
    SimaticML exports beside them: what they declare is known, and what they state of the IEC check of a block counts
    unless ``stated`` or ``iec_check`` says otherwise. Where nothing does, it is on in files that plcgen generated and
    off in all others.
    """
    files = [Path(path) for path in paths]
    beside = Surroundings.read(documents, target)
    if iec_check is not IecCheck.AS_STATED:
        beside.stated.clear()
    constants, places = _apart(tags or {})
    load = partial(
        Program.load, files, target, tags=places, constants=constants, stated=stated, encoding=encoding, beside=beside
    )
    program = load(iec_check=iec_check, foreign=foreign_files(files))
    found = [problem for problem in program.diagnostics if problem.code != "PG827"]
    loaded = [load_text(path, target, encoding=encoding) for path in paths]
    refused = [problem for text in loaded if not isinstance(text, Diagnostic) for problem in text[1]]
    found = sorted(
        [*found, *_unchecked(program, partial(load, iec_check=IecCheck.ON)), *sharing(program.link, beside.obs)],
        key=lambda d: d.sort_key,
    )
    return SourceCheck(tuple(map(Path, paths)), len(program.link.blocks), (*refused, *found))


def _unchecked(program: Program, with_check: Callable[[], Program]) -> Iterator[Diagnostic]:
    """Say once what compiles only without the IEC check, if nothing states of its blocks whether they have it."""
    if not program.link.unstated():
        return
    known = {(d.code, d.span) for d in program.diagnostics}
    more = [d for d in with_check().diagnostics if d.code in _TYPED and (d.code, d.span) not in known]
    if more:
        message = f"{quantity(len(more), 'place')} would not compile with IEC check, and nothing states that it is on"
        help_ = "--iec-check on shows them; --iec-check off is silent"
        yield Diagnostic("PG828", f"{message}: this is the first", more[0].span, Severity.NOTE, help=help_)


def _apart(
    tags: Mapping[str, str | tuple[str, str]],
) -> tuple[dict[str, int], dict[str, str | tuple[str, str]]]:
    """System constants with their values, and all other tags."""
    places: dict[str, str | tuple[str, str]] = {}
    constants: dict[str, int] = {}
    for name, target in tags.items():
        text = (target if isinstance(target, str) else target[0]).strip()
        if text.isascii() and text.isdecimal() and len(text) <= MAX_DIGITS:
            constants[name] = int(text)
        else:
            places[name] = target
    return constants, places


def find_sources(path: Path | str) -> list[Path]:
    """Return the sources below a folder, sorted, without binary files of such names; a file is returned as it is.

    Hidden ones and links to folders are left out.

    Raises DiagnosticError (PG802) for a folder with more than ``MAX_FILES`` of them, OSError for one that cannot be
    read.
    """
    path = Path(path)
    if not path.is_dir():
        return [path]
    seen = list(islice(_below(path), MAX_SEEN + 1))
    found = [entry for entry in seen if entry.suffix.lower() in SUFFIXES and entry.is_file()]
    if len(seen) > MAX_SEEN or len(found) > MAX_FILES:
        message = f"more than {MAX_FILES} sources or {MAX_SEEN} files below this folder"
        raise DiagnosticError([Diagnostic("PG802", message, Span(str(path)), help="name a smaller folder")])
    return [entry for entry in sorted(found) if not is_binary_file(entry)]


def _below(folder: Path) -> Iterator[Path]:
    """The files below a folder, as ``walk`` finds them."""
    for where, _, names in walk(folder):
        yield from (where / name for name in names)


def find_documents(path: Path) -> list[Path]:
    """XML files below a folder, sorted; a file is returned as it is. Bounds as for sources."""
    if not path.is_dir():
        return [path]
    seen = islice(_below(path), MAX_SEEN)
    return sorted(islice((entry for entry in seen if entry.suffix.lower() == ".xml" and entry.is_file()), MAX_FILES))
