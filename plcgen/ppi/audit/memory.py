"""Where a program may state telegrams: start values of data blocks, constants assigned to the elements of an array."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from plcgen.base.diagnostics import Span
from plcgen.ppi.audit.model import Bytes
from plcgen.s7.read.blocks import SourceBlock, Sources
from plcgen.s7.read.buffers import LARGEST, FoundBuffer
from plcgen.s7.read.calls import block_constants
from plcgen.s7.scl import ast
from plcgen.s7.scl.constants import evaluate
from plcgen.s7.scl.parser import ParseResult
from plcgen.s7.types.blocks import BlockKind


def stated(buffer: FoundBuffer) -> Bytes | None:
    """Start values of a data block; None if it has errors there."""
    if buffer.memory is None:
        return None
    places = {"".join(a.path.split()).replace('"', "").upper(): a.span for a in buffer.block.assignments}
    given: set[int] = set()
    spans: dict[int, Span] = {}
    for slot in buffer.slots:
        taken = range(slot.offset, slot.end)
        spans.update(dict.fromkeys(taken, places.get(slot.path.upper()) or slot.span))
        if slot.given:
            given.update(taken)
    return Bytes(buffer.title, buffer.memory, frozenset(given), buffer.span, spans, buffer)


def assigned(sources: Sources) -> Iterator[Bytes]:
    """Arrays that get constants byte by byte, one for each list of statements that does so."""
    for source in sources.blocks:
        if (
            source.block.kind is not BlockKind.DB
            and source.unit is not None
            and source.parsed is not None
            and source.unit.statements
        ):
            yield from _in_block(source, source.unit, source.parsed)


@dataclass(slots=True)
class _Array:
    """Elements of one array by index: a constant, or None for what is computed."""

    values: dict[int, int | None] = field(default_factory=dict)
    spans: dict[int, Span] = field(default_factory=dict)


def _in_block(source: SourceBlock, unit: ast.Unit, result: ParseResult) -> Iterator[Bytes]:
    known = block_constants(unit)
    lists: list[Sequence[ast.Statement]] = [unit.statements]
    for node in ast.walk(unit):
        lists += [body for name in ("body", "otherwise") if (body := getattr(node, name, None))]
    for statements in lists:
        arrays: dict[str, _Array] = {}
        for statement in statements:
            if isinstance(statement, ast.Assign) and statement.operator == ":=":
                _assign(statement, known, result, arrays)
        for name, array in arrays.items():
            first, last = min(array.values), max(array.values)
            if last - first >= LARGEST:
                continue
            data = bytes((array.values.get(n) or 0) & 0xFF for n in range(first, last + 1))
            given = frozenset(n - first for n, value in array.values.items() if value is not None)
            home = source.block.span or Span(source.file)
            spans = {n - first: span for n, span in array.spans.items()} if source.located else {}
            yield Bytes(f"{name} in {source.title}", data, given, home, spans)


def _assign(statement: ast.Assign, known: dict[str, int], result: ParseResult, arrays: dict[str, _Array]) -> None:
    for target in (statement.target, *statement.also):
        if not isinstance(target, ast.Index) or len(target.indices) != 1:
            continue
        index = evaluate(target.indices[0], known)
        if index is None:
            continue
        name = "".join(result.tokens.source[target.base.start : target.base.end].split())
        array = arrays.setdefault(name, _Array())
        array.values[index] = evaluate(statement.value, known)
        array.spans[index] = result.span(statement)
