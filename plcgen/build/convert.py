"""Blocks of anybody's sources in another spelling: SCL text, SimaticML, SIMATIC SD."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal

from plcgen.base.diagnostics import Diagnostic, Severity, Span, has_errors
from plcgen.base.paths import is_device
from plcgen.build.environment import RenderedFile
from plcgen.s7.read.files import SourceFile, project_constants, source_files
from plcgen.s7.read.plcs import by_plc, plc_names
from plcgen.s7.read.text import read_source
from plcgen.s7.scl.declarations import recursive_types, trim_code
from plcgen.s7.scl.dialect import Dialect
from plcgen.s7.scl.lexer import Tokens, tokenize
from plcgen.s7.scl.parser import ParseResult, parse
from plcgen.s7.types.blocks import Block, BlockKind, is_retentive
from plcgen.s7.xml.reading.documents import read_simaticml
from plcgen.s7.xml.reading.source import KEYWORDS, SUFFIXES, is_array_db, sd_document, source
from plcgen.s7.xml.spelling import VERSIONS
from plcgen.s7.xml.writing.documents import Setting, document, library_element
from plcgen.s7.xml.writing.elements import BlockScope
from plcgen.s7.xml.writing.structured_text import elements, numbered

Target = Literal["scl", "xml", "sd"]

_FORMS: Mapping[Target, int] = {"scl": 0, "sd": 1, "xml": 2}
_CODE = frozenset({BlockKind.FB, BlockKind.FC, BlockKind.OB})
_SYMBOLS = frozenset({".sdf", ".asc"})
_FORBIDDEN = frozenset('<>:"/\\|?*%')

MAX_LOST = 10
"""So many start values of a block that a document cannot hold are told one by one."""

MAX_NAME = 200
"""Longest file name in characters, without the ending."""


@dataclass(slots=True)
class Converted:
    """Finished files by name, and everything found; with an error there are no files."""

    files: list[RenderedFile] = field(default_factory=list)
    diagnostics: list[Diagnostic] = field(default_factory=list)

    @property
    def ok(self) -> bool:
        """Whether no diagnostic is an error."""
        return not has_errors(self.diagnostics)


@dataclass(frozen=True, slots=True)
class _Read:
    """A block, where it stands, and what its file is written in, see ``SourceFile.form``."""

    block: Block
    place: Span
    form: int
    document: bool


@dataclass(frozen=True, slots=True)
class _Sources:
    """Blocks of one PLC, the names of its user constants, and where the code of each block of a text begins in it."""

    blocks: Sequence[_Read]
    constants: frozenset[str]
    codes: Mapping[Span, tuple[Tokens, int]]


def convert(
    paths: Sequence[Path],
    to: Target,
    *,
    version: str = "V16",
    classic: bool = False,
    culture: str = "en-US",
    encoding: str | None = None,
    keep_going: bool = False,
) -> Converted:
    """Convert every block of files and folders; one file per block, named after it.

    ``keep_going``: what cannot be read or written is left out, the rest is done all the same. ``version`` is the TIA
    Portal version of documents to be written, ``culture`` the language of their comments. ``classic``: the blocks are
    for S7-300/400. ``encoding`` is the code page of ANSI sources.
    """
    found = Converted()
    named = list(source_files(paths, found.diagnostics))
    groups = by_plc((file.path for file in named), paths)
    called, setting = plc_names(groups, paths), Setting(VERSIONS[version], classic, (culture,))
    files = []
    for folder, own in groups.items():
        shared = own if folder is None else [*own, *groups.get(None, ())]
        read = _read([file for file in named if file.path in shared], found, classic=classic, encoding=encoding)
        made = [file for file, place in _group(read, to, setting, found) if place in map(str, own)]
        prefix = called[folder]
        files += [replace(file, path=f"{prefix}/{file.path}") if prefix else file for file in made]
    found.diagnostics = list(dict.fromkeys(found.diagnostics))
    if not files and found.ok and not any(d.code == "PG815" for d in found.diagnostics):
        found.diagnostics.append(Diagnostic("PG804", "there is no block in these files", Span(str(paths[0]))))
    found.files = files if found.ok or keep_going else []
    return found


def _group(read: _Sources, to: Target, setting: Setting, found: Converted) -> Iterator[tuple[RenderedFile, str]]:
    """The files of one PLC, and where the block of each stands."""
    bad = {d.span.file for d in found.diagnostics if d.severity is Severity.ERROR}
    blocks = _unique([one for one in read.blocks if str(one.place.file) not in bad], to, found)
    found.diagnostics += recursive_types(block for block, _ in blocks)
    types = {block.name.upper(): block for block, _ in blocks}
    taken: dict[str, Block] = {}
    for block, place in blocks:
        if block.safety:
            message = f'{block.kind} "{block.name}" is of a safety program, here it would be a standard block: left out'
            found.diagnostics.append(Diagnostic("PG815", message, place, Severity.WARNING))
            continue
        if block.kind in _CODE and block.code is None:
            message = f'{block.kind} "{block.name}" has no SCL code: it is not converted'
            found.diagnostics.append(Diagnostic("PG815", message, place, Severity.WARNING))
            continue
        if to == "sd":
            files = _to_sd(block, place, types, setting, found)
        elif to == "scl":
            files = _to_text(block, place, types, found)
        else:
            files = _to_document(block, place, types, read, setting, found)
        for file in files:
            first = taken.setdefault(file.path.upper(), block)
            if first is not block:
                message = f'"{block.name}" and "{first.name}" would both become {file.path}'
                help_ = "convert them one after the other"
                found.diagnostics.append(Diagnostic("PG805", message, place, help=help_))
            yield file, str(place.file)


def _read(files: Sequence[SourceFile], found: Converted, *, classic: bool, encoding: str | None) -> _Sources:
    """Blocks with their places; a bound or length that nobody knows is an error: it cannot be written."""
    constants = project_constants(files)
    dialect = Dialect.TIA_300_400 if classic else Dialect.TIA_1200_1500
    read: list[_Read] = []
    codes: dict[Span, tuple[Tokens, int]] = {}
    for file in files:
        if file.path.suffix.lower() in _SYMBOLS:
            continue
        if file.is_xml:
            blocks, problems = read_simaticml(file.path, classic=classic or None, constants=constants, inline=False)
            if not blocks and file.listed and all(problem.code == "PG812" for problem in problems):
                continue  # another kind of document that lies in the folder
        else:
            whole = {name: value for name, value in constants.items() if value is not None}
            kept: list[ParseResult] = []
            blocks, problems = read_source(file.path, dialect, encoding=encoding, constants=whole, keep=kept.append)
            codes |= {place: code for result in kept for place, code in _codes(result)}
            problems = [problem for problem in problems if not _about_encoding(problem)]
            if not classic and any(problem.code == "PG803" for problem in problems):
                _, other = read_source(file.path, Dialect.TIA_300_400, encoding=encoding, constants=whole)
                problems = [_of_classic(problem, other) for problem in problems]
        found.diagnostics += [_without_value(problem) for problem in problems if problem.code != "PG814"]
        places = [block.span or Span(str(file.path)) for block in blocks]
        read += [_Read(block, place, file.form, file.is_xml) for block, place in zip(blocks, places, strict=True)]
    return _Sources(_laid_out(read, found), frozenset(constants), codes)


def _codes(result: ParseResult) -> Iterator[tuple[Span, tuple[Tokens, int]]]:
    """Where the code of each block begins in its text, by the place of the block."""
    text = result.tokens.text_alone()
    for unit in result.units:
        begin, stop = unit.code
        if stop > begin >= 0 and not unit.networks:  # theirs is shifted to the left, for each network by itself
            code = text.source[begin:stop]
            yield text.span(unit.start, unit.start + len(unit.keyword)), (text, begin + code.index(trim_code(code)))


def _of_classic(problem: Diagnostic, other: Sequence[Diagnostic]) -> Diagnostic:
    """A construct that only S7-1200/1500 refuse, with the option for sources of the others."""
    if problem.code != "PG803" or any(each.code == "PG803" and each.span == problem.span for each in other):
        return problem
    return replace(problem, help="; ".join(filter(None, (problem.help, "for sources of an S7-300/400: --classic"))))


def _without_value(problem: Diagnostic) -> Diagnostic:
    unknown = problem.code == "PG806" and problem.severity is Severity.WARNING
    return replace(problem, severity=Severity.ERROR) if unknown else problem


def _laid_out(read: Sequence[_Read], found: Converted) -> list[_Read]:
    """The blocks with the access that is meant where documents say none: those of S7-300/400 never do, others always.

    So documents that all say none are of S7-300/400; a single one among others was not written by a TIA Portal.
    """
    able = [one for one in read if one.document and one.block.kind is not BlockKind.UDT and not one.block.safety]
    silent = [one for one in able if one.block.optimized is None and not one.block.instance_of]
    if not silent:
        return list(read)
    place = silent[0].place
    if all(one in silent or one.block.instance_of for one in able):
        message = "no MemoryLayout in these documents: they are taken as blocks of an S7-300/400, with standard access"
        help_ = "--classic says so; an export of S7-1200/1500 has one in every document"
        found.diagnostics.append(Diagnostic("PG815", message, place, Severity.NOTE, help=help_))
        return [replace(one, block=replace(one.block, optimized=False)) if one in able else one for one in read]
    names = ", ".join(f'{one.block.kind} "{one.block.name}"' for one in silent[:3])
    names += f" and {len(silent) - 3} more" if len(silent) > 3 else ""
    message = f"no MemoryLayout for {names}: taken as optimized access, as on S7-1200/1500"
    help_ = "for blocks of an S7-300/400: --classic"
    found.diagnostics.append(Diagnostic("PG815", message, place, Severity.WARNING, help=help_))
    return [replace(one, block=replace(one.block, optimized=True)) if one in silent else one for one in read]


def _about_encoding(problem: Diagnostic) -> bool:
    """Whether it only says that the TIA Portal would misread the file: the encoding is what we know already."""
    return problem.code == "PG803" and not problem.span.line


def _unique(read: Iterable[_Read], to: Target, found: Converted) -> list[tuple[Block, Span]]:
    """One block of each name: of source and document the one that is not the target, as in a generated folder.

    Two in the same spelling are an error, because only one can be written.
    """
    own = _FORMS[to]
    kept: dict[str, _Read] = {}
    for one in read:
        first = kept.setdefault(one.block.name.upper(), one)
        if first is one:
            continue
        if first.form != one.form:
            kept[one.block.name.upper()] = min(first, one, key=lambda each: (each.form == own, each.form))
            continue
        message = f'{one.block.kind} "{one.block.name}" is declared a second time, first in {first.place}'
        found.diagnostics.append(Diagnostic("PG805", message, one.place, help="name one version of each block"))
    return [(one.block, one.place) for one in kept.values()]


def file_name(name: str) -> str:
    """A file name for a block that every system takes: other characters become ``%XX``, as in addresses."""
    coded = "".join(c if c.isprintable() and c not in _FORBIDDEN else f"%{ord(c):02X}" for c in name)
    if not coded.strip(". "):
        coded = coded.replace(".", "%2E").replace(" ", "%20")
    if is_device(coded) or coded[-1:] in {".", " "}:
        coded = f"{coded[:-1]}%{ord(coded[-1]):02X}"
    return coded[:MAX_NAME] or "%00"


def _to_text(block: Block, place: Span, types: dict[str, Block], found: Converted) -> list[RenderedFile]:
    found.diagnostics += _lost_in_text(block, place)
    text = source(block, types)
    problem = _wrong(text, block)
    if problem:
        message = f'{block.kind} "{block.name}" does not become SCL: {problem}'
        found.diagnostics.append(Diagnostic("PG812", message, place))
        return []
    return [RenderedFile(file_name(block.name) + SUFFIXES[block.kind], text.encode("utf-8-sig", "replace"))]


def _to_sd(
    block: Block, place: Span, types: dict[str, Block], setting: Setting, found: Converted
) -> list[RenderedFile]:
    """The document of a block and its texts, if it has some; nothing, with a warning, for what no document shows."""
    of = types.get((block.instance_of or "").upper())
    if of is not None and block.optimized is None:
        block = replace(block, optimized=of.optimized)
    written = sd_document(block, setting.version.name, setting.cultures[0])
    if written.unseen:
        message = f'{block.kind} "{block.name}" has {written.unseen}: no public SIMATIC SD document shows that'
        help_ = "it is left out: import it as a source or as SimaticML"
        found.diagnostics.append(Diagnostic("PG815", message, place, Severity.WARNING, help=help_))
        return []
    if block.kind is BlockKind.UDT and (block.title or block.comment):
        message = f'{block.kind} "{block.name}": its title and comment are not converted'
        help_ = "no public SIMATIC SD document of a type shows where they stand"
        found.diagnostics.append(Diagnostic("PG815", message, place, Severity.NOTE, help=help_))
    texts = {".s7dcl": written.document, ".s7res": written.texts}
    return [
        RenderedFile(file_name(block.name) + suffix, text.replace("\n", "\r\n").encode("utf-8-sig", "replace"))
        for suffix, text in texts.items()
        if text
    ]


def _lost_in_text(block: Block, place: Span) -> Iterator[Diagnostic]:
    """What of a document does not get into a source: single start values outside of data blocks, the event of an OB."""
    if block.assignments and (block.kind is not BlockKind.DB or is_array_db(block)):
        first, more = block.assignments[0].path, len(block.assignments) - 1
        message = f'{block.kind} "{block.name}": the start value of {first} is not converted'
        message += f", nor those of {more} more members" if more else ""
        help_ = "values of single elements and inside of other types are written in data blocks only: add them by hand"
        yield Diagnostic("PG815", message, place, Severity.ERROR, help=help_)
    elif is_array_db(block) and block.members[0].start is not None:
        message = f'{block.kind} "{block.name}": its start values are not converted'
        yield Diagnostic("PG815", message, place, Severity.ERROR, help="add them by hand after the import")
    event = block.attributes.get("SecondaryType")
    if event:
        message = f'{block.kind} "{block.name}": that its event is {event} is not converted'
        help_ = "a source has no words for it: set it in the TIA Portal after the import; --keep-going writes the rest"
        yield Diagnostic("PG815", message, place, Severity.ERROR, help=help_)


def _wrong(text: str, block: Block) -> str:
    """What keeps a finished source from being exactly this block; empty if nothing does."""
    result = parse(text, "")
    errors = [d for d in result.diagnostics if d.severity is Severity.ERROR]
    if errors:
        return f"{errors[0].message} (line {errors[0].span.line} of the source)"
    return (
        "" if len(result.units) == 1 and result.units[0].keyword == KEYWORDS[block.kind] else "its code ends the block"
    )


def _to_document(
    block: Block, place: Span, types: dict[str, Block], read: _Sources, setting: Setting, found: Converted
) -> list[RenderedFile]:
    code = ""
    if is_array_db(block):
        message = f'{block.kind} "{block.name}" is one array: documents of array DBs are not written, it is left out'
        found.diagnostics.append(Diagnostic("PG815", message, place, Severity.ERROR, help="import it as a source"))
        return []
    if block.kind in _CODE and block.code is not None:
        scope = BlockScope.of(block, types.values(), read.constants)
        unknown: dict[str, tuple[int, int]] = {}
        tokens = tokenize(block.code, str(place.file))
        code = numbered(elements(tokens, 0, len(block.code), scope, setting, unknown))
        for what, (begin, stop) in unknown.items():
            message = f'{block.kind} "{block.name}" {what}'
            help_ = (
                "name the source of the FC, or those of the instance and of its function block, too"
                if what.startswith("calls")
                else "how a document says that is not known here: import the block as a source"
            )
            whole, first = read.codes.get(place, (None, 0))
            there = place if whole is None else whole.span(first + begin, first + stop)
            found.diagnostics.append(Diagnostic("PG815", message, there, Severity.ERROR, help=help_))
        if unknown:
            return []
    elif block.instance_of:
        made = _instance(block, place, types, found)
        if made is None:
            return []
        block = made
    if block.kind is BlockKind.OB and block.number is None and block.name.upper() != "MAIN":
        message = f'{block.kind} "{block.name}": its event is not known, it is written as ProgramCycle'
        help_ = "correct SecondaryType in the document if it is another one"
        found.diagnostics.append(Diagnostic("PG815", message, place, Severity.WARNING, help=help_))
    text, lost = document(block, setting, code, types)
    if is_retentive(block) and (block.instance_of or not block.members):
        message = f'{block.kind} "{block.name}": that it is retentive is not converted'
        help_ = "a document says it at members, and not in instance data blocks: set Retain in the TIA Portal"
        found.diagnostics.append(Diagnostic("PG815", message, place, Severity.NOTE, help=help_))
    for what in lost[:MAX_LOST]:
        message = f'{block.kind} "{block.name}": {what} is not converted'
        found.diagnostics.append(Diagnostic("PG815", message, place, Severity.ERROR))
    if len(lost) > MAX_LOST:
        message = f'{block.kind} "{block.name}": {len(lost) - MAX_LOST} more start values are not converted'
        found.diagnostics.append(Diagnostic("PG815", message, place, Severity.ERROR))
    return [RenderedFile(file_name(block.name) + ".xml", text.encode("utf-8-sig", "replace"))]


def _instance(block: Block, place: Span, types: dict[str, Block], found: Converted) -> Block | None:
    """An instance DB with the interface of what it is made from; None, with an error, if nobody knows that."""
    of = types.get((block.instance_of or "").upper())
    if of is None and not library_element(block):
        message = (
            f'{block.kind} "{block.name}" is made from "{block.instance_of}": whether that is an FB or a type is not'
        )
        help_ = "name its source, too"
        found.diagnostics.append(Diagnostic("PG815", f"{message} known", place, Severity.ERROR, help=help_))
        return None
    if of is None:
        return block
    return block if block.members else replace(block, sections=of.sections)
