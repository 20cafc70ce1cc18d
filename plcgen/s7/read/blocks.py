"""Any set of sources as blocks with what the block model leaves out: their code, and the attributes of members."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

from plcgen.base.diagnostics import Diagnostic, DiagnosticError
from plcgen.s7.layout.shapes import TypeTable
from plcgen.s7.read.code import Code, document_code, statement_list_code, unit_code
from plcgen.s7.read.files import Files, read_files
from plcgen.s7.read.text import parse_source
from plcgen.s7.scl import ast
from plcgen.s7.scl.parser import ParseResult, parse
from plcgen.s7.types.blocks import Block, BlockKind, block_title
from plcgen.s7.xml.reading.documents import KINDS, TagTable, document_attributes
from plcgen.s7.xml.reading.source import KEYWORDS, source
from plcgen.s7.xml.reading.xml import child, children, load, local, parse_xml, text
from plcgen.s7.xml.spelling import REMANENCE

if TYPE_CHECKING:
    from lxml.etree import _Element as Element


@dataclass(frozen=True, slots=True)
class NetworkCall:
    """A call or instruction with its operands by parameter, spelled as in SCL; ``line`` is its line in the file."""

    line: int
    operands: tuple[tuple[str, str], ...]


def document_calls(root: Element) -> dict[str, tuple[NetworkCall, ...]]:
    """Calls of every block of a document by block name, network by network."""
    found: dict[str, tuple[NetworkCall, ...]] = {}
    for block in children(root):
        if local(block) in KINDS:
            name = text(child(child(block, "AttributeList"), "Name")).strip()
            found[name] = tuple(call for network in block.iter("{*}FlgNet") for call in _calls(network))
    return found


def _calls(network: Element) -> Iterator[NetworkCall]:
    """A wire joins an operand (IdentCon) to pins of parts and calls (NameCon)."""
    parts = list(children(child(network, "Parts")))
    operands = {part.get("UId"): operand(part) for part in parts if local(part) == "Access"}
    pins: dict[str | None, list[tuple[str, str]]] = {
        part.get("UId"): [] for part in parts if local(part) in {"Part", "Call"}
    }
    for wire in children(child(network, "Wires")):
        ends = list(children(wire))
        joined = next((operands.get(end.get("UId"), "") for end in ends if local(end) == "IdentCon"), "")
        for end in ends:
            if local(end) == "NameCon" and joined and end.get("UId") in pins:
                pins[end.get("UId")].append((end.get("Name", "").upper(), joined))
    for part in parts:
        if pins.get(part.get("UId")):
            line: object = part.sourceline
            yield NetworkCall(line if isinstance(line, int) else 0, tuple(pins[part.get("UId")]))


def operand(access: Element) -> str:
    """``#a.b``, ``"DB".c``, ``256``, ``P#DB10.DBX0.0 BYTE 33``; empty for an address, whose text nothing here needs."""
    constant = child(access, "Constant")
    if constant is not None:
        return text(child(constant, "ConstantValue")).strip() or f"#{constant.get('Name', '')}"
    steps = [
        f"{part.get('Name', '')}[..]" if len(part) and child(part, "Access") is not None else part.get("Name", "")
        for part in children(child(access, "Symbol"))
        if local(part) == "Component"
    ]
    if not steps:
        return ""
    first = f'"{steps[0]}"' if access.get("Scope", "").startswith("Global") else f"#{steps[0]}"
    return ".".join([first, *steps[1:]])


STATEMENT_LISTS = frozenset({".awl", ".stl"})


@dataclass(frozen=True, slots=True)
class SourceBlock:
    """One block, the file it comes from, its code without comments, and what stands in braces at its members.

    ``unit`` is its syntax tree, None if there is none; of SimaticML it is that of the SCL its networks say, whose
    lines (``located`` False) are not those of the file. ``attributes`` has one entry per member with attributes:
    upper-case path to name and value; the key ``RETAIN`` is the retentivity (``RETAIN``, ``NONRETAIN``,
    ``SETINIDB``). ``calls`` are those of its networks in LAD and FBD.
    """

    block: Block
    file: str
    code: Code = field(default_factory=Code)
    attributes: dict[str, dict[str, str]] = field(default_factory=dict)
    unit: ast.Unit | None = None
    parsed: ParseResult | None = None
    located: bool = True
    calls: tuple[NetworkCall, ...] = ()

    @property
    def title(self) -> str:
        """How messages name it."""
        return block_title(self.block.kind, self.block.number, self.block.name)


@dataclass(frozen=True, slots=True)
class _Details:
    """What the model of a document's blocks leaves out, by block name."""

    code: dict[str, Code] = field(default_factory=dict)
    attributes: dict[str, dict[str, dict[str, str]]] = field(default_factory=dict)
    calls: dict[str, tuple[NetworkCall, ...]] = field(default_factory=dict)


@dataclass(slots=True)
class Sources:
    """Blocks in the order of the files, every type known to them, and everything that could not be read.

    Of several PLCs ``parts`` has the blocks and types of each by its name.
    """

    blocks: list[SourceBlock]
    types: TypeTable
    diagnostics: list[Diagnostic]
    parts: dict[str, Sources] = field(default_factory=dict)
    tables: list[TagTable] = field(default_factory=list)


def read_sources(paths: Iterable[Path], *, classic: bool = False) -> Sources:
    """Read files and folders as :func:`plcgen.s7.read.files.read_files` does; the null device is an empty source."""
    parsed: list[ParseResult] = []
    documents: dict[str, _Details] = {}

    def seen(file: str, root: Element) -> None:
        documents[file] = _Details(document_code(root), document_attributes(root), document_calls(root))

    named = [path for path in paths if path != Path(os.devnull)]
    return _sources(read_files(named, classic=classic, keep=parsed.append, seen=seen), parsed, documents)


def read_texts(texts: Iterable[tuple[str, str]]) -> Sources:
    """Read text sources that are in memory, as (file name, text)."""
    parsed: list[ParseResult] = []
    files = Files()
    for name, source_text in texts:
        blocks, found = parse_source(source_text, name, keep=parsed.append)
        files.blocks += blocks
        files.types.update((block.name.upper(), block) for block in blocks)
        files.diagnostics += found
    return _sources(files, parsed, {})


def _sources(files: Files, parsed: Sequence[ParseResult], documents: Mapping[str, _Details]) -> Sources:
    if files.parts:
        parts = {name: _sources(part, parsed, documents) for name, part in files.parts.items()}
        blocks = [block for part in parts.values() for block in part.blocks]
        return Sources(blocks, files.types, files.diagnostics, parts, files.tables)
    units = {
        (result.tokens.file, unit.keyword, unit.name.upper()): (unit, result)
        for result in reversed(parsed)
        for unit in reversed(result.units)
    }
    found: list[SourceBlock] = []
    for block in files.blocks:
        file = block.span.file if block.span is not None else ""
        known = units.get((file, KEYWORDS[block.kind], block.name.upper()))
        if known is not None:
            found.append(_from_text(block, file, *known))
        elif file in documents:
            found.append(_from_document(block, file, documents[file], files.types))
        else:
            found.append(SourceBlock(block, file))
    return Sources(found, files.types, files.diagnostics, tables=files.tables)


def _from_document(block: Block, file: str, details: _Details, types: TypeTable) -> SourceBlock:
    """A block of SimaticML; where its networks are StructuredText, with the SCL that they say."""
    attributes = details.attributes.get(block.name, {})
    networks, calls = details.code.get(block.name, Code()), details.calls.get(block.name, ())
    result = None if block.code is None else parse(source(block, types), file)
    if result is None or len(result.units) != 1:
        code = networks if result is None else _as_written(block, file)
        return SourceBlock(block, file, code, attributes, calls=calls)
    code = replace(unit_code(result.units[0], result), located=False)
    return SourceBlock(block, file, code, attributes, result.units[0], result, located=False, calls=calls)


def _as_written(block: Block, file: str) -> Code:
    """The networks of a block whose SCL is not that of one block; nothing if the file cannot be read any more."""
    try:
        return document_code(parse_xml(*load(Path(file), None)), scl=True).get(block.name, Code())
    except DiagnosticError:
        return Code()


def _from_text(block: Block, file: str, unit: ast.Unit, result: ParseResult) -> SourceBlock:
    code = Code()
    if block.kind not in {BlockKind.DB, BlockKind.UDT}:
        statement_list = Path(file).suffix.lower() in STATEMENT_LISTS
        code = statement_list_code(unit, result) if statement_list else unit_code(unit, result)
    found: dict[str, dict[str, str]] = {}
    pending: list[tuple[str, Sequence[ast.Declaration], dict[str, str]]] = []
    for section in unit.sections:
        remanence = next((REMANENCE[m].upper() for m in section.modifiers if m in REMANENCE), "")
        retain = {"RETAIN": remanence} if remanence else {}
        pending.append(("", section.declarations, retain))
    if isinstance(unit.body_type, ast.StructSpec):
        pending.append(("", unit.body_type.members, {}))
    while pending:
        prefix, declarations, common = pending.pop()
        for declaration in declarations:
            for name in declaration.names:
                path = f"{prefix}{name.name}".upper()
                own = common | {a.name.upper(): a.value.upper() for a in name.attributes}
                if own:
                    found[path] = own
                spec = declaration.type
                while isinstance(spec, ast.ArraySpec):
                    spec = spec.element
                if isinstance(spec, ast.StructSpec):
                    pending.append((f"{path}.", spec.members, {}))
    return SourceBlock(block, file, code, found, unit, result)
