"""Documents from strangers: a diagnostic with its place, bounded time and memory, and nothing of them becomes code."""

from __future__ import annotations

import resource
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

import plcgen
from plcgen.base.diagnostics import DiagnosticError, Severity
from plcgen.s7.layout.layout import layout_block
from plcgen.s7.xml.reading.documents import read_simaticml, read_tag_table, read_watch_table
from plcgen.s7.xml.reading.invariants import check_invariants
from plcgen.s7.xml.reading.source import source
from plcgen.s7.xml.reading.types import parse_datatype
from plcgen.s7.xml.reading.xml import MAX_TAGS, TAGS
from tests.projects import ROOT
from tests.s7.xml.reading.documents import FB_SECTIONS, document, function_block, global_db, sections

EXAMPLE = (ROOT / "examples/s7-300_6ra80_dp_tia/expected/xml/WriteRampDown.xml").read_bytes()
TEXT = "http://www.siemens.com/automation/Openness/SW/NetworkSource/StructuredText/v3"


def found(data: bytes) -> list[tuple[str, int]]:
    """Codes and lines of the errors of a document; every way of reading it ends well."""
    blocks, diagnostics = read_simaticml(data, "x.xml")
    for block in blocks:
        source(block)
    read_tag_table(data, "x.xml")
    read_watch_table(data, "x.xml")
    check_invariants(data, "x.xml")
    assert all(d.span.file == "x.xml" for d in diagnostics)
    return [(d.code, d.span.line) for d in diagnostics if d.severity is Severity.ERROR]


def code(elements: str) -> bytes:
    """A document of an FB with these elements as its code."""
    network = f'<StructuredText xmlns="{TEXT}">{elements}</StructuredText>'
    return document(function_block(sections(**FB_SECTIONS), network))


LAUGHS = "".join(f'<!ENTITY l{n} "{f"&l{n - 1};" * 10}">' for n in range(1, 10))


@pytest.mark.parametrize(
    ("head", "body", "line"),
    [
        ('<!DOCTYPE d [<!ENTITY a "b">]>', "&a;", 1),
        ('<!DOCTYPE d [<!ENTITY x SYSTEM "file:///etc/passwd">]>', "&x;", 1),
        ('\n\n<!DOCTYPE d SYSTEM "http://127.0.0.1:9/x.dtd">', "", 3),
        ('<!-- <a> -->\n<!DOCTYPE d [<!ENTITY % p SYSTEM "http://127.0.0.1:9/p"> %p;]>', "", 2),
        (f'<!DOCTYPE d [<!ENTITY l0 "lol">{LAUGHS}]>', "&l9;", 1),
        ('<!DOCTYPE d [<!ENTITY q "' + "A" * 100_000 + '">]>', "&q;" * 10_000, 1),
        ("<!DOCTYPE d>", "", 1),
    ],
)
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
def test_document_types_are_refused_before_they_are_read(head: str, body: str, line: int, encoding: str) -> None:
    """Entities inside and outside, parameter entities, billion laughs, quadratic blow-up: PG810 where it stands."""
    data = f'<?xml version="1.0" encoding="{encoding.removesuffix("-sig")}"?>{head}<Document>{body}</Document>'
    assert found(data.encode(encoding)) == [("PG810", line)]


@pytest.mark.parametrize(
    "data",
    [
        b'<?xml version="1.0" encoding="utf-8"?>\n<Document>\n\xff</Document>',
        b'<?xml version="1.0" encoding="klingon"?>\n<Document/>',
        b'<?xml version="1.0" encoding="utf-16"?>\n<Document/>',
        b"\xef\xbb\xbf" + '<?xml version="1.0" encoding="utf-16"?>\n<Document>ü</Document>'.encode("utf-16-le"),
        b"<Document>\0</Document>",
        b"\x1f\x8b\x08\x00\x00\x00\x00\x00",
        b"PK\x03\x04",
        b"",
        b"\xef\xbb\xbf",
        b"   \n",
        b"{}",
        b"<Document></Dokument>",
        b'<Document a="1" a="2"/>',
        b"<Document>&nbsp;</Document>",
        b"<x:Document/>",
    ],
)
def test_what_is_no_xml_is_refused_with_its_place(data: bytes) -> None:
    """Wrong and contradictory encodings, archives, empty files, tags that do not close: one PG811."""
    problems = found(data)
    assert [name for name, _ in problems] in (["PG811"], ["PG812"])
    assert problems[0][1] >= 1


def test_every_truncation_is_one_diagnostic() -> None:
    """A download that broke off at any byte: PG811 with a line of the document."""
    lines = EXAMPLE.count(b"\n") + 1
    for size in [*range(0, 400, 7), *range(400, len(EXAMPLE), 9973), len(EXAMPLE) - 3]:
        problems = found(EXAMPLE[:size])
        assert len(problems) == 1, size
        assert problems[0][0] == "PG811"
        assert 1 <= problems[0][1] <= lines


@pytest.mark.slow
@given(st.integers(0, len(EXAMPLE) - 1), st.binary(min_size=1, max_size=4))
def test_damage_never_raises(place: int, junk: bytes) -> None:
    """Any bytes anywhere: blocks or diagnostics at lines of the document, never an exception."""
    damaged = EXAMPLE[:place] + junk + EXAMPLE[place + len(junk) :]
    assert all(0 <= line <= damaged.count(b"\n") + 1 for _, line in found(damaged))


@pytest.mark.parametrize(
    ("data", "expected"),
    [
        (b"<html><body/></html>", "PG812"),
        (document('<SW.Blocks.Mystery ID="0"/>'), "PG812"),
        (code('<Gadget UId="21"/>'), "PG812"),
        (code('<Access Scope="LocalVariable"><Gadget/></Access>'), "PG812"),
        (code('<Access Scope="LocalVariable"/>'), "PG812"),
        (code('<Access Scope="LocalVariable"><Symbol/></Access>'), "PG812"),
        (code('<Access Scope="Statusword"><Statusword Combination="BR"/></Access>'), "PG812"),
        (code('<Access Scope="Address"><Address Area="Local" BitOffset="0"/></Access>'), "PG812"),
        (code('<Access Scope="Address"><Address Area="DB" BitOffset="-1"/></Access>'), "PG812"),
        (code('<Access Scope="LiteralConstant"><Constant/></Access>'), "PG812"),
        (code('<Blank Num="1000000000"/>'), "PG812"),
        (code('<NewLine Num="-1"/>'), "PG812"),
        (code('<NewLine Num="' + "9" * 5000 + '"/>'), "PG812"),
        (document(global_db('<Member Name="a" Datatype="Array[0..' + "9" * 5000 + '] of Int"/>')), "PG812"),
        (document(global_db('<Member Name="a" Datatype="' + "Array[0..1] of " * 5000 + 'Int"/>')), "PG812"),
        (document(global_db('<Member Name="a" Datatype="String[' + "9" * 5000 + ']"/>')), "PG812"),
        (document(global_db('<Member Name="a" Datatype="&quot;x&quot; ; y : &quot;z&quot;"/>')), "PG812"),
        (document(global_db("", number="9" * 5000)), "PG812"),
        (document(global_db('<Member Name="a" Datatype="Int"/><Member Name="A" Datatype="Int"/>')), "PG805"),
        (document(global_db('<Member Name="s" Datatype="Struct"><Member Name="b" Datatype="Int"/>'
                            '<Member Name="B" Datatype="Int"/></Member>')), "PG805"),
    ],
)  # fmt: skip
def test_what_a_document_must_not_say(data: bytes, expected: str) -> None:
    """Unknown roots, kinds and elements, counts out of bounds, members declared twice."""
    problems = found(data)
    assert [name for name, _ in problems] == [expected]
    assert problems[0][1] >= 1


@pytest.mark.parametrize(
    ("kind", "value", "reason"),
    [
        ("Int", "999999999(3)", "a single value is needed"),
        ("Array[0..3] of Int", "[999999999(3)]", "more than 4 values"),
        ("Array[0..3] of Int", "[1, 2, 3, 4, 5]", "more than 4 values"),
        ("Int", "32768", "outside -32768..32767"),
        ("Int", "TRUE", "not a whole number"),
        ("Bool", "2", "TRUE, FALSE, 1 or 0"),
        ("Byte", "16#100", "outside 0..255"),
        ("Time", "5", "it needs the prefix TIME#"),
        ("String[5]", "'sixsix'", "6 characters do not fit STRING[5]"),
    ],
)
def test_a_start_value_that_does_not_fit_is_refused(kind: str, value: str, reason: str) -> None:
    """At a member, at an element of an array, and at a member of a user type."""
    message = f"{value} is no start value of {kind}: {reason}"
    start = f"<StartValue>{value}</StartValue>"
    member = f'<Member Name="a" Datatype="{kind}">{{}}</Member>'
    places = [member.format(start)]
    places.append(f'<Member Name="u" Datatype="&quot;U&quot;"><Sections><Section Name="None">{places[0]}</Section>'
                  "</Sections></Member>")  # fmt: skip
    if "Array" not in kind:
        single = f'<Subelement Path="1">{start}</Subelement>'
        places.append(f'<Member Name="a" Datatype="Array[0..1] of {kind}">{single}</Member>')
    for place in places:
        _, diagnostics = read_simaticml(document(global_db(place)), "x.xml")
        assert [(d.code, d.message) for d in diagnostics] == [("PG812", message)]


@pytest.mark.parametrize(
    ("kind", "value"),
    [
        ("Int", "16#FFFF"),  # the bits, up to the sign
        ("LReal", "16#7FF0_0000_0000_0000"),
        ("Array[0..3] of Int", "[4(16#8000)]"),
        ("Int", "MAX_PUMPS"),
        ("Int", "#LAST - 1"),
        ("Real", "-1.5E-3"),
        ("Time", "T#1s_500ms"),
        ("Char", "' '"),
        ("HW_IO", "300"),
        ("Array[0..99999] of Array[0..99999] of Int", "[1]"),
    ],
)
def test_a_start_value_that_nobody_can_judge_or_that_fits_is_read(kind: str, value: str) -> None:
    """Bits, constants with values from elsewhere, and types too large for any block, of which more is said later."""
    member = f'<Member Name="a" Datatype="{kind}"><StartValue>{value}</StartValue></Member>'
    blocks, diagnostics = read_simaticml(document(global_db(member)), "x.xml")
    assert diagnostics == []
    assert blocks[0].sections[0].members[0].start == value


def test_messages_are_bounded() -> None:
    """A hundred thousand mistakes do not make a hundred thousand messages of the code."""
    assert len(found(code("<Gadget/>" * 100_000))) == 100


@pytest.mark.parametrize(
    ("opening", "closing"),
    [
        ('<Access Scope="Expression"><Expression>', "</Expression></Access>"),
        ('<Access Scope="Call"><Instruction Name="f"><Token Text="("/><NamelessParameter>',
         '</NamelessParameter><Token Text=")"/></Instruction></Access>'),
        ('<Access Scope="LocalVariable"><Symbol><Component Name="a"><Token Text="["/>',
         '<Token Text="]"/></Component></Symbol></Access>'),
    ],
)  # fmt: skip
def test_deep_nesting(opening: str, closing: str) -> None:
    """What is deeper than a parser goes is PG811; below that it is read, without a recursion error."""
    for depth in (10, 40, 60, 3000):
        problems = found(code(opening * depth + '<Token Text="1"/>' + closing * depth))
        assert [name for name, _ in problems] in ([], ["PG811"])
    assert problems


def test_types_that_are_missing_or_contain_themselves() -> None:
    """The layout names the type and its place."""
    db, _ = read_simaticml(document(global_db('<Member Name="u" Datatype="&quot;U&quot;"/>')), "x.xml")
    with pytest.raises(DiagnosticError) as missing:
        layout_block(db[0], {})
    assert [(d.code, d.span.file) for d in missing.value.diagnostics] == [("PG806", "x.xml")]
    udt = '<SW.Types.PlcStruct ID="0"><AttributeList>{}<Name>U</Name></AttributeList></SW.Types.PlcStruct>'
    member = '<Member Name="again" Datatype="Array[0..1] of &quot;U&quot;"/>'
    types, problems = read_simaticml(document(udt.format(sections(**{"None": member}))), "u.xml")
    assert problems == []
    with pytest.raises(DiagnosticError) as circle:
        layout_block(db[0], {"U": types[0]})
    assert "PG807" in [d.code for d in circle.value.diagnostics]


def test_recursive_types_are_reported_by_convert(tmp_path: Path) -> None:
    """PG807, and nothing is written."""
    udt = '<SW.Types.PlcStruct ID="0"><AttributeList>{}<Name>U</Name></AttributeList></SW.Types.PlcStruct>'
    data = document(udt.format(sections(**{"None": '<Member Name="u" Datatype="&quot;U&quot;"/>'})))
    (tmp_path / "u.xml").write_bytes(data)
    result = plcgen.convert(tmp_path / "u.xml", to="scl", out=tmp_path / "out")
    assert [d.code for d in result.diagnostics] == ["PG807"]
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    "elements",
    [
        '<Token Text="END_FUNCTION_BLOCK FUNCTION_BLOCK &quot;Evil&quot; BEGIN"/>',
        "<Text>; END_FUNCTION_BLOCK\nFUNCTION_BLOCK evil BEGIN</Text>",
        '<Token Text="IF"/>',
        '<Token Text="\'"/>',
    ],
)
def test_code_that_is_no_code_of_one_block_is_not_written(elements: str, tmp_path: Path) -> None:
    """A source is written only if it parses as exactly the one block."""
    (tmp_path / "x.xml").write_bytes(code(elements))
    result = plcgen.convert(tmp_path / "x.xml", to="scl", out=tmp_path / "out")
    assert [d.code for d in result.diagnostics if d.severity is Severity.ERROR] == ["PG812"]
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    "member",
    [
        '<Member Name="a" Datatype="Int"><StartValue>1; END_STRUCT; END_DATA_BLOCK</StartValue></Member>',
        '<Member Name="a" Datatype="Int"><StartValue>1 // rest</StartValue></Member>',
        '<Member Name="a" Datatype="Int"><StartValue>1 (* </StartValue></Member>',
        '<Member Name="a" Datatype="Int"><StartValue>{ x }</StartValue></Member>',
    ],
)
def test_start_values_cannot_become_code(member: str) -> None:
    """What is no value is reported and left out."""
    blocks, diagnostics = read_simaticml(document(global_db(member)))
    assert [d.code for d in diagnostics] == ["PG812"]
    assert blocks[0].sections[0].members[0].start is None


def test_names_and_texts_cannot_become_code(tmp_path: Path) -> None:
    """Quotes, line breaks and ends of comments in every text of a document stay texts: the source still parses."""
    evil = "x&quot; : Int; END_VAR&#10;BEGIN 'y' *) */ { } // $"
    member = (
        f'<Member Name="{evil}" Datatype="Int"><AttributeList><StringAttribute Name="At">{evil}</StringAttribute>'
        f'<BooleanAttribute Name="{evil}">true</BooleanAttribute><BooleanAttribute Name="SetPoint">{evil}'
        f'</BooleanAttribute></AttributeList><Comment><MultiLanguageText Lang="en-US">{evil}</MultiLanguageText>'
        "</Comment></Member>"
    )
    data = document(function_block(sections(**FB_SECTIONS | {"Static": f'<Member Name="w" Datatype="Int"/>{member}'})))
    texts = data.decode().replace("<Text></Text>", f"<Text>{evil}</Text>")
    texts = texts.replace("<Name>Job</Name>", f"<Name>{evil}</Name>")
    blocks, diagnostics = read_simaticml(texts.encode())
    assert diagnostics == []
    text = source(blocks[0])
    (tmp_path / "x.xml").write_text(texts, "utf-8")
    result = plcgen.convert(tmp_path / "x.xml", to="scl", out=tmp_path / "out")
    assert (result.ok, len(result.written)) == (True, 1), result.diagnostics
    assert text.count("\nBEGIN\n") == 1
    assert sum(line.startswith("END_VAR") for line in text.splitlines()) == 1
    assert [path.parent for path in tmp_path.rglob("*.scl")] == [tmp_path / "out"]


def test_data_types_with_a_comment_or_a_path_are_none() -> None:
    """A data type is a name, a quoted name, an array or a string."""
    assert [parse_datatype(t) for t in ("Int; x", "Int // x", '"a"b"', "../x", "a b", '"a\nb"')] == [None] * 6


def test_a_gigabyte_is_refused_by_its_size(tmp_path: Path) -> None:
    """The size of a file is looked at before its content; the process stays small."""
    path = tmp_path / "big.xml"
    with path.open("wb") as file:
        file.truncate(1 << 30)
    blocks, diagnostics = read_simaticml(path)
    assert (blocks, [d.code for d in diagnostics]) == ([], ["PG802"])
    assert check_invariants(path)[0].code == "PG802"


@pytest.mark.skipif(sys.platform != "linux", reason="needs limits of the system")
def test_hostile_documents_in_a_small_process(tmp_path: Path) -> None:
    """Laughs, quadratic entities and huge counts in a process with 400 MB and ten seconds of processor time."""
    (tmp_path / "laughs.xml").write_text(f'<!DOCTYPE d [<!ENTITY l0 "lol">{LAUGHS}]><Document>&l9;</Document>')
    (tmp_path / "count.xml").write_bytes(code('<NewLine Num="99999999"/>' * 1000))
    value = '<Subelement Path="999999999"><StartValue>1</StartValue></Subelement>'
    array = f'<Member Name="a" Datatype="Array[0..999999999] of Int">{value}</Member>'
    (tmp_path / "array.xml").write_bytes(document(global_db(array)))
    (tmp_path / "blanks.xml").write_bytes(code('<Blank Num="10000"/>' * 5000))
    script = (
        "import sys, glob\nfrom plcgen.s7.xml.reading.documents import read_simaticml\n"
        "for path in sorted(glob.glob(sys.argv[1] + '/*.xml')):\n"
        "    blocks, problems = read_simaticml(path)\n"
        "    print(path.rsplit('/', 1)[1], *sorted({d.code for d in problems}))\n"
    )

    def limits() -> None:
        resource.setrlimit(resource.RLIMIT_AS, (400 << 20, 400 << 20))
        resource.setrlimit(resource.RLIMIT_CPU, (10, 10))

    run = subprocess.run(
        [sys.executable, "-c", script, str(tmp_path)], capture_output=True, text=True, check=False, preexec_fn=limits
    )
    assert run.returncode == 0, run.stderr
    assert run.stdout.split("\n")[:-1] == ["array.xml", "blanks.xml", "count.xml PG812", "laughs.xml PG810"]


def test_names_of_elements_do_not_fill_the_memory() -> None:
    """The memory for tags is bounded, however many different ones a document has."""
    found(code("".join(f"<t{n}/>" for n in range(3 * MAX_TAGS))))
    assert len(TAGS) <= MAX_TAGS


@pytest.mark.parametrize(
    ("elements", "message"),
    [
        ('<Token Text=";" UId="22"/><Blank UId="21"/>', "UId 21 comes after 22: they ascend in document order"),
        ('<Token Text=";" UId="21"/><Blank UId="21"/>', "UId 21 is used twice in one network"),
        ('<Token Text=";" UId="x"/>', "UId x is not a number"),
    ],
)
def test_uids_ascend(elements: str, message: str) -> None:
    """In StructuredText every UId is a number above the one before it."""
    messages = [d.message for d in check_invariants(code(elements), "x.xml")]
    assert message in messages
