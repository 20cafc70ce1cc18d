"""The envelope of SimaticML documents and the schemas of their islands."""

from __future__ import annotations

import pytest

from plcgen.s7.xml.reading.invariants import check_invariants
from tests.s7.xml.reading.documents import (
    FAQ_DB3,
    FB_SECTIONS,
    HEADER,
    STANDARD,
    document,
    function_block,
    global_db,
    sections,
)
from tests.xsd_support import validate_islands

SCL = "http://www.siemens.com/automation/Openness/SW/NetworkSource/StructuredText/v3"
CODE = f'<StructuredText xmlns="{SCL}"><NewLine UId="21" /><NewLine UId="22" /></StructuredText>'
DB = document(global_db(FAQ_DB3))
FB = document(function_block(sections(**FB_SECTIONS), CODE))
ENO = b"<SetENOAutomatically>false</SetENOAutomatically>"


def messages(data, **options):
    found = check_invariants(data, "x.xml", **options)
    assert {d.code for d in found} <= {"PG813"}
    return [d.message for d in found]


@pytest.mark.parametrize("data", [DB, FB])
def test_a_document_like_a_genuine_export_has_no_findings(data):
    assert messages(data) == []


def test_s7_300_documents_have_neither_memory_layout_nor_eno():
    classic = FB.replace(STANDARD.encode(), b"").replace(ENO, b"")
    assert messages(classic, classic=True) == []
    assert len(messages(FB, classic=True)) == 2
    assert messages(classic) == [
        "SW.Blocks.FB has no MemoryLayout",
        "SW.Blocks.FB has no SetENOAutomatically",
    ]


@pytest.mark.parametrize(
    ("data", "expected"),
    [
        (document(global_db(""), head=HEADER), "byte order mark"),
        (DB.replace(b'encoding="utf-8"', b'encoding="utf-8" standalone="yes"'), "does not begin with"),
        (DB.replace(b"V18", b"18"), "Engineering"),
        (DB.replace(b'<Engineering version="V18" />\n', b""), "Engineering"),
        (DB.replace(b'ID="3"', b'ID="7"').replace(b'ID="4"', b'ID="8"'), "ID 7: 3 is next"),
        (FB.replace(b'ID="9"', b'ID="09"'), "ID 09 is not"),
        (DB.replace(b' ID="1"', b""), "MultilingualText has no ID"),
        (DB.replace(b"<AutoNumber>false</AutoNumber>", b""), "has no AutoNumber"),
        (
            DB.replace(b"<Number>3</Number>", b"").replace(b"<Name>", b"<Number>3</Number><Name>"),
            "alphabetical",
        ),
        (DB.replace(STANDARD.encode(), b""), "has no MemoryLayout"),
        (FB.replace(ENO, b""), "has no SetENOAutomatically"),
        (DB.replace(b'"Comment"', b'"Remark"'), "Comment or the Title"),
        (
            DB.replace(b'"Comment"', b'"X"').replace(b'"Title"', b'"Comment"').replace(b'"X"', b'"Title"'),
            "order is",
        ),
        (DB.replace(b'Name="Static"', b'Name="None"'), "the sections are Static"),
        (document(global_db('<Member Name="s" Datatype="Struct" />')), "empty Struct"),
        (DB.replace(b"Interface/v5", b"Interface/v4"), "V18 has the namespace"),
        (FB.replace(b"StructuredText/v3", b"StructuredText/v4"), "V18 has the namespace"),
        (FB.replace(b'UId="22"', b'UId="21"'), "UId 21 is used twice"),
        (document(global_db("")).replace(b"Document>", b"Dokument>"), "not Document"),
    ],
)
def test_every_departure_is_found(data, expected):
    assert [m for m in messages(data) if expected in m], messages(data)


def test_organisation_blocks_of_s7_300_have_no_input_section():
    """Temp and Constant only; elsewhere Input comes first."""
    groups = {"Temp": "", "Constant": ""}
    ob = function_block(sections(**groups), CODE).replace("SW.Blocks.FB", "SW.Blocks.OB")
    ob = ob.replace("<SetENO", "<SecondaryType>ProgramCycle</SecondaryType><SetENO")
    expected = ["SW.Blocks.OB: the sections are Input, Temp, Constant"]
    assert messages(document(ob)) == expected
    classic = ob.replace(STANDARD, "").replace(ENO.decode(), "")
    assert messages(document(classic), classic=True) == []


def test_ids_are_upper_case_hexadecimal_in_document_order():
    """The tenth ID is A; a lower-case a is a finding."""
    table = b"<AttributeList><Name>t</Name></AttributeList></SW.Tags.PlcTagTable>"
    many = FB.replace(b"</SW.Blocks.FB>\n", b'</SW.Blocks.FB>\n<SW.Tags.PlcTagTable ID="A">' + table)
    assert messages(many) == []
    assert messages(many.replace(b'ID="A"', b'ID="a"')) == ["ID a is not an upper-case hexadecimal number"]


@pytest.mark.parametrize(
    ("attributes", "expected"),
    [
        ("<Name>a.b</Name>", []),
        ("<Address>%MW2</Address><DisplayFormat>Hex</DisplayFormat>", []),
        (
            "<DisplayFormat>Hex</DisplayFormat><Name>a.b</Name>",
            ["a row of a watch table by name has a Name only, not DisplayFormat, Name"],
        ),
        ("<DisplayFormat>Hex</DisplayFormat>", ["a row of a watch table has a Name or an Address"]),
    ],
)
def test_rows_of_watch_tables_by_name_have_a_name_only(attributes, expected):
    """The display format of such a row cannot be set, nor a value to modify: the TIA Portal refuses the table."""
    row = (
        '<SW.WatchAndForceTables.PlcWatchTableEntry ID="1" CompositionName="Entries"><AttributeList>'
        f"{attributes}</AttributeList></SW.WatchAndForceTables.PlcWatchTableEntry>"
    )
    table = (
        '<SW.WatchAndForceTables.PlcWatchTable ID="0"><AttributeList><Name>W</Name></AttributeList>'
        f"<ObjectList>{row}</ObjectList></SW.WatchAndForceTables.PlcWatchTable>"
    )
    assert messages(document(table)) == expected


def test_documents_that_cannot_be_read():
    assert [d.code for d in check_invariants(b"<a")] == ["PG811"]
    assert [d.code for d in check_invariants(b"<!DOCTYPE a><a/>")] == ["PG810"]


@pytest.mark.parametrize(
    ("version", "number"), [("V15.1", 3), ("V16", 4), ("V17", 5), ("V18", 5), ("V19", 5), ("V21", 5)]
)
def test_hand_written_islands_are_valid_by_the_schemas(tmp_path, version, number):
    """Otherwise the reader's documents would prove little."""
    scl = {"V15.1": 2, "V19": 4, "V21": 4}.get(version, 3)
    for n, data in enumerate((DB, FB)):
        path = tmp_path / f"{n}.xml"
        other = data.replace(b"Interface/v5", b"Interface/v%d" % number)
        path.write_bytes(other.replace(b"StructuredText/v3", b"StructuredText/v%d" % scl))
        assert validate_islands(path, version) == []


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        (b' Datatype="Word"', b"", "required but missing"),
        (b'Name="Static"', b'Name="Statik"', "Statik"),
        (b"<StartValue>16#01</StartValue>", b"<Wrong/>", "Wrong"),
        (b"Interface/v5", b"Interface/v4", "is in"),
    ],
)
def test_broken_islands_are_found_with_their_line(tmp_path, old, new, expected):
    path = tmp_path / "x.xml"
    path.write_bytes(DB.replace(old, new))
    found = validate_islands(path, "V18")
    assert found
    assert expected in found[0]
    assert int(found[0].partition(":")[0]) >= 4


def test_without_schemas_the_check_is_skipped_and_says_so(tmp_path, monkeypatch):
    monkeypatch.setenv("PLCGEN_SIMATICML_XSD", str(tmp_path / "none"))
    path = tmp_path / "x.xml"
    path.write_bytes(DB)
    with pytest.raises(pytest.skip.Exception, match="PLCGEN_SIMATICML_XSD"):
        validate_islands(path, "V18")
