"""Languages of documents: a text is filed under the one it is in, and under no other."""

from __future__ import annotations

from pathlib import Path

import pytest
from lxml import etree

from plcgen import api

SPEC = """
plc: {{name: Ramps, family: s7-1500, toolchain: tia-v19, languages: [{languages}]}}
drives:
  fan: {{device: sinamics-g120, hardware_id: 270}}
jobs:
  ramp: {{drive: fan, read: [P1120], comment: {{de-DE: "Rampe \'lesen\'"}}, trigger: M50.0}}
"""
RUNNING, NUMBER, JOB = "the job is running", "Anzahl Parameter", "Rampe 'lesen'"


def said(folder: Path, languages: str) -> set[tuple[str, str]]:
    """Language and text of every comment and title in the documents of the spec."""
    (folder / "job.yaml").write_text(SPEC.format(languages=languages), "utf-8")
    assert api.generate(folder / "job.yaml", folder / "out").ok
    found = set()
    for path in (folder / "out" / "xml").glob("*.xml"):
        root = etree.parse(str(path)).getroot()
        found |= {(text.get("Lang"), text.text) for text in root.iter("{*}MultiLanguageText")}
        items = root.iter("{*}MultilingualTextItem")
        found |= {(item.findtext(".//Culture"), item.findtext(".//Text")) for item in items if item.findtext(".//Text")}
    return found


@pytest.mark.parametrize("languages", ["de-DE, en-US", "en-US, de-DE", "zh-CN, de-DE, en-GB"])
def test_what_is_not_translated_is_english_only(languages: str, tmp_path: Path) -> None:
    """Whatever the order of the languages; the comment of a job is in the language that the spec says."""
    english = next(name for name in languages.split(", ") if name.startswith("en"))
    found = said(tmp_path, languages)
    assert {culture for culture, text in found if text == RUNNING} == {english}
    assert ("de-DE", NUMBER) in found
    assert {culture for culture, text in found if text in {JOB, JOB.replace("'", "").replace("  ", " ")}} == {"de-DE"}


def test_a_project_without_english_has_no_place_for_it(tmp_path: Path) -> None:
    """The text source has the comment; the document does not call it German."""
    found = said(tmp_path, "de-DE")
    assert {culture for culture, _ in found} == {"de-DE"}
    assert RUNNING not in {text for _, text in found}
    assert RUNNING in (tmp_path / "out" / "scl" / "Ramp.scl").read_text("utf-8-sig")
    assert (tmp_path / "out" / "xml" / "Ramp.xml").read_text("utf-8-sig").count("Rampe") == 1


def test_the_example_ob_has_the_access_that_genuine_ones_have(tmp_path: Path) -> None:
    """113 of 113 exported OBs of S7-1200/1500 are optimized: with standard access they had start information."""
    said(tmp_path, "en-US")
    text = (tmp_path / "out" / "xml" / "Main.xml").read_text("utf-8-sig")
    assert "<MemoryLayout>Optimized</MemoryLayout>" in text
    assert "{ S7_Optimized_Access := 'TRUE' }" in (tmp_path / "out" / "scl" / "Main.scl").read_text("utf-8-sig")
