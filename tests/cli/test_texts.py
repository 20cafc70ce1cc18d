"""plcgen texts: lists for an HMI, held against what public exports look like."""

from __future__ import annotations

import csv
import re
import zipfile
from itertools import pairwise
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

from plcgen.ds47.hmi.lists import LANGUAGES, text_lists, translations
from plcgen.ds47.wire.errors import known_numbers
from plcgen.ds47.words import STATUS_WORDS

MAIN = "{http://schemas.openxmlformats.org/spreadsheetml/2006/main}"


def sheet(path: Path, number: int) -> list[list[str]]:
    """Rows of a sheet, read after ECMA-376 and without the writer's code."""
    with zipfile.ZipFile(path) as book:
        strings = ["".join(found.itertext()) for found in ET.fromstring(book.read("xl/sharedStrings.xml"))]
        rows = ET.fromstring(book.read(f"xl/worksheets/sheet{number}.xml"))
    return [[strings[int(cell[0].text or "")] for cell in row] for row in rows.iter(f"{MAIN}row")]


def test_the_workbook_is_that_of_an_export(plcgen):
    """Headings and first cells as in HMITextLists.xlsx of dpaspa/blk at d17e308, with two of its eleven languages."""
    done = plcgen("texts", "--language", "en-US", "--language", "de-DE")
    assert (done.code, done.out, done.err) == (0, "", "texts: 1 written, 0 unchanged\n")
    path = Path("texts/HMITextLists.xlsx")
    lists, entries = sheet(path, 1), sheet(path, 2)
    assert lists[0] == ["Name", "ListRange", "Comment [en-US]", "Comment [de-DE]"]
    assert lists[1] == ["DriveJobStatus", "Decimal", "<No value>", "<No value>"]
    assert entries[0] == ["Name", "Parent", "DefaultEntry", "Value", "Text [en-US]", "Text [de-DE]", "FieldInfos"]
    texts = ["job done, no error", "Auftrag fertig, kein Fehler"]
    assert entries[1] == ["Text_list_entry_1", "DriveJobStatus", "", "0", *texts, ""]
    with zipfile.ZipFile(path) as book:
        assert re.search(r'"TIA_Version"><vt:lpwstr[^>]*>1.1<', book.read("docProps/custom.xml").decode())


def test_the_bytes_are_the_same_every_time(plcgen):
    """No time and no order of a dictionary gets into a file; a changed one is kept without --force."""
    plcgen("texts")
    assert plcgen("texts").err == "texts: 0 written, 1 unchanged\n"
    Path("texts/HMITextLists.xlsx").write_bytes(b"mine")
    refused = plcgen("texts")
    assert (refused.code, "PG501" in refused.err) == (1, True)
    assert plcgen("texts", "--force").code == 0


def test_documents_for_openness(plcgen):
    """One a list: From and To are the value in decimal digits, 16#8401 = 8 * 4096 + 4 * 256 + 1 = 33793."""
    assert plcgen("texts", "--format", "xml", "--language", "zh-CN", "--tia", "V19").code == 0
    assert sorted(path.name for path in Path("texts").iterdir()) == [
        "DriveFaultClasses.xml", "DriveJobErrors.xml", "DriveJobStatus.xml", "DriveRecordStatus.xml",
        "DriveValueFormats.xml",
    ]  # fmt: skip
    root = ET.parse("texts/DriveJobStatus.xml").getroot()
    (entry,) = [e for e in root.iter("Hmi.TextGraphicList.TextListEntry") if e.findtext(".//From") == "33793"]
    assert entry.findtext(".//To") == "33793"
    assert entry.findtext(".//Culture") == "zh-CN"
    assert entry.findtext(".//Text") == "<body><p>驱动至少拒绝了一个参数，见 errors</p></body>"
    numbers = [found.get("ID") for found in root.iter() if found.get("ID")]
    assert len(numbers) == len(set(numbers))


def test_the_table(plcgen):
    """A text with < is written as it is; every entry has a text in every language."""
    plcgen("texts", "--format", "csv")
    rows = list(csv.reader(Path("texts/text_lists.csv").read_text("utf-8-sig").splitlines(), delimiter=";"))
    assert rows[0] == ["list", "value", "hex", "en-US", "de-DE", "zh-CN"]
    assert all(cell for row in rows for cell in row)
    (row,) = [row for row in rows if row[2] == "807F"]
    assert row[3] == "write only in commissioning state: any device commissioning state (p0009<>0)"


def test_nothing_lacks_a_translation():
    """Every status word and error number that has an English text has one in each language, and none is left over."""
    known = translations()
    assert list(known["status"]) == [word for _, word, _ in STATUS_WORDS]
    assert tuple(known["error"]) == known_numbers()
    for name in ("status", "result", "error", "fault_class", "record", "format"):
        assert all({*texts, "en"} == set(LANGUAGES) for texts in known[name].values()), name
    assert set(known["came"]) == set(LANGUAGES)


def test_values_are_different():
    """A list with one value twice is refused by the TIA Portal; a WORD ends at 65535."""
    for one in text_lists(["en-US"]):
        values = [entry.value for entry in one.entries]
        assert values == sorted(set(values))
        assert values[-1] <= 0xFFFF


def test_a_class_stands_with_both_its_numbers():
    """CU230P-2 fieldbus function manual p. 48: 900D hex is the braking module; class 14 of a count from 1."""
    texts = {entry.value: entry.texts["en-US"] for entry in text_lists(["en-US"])[3].entries}
    assert texts[0x900D] == texts[14] == "braking module faulted"
    assert texts[0x9013] == "auxiliary unit faulted"


def test_formats_have_their_standard_names():
    """PROFIdrive: 08h FloatingPoint, 43h double word; 73h was 23h (Danfoss MCA 120); 40h, 44h are no types."""
    texts = {entry.value: entry.texts["zh-CN"] for entry in text_lists(["zh-CN"])[4].entries}
    assert (texts[0x08], texts[0x43], texts[0x73], texts[0x23]) == ("FloatingPoint", "DoubleWord", "V2", "V2 (23h)")
    assert texts.keys().isdisjoint({0x40, 0x44})
    assert texts[0] == "尚无"


def test_every_record_status_has_a_text_of_its_own_meaning():
    """A code whose English text differs from that of the code before it has a translation of its own."""
    entries = text_lists(["en-US", "de-DE", "zh-CN"])[2].entries
    assert entries[0].value == 0
    assert {entry.value for entry in entries} >= {0x80B5, 0x80A1, 0x80C3, 0x80FF}
    for before, entry in pairwise(entries):
        same = entry.texts["en-US"] == before.texts["en-US"]
        assert (entry.texts["de-DE"] == before.texts["de-DE"], entry.texts["zh-CN"] == before.texts["zh-CN"]) == (
            same,
            same,
        ), hex(entry.value)


def test_numbers_of_other_makers():
    """What SINAMICS alone says about 65h and up is not told of other drives."""
    sizes = [len(text_lists(["en-US"], errors)[1].entries) for errors in ("sinamics", "profidrive")]
    assert sizes[1] < sizes[0]


@pytest.mark.parametrize("tag", ["fr-FR", "german", "de"])
def test_other_languages_are_refused(plcgen, tag):
    """There is no text in them."""
    told = plcgen("texts", "--language", tag)
    assert (told.code, "en-US, de-DE, zh-CN" in told.err) == (2, True)


def test_an_hmi_gets_the_titles_of_a_device(plcgen, tmp_path):
    """Faults and alarms are two lists, since one number can be both; both titles stand where the kinds of CU differ."""
    plcgen("texts", "--device", "sinamics-g120", "--format", "csv", "--language", "en-US", "-o", tmp_path / "hmi")
    with (tmp_path / "hmi" / "text_lists.csv").open(encoding="utf-8-sig", newline="") as file:
        rows = list(csv.DictReader(file, delimiter=";"))
    texts = {(row["list"], int(row["value"])): row["en-US"] for row in rows}
    assert texts["DriveFaults", 30001] == "F30001 Power unit: Overcurrent"
    assert texts["DriveAlarms", 7012] == "A07012 Drive: Motor temperature model 1/3 overtemperature"
    assert texts["DriveAlarms", 3505] == "A03505 Analog input wire breakage", "F03505 can be set to an alarm"
    assert len(texts) == len(rows)
    assert texts["DriveJobStatus", 0x8401]
    done = plcgen("texts", "--device", "sinamics-v90", "-o", tmp_path / "none")
    assert done.code == 2
    assert "no list of the messages of sinamics-v90 is known" in done.err
    assert not (tmp_path / "none").exists()
