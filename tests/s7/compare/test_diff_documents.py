"""Semantic differences of instances, and of the same block as text and as document."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

import plcgen
from tests.projects import ROOT

INSTANCE_FB = """FUNCTION_BLOCK "Motor"
{ S7_Optimized_Access := 'FALSE' }
VERSION : 0.1
VAR_INPUT
  speed : Int := 5;
  limit : Int := 16#10;
END_VAR
VAR
  part : STRUCT
    low : Int := 3;
  END_STRUCT;
  table : Array[0..2] of Int := [1, 2, 3];
END_VAR
BEGIN
;
END_FUNCTION_BLOCK
"""
INSTANCE_DB = """DATA_BLOCK "Motor_DB"
{ S7_Optimized_Access := 'FALSE' }
VERSION : 0.1
NON_RETAIN
"Motor"
BEGIN
  speed := 7;
  table[1] := 0;
END_DATA_BLOCK
"""


@pytest.fixture
def twins(tmp_path):
    """A function block and its instance as text and as documents."""
    for name, text in (("Motor.scl", INSTANCE_FB), ("Motor_DB.db", INSTANCE_DB)):
        (tmp_path / "text").mkdir(exist_ok=True)
        (tmp_path / "text" / name).write_text(text, "utf-8-sig")
    assert plcgen.convert(tmp_path / "text", to="xml", out=tmp_path / "xml").diagnostics == ()
    return tmp_path


@pytest.mark.parametrize(
    ("line", "changed", "path", "values"),
    [
        ("speed := 7;", "speed := 8;", "SPEED", ("7", "8")),
        ("speed := 7;", "", "SPEED", ("7", "")),
        ("table[1] := 0;", "table[1] := 4;", "TABLE[1]", ("0", "4")),
        ("speed := 7;", "speed := 7;\n  part.low := 4;", "PART.LOW", ("", "4")),
        ("speed := 7;", "speed := 16#7;\n  limit := 16;", "", None),
    ],
)
@pytest.mark.parametrize("with_owner", [True, False], ids=["with FB", "DB alone"])
def test_start_values_of_instances(twins, line, changed, path, values, with_owner):
    """Text against text, text against document, document against document: the same change everywhere."""
    (twins / "new").mkdir()
    (twins / "new/Motor.scl").write_text(INSTANCE_FB, "utf-8-sig")
    (twins / "new/Motor_DB.db").write_text(INSTANCE_DB.replace(line, changed), "utf-8-sig")
    assert plcgen.convert(twins / "new", to="xml", out=twins / "new_xml").ok
    if not with_owner:
        for name in ("xml/Motor.xml", "new_xml/Motor.xml"):
            (twins / name).unlink()
        old_new = [("xml", "new_xml")]
    else:
        old_new = [("text", "new"), ("text", "new_xml"), ("xml", "new"), ("xml", "new_xml")]
    for old, new in old_new:
        changes = plcgen.diff(twins / old, twins / new).changes
        if values is None:
            assert changes == ()
            continue
        if not with_owner:  # every value of a document counts: that of the function block is one of them
            values = (values[0] or "3", values[1] or "5")
        assert [(c.kind, c.path, c.old, c.new) for c in changes] == [("start-value", path, *values)], (old, new)
    assert plcgen.diff(twins / "text/Motor_DB.db", twins / "xml/Motor_DB.xml").changes == ()


def test_a_lock_sees_a_start_value_of_an_instance_document(twins):
    """One StartValue edited in the export of an instance: the lock of the exports differs."""
    lock, path = twins / "plcgen.lock.json", twins / "xml/Motor_DB.xml"
    assert plcgen.lock(twins / "xml", out=lock).ok
    assert plcgen.check_lock(twins / "xml", lock=lock).changes == ()
    path.write_text(path.read_text("utf-8-sig").replace(">7</StartValue>", ">9</StartValue>"), "utf-8-sig")
    found = [(c.kind, c.path, c.old, c.new) for c in plcgen.check_lock(twins / "xml", lock=lock).changes]
    assert found == [("start-value", "SPEED", "7", "9")]


def test_text_and_document_of_a_block_are_equal(tmp_path: Path) -> None:
    """Types, data blocks, function blocks with instances of library blocks, OBs: no change, not even of a text."""
    expected = ROOT / "examples" / "s7-1500_g120_pn" / "expected"
    for file in ("Pump_station.scl", "example/Main.scl"):
        (tmp_path / "text" / file).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(expected / file, tmp_path / "text" / file)
    result = plcgen.diff(tmp_path / "text", expected / "xml")
    assert result.diagnostics == ()
    assert [(change.subject, change.kind, change.message) for change in result.changes] == []


ATTRIBUTES = """DATA_BLOCK "D"
{ {0}S7_Optimized_Access := 'TRUE' }
NON_RETAIN
STRUCT
  a : Int;
END_STRUCT;
BEGIN
END_DATA_BLOCK
"""


@pytest.mark.parametrize(
    ("attribute", "braces", "from_text", "from_document"),
    [
        # 100 bytes are the default of a new block; other values have no place in a text.
        ("<MemoryReserve>100</MemoryReserve>", "", [], []),
        ("<MemoryReserve>200</MemoryReserve>", "", [], ["MemoryReserve (absent) -> 200"]),
        ("<IsIECCheckEnabled>true</IsIECCheckEnabled>", "", [], ["IsIECCheckEnabled (absent) -> true"]),
        # Both can say this, each in its spelling.
        ("<DBAccessibleFromOPCUA>false</DBAccessibleFromOPCUA>", "DB_Accessible_From_OPC_UA := 'FALSE'; ", [], None),
        ("", "DB_Accessible_From_OPC_UA := 'FALSE'; ", ["DB_Accessible_From_OPC_UA FALSE -> (absent)"], None),
        ("", "DB_Accessible_From_OPC_UA := 'TRUE'; ", [], None),
    ],
)
def test_attributes_of_text_and_document(
    attribute: str, braces: str, from_text: list[str], from_document: list[str] | None, tmp_path: Path
) -> None:
    """What a text cannot state is no difference to one; between documents, other values than the default are."""
    text = tmp_path / "D.db"
    text.write_text(ATTRIBUTES.replace("{0}", ""), "utf-8-sig")
    assert plcgen.convert(text, to="xml", out=tmp_path / "xml").ok
    text.write_text(ATTRIBUTES.replace("{0}", braces), "utf-8-sig")
    plain, document = tmp_path / "xml/D.xml", tmp_path / "D.xml"
    document.write_text(plain.read_text("utf-8-sig").replace("<Interface>", f"{attribute}<Interface>"), "utf-8-sig")
    assert [c.message for c in plcgen.diff(text, document).changes] == from_text
    assert len(plcgen.diff(document, text).changes) == len(from_text)
    if from_document is not None:
        assert [c.message for c in plcgen.diff(plain, document).changes] == from_document
        assert len(plcgen.diff(document, plain).changes) == len(from_document)
    lock = tmp_path / "plcgen.lock.json"
    assert plcgen.lock(text, out=lock).ok
    assert [c.message for c in plcgen.check_lock(document, lock=lock).changes] == (from_document or from_text)


def test_a_timer_with_its_members_written_out_is_its_text(tmp_path: Path) -> None:
    """Exports repeat the members of a library block; with optimized access nobody sees how long it is."""
    text = """DATA_BLOCK "T"
{ InstructionName := 'IEC_TIMER'; LibVersion := '1.0'; S7_Optimized_Access := 'TRUE' }
NON_RETAIN
IEC_TIMER
BEGIN
END_DATA_BLOCK
"""
    (tmp_path / "T.db").write_text(text, "utf-8-sig")
    assert plcgen.convert(tmp_path / "T.db", to="xml", out=tmp_path / "xml").ok
    document = tmp_path / "xml/T.xml"
    members = "".join(
        f'<Member Name="{n}" Datatype="{t}" />' for n, t in (("PT", "Time"), ("ET", "Time"), ("IN", "Bool"))
    )
    empty = '<Section Name="Static" />'
    written = document.read_text("utf-8-sig")
    assert empty in written
    document.write_text(written.replace(empty, f'<Section Name="Static">{members}</Section>'), "utf-8-sig")
    assert plcgen.diff(tmp_path / "T.db", document).changes == ()
    assert plcgen.diff(document, tmp_path / "T.db").changes == ()
