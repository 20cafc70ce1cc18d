"""Tables as an XLSX workbook: the smallest that spreadsheets and the TIA Portal read, and equal bytes every time.

All cells are shared strings, as in the exports of the TIA Portal that docs/hmi.md names; only the default style exists.
Format: ECMA-376 part 1, SpreadsheetML.
"""

from __future__ import annotations

import io
import zipfile
from collections.abc import Mapping, Sequence

_SHEETS = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
_OFFICE = "http://schemas.openxmlformats.org/officeDocument/2006/"
_PACKAGE = "http://schemas.openxmlformats.org/package/2006/"
_FORMATS = "application/vnd.openxmlformats-"
_HEAD = '<?xml version="1.0" encoding="UTF-8" standalone="yes"?>\n'
_EPOCH = (1980, 1, 1, 0, 0, 0)
"""The first date of a ZIP file: the bytes do not depend on the day."""
_FORMAT_ID = "{D5CDD505-2E9C-101B-9397-08002B2CF9AE}"
"""What ECMA-376 part 4 and every writer call custom properties."""


def workbook_bytes(sheets: Mapping[str, Sequence[Sequence[str]]], properties: Mapping[str, str] | None = None) -> bytes:
    """A workbook with a sheet for each name, rows of text; ``properties`` are custom document properties."""
    strings = dict.fromkeys(cell for rows in sheets.values() for row in rows for cell in row)
    numbers = {text: number for number, text in enumerate(strings)}
    parts = {
        "[Content_Types].xml": _types(len(sheets), custom=bool(properties)),
        "_rels/.rels": _roots(custom=bool(properties)),
        "xl/workbook.xml": _book(list(sheets)),
        "xl/_rels/workbook.xml.rels": _parts(len(sheets)),
        **{f"xl/worksheets/sheet{n}.xml": _sheet(rows, numbers) for n, rows in enumerate(sheets.values(), 1)},
        "xl/sharedStrings.xml": _strings(list(strings)),
    }
    if properties:
        parts["docProps/custom.xml"] = _custom(properties)
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as book:  # not compressed: the bytes do not depend on the version of zlib
        for path, text in parts.items():
            part = zipfile.ZipInfo(path, _EPOCH)
            part.create_system = 0  # else it says on which system it was made
            book.writestr(part, _HEAD + text)
    return stream.getvalue()


def _types(sheets: int, *, custom: bool) -> str:
    kinds = [("xl/workbook.xml", "officedocument.spreadsheetml.sheet.main+xml")]
    kinds += [(f"xl/worksheets/sheet{n + 1}.xml", "officedocument.spreadsheetml.worksheet+xml") for n in range(sheets)]
    kinds.append(("xl/sharedStrings.xml", "officedocument.spreadsheetml.sharedStrings+xml"))
    if custom:
        kinds.append(("docProps/custom.xml", "officedocument.custom-properties+xml"))
    overrides = "".join(f'<Override PartName="/{path}" ContentType="{_FORMATS}{kind}"/>' for path, kind in kinds)
    rels = f'<Default Extension="rels" ContentType="{_FORMATS}package.relationships+xml"/>'
    return f'<Types xmlns="{_PACKAGE}content-types">{rels}{overrides}</Types>'


def _relations(targets: Sequence[tuple[str, str]]) -> str:
    lines = (
        f'<Relationship Id="rId{n}" Type="{_OFFICE}relationships/{kind}" Target="{target}"/>'
        for n, (kind, target) in enumerate(targets, 1)
    )
    return f'<Relationships xmlns="{_PACKAGE}relationships">{"".join(lines)}</Relationships>'


def _escaped(text: str) -> str:
    """Text of an element; ``xml.sax.saxutils`` would load an HTTP client and TLS with it."""
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")


def _name(text: str) -> str:
    """An attribute of that name."""
    quoted = _escaped(text).replace('"', "&quot;")
    return f'name="{quoted}"'


def _roots(*, custom: bool) -> str:
    more = [("custom-properties", "docProps/custom.xml")] if custom else []
    return _relations([("officeDocument", "xl/workbook.xml"), *more])


def _parts(sheets: int) -> str:
    found = [("worksheet", f"worksheets/sheet{n + 1}.xml") for n in range(sheets)]
    return _relations([*found, ("sharedStrings", "sharedStrings.xml")])


def _book(names: Sequence[str]) -> str:
    sheets = "".join(f'<sheet {_name(name)} sheetId="{n}" r:id="rId{n}"/>' for n, name in enumerate(names, 1))
    return f'<workbook xmlns="{_SHEETS}" xmlns:r="{_OFFICE}relationships"><sheets>{sheets}</sheets></workbook>'


def _sheet(rows: Sequence[Sequence[str]], numbers: Mapping[str, int]) -> str:
    lines = []
    for at, row in enumerate(rows, 1):
        cells = (f'<c r="{_column(n)}{at}" t="s"><v>{numbers[cell]}</v></c>' for n, cell in enumerate(row))
        lines.append(f'<row r="{at}">{"".join(cells)}</row>')
    return f'<worksheet xmlns="{_SHEETS}"><sheetData>{"".join(lines)}</sheetData></worksheet>'


def _column(number: int) -> str:
    """A column from 0 by its letters: A .. Z, AA .."""
    letters = ""
    number += 1
    while number:
        number, digit = divmod(number - 1, 26)
        letters = chr(ord("A") + digit) + letters
    return letters


def _strings(texts: Sequence[str]) -> str:
    items = "".join(f'<si><t xml:space="preserve">{_escaped(text)}</t></si>' for text in texts)
    return f'<sst xmlns="{_SHEETS}">{items}</sst>'


def _custom(properties: Mapping[str, str]) -> str:
    types = f"{_OFFICE}docPropsVTypes"
    items = "".join(
        f'<property fmtid="{_FORMAT_ID}" pid="{n}" {_name(name)}>'
        f'<vt:lpwstr xmlns:vt="{types}">{_escaped(text)}</vt:lpwstr></property>'
        for n, (name, text) in enumerate(properties.items(), 2)
    )
    return f'<Properties xmlns="{_OFFICE}custom-properties">{items}</Properties>'
