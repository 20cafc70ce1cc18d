"""Files and folders of PLC sources - text, SimaticML, symbol tables - as blocks and the types they use."""

from __future__ import annotations

import csv
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from plcgen.base.diagnostics import Diagnostic, Note, Severity, Span
from plcgen.base.files.files import read_bounded, walk
from plcgen.s7.layout.shapes import TypeTable
from plcgen.s7.read.plcs import by_plc, plc_names
from plcgen.s7.read.text import decode_source, is_binary_file, no_text, read_source
from plcgen.s7.scl.declarations import recursive_types
from plcgen.s7.scl.grammar import documents
from plcgen.s7.scl.parser import ParseResult
from plcgen.s7.types.blocks import Block, BlockKind
from plcgen.s7.types.data_types import ELEMENTARY, HARDWARE, ArrayType, StructType, innermost, nested
from plcgen.s7.types.system import system_block

if TYPE_CHECKING:
    from lxml.etree import _Element as Element

    from plcgen.s7.xml.reading.documents import TagTable

SYMBOL_SUFFIXES = frozenset({".sdf", ".asc"})
MAX_BYTES = 4 * 1024 * 1024
"""A table of 65,535 symbols has less."""

_ADDRESS = re.compile(r"(DB|FB|FC|OB|SFB|SFC|UDT)\s*([0-9]{1,5})", re.IGNORECASE)
_ROW = re.compile(r"126,(.{24})(.{12})(.{0,10})", re.DOTALL)
"""A row of an .asc table: symbol in 24 columns, address in 12, type in 10, then a comment of 80."""


def read_rows(path: Path) -> tuple[list[tuple[str, str, str]], list[Diagnostic]]:
    """Symbol, address (``I      3.0``, ``DB    54``) and type of every row of one table.

    Diagnostics: PG802 too large, PG804 unreadable or no text.
    """
    file = str(path)
    try:
        data = read_bounded(path, MAX_BYTES)
    except OSError as error:
        reason = error.strerror or type(error).__name__
        return [], [Diagnostic("PG804", f"the file cannot be read: {reason}", Span(file))]
    if len(data) > MAX_BYTES:
        return [], [Diagnostic("PG802", f"the symbol table has more than {MAX_BYTES} bytes", Span(file))]
    text = decode_source(data, file)
    if isinstance(text, Diagnostic):
        return [], [text]
    rows = (
        _sdf(text)
        if path.suffix.lower() == ".sdf"
        else [(match[1], match[2], match[3]) for match in map(_ROW.match, text.splitlines()) if match]
    )
    if text.strip() and not rows:
        return [], [Diagnostic("PG804", "it has no row of a STEP 7 V5 symbol table", Span(file))]
    return [(symbol.strip(), address.strip(), type_.strip()) for symbol, address, type_ in rows if symbol.strip()], []


def read_symbols(path: Path) -> tuple[dict[str, str], list[Diagnostic]]:
    """Symbol -> block (``UDT5``, ``DB3``) of one table; other addresses are left out."""
    rows, problems = read_rows(path)
    found: dict[str, str] = {}
    for symbol, address, _ in rows:
        match = _ADDRESS.fullmatch(address)
        if match:
            found[symbol] = f"{match[1].upper()}{int(match[2])}"
    return found, problems


def _sdf(text: str) -> list[tuple[str, str, str]]:
    lines = (line for line in text.splitlines() if len(line) < 1000)
    rows = (row for row in csv.reader(lines, strict=False) if len(row) >= 2)
    return [(row[0], row[1], row[2] if len(row) > 2 else "") for row in rows]


Seen: TypeAlias = "Callable[[str, Element], None]"
"""Gets the file and the root of a document."""
TEXT_SUFFIXES = frozenset({".scl", ".udt", ".db", ".awl", ".stl", documents.SUFFIX})
XML_SUFFIXES = frozenset({".xml"})
MAX_FILES = 20_000
"""More files below one folder are refused with PG802."""

_MODERN = HARDWARE | {
    "LREAL", "LINT", "ULINT", "USINT", "UINT", "UDINT", "SINT", "LWORD", "LTIME", "LDT", "LTIME_OF_DAY", "DTL",
    "WSTRING", "WCHAR", "VARIANT", "IEC_TIMER", "TON_TIME", "TOF_TIME", "TP_TIME", "TONR_TIME",
}  # fmt: skip
_GRAPHICAL = re.compile(r"network in (.+?) is not read")
_TYPES = frozenset({BlockKind.UDT, BlockKind.FB})
MAX_SEEN = 200_000
"""So many entries of a folder tree are looked at."""


@dataclass(frozen=True, slots=True)
class SourceFile:
    """One file to read; ``listed`` files come from the folder ``root``, where strangers are no mistake."""

    path: Path
    root: Path | None = None

    @property
    def listed(self) -> bool:
        """Whether the file was found, not named."""
        return self.root is not None

    @property
    def is_xml(self) -> bool:
        """Whether it is SimaticML rather than text."""
        return self.path.suffix.lower() in XML_SUFFIXES

    @property
    def form(self) -> int:
        """What its blocks are written in: 0 for sources, 1 for SIMATIC SD, 2 for SimaticML; the lowest counts."""
        return 2 if self.is_xml else int(documents.is_document(self.path.name))


@dataclass(slots=True)
class Files:
    """Blocks in the order of the files, every type known to them, and everything that could not be read.

    ``types`` also has the blocks of files that stand beside the named ones; ``modern`` says that a type is used
    which only the S7-1200/1500 have. Of a folder with several PLCs ``parts`` has each of them by its name, with
    types of its own.
    """

    blocks: list[Block] = field(default_factory=list)
    types: TypeTable = field(default_factory=TypeTable)
    diagnostics: list[Diagnostic] = field(default_factory=list)
    modern: bool = False
    parts: dict[str, Files] = field(default_factory=dict)
    tables: list[TagTable] = field(default_factory=list)


def read_files(
    paths: Iterable[Path],
    *,
    classic: bool = False,
    keep: Callable[[ParseResult], object] | None = None,
    seen: Seen | None = None,
) -> Files:
    """Read files and folders; a folder means every source below it, hidden ones left out.

    Of a block that is there as source and as document the source counts, and SIMATIC SD before SimaticML. Types that
    are missing are looked for in UDT and SCL files beside the named files, or in ``../udt`` and ``../scl``. Symbol
    tables of STEP 7 V5 (``.sdf``, ``.asc``) give blocks their numbers. ``classic``: the documents are for S7-300/400.
    ``keep`` gets the syntax tree of every text, ``seen`` the root of every document of SimaticML. Where a folder has
    the exports of several PLCs, names mean something else in each of them; files that belong to none are there for all.
    """
    problems: list[Diagnostic] = []
    named = list(paths)
    files = list(source_files(named, problems))
    groups = by_plc((file.path for file in files), named)
    if len(groups) == 1:
        found = _read_group(files, classic=classic, keep=keep, seen=seen)
        found.diagnostics = _graphical_once(dict.fromkeys([*problems, *found.diagnostics]))
        return found
    called, whole = plc_names(groups, named), Files(diagnostics=problems)
    for folder in sorted(groups, key=lambda folder: called[folder]):
        own = set(groups[folder])
        part = _read_group([file for file in files if file.path in own], classic=classic, keep=keep, seen=seen)
        for name, block in whole.parts[""].types.items() if None in groups and folder is not None else ():
            part.types.setdefault(name, block)
        whole.parts[called[folder]] = part
        whole.tables += part.tables
        whole.blocks += part.blocks
        whole.diagnostics += part.diagnostics
        whole.modern = whole.modern or part.modern
        for name, block in part.types.items():
            whole.types.setdefault(name, block)
    whole.diagnostics = _graphical_once(whole.diagnostics)
    return whole


def _graphical_once(diagnostics: Iterable[Diagnostic]) -> list[Diagnostic]:
    """The notes about blocks with graphical networks as one, at the first of them: a project has hundreds."""
    given = list(diagnostics)
    graphical = [diagnostic for diagnostic in given if diagnostic.code == "PG814"]
    if len(graphical) < 2:
        return given
    languages = sorted({match[1] for d in graphical if (match := _GRAPHICAL.search(d.message)) is not None})
    what = f"networks of {len(graphical)} blocks, in {', '.join(languages)}, are not read"
    once = replace(graphical[0], message=f"{what}: only their interfaces are used; this is the first")
    return [once if d is graphical[0] else d for d in given if d is graphical[0] or d.code != "PG814"]


def _read_group(
    files: Sequence[SourceFile], *, classic: bool, keep: Callable[[ParseResult], object] | None, seen: Seen | None
) -> Files:
    """Read the files of one PLC."""
    found = Files()
    symbols: dict[str, str] = {}
    read: list[tuple[Block, SourceFile]] = []
    for file in files:
        if file.path.suffix.lower() in SYMBOL_SUFFIXES:
            table, problems = read_symbols(file.path)
            symbols |= table
        else:
            blocks, problems = _read(file, {}, classic=classic, keep=keep, seen=seen)
            read += [(block, file) for block in blocks]
            if file.is_xml and not blocks:
                tables = _tables(file.path)
                problems = [] if tables else problems
                found.tables += _new_tables(tables, found.tables, file.path, problems)
        found.diagnostics += problems
    _resolve(read, files, found.diagnostics, classic=classic, keep=keep, seen=seen)
    read = _without_unknown_bounds(read, found.diagnostics)
    found.blocks = [_numbered(block, symbols) for block in _unique(read, found.diagnostics)]
    _add_types(found.blocks, found.types)
    _add_aliases(symbols, found.types)
    used = _used(found.blocks)
    found.modern = not used.isdisjoint(_MODERN)
    if any(name not in found.types and name not in ELEMENTARY for name in used):
        _add_neighbours(files, found.types)
        _add_documents(files, used, found.types, classic=classic)
    _add_written_out(found.blocks, found.types)
    found.diagnostics = list(dict.fromkeys([*found.diagnostics, *recursive_types(found.types.values())]))
    return found


def _tables(path: Path) -> list[TagTable]:
    """The tag tables of a document that has no blocks; a table that is damaged is none."""
    from plcgen.s7.xml.reading.documents import read_tag_table

    tables, problems = read_tag_table(path)
    return [] if problems else tables


def source_files(paths: Iterable[Path], diagnostics: list[Diagnostic]) -> Iterator[SourceFile]:
    """The files that ``paths`` mean, each once; folders sorted, links to folders not followed."""
    seen: set[Path] = set()
    for path in paths:
        try:
            inside = _walk(path, diagnostics) if path.is_dir() else [SourceFile(path)]
        except OSError as problem:
            message = f"the folder cannot be read: {problem.strerror or problem}"
            diagnostics.append(Diagnostic("PG804", message, Span(str(problem.filename or path))))
            continue
        for file in inside:
            if file.path not in seen:
                seen.add(file.path)
                yield file


def _walk(folder: Path, diagnostics: list[Diagnostic]) -> list[SourceFile]:
    wanted = TEXT_SUFFIXES | XML_SUFFIXES | SYMBOL_SUFFIXES
    found: list[SourceFile] = []
    looked_at = 0
    for where, folders, names in walk(folder):
        found += [SourceFile(where / name, folder) for name in names if Path(name).suffix.lower() in wanted]
        looked_at += len(names) + len(folders)
        if len(found) > MAX_FILES or looked_at > MAX_SEEN:
            message = f"more than {MAX_FILES} sources or {MAX_SEEN} files below this folder"
            diagnostics.append(Diagnostic("PG802", message, Span(str(folder)), help="name a smaller folder"))
            return []
    binary = {file for file in found if file.path.suffix.lower() in TEXT_SUFFIXES and is_binary_file(file.path)}
    if binary:
        found = [file for file in found if file not in binary]
        diagnostics += no_text(folder, (file.path for file in binary))
    if not found:
        message = "no PLC source in this folder"
        text = f"sources end in {', '.join(sorted(TEXT_SUFFIXES | XML_SUFFIXES))}"
        diagnostics.append(Diagnostic("PG804", message, Span(str(folder)), help=text))
    return found


def _read(
    file: SourceFile,
    constants: Mapping[str, int | None],
    *,
    classic: bool,
    keep: Callable[[ParseResult], object] | None,
    seen: Seen | None,
) -> tuple[list[Block], list[Diagnostic]]:
    if not file.is_xml:
        whole = {name: value for name, value in constants.items() if value is not None}
        return read_source(file.path, constants=whole, keep=keep)
    from plcgen.s7.xml.reading.documents import read_simaticml

    told = None if seen is None else partial(seen, str(file.path))
    blocks, problems = read_simaticml(file.path, classic=classic, constants=constants, seen=told)
    if file.listed and not blocks and all(problem.code == "PG812" for problem in problems):
        return [], []  # another kind of document that lies in the folder
    return blocks, problems


def _resolve(
    read: list[tuple[Block, SourceFile]],
    files: Sequence[SourceFile],
    diagnostics: list[Diagnostic],
    *,
    classic: bool,
    keep: Callable[[ParseResult], object] | None,
    seen: Seen | None,
) -> None:
    """Read files with unknown bounds again, with the constants of the tag tables among the files or beside them."""
    unknown = {d.span.file for d in diagnostics if d.code == "PG806" and d.severity is Severity.WARNING}
    again = [file for file in files if str(file.path) in unknown]
    constants = project_constants(files) if again else {}
    if not constants:
        return
    for file in again:
        blocks, problems = _read(file, constants, classic=classic, keep=keep, seen=seen)
        own = {id(block): place for place, (block, where) in enumerate(read) if where is file}
        for place, block in zip(own.values(), blocks, strict=True):
            read[place] = (block, file)
        diagnostics[:] = [d for d in diagnostics if d.span.file != str(file.path)] + problems


def project_constants(files: Iterable[SourceFile]) -> dict[str, int | None]:
    """User constants of the tag tables among files or beside them by upper-case name; None if it is no whole number."""
    from plcgen.s7.xml.reading.documents import read_tag_table
    from plcgen.s7.xml.reading.interface import whole_number

    named = [file.path for file in files if file.is_xml]
    beside = {path for file in files if not file.listed for path in file.path.parent.glob("*.xml")}
    found: dict[str, int | None] = {}
    for path in [*named, *sorted(beside - set(named))][:MAX_FILES]:
        for table in read_tag_table(path)[0]:
            for constant in table.constants:
                found.setdefault(constant.name.upper(), whole_number(constant.value))
    return found


def _without_unknown_bounds(
    read: list[tuple[Block, SourceFile]], diagnostics: list[Diagnostic]
) -> list[tuple[Block, SourceFile]]:
    """Leave out blocks with an array bound or length from elsewhere: nobody knows where their members lie."""
    unknown = [n for n, d in enumerate(diagnostics) if d.code == "PG806" and d.severity is Severity.WARNING]
    if not unknown:
        return read
    left_out: set[int] = set()
    for position in unknown:
        place = diagnostics[position].span
        diagnostics[position] = replace(diagnostics[position], severity=Severity.ERROR)
        above = [b for b, _ in read if b.span and b.span.file == place.file and b.span.line <= place.line]
        left_out.update(id(block) for block in above[-1:])
    return [(block, file) for block, file in read if id(block) not in left_out]


def _unique(read: Iterable[tuple[Block, SourceFile]], diagnostics: list[Diagnostic]) -> Iterable[Block]:
    """Leave out documents that repeat a source, but keep their number; say so if one repeats another of its form."""
    kept: dict[tuple[BlockKind, str], tuple[Block, SourceFile]] = {}
    for block, file in read:
        key = (block.kind, block.name.upper())
        first, where = kept.setdefault(key, (block, file))
        if first is block:
            continue
        if where.form != file.form:
            (counts, counting), (other, _) = sorted([(first, where), (block, file)], key=lambda pair: pair[1].form)
            kept[key] = (counts if counts.number is not None else replace(counts, number=other.number), counting)
            continue
        message = f'{block.kind} "{block.name}" is declared a second time; the one in {where.path} counts'
        place = block.span or Span(str(file.path))
        help_text = "name the files of one version only"
        notes = (Note("first declared here", first.span),) if first.span else ()
        diagnostics.append(Diagnostic("PG805", message, place, Severity.WARNING, help=help_text, notes=notes))
    return [block for block, _ in kept.values()]


def _new_tables(
    tables: Iterable[TagTable], known: Iterable[TagTable], path: Path, diagnostics: list[Diagnostic]
) -> list[TagTable]:
    """The tag tables of a file that no file before it has; PG805 about the rest."""
    names = {table.name.upper() for table in known}
    new = []
    for table in tables:
        if table.name.upper() not in names:
            new.append(table)
            continue
        message = f'tag table "{table.name}" is declared a second time; the first one counts'
        places = [row.span for row in table.tags] + [row.span for row in table.constants]
        place = next((span for span in places if span is not None), Span(str(path)))
        help_text = "name the files of one version only"
        diagnostics.append(Diagnostic("PG805", message, place, Severity.WARNING, help=help_text))
    return new


def _numbered(block: Block, symbols: dict[str, str]) -> Block:
    kind = symbols.get(block.name, "")
    if block.number is not None or not kind.startswith(block.kind.value) or not kind[len(block.kind) :].isdigit():
        return block
    return replace(block, number=int(kind[len(block.kind) :]))


def _add_types(blocks: Iterable[Block], types: TypeTable) -> None:
    """Make blocks known by name: types first, the others so that a wrong use of them can be told."""
    for block in sorted(blocks, key=lambda b: b.kind not in _TYPES):
        types.setdefault(block.name.upper(), block)


def _add_written_out(blocks: Iterable[Block], types: TypeTable) -> None:
    """Types that documents write out where they use them, for names that nothing else declares."""
    for block in blocks:
        for inline in block.inline:
            if inline.name.upper() not in ELEMENTARY and system_block(inline.name) is None:
                types.setdefault(inline.name.upper(), inline)


def _used(blocks: Iterable[Block]) -> set[str]:
    """Upper-case names of all types that the blocks name, elementary ones too."""
    names = {block.instance_of.upper() for block in blocks if block.instance_of}
    types = (innermost(member.type) for block in blocks for member in nested(block.members))
    return names | {type_.name.upper() for type_ in types if not isinstance(type_, ArrayType | StructType)}


def _add_neighbours(files: Iterable[SourceFile], types: TypeTable) -> None:
    """Types from UDT and SCL files beside the sources, or one folder over, that the sources lack."""
    read = {file.path for file in files}
    near: set[Path] = set()
    for folder in {file.path.parent if file.root is None else file.root for file in files}:
        for suffix in (".udt", ".scl"):
            near.update(folder.glob(f"*{suffix}"))
            parent = folder.parent if folder.name not in {"", ".."} else folder.resolve().parent
            near.update((parent / suffix[1:]).glob(f"*{suffix}"))
    for path in sorted(near - read)[:MAX_FILES]:
        _add_types(read_source(path)[0], types)


def _add_documents(files: Sequence[SourceFile], used: Iterable[str], types: TypeTable, *, classic: bool) -> None:
    """Types and FBs that the sources lack, from documents of their names beside the named files.

    A document whose bounds nobody knows is no help.
    """
    from plcgen.s7.xml.reading.documents import read_simaticml

    folders = {file.path.parent for file in files if not file.listed}
    beside = {path.stem.upper(): path for folder in sorted(folders) for path in sorted(folder.glob("*.xml"))}
    for file in files:
        beside.pop(file.path.stem.upper(), None)
    pending = sorted(used)
    while pending:
        name = pending.pop()
        path = beside.pop(name, None) if name not in types else None
        if path is not None:
            blocks, problems = read_simaticml(path, classic=classic)
            if not any(problem.code == "PG806" for problem in problems):
                _add_types(blocks, types)
                pending += sorted(_used(blocks))


def _add_aliases(symbols: dict[str, str], types: TypeTable) -> None:
    """Make a type known by its symbol and by its number."""
    for symbol, number in symbols.items():
        for name, other in ((symbol.upper(), number), (number, symbol.upper())):
            if name not in types and other in types:
                types[name] = types[other]
    for block in list(types.values()):
        if block.number is not None:
            types.setdefault(f"{block.kind}{block.number}", block)
