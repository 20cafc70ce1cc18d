"""The first sheet of an XLSX workbook, read after ECMA-376 part 1 and without the writer's code; bounded."""

from __future__ import annotations

import io
import zipfile
import zlib
from typing import TYPE_CHECKING

from plcgen.simaticml.reading.xml import children, local, parse_xml

if TYPE_CHECKING:
    from lxml.etree import _Element as Element

MAX_PART = 16 * 1024 * 1024
"""Bytes of a part when it is unpacked."""
_STRINGS, _SHEET = "xl/sharedStrings.xml", "xl/worksheets/sheet1.xml"


def first_sheet(data: bytes, file: str) -> list[list[str]]:
    """Rows of cells that are shared strings.

    Raises:
        ValueError: if it is no such workbook.
        DiagnosticError: if a part is no XML, or not only that.
    """
    strings = ["".join(map(str, item.itertext())) for item in children(parse_xml(_part(data, _STRINGS), file))]
    sheet = parse_xml(_part(data, _SHEET), file)
    rows = (row for part in children(sheet) if local(part) == "sheetData" for row in children(part))
    return [[strings[_index(cell, len(strings))] for cell in children(row)] for row in rows]


def _part(data: bytes, name: str) -> bytes:
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as book, book.open(name) as part:
            found = part.read(MAX_PART + 1)
    except (zipfile.BadZipFile, zlib.error, KeyError, EOFError, OSError, RuntimeError, NotImplementedError) as problem:
        raise ValueError(f"it is no workbook: {problem}") from problem
    if len(found) > MAX_PART:
        raise ValueError(f"{name} is larger than 16 MiB")
    return found


def _index(cell: Element, count: int) -> int:
    """Which of ``count`` strings a cell shows."""
    value = next((each.text or "" for each in children(cell) if local(each) == "v"), "")
    if cell.get("t") != "s" or not value.isdecimal() or len(value) > 9 or int(value) >= count:
        raise ValueError(f"the cell {cell.get('r')} is no text")
    return int(value)
