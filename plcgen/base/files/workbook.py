"""Sheets of an XLSX workbook as rows of text, with bounds: what engineering tools export, whoever sends it.

Only cells are read: no formulas are computed, no links followed. Document types are refused in every part, and so is
what programs read differently: other encodings, two parts of one name. Format: ECMA-376 part 1, SpreadsheetML.
"""

from __future__ import annotations

import io
import re
import zipfile
import zlib
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from xml.parsers import expat

from plcgen.base.diagnostics import PlcgenError
from plcgen.base.paths import trap_in

MAX_PART = 64 * 1024 * 1024
"""Bytes of an unpacked part: a small file may hold a large one."""
MAX_BOOK = 4 * MAX_PART
"""Bytes of all its XML."""
MAX_PARTS = 4096
MAX_TEXT = 32_767
"""Characters of a cell, as in Excel."""
MAX_CELLS = 8_000_000
"""Cells of all sheets, those between two that are there included."""
MAX_SHEETS = 64
MAX_COLUMNS = 256
_SHEET = re.compile(r"xl/worksheets/sheet([0-9]{0,4})\.xml\Z")
_CELL = re.compile(r"([A-Z]{1,3})([0-9]{1,7})\Z")
_XML = (".xml", ".rels", ".vml")
_ENCODINGS = frozenset({"UTF-8", "UTF-16", "US-ASCII", "ASCII"})
"""What a part may declare (ECMA-376 part 2), and what is the same bytes."""
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
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            book = _Book(archive)
            book.check()
            names = sorted((name for name in archive.namelist() if _SHEET.match(name)), key=_number)
            if not names:
                raise WorkbookError("it has no sheet")
            strings = _strings(book) if _STRINGS in archive.namelist() else []
            for name in names[:MAX_SHEETS]:
                yield _rows(book, name, strings, most_rows)
    except (zipfile.BadZipFile, zlib.error, NotImplementedError, RuntimeError, EOFError, OSError) as problem:
        raise WorkbookError("it is not an XLSX file, or it is damaged or encrypted") from problem
    except expat.ExpatError as problem:
        raise WorkbookError(f"one of its parts is not XML: {problem}") from problem


def _number(name: str) -> int:
    match = _SHEET.match(name)
    return int(match[1] or 0) if match else 0


def _nothing(*_: object) -> None:
    """A handler of what is not needed."""


@dataclass(slots=True)
class _Book:
    """A workbook with what may still be read of it, in bytes and cells."""

    archive: zipfile.ZipFile
    room: int = MAX_BOOK
    cells: int = MAX_CELLS

    def check(self) -> None:
        """Look at its names, and at the XML of every part that is not read: who opens it sees the same."""
        names = self.archive.namelist()
        if len(names) > MAX_PARTS:
            raise WorkbookError(f"it has more than {MAX_PARTS} parts")
        for name in names:
            if trap_in(name):
                raise WorkbookError(f'it has a part "{name[:80]}": {trap_in(name)}')
        twice = next((name for name, count in Counter(map(str.lower, names)).items() if count > 1), None)
        if twice is not None:
            raise WorkbookError(f'it has two parts "{twice[:80]}"')
        for name in names:
            if name.lower().endswith(_XML) and not _SHEET.match(name) and name != _STRINGS:
                self.parse(name, _nothing, _nothing, _nothing)

    def parse(
        self,
        name: str,
        start: Callable[[str, dict[str, str]], None],
        end: Callable[[str], None],
        text: Callable[[str], None],
    ) -> None:
        """Hand what is in a part to these handlers."""
        parser = expat.ParserCreate(namespace_separator=" ")
        parser.buffer_text = True
        parser.XmlDeclHandler = _check_encoding
        parser.StartDoctypeDeclHandler = _refuse_doctype
        parser.StartElementHandler = lambda tag, found: start(tag.rpartition(" ")[2], found)
        parser.EndElementHandler = lambda tag: end(tag.rpartition(" ")[2])
        parser.CharacterDataHandler = text
        size = 0
        with self.archive.open(name) as part:
            while chunk := part.read(_CHUNK):
                size += len(chunk)
                self.room -= len(chunk)
                if size > MAX_PART or self.room < 0:
                    what, most = (name[:80], MAX_PART) if size > MAX_PART else ("its XML", MAX_BOOK)
                    raise WorkbookError(f"{what} has more than {most // 1024 // 1024} MiB")
                parser.Parse(chunk, False)  # noqa: FBT003 - whether it is the last one
        parser.Parse(b"", True)  # noqa: FBT003


def _refuse_doctype(*_: object) -> None:
    raise WorkbookError("it has a document type, which no workbook has")


def _check_encoding(_version: str, encoding: str | None, _standalone: int) -> None:
    if encoding is not None and encoding.upper() not in _ENCODINGS:
        raise WorkbookError(f'one of its parts is in "{encoding[:20]}": they are UTF-8 or UTF-16')


_STRINGS = "xl/sharedStrings.xml"


def _longer(text: str, piece: str) -> str:
    if len(text) + len(piece) > MAX_TEXT:
        raise WorkbookError(f"a cell has more than {MAX_TEXT} characters")
    return text + piece


def _strings(book: _Book) -> list[str]:
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
            found[-1] = _longer(found[-1], piece)

    book.parse(_STRINGS, start, end, text)
    return found


class _SheetRows:
    """Handlers of a sheet, and its rows."""

    def __init__(self, book: _Book, strings: list[str], most_rows: int) -> None:
        self.rows: list[Row] = []
        self._book = book
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
            new = max(0, self._column + 1 - len(cells))
            self._book.cells -= new
            if self._book.cells < 0:
                raise WorkbookError(f"it has more than {MAX_CELLS} cells")
            cells += [""] * new
            cells[self._column] = self._value()

    def text(self, piece: str) -> None:
        """Characters of a value."""
        if self._inside:
            self._text = _longer(self._text, piece)

    def _value(self) -> str:
        if self._kind != "s":
            return Numeral(self._text) if self._kind in {"", "n"} else self._text
        number = self._text.strip()
        if not (number.isascii() and number.isdigit() and int(number) < len(self._strings)):
            raise WorkbookError(f'a cell names the shared string "{number[:20]}", which is not there')
        return self._strings[int(number)]


def _rows(book: _Book, name: str, strings: list[str], most_rows: int) -> list[Row]:
    sheet = _SheetRows(book, strings, most_rows)
    book.parse(name, sheet.start, sheet.end, sheet.text)
    return sheet.rows


def _column(letters: str) -> int:
    """A column from 0 by its letters."""
    number = 0
    for letter in letters:
        number = number * 26 + ord(letter) - ord("A") + 1
    return number - 1
