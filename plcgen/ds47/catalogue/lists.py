"""Parameter lists as engineering tools export them: a row for each parameter or index, columns known by heading.

The expert list of STARTER and SCOUT, saved as CSV, has Parameter, Data, Parameter text, the value, Unit, Modifiable to,
Access level, Minimum, Maximum; the list of Startdrive has Number, Parameter text, Value, Unit. Headings may be English
or German, in any order; the separator is a tab, a semicolon or a comma, or the list is a sheet of an XLSX workbook.
Nobody publishes these formats: what is here follows the windows of the programs, and whatever is no known column is
left alone.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.base.files.text import decoded_list, read_data
from plcgen.base.files.workbook import Numeral, Row, WorkbookError, read_sheets
from plcgen.ds47.catalogue.numbers import decimal_sign, looks_like_number, number

MAX_BYTES = 16 * 1024 * 1024
MAX_ROWS = 200_000
_ZIP = b"PK\x03\x04"
_HEADINGS = 50
"""Rows at the top of a list among which the headings are looked for: some exports begin with a title."""

_COLUMNS = {
    "number": ("parameter", "number", "parameter number", "parameternummer", "nummer", "no.", "nr."),
    "title": ("parameter text", "parametertext", "text", "parameter name", "description", "bezeichnung"),
    "unit": ("unit", "einheit"),
    "min": ("minimum", "min", "min.", "minimum value"),
    "max": ("maximum", "max", "max.", "maximum value"),
    "changeable": ("modifiable to", "änderbar bis", "can be changed"),
    "type": ("data type", "datentyp"),
    "value": ("value", "wert", "actual value", "istwert"),
}
_VALUE = re.compile(r"(online|offline)[ -]?(value|wert)")
_PARAMETER = re.compile(r"([PpRrCc])0*([1-9][0-9]{0,4})(?:\[([0-9]{1,5})\])?\Z")
_BIT = re.compile(r"[PpRrCc][0-9]{1,5}(?:\[[0-9]{1,5}\])?\.[0-9]{1,2}\Z")
_MEANT = re.compile(r"[PpRrCc]? *[0-9]+ *(?:\[.*|\..*)?\Z")
"""What is meant as a parameter; everything else in that column is a heading of a group."""
_NUMBERS = {"min": "minimum", "max": "maximum", "value": "value"}


@dataclass(frozen=True, slots=True)
class ListedParameter:
    """What a list says about one parameter; None and empty where it says nothing.

    ``values`` are by index: numbers, and the text of what is none.
    """

    pnu: int
    letter: str
    line: int
    title: str = ""
    unit: str = ""
    type: str = ""
    changeable: str = ""
    minimum: float | None = None
    maximum: float | None = None
    values: Mapping[int, float | str] = field(default_factory=dict)
    indexes: int | None = None

    @property
    def value(self) -> float | None:
        """The number of index 0."""
        found = self.values.get(0)
        return None if isinstance(found, str) else found


@dataclass(frozen=True, slots=True)
class ParameterList:
    """The parameters of a list by their numbers, and what of it could not be read: a sentence each, with its line."""

    parameters: Sequence[ListedParameter]
    skipped: Sequence[str] = ()


def load_list(path: Path) -> ParameterList:
    """Read an exported list.

    Raises:
        DiagnosticError: PG704 if it is too long or no list, PG110 if it cannot be read.
    """
    return listed(load_sheets(path), path)


def load_sheets(path: Path) -> Sequence[Sequence[Row]]:
    """The rows of a file: one sheet of a CSV, the sheets of a workbook. Raises as ``load_list`` does."""
    if path.suffix.lower() in {".xls", ".ods"}:
        raise wrong(path, f"{path.suffix} files are not supported", "save it as XLSX or CSV")
    data = read_data(path, MAX_BYTES, str(path))
    if len(data) > MAX_BYTES:
        raise wrong(path, f"the file has more than {MAX_BYTES // 1024 // 1024} MiB", "export fewer parameters at once")
    return _book(data, path) if data.startswith(_ZIP) else [list(_rows(decoded_list(data), path))]


def _book(data: bytes, path: Path) -> Sequence[Sequence[Row]]:
    try:
        return list(read_sheets(data, MAX_ROWS))
    except WorkbookError as problem:
        raise wrong(path, f"the workbook cannot be read: {problem}", "export it again, or as CSV") from problem


def parse_list(text: str, path: Path) -> ParameterList:
    """Read the text of a list, parameters in the order of their numbers. Raises DiagnosticError, PG704."""
    return listed([list(_rows(text, path))], path)


def listed(sheets: Sequence[Sequence[Row]], path: Path) -> ParameterList:
    """The parameters of the sheet with the most known headings. Raises DiagnosticError, PG704."""
    return _parsed(max(sheets, key=lambda sheet: len(_headings(sheet)[0])), path)


def _parsed(rows: Sequence[Row], path: Path) -> ParameterList:
    columns, first = _headings(rows)
    if "number" not in columns or len(columns) == 1:
        help_ = "the headings are for example Parameter; Parameter text; Online value; Unit; Minimum; Maximum"
        raise wrong(path, "no row with the headings of a parameter list was found", help_)
    texts = [(line, {key: _cell(cells, at) for key, at in columns.items()}) for line, cells in rows[first:]]
    decimal = decimal_sign(row[key] for _, row in texts for key in _NUMBERS if key in row)
    found: dict[int, ListedParameter] = {}
    lines: dict[str, int] = {}
    skipped: list[str] = []
    for line, row in texts:
        name = row["number"].lower()
        if _BIT.match(name):
            continue
        one = _listed(row, line, decimal, skipped)
        if one is None:
            continue
        if lines.setdefault(name, line) != line:
            skipped.append(f"line {line}: {name} is in the list twice; line {lines[name]} counts")
            continue
        known = found.get(one.pnu)
        found[one.pnu] = one if known is None else _joined(known, one)
    if not found:
        raise wrong(path, "there is no parameter in the list", "a parameter is written like p1120 or r0945[3]")
    return ParameterList([found[pnu] for pnu in sorted(found)], skipped)


def _cell(cells: Sequence[str], at: int) -> str:
    text = cells[at] if at < len(cells) else ""
    return text if isinstance(text, Numeral) else text.strip()


def _rows(text: str, path: Path) -> Iterable[Row]:
    head = "\n".join(text.splitlines()[:_HEADINGS])
    separator = max("\t;,", key=head.count)
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=separator)
    try:
        for cells in reader:
            if reader.line_num > MAX_ROWS:
                raise wrong(path, f"the list has more than {MAX_ROWS} lines", "export fewer parameters at once")
            yield reader.line_num, cells
    except csv.Error as problem:
        raise wrong(path, str(problem), "export the list again", reader.line_num) from problem


def _headings(rows: Sequence[Row]) -> tuple[Mapping[str, int], int]:
    """Columns by what they hold, and the first row behind them: the row of the top with the most known headings."""
    best: tuple[Mapping[str, int], int] = ({}, 0)
    for at, (_, cells) in enumerate(rows[:_HEADINGS]):
        columns: dict[str, int] = {}
        for column, cell in enumerate(cells):
            key = _heading(cell)
            if key is not None:
                columns.setdefault(key, column)
        if len(columns) > len(best[0]):
            best = (columns, at + 1)
    return best


def _heading(cell: str) -> str | None:
    text = " ".join(cell.casefold().split())
    if _VALUE.match(text):
        return "value"
    return next((key for key, names in _COLUMNS.items() if text in names), None)


def _listed(texts: Mapping[str, str], line: int, decimal: str, skipped: list[str]) -> ListedParameter | None:
    """One row; None for a group heading, an empty row, and what is no parameter."""
    name = texts["number"]
    match = _PARAMETER.match(name)
    if match is None or int(match[2]) > 0xFFFF:
        if _MEANT.match(name):
            skipped.append(f"line {line}: {cell_text(name)} is no parameter: p, r or c and a number up to 65535")
        return None
    index = None if match[3] is None else int(match[3])
    numbers = {key: _number(texts.get(key, ""), decimal) for key in _NUMBERS}
    for key, read in numbers.items():
        if isinstance(read, str) and read and (key != "value" or looks_like_number(read)):
            skipped.append(f'line {line}: {_NUMBERS[key]} "{cell_text(read)}" of {name} cannot be read{_why(read)}')
    low, high = (None if isinstance(read, str) else read for read in (numbers["min"], numbers["max"]))
    return ListedParameter(
        pnu=int(match[2]),
        letter=match[1].lower(),
        line=line,
        title=cell_text(texts.get("title", "")),
        unit=cell_text(texts.get("unit", "")).strip("-"),
        type=texts.get("type", ""),
        changeable=cell_text(texts.get("changeable", "")),
        minimum=low,
        maximum=high,
        values={} if numbers["value"] == "" else {index or 0: numbers["value"]},
        indexes=None if index is None else index + 1,
    )


def _number(text: str, decimal: str) -> float | str:
    """The number of a cell, or else its text, empty for a dash."""
    read = number(text, decimal)
    return text.strip("-\N{EN DASH}") and text if read is None else read


def _why(text: str) -> str:
    sure = any(number(text, sign) is not None for sign in ".,")
    return ": no other number shows whether . or , is the decimal sign" if sure else ""


def _joined(known: ListedParameter, other: ListedParameter) -> ListedParameter:
    """Rows of the same parameter: what the first one says, the values of both, the highest index."""
    pairs = {name: getattr(known, name) for name in ListedParameter.__slots__}
    for name, value in pairs.items():
        if value is None or value == "":
            pairs[name] = getattr(other, name)
    counts = [count for count in (known.indexes, other.indexes) if count is not None]
    values = {**other.values, **known.values}
    return replace(ListedParameter(**pairs), values=values, indexes=max(counts) if counts else None)


def cell_text(text: str) -> str:
    """A text as a profile takes it: one printable line of at most 300 characters."""
    return "".join(character for character in " ".join(text.split()) if character.isprintable())[:300]


def wrong(path: Path, message: str, help_: str, line: int = 0) -> DiagnosticError:
    """PG704 at a line of a list."""
    return DiagnosticError([Diagnostic("PG704", message, Span(str(path), line, min(line, 1)), help=help_)])
