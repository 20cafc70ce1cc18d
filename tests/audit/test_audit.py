"""The data blocks of FAQ 109750712, transcribed by hand, against data set 47: they pass, DB6 does not; every
damage to them is found with its code and at its place.
"""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

import plcgen
from plcgen.base.display.view import PLAIN
from plcgen.proof.checks import Outcome
from plcgen.report.registry import output_format
from tests.projects import FAQ, SPECS, generated_example

HERE = Path(__file__).parent / "faq"


@pytest.fixture
def project(tmp_path):
    """A copy of the FAQ's sources, DB6 with the room that the text of section 4.3 gives it."""
    folder = tmp_path / "faq"
    shutil.copytree(HERE, folder)
    edit(folder / "DB6.db", "Num_of_Para : Byte;", "Num_of_Para : Byte;\n      Reserve : Array[0..5] of Byte;")
    return folder


def edit(path: Path, old: str, new: str) -> None:
    text = path.read_text("utf-8")
    assert old in text, old
    path.write_text(text.replace(old, new, 1), encoding="utf-8")


def findings(folder: Path, spec: Path = FAQ):
    result = plcgen.audit(folder, spec=spec)
    return [d for d in result.diagnostics if d.code.startswith(("PG65", "PG66"))]


def test_the_faq_passes_but_for_db6():
    """DB3, DB4 and DB5 fit; DB6 has 4 bytes (figure 4-10), a negative answer needs 4 + 6 x 1 = 10."""
    result = plcgen.audit(HERE, spec=FAQ)
    checks = {c.id: c for c in result.checks() if c.id.startswith("buffers.")}
    assert {name.partition(".")[2]: check.outcome for name, check in checks.items()} == {
        "WR_DataBuffer": Outcome.OK,
        "RD_DataBuffer": Outcome.OK,
        "WR_DataBuffer_1": Outcome.OK,
        "RD_DataBuffer_1": Outcome.ERROR,
    }
    (found,) = result.diagnostics
    assert found.code == "PG651"
    assert found.message == "response buffer 6 bytes too small: DB6 has 4 bytes, a negative answer needs 10"
    assert (Path(found.span.file).name, found.span.line, found.span.column) == ("DB6.db", 3, 1)


def test_the_faq_has_layouts():
    """Offsets as the figures show them: 10, 10, 16 and 4 bytes."""
    tables = {table.name: table for table in plcgen.layout(*sorted(HERE.glob("*.db"))).blocks}
    assert {name: table.size for name, table in tables.items()} == {
        "WR_DataBuffer": 10, "RD_DataBuffer": 10, "WR_DataBuffer_1": 16, "RD_DataBuffer_1": 4,
    }  # fmt: skip


def test_with_room_for_the_negative_answer_everything_passes(project):
    """No finding, all calls matched."""
    result = plcgen.audit(project, spec=FAQ)
    assert result.diagnostics == ()
    assert {c.outcome for c in result.checks()} == {Outcome.OK}
    assert len([c for c in result.checks() if c.id.startswith("calls.")]) == 4


# file, old, new, code, line, column, words of the message
DAMAGE = {
    "wrong width": ("DB3.db", "Axis : Byte", "Axis : Word", "PG652", 9, 7, "Axis takes 2 bytes, the axis"),
    "pnu as a byte": ("DB3.db", "Para_No : Word", "Para_No : Byte", "PG652", 13, 7, "Para_No takes 1 byte"),
    "a bit": ("DB3.db", "Axis : Byte", "Axis : Bool", "PG652", 9, 7, "Axis takes 1 bit"),
    "value as a word": ("DB4.db", "Value : Real", "Value : Word", "PG652", 12, 7, "takes 2 bytes, the value of P50303"),
    "value as a long real": ("DB5.db", "Value : Real", "Value : LReal", "PG652", 16, 7, "takes 8 bytes"),
    "swapped pnu and subindex": (
        "DB3.db", "Para_No : Word;\n      Subindex : Word;", "Subindex : Word;\n      Para_No : Word;",
        "PG653", 13, 7, "Subindex and Para_No are swapped",
    ),
    "swapped header": (
        "DB4.db", "Para_Format : Byte;\n      Num_of_Element : Byte;",
        "Num_of_Element : Byte;\n      Para_Format : Byte;", "PG653", 10, 7, "and Para_Format are swapped",
    ),
    "member missing": (
        "DB3.db", "      Num_of_Para : Byte;\n", "", "PG653", 10, 7, "no member for the number of parameters, byte 3",
    ),
    "last member missing": ("DB4.db", "      ParameterValue : Real;\n", "", "PG653", 2, 1, "no member for the value"),
    "member too much": ("DB3.db", "Axis :", "Reserve : Word;\n      Axis :", "PG653", 9, 7, "Reserve at byte 2"),
    "odd count leaves a gap": (
        "DB3.db", "Request_Ref : Byte;", "Job : STRUCT Request_Ref : Byte; END_STRUCT;",
        "PG653", 8, 7, "Request_ID lies at byte 2: 1 byte of gap before it",
    ),
    "optimized": ("DB3.db", "'FALSE'", "'TRUE'", "PG654", 3, 1, "optimized access"),
    "request too short": (
        "DB5.db", "      Value : Real;\n", "", "PG651", 2, 1, "request buffer 4 bytes too small: DB5 has 12 bytes",
    ),
    "read as an integer": ("DB4.db", "Value : Real", "Value : DInt", "PG662", 12, 7, "a FloatingPoint, as DINT"),
    "LEN too long": ("OB1.awl", ":= 10,", ":= 12,", "PG657", 19, 12, "LEN is 12, the request"),
    "LEN too short": ("OB1.awl", ":= 16,", ":= 10,", "PG657", 44, 12, "its last 6 are cut off"),
    "no LEN": (
        "OB1.awl", "           LEN                      := 10,\n", "", "", 0, 0, "",
    ),
    "MLEN too small": (
        "OB1.awl", "MLEN                     := 10,\n           VALID                    := M    150",
        "MLEN                     := 4,\n           VALID                    := M    150",
        "PG658", 56, 12, "MLEN is 4, a negative answer of write_ramp_down has 10 bytes",
    ),
    "MLEN below the positive answer": (
        "OB1.awl", "MLEN                     := 10", "MLEN                     := 6",
        "PG658", 31, 12, "the positive answer of read_ramp_up has 10 bytes",
    ),
    "MLEN beyond RECORD": (
        "OB1.awl", "MLEN                     := 10", "MLEN                     := 240",
        "PG658", 31, 12, "MLEN is 240, RECORD has room for 10 bytes",
    ),
    "another DB": (
        "OB1.awl", "P#DB3.DBX0.0", "P#DB4.DBX0.0", "PG659", 24, 12, "is the response of read_ramp_up",
    ),
    "RECORD too short": (
        "OB1.awl", "P#DB3.DBX0.0 BYTE 10", "P#DB3.DBX0.0 BYTE 8", "PG659", 24, 12, "covers 8 bytes, the request has 10",
    ),
    "RECORD beyond the DB": (
        "OB1.awl", "P#DB4.DBX0.0 BYTE 10", "P#DB4.DBX0.0 BYTE 20", "PG659", 37, 12, "covers 20 bytes",
    ),
    "RECORD begins later": (
        "OB1.awl", "P#DB3.DBX0.0 BYTE 10", "P#DB3.DBX2.0 BYTE 10", "PG659", 24, 12, "begins at byte 2",
    ),
    "INDEX": ("OB1.awl", ":= 47", ":= 46", "PG660", 18, 12, "INDEX is 46, SINAMICS DC MASTER (6RA80) expects 47"),
    "ID": ("OB1.awl", "DW#16#100", "DW#16#101", "PG661", 17, 12, "ID is DW#16#101 (257), drive dcm has 256"),
}  # fmt: skip


@pytest.mark.parametrize("name", DAMAGE)
def test_damage(project, name):
    """One mistake is one finding, with its code and at its place."""
    file, old, new, code, line, column, words = DAMAGE[name]
    edit(project / file, old, new)
    found = findings(project)
    if not code:
        assert found == []
        return
    hits = [d for d in found if d.code == code]
    assert len(hits) == 1, found
    hit = hits[0]
    assert words in hit.message, hit.message
    assert (Path(hit.span.file).name, hit.span.line, hit.span.column) == (file, line, column)
    assert hit.help
    others = {d.code for d in found} - {code}
    assert others <= {"PG651", "PG657", "PG653"}, found  # a shorter DB is also too small for its telegram


def start(project: Path, **values: str) -> None:
    """Give DB3 start values: those of figure 5-1, changed by ``values``."""
    path = project / "DB3.db"
    figure = {
        "Request_Ref": "3", "Request_ID": "1", "Axis": "2", "Num_of_Para": "1", "Para_Attribute": "16#10",
        "Num_of_Element": "1", "Para_No": "50303", "Subindex": "0",
    }  # fmt: skip
    lines = "".join(f"   {name} := {value};\n" for name, value in (figure | values).items() if value)
    edit(path, "BEGIN\n", f"BEGIN\n{lines}")


def test_start_values_of_figure_5_1(project):
    """The telegram of figure 5-1 is what the spec asks for; reference, and elements 0 or 1, may be any."""
    start(project)
    assert findings(project) == []
    edit(project / "DB3.db", "Request_Ref := 3", "Request_Ref := 200")
    edit(project / "DB3.db", "Num_of_Element := 1", "Num_of_Element := 0")
    assert findings(project) == []


VALUES = {
    "parameter": ({"Para_No": "50304"}, 13, "Para_No holds 50304 (16#C480), the parameter number of P50303 is 50303"),
    "service": ({"Request_ID": "2"}, 8, "Request_ID holds 16#02 (change), the request ID is 16#01 (read)"),
    "axis": ({"Axis": "1"}, 9, "Axis holds 16#01"),
    "subindex": ({"Subindex": "1"}, 14, "Subindex holds 16#0001"),
    "attribute": ({"Para_Attribute": "16#20"}, 11, "Para_Attribute holds 16#20"),
    "elements": ({"Num_of_Element": "2"}, 12, "Num_of_Element holds 16#02"),
    "reference 0": ({"Request_Ref": "0"}, 7, "Request_Ref holds 16#00"),
    "swapped": ({"Para_No": "0", "Subindex": "50303"}, 13, "start values of Para_No and Subindex are swapped"),
    "forgotten": ({"Para_No": ""}, 13, "Para_No has no start value"),
}


@pytest.mark.parametrize("name", VALUES)
def test_start_values(project, name):
    """Start values that form another request: one finding at the member."""
    values, line, words = VALUES[name]
    start(project, **values)
    (found,) = findings(project)
    assert (found.code, found.span.line) == ("PG656", line)
    assert words in found.message


def test_written_value_and_format(project):
    """A constant of the spec must be in the request, in its format or one of the same size."""
    spec = project.parent / "job.yaml"
    spec.write_text(FAQ.read_text("utf-8"), encoding="utf-8")
    lines = "Request_Ref := 4; Request_ID := 2; Axis := 2; Num_of_Para := 1; Para_Attribute := 16#10;\n"
    lines += "Num_of_Element := 1; Para_No := 50304; Value_Format := 16#43; No_of_Element := 1; Value := 50.0;\n"
    edit(project / "DB5.db", "BEGIN\n", f"BEGIN\n{lines}")
    (found,) = findings(project, spec)
    assert found.message == "Value holds 50.0 (42 48 00 00), the value of P50304 is 100.0 (42 C8 00 00)"
    edit(project / "DB5.db", "50.0", "100.0")
    assert findings(project, spec) == []
    edit(project / "DB5.db", "16#43", "16#04")
    (found,) = findings(project, spec)
    assert found.message == "Value_Format holds 16#04 (Integer32), the format of P50304 is 16#08 (FloatingPoint)"


PADS = """\
plc: {name: pads, family: s7-300, toolchain: tia-v16, names: faq}
drives:
  d: {device: sinamics-g120, address: 256, parameters: {P900: {type: Unsigned8}, P901: {type: Unsigned16}}}
jobs:
  r: {drive: d, read: [P900, P901], request: {name: Rq}, response: {name: Rs}}
"""
PADDED = """\
DATA_BLOCK "Rs"
STRUCT
  Ref : Byte; ID : Byte; Axis : Byte; NumPara : Byte;
  Format1 : Byte; NumVal1 : Byte; Value1 : Byte; Pad1 : Byte;
  Format2 : Byte; NumVal2 : Byte; Value2 : Word; Reserve : Array[0..3] of Byte;
END_STRUCT;
BEGIN
END_DATA_BLOCK
"""
# Answer by hand: header 4, 05 01 vv 00 (one byte and its pad), 06 01 vv vv: 12 bytes; negative 4 + 2 x 6 = 16.


@pytest.mark.parametrize(
    ("old", "new", "code", "line"),
    [
        ("", "", "", 0),
        ("Pad1 : Byte;", "", "PG655", 5),
        ("Pad1 : Byte;", "Pad1 : Byte; Pad2 : Byte;", "PG653", 4),
        ("Pad1 : Byte;\n  Format2 : Byte; NumVal2 : Byte;", "\n  FormatAndNumber2 : Word;", "", 0),
    ],
)
def test_pads(tmp_path, old, new, code, line):
    """A value of one byte needs a pad; a gap that the compiler leaves is one too."""
    spec, source = tmp_path / "job.yaml", tmp_path / "Rs.db"
    spec.write_text(PADS, encoding="utf-8")
    source.write_text(PADDED.replace(old, new) if old else PADDED, encoding="utf-8")
    found = [d for d in findings(source, spec) if d.code != "PG650"]
    assert [(d.code, d.span.line) for d in found] == ([(code, line)] if code else [])


COARSE = {
    "words": "w0 : Word; w1 : Word; w2 : Word; w3 : Word; w4 : Word;",
    "bytes": "data : Array[0..9] of Byte;",
    "one structure": "h : STRUCT a : Byte; b : Byte; c : Byte; d : Byte; END_STRUCT; p : Array[0..2] of Word;",
    "longer": "data : Array[0..19] of Byte;",
}


@pytest.mark.parametrize("name", COARSE)
def test_coarser_and_finer_members(project, name):
    """The MM4 guide works with words (MW100 ..): whatever covers the telegram is good; its start values count."""
    text = f'DATA_BLOCK "WR_DataBuffer"\nSTRUCT {COARSE[name]} END_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n'
    (project / "DB3.db").write_text(text, encoding="utf-8")
    assert findings(project) == []
    if name == "words":
        values = "w0 := 16#0301; w1 := 16#0201; w2 := 16#1001; w3 := 16#C480; w4 := 0;"
        edit(project / "DB3.db", "BEGIN\n", f"BEGIN\n{values}\n")
        (found,) = findings(project)
        assert (found.code, "w3 holds 50304" in found.message) == ("PG656", True)


SCL = """\
FUNCTION_BLOCK "Talk"
VAR
  w : WRREC;
  own : Array[0..7] of Byte;
END_VAR
VAR CONSTANT
  SIZE : Int := {size};
END_VAR
BEGIN
#w(REQ := TRUE, ID := {id}, INDEX := {index}, LEN := {len}, RECORD := {record});
END_FUNCTION_BLOCK
"""


@pytest.mark.parametrize(
    ("changes", "code"),
    [
        ({}, ""),
        ({"len": "#SIZE"}, ""),
        ({"len": "#SIZE", "size": "12"}, "PG657"),
        ({"len": "12"}, "PG657"),
        ({"len": "#n"}, ""),
        ({"record": "DB3"}, ""),
        ({"record": "%DB3"}, ""),
        ({"record": "DB3.DBD0"}, "PG659"),
        ({"record": "P#DB3.DBX0.0 BYTE 10"}, ""),
        ({"record": '"RD_DataBuffer"'}, "PG659"),
        ({"record": "#own"}, "PG657"),
        ({"record": '"Nowhere"'}, ""),
        ({"index": "16#B02E"}, "PG660"),
        ({"id": "W#16#104"}, "PG661"),
        ({"id": "#address"}, ""),
    ],
)
def test_calls_in_scl(project, changes, code):
    """Every way SCL names a record; constants of the block count, variables are not guessed."""
    values = {"id": "256", "index": "47", "len": "10", "record": '"WR_DataBuffer"', "size": "10"} | changes
    (project / "Talk.scl").write_text(SCL.format(**values), encoding="utf-8")
    (project / "OB1.awl").unlink()
    found = findings(project)
    assert [d.code for d in found] == ([code] if code else [])
    assert all((Path(d.span.file).name, d.span.line) == ("Talk.scl", 10) for d in found)


def test_numbers_and_start_values_find_the_db(project):
    """A DB with another name is found by the number that the spec pins, or by what it asks for."""
    for file in ("DB3.db", "DB4.db"):
        text = (project / file).read_text("utf-8")
        number = f"DB {file[2]}"
        for name in ('"WR_DataBuffer"', '"RD_DataBuffer"'):
            text = text.replace(f"DATA_BLOCK {name}", f"DATA_BLOCK {number}")
        (project / file).write_text(text, encoding="utf-8")
    checks = {c.subject: c.text for c in plcgen.audit(project, spec=FAQ).checks()}
    assert "found by number" in checks["DB3"]
    start(project)
    text = (project / "DB3.db").read_text("utf-8")
    (project / "DB3.db").write_text(text.replace("DATA_BLOCK DB 3", 'DATA_BLOCK "Question"'), encoding="utf-8")
    checks = {c.subject: c.text for c in plcgen.audit(project, spec=FAQ).checks()}
    assert "found by start values" in checks['DB "Question"']


def test_what_belongs_to_no_job(project):
    """A request for another parameter, and a job with only one of its DBs."""
    text = (HERE / "DB3.db").read_text("utf-8").replace("WR_DataBuffer", "Other")
    text = text.replace("BEGIN\n", "BEGIN\nRequest_Ref := 1; Request_ID := 1; Axis := 1; Num_of_Para := 1;\n"
                        "Para_Attribute := 16#10; Num_of_Element := 1; Para_No := 945;\n")  # fmt: skip
    (project / "Other.db").write_text(text, encoding="utf-8")
    (project / "DB4.db").unlink()
    found = {d.message.partition(";")[0].partition(":")[0]: d for d in findings(project) if d.code == "PG650"}
    assert set(found) == {'DB "Other" is a request that reads P945[0]', "no DB for the response of read_ramp_up"}
    assert {d.severity.label for d in found.values()} == {"warning"}


@pytest.mark.parametrize("spec", SPECS, ids=lambda spec: spec.stem)
def test_generated_sources_pass(spec):
    """What plcgen itself writes has nothing to find, as text and as SimaticML."""
    folder = generated_example(spec.stem)
    for what in (folder, folder / "xml"):
        if what.exists():
            result = plcgen.audit(what, spec=spec)
            assert result.diagnostics == (), result.diagnostics
            buffers = [c for c in result.checks() if c.id.startswith("buffers.")]
            text = spec.read_text("utf-8")
            own = "request:" in text  # without data blocks of its own a telegram lies in the instance of its job
            drives = "device:" in text  # PPI masters have no DS47 buffers
            expected = {Outcome.OK if own else Outcome.NOT_RUN} if drives else set()
            assert {c.outcome for c in buffers} == expected


def test_optimized_by_default_on_s7_1500(tmp_path):
    """A source that does not say is optimized there."""
    spec = tmp_path / "job.yaml"
    spec.write_text(
        "plc: {name: a, sources: per_block, family: s7-1500, toolchain: tia-v19}\n"
        "drives: {d: {device: sinamics-g120, hardware_id: 270}}\n"
        "jobs: {read_speed: {drive: d, read: [r21], buffers: db}}\n"
    )
    plcgen.generate(spec, tmp_path / "out")
    path = tmp_path / "ReadSpeed_Request.db"
    text = (tmp_path / "out" / "db" / path.name).read_text("utf-8-sig")
    path.write_text(text.replace("{ S7_Optimized_Access := 'FALSE' }", ""), encoding="utf-8")
    assert "PG654" in {d.code for d in findings(path, spec)}


BROKEN = {
    "missing": ("none.db", None, "PG804"),
    "syntax": ("x.db", 'DATA_BLOCK "WR_DataBuffer" STRUCT a : ; END_STRUCT; BEGIN END_DATA_BLOCK', "PG801"),
    "unknown type": ("x.db", 'DATA_BLOCK "WR_DataBuffer" STRUCT a : "T"; END_STRUCT; BEGIN END_DATA_BLOCK', "PG806"),
    "start value": ("x.db", 'DATA_BLOCK "A" STRUCT a : Byte := 300; END_STRUCT; BEGIN END_DATA_BLOCK', "PG656"),
    "entities": ("x.xml", '<!DOCTYPE d [<!ENTITY x "y">]><Document/>', "PG810"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_broken_sources(tmp_path, name, capsys):
    """Whatever cannot be read is a diagnostic."""
    file, text, code = BROKEN[name]
    if text is not None:
        (tmp_path / file).write_text(text, encoding="utf-8")
    result = plcgen.audit(tmp_path / file, spec=FAQ)
    assert not result.ok
    assert code in {d.code for d in result.diagnostics}
    assert capsys.readouterr() == ("", "")


def test_broken_spec(tmp_path):
    """So is a spec."""
    result = plcgen.audit(HERE, spec=tmp_path / "none.yaml")
    assert [d.code for d in result.diagnostics] == ["PG110"]


def test_reports():
    """JSON, SARIF, JUnit and GitHub through the reporters of verify, under the name of the verb."""
    result = plcgen.audit(HERE, spec=FAQ)
    assert json.loads(output_format("json").render("verification", result, PLAIN))["kind"] == "audit"
    run = json.loads(output_format("sarif").render("verification", result, PLAIN))["runs"][0]
    assert [r["ruleId"] for r in run["results"]] == ["PG651"]
    document = ET.fromstring(output_format("junit").render("verification", result, PLAIN))  # our own output
    assert document.get("failures") == "1"
    names = {case.get("classname") for case in document.iter("testcase")}
    assert names == {"plcgen.audit.buffers", "plcgen.audit.calls"}
    assert output_format("github").render("verification", result, PLAIN).startswith("::error file=")


def test_a_wrong_width_among_names_that_say_nothing(project):
    """As many members as fields: a word is a mistake there, not two bytes in one."""
    types = ["Byte", "Byte", "Word", "Byte", "Byte", "Byte", "Word", "Word"]
    body = "".join(f"x{n} : {type_};\n" for n, type_ in enumerate(types))
    text = f'DATA_BLOCK "WR_DataBuffer"\nSTRUCT\n{body}END_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n'
    (project / "DB3.db").write_text(text, encoding="utf-8")
    (found,) = findings(project)
    assert (found.code, found.span.line) == ("PG652", 5)


def test_rdrec_is_known_without_mlen(project):
    """VALID makes it RDREC: its RECORD may be a response, and the length of RECORD counts."""
    call = '#r(REQ := TRUE, ID := 256, INDEX := 47, VALID => #v, RECORD := "RD_DataBuffer");'
    text = f'FUNCTION_BLOCK "F" VAR r : RDREC; v : Bool; END_VAR BEGIN\n{call}\nEND_FUNCTION_BLOCK'
    (project / "F.scl").write_text(text, encoding="utf-8")
    (project / "OB1.awl").unlink()
    result = plcgen.audit(project, spec=FAQ)
    assert result.diagnostics == ()
    assert 'RDREC in FB "F"' in {c.subject for c in result.checks()}


def test_automatic_numbers_match_nothing(tmp_path):
    """Only a number that the spec pins says which DB is meant; 472 is one that plcgen chose."""
    spec = tmp_path / "job.yaml"
    spec.write_text(FAQ.read_text("utf-8").replace("request: {db: 3, name: WR_DataBuffer}", ""), encoding="utf-8")
    number = plcgen.check(spec).project.jobs[0].telegrams[0].request.db.number
    source = tmp_path / "other.db"
    source.write_text(f"DATA_BLOCK DB {number} STRUCT a : Bool; END_STRUCT; BEGIN END_DATA_BLOCK", encoding="utf-8")
    assert not any(c.text.partition(" ")[0].isdigit() for c in plcgen.audit(source, spec=spec).checks())


def test_two_equal_requests_are_ambiguous(project):
    """Neither is taken for the job's: the audit does not guess."""
    start(project)
    text = (project / "DB3.db").read_text("utf-8")
    (project / "DB3.db").unlink()
    for name in ("One", "Two"):
        (project / f"{name}.db").write_text(text.replace("WR_DataBuffer", name), encoding="utf-8")
    outcomes = {c.subject: c.outcome for c in plcgen.audit(project, spec=FAQ).checks()}
    assert outcomes['DB3 "WR_DataBuffer"'] is Outcome.WARNING


def test_calls_in_simaticml(project, tmp_path):
    """The calls of an exported block are audited as those of its text; they stand where the block does."""
    values = {"id": "256", "index": "47", "len": "12", "record": '"WR_DataBuffer"', "size": "10"}
    text = tmp_path / "Talk.scl"
    text.write_text(SCL.format(**values), encoding="utf-8")
    assert plcgen.convert(text, to="xml", out=project, classic=True).ok
    (project / "OB1.awl").unlink()
    (found,) = findings(project)
    assert found.code == "PG657"
    assert (Path(found.span.file).name, found.span.column) == ("Talk.xml", 1)


def test_what_was_not_looked_at_is_said(project):
    """Buffers that no call names, and code without any call."""
    text = (project / "OB1.awl").read_text("utf-8")
    first = text.index("NETWORK", text.index("NETWORK") + 1)
    (project / "OB1.awl").write_text(f"{text[:first]}END_ORGANIZATION_BLOCK\n", encoding="utf-8")
    checks = {c.verdict for c in plcgen.audit(project, spec=FAQ).checks() if c.outcome is Outcome.NOT_RUN}
    assert checks == {"no WRREC call names it", "no RDREC call names it"}
    (project / "OB1.awl").unlink()
    assert [group.name for group in plcgen.audit(project, spec=FAQ).groups] == ["buffers"]
    (project / "F.scl").write_text('FUNCTION "F" : Void BEGIN "x" := 1; END_FUNCTION', encoding="utf-8")
    assert [group.name for group in plcgen.audit(project, spec=FAQ).groups] == ["buffers", "calls"]


def test_instance_data_are_no_buffer(project):
    """A DB made from a function block is not taken for a request, whatever its name."""
    (project / "DB3.db").write_text(
        'FUNCTION_BLOCK "F" VAR a : Int; END_VAR BEGIN END_FUNCTION_BLOCK\n'
        'DATA_BLOCK "WR_DataBuffer" "F" BEGIN END_DATA_BLOCK\n',
        encoding="utf-8",
    )
    assert "PG650" in {d.code for d in findings(project)}


def test_a_variable_is_not_a_constant(project):
    """The start value of a variable says nothing about what LEN is in a call."""
    values = {"id": "256", "index": "47", "len": "#n", "record": '"WR_DataBuffer"', "size": "10"}
    text = SCL.format(**values).replace("own :", "n : Int := 12;\n  own :")
    (project / "Talk.scl").write_text(text, encoding="utf-8")
    (project / "OB1.awl").unlink()
    assert findings(project) == []


def test_two_reads_into_one_db_are_an_error(project):
    """The answer that comes later overwrites the other; it is the second request whose answer nobody fetches."""
    edit(project / "OB1.awl", "P#DB6.DBX0.0 BYTE 10", "P#DB4.DBX0.0 BYTE 10")
    found = [d for d in findings(project) if d.code == "PG659"]
    assert [d.message for d in found] == [
        'DB "RD_DataBuffer_1" is never filled: its request is sent, but no RDREC fetches the answer',
        "RDREC in OB1 fills P#DB4.DBX0.0 BYTE 10, which RDREC in OB1 already fills",
    ]
    assert found[1].notes[0].span.line < found[1].span.line
