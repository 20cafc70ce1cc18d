"""Sheets of an XLSX workbook as rows of text, with bounds: what engineering tools export, whoever sends it.

Only cells are read: no formulas are computed, no links followed, document types refused. Format: ECMA-376 part 1,
SpreadsheetML.
"""

from __future__ import annotations

import io
import re
import zipfile
import zlib
from collections.abc import Callable, Iterator
from xml.parsers import expat

from plcgen.base.diagnostics import PlcgenError
from plcgen.base.paths import trap_in

MAX_PART = 64 * 1024 * 1024
"""Bytes of an unpacked part: a small file may hold a large one."""
MAX_SHEETS = 64
MAX_COLUMNS = 256
_SHEET = re.compile(r"xl/worksheets/sheet([0-9]{0,4})\.xml\Z")
_CELL = re.compile(r"([A-Z]{1,3})([0-9]{1,7})\Z")
_CHUNK = 1 << 16

Row = tuple[int, list[str]]
"""Number of a row, from 1, and its cells as text."""


class Numeral(str):
    """A cell that is a number, as every workbook has it: with a decimal point, without groups."""

    __slots__ = ()


class WorkbookError(PlcgenError, ValueError):
    """The bytes are no workbook, or more than the bounds allow; the message says which."""


def read_sheets(data: bytes, most_rows: int) -> Iterator[list[Row]]:
    """The rows of each sheet, in the order of their files, at most ``most_rows`` of a sheet.

    Raises:
        WorkbookError: see there.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as book:
            for name in book.namelist():
                if trap_in(name):
                    raise WorkbookError(f'it has a part "{name[:80]}": {trap_in(name)}')
            names = sorted((name for name in book.namelist() if _SHEET.match(name)), key=_number)
            if not names:
                raise WorkbookError("it has no sheet")
            strings = _strings(book) if "xl/sharedStrings.xml" in book.namelist() else []
            for name in names[:MAX_SHEETS]:
                yield _rows(book, name, strings, most_rows)
    except (zipfile.BadZipFile, zlib.error, NotImplementedError, RuntimeError, EOFError, OSError) as problem:
        raise WorkbookError("it is not an XLSX file, or it is damaged or encrypted") from problem
    except expat.ExpatError as problem:
        raise WorkbookError(f"one of its parts is not XML: {problem}") from problem


def _number(name: str) -> int:
    match = _SHEET.match(name)
    return int(match[1] or 0) if match else 0


def _parse(
    book: zipfile.ZipFile,
    name: str,
    start: Callable[[str, dict[str, str]], None],
    end: Callable[[str], None],
    text: Callable[[str], None],
) -> None:
    parser = expat.ParserCreate(namespace_separator=" ")
    parser.buffer_text = True

    def refuse(*_: object) -> None:
        raise WorkbookError("it has a document type, which no workbook has")

    parser.StartDoctypeDeclHandler = refuse
    parser.StartElementHandler = lambda tag, found: start(tag.rpartition(" ")[2], found)
    parser.EndElementHandler = lambda tag: end(tag.rpartition(" ")[2])
    parser.CharacterDataHandler = text
    size = 0
    with book.open(name) as part:
        while chunk := part.read(_CHUNK):
            size += len(chunk)
            if size > MAX_PART:
                raise WorkbookError(f"{name} has more than {MAX_PART // 1024 // 1024} MiB")
            parser.Parse(chunk, False)  # noqa: FBT003 - whether it is the last one
    parser.Parse(b"", True)  # noqa: FBT003


def _strings(book: zipfile.ZipFile) -> list[str]:
    """The shared strings: all runs of an item, without what is only a reading aid."""
    found: list[str] = []
    state = {"text": False, "aid": 0}

    def start(tag: str, _: dict[str, str]) -> None:
        if tag == "si":
            found.append("")
        state["aid"] += tag == "rPh"
        state["text"] = tag == "t" and not state["aid"]

    def end(tag: str) -> None:
        state["aid"] -= tag == "rPh"
        state["text"] = False

    def text(piece: str) -> None:
        if state["text"] and found:
            found[-1] += piece

    _parse(book, "xl/sharedStrings.xml", start, end, text)
    return found


class _SheetRows:
    """Handlers of a sheet, and its rows."""

    def __init__(self, strings: list[str], most_rows: int) -> None:
        self.rows: list[Row] = []
        self._strings, self._most = strings, most_rows
        self._column, self._kind, self._text, self._inside = 0, "", "", False

    def start(self, tag: str, found: dict[str, str]) -> None:
        """A row or a cell begins, or what a cell holds."""
        if tag == "row":
            if len(self.rows) >= self._most:
                raise WorkbookError(f"a sheet has more than {self._most} rows")
            last = self.rows[-1][0] if self.rows else 0
            number = found.get("r", "")
            self.rows.append((int(number) if number.isascii() and number.isdigit() else last + 1, []))
        elif tag == "c" and self.rows:
            place = _CELL.match(found.get("r", ""))
            self._column = _column(place[1]) if place else len(self.rows[-1][1])
            self._kind, self._text = found.get("t", ""), ""
        self._inside = tag in {"v", "t"}

    def end(self, tag: str) -> None:
        """A cell is complete."""
        self._inside = False
        if tag == "c" and self.rows and self._column < MAX_COLUMNS:
            cells = self.rows[-1][1]
            cells += [""] * (self._column + 1 - len(cells))
            cells[self._column] = self._value()

    def text(self, piece: str) -> None:
        """Characters of a value."""
        if self._inside:
            self._text += piece

    def _value(self) -> str:
        if self._kind != "s":
            return Numeral(self._text) if self._kind in {"", "n"} else self._text
        number = self._text.strip()
        if not (number.isascii() and number.isdigit() and int(number) < len(self._strings)):
            raise WorkbookError(f'a cell names the shared string "{number[:20]}", which is not there')
        return self._strings[int(number)]


def _rows(book: zipfile.ZipFile, name: str, strings: list[str], most_rows: int) -> list[Row]:
    sheet = _SheetRows(strings, most_rows)
    _parse(book, name, sheet.start, sheet.end, sheet.text)
    return sheet.rows


def _column(letters: str) -> int:
    """A column from 0 by its letters."""
    number = 0
    for letter in letters:
        number = number * 26 + ord(letter) - ord("A") + 1
    return number - 1
