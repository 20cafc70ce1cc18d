"""Symbol tables of STEP 7-Micro/WIN: Symbol, Address, Comment, as the program exports or copies them.

Columns may be separated by tabs, semicolons or commas; there may be a header row (in any order, English, German or
Chinese) and leading empty or marker columns. The text may be UTF-8, UTF-16 or Windows-1252, with or without a byte
order mark. Symbols are found in any letter case, as Micro/WIN does.
"""

from __future__ import annotations

import csv
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Note, Report, Span
from plcgen.base.diagnostics.suggest import Vocabulary
from plcgen.base.files.files import read_bounded
from plcgen.base.files.lookalikes import disguise, skeleton
from plcgen.base.files.text import decoded_list
from plcgen.ppi.wire.address import PpiAddressError, parse_item
from plcgen.ppi.wire.model import Item

MAX_BYTES = 16 * 1024 * 1024
"""Largest file that is read; Micro/WIN has some thousand symbols at most."""

_HEADERS = {
    "symbol": "symbol", "name": "symbol", "symbolname": "symbol", "symbol name": "symbol", "符号": "symbol",
    "address": "address", "adresse": "address", "addr": "address", "operand": "address", "地址": "address",
    "comment": "comment", "kommentar": "comment", "注释": "comment",
}  # fmt: skip
_ONE_SCRIPT = "write the whole name in the letters of one script, in Micro/WIN too"
_HELP = "columns are Symbol, Address, Comment, separated by tabs, semicolons or commas"


@dataclass(frozen=True, slots=True)
class PpiSymbol:
    """One symbol: name, item, comment and the line it stands in (from 1)."""

    name: str
    item: Item
    comment: str
    line: int


@dataclass(frozen=True)
class SymbolTable:
    """Symbols by name, letter case ignored."""

    symbols: tuple[PpiSymbol, ...]
    _index: dict[str, PpiSymbol] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self._index.update({symbol.name.casefold(): symbol for symbol in self.symbols})

    @cached_property
    def names(self) -> Vocabulary:
        """Names in the order of the table."""
        return Vocabulary(symbol.name for symbol in self.symbols)

    def find(self, name: str) -> PpiSymbol | None:
        """Return the symbol of this name."""
        return self._index.get(name.strip().strip('"').casefold())


def load_symbols(path: Path) -> SymbolTable:
    """Read a file. Raises DiagnosticError with every problem, OSError if it cannot be read."""
    data = read_bounded(path, MAX_BYTES)
    if len(data) > MAX_BYTES:
        limit = f"the file has more than {MAX_BYTES // 1024 // 1024} MiB"
        raise DiagnosticError([Diagnostic("PG717", limit, Span(str(path)), help=_HELP)])
    return parse_symbols(decoded_list(data), str(path))


def parse_symbols(text: str, name: str = "<symbols>") -> SymbolTable:
    """Read the text of a symbol table. Raises DiagnosticError with every problem, each at its line and column."""
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    # what most lines contain; commas stand in comments too, so they come last
    separator = max("\t;,", key=lambda mark: (sum(mark in line for line in lines), "\t;,"[::-1].index(mark)))
    rows = [(number, _cells(line, separator)) for number, line in enumerate(lines, 1) if line.strip()]
    report = Report()
    columns = _columns(rows)
    if columns is None:
        report.add(Diagnostic("PG717", "no column of addresses was found", Span(name), help=_HELP))
        raise DiagnosticError(report.sorted())
    found: dict[str, PpiSymbol] = {}
    looks: dict[str, PpiSymbol] = {}
    for number, cells in rows:
        symbol = _symbol(name, number, cells, columns, report)
        if symbol is None:
            continue
        pretended, twin = disguise(symbol.name), looks.setdefault(skeleton(symbol.name), symbol)
        if pretended:
            message = f'the symbol "{symbol.name}" {pretended}'
            report.add(Diagnostic("PG414", message, _span(name, number, cells[columns[0]]), help=_ONE_SCRIPT))
        elif twin.name.casefold() != symbol.name.casefold():
            notes = (Note("the first one is here", Span(name, twin.line, 1)),)
            message = f'the symbol "{symbol.name}" looks like "{twin.name}" in other letters'
            report.add(
                Diagnostic("PG414", message, _span(name, number, cells[columns[0]]), help=_ONE_SCRIPT, notes=notes)
            )
        first = found.setdefault(symbol.name.casefold(), symbol)
        if first is not symbol and first.item != symbol.item:
            notes = (Note("the first one is here", Span(name, first.line, 1)),)
            message = f'the symbol "{symbol.name}" appears twice'
            report.add(Diagnostic("PG717", message, _span(name, number, cells[columns[0]]), notes=notes))
    report.raise_on_errors()
    return SymbolTable(tuple(found.values()))


@dataclass(frozen=True, slots=True)
class _Cell:
    """Text of a cell and the column in the line where it starts (from 1)."""

    text: str
    column: int


def _cells(line: str, separator: str) -> list[_Cell]:
    cells: list[_Cell] = []
    column = 1
    try:
        texts = next(csv.reader([line], delimiter=separator, skipinitialspace=True))
    except (csv.Error, StopIteration):
        texts = line.split(separator)
    for text in texts:
        at = line.find(text.split('"')[0], column - 1) + 1 if text else column
        cells.append(_Cell(text.strip(), max(at, column)))
        column = max(at, column) + len(text) + 1
    return cells


def _columns(rows: list[tuple[int, list[_Cell]]]) -> tuple[int, int, int] | None:
    """Columns of symbol, address and comment: from the header row, else from where the addresses are."""
    for _, cells in rows[:10]:
        known = {_HEADERS.get(cell.text.strip().casefold(), ""): index for index, cell in enumerate(cells)}
        if "symbol" in known and "address" in known:
            return known["symbol"], known["address"], known.get("comment", len(cells))
    counts: dict[int, int] = {}
    for _, cells in rows:
        for index, cell in enumerate(cells):
            counts[index] = counts.get(index, 0) + _is_address(cell.text)
    best = max(counts, key=lambda index: (counts[index], index), default=0)
    if not counts or counts[best] == 0 or best == 0:
        return None
    return best - 1, best, best + 1


def _is_address(text: str) -> bool:
    try:
        parse_item(text)
    except PpiAddressError:
        return False
    return True


def _symbol(
    name: str, number: int, cells: list[_Cell], columns: tuple[int, int, int], report: Report
) -> PpiSymbol | None:
    """Read one row; None for a header, a row without symbol and address, and one that is wrong."""
    empty = _Cell("", 1)
    symbol, address, comment = (cells[index] if index < len(cells) else empty for index in columns)
    if _HEADERS.get(symbol.text.casefold()) == "symbol" and _HEADERS.get(address.text.casefold()) == "address":
        return None
    if not symbol.text or not address.text:
        if symbol.text or address.text:
            missing = "address" if symbol.text else "symbol"
            cell = symbol if symbol.text else address
            report.add(Diagnostic("PG717", f"the {missing} is missing", _span(name, number, cell), help=_HELP))
        return None
    try:
        return PpiSymbol(symbol.text, parse_item(address.text), comment.text, number)
    except PpiAddressError as problem:
        report.add(Diagnostic("PG717", problem.message, _span(name, number, address), help=problem.help))
        return None


def _span(name: str, number: int, cell: _Cell) -> Span:
    return Span(name, number, cell.column, number, cell.column + max(len(cell.text), 1))
