"""``tags.xlsx``: the workbook of tags that the TIA Portal exports and imports."""

from __future__ import annotations

import io
import re
import shutil
import xml.etree.ElementTree as ET
import zipfile
from pathlib import Path

from plcgen.project.opening import open_spec
from plcgen.proof.folder import read_folder
from plcgen.proof.tables import check_tables
from tests.projects import FAQ, generated_example

V = "{http://schemas.openxmlformats.org/spreadsheetml/2006/main}v"


def test_the_workbook_of_tags_is_that_of_an_export() -> None:
    """Sheet, titles, cells and property as in the PLCTags.xlsx of Canabis220/Robot; read here without plcgen's code."""
    with zipfile.ZipFile(generated_example(FAQ.stem) / "tags.xlsx") as book:
        strings = ["".join(each.itertext()) for each in ET.fromstring(book.read("xl/sharedStrings.xml"))]
        cells = ET.fromstring(book.read("xl/worksheets/sheet1.xml")).iter(V)
        assert b'<sheet name="PLC Tags" ' in book.read("xl/workbook.xml")
        assert re.search(rb'"TIA_Version"><vt:lpwstr[^>]*>1.0<', book.read("docProps/custom.xml"))
        stable = {(each.compress_type, each.create_system, each.date_time[0]) for each in book.infolist()}
    assert stable == {(zipfile.ZIP_STORED, 0, 1980)}
    rows = [strings[int(cell.text or "")] for cell in cells]
    titles = "Name|Path|Data Type|Logical Address|Comment|Hmi Visible|Hmi Accessible|Hmi Writeable|Typeobject ID"
    assert rows[:10] == [*titles.split("|"), "Version ID"]
    first = "readRampUpExecute|DriveJobTags|Bool|%M50.0|execute: Read the ramp-up time P50303|True|True|True||"
    assert rows[10:20] == first.split("|")
    assert len(rows) == 50


def test_a_workbook_that_says_something_else_is_noticed(tmp_path: Path) -> None:
    """Another address, no workbook at all."""
    made = shutil.copytree(generated_example(FAQ.stem), tmp_path / "made")
    other = io.BytesIO()
    with zipfile.ZipFile(made / "tags.xlsx") as good, zipfile.ZipFile(other, "w") as book:
        for part in good.namelist():
            book.writestr(part, good.read(part).replace(b"%M50.0", b"%M50.1"))
    project = open_spec(FAQ).sound()
    for data, word in ((other.getvalue(), "M50.1"), (b"PK", "not an XLSX file")):
        (made / "tags.xlsx").write_bytes(data)
        (check,) = check_tables(project, read_folder(made, project.target))
        assert "tags.xlsx" in str(check.diagnostic)
        assert word in str(check.diagnostic)
