"""IMPORT.md, xml/IMPORT.md and LAYOUT.md in the first language of the project."""

from __future__ import annotations

import re
import tomllib
from itertools import pairwise
from pathlib import Path

import pytest

from plcgen import api
from plcgen.base.resources import templates_dir
from plcgen.proof.folder import read_folder
from plcgen.proof.tables import check_tables
from plcgen.proof.wording import check_wording
from plcgen.proof.wording.languages import read_back
from tests.projects import ROOT

GUIDES = ("IMPORT.md", "xml/IMPORT.md", "LAYOUT.md")
SPECS = (
    "s7-300_6ra80_dp_tia", "s7-300_mm440_dp", "s7-1500_g120_pn", "s7-1500_s210_restore", "s7-1200_s120_recipe",
    "s7-1200_s7-200_ppi", "s7-300_s7-200_ppi_cp341",
)  # fmt: skip
"""Every part of a guide is in one of them: V5 and TIA, drives and PPI, flags, recipes, bits, restoring."""
BOOK = tomllib.loads((templates_dir() / "text" / "guide.toml").read_text("utf-8"))
FACTS = re.compile(r"`[^`]+`|\{\w+\}|\d+(?:\.\d+)?|\bDF80B000\b")


def project(folder: Path, name: str, language: str, sources: str = "one") -> Path:
    """The spec of an example in one language, generated."""
    text = (ROOT / "specs" / f"{name}.yaml").read_text("utf-8")
    text = re.sub(r", languages: \[[^\]]*\]", "", text, count=1)
    text = text.replace("plc: {", f"plc: {{sources: {sources}, languages: [{language}], ", 1)
    text = re.sub(r"comment: \{[^}]*\}", f"comment: {{{language}: Wickler 5}}", text)
    spec = folder / f"{language}.yaml"
    spec.write_text(text, "utf-8")
    made = api.generate(spec, folder / language)
    assert made.ok, made.diagnostics
    return spec


def wrong(spec: Path, folder: Path) -> list[str]:
    """What tables and wording of a folder do not say as they must."""
    made = api.check(spec).project
    assert made is not None
    read = read_folder(folder, made.target)
    checks = [*check_wording(made, read), *check_tables(made, read)]
    return [check.verdict for check in checks if check.outcome.value != "ok"]


def lines(folder: Path) -> dict[str, list[str]]:
    """Lines of each guide, a paragraph as one, without code."""
    found = {name: folder / name for name in GUIDES if (folder / name).is_file()}
    texts = {name: re.sub(r"(?ms)^```.*?^```", "", path.read_text("utf-8")) for name, path in found.items()}
    return {name: [line for line in read_back(text, "en").split("\n") if line] for name, text in texts.items()}


def header(rows: list[str]) -> list[str]:
    """Titles of columns: the rows in front of a rule."""
    return [one for one, two in pairwise(rows) if set(two) <= {"|", "-", ":"}]


@pytest.mark.parametrize("part", BOOK)
def test_a_translation_states_what_the_english_text_does(part: str) -> None:
    """Code, places, numbers, and no text twice: two English texts with one translation could not be read back."""
    for english, texts in BOOK[part].items():
        assert len(texts) == 2, english
        for text in texts:
            assert sorted(FACTS.findall(text)) == sorted(FACTS.findall(english)), text
    for column in (0, 1):
        said = [re.sub(r"\{\w+\}", "{}", texts[column]) for texts in BOOK[part].values()]
        assert len(said) == len(set(said)), [text for text in said if said.count(text) > 1]


@pytest.mark.slow
@pytest.mark.parametrize("name", SPECS)
def test_every_heading_and_sentence_has_every_language(name: str, tmp_path: Path) -> None:
    """Line by line beside the English guide: each is another one, and as many; the proof reads it back."""
    for language in ("en-US", "de-DE", "zh-CN"):
        spec = project(tmp_path, name, language)
        assert wrong(spec, tmp_path / language) == []
    english = lines(tmp_path / "en-US")
    for language, same in (("de-DE", {"Parameter", "Text", "Symbol", "Offset", "Name", "Station"}), ("zh-CN", set())):
        found = lines(tmp_path / language)
        for guide, rows in english.items():
            assert len(found[guide]) == len(rows), guide
            for one, two in zip(rows, found[guide], strict=True):
                if not one.startswith("|") and not re.match(r"## \w+: Wickler", one):
                    assert one != two, one
            for one, two in zip(header(rows), header(found[guide]), strict=True):
                cells = zip(one.split("|")[1:-1], two.split("|")[1:-1], strict=True)
                assert [old for old, new in cells if old == new and old.strip().title() not in same] == [], one


@pytest.mark.parametrize("name", ["s7-1500_g120_pn", "s7-300_mm440_dp"])
def test_a_file_for_each_block(name: str, tmp_path: Path) -> None:
    """The guide has the order of the files, under a German heading, and verify finds it."""
    spec = project(tmp_path, name, "de-DE", "per_block")
    assert "\n## Reihenfolge\n" in (tmp_path / "de-DE" / "IMPORT.md").read_text("utf-8")
    assert wrong(spec, tmp_path / "de-DE") == []


NAMES = """
plc: {name: value, family: s7-1500, toolchain: tia-v19, languages: [de-DE]}
drives: {drive: {device: sinamics-g120, hardware_id: 270, parameters: {P2900: {type: FloatingPoint, title: a record}}}}
jobs: {job: {drive: drive, write: {P2900: 1.0}, trigger: M50.0}, number: {drive: drive, read: [r21]}}
"""


def test_names_of_the_spec_are_not_translated(tmp_path: Path) -> None:
    """A drive called drive, a job called job, a title that is a phrase of the book: verify agrees."""
    (tmp_path / "job.yaml").write_text(NAMES, "utf-8")
    assert api.generate(tmp_path / "job.yaml", tmp_path / "out").ok
    text = (tmp_path / "out" / "IMPORT.md").read_text("utf-8")
    assert "| drive | `270` | 1 | 47 |" in text
    assert "| `M50.0` | job | execute |" in text
    assert "| Job | drive | P2900 | a record | 1.0 |" in text
    assert wrong(tmp_path / "job.yaml", tmp_path / "out") == []


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("Beim Ausschalten gehen sie verloren", "Beim Ausschalten bleiben sie"),
        ("Eingang, 10.0, wenn", "Eingang, 11.0, wenn"),
        (" Kennung |", " Adresse |"),
        ("`tags.csv`", "`tags.txt`"),
        ("## Was diese Bausteine schreiben\n", ""),
        ("| `M50.0` |", "| `M50.1` |"),
        ("Rücklaufzeit |", "Hochlaufzeit |"),
    ],
)
def test_a_damaged_german_guide_is_noticed(old: str, new: str, tmp_path: Path) -> None:
    """Another sentence, value, column, file, flag or title is one that nobody states."""
    (tmp_path / "job.yaml").write_text(NAMES.replace("P2900: 1.0", "P1121: {start: 10.0}"), "utf-8")
    assert api.generate(tmp_path / "job.yaml", tmp_path / "out").ok
    guide = tmp_path / "out" / "IMPORT.md"
    text = read_back(guide.read_text("utf-8"), "en")
    assert old in text
    guide.write_text(text.replace(old, new), "utf-8")
    (said,) = wrong(tmp_path / "job.yaml", tmp_path / "out")
    assert "no source for" in said or "is missing" in said


@pytest.mark.parametrize(
    ("written", "cell", "right"),
    [
        ("P1121: 7.0", "| 7.0 |", "| 7 |"),
        ("P1121: {start: 7.0}", "7.0 if", "| input, 7 if nothing is connected |"),
    ],
)
def test_what_a_guide_must_say_is_said_in_its_words(written: str, cell: str, right: str, tmp_path: Path) -> None:
    """The message has the value as the guide has it, not the bytes 40 E0 00 00."""
    text = NAMES.replace("[de-DE]", "[en-US]").replace("P2900: 1.0", f"{written}")
    (tmp_path / "job.yaml").write_text(text, "utf-8")
    assert api.generate(tmp_path / "job.yaml", tmp_path / "out").ok
    guide = tmp_path / "out" / "IMPORT.md"
    guide.write_text(guide.read_text("utf-8").replace(cell, cell.replace("7.0", "8.0")), "utf-8")
    (said,) = wrong(tmp_path / "job.yaml", tmp_path / "out")
    assert right in said.partition("it must say")[2]


def test_a_table_does_not_run_into_what_follows(tmp_path: Path) -> None:
    """Behind every table of a guide is an empty line, or a viewer takes the next paragraph for a row."""
    for name in ("s7-300_6ra80_dp_tia", "s7-1500_g120_pn", "s7-300_s7-200_ppi_cp341"):
        folder = tmp_path / name
        folder.mkdir()
        project(folder, name, "en-US")
        for guide in GUIDES:
            rows = (folder / "en-US" / guide).read_text("utf-8").split("\n")
            for one, two in pairwise(rows):
                assert not one.startswith("|") or two.startswith("|") or not two, two
