"""Device profiles: every mistake at its place, a profile beside the spec, profiles of installed packages."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
import yaml

from plcgen import api
from plcgen.base.diagnostics import DiagnosticError, PluginError
from plcgen.base.resources import specs_dir
from plcgen.ds47 import devices
from plcgen.ds47.device import Device, Parameter
from plcgen.ds47.plan.nouns import DrivePlan
from plcgen.ds47.profile import (
    Answers,
    Changes,
    DeviceProfile,
    DriveObjects,
    ParameterEntry,
    ProfileLimits,
    ProfileList,
    ProfileObjects,
    RecordIndexes,
    ScalarElements,
)

PAGE = (Path(__file__).parents[2] / "docs" / "devices.md").read_text("utf-8")

WRONG = """\
title: ""
sorce: Acme manual
record_index: {profibus: 0, profinet: 47, profinet-local: "47", default: profinet-global}
drive_object: {default: 9, allowed: [1, 300], rule: 5}
limits: {record: 300, parameters: 40, telegrams: 1}
answers: {format: exakt, error_words: 3}
scalar_elements: {read: 2, write: yes}
strict_length: 1
error_table: sinamic
family: acme
parameters:
  P0: {type: Unsigned16}
  P1: {name: ramp}
  P2: {type: Real}
  P3: {type: "Unsigned16[4]"}
  P4: {type: FloatingPoint, maximum: 10.0}
  P5: {type: FloatingPoint, max: 1e39}
  P6: {type: Integer16, min: -40000}
  P7: {type: Integer16, min: 10, max: 1}
  P8: {type: Unsigned8, max: 10, default: 11}
  P9: {type: Unsigned16, default: x}
  P10: {type: Unsigned16, acess: r}
  P11: {type: Unsigned16, access: read}
  P12: {type: Unsigned16, array: 0}
  P13: {type: Unsigned16, name: "ramp up"}
  P14: {type: Unsigned16, name: P50}
  P15: {type: Unsigned16, bico: true}
  P16: {type: "OctetString[2]", default: "032900"}
  P17: {type: "OctetString[2]", min: 1}
  P18: {type: Unsigned16, dangerous: yes}
  P19: [Unsigned16]
  R19: {type: Unsigned16}
  P20: {type: Unsigned16, title: "two\\nlines"}
  P21: {type: Unsigned16, name: ramp_up}
  P22: {type: Unsigned16, name: ramp_up}
  P23[1]: {type: Unsigned16}
  P24: {type: Unsigned16, unit: 5}
  P25: {type: Unsigned16, source: ""}
  P26: {type: Unsigned16}
  P26: {type: Unsigned16}
  P27: {type: Unsigned16, max: 10, observed: 11}
  P28: {type: Unsigned16, max: 10, values: {off: 0, on: 11}}
  P29: {type: Unsigned16, name: Ramp_Up}
"""

MISTAKES = [
    ("PG105", 1, 1, 'the profile lacks the key "source"'),
    ("PG107", 1, 8, "a text is one line of printable characters"),
    ("PG104", 2, 1, 'unknown key "sorce" in the profile'),
    ("PG107", 3, 26, '"profibus": must be greater than or equal to 1, not "0"'),
    ("PG104", 3, 29, 'unknown key "profinet" in record_index'),
    ("PG106", 3, 59, 'expected a whole number instead of "47"'),
    ("PG107", 3, 74, 'there is no record index "profinet-global"'),
    ("PG107", 4, 41, '"allowed": must be less than or equal to 255, not "300"'),
    ("PG106", 4, 53, 'expected text instead of "5"'),
    ("PG107", 5, 18, '"record": must be less than or equal to 240, not "300"'),
    ("PG107", 5, 35, '"parameters": must be less than or equal to 39, not "40"'),
    ("PG104", 5, 39, 'unknown key "telegrams" in limits'),
    ("PG107", 6, 19, '"exakt" is not a value of "format"'),
    ("PG107", 6, 39, '"3" is not a value of "error_words"'),
    ("PG107", 7, 25, '"2" is not a value of "read"'),
    ("PG108", 7, 35, "ambiguous value yes"),
    ("PG106", 8, 16, 'expected true or false instead of "1"'),
    ("PG107", 9, 14, '"sinamic" is not a value of "error_table"'),
    ("PG104", 10, 1, 'unknown key "family" in the profile'),
    ("PG203", 12, 3, '"P0" is not a parameter number'),
    ("PG105", 13, 7, 'parameters.P1 lacks the key "type"'),
    ("PG205", 14, 14, '"Real" is not a DS47 data type'),
    ("PG205", 15, 14, "Unsigned16[4]: only strings have a length, 1..234"),
    ("PG104", 16, 29, 'unknown key "maximum" in parameters.P4'),
    ("PG107", 17, 34, "FloatingPoint takes a finite number"),
    ("PG107", 18, 30, "Integer16 takes an integer from -32768 to 32767, not -40000"),
    ("PG107", 19, 39, "min 10 is larger than max 1"),
    ("PG107", 20, 43, "the default value 11 is outside min and max"),
    ("PG107", 21, 35, '"x" is not a value of type Unsigned16'),
    ("PG104", 22, 27, 'unknown key "acess" in parameters.P10'),
    ("PG107", 23, 35, '"read" is not a value of "access"'),
    ("PG107", 24, 34, '"array": must be greater than or equal to 1, not "0"'),
    ("PG107", 25, 33, '"ramp up" is not a name'),
    ("PG107", 26, 33, 'the name "P50" reads as a parameter number'),
    ("PG107", 27, 33, "a BICO source is an Unsigned32"),
    ("PG107", 28, 42, "3 octets do not fit OctetString[2]"),
    ("PG107", 29, 38, "OctetString has no limits"),
    ("PG108", 30, 38, "ambiguous value yes"),
    ("PG106", 31, 8, "expected a mapping instead of a list"),
    ("PG103", 32, 3, "R19 is the same parameter as P19"),
    ("PG107", 33, 34, "the character U+000A is not allowed: a text is one line"),
    ("PG107", 35, 33, 'P21 has the name "ramp_up" as well'),
    ("PG203", 36, 3, '"P23[1]" is not a parameter number'),
    ("PG106", 37, 33, 'expected text instead of "5"'),
    ("PG107", 38, 35, "a text is one line of printable characters"),
    ("PG103", 40, 3, 'key "P26" appears twice'),
    ("PG107", 41, 46, "the observed value 11 is outside min and max"),
    ("PG107", 42, 57, "on: 11 is outside min and max"),
    ("PG107", 43, 33, 'P21 has the name "Ramp_Up" as well'),
]
"""Written by hand, next to the text: code, line, column, how the message begins."""

SPEC = """\
plc: {name: a, family: s7-1500, toolchain: tia-v17}
drives: {d: {device: DEVICE, hardware_id: 270}}
jobs:
  look: {drive: d, read: [ramp, torque]}
  set: {drive: d, write: {ramp: 2.0, torque: {start: 0}}, allow: {P11: agreed, P20: agreed}}
"""

ACME = """\
title: Acme Turbo
source: Acme manual 12
record_index: {profinet-global: 0xB02F, default: profinet-global}
drive_object: {default: 7, allowed: [7, 8], rule: 7 is the motor}
limits: {record: 100, parameters: 5, elements: 7}
answers: {format: size, error_words: 1}
scalar_elements: {read: 0, write: 1}
strict_length: false
error_table: profidrive
parameters:
  P20: {name: ramp, title: Ramp time, type: FloatingPoint, unit: s, min: 0, max: 10, default: 1.5, array: 3}
  p11: {name: torque, type: Integer16, min: -100, max: 100, source: chapter 4}
  R12: {name: speed, type: Unsigned16, access: r}
  P13: {name: save, type: Unsigned16, dangerous: wears the memory}
  P14: {name: source, type: Unsigned32, bico: true, default: r722.0}
"""


def write(folder: Path, device: str = "./acme.yaml", profile: str | None = ACME) -> Path:
    """A spec with a device, and the profile beside it."""
    if profile is not None:
        (folder / "acme.yaml").write_text(profile, "utf-8")
    path = folder / "job.yaml"
    path.write_text(SPEC.replace("DEVICE", device), "utf-8")
    return path


def found(path: Path) -> list[tuple[str, str, int, int, str]]:
    """Problems that a check reports; what it remarks (PG227) is none."""
    return [
        (d.code, Path(d.span.file).name, d.span.line, d.span.column, d.message)
        for d in api.check(path).diagnostics
        if d.severity.label != "note"
    ]


def planned(path: Path) -> Device:
    """The device of the only drive."""
    return api.check(path).project.plan(DrivePlan).drives[0].device


# ---- Mistakes ------------------------------------------------------------------------------------------------


def test_every_mistake_of_a_profile_is_told_in_one_run(tmp_path: Path) -> None:
    """More than 30 kinds of mistakes: each is one diagnostic at its line and column of the profile."""
    diagnostics = api.check(write(tmp_path, profile=WRONG)).diagnostics
    assert {Path(d.span.file).name for d in diagnostics} == {"acme.yaml"}
    told = [(d.code, d.span.line, d.span.column, d.message) for d in diagnostics]
    assert [entry[:3] for entry in told] == [entry[:3] for entry in MISTAKES]
    for (*_, message), (*_, start) in zip(told, MISTAKES, strict=True):
        assert message.startswith(start)
    assert len({(code, re.sub(r"[\"'].*?[\"']|\d+", "", start)) for code, _, _, start in MISTAKES}) >= 30


def test_help_names_what_was_meant(tmp_path: Path) -> None:
    """Keys and values that look like the wrong ones are offered, and all keys of the place."""
    helps = {d.span.line: d.help for d in api.check(write(tmp_path, profile=WRONG)).diagnostics}
    assert 'did you mean "source"?' in helps[2]
    assert 'did you mean "exact"? allowed: exact, size' in helps[6] or "1, 2" in helps[6]
    assert 'did you mean "FloatingPoint"?' in helps[14]
    assert (
        ", name, title, unit, access, array, scale, min, max, default, bico, values, dangerous, harmless, source"
        in helps[16]
    )
    assert 'did you mean "access"?' in helps[22]


@pytest.mark.parametrize("text", ["", "- 1", "5", "a: &a [*a]", "\0", "title: [\n", "parameters: {1: {2: {3: 4}}}"])
def test_a_file_that_is_no_profile(tmp_path: Path, text: str) -> None:
    """Whatever the file holds, the answer is diagnostics in it."""
    diagnostics = api.check(write(tmp_path, profile=text)).diagnostics
    assert diagnostics
    assert {Path(d.span.file).name for d in diagnostics} == {"acme.yaml"}
    assert all(d.span.line for d in diagnostics)


def test_a_wrong_profile_is_told_once(tmp_path: Path) -> None:
    """Two drives with one profile do not double its problems."""
    path = write(tmp_path, profile=ACME.replace("type: Integer16", "type: Integr16"))
    path.write_text(path.read_text().replace("drives: {", "drives: {e: {device: ./acme.yaml, hardware_id: 1}, "))
    assert [entry[:4] for entry in found(path)] == [("PG205", "acme.yaml", 12, 29)]


def test_a_profile_is_read_once(tmp_path: Path) -> None:
    """However many drives a spec has, they share one device."""
    path = write(tmp_path)
    path.write_text(path.read_text().replace("drives: {", "drives: {e: {device: ./acme.yaml, hardware_id: 1}, "))
    first, second = api.check(path).project.plan(DrivePlan).drives
    assert first.device is second.device


# ---- A profile beside the spec --------------------------------------------------------------------------------


def test_a_profile_says_everything_that_a_shipped_one_says(tmp_path: Path) -> None:
    """Every key reaches the device; a parameter without a source has that of the profile."""
    device = planned(write(tmp_path))
    assert replace(device, parameters={}) == Device(
        key="./acme.yaml", title="Acme Turbo", source="Acme manual 12", record_index={"profinet-global": 0xB02F},
        default_index="profinet-global", drive_object=7, drive_objects=(7, 8), drive_object_rule="7 is the motor",
        record_limit=100, max_parameters=5, max_elements=7, answer_format="size", error_words=1, scalar_elements=(0, 1),
        strict_length=False, bases=(), bico="drive-object", error_table="profidrive", parameters={},
    )  # fmt: skip
    assert device.parameters[20] == Parameter(
        20,
        "FloatingPoint",
        "ramp",
        "Ramp time",
        "s",
        "rw",
        3,
        0.0,
        10.0,
        1.5,
        source="Acme manual 12",
    )
    assert (device.parameters[11].source, device.parameters[12].access) == ("chapter 4", "r")
    assert (device.parameters[13].dangerous, device.parameters[14].bico) == ("wears the memory", True)


def test_defaults_of_a_profile_are_those_of_the_page(tmp_path: Path) -> None:
    """A title, a source, an index and an object are enough."""
    lines = ACME.splitlines(keepends=True)
    found = planned(write(tmp_path, profile="".join([*lines[:3], "drive_object: {default: 1}\n", *lines[9:]])))
    assert (found.record_limit, found.max_parameters, found.drive_objects) == (240, 39, None)
    assert (found.answer_format, found.error_words, found.scalar_elements) == ("exact", 2, (1, 1))
    assert (found.strict_length, found.error_table) == (True, "sinamics")


@pytest.mark.slow
def test_every_verb_works_with_a_profile_of_your_own(tmp_path: Path) -> None:
    """check, generate, verify, simulate and layout."""
    path = write(tmp_path)
    assert found(path) == []
    assert api.generate(path, tmp_path / "out").ok
    assert api.verify(path, tmp_path / "out").ok
    trace = api.simulate(path, tmp_path / "out")
    assert [job.ending for job in trace.jobs] == ["done", "done"]
    result = api.layout(path)
    assert not result.diagnostics


def test_its_limits_and_names_count(tmp_path: Path) -> None:
    """Values outside its limits, unknown names, drive objects and unsigned writes are reported against the profile."""
    path = write(tmp_path)
    text = path.read_text().replace("ramp: 2.0", "ramp: 11.0, save: 1").replace("torque]", "torqe]")
    path.write_text(text.replace("hardware_id", "drive_object: 9, hardware_id"))
    told = {d.code: d for d in api.check(path).diagnostics}
    assert "P20 = 11 is outside its limits 0..10 s" in told["PG209"].message
    assert told["PG203"].help == 'did you mean "torque"?'
    assert "wears the memory" in told["PG219"].message
    assert any("7 is the motor" in d.help for d in told.values())


@pytest.mark.parametrize(
    ("device", "message"),
    [
        ("../acme.yaml", 'the device profile "../acme.yaml" is not below the folder of the spec'),
        ("/etc/acme.yaml", 'the device profile "/etc/acme.yaml" is not below the folder of the spec'),
        ("sub/../../acme.yaml", 'the device profile "sub/../../acme.yaml" is not below the folder of the spec'),
        (
            r".\acme.yaml",
            r'the device profile ".\acme.yaml" is refused: it has a backslash, which separates folders on Windows',
        ),
        ("link.yaml", 'the device profile "link.yaml" is not below the folder of the spec'),
        ("loop.yaml", 'there is no device profile "loop.yaml"'),
        ("./missing.yaml", 'there is no device profile "./missing.yaml"'),
        ("./sub.yaml", 'there is no device profile "./sub.yaml"'),
        ("./pipe.yaml", 'there is no device profile "./pipe.yaml"'),
    ],
)
def test_only_files_below_the_spec_are_read(tmp_path: Path, device: str, message: str) -> None:
    """Neither a path nor a link leads out; folders and pipes are no profiles."""
    import os

    folder = tmp_path / "plant"
    (folder / "sub.yaml").mkdir(parents=True)
    (tmp_path / "acme.yaml").write_text(ACME, "utf-8")
    (folder / "link.yaml").symlink_to(tmp_path / "acme.yaml")
    (folder / "loop.yaml").symlink_to(folder / "loop.yaml")
    os.mkfifo(folder / "pipe.yaml")
    path = write(folder, device, None)
    assert found(path) == [("PG201", "job.yaml", 2, 22, message)]


def test_a_profile_in_a_folder_below_and_behind_a_link(tmp_path: Path) -> None:
    """Below the spec, links are as good as files; either ending will do."""
    (tmp_path / "lib").mkdir()
    (tmp_path / "lib" / "a.yml").write_text(ACME, "utf-8")
    (tmp_path / "b.yaml").symlink_to(tmp_path / "lib" / "a.yml")
    for device in ("lib/a.yml", "b.yaml", "./b.yaml"):
        assert found(write(tmp_path, device, None)) == []


@pytest.mark.slow
def test_texts_of_a_profile_end_no_comment(tmp_path: Path) -> None:
    """What a profile says becomes comments: none of it becomes code."""
    nasty = '"x *) END_FUNCTION_BLOCK (* {{ 7 * 7 }} // \'"'
    text = ACME.replace("Acme Turbo", nasty).replace("Ramp time", nasty).replace("unit: s", f"unit: {nasty}")
    path = write(tmp_path, profile=text.replace("Acme manual 12", nasty).replace("7 is the motor", nasty))
    assert api.generate(path, tmp_path / "out").ok
    assert api.verify(path, tmp_path / "out").ok


# ---- Profiles of installed packages ----------------------------------------------------------------------------


@pytest.fixture
def installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder of installed packages; what is found there is looked up again in every test."""
    site = tmp_path / "site"
    site.mkdir()
    monkeypatch.syspath_prepend(str(site))
    devices._packaged.cache_clear()
    yield site
    devices._packaged.cache_clear()
    for name in [name for name in sys.modules if name.startswith("toy_")]:
        del sys.modules[name]


def install(site: Path, name: str, target: str, code: str = "") -> Path:
    """A package with the entry point ``name``; its folder."""
    info = site / f"{name}-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(f"[plcgen.devices]\n{name} = {target}\n")
    package = site / target.partition(":")[0]
    package.mkdir(exist_ok=True)
    (package / "__init__.py").write_text(code)
    return package


def test_a_package_brings_devices(installed: Path, tmp_path: Path) -> None:
    """A toy device without a change of plcgen: its name is known, listed, offered to editors, and works."""
    (install(installed, "toy", "toy_drives") / "acme-turbo.yaml").write_text(ACME, "utf-8")
    path = write(tmp_path, "acme-turbo", None)
    assert found(path) == []
    assert planned(path).key == "acme-turbo"
    assert "acme-turbo" in devices.device_names()
    assert devices.find_device("acme-turbo").title == "Acme Turbo"
    offered = api.schema()["$defs"]["DriveEntry"]["properties"]["device"]["anyOf"][0]["enum"]
    assert "acme-turbo" in offered
    path.write_text(path.read_text().replace("acme-turbo", "acme-turbu"))
    (told,) = api.check(path).diagnostics
    assert 'did you mean "acme-turbo"?' in told.help


@pytest.mark.parametrize("target", ["toy_paths:FOLDER", "toy_paths:FILE"])
def test_a_package_names_a_folder_or_a_file(installed: Path, target: str) -> None:
    """An entry point may also be a path."""
    code = "from pathlib import Path\nFOLDER = Path(__file__).parent / 'data'\nFILE = str(FOLDER / 'acme.yaml')\n"
    data = install(installed, "toy", target, code) / "data"
    data.mkdir()
    (data / "acme.yaml").write_text(ACME, "utf-8")
    assert devices.find_device("acme").drive_object == 7


def test_packages_are_loaded_only_when_needed(installed: Path, tmp_path: Path) -> None:
    """A package that fails does not harm a spec with shipped devices; it is told where its device may be meant."""
    install(installed, "toy", "toy_broken", "raise RuntimeError('no licence')")
    path = write(tmp_path, "sinamics-g120", None)
    path.write_text(path.read_text().replace("[ramp, torque]", "[actual_speed]").partition("  set:")[0])
    assert found(path) == []
    assert "toy_broken" not in sys.modules
    with pytest.raises(PluginError, match=r"toy_broken.* cannot be loaded: no licence"):
        api.check(write(tmp_path, "acme", None))


def test_an_entry_point_is_a_package_or_a_path(installed: Path) -> None:
    """Anything else is told with its name."""
    install(installed, "toy", "toy_number:FIVE", "FIVE = 5")
    with pytest.raises(PluginError, match=r"the entry point toy in plcgen\.devices is neither a package nor a path"):
        devices.device_names()


def test_a_package_does_not_replace_a_shipped_device(installed: Path) -> None:
    """The same name means the same device on every machine."""
    (install(installed, "toy", "toy_drives") / "sinamics-g120.yaml").write_text(ACME, "utf-8")
    assert devices.find_device("sinamics-g120").title.startswith("SINAMICS G120")


def test_mistakes_in_the_profile_of_a_package_have_a_place(installed: Path, tmp_path: Path) -> None:
    """They are told like those of a profile of your own."""
    (install(installed, "toy", "toy_drives") / "acme.yaml").write_text(ACME.replace("unit", "units"), "utf-8")
    assert [entry[:4] for entry in found(write(tmp_path, "acme", None))] == [("PG104", "acme.yaml", 11, 60)]


# ---- The page ------------------------------------------------------------------------------------------------


def test_every_key_is_on_the_page() -> None:
    """docs/devices.md describes every key of a profile, and nothing that is none."""
    models = (
        DeviceProfile,
        RecordIndexes,
        DriveObjects,
        ProfileObjects,
        ProfileList,
        ProfileLimits,
        Answers,
        Changes,
        ScalarElements,
        ParameterEntry,
    )
    keys = {info.alias or name for model in models for name, info in model.model_fields.items()}
    section = PAGE[PAGE.index("## A profile of your own") :]
    table = {
        key for row in re.findall(r"^\| (`[^|]*) \|", section, re.MULTILINE) for key in re.findall(r"`([^`]+)`", row)
    }
    assert {key.rpartition(".")[2] for key in table} == keys


def test_the_profile_of_the_page_is_valid(tmp_path: Path) -> None:
    """It can be copied and used."""
    (text,) = re.findall(r"```yaml\n(title:.*?)```", PAGE, re.DOTALL)
    (tmp_path / "acme.yaml").write_text(text, "utf-8")
    device = devices.find_device(str(tmp_path / "acme.yaml"))
    assert device.parameters
    assert set(yaml.safe_load(text)) == set(DeviceProfile.model_fields)


def test_shipped_profiles_name_no_default_twice() -> None:
    """All of them can be read."""
    for path in (specs_dir() / "devices").glob("*.yaml"):
        assert devices.find_device(path.stem).key == path.stem


def test_a_profile_on_the_command_line_may_lie_anywhere(tmp_path: Path) -> None:
    """``--device PATH`` was typed by you, so it is read wherever it is."""
    with pytest.raises(DiagnosticError, match="no such file"):
        devices.find_device(str(tmp_path / "acme.yaml"))
    write(tmp_path)
    assert devices.find_device(str(tmp_path / "acme.yaml")).drive_object == 7


def test_a_parameter_is_there_or_absent(tmp_path: Path) -> None:
    """Not both, whatever letter and zeros it is written with; one that is absent is not found in a list either."""
    own = tmp_path / "acme.yaml"
    head = "title: A\nsource: m\nrecord_index: {profibus: 47, default: profibus}\ndrive_object: {default: 1}\n"
    lists = "lists: [{list: vector, objects: [VECTOR], grade: inferred}]\n"
    own.write_text(f"{head}absent: {{r0021: {{source: m}}}}\nparameters: {{P21: {{type: FloatingPoint}}}}\n", "utf-8")
    with pytest.raises(DiagnosticError) as wrong:
        devices.find_device(str(own))
    (told,) = wrong.value.diagnostics
    assert (told.code, told.message, told.span.line) == ("PG103", "P21 is among the absent parameters, too", 6)
    own.write_text(f"{head}{lists}sources: {{p9: manual p. 9}}\nabsent: {{r0021: {{source: p9}}}}\n", "utf-8")
    device = devices.find_device(str(own))
    assert device.find(21) is None
    assert device.find(22) is not None
    assert (device.absent(21, ""), device.lacks(21, "")) == (("manual p. 9",), "surely")
    own.write_text(own.read_text("utf-8").replace("source: p9", "source: p9, grade: inferred"), "utf-8")
    device = devices.find_device(str(own))
    assert (device.absent(21, ""), device.lacks(21, "")) == (("manual p. 9 (inferred)",), "perhaps")
