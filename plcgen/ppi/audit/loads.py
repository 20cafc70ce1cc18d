"""Telegrams that a statement list puts together: ``L B#16#68; T DB10.DBB 0;``, each network on its own."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from plcgen.base.diagnostics import Span
from plcgen.ppi.audit.model import Bytes
from plcgen.s7.read.blocks import STATEMENT_LISTS, Sources
from plcgen.s7.read.buffers import LARGEST, FoundBuffer
from plcgen.s7.scl import ast
from plcgen.s7.scl.parser import ParseResult
from plcgen.s7.types.literals import LiteralError, pack_literal

_STATEMENT = re.compile(
    r"(?P<network>\bNETWORK\b)|(?P<skip>//[^\n]*|'(?:[^'$\n]|\$.)*')"
    r"|(?:(?P<label>[A-Z_][A-Z0-9_]{0,3})\s*:(?!=)\s*)?(?<![\w#.\"])(?P<op>[A-Z=<>+\-*/)][A-Z0-9=<>+\-*/)(]*)"
    r"(?P<operand>(?:[ \t]+[^;\n]*?)?)\s*;",
    re.IGNORECASE,
)
_PLACE = re.compile(
    r"(?:(?P<db>DB\s*(?P<number>\d{1,5})|\"[^\"]+\")\s*\.\s*)?DB(?P<width>[BWD])\s*(?P<byte>\d{1,5})", re.IGNORECASE
)
_ELEMENT = re.compile(r"(?P<name>(?:#|\"[^\"]+\"\s*\.\s*)?[\w.]+)\s*\[\s*(?P<index>\d{1,5})\s*\]")
_OPENED = re.compile(r"DB\s*(\d{1,5})|\"([^\"]+)\"", re.IGNORECASE)
_WIDTHS = {"B": ("BYTE", 1), "W": ("WORD", 2), "D": ("DWORD", 4)}
_KEEP = frozenset({"T", "NOP", "BLD", "SET", "CLR", "U", "UN", "O", "ON", "A", "AN", "X", "XN", "=", "S", "R"})
"""Instructions that leave the accumulator alone; of all others nobody here knows what is in it afterwards."""


@dataclass(slots=True)
class _Filled:
    """Bytes that one network transfers: a constant, or None for what is computed."""

    values: dict[int, int | None] = field(default_factory=dict)
    spans: dict[int, Span] = field(default_factory=dict)


@dataclass(slots=True)
class _State:
    """What one network has done so far: the constant in the accumulator, the open data block, what was filled."""

    constant: str | None = None
    opened: str = ""
    filled: dict[str, _Filled] = field(default_factory=dict)


def loaded(sources: Sources, buffers: Sequence[FoundBuffer]) -> Iterator[Bytes]:
    """Memory that statement lists fill byte by byte, word by word or by double words."""
    for source in sources.blocks:
        unit, result = source.unit, source.parsed
        if unit is None or result is None or Path(source.file).suffix.lower() not in STATEMENT_LISTS:
            continue
        for state in _networks(unit, result):
            for name, filled in state.filled.items():
                yield from _memory(name, filled, source.title, source.block.span, buffers)


def _networks(unit: ast.Unit, result: ParseResult) -> Iterator[_State]:
    """Walk the statements of a block; a label or a new network forgets the accumulator."""
    state = _State()
    text = result.tokens.source
    for match in _STATEMENT.finditer(text, max([unit.start, *(s.end for s in unit.sections)]), unit.end):
        if match["network"]:
            yield state
            state = _State()
        elif match["op"]:
            if match["label"]:
                state.constant = None
            span = result.tokens.span(match.start("op"), match.end())
            _execute(state, match["op"].upper(), match["operand"].strip(), span)
    yield state


def _execute(state: _State, operation: str, operand: str, span: Span) -> None:
    if operation == "L":
        state.constant = operand
    elif operation in {"AUF", "OPN"}:
        found = _OPENED.fullmatch(operand)
        state.opened = "" if found is None else f"DB{int(found[1])}" if found[1] else found[2]
    elif operation == "T":
        _transfer(state, operand, span)
    elif operation not in _KEEP:
        state.constant = None


def _transfer(state: _State, operand: str, span: Span) -> None:
    """Keep the bytes of a place in a data block, or of one element of an array of bytes."""
    place, element = _PLACE.fullmatch(operand), _ELEMENT.fullmatch(operand)
    if place is not None:
        number = place["number"]
        name = f"DB{int(number)}" if number else (place["db"] or state.opened).strip('"')
        first, (type_, size) = int(place["byte"]), _WIDTHS[place["width"].upper()]
    elif element is not None:
        name, first, type_, size = f"{element['name']}[]", int(element["index"]), "BYTE", 1
    else:
        return
    if not name:
        return
    filled = state.filled.setdefault(name, _Filled())
    data = _bytes(state.constant, type_, size)
    for at in range(size):
        filled.values[first + at] = None if data is None else data[at]
        filled.spans[first + at] = span


def _bytes(constant: str | None, type_: str, size: int) -> bytes | None:
    """Constant of any width as the lowest bytes of the accumulator; None if it is no constant."""
    for wide in ("DWORD", "DINT"):
        try:
            return pack_literal(constant or "", wide)[-size:]
        except LiteralError:
            continue
    try:
        return pack_literal(constant or "", type_)
    except LiteralError:
        return None


def _memory(
    name: str, filled: _Filled, block: str, home: Span | None, buffers: Sequence[FoundBuffer]
) -> Iterator[Bytes]:
    """The bytes of a data block from its first one on, or of an array from the first element that is filled."""
    known = [one for one in buffers if name.upper() in {f"DB{one.block.number}", one.block.name.upper()}]
    whole = not name.endswith("[]")
    first, last = 0 if whole else min(filled.values), max(filled.values)
    if last - first >= LARGEST:
        return
    size = max(last - first + 1, known[0].size if known else 0)
    data = bytearray(size)
    for at, value in filled.values.items():
        data[at - first] = value or 0
    given = frozenset(at - first for at, value in filled.values.items() if value is not None)
    spans = {at - first: span for at, span in filled.spans.items()}
    title = f"{known[0].title} filled in {block}" if known else f"{name.removesuffix('[]')} in {block}"
    yield Bytes(title, bytes(data), given, home or Span(""), spans, known[0] if known else None)
