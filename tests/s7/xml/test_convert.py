"""plcgen convert: files in, files out, nothing lost in silence, nothing outside the folder."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import plcgen
from plcgen.build.convert import file_name
from plcgen.s7.xml.reading.invariants import check_invariants
from tests.projects import ROOT, per_block_spec
from tests.xsd_support import validate_islands

EXAMPLE = ROOT / "examples/s7-1500_g120_pn/expected"

FB = """FUNCTION_BLOCK "Motor"
{ S7_Optimized_Access := 'FALSE' }
VERSION : 0.1
VAR_INPUT
  speed : Int := 5;
END_VAR

BEGIN
#speed := 1; // keep
END_FUNCTION_BLOCK
"""
INSTANCE = """DATA_BLOCK "Motor_DB"
{ S7_Optimized_Access := 'FALSE' }
VERSION : 0.1
NON_RETAIN
"Motor"
BEGIN
  speed := 7;
END_DATA_BLOCK
"""


def put(folder: Path, **texts: str) -> list[Path]:
    files = []
    for name, text in texts.items():
        stem, _, suffix = name.rpartition("_")
        path = folder / f"{stem}.{suffix}"
        path.write_text(text, "utf-8-sig")
        files.append(path)
    return files


def test_a_source_of_a_classic_cpu_is_told_the_option(tmp_path: Path) -> None:
    """What only an S7-1200/1500 refuses names --classic, and with it the source is converted."""
    text = 'FUNCTION "F" : VOID\nVAR_INPUT\n  d : BLOCK_DB;\nEND_VAR\nVAR_TEMP\n  w : WORD;\nEND_VAR\n'
    files = put(tmp_path, f_scl=f"{text}BEGIN\n  #w := BLOCK_DB_TO_WORD(#d);\nEND_FUNCTION\n")
    told = [one for one in plcgen.convert(*files, to="xml", out=tmp_path / "no").diagnostics if one.code == "PG803"]
    assert told
    assert all(one.help.endswith("for sources of an S7-300/400: --classic") for one in told)
    assert plcgen.convert(*files, to="xml", out=tmp_path / "xml", classic=True).ok


@pytest.mark.slow
@pytest.mark.parametrize("version", ["V14 SP1", "V15", "V15.1", "V16", "V17", "V18", "V19", "V20", "V21"])
def test_a_generated_folder_both_ways(version: str, tmp_path: Path) -> None:
    """Text to documents of every version and back: the same text; the documents keep the rules of exports."""
    made = per_block_spec("s7-1500_g120_pn").parent / "out"
    sources = [made / name for name in ("udt", "db", "scl")]
    there = plcgen.convert(*sources, to="xml", out=tmp_path / "xml", version=version)
    assert (there.diagnostics, len(there.written)) == ((), 27)
    for name in there.written:
        assert check_invariants(tmp_path / "xml" / name) == []
    back = plcgen.convert(tmp_path / "xml", to="scl", out=tmp_path / "scl")
    assert back.diagnostics == ()
    for folder in sources:
        for path in folder.iterdir():
            assert (tmp_path / "scl" / path.name).read_bytes() == path.read_bytes()


@pytest.mark.slow
@pytest.mark.parametrize("version", ["V16", "V17", "V18", "V19", "V20", "V21"])
def test_islands_of_converted_documents_are_valid(version: str, tmp_path: Path) -> None:
    """By Siemens' schemas, where they are at hand."""
    plcgen.convert(*put(tmp_path, a_scl=FB, b_db=INSTANCE), EXAMPLE, to="xml", out=tmp_path / "xml", version=version)
    assert len(list((tmp_path / "xml").glob("*.xml"))) == 29
    assert [m for path in (tmp_path / "xml").glob("*.xml") for m in validate_islands(path, version)] == []


def test_an_instance_db_keeps_its_own_values(tmp_path: Path) -> None:
    """What differs from the function block stands behind BEGIN, in both directions."""
    there = plcgen.convert(*put(tmp_path, a_scl=FB, b_db=INSTANCE), to="xml", out=tmp_path / "xml")
    assert there.diagnostics == ()
    assert "<StartValue>7</StartValue>" in (tmp_path / "xml/Motor_DB.xml").read_text("utf-8-sig")
    assert "Remanence" not in (tmp_path / "xml/Motor_DB.xml").read_text("utf-8-sig")
    plcgen.convert(tmp_path / "xml", to="scl", out=tmp_path / "scl")
    assert (tmp_path / "scl/Motor_DB.db").read_text("utf-8-sig") == INSTANCE
    alone = plcgen.convert(tmp_path / "b.db", to="xml", out=tmp_path / "alone")
    assert [(d.code, d.severity.label) for d in alone.diagnostics] == [("PG815", "error")]
    assert "whether that is an FB or a type is not known" in alone.diagnostics[0].message
    assert alone.written == ()


SYSTEM_DB = """DATA_BLOCK "T"
{{ InstructionName := '{0}'; LibVersion := '1.0'; S7_Optimized_Access := 'TRUE' }}
VERSION : 0.1
NON_RETAIN
{0}
BEGIN
END_DATA_BLOCK
"""


@pytest.mark.parametrize(
    ("name", "sections"),
    [
        ("IEC_TIMER", ["Static"]),
        ("TON", ["Input", "Output", "InOut", "Static"]),
        ("MC_POWER", ["Input", "Output", "InOut", "Static"]),
    ],
)
def test_an_instance_db_of_a_library_keeps_its_version(name: str, sections: list[str], tmp_path: Path) -> None:
    """Element and version together, and no InstanceOfType: 694 of 694 exports (tests/evidence/simaticml.tsv)."""
    text = SYSTEM_DB.format(name)
    assert plcgen.convert(*put(tmp_path, T_db=text), to="xml", out=tmp_path / "xml").diagnostics == ()
    document = (tmp_path / "xml/T.xml").read_text("utf-8-sig")
    assert f"<InstanceOfName>{name}</InstanceOfName>\n      <Interface>" in document
    element = f"<OfSystemLibElement>{name}</OfSystemLibElement>\n      <OfSystemLibVersion>1.0</OfSystemLibVersion>"
    assert element in document
    assert "<MemoryLayout>Optimized</MemoryLayout>" in document
    assert re.findall('<Section Name="([^"]*)"', document) == sections
    assert plcgen.convert(tmp_path / "xml", to="scl", out=tmp_path / "scl").diagnostics == ()
    assert (tmp_path / "scl/T.db").read_text("utf-8-sig") == text
    for old, new in (("T.db", "xml"), ("xml", "T.db"), ("xml", "scl")):
        assert plcgen.diff(tmp_path / old, tmp_path / new).changes == ()


def test_a_data_block_of_a_type_says_so(tmp_path: Path) -> None:
    """InstanceOfType UDT, its own access, members in Static only: as 61 exports of V20 and V21 have it."""
    udt = 'TYPE "Rec"\nVERSION : 0.1\n  STRUCT\n    a : Int;\n  END_STRUCT;\nEND_TYPE\n'
    db = INSTANCE.replace('"Motor"', '"Rec"').replace("speed", "a")
    assert plcgen.convert(*put(tmp_path, a_udt=udt, b_db=db), to="xml", out=tmp_path / "xml").diagnostics == ()
    document = (tmp_path / "xml/Motor_DB.xml").read_text("utf-8-sig")
    assert "<InstanceOfType>UDT</InstanceOfType>" in document
    assert "<MemoryLayout>Standard</MemoryLayout>" in document
    assert re.findall('<Section Name="([^"]*)"', document) == ["Static"]
    assert plcgen.convert(tmp_path / "xml", to="scl", out=tmp_path / "scl").diagnostics == ()
    assert (tmp_path / "scl/Motor_DB.db").read_text("utf-8-sig") == db


@pytest.mark.parametrize("header", ["", "NON_RETAIN\n"])
@pytest.mark.parametrize("optimized", ["TRUE", "FALSE"])
def test_a_global_db_stays_as_retentive_as_it_is(header: str, optimized: str, tmp_path: Path) -> None:
    """Without NON_RETAIN every member on the first level is Remanence="Retain"; the way back is the same text."""
    text = (
        f"DATA_BLOCK \"Data\"\n{{ S7_Optimized_Access := '{optimized}' }}\nVERSION : 0.1\n{header}  STRUCT\n"
        "    run : Bool;\n    part : STRUCT\n      low : Int := 3;\n    END_STRUCT;\n  END_STRUCT;\n\nBEGIN\n"
        "END_DATA_BLOCK\n"
    )
    files = put(tmp_path, a_db=text)
    assert plcgen.convert(*files, to="xml", out=tmp_path / "xml").diagnostics == ()
    document = (tmp_path / "xml/Data.xml").read_text("utf-8-sig")
    assert document.count('Remanence="Retain"') == (0 if header else 2)
    assert check_invariants(tmp_path / "xml/Data.xml") == []
    assert validate_islands(tmp_path / "xml/Data.xml", "V16") == []
    assert plcgen.diff(files[0], tmp_path / "xml").changes == ()
    plcgen.convert(tmp_path / "xml", to="scl", out=tmp_path / "scl")
    assert (tmp_path / "scl/Data.db").read_text("utf-8-sig") == text


def test_single_retentive_members_stay_so(tmp_path: Path) -> None:
    """VAR RETAIN beside VAR: the members of the first are Retain, those of the second are not, both ways."""
    text = (
        "DATA_BLOCK \"Data\"\n{ S7_Optimized_Access := 'TRUE' }\nVERSION : 0.1\n  VAR RETAIN\n"
        "    a : Int;\n  END_VAR\n  VAR\n    b : Int;\n  END_VAR\n\nBEGIN\nEND_DATA_BLOCK\n"
    )
    files = put(tmp_path, a_db=text)
    plcgen.convert(*files, to="xml", out=tmp_path / "xml")
    assert (tmp_path / "xml/Data.xml").read_text("utf-8-sig").count('Name="a" Datatype="Int" Remanence="Retain"') == 1
    assert (tmp_path / "xml/Data.xml").read_text("utf-8-sig").count("Remanence") == 1
    assert plcgen.diff(files[0], tmp_path / "xml").changes == ()
    plcgen.convert(tmp_path / "xml", to="scl", out=tmp_path / "scl")
    assert (tmp_path / "scl/Data.db").read_text("utf-8-sig") == text


def test_a_retentive_instance_db_is_told(tmp_path: Path) -> None:
    """Documents of instance DBs have no Remanence: a note says what is lost."""
    retentive = INSTANCE.replace("NON_RETAIN\n", "")
    files = put(tmp_path, a_scl=FB, b_db=retentive)
    there = plcgen.convert(*files, to="xml", out=tmp_path / "xml")
    found = [(d.code, d.severity.label, d.message) for d in there.diagnostics]
    assert found == [("PG815", "note", 'DB "Motor_DB": that it is retentive is not converted')]
    assert plcgen.diff(files, [tmp_path / "xml"]).changes == ()


def test_nothing_is_overwritten_unasked(tmp_path: Path) -> None:
    """An existing file stops the whole conversion; equal files are left alone; --force replaces."""
    files = put(tmp_path, a_scl=FB, b_db=INSTANCE)
    out = tmp_path / "xml"
    out.mkdir()
    (out / "Motor.xml").write_text("mine")
    refused = plcgen.convert(*files, to="xml", out=out)
    assert [d.code for d in refused.diagnostics] == ["PG501"]
    assert [p.name for p in out.iterdir()] == ["Motor.xml"]
    assert (out / "Motor.xml").read_text() == "mine"
    assert plcgen.convert(*files, to="xml", out=out, force=True).written == ("Motor.xml", "Motor_DB.xml")
    assert plcgen.convert(*files, to="xml", out=out).unchanged == ("Motor.xml", "Motor_DB.xml")


def test_nothing_is_written_if_something_is_wrong(tmp_path: Path) -> None:
    """A syntax error in one source, and two blocks of one name: messages, no files."""
    broken = FB.replace("#speed := 1;", "#speed := ;").replace("Motor", "Broken")
    result = plcgen.convert(*put(tmp_path, a_scl=FB, b_scl=broken), to="xml", out=tmp_path / "xml")
    assert [(d.code, d.span.line) for d in result.diagnostics] == [("PG801", 9)]
    twice = plcgen.convert(*put(tmp_path, a_scl=FB, c_scl=FB), to="xml", out=tmp_path / "xml")
    assert [d.code for d in twice.diagnostics] == ["PG805"]
    assert not (tmp_path / "xml").exists()


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("Motor", "Motor"),
        ("../../etc/x", "..%2F..%2Fetc%2Fx"),
        ("..", "%2E%2E"),
        (".", "%2E"),
        (" ", "%20"),
        ("", "%00"),
        ("C:\\x", "C%3A%5Cx"),
        ("a\nb", "a%0Ab"),
        ("con", "co%6E"),
        ("NUL.x", "NUL.%78"),
        ("x.", "x%2E"),
        ("100%", "100%25"),
        ("Füllstand 液位", "Füllstand 液位"),
    ],
)
def test_file_names(name: str, expected: str) -> None:
    """No block name leads out of the folder, to a device of Windows or to a name that a system refuses."""
    assert file_name(name) == expected


def test_a_path_in_a_block_name_stays_inside(tmp_path: Path) -> None:
    """The name stays in the block, the file in the folder."""
    result = plcgen.convert(*put(tmp_path, a_scl=FB.replace("Motor", "../../Motor")), to="xml", out=tmp_path / "o/xml")
    assert result.written == ("..%2F..%2FMotor.xml",)
    assert [p.relative_to(tmp_path).as_posix() for p in tmp_path.rglob("*.xml")] == ["o/xml/..%2F..%2FMotor.xml"]
    assert "<Name>../../Motor</Name>" in (tmp_path / "o/xml/..%2F..%2FMotor.xml").read_text("utf-8-sig")


def test_blocks_without_scl_are_left_out_with_a_message(tmp_path: Path) -> None:
    """STL has no StructuredText; LAD has no SCL."""
    stl = 'FUNCTION_BLOCK "L"\nVERSION : 0.1\nBEGIN\nNETWORK\nA I0.0;\nEND_FUNCTION_BLOCK\n'
    result = plcgen.convert(*put(tmp_path, a_stl=stl, b_scl=FB), to="xml", out=tmp_path / "xml")
    assert [(d.code, d.severity.label) for d in result.diagnostics] == [("PG815", "warning")]
    assert result.written == ("Motor.xml",)
    text = (tmp_path / "xml/Motor.xml").read_text("utf-8-sig")
    begin, end = text.index("<StructuredText"), text.index("</NetworkSource>")
    drawn = (
        text[:begin]
        + '<FlgNet xmlns="http://www.siemens.com/automation/Openness/SW/NetworkSource/FlgNet/v4"/>'
        + text[end:]
    )
    (tmp_path / "lad.xml").write_text(drawn, "utf-8-sig")
    result = plcgen.convert(tmp_path / "lad.xml", to="scl", out=tmp_path / "scl")
    assert [(d.code, d.severity.label) for d in result.diagnostics] == [("PG815", "warning")]
    assert result.ok


@pytest.mark.parametrize(("tag", "language"), [("GlobalDB", "F_DB"), ("FB", "F_CALL"), ("FB", "F_LAD")])
def test_a_block_of_a_safety_program_never_becomes_a_standard_one(tag: str, language: str, tmp_path: Path) -> None:
    """Not even where there is no network to be drawn: 27 public documents are data blocks in F_DB."""
    data = INSTANCE.replace('"Motor"', "STRUCT\n  speed : Int;\nEND_STRUCT;")
    plcgen.convert(*put(tmp_path, a_scl=FB, d_db=data), to="xml", out=tmp_path / "xml")
    name = {"GlobalDB": "Motor_DB", "FB": "Motor"}[tag]
    text = (tmp_path / f"xml/{name}.xml").read_text("utf-8-sig")
    text = re.sub(r"<ProgrammingLanguage>\w+</", f"<ProgrammingLanguage>{language}</", text)
    text = re.sub(r"<MemoryLayout>\w+</MemoryLayout>", "", text)  # what is left out has no access to be asked for
    (tmp_path / "f.xml").write_text(text, "utf-8-sig")
    result = plcgen.convert(tmp_path / "f.xml", to="scl", out=tmp_path / "scl", keep_going=True)
    assert result.ok
    (found,) = result.diagnostics
    assert (found.code, found.severity.label, "safety program" in found.message) == ("PG815", "warning", True)
    assert not result.written


def test_constructs_of_another_target_are_refused(tmp_path: Path) -> None:
    """The SCL of STEP 7 V5 is not what the TIA Portal imports."""
    v5 = "FUNCTION_BLOCK FB1\nVAR x : INT; END_VAR\nBEGIN\nx := x DIV 2;\nEND_FUNCTION_BLOCK\n"
    result = plcgen.convert(*put(tmp_path, a_scl=v5), to="xml", out=tmp_path / "xml")
    assert [d.code for d in result.diagnostics] == ["PG803"]


def test_user_constants_of_tag_tables_are_constants(tmp_path: Path) -> None:
    """A quoted name that a tag table declares as a constant is a GlobalConstant."""
    table = (
        '<?xml version="1.0" encoding="utf-8"?><Document><Engineering version="V18"/><SW.Tags.PlcTagTable ID="0">'
        '<AttributeList><Name>T</Name></AttributeList><ObjectList><SW.Tags.PlcUserConstant ID="1" '
        'CompositionName="UserConstants"><AttributeList><DataTypeName>Int</DataTypeName><Name>MAX</Name><Value>5</Value>'
        "</AttributeList></SW.Tags.PlcUserConstant></ObjectList></SW.Tags.PlcTagTable></Document>"
    )
    (tmp_path / "t.xml").write_text(table, "utf-8")
    files = put(tmp_path, a_scl=FB.replace(":= 1;", ':= "MAX" + "other";'))
    assert plcgen.convert(*files, tmp_path / "t.xml", to="xml", out=tmp_path / "xml").diagnostics == ()
    text = (tmp_path / "xml/Motor.xml").read_text("utf-8-sig")
    assert '<Constant Name="MAX"' in text
    assert '<Component Name="other"' in text


def test_start_values_in_a_structure_inside_a_type_survive(tmp_path: Path) -> None:
    """An anonymous STRUCT has its members in itself, as in exports; only a user type has Sections."""
    udt = """TYPE "Rec"
VERSION : 0.1
  STRUCT
    nested : STRUCT
      c : Array[1..3] of Char;
      deep : STRUCT
        i : Int;
      END_STRUCT;
    END_STRUCT;
  END_STRUCT;
END_TYPE
"""
    db = """DATA_BLOCK "Recs"
{ S7_Optimized_Access := 'FALSE' }
VERSION : 0.1
NON_RETAIN
  STRUCT
    a : "Rec";
    b : Array[1..2] of "Rec";
  END_STRUCT;

BEGIN
  a.nested.deep.i := 5;
  b[2].nested.c[1] := 'x';
  b[1].nested.deep.i := 6;
END_DATA_BLOCK
"""
    sources = put(tmp_path, Rec_udt=udt, Recs_db=db)
    assert plcgen.convert(*sources, to="xml", out=tmp_path / "xml").diagnostics == ()
    document = (tmp_path / "xml" / "Recs.xml").read_text("utf-8")
    # One Sections of the Interface, one for each of the two members of the user type.
    assert document.count("<Sections") == 3
    assert plcgen.convert(tmp_path / "xml", to="scl", out=tmp_path / "scl").diagnostics == ()
    text = (tmp_path / "scl" / "Recs.db").read_text("utf-8-sig")
    for line in ("a.nested.deep.i := 5;", "b[2].nested.c[1] := 'x';", "b[1].nested.deep.i := 6;"):
        assert line in text
    assert validate_islands(tmp_path / "xml" / "Recs.xml", "V16") == []


def test_start_values_that_a_source_of_a_function_block_cannot_state_are_told(tmp_path: Path) -> None:
    """A document has values of its own inside user types; a source only behind BEGIN of a data block."""
    udt = 'TYPE "Q"\nVERSION : 0.1\nSTRUCT\n  w : Int;\nEND_STRUCT;\nEND_TYPE\n'
    fb = FB.replace("speed : Int := 5", 'speed : "Q" := (w := 5);\n  more : Array[0..1] of "Q" := [(w := 1), (w := 2)]')
    files = put(tmp_path, a_scl=fb.replace("#speed := 1", ""), b_udt=udt)
    assert plcgen.convert(*files, to="xml", out=tmp_path / "xml").diagnostics == ()
    back = plcgen.convert(tmp_path / "xml", to="scl", out=tmp_path / "scl")
    assert (back.ok, back.written) == (False, ())
    assert [(d.code, d.severity.label, d.message) for d in back.diagnostics] == [
        ("PG815", "error", 'FB "Motor": the start value of speed.w is not converted, nor those of 2 more members')
    ]


CALLER = """FUNCTION_BLOCK "Caller"
VERSION : 0.1
BEGIN
"Scale"(a := 1);
END_FUNCTION_BLOCK
"""
SCALE = 'FUNCTION "Scale" : Void\nVERSION : 0.1\nVAR_INPUT\n  a : Int;\nEND_VAR\n\nBEGIN\n;\nEND_FUNCTION\n'


def test_what_is_called_is_never_guessed(tmp_path: Path) -> None:
    """A name that ends in _DB says nothing: the source of the FC, or of instance and FB, must be there."""
    files = put(tmp_path, a_scl=CALLER, b_scl=CALLER.replace("Caller", "Second").replace("Scale", "Pump_DB"))
    result = plcgen.convert(*files, to="xml", out=tmp_path / "xml")
    assert [(d.code, d.severity.label, d.message) for d in result.diagnostics] == [
        ("PG815", "error", 'FB "Caller" calls "Scale": whether that is an FC or an instance is not known'),
        ("PG815", "error", 'FB "Second" calls "Pump_DB": whether that is an FC or an instance is not known'),
    ]
    assert [(d.span.line, d.span.column, d.span.end_column) for d in result.diagnostics] == [(4, 1, 8), (4, 1, 10)]
    assert not (tmp_path / "xml").exists()
    assert plcgen.convert(*files[:1], *put(tmp_path, c_scl=SCALE), to="xml", out=tmp_path / "xml").ok
    assert '<CallInfo BlockType="FC"' in (tmp_path / "xml/Caller.xml").read_text("utf-8-sig")


def test_an_unknown_call_is_shown_where_it_is(tmp_path: Path) -> None:
    """The first call of a name, behind other blocks of the file, in any line of the code."""
    code = '#a := 1; // "Later"(a := 1)\n\n  IF #a > 0 THEN "Later" (a := 1); END_IF;\n"Later"();\n'
    code += '#t.inner(a := "Deep"(2));'
    block = 'FUNCTION_BLOCK "B"\nVERSION : 0.1\nVAR\n  a : Int;\n  t : "T";\nEND_VAR\n'
    file = put(tmp_path, a_scl=f"{SCALE}{block}BEGIN {code}\nEND_FUNCTION_BLOCK\n")
    result = plcgen.convert(*file, to="xml", out=tmp_path / "xml")
    told = [(d.message.split(":")[0], d.span.line, d.span.column, d.span.end_column) for d in result.diagnostics]
    # Nine lines of the function, six of the block before BEGIN, which is in line 16.
    assert told == [
        ('FB "B" calls "Later"', 18, 18, 25), ('FB "B" calls #t.inner', 20, 1, 9), ('FB "B" calls "Deep"', 20, 15, 21),
    ]  # fmt: skip


def test_an_instance_inside_a_data_block_is_known_by_its_declaration(tmp_path: Path) -> None:
    """Through a structure and a user type: the call names the function block."""
    data = 'DATA_BLOCK "Plant"\nVERSION : 0.1\nSTRUCT\n  line : "Line";\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n'
    line = 'TYPE "Line"\nVERSION : 0.1\nSTRUCT\n  pumps : Array[1..2] of "Motor";\nEND_STRUCT;\nEND_TYPE\n'
    caller = CALLER.replace('"Scale"(a := 1)', '"Plant".line.pumps[1](speed := 1)')
    files = put(tmp_path, a_scl=caller, b_scl=FB, c_db=data, d_udt=line)
    assert plcgen.convert(*files, to="xml", out=tmp_path / "xml").diagnostics == ()
    assert '<CallInfo Name="Motor" BlockType="FB"' in (tmp_path / "xml/Caller.xml").read_text("utf-8-sig")
    missing = plcgen.convert(files[0], files[1], files[3], to="xml", out=tmp_path / "xml2")
    assert [d.message for d in missing.diagnostics] == [
        'FB "Caller" calls "Plant".line.pumps: whether that is an FC or an instance is not known'
    ]


def test_keep_going_does_what_can_be_done(tmp_path: Path) -> None:
    """Everything wrong is listed, what it stands in is left out, the rest is written; the result is not good."""
    broken = FB.replace("Motor", "Broken").replace("Int := 5", "Int := := 5")
    files = put(tmp_path, a_scl=CALLER, b_scl=FB, c_scl=broken)
    assert plcgen.convert(*files, to="xml", out=tmp_path / "xml").written == ()
    result = plcgen.convert(*files, to="xml", out=tmp_path / "xml", keep_going=True)
    assert (result.ok, result.written) == (False, ("Motor.xml",))
    assert {Path(d.span.file).name for d in result.diagnostics} == {"a.scl", "c.scl"}


def test_a_bound_that_nobody_knows_is_not_written(tmp_path: Path) -> None:
    """With the tag table among the files it has its value."""
    bad = FB.replace("speed : Int := 5", 'speed : Array[0.."LAST"] of Int').replace("#speed := 1", "#speed[0] := 1")
    result = plcgen.convert(*put(tmp_path, a_scl=bad), to="xml", out=tmp_path / "xml")
    assert [(d.code, d.severity.label) for d in result.diagnostics] == [("PG806", "error")]


def test_other_documents_in_a_folder_are_left_alone(tmp_path: Path) -> None:
    """Only a file that is named must be one."""
    put(tmp_path, a_scl=FB, b_xml="<project />")
    assert plcgen.convert(tmp_path, to="xml", out=tmp_path / "out").diagnostics == ()
    assert not plcgen.convert(tmp_path / "b.xml", to="scl", out=tmp_path / "out2").ok


def test_documents_without_any_layout_are_of_s7_300(tmp_path: Path) -> None:
    """An export of S7-1200/1500 has a MemoryLayout in every document (``REQUIRED``), one of S7-300/400 in none."""
    there = plcgen.convert(*put(tmp_path, a_scl=FB, b_db=INSTANCE), to="xml", out=tmp_path / "xml", classic=True)
    assert there.diagnostics == ()
    assert "MemoryLayout" not in (tmp_path / "xml/Motor.xml").read_text("utf-8-sig")
    taken = plcgen.convert(tmp_path / "xml", to="scl", out=tmp_path / "taken")
    assert [(d.code, d.severity.label) for d in taken.diagnostics] == [("PG815", "note")]
    assert plcgen.convert(tmp_path / "xml", to="scl", out=tmp_path / "scl", classic=True).diagnostics == ()
    for folder in ("taken", "scl"):
        assert "S7_Optimized_Access := 'FALSE'" in (tmp_path / folder / "Motor.scl").read_text("utf-8-sig")


def test_a_document_without_layout_among_others_is_told_of(tmp_path: Path) -> None:
    """TIA takes a missing one as optimized; a single warning names the blocks."""
    put(tmp_path, a_scl=FB, c_scl=FB.replace("Motor", "Fan"), d_scl=FB.replace("Motor", "Pump"))
    plcgen.convert(*tmp_path.glob("*.scl"), to="xml", out=tmp_path / "xml")
    for name in ("Motor", "Fan"):
        path = tmp_path / "xml" / f"{name}.xml"
        path.write_text(re.sub(r"<MemoryLayout>.*?</MemoryLayout>", "", path.read_text("utf-8-sig")), "utf-8-sig")
    found = plcgen.convert(tmp_path / "xml", to="scl", out=tmp_path / "scl")
    assert [(d.code, d.severity.label, "--classic" in (d.help or "")) for d in found.diagnostics] == [
        ("PG815", "warning", True)
    ]
    assert 'FB "Fan", FB "Motor"' in found.diagnostics[0].message
    assert "S7_Optimized_Access := 'TRUE'" in (tmp_path / "scl/Motor.scl").read_text("utf-8-sig")
