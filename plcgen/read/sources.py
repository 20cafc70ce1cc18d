"""Any set of sources - files and folders, text and SimaticML - as blocks with their code and member attributes."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from plcgen.diagnostics import Diagnostic, Severity, Span
from plcgen.read.code import Code, document_code, statement_list_code, unit_code
from plcgen.read.simaticml import read_simaticml
from plcgen.read.text import MAX_BYTES, decode
from plcgen.read.xml_attributes import document_attributes
from plcgen.s7.blocks import Block, BlockKind
from plcgen.s7.shapes import TypeTable
from plcgen.scl import ast
from plcgen.scl.declarations import blocks as declared_blocks
from plcgen.scl.parser import ParseResult, parse

TEXT_SUFFIXES = frozenset({".scl", ".udt", ".db", ".awl", ".stl"})
XML_SUFFIXES = frozenset({".xml"})
STATEMENT_LISTS = frozenset({".awl", ".stl"})
MAX_FILES = 20_000
"""More files in one folder are refused with PG802."""


@dataclass(frozen=True, slots=True)
class SourceBlock:
    """One block, the file it comes from, its code without comments, and what stands in braces at its members.

    ``attributes`` has one entry per member with attributes: upper-case path to name and value; the key
    ``RETAIN`` is the retentivity (``RETAIN``, ``NONRETAIN``, ``SETINIDB``).
    """

    block: Block
    file: str
    code: Code
    attributes: dict[str, dict[str, str]]


@dataclass(slots=True)
class Sources:
    """Blocks in the order of the files, the first of each name, and everything that could not be read."""

    blocks: list[SourceBlock] = field(default_factory=list)
    types: TypeTable = field(default_factory=TypeTable)
    files: list[str] = field(default_factory=list)
    parsed: dict[str, ParseResult] = field(default_factory=dict)
    diagnostics: list[Diagnostic] = field(default_factory=list)


def read_sources(paths: Iterable[Path], *, classic: bool = False) -> Sources:
    """Read files and folders; a folder means every source below it, hidden folders left out.

    Where a folder holds a block as text and as SimaticML, as plcgen writes it, the text counts. Types that the
    files use and do not declare are looked for beside them. ``classic``: the documents are for S7-300/400.
    """
    sources = Sources()
    found: list[Path] = []
    for path in dict.fromkeys(paths):
        if path == Path(os.devnull):
            continue
        if path.is_dir():
            found += _walk(path, sources)
        else:
            found.append(path)
    seen: dict[tuple[BlockKind, str], SourceBlock] = {}
    for path in sorted(dict.fromkeys(found), key=lambda p: (p.suffix.lower() in XML_SUFFIXES, p.as_posix())):
        sources.files.append(path.as_posix())
        for block in _read(path, sources, classic=classic):
            _keep(block, seen, sources)
    sources.types.update(_neighbours(found, sources))
    return sources


def read_texts(texts: Iterable[tuple[str, str]]) -> Sources:
    """Read text sources that are in memory, as (file name, text)."""
    sources = Sources()
    seen: dict[tuple[BlockKind, str], SourceBlock] = {}
    for name, text in texts:
        sources.files.append(name)
        for block in _text_blocks(text, name, sources):
            _keep(block, seen, sources)
    return sources


def _keep(found: SourceBlock, seen: dict[tuple[BlockKind, str], SourceBlock], sources: Sources) -> None:
    block = found.block
    key = (block.kind, block.name.upper())
    first = seen.setdefault(key, found)
    if first is found:
        sources.blocks.append(found)
        sources.types.setdefault(block.name.upper(), block)
        return
    twins = Path(first.file).suffix.lower() not in XML_SUFFIXES and Path(found.file).suffix.lower() in XML_SUFFIXES
    if not twins:
        message = f'{block.kind} "{block.name}" is declared a second time; the one in {first.file} counts'
        place = block.span or Span(found.file)
        help_ = "name the files of one version only"
        sources.diagnostics.append(Diagnostic("PG805", message, place, Severity.WARNING, help=help_))


def _walk(folder: Path, sources: Sources) -> list[Path]:
    """Every source below a folder, sorted; symbolic links to folders are not followed."""
    found: list[Path] = []
    for where, folders, names in os.walk(folder):
        folders[:] = sorted(name for name in folders if not name.startswith("."))
        found += [Path(where) / name for name in sorted(names) if _is_source(name)]
        if len(found) > MAX_FILES:
            message = f"more than {MAX_FILES} sources below this folder"
            sources.diagnostics.append(Diagnostic("PG802", message, Span(str(folder)), help="name a smaller folder"))
            return found[:MAX_FILES]
    return found


def _is_source(name: str) -> bool:
    return Path(name).suffix.lower() in TEXT_SUFFIXES | XML_SUFFIXES and not name.startswith(".")


def _read(path: Path, sources: Sources, *, classic: bool) -> Iterator[SourceBlock]:
    if path.suffix.lower() in XML_SUFFIXES:
        yield from _document(path, sources, classic=classic)
        return
    name = str(path)
    try:
        size = path.stat().st_size
        data = path.read_bytes() if size <= MAX_BYTES else b""
    except OSError as error:
        message = f"the file cannot be read: {error.strerror or type(error).__name__}"
        sources.diagnostics.append(Diagnostic("PG804", message, Span(name)))
        return
    if size > MAX_BYTES:
        message = f"the file has {size} bytes, more than {MAX_BYTES}"
        sources.diagnostics.append(Diagnostic("PG802", message, Span(name)))
        return
    text = decode(data, name)
    if isinstance(text, Diagnostic):
        sources.diagnostics.append(text)
        return
    yield from _text_blocks(text, name, sources)


def _document(path: Path, sources: Sources, *, classic: bool) -> Iterator[SourceBlock]:
    blocks, found = read_simaticml(path, classic=classic)
    sources.diagnostics += found
    if not blocks:
        return
    code, attributes = document_code(path), document_attributes(path)
    for block in blocks:
        yield SourceBlock(block, str(path), code.get(block.name, Code()), attributes.get(block.name, {}))


def _text_blocks(text: str, name: str, sources: Sources) -> Iterator[SourceBlock]:
    statement_list = Path(name).suffix.lower() in STATEMENT_LISTS
    result = parse(text, name, None, bodies=not statement_list)
    blocks, found = declared_blocks(result)
    sources.diagnostics += sorted([*result.diagnostics, *found], key=lambda d: d.sort_key)
    sources.parsed[name] = result
    for unit, block in zip(result.units, blocks, strict=True):
        code = Code()
        if block.kind not in {BlockKind.DB, BlockKind.UDT}:
            code = statement_list_code(unit, result) if statement_list else unit_code(unit, result)
        yield SourceBlock(block, name, code, _attributes(unit))


def _attributes(unit: ast.Unit) -> dict[str, dict[str, str]]:
    found: dict[str, dict[str, str]] = {}
    pending: list[tuple[str, Sequence[ast.Declaration], dict[str, str]]] = []
    for section in unit.sections:
        retain = {"RETAIN": "RETAIN"} if "RETAIN" in section.modifiers else {}
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
    return found


def _neighbours(paths: Iterable[Path], sources: Sources) -> dict[str, Block]:
    """Types from UDT and SCL files beside the sources, or in ``../udt`` and ``../scl``, that the sources lack."""
    from plcgen.read.text import read_source

    known = {Path(file) for file in sources.files}
    folders = {path.parent for path in paths if path.is_file()}
    near: set[Path] = set()
    for folder in folders:
        for suffix in ("udt", "scl"):
            near |= {*folder.glob(f"*.{suffix}"), *(folder.parent / suffix).glob(f"*.{suffix}")}
    missing: dict[str, Block] = {}
    for path in sorted(near - known):
        for block in read_source(path)[0]:
            if block.name.upper() not in sources.types:
                missing.setdefault(block.name.upper(), block)
    return missing
