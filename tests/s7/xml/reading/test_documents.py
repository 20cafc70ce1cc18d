"""SimaticML documents to blocks and tables; documents written by hand after genuine exports."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from plcgen.s7.layout.image import image
from plcgen.s7.layout.layout import layout_block
from plcgen.s7.types.blocks import Block, BlockKind, Section, SectionKind
from plcgen.s7.types.data_types import ELEMENTARY, ArrayType, Member, NamedType, StringType, StructType
from plcgen.s7.xml.reading.documents import Tag, WatchEntry, read_simaticml, read_tag_table, read_watch_table
from plcgen.s7.xml.reading.types import parse_datatype
from plcgen.s7.xml.reading.xml import MAX_BYTES
from tests.s7.xml.reading.documents import (
    BOM,
    FAQ_DB3,
    FB_SECTIONS,
    HEADER,
    document,
    function_block,
    global_db,
    sections,
)


def one(*objects, **options):
    blocks, diagnostics = read_simaticml(document(*objects), "x.xml", **options)
    assert diagnostics == []
    return blocks[0]


def codes(data, **options):
    _, diagnostics = read_simaticml(data, "x.xml", **options)
    return [d.code for d in diagnostics]


def test_the_read_request_of_the_faq_keeps_its_offsets_and_bytes():
    """DB3 of FAQ 109750712: offsets 0..8 of figure 4-5, bytes of figure 5-1."""
    db = one(global_db(FAQ_DB3))
    assert (db.kind, db.name, db.number, db.optimized) == (BlockKind.DB, "WR_DataBuffer", 3, False)
    assert (db.title, db.comment) == ("Request", "Buffer")
    assert db.attributes == {}
    assert db.non_retain
    assert [e.byte for e in layout_block(db, {}).entries] == [0, 1, 2, 3, 4, 5, 6, 8]
    assert image(db, {}).hex() == "030102011001c47f0000"
    assert db.span.line == 4


@pytest.mark.parametrize(
    ("layout", "classic", "optimized"),
    [
        ("<MemoryLayout>Standard</MemoryLayout>", False, False),
        ("<MemoryLayout>Optimized</MemoryLayout>", False, True),
        ("", False, True),
        ("", True, False),
    ],
)
def test_without_memory_layout_access_is_optimized_except_on_s7_300(layout, classic, optimized):
    assert one(global_db("", layout), classic=classic).optimized is optimized


@pytest.mark.parametrize(
    ("spelling", "expected"),
    [
        ("Bool", ELEMENTARY["BOOL"]),
        ("Date_And_Time", ELEMENTARY["DATE_AND_TIME"]),
        ("Time_Of_Day", ELEMENTARY["TIME_OF_DAY"]),
        ("HW_IO", ELEMENTARY["HW_IO"]),
        ('"My Udt"', NamedType("My Udt", quoted=True)),
        ("TON_TIME", NamedType("TON_TIME")),
        ("dtl:v1.0", ELEMENTARY["DTL"]),
        ("String[16]", StringType("STRING", 16)),
        ("WString", StringType("WSTRING", 254)),
        ("Array[0..9] of Word", ArrayType(((0, 9),), ELEMENTARY["WORD"])),
        ("Array[-1..1, 2..3] of String[4]", ArrayType(((-1, 1), (2, 3)), StringType("STRING", 4))),
        ('Array[1..2] of "U"', ArrayType(((1, 2),), NamedType("U", quoted=True))),
        ("Array[*] of Int", ArrayType((), ELEMENTARY["INT"])),
        ("Array[*, *] of Int", ArrayType((), ELEMENTARY["INT"], 2)),
        ('"typeMotor":v1.0.2', NamedType("typeMotor", quoted=True)),
        ('Array[0.."N"] of Int', None),
        ("", None),
        ("a b", None),
    ],
)
def test_data_types(spelling, expected):
    assert parse_datatype(spelling) == expected


def test_sections_comments_views_and_start_values_of_a_function_block():
    static = (
        '<Member Name="w" Datatype="Word" Remanence="Retain"><Comment><MultiLanguageText Lang="en-US">Word'
        "</MultiLanguageText></Comment><StartValue>16#1</StartValue></Member>"
        '<Member Name="v" Datatype="Array[0..1] of Byte"><AttributeList><StringAttribute Name="At" '
        'SystemDefined="true">w</StringAttribute></AttributeList></Member>'
        '<Member Name="wr" Datatype="WRREC" Version="1.1" />'
    )
    groups = FB_SECTIONS | {"Input": '<Member Name="go" Datatype="Bool" />', "Static": static}
    fb = one(function_block(sections(**groups)))
    assert [s.kind for s in fb.sections] == [
        *(SectionKind.INPUT, SectionKind.OUTPUT, SectionKind.IN_OUT),
        *(SectionKind.STATIC, SectionKind.STATIC, SectionKind.TEMP, SectionKind.CONSTANT),
    ]
    assert [s.retain for s in fb.sections if s.kind is SectionKind.STATIC] == ["RETAIN", ""]
    assert [m.name for m in fb.sections[3].members] == ["w", "v"]
    word, view, wrrec = fb.section(SectionKind.STATIC)
    assert (word.start, word.comment, view.at, wrrec.type) == ("16#1", "Word", "w", NamedType("WRREC"))
    assert {e.path: e.byte for e in layout_block(fb, {}).entries if e.depth == 0} == {
        "go": 0,
        "w": 2,
        "v": 2,
        "wr": 4,
    }


def test_types_structures_and_instance_dbs():
    udt = (
        '<SW.Types.PlcStruct ID="0"><AttributeList>'
        + sections(**{"None": '<Member Name="s" Datatype="Struct"><Member Name="a" Datatype="Int" /></Member>'})
        + "<Name>U</Name></AttributeList></SW.Types.PlcStruct>"
    )
    instance = (
        '<SW.Blocks.InstanceDB ID="1"><AttributeList><InstanceOfName>Job</InstanceOfName>'
        + sections(Static='<Member Name="n" Datatype="Int"><StartValue>7</StartValue></Member>')
        + "<Name>Job_DB</Name><Number>9</Number></AttributeList></SW.Blocks.InstanceDB>"
    )
    blocks, diagnostics = read_simaticml(document(udt, instance), "x.xml")
    assert diagnostics == []
    assert (blocks[0].kind, blocks[0].optimized) == (BlockKind.UDT, None)
    assert isinstance(blocks[0].section(SectionKind.STATIC)[0].type, StructType)
    assert (blocks[1].instance_of, blocks[1].optimized) == ("Job", None)
    assert image(blocks[1], {}).hex() == "0007"


def test_start_values_of_array_elements():
    """Listed by position; gaps keep the default; two dimensions count the last index fastest."""
    subs = "".join(
        f'<Subelement Path="{path}"><StartValue>{value}</StartValue></Subelement>'
        for path, value in (("1,6", "5"), ("2,5", "6"))
    )
    member = f'<Member Name="a" Datatype="Array[1..2,5..6] of Int">{subs}</Member>'
    assert image(one(global_db(member)), {}).hex() == "0000" + "0005" + "0006" + "0000"


@pytest.mark.parametrize(("values", "shown"), [("11111", "[5(1)]"), ("11300", "[1, 1, 3, 0, 0]"), ("1", "[1]")])
def test_equal_values_of_a_whole_array_are_one_repetition(values, shown):
    """``[8(25.0)]``: sources of the TIA Portal have it; its documents have an element for each."""
    elements = "".join(
        f'<Subelement Path="{n}"><StartValue>{value}</StartValue></Subelement>' for n, value in enumerate(values)
    )
    block = one(global_db(f'<Member Name="a" Datatype="Array[0..5] of Int">{elements}</Member>'))
    assert block.sections[0].members[0].start == shown
    assert image(block, {}).hex() == "".join(f"000{value}" for value in values.ljust(6, "0"))


@pytest.mark.parametrize("place", ["1,0", "1;0"])
def test_start_values_inside_user_types_and_structures_in_arrays(place):
    """Path ``1,0`` is element 1 of the outer and element 0 of the inner array; older documents of ours have ``1;0``."""
    inner = (
        '<Member Name="b" Datatype="Byte"><StartValue>1</StartValue>'
        '<Subelement Path="2"><StartValue>9</StartValue></Subelement></Member>'
        '<Member Name="a" Datatype="Array[0..1] of Byte">'
        f'<Subelement Path="{place}"><StartValue>8</StartValue></Subelement></Member>'
    )
    expanded = (
        '<Member Name="u" Datatype="&quot;U&quot;"><Sections><Section Name="None">'
        '<Member Name="x" Datatype="Int"><StartValue>4</StartValue></Member></Section></Sections></Member>'
    )
    db = one(global_db(f'<Member Name="s" Datatype="Array[1..2] of Struct">{inner}</Member>{expanded}'))
    udt = Block(BlockKind.UDT, "U", (Section(SectionKind.STATIC, (Member("x", ELEMENTARY["INT"]),)),))
    assert image(db, {"U": udt}).hex() == "01000800" + "09000000" + "0004"


def test_start_values_in_arrays_of_several_dimensions_inside_each_other():
    """A Path has the indices of all arrays from the outermost in: 1 of the outer, 0,5 of the inner."""
    inner = '<Member Name="a" Datatype="Array[0..1,5..6] of Byte"><Subelement Path="{}"><StartValue>7</StartValue>'
    text = '<Member Name="s" Datatype="Array[1..2] of Struct">' + inner + "</Subelement></Member></Member>"
    assert image(one(global_db(text.format("1,0,6"))), {}).hex() == "00070000" + "00000000"
    assert image(one(global_db(text.format("2,1,5"))), {}).hex() == "00000000" + "00000700"
    _, diagnostics = read_simaticml(document(global_db(text.format("1,0"))), "x.xml")
    assert [d.message for d in diagnostics] == ["Subelement Path 1,0 does not fit the arrays of a"]


def test_optional_document_info_and_other_objects_are_passed_over():
    assert read_simaticml(document("<DocumentInfo/>", "<SW.Tags.PlcTagTable ID='0'/>")) == ([], [])


def test_billion_laughs_external_entities_and_any_dtd_are_refused():
    """Refused before anything is expanded, whatever the encoding."""
    laughs = "".join(f'<!ENTITY l{n} "{f"&l{n - 1};" * 10}">' for n in range(1, 10))
    bomb = f'<!DOCTYPE Document [<!ENTITY l0 "lol">{laughs}]><Document>&l9;</Document>'
    external = '<!DOCTYPE d [<!ENTITY x SYSTEM "file:///etc/passwd">]><Document>&x;</Document>'
    hidden = "<!-- <Document> --><!DOCTYPE Document><Document/>"
    for text in (bomb, external, hidden, "<!DOCTYPE Document SYSTEM 'http://localhost/x.dtd'><Document/>"):
        assert codes(text.encode()) == ["PG810"], text
        assert codes(f'<?xml version="1.0" encoding="utf-16"?>{text}'.encode("utf-16")) == ["PG810"], text


@pytest.mark.parametrize(
    ("data", "line"),
    [
        (b"", 1),
        (b"not xml", 1),
        (b"<Document>\n<Engineering>\n</Document>", 3),
        (b"<Document>\n  &undefined;</Document>", 2),
        (b"\xff\xfe\xfa", 1),
        (b"<Document>\n" + b"<a>" * 3000, 2),
    ],
)
def test_malformed_documents_are_refused_with_line_and_column(data, line):
    blocks, diagnostics = read_simaticml(data, "x.xml")
    (found,) = diagnostics
    assert (blocks, found.code, found.span.file, found.span.line) == ([], "PG811", "x.xml", line)
    assert found.span.column >= 1
    assert "line" not in found.message.partition(",")[2]


@pytest.mark.parametrize(
    "data",
    [
        b"<Other/>",
        document('<SW.Blocks.Recipe ID="0"/>'),
        document(global_db("").replace("<Name>WR_DataBuffer</Name>", "")),
        document(global_db("").replace("<Number>3</Number>", "")),
        document(global_db("", number="x")),
        document(global_db("").replace("GlobalDB", "InstanceDB")),
        document(global_db('<Member Datatype="Int" />')),
        document(global_db('<Member Name="a" />')),
        document(global_db('<Member Name="a" Datatype="Array[] of Int" />')),
        document(global_db("").replace("Interface/v5", "Interface/v9")),
        document(global_db("").replace('Name="Static"', 'Name="Statik"')),
        document(global_db('<Member Name="a" Datatype="Array[0..1] of Int"><Subelement Path="7"><StartValue>1'
                           "</StartValue></Subelement></Member>")),
        document(global_db('<Member Name="a" Datatype="Struct">' * 70 + "</Member>" * 70)),
    ],
)  # fmt: skip
def test_missing_attributes_and_unknown_kinds_are_reported(data):
    assert codes(data) == ["PG812"]


def test_files_too_large_or_missing(tmp_path):
    path = tmp_path / "big.xml"
    path.write_bytes(b" " * (MAX_BYTES + 1))
    assert [d.code for d in read_simaticml(path)[1]] == ["PG802"]
    assert codes(b" " * (MAX_BYTES + 1)) == ["PG802"]
    assert [d.code for d in read_simaticml(tmp_path / "none.xml")[1]] == ["PG804"]
    path.write_bytes(document(global_db(FAQ_DB3)))
    blocks, _ = read_simaticml(path)
    assert blocks[0].span.file == str(path)


@given(st.binary(max_size=200) | st.text(max_size=200).map(lambda t: (BOM + HEADER + t).encode()))
def test_any_bytes_give_diagnostics_never_an_exception(data):
    blocks, diagnostics = read_simaticml(data)
    assert not blocks
    assert diagnostics


def test_tag_tables():
    table = (
        '<SW.Tags.PlcTagTable ID="0"><AttributeList><Name>Drive</Name></AttributeList><ObjectList>'
        '<SW.Tags.PlcTag ID="1" CompositionName="Tags"><AttributeList><DataTypeName>Bool</DataTypeName>'
        "<LogicalAddress>%M50.0</LogicalAddress><Name>WriteRequest</Name></AttributeList><ObjectList>"
        '<MultilingualText ID="2" CompositionName="Comment"><ObjectList><MultilingualTextItem ID="3" '
        'CompositionName="Items"><AttributeList><Culture>en-US</Culture><Text>starts the job</Text>'
        "</AttributeList></MultilingualTextItem></ObjectList></MultilingualText></ObjectList></SW.Tags.PlcTag>"
        '<SW.Tags.PlcTag ID="4" CompositionName="Tags"><AttributeList><Name>Broken</Name></AttributeList>'
        '</SW.Tags.PlcTag><SW.Tags.PlcUserConstant ID="5" CompositionName="UserConstants"><AttributeList>'
        "<DataTypeName>Int</DataTypeName><Name>N</Name><Value>47</Value></AttributeList></SW.Tags.PlcUserConstant>"
        "</ObjectList></SW.Tags.PlcTagTable>"
    )
    (found,), diagnostics = read_tag_table(document(table), "t.xml")
    assert found.name == "Drive"
    assert found.tags == (Tag("WriteRequest", "Bool", "%M50.0", "starts the job", found.tags[0].span),)
    assert [(c.name, c.type, c.value) for c in found.constants] == [("N", "Int", "47")]
    assert [d.code for d in diagnostics] == ["PG812", "PG812"]


EXPORTED = (
    "<?xml version='1.0' encoding='utf-8'?>\n<Tagtable name='Drive'>\n  <!-- exported by the TIA Portal -->\n"
    "  <Tag type='Bool' hmiVisible='True' retain='False' remark='starts &amp; stops' addr='%M50.0'>Request</Tag>\n"
    "  <Tag type='Bool' remark='' addr=''>Nowhere</Tag>\n"
    "  <Constant type='Int' remark='' value='47'>LAST</Constant>\n</Tagtable>\n"
)
"""A tag table as the editor of the TIA Portal exports it: the other form besides SimaticML, with the same suffix."""


def test_tag_tables_of_the_editor():
    (found,), diagnostics = read_tag_table(EXPORTED.encode(), "t.xml")
    assert found.name == "Drive"
    assert found.tags == (Tag("Request", "Bool", "%M50.0", "starts & stops", found.tags[0].span),)
    assert [(c.name, c.type, c.value) for c in found.constants] == [("LAST", "Int", "47")]
    assert [(d.code, d.span.line) for d in diagnostics] == [("PG812", 5)]


def test_watch_tables():
    table = (
        '<SW.WatchAndForceTables.PlcWatchTable ID="0"><AttributeList><Name>Watch</Name></AttributeList>'
        "<ObjectList>"
        '<SW.WatchAndForceTables.PlcWatchTableEntry ID="1" CompositionName="Entries"><AttributeList>'
        "<DisplayFormat>Hex</DisplayFormat><ModifyValue>16#03</ModifyValue>"
        '<Name>"WR_DataBuffer".Request_Ref</Name></AttributeList></SW.WatchAndForceTables.PlcWatchTableEntry>'
        '<SW.WatchAndForceTables.PlcWatchTableEntry ID="2" CompositionName="Entries"><AttributeList>'
        "<Address>%DB4.DBD6</Address><DisplayFormat>FloatingPoint</DisplayFormat></AttributeList>"
        '</SW.WatchAndForceTables.PlcWatchTableEntry><SW.WatchAndForceTables.PlcWatchTableEntry ID="3" '
        'CompositionName="Entries"><AttributeList><Name>"x"</Name></AttributeList>'
        "</SW.WatchAndForceTables.PlcWatchTableEntry></ObjectList></SW.WatchAndForceTables.PlcWatchTable>"
    )
    (found,), diagnostics = read_watch_table(document(table), "w.xml")
    assert diagnostics == []
    first, second, third = found.entries
    assert third == WatchEntry('"x"', None, "", None, third.span)
    assert first == WatchEntry('"WR_DataBuffer".Request_Ref', None, "Hex", "16#03", first.span)
    assert second == WatchEntry("", "%DB4.DBD6", "FloatingPoint", None, second.span)
