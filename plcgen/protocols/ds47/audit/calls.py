"""Calls of WRREC and RDREC in SCL and in statement lists, whatever the instance is called.

A call is known by its parameters: RECORD and INDEX belong to no other block of the standard library; MLEN or VALID
make it RDREC.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path

from plcgen.diagnostics import DiagnosticError, Span
from plcgen.protocols.ds47.audit.model import ConstantArgument, FoundCall, Record, block_title
from plcgen.s7.address import AddressError, parse_address, parse_pointer
from plcgen.s7.blocks import Block
from plcgen.s7.layout import layout_members, split_path
from plcgen.s7.types import Elementary
from plcgen.scl import ast
from plcgen.scl.constants import evaluate, integer
from plcgen.scl.lexer import NAME
from plcgen.scl.parser import ParseResult
from plcgen.sources.blocks import STATEMENT_LISTS, SourceBlock, Sources

_NUMBER = re.compile(r"%?DB\s*([0-9]{1,5})", re.IGNORECASE)
_PARAMETERS = frozenset({"REQ", "ID", "INDEX", "LEN", "MLEN", "DONE", "VALID", "BUSY", "ERROR", "STATUS", "RECORD"})


def record_calls(sources: Sources) -> Iterator[FoundCall]:
    """Every call in the text sources, in the order of the files."""
    for source in sources.blocks:
        if source.unit is None or source.parsed is None:
            continue
        if Path(source.file).suffix.lower() in STATEMENT_LISTS:
            yield from _statement_list(source, source.unit, source.parsed)
        else:
            yield from _scl(source, source.unit, source.parsed, sources.types)


def _is_read(names: set[str]) -> bool:
    return bool(names & {"MLEN", "VALID"})


def _scl(source: SourceBlock, unit: ast.Unit, result: ParseResult, types: Mapping[str, Block]) -> Iterator[FoundCall]:
    known = _constants(unit)
    for node in ast.walk(unit):
        if not isinstance(node, ast.Call):
            continue
        named = {a.name.upper(): a for a in node.arguments if a.name is not None}
        if not {"RECORD", "INDEX"} <= named.keys():
            continue
        arguments = {
            name: ConstantArgument(
                _text(result, argument.value), evaluate(argument.value, known), result.span(argument)
            )
            for name, argument in named.items()
        }
        record = _record(named["RECORD"].value, _text(result, named["RECORD"].value), result.span(named["RECORD"]))
        if record.local and record.length is None:
            record = replace(record, length=_local_size(named["RECORD"].value, source, types))
        call = FoundCall(
            not _is_read(set(named)), block_title(source.block), result.span(node.target), arguments, record
        )
        yield call if source.located else _at_block(call, source.block.span or Span(source.file))


def _at_block(call: FoundCall, place: Span) -> FoundCall:
    """The same call in SimaticML, whose code has no lines: everything in it stands where the block does."""
    arguments = {name: replace(argument, span=place) for name, argument in call.arguments.items()}
    record = None if call.record is None else replace(call.record, span=place)
    return replace(call, span=place, arguments=arguments, record=record)


def _local_size(node: ast.Expression, source: SourceBlock, types: Mapping[str, Block]) -> int | None:
    """Bytes of a variable of the block; None if it is none, of unknown size, or a pointer to something else."""
    if not isinstance(node, ast.Name):
        return None
    members = [m for s in source.block.sections for m in s.members if m.name.upper() == node.name.upper()]
    if any(isinstance(m.type, Elementary) and m.type.name in {"ANY", "POINTER"} for m in members):
        return None
    try:
        return layout_members(members, types).size or None if members else None
    except DiagnosticError:
        return None


def _constants(unit: ast.Unit) -> dict[str, int]:
    """Integer constants of the block by upper-case name."""
    known: dict[str, int] = {}
    for section in unit.sections:
        if section.keyword != "CONST" and "CONSTANT" not in section.modifiers:
            continue
        for declaration in section.declarations:
            value = evaluate(declaration.initial, known) if declaration.initial is not None else None
            if value is not None:
                known.update((name.name.upper(), value) for name in declaration.names)
    return known


def _text(result: ParseResult, node: ast.Node) -> str:
    return " ".join(result.tokens.source[node.start : node.end].split())


def _record(node: ast.Expression, text: str, span: Span) -> Record:
    """What an expression after RECORD names."""
    path: list[str] = []
    base = node
    while isinstance(base, ast.Member | ast.Index | ast.Slice):
        if isinstance(base, ast.Member):
            path.insert(0, base.name)
        base = base.base
    if isinstance(base, ast.Literal) and base.kind == "pointer":
        return pointer_record(base.text, span)
    if isinstance(base, ast.Address):
        return address_record(base.text, text, span, ".".join(path))
    if isinstance(base, ast.Name) and base.scope == "quoted":
        return Record(text, span, db=base.name, path=".".join(path))
    if isinstance(base, ast.Name) and base.scope == "bare" and _NUMBER.fullmatch(base.name):
        return address_record(base.name, text, span, ".".join(path))
    return Record(text, span, local=True)


def pointer_record(text: str, span: Span) -> Record:
    """``P#DB3.DBX0.0 BYTE 10``; another area (``P#M100.0 BYTE 40``) is a variable of known length."""
    try:
        pointer = parse_pointer(text)
    except AddressError:
        return Record(text, span, local=True)
    length = None if pointer.kind is None else max(pointer.region.width_bits // 8, 1)
    if pointer.start.db is None:
        return Record(text, span, local=True, length=length)
    return Record(text, span, number=pointer.start.db, start=pointer.start.byte, length=length)


def address_record(text: str, shown: str, span: Span, path: str = "") -> Record:
    """``DB3``, ``%DB3``, ``DB3.DBD0``."""
    whole = _NUMBER.fullmatch(text)
    if whole:
        return Record(shown, span, number=int(whole[1]), path=path)
    try:
        address = parse_address(text)
    except AddressError:
        return Record(shown, span, local=True)
    if address.db is None:
        return Record(shown, span, local=True, length=max(address.width_bits // 8, 1))
    return Record(shown, span, number=address.db, start=address.byte, length=max(address.width_bits // 8, 1))


def _statement_list(source: SourceBlock, unit: ast.Unit, result: ParseResult) -> Iterator[FoundCall]:
    """``CALL SFB 53 , DB 53 ( REQ := .., LEN := 10, RECORD := P#DB3.DBX0.0 BYTE 10);``."""
    tokens = result.tokens
    first = next((i for i, start in enumerate(tokens.starts) if start >= unit.start), 0)
    last = next((i for i, start in enumerate(tokens.starts) if start >= unit.end), len(tokens.starts) - 1)
    index = first
    while index < last:
        if tokens.kinds[index] == NAME and tokens.texts[index].upper() == "CALL":
            call, index = _call(source, result, index, last)
            if call is not None:
                yield call
        else:
            index += 1


def _call(source: SourceBlock, result: ParseResult, start: int, last: int) -> tuple[FoundCall | None, int]:
    """One CALL up to its semicolon."""
    tokens = result.tokens
    stop = next((i for i in range(start, last) if tokens.kinds[i] == ";"), last)
    heads = [
        i for i in range(start + 1, stop - 1)
        if tokens.texts[i].upper() in _PARAMETERS and tokens.kinds[i + 1] in {":=", "=>"}
    ]  # fmt: skip
    arguments: dict[str, ConstantArgument] = {}
    record = None
    for i, head in enumerate(heads):
        end = heads[i + 1] if i + 1 < len(heads) else stop
        values = [n for n in range(head + 2, end) if tokens.kinds[n] not in {",", ")"}]
        if not values:
            continue
        text = " ".join(tokens.source[tokens.starts[values[0]] : tokens.end(values[-1])].split())
        span = tokens.span(tokens.starts[head], tokens.end(values[-1]))
        arguments[tokens.texts[head].upper()] = ConstantArgument(text, integer(text), span)
        if tokens.texts[head].upper() == "RECORD":
            record = _stl_record(text, span)
    if not {"RECORD", "INDEX"} <= arguments.keys():
        return None, stop + 1
    names = {tokens.texts[head].upper() for head in heads}
    span = tokens.span(tokens.starts[start], tokens.end(start))
    return FoundCall(not _is_read(names), block_title(source.block), span, arguments, record), stop + 1


def _stl_record(text: str, span: Span) -> Record:
    if text.upper().startswith("P#"):
        return pointer_record(text, span)
    if text.startswith('"'):
        try:
            steps = [step for step in split_path(text) if isinstance(step, str)]
        except KeyError:
            return Record(text, span, local=True)
        return Record(text, span, db=steps[0], path=".".join(steps[1:]))
    return Record(text, span, local=True) if text.startswith("#") else address_record(text, text, span)
