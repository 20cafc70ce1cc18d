"""What genuine exports have and a plain reader trips over: base types, constants in bounds, types written out."""

from __future__ import annotations

from pathlib import Path

import pytest

from plcgen import api
from plcgen.s7.types.data_types import ELEMENTARY, ArrayType, StringType
from plcgen.s7.xml.reading.documents import read_simaticml
from tests.s7.xml.reading.documents import STANDARD, document, function_block, global_db, sections

TEXT = 'xmlns="http://www.siemens.com/automation/Openness/SW/NetworkSource/StructuredText/v3"'
TABLE = """<SW.Tags.PlcTagTable ID="0"><AttributeList><Name>Constants</Name></AttributeList><ObjectList>
<SW.Tags.PlcUserConstant ID="1" CompositionName="UserConstants"><AttributeList><DataTypeName>Int</DataTypeName>
<Name>MAX_PUMPS</Name><Value>{value}</Value></AttributeList></SW.Tags.PlcUserConstant></ObjectList>
</SW.Tags.PlcTagTable>"""
SYMBOLIC = (
    '<Member Name="pumps" Datatype="Array[1..&quot;MAX_PUMPS&quot;] of Int"><Subelement Path="2">'
    '<StartValue>7</StartValue></Subelement></Member><Member Name="name" Datatype="String[&quot;MAX_PUMPS&quot;]" />'
)
DEFAULTS = "<DocumentInfo><ExportSetting>WithDefaults</ExportSetting></DocumentInfo>"
UNIT = (
    '<Sections><Section Name="None"><Member Name="speed" Datatype="Real" /><Member Name="on" Datatype="Bool" />'
    "</Section></Sections>"
)
TIMER = (
    '<Sections><Section Name="Input"><Member Name="go" Datatype="Bool" /></Section>'
    '<Section Name="Static"><Member Name="left" Datatype="DInt" /></Section></Sections>'
)


def codes(data: bytes) -> list[str]:
    return [problem.code for problem in read_simaticml(data, "x.xml")[1]]


def messages(data: bytes) -> list[str]:
    return [problem.message for problem in read_simaticml(data, "x.xml")[1]]


def scl(body: str) -> tuple[str, list[str]]:
    """Code of a block with these elements, and the messages."""
    data = document(function_block(sections(Input="", Static=""), f"<StructuredText {TEXT}>{body}</StructuredText>"))
    blocks, problems = read_simaticml(data, "x.xml")
    return blocks[0].code or "", [problem.message for problem in problems]


def test_a_graph_block_is_read_without_its_base_type() -> None:
    """The section Base says what a GRAPH block inherits; it has no memory."""
    base = '<Member Name="GRAPH_BASE" Datatype="GRAPH_BASE"><Sections><Section Name="Static" /></Sections></Member>'
    data = document(function_block(sections(Base=base, Input='<Member Name="go" Datatype="Bool" />')))
    (block,), problems = read_simaticml(data, "x.xml")
    assert problems == []
    assert [(section.kind.value, [m.name for m in section.members]) for section in block.sections] == [
        ("Input", ["go"])
    ]


def test_an_array_db_has_its_array_as_a_member() -> None:
    """Exports write it in a section None, not in attributes."""
    data = document(
        global_db("").replace("GlobalDB", "ArrayDB").replace(
            '<Section Name="Static">', '<Section Name="None"><Member Name="X" Datatype="Array[0..4] of Int" />'
        )
    )  # fmt: skip
    (block,), problems = read_simaticml(data, "x.xml")
    assert problems == []
    assert [(m.name, m.type) for m in block.sections[0].members] == [("THIS", ArrayType(((0, 4),), ELEMENTARY["INT"]))]


def test_constants_in_bounds_and_lengths_have_their_values() -> None:
    """From the project, or from the block itself; start values of single elements follow."""
    data = document(global_db(SYMBOLIC))
    (block,), problems = read_simaticml(data, "x.xml", constants={"MAX_PUMPS": 3})
    assert problems == []
    assert [m.type for m in block.sections[0].members] == [
        ArrayType(((1, 3),), ELEMENTARY["INT"]), StringType("STRING", 3),
    ]  # fmt: skip
    assert block.sections[0].members[0].start == "[0, 7]"
    own = sections(
        Static='<Member Name="a" Datatype="Array[0..#LAST] of Int" />',
        Constant='<Member Name="LAST" Datatype="Int"><StartValue>16#A</StartValue></Member>',
    )
    (block,), problems = read_simaticml(document(function_block(own)), "x.xml")
    assert problems == []
    assert block.sections[0].members[0].type == ArrayType(((0, 10),), ELEMENTARY["INT"])


def test_a_constant_without_a_value_is_one_message_for_each_use() -> None:
    """And no start value is called wrong for it."""
    assert codes(document(global_db(SYMBOLIC))) == ["PG806", "PG806"]


@pytest.mark.parametrize("whole", [True, False])
def test_layout_takes_constants_from_the_tag_table_beside_the_document(whole: bool, tmp_path: Path) -> None:
    """Whether the folder is named or the document alone: Array[1..3] of Int is 6 bytes, String[3] 5."""
    (tmp_path / "pumps.xml").write_bytes(document(global_db(SYMBOLIC)))
    (tmp_path / "tags.xml").write_bytes(document(TABLE.format(value=3)))
    result = api.layout(tmp_path if whole else tmp_path / "pumps.xml")
    assert [d.message for d in result.diagnostics] == []
    assert [(row.name, row.offset) for row in result.blocks[0].rows if row.depth == 0] == [
        ("pumps", "0.0"),
        ("name", "6.0"),
        ("(unused)", "11.0"),
    ]


@pytest.mark.parametrize("value", ["many", "16#FFFFFFFFF", "0"])
def test_a_constant_that_gives_no_array_is_said(value: str, tmp_path: Path) -> None:
    """No whole number of 32 bits, or an array that ends before it begins."""
    (tmp_path / "pumps.xml").write_bytes(document(global_db(SYMBOLIC)))
    (tmp_path / "tags.xml").write_bytes(document(TABLE.format(value=value)))
    result = api.layout(tmp_path)
    assert {d.code for d in result.diagnostics} == ({"PG812"} if value == "0" else {"PG806"})
    assert not result.blocks or value == "0"


def test_types_that_an_export_writes_out_are_known(tmp_path: Path) -> None:
    """Exports with defaults write used types whole: 1,028 of 1,028 members in 2,117 public documents.

    Hand calculation: unit is REAL and BOOL, 6 bytes; the timer has its input in byte 6, its DInt from 8 on: 12 bytes.
    """
    unit = f'<Member Name="u" Datatype="&quot;Unit&quot;">{UNIT}</Member>'
    members = f'{unit}<Member Name="t" Datatype="MC_TIMER">{TIMER}</Member>'
    data = document(global_db(members)).replace(b"<SW.Blocks", DEFAULTS.encode() + b"<SW.Blocks", 1)
    (tmp_path / "a.xml").write_bytes(data)
    result = api.layout(tmp_path)
    assert [d.message for d in result.diagnostics] == []
    assert result.blocks[0].size == 12
    assert [(row.name, row.offset) for row in result.blocks[0].rows if row.name in {"speed", "on", "go", "left"}] == [
        ("speed", "0.0"), ("on", "4.0"), ("go", "6.0"), ("left", "8.0"),
    ]  # fmt: skip


def test_types_that_are_written_out_in_part_are_not_taken_for_whole(tmp_path: Path) -> None:
    """Without the setting an export writes the members with start values only."""
    (tmp_path / "a.xml").write_bytes(
        document(global_db(f'<Member Name="u" Datatype="&quot;Unit&quot;">{UNIT}</Member>'))
    )
    assert [d.message for d in api.layout(tmp_path).diagnostics] == ["unknown data type Unit"]


def test_a_type_of_its_own_counts_more_than_what_is_written_out(tmp_path: Path) -> None:
    """The document of the type is the declaration."""
    data = document(global_db(f'<Member Name="u" Datatype="&quot;Unit&quot;">{UNIT}</Member>'))
    (tmp_path / "a.xml").write_bytes(data.replace(b"<SW.Blocks", DEFAULTS.encode() + b"<SW.Blocks", 1))
    (tmp_path / "Unit.udt").write_text('TYPE "Unit"\nSTRUCT\n a : Int;\nEND_STRUCT;\nEND_TYPE\n', "utf-8")
    (table,) = [block for block in api.layout(tmp_path).blocks if block.kind == "DB"]
    assert table.size == 2


def test_an_operand_in_a_named_data_block_is_written_by_its_number() -> None:
    """The name and the number of the DB stand in one Address, the place in another."""
    block = '<Address Area="DB" Type="Pumps" BlockNumber="2" />'
    symbol = f'<Symbol>{block}<Token Text="." /><Address Area="DB" Type="Word" BitOffset="32" /></Symbol>'
    assert scl(f'<Access Scope="Address">{symbol}</Access>') == ("%DB2.DBW4", [])


@pytest.mark.parametrize("scope", ["", "Variable", "localvariable"])
def test_an_unknown_scope_is_refused(scope: str) -> None:
    """What an operand is may not be guessed."""
    body = f'<Access Scope="{scope}"><Symbol><Component Name="a" /></Symbol></Access>'
    assert scl(body) == ("", [f"the Scope {scope or '(none)'} is unknown"])


@pytest.mark.parametrize(
    ("spelling", "message"),
    [
        ("Array[5..1] of Int", "x: the array ends before it begins (5..1)"),
        ("Array[0..2147483648] of Int", "x: the array bounds 0..2147483648 are no 32-bit numbers"),
        ("Array[0..1,0..1,0..1,0..1,0..1,0..1,0..1] of Int", "x: an array has at most 6 dimensions"),
        ("String[255]", "x: STRING has 1 to 254 characters, not 255"),
        ("Array[0..1] of String[0]", "x: STRING has 1 to 254 characters, not 0"),
        ("WString[16383]", "x: WSTRING has 1 to 16382 characters, not 16383"),
    ],
)
def test_what_no_compiler_takes_is_refused_where_it_is_read(spelling: str, message: str) -> None:
    """Bounds and lengths, with the line of the member."""
    assert messages(document(global_db(f'<Member Name="x" Datatype="{spelling}" />'))) == [message]


def test_very_many_equal_members_are_one_error() -> None:
    """Reading ends after a few: 1.6 million take as long as parsing them."""
    data = document(global_db('<Member Name="a" Datatype="Bool" />' * 50_000))
    (block,), problems = read_simaticml(data, "x.xml")
    assert [problem.message for problem in problems] == ['"a" is declared twice, as are 1022 more members']
    assert len(block.sections[0].members) == 1024


def test_an_instruction_for_one_type_has_it_in_its_name() -> None:
    """SHL with the template value Word is another instruction than SHL of a byte: the TIA Portal writes SHL_WORD."""
    template = '<TemplateValue Name="value_type" Type="Type">Word</TemplateValue>'
    call = f'<Instruction Name="SHL">{template}<Token Text="(" /><Token Text=")" /></Instruction>'
    assert scl(f'<Access Scope="Call">{call}</Access>') == ("SHL_WORD()", [])


GRAPH = (
    '<Member Name="RT_DATA" Datatype="G7_RTDataPlus_V6" Version="1.0" />'
    '<Member Name="Step1" Datatype="GraphStep" Version="1.0" />'
    '<Member Name="Step2" Datatype="GraphStep" Version="1.0" />'
    '<Member Name="stop" Datatype="ESTOP1" Version="1.6" />'
)


def optimized(block: str) -> str:
    return block.replace(STANDARD, STANDARD.replace("Standard", "Optimized"))


def laid_out(folder: Path, **files: bytes):
    for name, data in files.items():
        (folder / f"{name}.xml").write_bytes(data)
    return api.layout(folder)


def test_a_graph_block_is_shown_with_the_types_that_only_the_library_knows(tmp_path: Path) -> None:
    """Steps, transitions and safety blocks have no members here; the block has no offsets, so nothing is missing."""
    interface = sections(Input='<Member Name="OFF_SQ" Datatype="Bool" />', Static=GRAPH)
    block = function_block(interface, '<Graph xmlns="urn:graph" />').replace(
        "Standard</MemoryLayout", "Optimized</MemoryLayout"
    )
    found = laid_out(tmp_path, sequence=document(block))
    (table,) = found.blocks
    assert [(row.name, row.type, row.byte) for row in table.rows] == [
        ("OFF_SQ", "BOOL", None), ("RT_DATA", "G7_RTDataPlus_V6", None), ("Step1", "GraphStep", None),
        ("Step2", "GraphStep", None), ("stop", "ESTOP1", None),
    ]  # fmt: skip
    said = {d.message: (d.code, d.severity.label) for d in found.diagnostics}
    assert [what for message, what in said.items() if "GRAPH is not read" in message] == [("PG814", "note")]
    for name in ("G7_RTDataPlus_V6", "GraphStep", "ESTOP1"):
        assert said[f"the members of {name} are not known to plcgen: shown without them"] == ("PG806", "warning")
    assert len(said) == len(found.diagnostics) == 4


def test_an_instance_of_such_a_block_has_its_access(tmp_path: Path) -> None:
    """An instance DB that says nothing has the access of its FB: no offsets either."""
    block = optimized(function_block(sections(Static=GRAPH)))
    instance = (
        '<SW.Blocks.InstanceDB ID="0"><AttributeList><InstanceOfName>Job</InstanceOfName>'
        f"<InstanceOfType>FB</InstanceOfType>{sections(Static='')}<Name>Job_DB</Name><Number>5</Number>"
        "<ProgrammingLanguage>DB</ProgrammingLanguage></AttributeList></SW.Blocks.InstanceDB>"
    )
    found = laid_out(tmp_path, job=document(block), job_db=document(instance))
    assert [d for d in found.diagnostics if d.severity.label == "error"] == []
    assert {table.name: table.size for table in found.blocks} == {"Job": None, "Job_DB": None}


def test_with_standard_access_such_a_type_leaves_nothing_to_be_shown(tmp_path: Path) -> None:
    """Where a step lies, and all behind it, depends on its members: an error, as for any unknown type."""
    found = laid_out(tmp_path, sequence=document(function_block(sections(Static=GRAPH))))
    assert found.blocks == ()
    assert {(d.code, d.severity.label) for d in found.diagnostics} == {("PG806", "error")}


def test_a_type_of_the_user_is_missed_with_optimized_access_too(tmp_path: Path) -> None:
    """Quotes are what a PLC data type has: some file declares it."""
    member = '<Member Name="axis" Datatype="&quot;Axis&quot;" />'
    block = optimized(function_block(sections(Static=member)))
    found = laid_out(tmp_path, job=document(block))
    assert [(d.code, d.severity.label, d.message) for d in found.diagnostics] == [
        ("PG806", "error", "unknown data type Axis")
    ]


def test_the_block_of_an_instance_lies_beside_it(tmp_path: Path) -> None:
    """Of an instance DB alone its FB is read from the document of its name, and the type that the FB uses."""
    member = '<Member Name="axis" Datatype="&quot;Axis&quot;" />'
    udt = (
        '<SW.Types.PlcStruct ID="0"><AttributeList>'
        + sections(**{"None": '<Member Name="speed" Datatype="Real" /><Member Name="on" Datatype="Bool" />'})
        + "<Name>Axis</Name></AttributeList></SW.Types.PlcStruct>"
    )
    instance = (
        '<SW.Blocks.InstanceDB ID="0"><AttributeList><InstanceOfName>Job</InstanceOfName>'
        f"<InstanceOfType>FB</InstanceOfType>{sections(Static='')}<Name>Job_DB</Name><Number>5</Number>"
        "<ProgrammingLanguage>DB</ProgrammingLanguage></AttributeList></SW.Blocks.InstanceDB>"
    )
    (tmp_path / "Job.xml").write_bytes(document(function_block(sections(Static=member))))
    (tmp_path / "Axis.xml").write_bytes(document(udt))
    (tmp_path / "Job_DB.xml").write_bytes(document(instance))
    found = api.layout(tmp_path / "Job_DB.xml")
    assert found.diagnostics == ()
    (table,) = found.blocks
    assert (table.name, table.size) == ("Job_DB", 6)
    assert [(row.name, row.offset) for row in table.rows[:3]] == [("axis", "0.0"), ("speed", "0.0"), ("on", "4.0")]
