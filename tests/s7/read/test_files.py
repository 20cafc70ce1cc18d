"""Files and folders to blocks and types: several files at once, twins, symbol tables, broken input."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from plcgen import api
from plcgen.s7.layout.layout import layout_block
from plcgen.s7.read.files import read_files, read_symbols
from tests.s7.xml.reading.documents import document, global_db

UDT = "TYPE UDT 5\nTITLE =Motor\nVERSION : 0.1\n  STRUCT\n   a : INT ;\n   b : BOOL ;\n  END_STRUCT ;\nEND_TYPE\n"
DB = """DATA_BLOCK DB 3
TITLE =Auftragspuffer
//mehrzeiliger Kommentar
//Größe, zweite Zeile
{ S7_m_c := 'true' }
AUTHOR : Muster
FAMILY : DS47
NAME : WR_BUF
VERSION : 0.1

  STRUCT
   Request_Ref : BYTE  := B#16#3;	//Referenz
   Arr : ARRAY  [1 .. 10 ] OF //Kommentar
   BYTE  := B#16#0, B#16#1;
   p { S7_visible := 'false' }: STRUCT
    x : BOOL ;	//Bit
    u : UDT 5;
   END_STRUCT ;
  END_STRUCT ;
BEGIN
   Request_Ref := B#16#4;
   Arr[1] := B#16#1;
   p.u.a := 7;
END_DATA_BLOCK
"""


def write(folder: Path, **files: str) -> Path:
    for name, text in files.items():
        path = folder / name.replace("__", "/").replace("_dot_", ".")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return folder


def codes(diagnostics):
    return [d.code for d in diagnostics]


@pytest.mark.parametrize("encoding", ["utf-8-sig", "cp1252", "utf-16", "utf-8"])
def test_a_statement_list_export_is_read_whatever_its_encoding(tmp_path, encoding):
    """STEP 7 V5 writes blanks inside brackets, comments between OF and the type, attributes in braces.

    Request_Ref 0, Arr 2..11, p 12 (x 12.0, u 14..17), 18 bytes; BEGIN overrides the declared value.
    """
    (tmp_path / "a.awl").write_text(UDT + DB, encoding=encoding)
    result = api.layout(tmp_path / "a.awl")
    assert result.diagnostics == ()
    udt, db = result.blocks
    assert (udt.size, db.size, db.number, db.comment) == (4, 18, 3, "Auftragspuffer")
    rows = [(row.offset, row.address, row.name, row.start, row.comment) for row in db.rows if row.kind == "member"]
    assert rows == [
        ("0.0", "DB3.DBB0", "Request_Ref", "B#16#4", "Referenz"),
        ("2.0", "DB3.DBB2", "Arr", "B#16#0, B#16#1, [1] := B#16#1", ""),
        ("12.0", "DB3.DBB12", "p", "", ""),
        ("12.0", "DB3.DBX12.0", "x", "", "Bit"),
        ("14.0", "DB3.DBB14", "u", "", ""),
        ("14.0", "DB3.DBW14", "a", "7", ""),
        ("16.0", "DB3.DBX16.0", "b", "", ""),
    ]


INSTANCES = """FUNCTION_BLOCK "Antrieb"
VAR_INPUT
  zeit : TIMER ;
  zaehler : COUNTER ;
  bl : BLOCK_FB ;
  a : ANY ;
  p : POINTER ;
END_VAR
VAR_OUTPUT
  laeuft : BOOL ;
END_VAR
VAR_IN_OUT
  st : STRUCT
   a : INT ;
  END_STRUCT ;
  i : INT ;
END_VAR
VAR
  ton1 : "TON";
  wr : SFB 53;
  sub : FB 12;
  q : BOOL ;
END_VAR
VAR_TEMP
  tmp : ARRAY [0..9] OF REAL ;
END_VAR
BEGIN
NETWORK
TITLE =Netz 1
      U     #q;
END_FUNCTION_BLOCK
FUNCTION_BLOCK FB 12
VAR
  x : BOOL ;
  inner : FB 13;
END_VAR
BEGIN
END_FUNCTION_BLOCK
FUNCTION_BLOCK FB 13
CONST
  last := 2 * 2 - 3;
END_CONST
VAR
  y : ARRAY [-1..last] OF UDT 5;
  w : DWORD;
  v AT w : ARRAY [0..3] OF BYTE;
END_VAR
BEGIN
END_FUNCTION_BLOCK
DATA_BLOCK "Inst"
TITLE =
VERSION : 0.0

 "Antrieb"
BEGIN
END_DATA_BLOCK
DATA_BLOCK DB 8
 UDT 5
BEGIN
   a := 3;
END_DATA_BLOCK
"""


def test_multi_instances_inside_each_other(tmp_path):
    """IN 0..21, OUT 22, IN_OUT 24..31, ton1 32 (22 bytes), wr 54 (26), sub 80: x, inner 82: y 12, w 4; q 98.

    The IN_OUT structure is a pointer of 6 bytes; TEMP and views take none; y has three elements of 4 bytes.
    """
    (tmp_path / "a.awl").write_text(UDT + INSTANCES, encoding="utf-8")
    tables = {table.name: table for table in api.layout(tmp_path / "a.awl").blocks}
    places = {row.name: row.byte for row in tables["Inst"].rows if row.depth == 0 and row.kind == "member"}
    assert places == {
        "zeit": 0, "zaehler": 2, "bl": 4, "a": 6, "p": 16, "laeuft": 22, "st": 24, "i": 30, "ton1": 32, "wr": 54,
        "sub": 80, "q": 98,
    }  # fmt: skip
    assert tables["Inst"].size == tables["Antrieb"].size == 100
    assert {row.name: row.type for row in tables["Inst"].rows}["st"] == "POINTER to STRUCT"
    assert [row.offset for row in tables["FB13"].rows if row.name in {"w", "v"}] == ["12.0", "12.0"]
    assert [row.start for row in tables["DB8"].rows if row.name == "a"] == ["3"]


def test_types_are_found_across_files_whatever_their_order(tmp_path):
    write(tmp_path, a_dot_db='DATA_BLOCK "D"\nSTRUCT\n x : "T";\nEND_STRUCT\nBEGIN\nEND_DATA_BLOCK\n')
    write(tmp_path, t_dot_udt='TYPE "T"\nSTRUCT\n y : INT;\nEND_STRUCT\nEND_TYPE\n')
    for paths in (("a.db", "t.udt"), ("t.udt", "a.db"), (".",)):
        result = api.layout(*(tmp_path / path for path in paths))
        assert (result.diagnostics, sorted(b.size for b in result.blocks)) == ((), [2, 2])


def test_a_missing_type_is_named_once_with_every_place_that_uses_it(tmp_path):
    """Two blocks use it three times: one PG806, two notes; an instance DB names its missing FB."""
    text = 'DATA_BLOCK "D"\nSTRUCT\n x : "Motr";\n y : "Motr";\nEND_STRUCT\nBEGIN\nEND_DATA_BLOCK\n'
    other = 'TYPE "Motor"\nSTRUCT\n z : "Motr";\nEND_STRUCT\nEND_TYPE\nDATA_BLOCK DB 9\n FB 99\nBEGIN\nEND_DATA_BLOCK\n'
    write(tmp_path, a_dot_db=text, b_dot_awl=other)
    result = api.layout(tmp_path)
    missing, instance = result.diagnostics
    assert (missing.code, missing.message, missing.help) == ("PG806", "unknown data type Motr", 'did you mean "MOTOR"?')
    assert [(Path(note.span.file).name, note.span.line) for note in missing.notes] == [("a.db", 4), ("b.awl", 3)]
    assert (instance.message, instance.span.line) == ("unknown data type FB99", 6)
    assert "name the file that declares it" in instance.help


def test_a_system_block_without_known_members_is_said_to_be_one(tmp_path):
    """A system function block, and what GRAPH keeps for each step."""
    graph = 'DATA_BLOCK "S"\nSTRUCT\n Step1 : G7_StepPlus_V6;\nEND_STRUCT\nBEGIN\nEND_DATA_BLOCK\n'
    write(tmp_path, a_dot_awl="DATA_BLOCK DB 9\n SFB 33\nBEGIN\nEND_DATA_BLOCK\n", b_dot_db=graph)
    problems = api.layout(tmp_path).diagnostics
    names = ("SFB33", "G7_StepPlus_V6")
    assert [problem.message for problem in problems] == [
        f"the members of {name} are not known to plcgen" for name in names
    ]


def test_a_block_with_a_bound_from_elsewhere_is_no_layout(tmp_path):
    """The value of "MAX" stands in a tag table: neither the type nor what is made from it has known offsets."""
    write(
        tmp_path,
        a_dot_udt='TYPE "T"\nSTRUCT\n a : ARRAY[1.."MAX"] OF INT;\nEND_STRUCT\nEND_TYPE\n',
        b_dot_db='DATA_BLOCK "D"\nSTRUCT\n x : "T";\nEND_STRUCT\nBEGIN\nEND_DATA_BLOCK\n',
        c_dot_db='DATA_BLOCK "E"\nSTRUCT\n x : INT;\nEND_STRUCT\nBEGIN\nEND_DATA_BLOCK\n',
    )
    result = api.layout(tmp_path)
    assert [block.name for block in result.blocks] == ["E"]
    assert [(d.code, d.severity.label) for d in result.diagnostics] == [("PG806", "error"), ("PG806", "error")]


def test_an_array_without_bounds_is_a_pointer_as_in_out(tmp_path):
    text = "FUNCTION_BLOCK F\nVAR_IN_OUT\n a : ARRAY[*] OF INT;\n b : BOOL;\nEND_VAR\nBEGIN\nEND_FUNCTION_BLOCK\n"
    write(tmp_path, f_dot_scl=text)
    (table,) = api.layout(tmp_path / "f.scl").blocks
    assert [(row.offset, row.size) for row in table.rows[:2]] == [("0.0", "6 B"), ("6.0", "1 bit")]
    write(tmp_path, f_dot_scl=text.replace("VAR_IN_OUT", "VAR_INPUT"))
    assert codes(api.layout(tmp_path / "f.scl").diagnostics) == ["PG806"]


def test_a_symbol_table_gives_numbers_to_symbols(tmp_path):
    """UDT 5 is declared by its symbol; the DB by its symbol gets the number 7 and so addresses."""
    (tmp_path / "s.sdf").write_text('"MotorTyp","UDT 5","UDT 5","größer"\n"Puffer","DB 7","DB 7",""\n', "cp1252")
    write(
        tmp_path,
        a_dot_awl='DATA_BLOCK "Puffer"\nSTRUCT\n m : UDT 5;\nEND_STRUCT\nBEGIN\nEND_DATA_BLOCK\n',
        b_dot_udt='TYPE "MotorTyp"\nSTRUCT\n y : INT;\nEND_STRUCT\nEND_TYPE\n',
    )
    result = api.layout(tmp_path, block="DB7")
    assert result.diagnostics == ()
    assert [row.address for row in result.blocks[0].rows] == ["DB7.DBB0", "DB7.DBW0"]
    write(
        tmp_path, a_dot_awl=UDT + 'DATA_BLOCK "Puffer"\nSTRUCT\n m : "MotorTyp";\nEND_STRUCT\nBEGIN\nEND_DATA_BLOCK\n'
    )
    (tmp_path / "b.udt").unlink()
    result = api.layout(tmp_path, block="Puffer")  # and the other way round: declared by number, used by symbol
    assert (result.diagnostics, result.blocks[0].size) == ((), 4)
    path = tmp_path / "s.asc"
    path.write_text("126,MotorTyp                UDT     5   UDT     5 Kommentar\n126,x   E 0.0\nrubbish\n", "cp1252")
    assert read_symbols(path) == ({"MotorTyp": "UDT5"}, [])


def test_of_text_and_document_the_text_counts_and_a_second_text_is_a_warning(tmp_path):
    xml = document(global_db('<Member Name="v" Datatype="Int" />', name="D"))
    (tmp_path / "a.xml").write_bytes(xml)
    text = (
        "DATA_BLOCK \"D\"\n{ S7_Optimized_Access := 'FALSE' }\nSTRUCT\n v : INT;\nEND_STRUCT\nBEGIN\nEND_DATA_BLOCK\n"
    )
    write(tmp_path, d_dot_db=text)
    (block,) = read_files([tmp_path]).blocks
    assert block.span is not None
    assert block.span.file.endswith("d.db")
    assert block.number == 3  # only the document says it
    write(tmp_path, sub__e_dot_db=text)
    found = read_files([tmp_path])
    assert (len(found.blocks), codes(found.diagnostics)) == (1, ["PG805"])
    assert found.diagnostics[0].severity.label == "warning"


def test_strangers_in_a_folder_are_no_mistake_but_are_one_if_named(tmp_path):
    write(tmp_path, x_dot_xml="<note/>", y_dot_txt="nothing", u_dot_udt=UDT, _dot_hidden__z_dot_db="broken")
    assert (len(read_files([tmp_path]).blocks), read_files([tmp_path]).diagnostics) == (1, [])
    assert codes(read_files([tmp_path / "x.xml"]).diagnostics) == ["PG812"]
    (tmp_path / "empty").mkdir()
    assert codes(read_files([tmp_path / "empty"]).diagnostics) == ["PG804"]


@pytest.mark.skipif(os.name != "posix" or os.geteuid() == 0, reason="needs a user without all rights")
def test_a_file_without_permission_is_a_diagnostic(tmp_path):
    write(tmp_path, u_dot_udt=UDT)
    (tmp_path / "u.udt").chmod(0)
    assert codes(read_files([tmp_path / "u.udt"]).diagnostics) == ["PG804"]


def test_a_circle_over_two_files_is_found_once(tmp_path):
    write(
        tmp_path,
        a_dot_udt='TYPE "A"\nSTRUCT\n b : "B";\nEND_STRUCT\nEND_TYPE\n',
        b_dot_udt='TYPE "B"\nSTRUCT\n a : ARRAY[0..1] OF "A";\nEND_STRUCT\nEND_TYPE\n',
        d_dot_db='DATA_BLOCK "D"\nSTRUCT\n a : "A";\nEND_STRUCT\nBEGIN\nEND_DATA_BLOCK\n',
    )
    (problem,) = api.layout(tmp_path).diagnostics
    assert (problem.code, problem.message) == ("PG807", "a type must not contain itself: A -> B -> A")


def test_a_member_declared_twice_is_reported_once(tmp_path):
    write(tmp_path, a_dot_db='DATA_BLOCK "D"\nSTRUCT\n a : INT;\n A : INT;\nEND_STRUCT\nBEGIN\nEND_DATA_BLOCK\n')
    (problem,) = api.layout(tmp_path).diagnostics
    assert (problem.code, problem.span.line, problem.notes[0].span.line) == ("PG805", 4, 3)


def test_the_family_decides_what_a_timer_is(tmp_path):
    """16 bytes on S7-1200/1500, 22 bytes (SFB4) on S7-300/400 and wherever STEP 7 V5 calls it by its symbol."""
    for spelling, family, size in (
        ("TON", None, 16),
        ("TON", "s7-300", 22),
        ("TON_TIME", "s7-1500", 16),
        ('"TON"', None, 22),
    ):
        write(tmp_path, f_dot_scl=f"FUNCTION_BLOCK FB1\nVAR\n t : {spelling};\nEND_VAR\nBEGIN\nEND_FUNCTION_BLOCK\n")
        (table,) = api.layout(tmp_path / "f.scl", family=family).blocks
        assert table.size == size


def test_the_types_beside_it_tell_whose_record_block_it_is(tmp_path):
    """26 bytes beside types that every CPU has, 16 (RECORD is a VARIANT) beside a UInt; --family has the last word."""
    for other, family, size in (("Int", None, 26), ("UInt", None, 16), ("UInt", "s7-300", 26), ("Int", "s7-1200", 16)):
        text = f"FUNCTION_BLOCK F\nVAR\n w : WRREC;\n x : {other};\nEND_VAR\nBEGIN\nEND_FUNCTION_BLOCK\n"
        write(tmp_path, f_dot_scl=text)
        (table,) = api.layout(tmp_path / "f.scl", family=family).blocks
        assert table.size == size + 2


def test_documented_structures_have_their_documented_lengths():
    """TCON_PAR 64, TADDR_PAR 8, TCON_IP_v4 14, IEC_COUNTER 6, ErrorStruct 28 bytes (Siemens documentation)."""
    from tests.layout_vectors import db

    expected = {"TCON_PAR": 64, "TADDR_PAR": 8, "TCON_IP_v4": 14, "IEC_COUNTER": 6, "ErrorStruct": 28, "NREF": 8}
    expected |= {"SFB0": 10, "SFB2": 10, "SFB4": 22, "SFB13": 26, "SFB14": 90, "SFB22": 40, "SFB54": 40}
    assert expected == {name: layout_block(db(f"x : {name}"), {}).size for name in expected}


@pytest.mark.parametrize("verb", ["layout", "diff", "lock", "convert"])
def test_a_binary_file_in_a_folder_is_noted_and_left_alone(verb, tmp_path):
    """Projects have databases that end in .db; one that is named is an error."""
    folder = tmp_path / "project"
    folder.mkdir()
    (folder / "d.db").write_text(
        'DATA_BLOCK "D"\nSTRUCT\n  a : Int;\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n', "utf-8-sig"
    )
    (folder / "XRef.db").write_bytes(b"SQLite format 3\0\x10\0\1\1\0\x40\x20\x20")
    run = {
        "layout": api.layout,
        "diff": lambda path: api.diff(path, path),
        "lock": lambda path: api.lock(path, out=tmp_path / "plcgen.lock.json"),
        "convert": lambda path: api.convert(path, to="xml", out=tmp_path / "xml"),
    }[verb]
    told = [(d.code, d.severity.label, d.message) for d in run(folder).diagnostics]
    assert told == [("PG804", "note", "1 file that is no text in this folder not read: XRef.db")]
    assert [(d.code, d.severity.label) for d in run(folder / "XRef.db").diagnostics] == [("PG804", "error")]
