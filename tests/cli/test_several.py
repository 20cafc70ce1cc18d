"""Several specs and folders in one call of check, generate and verify."""

import errno
import json
import os
import re
import shutil
from xml.etree import ElementTree as ET

import pytest

from plcgen.project.below import specs_below
from tests.projects import ROOT


@pytest.fixture
def machines(tmp_path, good):
    """A folder with two specs, and YAML files that are none."""
    folder = tmp_path / "machines"
    (folder / "hall2" / ".hidden").mkdir(parents=True)
    shutil.copy(tmp_path / good, folder / "press.yaml")
    text = (tmp_path / good).read_text("utf-8").replace("Demo", "Saw")
    (folder / "hall2" / "saw.yml").write_text(f"\ufeff{text}", "utf-8")
    (folder / "drive.yaml").write_text("parameters: {P50303: 10.0}\n", "utf-8")
    (folder / "hall2" / ".hidden" / "no.yaml").write_text(text, "utf-8")
    return folder


def test_specs_below(machines):
    """Specs have a section plc; hidden folders, drive files and folders called *.yaml are none."""
    (machines / "odd.yaml").mkdir()
    (machines / "flow.yaml").write_text('{"plc": {name: a}}', "utf-8")
    (machines / "text.yaml").write_text("comment: |\n  plc: in a text\n", "utf-8")
    names = [path.relative_to(machines).as_posix() for path in specs_below(machines).specs]
    assert names == ["flow.yaml", "hall2/saw.yml", "press.yaml"]


@pytest.mark.parametrize(
    ("text", "encoding"),
    [
        ('{\n  "plc": {"name": "A"},\n  "drives": {}\n}\n', "utf-8"),  # json.dump with indent
        ('{"variables": {"a": 1},\n "plc": {"name": "A"}}', "utf-8"),
        ("# made by a script\n---\n  plc: {name: A}\n  drives: {}\n", "utf-8"),
        ("plc: {name: A}\n", "utf-16"),  # > of Windows PowerShell
        ("# M\u00fcller\r\nplc: {name: A}\r\n", "cp1252"),
    ],
)
def test_a_spec_however_it_was_written(tmp_path, text, encoding):
    """A spec that is passed over makes a green run: keys in braces or indented, and what is not UTF-8."""
    (tmp_path / "job.yaml").write_bytes(text.encode(encoding))
    assert [path.name for path in specs_below(tmp_path).specs] == ["job.yaml"]


@pytest.mark.parametrize("text", ["a: 1\nb:\n  plc: {}\n", "  a: 1\n  b:\n    plc: {}\n", "# plc: {}\n", ""])
def test_no_spec(tmp_path, text):
    """A key plc further inside is none of a spec."""
    (tmp_path / "job.yaml").write_text(text, "utf-8")
    assert specs_below(tmp_path).specs == []


OTHERS = {
    "Kubernetes": "apiVersion: v1\nkind: Pod\nspec: {}\n",
    "GitHub": "on: push\nname: CI\njobs:\n  test:\n    runs-on: x\n",
    "GitLab": "include: [a.yml]\nstages: [a]\nbuild: {script: make}\n",
    "Azure": "jobs:\n- job: a\n  steps: []\n",
    "Compose": "include: [a.yaml]\nservices: {}\n",
    "Taskfile": "version: '3'\nincludes: {a: b.yml}\ntasks: {}\n",
    "an API": "api: {url: x}\n",
    "Prometheus in braces": '{"global": {"jobs": {}, "plc": 1}, "scrape": []}',
    "drives of another tool": "drives: {c: 1}\n",
}


@pytest.mark.parametrize("text", OTHERS.values(), ids=OTHERS)
def test_what_other_tools_keep_in_a_repository(plcgen, tmp_path, text):
    """It is no spec, and a run over nothing but it is none: exit code 2, and its name is told."""
    (tmp_path / "other.yaml").write_text(text, "utf-8")
    for verb in ("check", "generate", "verify"):
        result = plcgen(verb, ".")
        assert result.code == 2
        assert "left, no specs: other.yaml" in result.err
        assert "there is no spec" in result.err


_REST = "drives: {x: {device: sinamics-g120, hardware_id: 270}}\njobs: {a: {drive: x, reed: [r21]}}\n"
_PLC = "{name: L, family: s7-1500, toolchain: tia-v19}\n"
SPECS = {
    "wrong case": (f"PLC: {_PLC}{_REST}", ' (its "PLC" should be "plc")'),
    "changed places": (f"pcl: {_PLC}{_REST}", ' (its "pcl" should be "plc")'),
    "one letter more": (f"plcs: {_PLC}{_REST}", ' (its "plcs" should be "plc")'),
    "one letter less": (f"include: [common.yaml]\n{_REST.replace('jobs', 'job')}", ""),
    "quoted": (f'"PLC": {_PLC}{_REST}', ' (its "PLC" should be "plc")'),
    "in braces": ('{"Jobs": {"a": {"reed": 1}},\n "drives": {}}', ' (its "Jobs" should be "jobs")'),
    "plc from the include": (f"include: common.yaml\n{_REST}", ""),
    "nothing but an include": ("include: [common.yaml]\n", ""),
    "without plc": (_REST, ""),
    "a list where none belongs": ("plc:\n- name: L\njobs:\n- drive: x\n", ""),
    "PPI": ("ppi: {port: P}\nvariables: {reed: 1}\n", ""),
}


@pytest.mark.parametrize(("text", "told"), SPECS.values(), ids=SPECS)
def test_a_spec_whose_section_plc_is_elsewhere_or_misspelt(plcgen, tmp_path, text, told):
    """It is checked, not passed over, and what it includes is not checked alone; the run says what it took."""
    (tmp_path / "m1.yaml").write_text(text, "utf-8")
    if "common" in text:
        (tmp_path / "common.yaml").write_text(f"plc: {_PLC}jobs: {{b: {{reed: [r21]}}}}\n", "utf-8")
    result = plcgen("check", ".")
    assert result.code == 1
    assert f"1 spec: m1.yaml{told}\n" in result.err
    assert ("a spec includes them: common.yaml" in result.err) == ("common" in text)
    for verb in (["generate", "--check"], ["verify"]):
        assert plcgen(*verb, ".").code == 1


def test_the_name_of_a_spec_is_enough(plcgen, tmp_path):
    """Whatever it begins with: what it should have is told."""
    (tmp_path / "m1.plcgen.yaml").write_text("machine: 7\n", "utf-8")
    result = plcgen("check", ".")
    assert result.code == 1
    assert 'lacks the key "plc"' in result.out


def test_files_that_include_each_other(plcgen, tmp_path):
    """None of them includes the others for good: they are checked, and the error is told."""
    for name, other in (("a", "b"), ("b", "a")):
        (tmp_path / f"{name}.yaml").write_text(f"include: {other}.yaml\nplc: {_PLC}", "utf-8")
    result = plcgen("check", ".")
    assert result.code == 1
    assert "PG112" in result.out


def test_a_spec_that_cannot_be_read(plcgen, machines):
    """It is an error, not a green run over the others."""
    (machines / "gone.yaml").symlink_to("nowhere.yaml")
    for verb in (["check"], ["generate", "--check"], ["verify"]):
        result = plcgen(*verb, "machines")
        assert result.code == 1
        assert "gone.yaml" in result.out + result.err


@pytest.mark.parametrize(
    "verb", [["check"], ["check", "--program", "--target", "v5"], ["generate"], ["layout"], ["lock"]]
)
def test_a_folder_that_cannot_be_read(plcgen, machines, monkeypatch, verb):
    """What lies in it must not be passed over in silence."""
    (machines / "M.db").write_text("DATA_BLOCK DB1\nSTRUCT\na : INT;\nEND_STRUCT\nBEGIN\nEND_DATA_BLOCK\n", "utf-8")
    scandir = os.scandir

    def refusing(path):
        if os.fspath(path).endswith("hall2"):
            raise PermissionError(errno.EACCES, "Permission denied", path)
        return scandir(path)

    monkeypatch.setattr(os, "scandir", refusing)
    result = plcgen(*verb, "machines")
    assert result.code == 1
    assert "hall2" in result.out + result.err
    assert "Permission denied" in result.out + result.err


@pytest.mark.usefixtures("machines")
def test_too_many_files_to_look_at(plcgen, monkeypatch):
    """Specs behind the bound would be passed over."""
    monkeypatch.setattr("plcgen.project.below.MAX_SEEN", 3)
    result = plcgen("generate", "machines")
    assert result.code == 1
    assert "PG802" in result.err


def test_check_takes_folders(plcgen, machines):
    """Every spec of the folder once, whatever else names it; sources that plcgen made of them are left to verify."""
    taken = "2 specs: machines/hall2/saw.yml, machines/press.yaml\nleft, no specs: machines/drive.yaml\n"
    assert plcgen("check", "machines", "machines/press.yaml").err == f"{taken}no problems in 2 specs\n"
    assert plcgen("generate", "machines", "-q").code == 0
    assert plcgen("check", "machines").err == f"{taken}no problems in 2 specs\n"
    (machines / "own.scl").write_text("FUNCTION_BLOCK oops", "utf-8")
    mixed = plcgen("check", "machines")
    assert mixed.code == 1
    assert "own.scl" in mixed.out


def test_a_folder_without_specs(plcgen, tmp_path):
    """It is wrong use, not a green run over nothing."""
    (tmp_path / "empty").mkdir()
    for verb in ("check", "generate", "verify"):
        result = plcgen(verb, "empty")
        assert result.code == 2
        assert "there is no spec" in result.err
        assert "below empty" in result.err


@pytest.mark.slow
def test_generate_and_verify_take_folders(plcgen, machines):
    """Each spec has its own folder; one that fails does not keep the others from their turn."""
    made = plcgen("generate", "machines")
    assert made.code == 0
    assert "hall2/saw_generated: " in made.err
    assert "machines/press_generated: " in made.err
    data = json.loads(plcgen("generate", "machines", "--check", "--json").out)
    assert data["specs"] == ["machines/hall2/saw.yml", "machines/press.yaml"]
    assert [project["folder"] for project in data["projects"]] == [
        "machines/hall2/saw_generated",
        "machines/press_generated",
    ]
    shutil.rmtree(machines / "hall2" / "saw_generated")
    result = plcgen("verify", "machines", "--faults", "none")
    assert result.code == 1
    assert "S7" not in result.err
    assert result.out.endswith("\n1 of 2 specs verified without an error\n")
    assert plcgen("verify", "machines/press.yaml", "machines/press.yaml", "--faults", "none").out.count("Layout") == 1
    short = plcgen("verify", "machines", "--faults", "none", "-q")
    assert "press_generated" not in short.out


@pytest.mark.slow
def test_verify_several_for_machines(plcgen, machines):
    """Every format tells the specs apart."""
    assert plcgen("generate", "machines", "-q").code == 0
    shutil.rmtree(machines / "press_generated")
    found = {
        name: plcgen("verify", "machines", "--faults", "none", "-f", name).out
        for name in ("junit", "json", "sarif", "github")
    }
    root = ET.fromstring(found["junit"])  # our own output
    cases = [(case.get("classname"), case.get("name")) for case in root.iter("testcase")]
    assert len(set(cases)) == len(cases)
    assert {suite.get("name").partition(": ")[0] for suite in root} == {"machines/hall2/saw.yml", "machines/press.yaml"}
    assert [part["ok"] for part in json.loads(found["json"])["verifications"]] == [True, False]
    results = json.loads(found["sarif"])["runs"][0]["results"]
    assert any(result["level"] == "error" for result in results)
    assert found["github"].startswith("::")


def test_specs_of_one_output_folder(plcgen, machines):
    """The second would replace the files of the first."""
    shutil.copy(machines / "press.yaml", machines / "press.yml")
    for verb in ("generate", "verify"):
        result = plcgen(verb, "machines")
        assert result.code == 2
        assert "press.yaml and machines/press.yml have the same folder" in result.err


def test_one_folder_for_one_spec(plcgen, machines):
    """--out names the folder of one spec."""
    for verb in ("generate", "verify"):
        result = plcgen(verb, "machines", "--out", "plc")
        assert result.code == 2
        assert "--out is the folder of one spec, not of 2" in result.err
    assert not list(machines.rglob("*_generated"))


def test_what_was_not_written_is_named(plcgen, machines):
    """One wrong spec keeps its own folder as it was; those of the others are written, and the summary says which."""
    press = machines / "press.yaml"
    press.write_text(press.read_text("utf-8").replace("sinamics-dcm", "sinamics-dcmm"), "utf-8")
    result = plcgen("generate", "machines")
    assert result.code == 1
    assert result.err.endswith("machines/press_generated: 1 error; nothing was written\n")
    assert [path.name for path in machines.rglob("*_generated")] == ["saw_generated"]


_PRESS = (
    "plc: {{name: {name}, family: s7-1500, toolchain: tia-v19}}\n"
    "drives: {{{drive}: {{device: sinamics-g120, hardware_id: {id}}}}}\n"
    "jobs: {{{job}: {{drive: {drive}, write: {{P1120: }}}}}}\n"
)


def _two(folder, **other):
    press = {"name": "PLC_1", "drive": "fan", "id": 270, "job": "ramps"}
    (folder / "press.yaml").write_text(_PRESS.format(**press), "utf-8")
    (folder / "pump.yaml").write_text(_PRESS.format(**press | {"drive": "pump", "id": 271} | other), "utf-8")


@pytest.mark.parametrize("verb", [["check"], ["generate"], ["generate", "--check"]])
def test_two_specs_for_one_plc(plcgen, tmp_path, verb):
    """Their blocks would replace each other: both places are told, and of the second one nothing is written."""
    _two(tmp_path)
    result = plcgen(*verb, ".", "--format", "json")
    assert result.code == 1
    (found,) = (d for d in json.loads(result.out)["diagnostics"] if d["code"] == "PG511")
    assert (found["file"], found["line"], found["severity"]) == ("pump.yaml", 3, "error")
    assert 'press.yaml is for the same PLC "PLC_1" and has the names of' in found["message"]
    assert '"Ramps"' in found["message"]
    assert (found["notes"][0]["file"], found["notes"][0]["line"]) == ("press.yaml", 3)
    assert not (tmp_path / "pump_generated").exists()


def test_two_specs_that_share_what_every_spec_has(plcgen, tmp_path):
    """Jobs and drives of other names do not help: the second DriveJobs has the jobs of the second spec only."""
    _two(tmp_path, job="speeds")
    result = plcgen("check", ".")
    assert result.code == 1
    assert "PG511" in result.out
    assert '"DriveChannel"' in result.out


@pytest.mark.parametrize("other", [{"name": "PLC_2"}, {"name": "PLC_1, cpu: 1511-1"}])
def test_specs_for_two_plcs(plcgen, tmp_path, other):
    """Only the name and family tell PLCs apart, not what else is written of them."""
    _two(tmp_path, **other)
    result = plcgen("check", ".")
    assert ("PG511" in result.out) == ("cpu" in other["name"])


def test_two_folders_with_a_plc_of_one_name(plcgen, tmp_path):
    """Each may be a project of its own, whose PLC has the name of all: a warning, and both are generated."""
    _two(tmp_path)
    (tmp_path / "second").mkdir()
    (tmp_path / "pump.yaml").rename(tmp_path / "second" / "pump.yaml")
    result = plcgen("generate", ".")
    assert result.code == 0
    assert "warning[PG511]" in result.out + result.err
    assert (tmp_path / "second" / "pump_generated").is_dir()


def test_numbers_of_two_protocols(plcgen, tmp_path):
    """Drives in one spec and a PPI master in another have other names; automatic numbers begin at 470 in both."""
    _two(tmp_path)
    (tmp_path / "pump.yaml").write_text(
        (ROOT / "specs" / "s7-1200_s7-200_ppi.yaml").read_text("utf-8").replace("Pump station", "PLC_1")
        .replace("s7-1200", "s7-1500"), "utf-8")  # fmt: skip
    result = plcgen("check", ".")
    assert "has the numbers of" in result.out
    assert "DB471" in result.out
    text = (tmp_path / "press.yaml").read_text("utf-8")
    (tmp_path / "press.yaml").write_text(text.replace("tia-v19}", "tia-v19, numbers: {fb: 600, db: 600}}"), "utf-8")
    assert "PG511" not in plcgen("check", ".").out


def test_two_specs_with_a_prefix(plcgen, tmp_path):
    """What the message says helps: names of blocks, tables and tags differ, and the second spec verifies."""
    _two(tmp_path)
    text = (tmp_path / "pump.yaml").read_text("utf-8").replace("P1120: ", "P1120: }, trigger: {execute: M50.0")
    plc = "tia-v19, prefix: L2_, numbers: {fb: 600, db: 600}}"
    (tmp_path / "pump.yaml").write_text(text.replace("tia-v19}", plc), "utf-8")
    assert plcgen("check", ".").code == 0
    assert plcgen("generate", ".").code == 0
    shared = {path.name for path in (tmp_path / "press_generated" / "xml").glob("*.xml")} & {
        path.name for path in (tmp_path / "pump_generated" / "xml").glob("*.xml")
    }
    assert shared == {"Main.xml"}
    assert (
        (tmp_path / "pump_generated" / "tags.csv").read_text("utf-8-sig").splitlines()[1].startswith("L2_rampsExecute;")
    )
    declared = re.compile(r'^(?:TYPE|DATA_BLOCK|FUNCTION_BLOCK) "([^"]+)"', re.MULTILINE)
    names = declared.findall((tmp_path / "pump_generated" / "PLC_1.scl").read_text("utf-8-sig"))
    assert len(names) > 10
    assert [name for name in names if not name.removeprefix("type").startswith("L2_")] == []
    assert plcgen("verify", "pump.yaml", "--faults", "none").code == 0


def test_two_specs_with_one_device(plcgen, tmp_path):
    """A prefix does not make two channels on one parameter server right."""
    _two(tmp_path, id=270)
    text = (tmp_path / "pump.yaml").read_text("utf-8")
    (tmp_path / "pump.yaml").write_text(
        text.replace("tia-v19}", "tia-v19, prefix: L2_, numbers: {fb: 600, db: 600}}"), "utf-8"
    )
    result = plcgen("check", ".", "--format", "json")
    assert result.code == 1
    (found,) = (one for one in json.loads(result.out)["diagnostics"] if one["severity"] == "error")
    assert (found["code"], found["file"], found["line"]) == ("PG513", "pump.yaml", 2)
    assert "the device at 270" in found["message"]


def test_two_specs_as_one(plcgen, tmp_path):
    """What the message says helps: a spec with its own plc that includes both; they are not checked alone then."""
    _two(tmp_path, job="speeds")
    line = "include: [press.yaml, pump.yaml]\nplc: {name: PLC_1, family: s7-1500, toolchain: tia-v19}\n"
    (tmp_path / "line.plcgen.yaml").write_text(line, "utf-8")
    result = plcgen("check", ".")
    assert (result.code, result.err.splitlines()[0]) == (0, "1 spec: line.plcgen.yaml")


@pytest.mark.slow
def test_verify_of_two_specs_for_one_plc(plcgen, tmp_path):
    """It fails, too."""
    _two(tmp_path)
    for spec in ("press.yaml", "pump.yaml"):
        assert plcgen("generate", spec).code == 0
    result = plcgen("verify", ".", "--faults", "none")
    assert result.code == 1
    assert "PG511" in result.out + result.err
