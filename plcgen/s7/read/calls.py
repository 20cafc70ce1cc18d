"""Calls in SCL, statement lists, LAD and FBD, known by the names of their parameters, whatever the instance is called.

Arguments are constants where they can be evaluated; one of them may point to the memory that the call sends or fills.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from plcgen.base.diagnostics import DiagnosticError, Span
from plcgen.s7.layout.layout import layout_members, split_path
from plcgen.s7.read.blocks import STATEMENT_LISTS, SourceBlock, Sources
from plcgen.s7.scl import ast
from plcgen.s7.scl.constants import evaluate, integer
from plcgen.s7.scl.lexer import NAME
from plcgen.s7.scl.parser import ParseResult
from plcgen.s7.types.address import AddressError, parse_address, parse_pointer
from plcgen.s7.types.blocks import Block
from plcgen.s7.types.data_types import Elementary

_NUMBER = re.compile(r"%?DB\s*([0-9]{1,5})", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class ConstantArgument:
    """One argument of a call: its text, its value if it is a constant, and where it stands."""

    text: str
    value: int | None
    span: Span


@dataclass(frozen=True, slots=True)
class PointedArea:
    """What an argument points to: a DB by name or number, or a variable (``local``), from ``start``, ``length`` bytes.

    ``length`` is None if the whole DB or a part of unknown length is meant.
    """

    text: str
    span: Span
    db: str = ""
    number: int | None = None
    start: int = 0
    length: int | None = None
    local: bool = False
    path: str = ""


@dataclass(frozen=True, slots=True)
class SourceCall:
    """A call with its arguments by upper-case name; ``area`` is what its pointer names, None if it has none."""

    block: str
    span: Span
    arguments: dict[str, ConstantArgument]
    area: PointedArea | None = None


def find_calls(sources: Sources, required: frozenset[str], pointer: str = "") -> Iterator[SourceCall]:
    """Every call with all of these parameters in the text sources and documents, in the order of the files."""
    for source in sources.blocks:
        yield from _in_networks(source, sources.types, required, pointer)
        if source.unit is None or source.parsed is None:
            continue
        if Path(source.file).suffix.lower() in STATEMENT_LISTS:
            found = _statement_list(source, source.unit, source.parsed, pointer)
        else:
            found = _scl(source, source.unit, source.parsed, sources.types, required, pointer)
        yield from (call for call in found if required <= call.arguments.keys())


def _scl(
    source: SourceBlock, unit: ast.Unit, result: ParseResult, types: Mapping[str, Block], required: frozenset[str],
    pointer: str,
) -> Iterator[SourceCall]:  # fmt: skip
    known = block_constants(unit)
    for node in ast.walk(unit):
        if not isinstance(node, ast.Call):
            continue
        named = {a.name.upper(): a for a in node.arguments if a.name is not None}
        if not required <= named.keys():
            continue
        arguments = {
            name: ConstantArgument(
                _text(result, argument.value), evaluate(argument.value, known), result.span(argument)
            )
            for name, argument in named.items()
        }
        area = None
        if pointer in named:
            area = _area(named[pointer].value, _text(result, named[pointer].value), result.span(named[pointer]))
        if area is not None and area.local and area.length is None:
            target = named[pointer].value
            size = _local_size(target.name, source, types) if isinstance(target, ast.Name) else None
            area = replace(area, length=size)
        call = SourceCall(source.title, result.span(node.target), arguments, area)
        yield call if source.located else _at_block(call, source.block.span or Span(source.file))


def _in_networks(
    source: SourceBlock, types: Mapping[str, Block], required: frozenset[str], pointer: str
) -> Iterator[SourceCall]:
    """Calls of LAD and FBD; each stands where the document has it."""
    for call in source.calls:
        operands = dict(call.operands)
        if not required <= operands.keys():
            continue
        span = Span(source.file, call.line, 1)
        arguments = {name: ConstantArgument(text, integer(text), span) for name, text in operands.items()}
        area = _stl_area(operands[pointer], span) if pointer in operands else None
        if area is not None and area.local and area.length is None:
            area = replace(area, length=_local_size(area.text.lstrip("#"), source, types))
        yield SourceCall(source.title, span, arguments, area)


def _at_block(call: SourceCall, place: Span) -> SourceCall:
    """The same call in SimaticML, whose code has no lines: everything in it stands where the block does."""
    arguments = {name: replace(argument, span=place) for name, argument in call.arguments.items()}
    area = None if call.area is None else replace(call.area, span=place)
    return replace(call, span=place, arguments=arguments, area=area)


def _local_size(name: str, source: SourceBlock, types: Mapping[str, Block]) -> int | None:
    """Bytes of a variable of the block; None if it is none, of unknown size, or a pointer to something else."""
    members = [m for m in source.block.members if m.name.upper() == name.upper()]
    if any(isinstance(m.type, Elementary) and m.type.name in {"ANY", "POINTER"} for m in members):
        return None
    try:
        return layout_members(members, types).size or None if members else None
    except DiagnosticError:
        return None


def block_constants(unit: ast.Unit) -> dict[str, int]:
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


def _area(node: ast.Expression, text: str, span: Span) -> PointedArea:
    """What an expression names."""
    path: list[str] = []
    base = node
    while isinstance(base, ast.Member | ast.Index | ast.Slice):
        if isinstance(base, ast.Member):
            path.insert(0, base.name)
        base = base.base
    if isinstance(base, ast.Literal) and base.kind == "pointer":
        return pointer_area(base.text, span)
    if isinstance(base, ast.Address):
        return address_area(base.text, text, span, ".".join(path))
    if isinstance(base, ast.Name) and base.scope == "quoted":
        return PointedArea(text, span, db=base.name, path=".".join(path))
    if isinstance(base, ast.Name) and base.scope == "bare" and _NUMBER.fullmatch(base.name):
        return address_area(base.name, text, span, ".".join(path))
    return PointedArea(text, span, local=True)


def pointer_area(text: str, span: Span) -> PointedArea:
    """``P#DB3.DBX0.0 BYTE 10``; another area (``P#M100.0 BYTE 40``) is a variable of known length."""
    try:
        pointer = parse_pointer(text)
    except AddressError:
        return PointedArea(text, span, local=True)
    length = None if pointer.kind is None else max(pointer.region.width_bits // 8, 1)
    if pointer.start.db is None:
        return PointedArea(text, span, local=True, length=length)
    return PointedArea(text, span, number=pointer.start.db, start=pointer.start.byte, length=length)


def address_area(text: str, shown: str, span: Span, path: str = "") -> PointedArea:
    """``DB3``, ``%DB3``, ``DB3.DBD0``."""
    whole = _NUMBER.fullmatch(text)
    if whole:
        return PointedArea(shown, span, number=int(whole[1]), path=path)
    try:
        address = parse_address(text)
    except AddressError:
        return PointedArea(shown, span, local=True)
    if address.db is None:
        return PointedArea(shown, span, local=True, length=max(address.width_bits // 8, 1))
    return PointedArea(shown, span, number=address.db, start=address.byte, length=max(address.width_bits // 8, 1))


def _statement_list(source: SourceBlock, unit: ast.Unit, result: ParseResult, pointer: str) -> Iterator[SourceCall]:
    """``CALL SFB 53 , DB 53 ( REQ := .., LEN := 10, RECORD := P#DB3.DBX0.0 BYTE 10);``."""
    tokens = result.tokens
    first = next((i for i, start in enumerate(tokens.starts) if start >= unit.start), 0)
    last = next((i for i, start in enumerate(tokens.starts) if start >= unit.end), len(tokens.starts) - 1)
    index = first
    while index < last:
        if tokens.kinds[index] == NAME and tokens.texts[index].upper() == "CALL":
            stop = next((i for i in range(index, last) if tokens.kinds[i] == ";"), last)
            yield _call(source, result, index, stop, pointer)
            index = stop
        index += 1


def _call(source: SourceBlock, result: ParseResult, start: int, stop: int, pointer: str) -> SourceCall:
    """One CALL up to its semicolon: a parameter is what stands before ``:=``."""
    tokens = result.tokens
    heads = [i for i in range(start + 1, stop - 1) if tokens.kinds[i + 1] in {":=", "=>"}]
    arguments: dict[str, ConstantArgument] = {}
    area = None
    for i, head in enumerate(heads):
        end = heads[i + 1] if i + 1 < len(heads) else stop
        values = [n for n in range(head + 2, end) if tokens.kinds[n] not in {",", ")"}]
        if not values:
            continue
        text = " ".join(tokens.source[tokens.starts[values[0]] : tokens.end(values[-1])].split())
        span = tokens.span(tokens.starts[head], tokens.end(values[-1]))
        name = tokens.texts[head].upper()
        arguments[name] = ConstantArgument(text, integer(text), span)
        if name == pointer:
            area = _stl_area(text, span)
    span = tokens.span(tokens.starts[start], tokens.end(start))
    return SourceCall(source.title, span, arguments, area)


def _stl_area(text: str, span: Span) -> PointedArea:
    if text.upper().startswith("P#"):
        return pointer_area(text, span)
    if text.startswith('"'):
        try:
            steps = [step for step in split_path(text) if isinstance(step, str)]
        except KeyError:
            return PointedArea(text, span, local=True)
        return PointedArea(text, span, db=steps[0], path=".".join(steps[1:]))
    return PointedArea(text, span, local=True) if text.startswith("#") else address_area(text, text, span)
