"""What the service says of a spec while somebody types it."""

from __future__ import annotations

import random
from pathlib import Path

import pytest

from plcgen import api
from plcgen.base.diagnostics import DiagnosticError
from plcgen.base.files.yaml import load_yaml
from tests.projects import ROOT, SPECS
from tests.workbench.desk import Desk, edited

HEAD = """# a plant
plc: {name: Plant, family: s7-1500, toolchain: tia-v19}
drives:
  pump: {device: sinamics-g120, hardware_id: 270}
  axis: {device: sinamics-s210, hardware_id: 280}
jobs:
"""
JOB = "  set_ramps:\n    drive: pump\n    write: {P1120: 10.0, P1121: 12.5}\n"


@pytest.fixture
def desk(tmp_path: Path) -> Desk:
    return Desk(tmp_path)


# --- diagnostics -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("path", SPECS, ids=lambda path: path.stem)
def test_findings_are_those_of_check(path: Path) -> None:
    """For every shipped spec: the same diagnostics as ``check``, from the text alone."""
    desk = Desk(path.parent)
    document = desk.workspace.open(path, path.read_text("utf-8"))
    found = [one.diagnostic for one in desk.workspace.diagnostics(document)]
    assert found == list(api.check(path.absolute()).diagnostics)


def test_unsaved_text_counts(desk: Desk) -> None:
    """The file on disk is sound, the text in the editor is not: its mistake is found at its place, with a remedy."""
    (desk.folder / "plant.yaml").write_text(HEAD + JOB, "utf-8")
    document, *_ = desk.open(HEAD + JOB.replace("pump", "pmup"))
    found = next(one for one in desk.workspace.diagnostics(document) if one.diagnostic.code == "PG202")
    assert (found.diagnostic.span.line, found.diagnostic.span.column) == (8, 12)
    assert found.reason
    assert found.remedy == 'did you mean "pump"?'
    (fix,) = found.fixes
    assert edited(document.text, fix.edits) == HEAD + JOB


def test_an_open_included_file_counts(desk: Desk) -> None:
    """What an open file says counts for the specs that include it, and the file shows what is wrong there."""
    (desk.folder / "drives.yaml").write_text("drives:\n  pump: {device: sinamics-g120, hardware_id: 270}\n", "utf-8")
    spec = "include: drives.yaml\nplc: {name: P, family: s7-1500, toolchain: tia-v19}\njobs:\n" + JOB
    document, *_ = desk.open(spec)
    assert not [one for one in desk.workspace.diagnostics(document) if one.diagnostic.severity.name == "ERROR"]
    part, *_ = desk.open("drives:\n  pump: {device: sinamics-g12, hardware_id: 270}\n", "drives.yaml")
    codes = [(one.diagnostic.code, Path(one.diagnostic.span.file).name) for one in desk.workspace.diagnostics(document)]
    assert ("PG201", "drives.yaml") in codes
    assert [one.diagnostic.code for one in desk.workspace.diagnostics(part)] == ["PG201"]


def test_a_part_alone_lacks_nothing(desk: Desk) -> None:
    """A file for specs to include has no plc; that is not wrong with it, an unknown key is."""
    part, *_ = desk.open("drives:\n  pump: {devise: sinamics-g120, hardware_id: 270}\n", "drives.yaml")
    assert [one.diagnostic.code for one in desk.workspace.diagnostics(part)] == ["PG105", "PG104"]


@pytest.mark.parametrize(
    "text",
    [
        "services:\n  web: {image: nginx}\n",
        'version: "3"\nservices:\n  web: {image: nginx}\n',
        "name: CI\non: push\njobs:\n  build:\n      runs-on: ubuntu-latest\n      steps: [{run: make}]\n",
        "variables: {A: b}\ninclude: [other.yml]\nstages: [test]\nunit: {stage: test}\n",
        "trigger: [main]\npool: {vmImage: ubuntu}\nvariables: {a: b}\njobs: []\n",
        "title: Holidays\nparameters: {a: 1}\npages: [one]\n",
    ],
)
def test_other_yaml_is_left_alone(text: str, desk: Desk) -> None:
    """Files of other programs, two of which have jobs and variables: nothing is said of them, offered or changed."""
    document, *_ = desk.open(text, "other.yaml")
    assert desk.workspace.diagnostics(document) == ()
    assert desk.workspace.outline(document) == ()
    assert desk.workspace.format(document) == ()
    for number, line in enumerate(document.lines, 1):
        for column in (1, len(line) // 2, len(line) + 1):
            assert desk.workspace.complete(document, number, column) == ()
            assert desk.workspace.hover(document, number, column) is None
            assert desk.workspace.name_at(document, number, column) is None
            assert desk.workspace.definition(document, number, column) is None


def test_a_part_of_several_specs(desk: Desk) -> None:
    """Each spec that includes it says what is wrong there: one has no drive b, the other no drive a."""
    part = "jobs:\n  one: {drive: a, read: [r21]}\n  two: {drive: b, read: [r21]}\n"
    for name, drive in (("first", "a"), ("second", "b")):
        text = f"include: [jobs.yaml]\n{HEAD.replace('pump', drive).removesuffix('jobs:' + chr(10))}"
        (desk.folder / f"{name}.yaml").write_text(text, "utf-8")
    document, *_ = desk.open(part, "jobs.yaml")
    found = [one.diagnostic for one in desk.workspace.diagnostics(document)]
    assert sorted((one.code, one.span.line) for one in found if one.severity.name == "ERROR") == [
        ("PG202", 2),
        ("PG202", 3),
    ]


PROFILE = (ROOT / "specs/devices/profidrive.yaml").read_text("utf-8")
DRIVE = "objects:\n  - number: 1\n    parameters:\n      - {pnu: 1120, type: FloatingPoint, value: 10.0}\n"
BUS = "stations:\n  - {cpu: 224, address: 2, values: {VW100: 7}}\n"


@pytest.mark.parametrize(
    ("text", "wrong", "right"),
    [
        (PROFILE, "titel:", "title:"),
        (PROFILE, "record_idx:", "record_index:"),
        (DRIVE, "type: FloatingPint", "type: FloatingPoint"),
        (BUS, "adress: 2", "address: 2"),
        (BUS, "VW9999999: 7", "VW100: 7"),
    ],
)
def test_other_files_of_plcgen(text: str, wrong: str, right: str, desk: Desk) -> None:
    """Profiles of devices, simulated drives and stations: sound as they are; a mistake is told at its place."""
    document, *_ = desk.open(text, "other.yaml")
    assert desk.workspace.diagnostics(document) == ()
    assert right in text
    document, *_ = desk.open(text.replace(right, wrong, 1), "other.yaml")
    found = [one.diagnostic for one in desk.workspace.diagnostics(document)]
    line = document.text[: document.text.index(wrong)].count("\n") + 1
    assert line in {one.span.line for one in found}


def test_keys_of_other_files(desk: Desk) -> None:
    """By their schemas: keys of a profile with what they are for, words of a station, hover."""
    assert "drive_object" in desk.offers("title: A\nsource: B\n|", "acme.yaml")
    assert "cpu" in desk.offers("stations:\n  - {address: 2, |}\n", "bus.yaml")
    assert "decides the sizes" in desk.hover("stations:\n  - {c|pu: 224}\n", "bus.yaml")


@pytest.mark.parametrize("path", sorted((ROOT / "specs/devices").glob("*.yaml")), ids=lambda path: path.stem)
def test_shipped_profiles_are_sound(path: Path, desk: Desk) -> None:
    """Nothing is said of any of them, wherever it lies."""
    assert desk.workspace.diagnostics(desk.open(path.read_text("utf-8"), "own.yaml")[0]) == ()


FIXES = [
    ("PG104", HEAD + JOB.replace("write", "wirte"), HEAD + JOB),
    ("PG104", HEAD + JOB.replace("write", "Write"), HEAD + JOB),
    ("PG104", HEAD + JOB + "    zzz:\n      deep: 1\n", HEAD + JOB),
    ("PG106", HEAD.replace("name: Plant", "name: [1]") + JOB, None),
    ("PG107", HEAD + JOB.replace("pump", "[]"), None),
    ("PG107", HEAD.replace("tia-v19", "tia-v91") + JOB, HEAD.replace("tia-v19", "tia-v21") + JOB),
    ("PG201", HEAD.replace("sinamics-g120", "sinamic-g120") + JOB, HEAD + JOB),
    ("PG202", HEAD + JOB.replace("pump", "pumb"), HEAD + JOB),
    (
        "PG105",
        HEAD.replace("family: s7-1500, ", "") + JOB,
        HEAD.replace("{name: Plant, family: s7-1500,", "{family: , name: Plant,") + JOB,
    ),
    (
        "PG215",
        HEAD.replace(", hardware_id: 270", "") + JOB,
        HEAD.replace("{device: sinamics-g120, hardware_id: 270}", "{hardware_id: , device: sinamics-g120}") + JOB,
    ),
    (
        "PG219",
        HEAD + JOB.replace("P1120: 10.0", "P970: 1"),
        HEAD + JOB.replace("P1120: 10.0", "P970: 1").replace("    drive", "    allow: {P970: }\n    drive"),
    ),
    ("PG226", HEAD + JOB.replace("P1120: 10.0", "P1082: "), None),
    ("PG226", HEAD + JOB.replace("P1120: 10.0", "1082: "), None),
    ("PG108", HEAD.replace("name: Plant", "name: no") + JOB, HEAD.replace("name: Plant", 'name: "no"') + JOB),
]


@pytest.mark.parametrize(("code", "wrong", "right"), FIXES)
def test_fixes(desk: Desk, code: str, wrong: str, right: str | None) -> None:
    """A fix makes exactly the text that is meant; where the message knows no edit there is none."""
    document, *_ = desk.open(wrong)
    found = [one for one in desk.workspace.diagnostics(document) if one.diagnostic.code == code]
    made = [edited(wrong, fix.edits) for one in found for fix in one.fixes]
    assert found
    assert right in made if right is not None else made == []
    assert wrong not in made


def test_a_fix_never_makes_it_worse(desk: Desk) -> None:
    """After any fix of any mistake the code is not reported at that place, unless there is a value to give."""
    for _, wrong, _ in FIXES:
        document, *_ = desk.open(wrong)
        for finding in desk.workspace.diagnostics(document):
            for fix in finding.fixes:
                if fix.title.endswith(":"):
                    continue
                after, *_ = desk.open(edited(wrong, fix.edits))
                left = [(one.diagnostic.code, one.diagnostic.span.line) for one in desk.workspace.diagnostics(after)]
                assert (finding.diagnostic.code, finding.diagnostic.span.line) not in left


# --- completion ------------------------------------------------------------------------------------------------------


def test_keys_by_the_schema(desk: Desk) -> None:
    """In a drive: the keys of a drive that are not there yet, each with what it is for."""
    found = desk.offers(HEAD.replace("hardware_id: 280}", "|}") + JOB)
    assert found["hardware_id"] == (
        "hardware_id: ",
        "hardware identifier (S7-1200/1500), 1..65535, or the name of its system constant",
    )
    assert "device" not in found
    assert "read" not in found


def test_a_key_that_has_its_colon(desk: Desk) -> None:
    """It is replaced without a second one."""
    assert desk.offers(HEAD.replace("hardware_id: 280", "hard|: 280") + JOB)["hardware_id"][0] == "hardware_id"


def test_one_kind_of_job(desk: Desk) -> None:
    """A job that writes is offered nothing that it cannot do besides; save, which may follow, is."""
    found = desk.offers(HEAD + JOB + "    |\n")
    assert "save" in found
    assert "timeout" in found
    assert not {"read", "compare", "faults", "write"} & found.keys()


def test_words_devices_and_names(desk: Desk) -> None:
    """Families, toolchains, devices with their titles, drives."""
    assert list(desk.offers(HEAD.replace("s7-1500", "|") + JOB)) == ["s7-300", "s7-400", "s7-1200", "s7-1500"]
    assert "tia-v21" in desk.offers(HEAD.replace("tia-v19", "tia|") + JOB)
    assert "SINAMICS G120" in desk.offers(HEAD.replace("sinamics-g120", "|") + JOB)["sinamics-g120"][1]
    assert desk.offers(HEAD + JOB.replace("pump", "|")) == {
        "pump": ("pump", "sinamics-g120"),
        "axis": ("axis", "sinamics-s210"),
    }


def test_parameters_of_that_drive(desk: Desk) -> None:
    """p2900 is a fixed value of G120 (list manual: Fixed value 1 [%]); r0021 can only be read, so nobody writes it."""
    found = desk.offers(HEAD + "  new:\n    drive: pump\n    write: {P112|}\n")
    assert found["P1120"][0] == "P1120: "
    assert all(label[1:].startswith("112") for label in found if label[1:].isdecimal())
    assert "ramp-up time" in found["P1120"][1]
    assert " s" in found["P1120"][1]
    read = desk.offers(HEAD + "  new:\n    drive: pump\n    read: [r2|]\n")
    assert "r21" in read
    assert "r21" not in desk.offers(HEAD + "  new:\n    drive: pump\n    write: {r2|}\n")


def test_parameters_by_words(desk: Desk) -> None:
    """Words of a title find a parameter, too."""
    found = desk.offers(HEAD + "  new:\n    drive: pump\n    read: [ramp-up|]\n")
    assert "P1120" in found


def test_names_of_values(desk: Desk) -> None:
    """A value that has a name in the spec is offered by it, with its number."""
    head = HEAD.replace(
        "hardware_id: 270", "hardware_id: 270, parameters: {P2280: {type: Integer16, values: {off: 0, pid: 1}}}"
    )
    head = head.replace("off: 0", "idle: 0")
    desk.workspace.diagnostics(desk.open(head + JOB)[0])
    found = desk.offers(head + "  new:\n    drive: pump\n    write: {P2280: |}\n")
    assert found["idle"] == ("idle", "0")
    assert found["pid"] == ("pid", "1")


@pytest.mark.parametrize(
    "text",
    [
        HEAD + "  new:\n    drive: pump\n    write: {P112|\n  other:\n    drive: axis\n",
        HEAD + "  new:\n    drive: pump\n    write:\n      P112|\n  other: {drive: [axis\n",
        HEAD.replace("name: Plant", 'name: "Plant') + "  new:\n    drive: pump\n    write:\n      P112|\n",
        HEAD + '  new:\n    drive: pump\n    read: ["P112|\n',
        HEAD + "  new:\n    drive: pump\n    sequence:\n      - write: {P112|\n      - read: \n",
    ],
)
def test_a_broken_text_completes(desk: Desk, text: str) -> None:
    """Brackets and quotes that are left open, in front of the cursor or behind it."""
    assert "P1120" in desk.offers(text)


def test_variables_and_files(desk: Desk) -> None:
    """``$`` offers variables, ``include:`` the files of the folder."""
    (desk.folder / "more.yaml").write_text("variables: {up: 3.0}\n", "utf-8")
    text = "include: [more.yaml]\nvariables: {down: 5.0}\n" + HEAD + JOB
    assert set(desk.offers(text.replace("10.0", "$|"))) == {"$(up)", "$(down)"}
    assert desk.offers(text.replace("more.yaml", "|"))["more.yaml"][0] == "more.yaml"


def test_recipes_and_stations(desk: Desk) -> None:
    """Recipes where a job names one, members where a record gives values; stations of that master only."""
    text = (
        HEAD
        + "  load: {drive: axis, write_recipe: |}\n"
        + "recipes:\n  wind: {parameters: [P1120], records: {a: {}, b: {}}}\n"
    )
    assert "wind" in desk.offers(text)
    assert "P1120" in desk.offers(text.replace("|", "wind").replace("a: {}", "a: {|}"))
    ppi = "ppi:\n  a: {stations: {one: {address: 2}}, jobs: {x: {station: |}}}\n  b: {stations: {two: {address: 3}}}\n"
    assert set(desk.offers(ppi)) == {"one"}


# --- hover -----------------------------------------------------------------------------------------------------------


def test_hover_of_a_key(desk: Desk) -> None:
    """What it is for, its words, its default."""
    found = desk.hover(HEAD.replace("toolchain", "tool|chain") + JOB)
    assert "engineering tool that imports the sources" in found
    assert "tia-v21" in found


def test_hover_of_a_job(desk: Desk) -> None:
    """Its telegram: 01 reference, 02 change, 01 object, 02 parameters, 10h value, 01 element, 0460h = P1120; 10.0 is
    41200000h as IEEE 754; a good answer to a change has 4 bytes (PROFIdrive profile, 6.2.3).
    """
    found = desk.hover(HEAD + JOB.replace("set_ramps", "set_|ramps"))
    for text in ("04 60", "41 20 00 00", "rampUpTime", "01 02 01 02"):
        assert text in found


def test_hover_of_parameter_and_drive(desk: Desk) -> None:
    """Unit and source of a parameter; identifier, data record and drive object of a drive."""
    found = desk.hover(HEAD + JOB.replace("P1120", "P11|20"))
    assert "unit: s" in found
    assert "Source: " in found
    drive = desk.hover(HEAD.replace("  pump", "  pu|mp") + JOB)
    assert "270 (16#010E)" in drive
    assert "set_ramps" in drive


def test_hover_says_what_a_drive_lacks(desk: Desk) -> None:
    """A G120 is one drive object: it cannot be left out, and the reason stands there."""
    found = desk.hover((HEAD + JOB).replace("  pump:", "  pu|mp:"))
    assert "Cannot have: activate: SINAMICS G120" in found


def test_profiles_of_the_folder_are_devices(desk: Desk) -> None:
    """A profile beside the spec is offered by its path, other files are not."""
    (desk.folder / "drives").mkdir()
    (desk.folder / "drives/acme.yaml").write_text(PROFILE, "utf-8")
    (desk.folder / "notes.yaml").write_text("title: no profile\n", "utf-8")
    found = desk.offers(HEAD.replace("device: sinamics-g120", "device: |"))
    assert [label for label in found if label.startswith("./")] == ["./drives/acme.yaml"]


def test_hover_of_a_code(desk: Desk) -> None:
    """A code in a comment is explained."""
    assert "PG228" in desk.hover("# plcgen: allow PG2|28 reason\n" + HEAD + JOB)


# --- names -----------------------------------------------------------------------------------------------------------

NAMES = """include: [shared.yaml]
variables: {which: pump, both: [pump, axis]}
plc: {name: Plant, family: s7-1500, toolchain: tia-v19}
jobs:
  one: {drive: pump, read: [r21]}
  two: {drive: $(which), read: [r21]}
  three: {drive: &some ["pump", axis], read: [r21]}
  four: {drive: *some, read: [r21]}
  five: {drive: $(both), read: [r21]}
"""
SHARED = """drives:
  pump: {device: sinamics-g120, hardware_id: 270}
  axis: {device: sinamics-g120, hardware_id: 280}
"""


def test_a_drive_gets_another_name_everywhere(desk: Desk) -> None:
    """In the included file, in quotes, in values of variables, in anchors: each once, and nothing else."""
    (desk.folder / "shared.yaml").write_text(SHARED, "utf-8")
    document, line, column = desk.open(NAMES.replace("one: {drive: pump", "one: {drive: pu|mp"))
    edits = desk.workspace.rename(document, line, column, "pump_1")
    shared = desk.folder / "shared.yaml"
    own = tuple(edit for edit in edits if edit.span.file == document.file)
    other = tuple(edit for edit in edits if edit.span.file == shared.as_posix())
    assert len(own) + len(other) == len(edits)
    assert edited(NAMES, own) == NAMES.replace("pump", "pump_1")
    assert edited(SHARED, other) == SHARED.replace("  pump:", "  pump_1:")


def test_other_names(desk: Desk) -> None:
    """A variable at its uses, a recipe, a station of one of two masters, a job: nothing else of the same name."""

    def renamed(text: str, new: str) -> str:
        document, line, column = desk.open(text)
        return edited(document.text, desk.workspace.rename(document, line, column, new))

    (desk.folder / "shared.yaml").write_text(SHARED, "utf-8")
    assert renamed(NAMES.replace("$(which)", "$(wh|ich)"), "what") == NAMES.replace("which", "what")
    recipe = "recipes:\n  wind: {parameters: [P1120], records: 2}\njobs:\n  wind: {drive: a, write_recipe: wi|nd}\n"
    assert renamed(recipe, "pull") == recipe.replace("  wind: {p", "  pull: {p").replace("wi|nd", "pull")
    line = "ppi:\n  a: {stations: {s: {address: 2}}, jobs: {x: {station: s}}}\n"
    line += "  b: {stations: {s: {address: 3}}, jobs: {x: {station: |s}}}\n"
    after = line.replace("|", "").split("\n")
    after[2] = after[2].replace("{s:", "{t:").replace("station: s", "station: t")
    assert renamed(line, "t") == "\n".join(after)


def test_a_rename_that_fails_says_why(desk: Desk) -> None:
    """A name that is taken, a name that is none, a broken text, no name at all, a file outside the workspace."""
    text = HEAD + JOB.replace("set_ramps", "set|_ramps") + "  other:\n    drive: pump\n    read: [r21]\n"
    document, line, column = desk.open(text)
    for new, why in (("other", "already"), ("a: b", "not a name"), ("", "not a name")):
        with pytest.raises(DiagnosticError, match=why):
            desk.workspace.rename(document, line, column, new)
    with pytest.raises(DiagnosticError, match="no name"):
        desk.workspace.rename(document, 1, 1, "x")
    document, line, column = desk.open(HEAD + "  a|b: {drive: pump, read: [")
    with pytest.raises(DiagnosticError, match="cannot be read"):
        desk.workspace.rename(document, line, column, "x")


def test_nothing_outside_the_workspace_is_changed(tmp_path: Path) -> None:
    """A spec outside of the folder may be open, but gets no edits."""
    (tmp_path / "in").mkdir()
    desk = Desk(tmp_path / "in")
    desk.folder = tmp_path
    document, line, column = desk.open(HEAD + JOB.replace("set_ramps", "set|_ramps"))
    with pytest.raises(DiagnosticError, match="outside"):
        desk.workspace.rename(document, line, column, "x")


def test_definitions(desk: Desk) -> None:
    """Of a drive in an included file, of a variable, of an anchor, of a file."""
    (desk.folder / "shared.yaml").write_text(SHARED, "utf-8")

    def goes(text: str) -> tuple[str, int, int]:
        place = desk.workspace.definition(*desk.open(text))
        assert place is not None
        return Path(place.file).name, place.line, place.column

    assert goes(NAMES.replace("one: {drive: pump", "one: {drive: pu|mp")) == ("shared.yaml", 2, 3)
    assert goes(NAMES.replace("$(which)", "$(wh|ich)")) == ("plant.yaml", 2, 13)
    assert goes(NAMES.replace("*some", "*so|me")) == ("plant.yaml", 7, 18)
    assert goes(NAMES.replace("[shared", "[sha|red")) == ("shared.yaml", 1, 1)
    assert goes("recipes:\n  wind: {}\njobs:\n  a: {write_recipe: wi|nd}\n") == ("plant.yaml", 2, 3)


# --- layout and outline ----------------------------------------------------------------------------------------------


def test_layout_keeps_what_is_said(desk: Desk) -> None:
    """Uneven steps and line ends are laid out; comments, order, brackets and values are as they were."""
    text = "# head\nplc:\n      name: A   \n      family: s7-1500 # why\n\n\n\njobs:\n   a:\n"
    text += "       read:\n        - r21 \n        -  as: x\n           parameter: r2\n"
    want = "# head\nplc:\n  name: A\n  family: s7-1500 # why\n\njobs:\n  a:\n"
    want += "    read:\n      - r21\n      -  as: x\n         parameter: r2\n"
    document, *_ = desk.open(text)
    assert edited(text, desk.workspace.format(document)) == want


def test_layout_keeps_keys_that_are_put_aside(desk: Desk) -> None:
    """A comment at the end of a block, as deep as its keys, belongs to it; one as deep as the next line to that."""
    text = "plc:\n    name: A\n    # names: faq\n\n# the drives\ndrives:\n  a: {}\n  # b: {}\n"
    want = "plc:\n  name: A\n  # names: faq\n\n# the drives\ndrives:\n  a: {}\n  # b: {}\n"
    assert edited(text, desk.workspace.format(desk.open(text)[0])) == want


def test_layout_leaves_texts_of_several_lines(desk: Desk) -> None:
    """Empty lines inside a text belong to it; the keys around it are laid out all the same."""
    text = "plc:\n    name: >\n      a\n\n\n      b\n    family: s7-1500\n"
    after = edited(text, desk.workspace.format(desk.open(text)[0]))
    assert load_yaml(after, "f").data() == load_yaml(text, "f").data()
    assert "\n  family: s7-1500\n" in after


@pytest.mark.parametrize("path", SPECS, ids=lambda path: path.stem)
def test_layout_of_shipped_specs(path: Path, desk: Desk) -> None:
    """The same values and comments afterwards, and nothing to do a second time."""
    text = path.read_text("utf-8")
    document, *_ = desk.open(text)
    after = edited(text, desk.workspace.format(document))
    assert load_yaml(after, "f").data() == load_yaml(text, "f").data()
    assert after.count("#") == text.count("#")
    assert desk.workspace.format(desk.open(after)[0]) == ()


def test_outline(desk: Desk) -> None:
    """Drives with their devices, jobs with what they do."""
    document, *_ = desk.open(HEAD + JOB)
    found = {one.name: one for one in desk.workspace.outline(document)}
    assert [(one.name, one.kind, one.detail) for one in found["drives"].children] == [
        ("pump", "drive", "sinamics-g120"),
        ("axis", "drive", "sinamics-s210"),
    ]
    (job,) = found["jobs"].children
    assert (job.name, job.kind, job.detail) == ("set_ramps", "job", "write")
    assert (job.whole.line, job.whole.end_line) == (7, 9)


# --- memory ----------------------------------------------------------------------------------------------------------


def test_edits_leave_nothing(desk: Desk) -> None:
    """After 10,000 edits there is what there was after one: one document, one state."""
    import gc

    from plcgen.workbench.service import Document
    from plcgen.workbench.service.specs.state import SpecState

    for n in range(10_000):
        document, *_ = desk.open(f"{HEAD}{JOB}# {n}\n")
        if n % 100 == 0:
            desk.workspace.diagnostics(document)
            desk.workspace.complete(document, 9, 13)
    gc.collect()
    kept = [one for one in gc.get_objects() if isinstance(one, Document | SpecState)]
    assert len(kept) <= 3
    desk.workspace.close(document.path)
    assert not list(desk.workspace.documents)


# --- stations --------------------------------------------------------------------------------------------------------

LINE = """plc: {name: Line, family: s7-1200, toolchain: tia-v19}
ppi:
  pumps:
    module: cm1241
    port: 270
    baud: 9600
    stations:
      one: {address: 2, symbols: {level: VD104}}
      two: {address: 3, symbols: two.csv}
    jobs:
      first: {station: one, read: [level]}
      second: {station: two, write: {speed: null}}
"""


def test_symbols_of_that_station(desk: Desk) -> None:
    """Those of the spec, or of the table of Micro/WIN that the station names; hover says where they lie."""
    (desk.folder / "two.csv").write_text("Symbol,Address,Comment\nspeed,VW112,of the fan\n", "utf-8")
    assert desk.offers(LINE.replace("[level]", "[|]"))["level"] == ("level", "VD104")
    assert desk.offers(LINE.replace("{speed: null}", "{|}"))["speed"] == ("speed: ", "VW112 of the fan")
    assert "Address: VD104" in desk.hover(LINE.replace("[level]", "[lev|el]"))
    assert "of the fan" in desk.hover(LINE.replace("{speed", "{sp|eed"))
    assert "PPI address: 3" in desk.hover(LINE.replace("station: two", "station: t|wo"))


def test_hover_of_a_job_on_the_line(desk: Desk) -> None:
    """A read of PPI begins with 68h, its length twice, 68h; it goes to station 2 (PPI, frame SD2)."""
    found = desk.hover(LINE.replace("first:", "fi|rst:").replace("two.csv", "{speed: VW112}"))
    assert "68h = start delimiter SD2" in found
    assert "With: one" in found


# --- whatever is typed -----------------------------------------------------------------------------------------------

PIECES = (
    "{",
    "[",
    "]",
    "}",
    '"',
    "'",
    ": ",
    "- ",
    "\n",
    "  ",
    "*a",
    "&b ",
    "|\n",
    "$(",
    "#",
    "\t",
    "\u2028",
    "\ud800",
    "<<: ",
)


@pytest.mark.parametrize("path", SPECS, ids=lambda path: path.stem)
def test_nothing_that_is_typed_fails(path: Path, desk: Desk) -> None:
    """Parts taken out, doubled and put in at places that are drawn: every question has an answer."""
    drawn, text = random.Random(path.stem), path.read_text("utf-8")  # the same damages in every run
    for n in range(12):
        start = drawn.randrange(len(text))
        end = min(start + drawn.randrange(60), len(text))
        piece = ("", drawn.choice(PIECES), text[end : end + 30])[n % 3]
        broken = text[:start] + piece + text[start if piece else end :]
        document = desk.workspace.open(desk.folder / "plant.yaml", broken)
        line, column = text.count("\n", 0, start) + 1, start - text.rfind("\n", 0, start)
        desk.workspace.diagnostics(document)
        for at in ((line, column), (line, column + len(piece)), (line + 1, 3)):
            desk.workspace.complete(document, *at)
            desk.workspace.hover(document, *at)
            desk.workspace.definition(document, *at)
            desk.workspace.references(document, *at)
        desk.workspace.outline(document)
        desk.workspace.format(document)
