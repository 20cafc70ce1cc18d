"""Several PLCs in one folder: a namespace for each, in every verb that reads sources."""

from __future__ import annotations

from pathlib import Path

import pytest

import plcgen
from plcgen.sources.plcs import by_plc, plc_folder, plc_names

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
    lock = tmp_path / "plcgen.lock.yaml"
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
