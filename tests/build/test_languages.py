"""Languages of documents: a text is filed under the one it is in, and under no other."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest
from lxml import etree

from plcgen import api
from plcgen.base.resources import templates_dir
from plcgen.build.phrases import translated
from plcgen.ds47.devices import device_names, find_device

SPEC = """
plc: {{name: Ramps, sources: per_block, family: s7-1500, toolchain: tia-v19, languages: [{languages}]}}
drives:
  fan: {{device: sinamics-g120, hardware_id: 270}}
jobs:
  ramp: {{drive: fan, read: [P1120], comment: {{de-DE: "Rampe \'lesen\'"}}, trigger: M50.0}}
"""
LAEUFT, INTERNAL = "der Auftrag läuft", "what goes with every telegram"
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
def test_every_text_is_in_its_own_language(languages: str, tmp_path: Path) -> None:
    """Whatever the order of the languages; the comment of a job is in the language that the spec says."""
    english = next(name for name in languages.split(", ") if name.startswith("en"))
    found = said(tmp_path, languages)
    assert {culture for culture, text in found if text == RUNNING} == {english}
    assert {culture for culture, text in found if text == LAEUFT} == {"de-DE"}
    assert {culture for culture, text in found if text == INTERNAL} == {english}
    assert ("de-DE", NUMBER) in found
    assert {culture for culture, text in found if text in {JOB, JOB.replace("'", "").replace("  ", " ")}} == {"de-DE"}


def test_a_project_without_english(tmp_path: Path) -> None:
    """What the engine says to itself has no place in the documents, and what it says to its user is German."""
    found = said(tmp_path, "de-DE")
    assert {culture for culture, _ in found} == {"de-DE"}
    texts = {text for _, text in found}
    assert not {RUNNING, INTERNAL} & texts
    assert LAEUFT in texts
    source = (tmp_path / "out" / "scl" / "Ramp.scl").read_text("utf-8-sig")
    assert f"busy : Bool;  // {LAEUFT}" in source
    assert INTERNAL in source
    assert (tmp_path / "out" / "xml" / "Ramp.xml").read_text("utf-8-sig").count("Rampe") == 1


PLANT = """
plc: {{name: Plant, sources: per_block, family: s7-1500, toolchain: tia-v19, languages: [{languages}]}}
drives:
  fan: {{device: sinamics-g120, hardware_id: 270, drive_object: 1}}
  dcm: {{device: sinamics-dcm, hardware_id: 271}}
  cu: {{device: sinamics-s120, hardware_id: 272}}
recipes: {{product: {{parameters: [P1120], records: 2}}}}
jobs:
  watch: {{drive: fan, read: [actual_speed, "r947[0..3]"], trigger: M50.0}}
  ramps: {{drive: fan, write: {{P1120: null, P1121: 5.0}}, verify: readback}}
  pinned: {{drive: dcm, write: {{P50303: 1.0}}, request: {{db: 5}}, response: {{db: 6}}}}
  keep: {{drive: fan, save: drive_object}}
  load: {{drive: fan, write_recipe: product}}
  stops: {{drive: cu, faults: current}}
  past: {{drive: cu, alarms: current}}
"""
USED = ("DriveJobs", "Main", "DriveCalls", "DriveJobTags", "Watch", "Ramps", "Pinned", "Keep", "Load", "Stops", "Past")
INNER = {"Static", "Temp", "Constant"}


def shown(folder: Path, languages: str) -> dict[str, list[dict[str, str]]]:
    """What a user of the jobs sees: for each document of theirs, comments and titles by culture."""
    (folder / "job.yaml").write_text(PLANT.format(languages=languages), "utf-8")
    assert api.generate(folder / "job.yaml", folder / "out").ok
    found = {}
    for name in USED:
        root = etree.parse(str(folder / "out" / "xml" / f"{name}.xml")).getroot()
        sections = [s for s in root.iter("{*}Section") if name == "DriveJobs" or s.get("Name") not in INNER]
        comments = [c for s in sections for c in s.iter("{*}Comment")]
        texts = [{t.get("Lang"): t.text for t in c.iter("{*}MultiLanguageText")} for c in comments]
        for group in root.iter("{*}MultilingualText"):
            items = {
                item.findtext(".//Culture"): item.findtext(".//Text") for item in group.iter("{*}MultilingualTextItem")
            }
            texts.append({culture: text for culture, text in items.items() if text})
        found[name] = [text for text in texts if text]
    return found


def test_german_and_chinese_are_as_complete_as_english(tmp_path: Path) -> None:
    """Every comment and title of jobs, DriveJobs, Main, caller and tags is there in all three; none is copied."""
    for name, texts in shown(tmp_path, "en-US, de-DE, zh-CN").items():
        assert texts, name
        for text in texts:
            assert set(text) == {"en-US", "de-DE", "zh-CN"}, (name, text)
            assert len(set(text.values())) == 3 or not text["en-US"].strip("rP[]0123456789.:, "), (name, text)


def test_the_first_language_is_that_of_the_sources(tmp_path: Path) -> None:
    """No line without Chinese in what a user reads of a Chinese project."""
    shown(tmp_path, "zh-CN")
    lines = [
        line for name in ("scl/Watch.scl", "db/DriveJobs.db", "scl/Main.scl")
        for line in (tmp_path / "out" / name).read_text("utf-8-sig").partition("END_VAR\n\nVAR\n")[0].splitlines()
        if "//" in line or "TITLE" in line or "REGION " in line
    ]  # fmt: skip
    assert len(lines) > 20
    assert [line for line in lines if not re.search("[\u4e00-\u9fff]", line)] == []


def test_languages_that_nobody_translated(tmp_path: Path) -> None:
    """French first: sources have the next language, documents have no French."""
    texts = shown(tmp_path, "fr-FR, de-DE")
    assert {culture for found in texts.values() for text in found for culture in text} == {"de-DE"}
    assert f"// {LAEUFT}" in (tmp_path / "out" / "scl" / "Watch.scl").read_text("utf-8-sig")


OWN = """
plc: {{name: Own, sources: per_block, family: s7-1500, toolchain: tia-v19, languages: [{languages}]}}
drives:
  axis:
    device: sinamics-s120
    hardware_id: 281
    drive_object: 3
    parameters: {{P3120: {{type: Unsigned16, array: 4}}, P3121: {{type: Unsigned16, title: Pull, unit: N}}}}
recipes: {{spool: {{parameters: [P3121], records: {{small: {{P3121: 1}}, large: {{P3121: 2}}}}}}}}
jobs:
  change:
    drive: axis
    write: {{P3121.2: null, P3121.5: 1}}
    verify: readback
    on_error: restore
    comment: {{de-DE: Seilzug, zh-CN: 张力, en-US: Rope}}
  check: {{drive: axis, compare: {{"P3120[2]": 3, P3121: null}}}}
  course:
    drive: axis
    sequence: [{{write: {{P3121: 1}}}}, {{until: {{P3121: 1, "P3120[0]": 2}}}}, {{read: [P3121]}}]
  keep: {{drive: axis, save: drive_object}}
  switch: {{drive: axis, activate: input}}
  load: {{drive: axis, write_recipe: spool, verify: readback, on_error: restore}}
"""
STATE = {
    "en-US": "reads r899 CO/BO: Status word sequence control",
    "de-DE": "liest r899 CO/BO: Zustandswort Ablaufsteuerung",
    "zh-CN": "读取 r899 CO/BO: 顺序控制状态字",
}
HEADERS = {
    "en-US": ["1: remembers P3121 Pull", f"2: {STATE['en-US']}", "3: writes P3121.2, .5 Pull",
              "4: reads back P3121 Pull", f"5: {STATE['en-US']}"],
    "de-DE": ["1: merkt sich P3121 Pull", f"2: {STATE['de-DE']}", "3: schreibt P3121.2, .5 Pull",
              "4: liest zurück P3121 Pull", f"5: {STATE['de-DE']}"],
    "zh-CN": ["1：记住 P3121 Pull", f"2：{STATE['zh-CN']}", "3：写入 P3121.2, .5 Pull",
              "4：回读 P3121 Pull", f"5：{STATE['zh-CN']}"],
}  # fmt: skip
COMMENTS = {"de-DE": "Seilzug", "zh-CN": "张力", "en-US": "Rope"}
ENGLISH = re.compile(r"\b(writes|reads|compares|remembers|step|waits|value|last|bit|state|restore|activated)\b")


def others_of(order: list[str]) -> list[str]:
    """The comment of the job in all languages but the first."""
    return [COMMENTS[name] for name in order[1:]]


@pytest.mark.parametrize("first", [0, 1, 2])
def test_a_title_that_nobody_translated_stays_in_its_frame(first: int, tmp_path: Path) -> None:
    """Whichever language is the first: header, interface and DriveJobs are whole in all three, in no mixture."""
    order = [*HEADERS][first:] + [*HEADERS][:first]
    (tmp_path / "job.yaml").write_text(OWN.format(languages=", ".join(order)), "utf-8")
    assert api.generate(tmp_path / "job.yaml", tmp_path / "out").ok
    source = (tmp_path / "out" / "scl" / "Change.scl").read_text("utf-8-sig")
    own = COMMENTS[order[0]]
    assert re.findall("^// (.*)$|^TITLE = (.*)$", source, re.MULTILINE) == [
        ("", own),
        *((t, "") for t in others_of(order) + HEADERS[order[0]]),
    ]
    for name in ("Change", "Check", "Course", "Keep", "Switch", "Load", "DriveJobs", "typeChange_Request2"):
        root = etree.parse(str(tmp_path / "out" / "xml" / f"{name}.xml")).getroot()
        sections = [s for s in root.iter("{*}Section") if name == "DriveJobs" or s.get("Name") not in INNER]
        texts = [
            {t.get("Lang"): t.text for t in c.iter("{*}MultiLanguageText")}
            for s in sections
            for c in s.iter("{*}Comment")
        ]
        groups = [group.iter("{*}MultilingualTextItem") for group in root.iter("{*}MultilingualText")]
        texts += [{item.findtext(".//Culture"): item.findtext(".//Text") for item in group} for group in groups]
        for text in (text for text in texts if any(text.values())):
            assert set(text) == {*HEADERS}, (name, text)
            assert not [t for language, t in text.items() if language != "en-US" and ENGLISH.search(t)], (name, text)
            others = [t for language, t in text.items() if language not in {"zh-CN", order[0]}]
            assert not re.search("[\u4e00-\u9fff]", "".join(others)), (name, text)
        if name == "Change":
            found = [{language: (text or "").split("\n") for language, text in one.items()} for one in texts]
            wanted = {language: [*lines] for language, lines in HEADERS.items()}
            for language in order[1:]:
                wanted[language].insert(0, COMMENTS[language])
            wanted[order[0]] = others_of(order) + wanted[order[0]]  # the text of the source
            assert wanted in found


@pytest.mark.slow
@pytest.mark.parametrize("languages", ["de-DE", "zh-CN, en-US", "fr-FR, de-DE"])
def test_what_is_generated_in_other_languages_is_verified(languages: str, tmp_path: Path) -> None:
    """Sources and documents are the same blocks, and the headers are what the spec says."""
    shown(tmp_path, languages)
    assert api.verify(tmp_path / "job.yaml", tmp_path / "out", faults="none").ok


def test_every_title_of_the_catalogue_is_translated() -> None:
    """Also those of parameters that no test uses; an unknown title stays as it is."""
    titles = {p.title for name in device_names() for p in find_device(name).parameters.values()}
    assert sorted(title for title in titles if set(translated(f"P1 {title} [s]")) != {"de", "zh"}) == []
    assert translated("P1 Something of your own [s]") == dict.fromkeys(("de", "zh"), "P1 Something of your own [s]")


def test_every_phrase_has_two_translations() -> None:
    """The places of a phrase are those of its translations."""
    for path in templates_dir().glob("*/phrases.toml"):
        for text, translations in tomllib.loads(path.read_text("utf-8")).items():
            places = sorted(re.findall(r"{(\w+)}", text))
            assert [sorted(re.findall(r"{(\w+)}", one)) for one in translations] == [places, places], text


def test_the_example_ob_has_the_access_that_genuine_ones_have(tmp_path: Path) -> None:
    """113 of 113 exported OBs of S7-1200/1500 are optimized: with standard access they had start information."""
    said(tmp_path, "en-US")
    assert "{ S7_Optimized_Access := 'TRUE' }" in (tmp_path / "out" / "scl" / "Main.scl").read_text("utf-8-sig")
