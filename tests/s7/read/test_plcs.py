"""Several PLCs in one folder: a namespace for each, in every verb that reads sources."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import plcgen
from plcgen.s7.read.plcs import by_plc, plc_folder, plc_names

TYPE = 'TYPE "Unit"\nVERSION : 0.1\n  STRUCT\n    a : {type};\n  END_STRUCT;\nEND_TYPE\n'
DATA = """DATA_BLOCK "Plant"
{{ S7_Optimized_Access := 'FALSE' }}
VERSION : 0.1
  STRUCT
    u : "{type}";
  END_STRUCT;
BEGIN
END_DATA_BLOCK
"""


def project(folder: Path, first: str = "Int", second: str = "Real", shared: str = "") -> Path:
    """Two PLCs with blocks of the same names, as the version control interface writes them."""
    for plc, type_ in (("PLC_1", first), ("PLC_2", second)):
        for group, name, text in (
            ("PLC data types", "Unit.udt", TYPE.format(type=type_)),
            ("Program blocks/Line", "Plant.db", DATA.format(type=shared or "Unit")),
        ):
            path = folder / plc / group / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, "utf-8-sig")
    return folder


@pytest.mark.parametrize(
    ("path", "folder"),
    [
        ("a/PLC_1/Program blocks/Line/X.xml", "a/PLC_1"),
        ("a/PLC_1/PLC data types/X.udt", "a/PLC_1"),
        ("a/PLC_1/Software units/Unit_1/Program blocks/X.xml", "a/PLC_1"),
        ("SPS/Programmbausteine/X.xml", "SPS"),
        ("src/X.scl", None),
    ],
)
def test_the_plc_of_a_file_is_the_folder_around_the_groups_of_its_project_tree(path: str, folder: str | None) -> None:
    """The outermost one: a software unit is a part of its PLC."""
    assert plc_folder(Path(path)) == (None if folder is None else Path(folder))


def test_one_plc_is_no_reason_to_tell_files_apart() -> None:
    """Files beside it are its files."""
    paths = [Path("PLC_1/Program blocks/a.xml"), Path("lib/b.scl")]
    assert by_plc(paths) == {None: paths}


def test_plcs_of_the_same_name_have_more_of_their_path_as_name() -> None:
    """As much as it needs."""
    folders = [Path("a/PLC_1"), Path("b/PLC_1")]
    assert plc_names([None, *folders]) == {None: "", folders[0]: "a/PLC_1", folders[1]: "b/PLC_1"}


def generated(folder: Path, plc: str) -> Path:
    """A source of a folder that plcgen generated for a PLC."""
    (folder / "db").mkdir(parents=True)
    (folder / "manifest.json").write_text(
        json.dumps({"project": plc, "files": [{"path": "db/Jobs.db", "sha256": ""}]}), "utf-8"
    )
    source = folder / "db" / "Jobs.db"
    source.write_text(DATA.format(type="Unit").replace('"Unit"', "Int"), "utf-8-sig")
    return source


def test_the_folders_of_several_specs_are_plcs_of_their_own(tmp_path: Path) -> None:
    """What lies around one of them belongs to it, and what lies beside all of them to none."""
    press = generated(tmp_path / "press" / "job_generated", "PLC")
    saw = generated(tmp_path / "saw" / "job_generated", "PLC")
    own, library = tmp_path / "saw" / "src" / "Own.scl", tmp_path / "lib" / "Lib.udt"
    assert by_plc([press, saw, own, library]) == {
        tmp_path / "press": [press],
        tmp_path / "saw": [saw, own],
        None: [library],
    }
    beside = [generated(tmp_path / "flat" / name, name) for name in ("a_generated", "b_generated")]
    assert list(by_plc(beside)) == [tmp_path / "flat" / "a_generated", tmp_path / "flat" / "b_generated"]


def test_several_specs_of_one_plc(tmp_path: Path) -> None:
    """Folders beside each other with the name of one PLC: drives in one spec, stations in the other."""
    made = [generated(tmp_path / name, "PLC") for name in ("drives_generated", "pumps_generated")]
    assert by_plc(made) == {None: made}
    other = generated(tmp_path / "saw_generated", "Saw")
    assert [len(files) for files in by_plc([*made, other]).values()] == [2, 1]


def test_a_change_for_one_of_several_specs(tmp_path: Path) -> None:
    """Blocks of one name in two generated folders: a change of either is a change."""
    for state in ("old", "new"):
        for plc in ("press", "saw"):
            generated(tmp_path / state / f"{plc}_generated", plc)
    assert plcgen.diff(tmp_path / "old", tmp_path / "new").changes == ()
    changed = tmp_path / "new" / "saw_generated" / "db" / "Jobs.db"
    changed.write_text(changed.read_text("utf-8-sig").replace("u : Int", "u : Real"), "utf-8-sig")
    result = plcgen.diff(tmp_path / "old", tmp_path / "new")
    assert result.diagnostics == ()
    assert ('DB "saw_generated/Plant"', "type-changed") in [(change.subject, change.kind) for change in result.changes]
    assert plcgen.lock(tmp_path / "new", out=tmp_path / "lock.json").blocks == 2


def test_each_plc_has_its_own_types(tmp_path: Path) -> None:
    """An Int is 2 bytes, a Real 4: each Plant is laid out with the Unit of its PLC, and nothing is declared twice."""
    result = plcgen.layout(project(tmp_path))
    assert result.diagnostics == ()
    assert {(block.kind, block.name): block.size for block in result.blocks} == {
        ("UDT", "PLC_1/Unit"): 2, ("DB", "PLC_1/Plant"): 2, ("UDT", "PLC_2/Unit"): 4, ("DB", "PLC_2/Plant"): 4,
    }  # fmt: skip
    assert len(plcgen.layout(tmp_path, block="Plant").blocks) == 2


def test_files_of_no_plc_are_there_for_all(tmp_path: Path) -> None:
    """A library beside the PLCs."""
    (project(tmp_path, shared="Lib") / "lib").mkdir()
    (tmp_path / "lib" / "Lib.udt").write_text(TYPE.format(type="LReal").replace("Unit", "Lib"), "utf-8-sig")
    result = plcgen.layout(tmp_path)
    assert result.diagnostics == ()
    assert {block.size for block in result.blocks if block.kind == "DB"} == {8}


def test_diff_compares_each_plc_with_itself(tmp_path: Path) -> None:
    """Only what changed in PLC_2 is told, of PLC_2."""
    old, new = project(tmp_path / "old"), project(tmp_path / "new", second="DWord")
    result = plcgen.diff(old, new)
    assert result.diagnostics == ()
    assert [(change.subject, change.kind) for change in result.changes] == [('UDT "PLC_2/Unit"', "type-changed")]


def test_a_lock_has_every_plc_of_its_folder(tmp_path: Path) -> None:
    """Written, found as written, and a change of one PLC is a change of that one."""
    lock = tmp_path / "plcgen.lock.json"
    written = plcgen.lock(project(tmp_path / "plant"), out=lock)
    assert (written.ok, written.blocks) == (True, 4)
    assert plcgen.check_lock(lock=lock).changes == ()
    project(tmp_path / "plant", first="DInt")
    assert {change.subject for change in plcgen.check_lock(lock=lock).changes} == {
        'UDT "PLC_1/Unit"', 'DB "PLC_1/Plant"',
    }  # fmt: skip


def test_convert_writes_a_folder_for_each_plc(tmp_path: Path) -> None:
    """Blocks of the same name do not meet."""
    result = plcgen.convert(project(tmp_path / "in"), to="xml", out=tmp_path / "out")
    assert result.diagnostics == ()
    assert sorted(result.written) == ["PLC_1/Plant.xml", "PLC_1/Unit.xml", "PLC_2/Plant.xml", "PLC_2/Unit.xml"]
