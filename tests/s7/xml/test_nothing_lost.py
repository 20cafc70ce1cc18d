"""What exports of others have and conversion, layout and diff once left out without a word."""

from __future__ import annotations

from pathlib import Path

import pytest

import plcgen
from plcgen import api
from plcgen.report.diff.run import compare
from plcgen.s7.tables.declared import block_tables
from plcgen.s7.types.literals import pack_literal
from plcgen.s7.xml.reading.documents import read_simaticml
from tests.s7.xml.reading.documents import STANDARD, document, function_block, global_db, sections

CONNECTION = (
    '<Member Name="link" Datatype="TCON_IP_v4" Version="1.0"><Sections><Section Name="None">'
    '<Member Name="ID" Datatype="CONN_OUC"><StartValue>7</StartValue></Member>'
    '<Member Name="RemoteAddress" Datatype="IP_V4" Version="1.0"><Sections><Section Name="None">'
    '<Member Name="ADDR" Datatype="Array[1..4] of Byte"><Subelement Path="1"><StartValue>{0}</StartValue></Subelement>'
    "</Member></Section></Sections></Member></Section></Sections></Member>"
)
OWN = (
    '<Member Name="{0}" Datatype="&quot;Elsewhere&quot;"><Sections><Section Name="None">'
    '<Member Name="speed" Datatype="Real"><StartValue>{1}</StartValue></Member></Section></Sections></Member>'
)
TYPE = (
    '<SW.Types.PlcStruct ID="0"><AttributeList>{0}<Name>Limits</Name></AttributeList><ObjectList>'
    '<MultilingualText ID="1" CompositionName="Comment"><ObjectList>{1}</ObjectList></MultilingualText>'
    "</ObjectList></SW.Types.PlcStruct>"
)
ITEM = (
    '<MultilingualTextItem ID="{0}" CompositionName="Items"><AttributeList><Culture>{1}</Culture><Text>{2}</Text>'
    "</AttributeList></MultilingualTextItem>"
)


def write(folder: Path, name: str, data: bytes | str) -> Path:
    folder.mkdir(exist_ok=True)
    (folder / name).write_bytes(data if isinstance(data, bytes) else data.encode("utf-8-sig"))
    return folder / name


def to_text(tmp_path: Path, data: bytes, name: str) -> tuple[str, list[str]]:
    """Source of one document and the messages."""
    result = plcgen.convert(write(tmp_path, "in.xml", data), to="scl", out=tmp_path / "scl", keep_going=True)
    return (tmp_path / "scl" / name).read_text("utf-8-sig"), [d.message for d in result.diagnostics]


def to_xml(tmp_path: Path, text: str, name: str, **more: str) -> tuple[str, list[str]]:
    """Document of one source, others beside it, and the messages; empty if it is not written."""
    paths = [write(tmp_path / "in", f"{stem}.scl", body) for stem, body in {"own": text, **more}.items()]
    result = plcgen.convert(*paths, to="xml", out=tmp_path / "xml", keep_going=True)
    found = tmp_path / "xml" / name
    return found.read_text("utf-8-sig") if found.exists() else "", [d.message for d in result.diagnostics]


def changes(tmp_path: Path, old: bytes, new: bytes) -> list[tuple[str, str]]:
    """Kind and message of every change between two documents."""
    files = [write(tmp_path / name, "x.xml", data) for name, data in (("old", old), ("new", new))]
    return [(c.kind, c.message) for c in compare(files[:1], files[1:]).changes]


# --- start values ------------------------------------------------------------------------------------------


def test_values_inside_types_of_the_system_are_kept(tmp_path: Path) -> None:
    """The address of the partner in a TCON_IP_v4 is in no other place."""
    text, messages = to_text(tmp_path, document(global_db(CONNECTION.format(192))), "WR_DataBuffer.db")
    assert messages == []
    assert "  link.ID := 7;\n  link.RemoteAddress.ADDR[1] := 192;\n" in text


def test_a_changed_value_inside_a_type_of_the_system_is_a_difference(tmp_path: Path) -> None:
    """So is any other start value."""
    old, new = (document(global_db(CONNECTION.format(byte))) for byte in (192, 193))
    assert changes(tmp_path, old, new) == [("start-value", "start value 192 -> 193")]


def test_a_value_inside_a_type_that_no_file_declares_is_a_difference(tmp_path: Path) -> None:
    """Without the type nobody knows offsets; what the data block says itself is compared all the same."""
    old, new = (document(global_db(OWN.format("drive", speed))) for speed in ("1.5", "1.6"))
    assert changes(tmp_path, old, new) == [("start-value", "start value 1.5 -> 1.6")]


def test_a_pointer_inside_an_area_is_a_value_of_a_dword() -> None:
    """P#544.0 is byte 544: 544 * 8 = 16#1100. So writes a V16 project with an S7-300 its instance of a counter."""
    member = '<Member Name="CH_ADR" Datatype="DWord"><StartValue>P#544.0</StartValue></Member>'
    (block,), problems = read_simaticml(document(global_db(member)), "x.xml")
    assert problems == []
    assert block.members[0].start == "P#544.0"
    assert pack_literal("P#544.0", "DWORD") == bytes.fromhex("00001100")


def test_values_of_an_instance_are_in_the_sections_of_its_block(tmp_path: Path) -> None:
    """An FB has Input to Static inside of an instance, as in the exports of V20; None belongs to types."""
    inner = (
        'FUNCTION_BLOCK "Inner"\nVERSION : 0.1\nVAR_INPUT\n  a : Int;\nEND_VAR\nVAR\n  b : Int;\nEND_VAR\nBEGIN\n;\n'
    )
    outer = 'FUNCTION_BLOCK "Outer"\nVERSION : 0.1\nVAR\n  i : "Inner";\nEND_VAR\nBEGIN\n;\nEND_FUNCTION_BLOCK\n'
    own = 'DATA_BLOCK "D"\nVERSION : 0.1\nNON_RETAIN\n"Outer"\nBEGIN\n  i.a := 3;\n  i.b := 4;\nEND_DATA_BLOCK\n'
    text, messages = to_xml(tmp_path, own, "D.xml", inner=f"{inner}END_FUNCTION_BLOCK\n", outer=outer)
    assert messages == []
    found = "".join(text.split())
    assert '<SectionName="Input"><MemberName="a"Datatype="Int"><StartValue>3</StartValue></Member></Section>' in found
    assert '<SectionName="Static"><MemberName="b"Datatype="Int"><StartValue>4</StartValue></Member></Section>' in found
    assert 'Name="None"' not in found


def test_a_value_inside_a_type_that_only_a_library_knows_is_no_mistake() -> None:
    """Steps of GRAPH have numbers in their document; with optimized access the block is shown without them."""
    step = (
        '<Member Name="S1" Datatype="G7_StepPlus_V6" Version="1.0"><Sections><Section Name="None">'
        '<Member Name="SNO" Datatype="Int"><StartValue>1</StartValue></Member></Section></Sections></Member>'
        '<Member Name="a" Datatype="Array[0..1] of Int"><Subelement Path="1"><StartValue>4</StartValue></Subelement>'
        "</Member>"
    )
    optimized = STANDARD.replace("Standard", "Optimized")
    (block,), problems = read_simaticml(document(global_db(step, optimized)), "x.xml")
    assert problems == []
    tables, found = block_tables([block], {})
    assert [d.message for d in found] == ["the members of G7_StepPlus_V6 are not known to plcgen: shown without them"]
    assert [row.name for row in tables[0].rows][:2] == ["S1", "a"]


def test_very_many_values_that_are_lost_are_one_message(tmp_path: Path) -> None:
    """Those of a type that is not among the files: ten are named."""
    lines = "".join(f"  a[{n}].x := 1;\n" for n in range(30))
    text = (
        'DATA_BLOCK "D"\nVERSION : 0.1\nNON_RETAIN\n  STRUCT\n    a : Array[0..29] of "Elsewhere";\n  END_STRUCT;\n\n'
        f"BEGIN\n{lines}END_DATA_BLOCK\n"
    )
    _, messages = to_xml(tmp_path, text, "D.xml")
    assert len(messages) == 11
    assert 'DB "D": 20 more start values are not converted' in messages


# --- declarations ------------------------------------------------------------------------------------------


def test_constants_of_a_type_that_is_written_out_have_their_values(tmp_path: Path) -> None:
    """String["N"] with N = 6 takes 8 bytes; with a length of 1, as nobody knows, b was at 4.0."""
    defaults = "<DocumentInfo><ExportSetting>WithDefaults</ExportSetting></DocumentInfo>"
    member = (
        '<Member Name="u" Datatype="&quot;T&quot;"><Sections><Section Name="None">'
        '<Member Name="a" Datatype="String[&quot;N&quot;]" /></Section></Sections></Member>'
        '<Member Name="b" Datatype="Int" />'
    )
    table = (
        '<SW.Tags.PlcTagTable ID="0"><AttributeList><Name>C</Name></AttributeList><ObjectList>'
        '<SW.Tags.PlcUserConstant ID="1" CompositionName="UserConstants"><AttributeList><DataTypeName>Int'
        "</DataTypeName><Name>N</Name><Value>6</Value></AttributeList></SW.Tags.PlcUserConstant></ObjectList>"
        "</SW.Tags.PlcTagTable>"
    )
    own = write(tmp_path, "own.xml", document(defaults, global_db(member)))
    alone = api.layout(own)
    assert [d.message for d in alone.diagnostics] == ['the constant "N" is defined outside this document']
    write(tmp_path, "tags.xml", document(table))
    rows = api.layout(tmp_path).blocks[0].rows
    assert [(row.name, row.offset) for row in rows if row.depth == 0] == [("u", "0.0"), ("b", "8.0")]
    assert plcgen.convert(own, to="scl", out=tmp_path / "scl").diagnostics == ()


def test_the_comment_of_a_type_stays_with_its_lines(tmp_path: Path) -> None:
    """Between VERSION and STRUCT, where the TIA Portal has it; blank lines and indentation are part of it."""
    member = sections(None_='<Member Name="a" Datatype="Int" />').replace("None_", "None")
    data = document(TYPE.format(member, ITEM.format(2, "en-US", "One\n\n  two")))
    text, messages = to_text(tmp_path, data, "Limits.udt")
    assert messages == []
    assert 'TYPE "Limits"\nVERSION : 0.1\n// One\n//\n//   two\n  STRUCT\n' in text
    assert "<Text>One\n\n  two</Text>" in to_xml(tmp_path, text, "Limits.xml")[0]


def test_comments_are_in_one_language(tmp_path: Path) -> None:
    """Members have their languages in alphabetical order, blocks in the order of the project."""
    member = (
        '<Member Name="a" Datatype="Int"><Comment><MultiLanguageText Lang="de-DE">Grenze</MultiLanguageText>'
        '<MultiLanguageText Lang="en-US">Limit</MultiLanguageText></Comment></Member>'
    )
    items = ITEM.format(2, "en-US", "Limits") + ITEM.format(3, "de-DE", "Grenzen")
    interface = sections(None_=member).replace("None_", "None")
    text, _ = to_text(tmp_path, document(TYPE.format(interface, items)), "Limits.udt")
    assert "// Limits\n" in text
    assert "// Limit\n" in text


@pytest.mark.parametrize(("remanence", "words"), [("SetInIDB", "VAR DB_SPECIFIC"), ("Retain", "VAR RETAIN")])
def test_each_instance_may_say_what_is_retentive(remanence: str, words: str, tmp_path: Path) -> None:
    """472 members of the exports measured have SetInIDB; sources of the TIA Portal say DB_SPECIFIC."""
    member = f'<Member Name="a" Datatype="Int" Remanence="{remanence}" />'
    code = (
        '<StructuredText xmlns="http://www.siemens.com/automation/Openness/SW/NetworkSource/StructuredText/v3">'
        '<Token Text=";" UId="21" /></StructuredText>'
    )
    data = document(function_block(sections(Input="", Output="", InOut="", Static=member), code))
    text, messages = to_text(tmp_path, data, "Job.scl")
    assert messages == []
    assert f"{words}\n  a : Int;\n" in text
    assert f'Remanence="{remanence}"' in to_xml(tmp_path, text, "Job.xml")[0]


@pytest.mark.parametrize("name", ["Counter", "Date", "Byte", "NULL", "Version", "Array", "String"])
def test_names_of_types_are_written_in_quotes(name: str, tmp_path: Path) -> None:
    """As the sources of the TIA Portal have them, without exception."""
    text, _ = to_text(tmp_path, document(global_db(OWN.format(name, "1.5"))), "WR_DataBuffer.db")
    assert f'    "{name}" : "Elsewhere";\n' in text
    assert f'  "{name}".speed := 1.5;\n' in text


def test_an_open_array_keeps_its_dimensions(tmp_path: Path) -> None:
    """A matrix is no vector."""
    text = 'FUNCTION "F" : Void\nVERSION : 0.1\nVAR_IN_OUT\n  m : Array[*, *] of LReal;\nEND_VAR\n\nBEGIN\n;\n'
    found, messages = to_xml(tmp_path, f"{text}END_FUNCTION\n", "F.xml")
    assert messages == []
    assert 'Datatype="Array[*, *] of LReal"' in found
    back = plcgen.convert(tmp_path / "xml", to="scl", out=tmp_path / "scl")
    assert back.diagnostics == ()
    assert "  m : Array[*, *] of LReal;\n" in (tmp_path / "scl/F.scl").read_text("utf-8-sig")


@pytest.mark.parametrize(
    ("value", "line"), [("Ada", "AUTHOR : Ada\n"), ("G.Muster", "AUTHOR : 'G.Muster'\n"), ("A B", "AUTHOR : 'A B'\n")]
)
def test_words_of_the_header_stand_in_quotes_where_they_need_them(value: str, line: str, tmp_path: Path) -> None:
    """A name with a dot or a blank is no word: the TIA Portal writes it in quotes."""
    layout = f"<HeaderAuthor>{value}</HeaderAuthor>{STANDARD}"
    text, _ = to_text(tmp_path, document(global_db('<Member Name="a" Datatype="Int" />', layout)), "WR_DataBuffer.db")
    assert line in text


def test_a_data_block_that_opc_ua_does_not_see_stays_so(tmp_path: Path) -> None:
    """Both spellings of the TIA Portal; true is the default and goes without saying."""
    layout = f"<DBAccessibleFromOPCUA>false</DBAccessibleFromOPCUA>{STANDARD}"
    text, _ = to_text(tmp_path, document(global_db('<Member Name="a" Datatype="Int" />', layout)), "WR_DataBuffer.db")
    assert "{ S7_Optimized_Access := 'FALSE'; DB_Accessible_From_OPC_UA := 'FALSE' }\n" in text
    found, messages = to_xml(tmp_path, text, "WR_DataBuffer.xml")
    assert messages == []
    assert "<AutoNumber>true</AutoNumber>\n      <DBAccessibleFromOPCUA>false</DBAccessibleFromOPCUA>\n" in found


def test_other_attributes_of_members_are_compared(tmp_path: Path) -> None:
    """What a call in a ladder network shows at first is an attribute of the parameter."""
    member = (
        '<Member Name="a" Datatype="Int"><AttributeList><StringAttribute Name="S7_PredefinedAssignment" '
        'SystemDefined="true">{0}</StringAttribute></AttributeList></Member>'
    )
    old, new = (document(function_block(sections(Input=member.format(n)))) for n in (1, 2))
    assert [kind for kind, _ in changes(tmp_path, old, new)] == ["member-attribute"]


def test_the_order_in_a_function_block_is_compared(tmp_path: Path) -> None:
    """Its instances are loaded with start values after that, as a data block is."""
    first, second = (f'<Member Name="{name}" Datatype="Int" />' for name in "ab")
    optimized = STANDARD.replace("Standard", "Optimized")
    old, new = (
        document(function_block(sections(Input="", Static=members)).replace(STANDARD, optimized))
        for members in (first + second, second + first)
    )
    assert changes(tmp_path, old, new) == [("member-reordered", "is at another place among the members")]


# --- what cannot be converted is told ----------------------------------------------------------------------


def test_the_event_of_an_ob_is_told_both_ways(tmp_path: Path) -> None:
    """A source says neither number nor event; a document must, and ProgramCycle would be called in every cycle."""
    text = 'ORGANIZATION_BLOCK "Startup"\nVERSION : 0.1\n\nBEGIN\n;\nEND_ORGANIZATION_BLOCK\n'
    found, messages = to_xml(tmp_path, text, "Startup.xml")
    assert messages == ['OB "Startup": its event is not known, it is written as ProgramCycle']
    data = found.replace(">ProgramCycle<", ">CyclicInterrupt<").encode()
    _, messages = to_text(tmp_path / "back", data, "Startup.scl")
    assert messages == ['OB "Startup": that its event is CyclicInterrupt is not converted']
    (tmp_path / "lost.xml").write_bytes(data)
    result = plcgen.convert(tmp_path / "lost.xml", to="scl", out=tmp_path / "lost")
    assert (result.ok, result.written) == (False, ())


def test_an_array_db_does_not_become_another_block(tmp_path: Path) -> None:
    """Nor are its start values left out in silence."""
    text = 'DATA_BLOCK "Field"\nVERSION : 0.1\nNON_RETAIN\n  Array[0..4] of Int;\n\nBEGIN\nEND_DATA_BLOCK\n'
    found, messages = to_xml(tmp_path, text, "Field.xml")
    assert (found, messages) == (
        "",
        ['DB "Field" is one array: documents of array DBs are not written, it is left out'],
    )
    array = (
        '<Member Name="X" Datatype="Array[0..4] of Int"><Subelement Path="1"><StartValue>5</StartValue></Subelement>'
    )
    data = global_db("").replace("GlobalDB", "ArrayDB").replace('"Static">', f'"None">{array}</Member>')
    _, messages = to_text(tmp_path / "back", document(data), "WR_DataBuffer.db")
    assert messages == ['DB "WR_DataBuffer": its start values are not converted']


def test_a_type_as_an_operand_is_no_tag(tmp_path: Path) -> None:
    """TypeOf(..) = Bool: written as a tag it came back as "Bool", which is another program."""
    text = (
        'FUNCTION "F" : Void\nVERSION : 0.1\nVAR_INPUT\n  v : Variant;\nEND_VAR\n\nBEGIN\n'
        "IF TypeOf(#v) = Bool THEN\n  ;\nEND_IF;\nEND_FUNCTION\n"
    )
    assert to_xml(tmp_path, text, "F.xml") == ("", ['FC "F" compares with the type Bool'])


TYPE_VALUES = ["Bool", "STRING", "LReal", "TO_SpeedAxis", "TO_POSITIONINGAXIS", "HW_IO", "DTL", '"Recipe"']
TYPE_PLACES = {
    "IF TypeOf(#v) = {} THEN\n  ;\nEND_IF;": "TypeOf", "CASE TypeOfDB(#d) OF\n  {}:\n    ;\nEND_CASE;": "TypeOfDB",
    "IF TypeOfElements(#v) <> {} THEN\n  ;\nEND_IF;": "TypeOfElements",
}  # fmt: skip


@pytest.mark.parametrize("type_", TYPE_VALUES)
@pytest.mark.parametrize("code", TYPE_PLACES)
def test_no_type_is_a_tag(code: str, type_: str, tmp_path: Path) -> None:
    """Every kind of type name, in every place where code can compare with one."""
    text = (
        'TYPE "Recipe"\nVERSION : 0.1\n  STRUCT\n    a : Int;\n  END_STRUCT;\nEND_TYPE\n'
        'FUNCTION "F" : Void\nVERSION : 0.1\nVAR_INPUT\n  v : Variant;\n  d : DB_ANY;\nEND_VAR\n\nBEGIN\n'
        f"{code.format(type_)}\nEND_FUNCTION\n"
    )
    found, messages = to_xml(tmp_path, text, "F.xml")
    name = type_.strip('"')
    assert messages == [f'FC "F" compares with the type {name}']
    assert f'Name="{name}"' not in found


def test_an_instance_in_a_software_unit_has_its_block(tmp_path: Path) -> None:
    """Its document names the block with the namespace of the unit before it."""
    unit = "<Namespace>Unit_2</Namespace><Number>1"
    block = document(function_block(sections(Input='<Member Name="a" Datatype="Int" />')).replace("<Number>1", unit))
    interface = sections(Input="", Output="", InOut="", Static="")
    own = (
        f'<SW.Blocks.InstanceDB ID="0"><AttributeList><InstanceOfName>Unit_2.Job</InstanceOfName>{interface}'
        f"<Name>Job_DB</Name>{unit}</Number></AttributeList><ObjectList /></SW.Blocks.InstanceDB>"
    )
    write(tmp_path, "Job.xml", block)
    write(tmp_path, "Job_DB.xml", document(own))
    result = api.layout(tmp_path)
    assert [d.message for d in result.diagnostics if d.severity.label == "error"] == []
    assert "instance of Job" in next(b.summary for b in result.blocks if b.name == "Job_DB")


def test_a_type_of_the_system_is_not_looked_for_in_files(tmp_path: Path) -> None:
    """Instances of PUT have parameters of the type Remote, those of MODBUS blocks T_DIAG: no file declares them."""
    own = write(tmp_path, "own.xml", document(global_db('<Member Name="a" Datatype="Remote" />')))
    assert [d.message for d in api.layout(own).diagnostics] == ["the members of Remote are not known to plcgen"]
