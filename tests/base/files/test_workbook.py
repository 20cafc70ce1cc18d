"""Workbooks from anybody: every part of one is looked at, and nothing in it has no bound."""

from __future__ import annotations

import io
import zipfile

import pytest

from plcgen.base.files import workbook
from plcgen.base.files.workbook import WorkbookError, read_sheets

SHEET = '<worksheet><sheetData><row r="1"><c r="A1"><v>1</v></c></row></sheetData></worksheet>'
PARTS = {
    "[Content_Types].xml": "<Types/>",
    "_rels/.rels": "<Relationships/>",
    "docProps/app.xml": "<Properties/>",
    "xl/workbook.xml": "<workbook/>",
    "xl/_rels/workbook.xml.rels": "<Relationships/>",
    "xl/styles.xml": "<styleSheet/>",
    "xl/sharedStrings.xml": "<sst><si><t>a</t></si></sst>",
    "xl/worksheets/sheet1.xml": SHEET,
    "xl/drawings/vmlDrawing1.vml": "<xml/>",
}
DECLARED = '<?xml version="1.0" encoding="{}"?>'


def book(**changed: bytes | str) -> bytes:
    """A workbook in which parts are other ones."""
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in (PARTS | changed).items():
            archive.writestr(name, text)
    return data.getvalue()


def read(data: bytes) -> list[list[str]]:
    """The cells of the first sheet."""
    return [cells for _, cells in next(iter(list(read_sheets(data, 1000))))]


def test_the_workbook_itself() -> None:
    """It is read as it is, and so is one whose parts are UTF-16 or say that they are ASCII."""
    assert read(book()) == [["1"]]
    for name, text in PARTS.items():
        for declared, encoding in (("utf-16", "utf-16"), ("US-ASCII", "ascii"), ("UTF-8", "utf-8-sig")):
            assert read(book(**{name: (DECLARED.format(declared) + text).encode(encoding)})) == [["1"]]


@pytest.mark.parametrize("name", PARTS)
@pytest.mark.parametrize(
    ("head", "said"),
    [
        ('<!DOCTYPE x [<!ENTITY a "aaaa">]>', "document type"),
        ('<!DOCTYPE x SYSTEM "file:///etc/passwd">', "document type"),
        (DECLARED.format("utf-16") + "<!DOCTYPE x>", "document type"),
        (DECLARED.format("utf-7"), '"utf-7"'),
        (DECLARED.format("cp037"), '"cp037"'),
        (DECLARED.format("iso-8859-1"), '"iso-8859-1"'),
        (DECLARED.format("ascii") + "<!-- \xe4 -->", "not XML"),
        ("<", "not XML"),
    ],
)
def test_a_part_that_no_program_should_open(name: str, head: str, said: str) -> None:
    """Refused whether plcgen needs the part or not."""
    encoding = "utf-16" if '"utf-16"' in head else "utf-8"
    with pytest.raises(WorkbookError, match=said):
        read(book(**{name: (head + PARTS[name]).encode(encoding)}))


@pytest.mark.parametrize("name", PARTS)
def test_a_part_that_is_too_large(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each has a bound, and all of them together: blanks pack to a thousandth."""
    monkeypatch.setattr(workbook, "MAX_PART", 100_000)
    with pytest.raises(WorkbookError, match="MiB"):
        read(book(**{name: PARTS[name] + " " * 200_000}))
    monkeypatch.undo()
    monkeypatch.setattr(workbook._Book, "__init__", _poor)
    with pytest.raises(WorkbookError, match="its XML has more"):
        read(book(**{name: PARTS[name] + " " * 200_000}))


def _poor(self: workbook._Book, archive: zipfile.ZipFile) -> None:
    self.archive, self.room, self.cells = archive, 100_000, 10


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"XL/Workbook.xml": "<workbook/>"}, "two parts"),
        ({f"x{number}": "" for number in range(workbook.MAX_PARTS)}, "parts"),
        ({"xl/sharedStrings.xml": f"<sst><si><t>{'x' * 40_000}</t></si></sst>"}, "32767 characters"),
        ({"xl/worksheets/sheet1.xml": SHEET.replace("<v>1", f"<v>{'1' * 40_000}")}, "32767 characters"),
    ],
)
def test_what_is_too_much(changed: dict[str, str], said: str) -> None:
    """Parts of one name in any letter case, too many of them, cells longer than Excel has them."""
    with pytest.raises(WorkbookError, match=said):
        read(book(**changed))


def test_cells_that_are_not_there_count(monkeypatch: pytest.MonkeyPatch) -> None:
    """A row with nothing but its last cell is 256 cells."""
    monkeypatch.setattr(workbook._Book, "__init__", _poor)
    with pytest.raises(WorkbookError, match="cells"):
        read(book(**{"xl/worksheets/sheet1.xml": SHEET.replace('"A1"', '"IV1"')}))
