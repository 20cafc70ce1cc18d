"""What two parts of a program share and must not: instances in two OBs, units of channels, drives of jobs."""

import pytest

from plcgen.base.diagnostics import Severity
from plcgen.s7.cpu.program import Program
from plcgen.s7.cpu.sharing import sharing
from plcgen.s7.cpu.sources import check_program
from plcgen.s7.scl.dialect import Dialect
from tests.s7.cpu.support import DIALECTS, cases
from tests.work import calls_of

CASES = cases("sharing")
ACCESS = "{ S7_Optimized_Access := 'FALSE' }\n"


def source(case):
    """The blocks of the case and those that it calls; the smallest that are a channel and a job."""
    v5 = case.get("dialect") == "V5"
    access, local = ("", "") if v5 else (ACCESS, "#")
    constant = "CONST\nONE := 1;\nEND_CONST" if v5 else "VAR CONSTANT\nONE : Int := 1;\nEND_VAR"
    classic = case.get("dialect", "T15") != "T15"
    drive = "driveAddress : DWORD" if classic else "hardwareId : HW_IO"
    data = ("STRUCT", "END_STRUCT;") if v5 else ("VAR", "END_VAR")
    return f"""TYPE "tUnit"
STRUCT
  x : INT;
END_STRUCT;
END_TYPE
TYPE "tPlace"
STRUCT
  y : INT;
END_STRUCT;
END_TYPE
FUNCTION_BLOCK "Talker"
{access}VAR_IN_OUT
  unit : "tUnit";
  place : "tPlace";
END_VAR
VAR
  send : {"SFB53" if v5 else "WRREC"};
  buffer : ARRAY[0..9] OF BYTE;
END_VAR
BEGIN
{local}send(REQ := FALSE, ID := {"DW#16#0" if classic else "0"}, INDEX := 47, LEN := 10, RECORD := {local}buffer);
END_FUNCTION_BLOCK
FUNCTION_BLOCK "Ask"
{access}VAR_INPUT
  {drive};
  slot : INT;
END_VAR
VAR_IN_OUT
  unit : "tUnit";
END_VAR
BEGIN
{local}unit.x := 1;
END_FUNCTION_BLOCK
DATA_BLOCK "AUnit"
{access}{data[0]}
  unit : "tUnit";
{data[1]}
BEGIN
END_DATA_BLOCK
DATA_BLOCK "BUnit"
{access}{data[0]}
  unit : "tUnit";
{data[1]}
BEGIN
END_DATA_BLOCK
DATA_BLOCK "Gate"
{access}{data[0]}
  channels : ARRAY[1..4] OF "tPlace";
  bytes : ARRAY[0..9] OF BYTE;
{data[1]}
BEGIN
END_DATA_BLOCK
FUNCTION_BLOCK "Calls"
{access}VAR
  channelA : "Talker";
  channelB : "Talker";
  more : ARRAY[1..2] OF "Talker";
  ask : "Ask";
  asks : ARRAY[1..2] OF "Ask";
  read : {"SFB52" if v5 else "RDREC"};
  bytes : ARRAY[0..9] OF BYTE;
  mine : "tUnit";
  here : "tPlace";
  flag : BOOL;
  n : INT;
  id : {"DWORD" if classic else "HW_IO"};
END_VAR
{constant}
BEGIN
{case.get("calls", "").rstrip() or ";"}
END_FUNCTION_BLOCK
DATA_BLOCK "Calls_DB"
{access}"Calls"
BEGIN
END_DATA_BLOCK
{case.get("also", "")}"""


def shown(diagnostic, text, case):
    """Code, place (in the code of Calls or in what the case adds), severity if it is no error, message."""
    calls = text.index('FUNCTION_BLOCK "Calls"')
    code = text.count("\n", 0, text.index("BEGIN", calls)) + 2
    also = text.count("\n", 0, text.rindex("END_DATA_BLOCK\n", 0, -len(case.get("also", "")) or None)) + 2
    span = diagnostic.span
    place = f"{span.line - also}" if span.line >= also else f"calls {span.line - code}"
    severity = "" if diagnostic.severity is Severity.ERROR else "warning "
    return f"{diagnostic.code} {place}:{span.column} {severity}{diagnostic.message}"


@pytest.mark.parametrize("case", CASES, ids=[case["name"] for case in CASES])
def test_sharing(case):
    """Each mistake is reported once, at its place, with what it shares; what is right is not."""
    text = source(case)
    program = Program.load(
        [("test.scl", text)],
        DIALECTS[case.get("dialect", "T15")],
        tags=case.get("tags"),
        constants=case.get("constants"),
    )
    unknown = {"PG820"} if case.get("unknown") else set()
    assert {d.code for d in program.diagnostics if d.severity is Severity.ERROR} <= unknown
    assert [shown(d, text, case) for d in sharing(program.link)] == case["found"]


def test_notes_lead_along_both_ways():
    """The second call of the instance has a note for the first way and for the call that both share."""
    case = next(case for case in CASES if case["name"] == "through an FC and an FB")
    (found,) = sharing(Program.load([("test.scl", source(case))], Dialect.TIA_1200_1500).link)
    lines = source(case).split("\n")
    assert [(note.message, lines[note.span.line - 1].split(" BEGIN")[0]) for note in found.notes] == [
        ("the path from Main", 'ORGANIZATION_BLOCK "Main"'),
        ("the call of the instance", 'FUNCTION "Inner" : Void'),
    ]


def test_check_program_reports_it(tmp_path):
    """The files of a program are checked together; the OBs may be of another file."""
    case = next(case for case in CASES if case["name"] == "instance DB in two OBs")
    (tmp_path / "blocks.scl").write_text(source({**case, "also": ""}), "ascii")
    (tmp_path / "mine.scl").write_text(case["also"], "ascii")
    found = check_program(sorted(tmp_path.iterdir()), Dialect.TIA_1200_1500).diagnostics
    assert [(d.code, d.span.file, d.span.line) for d in found] == [("PG840", str(tmp_path / "mine.scl"), 2)]


def hostile(blocks):
    """Function blocks, Main and OB35 that call the first, and work for looking at them in calls of Python functions."""
    obs = "".join(f'ORGANIZATION_BLOCK "{ob}" BEGIN "Top"(); END_ORGANIZATION_BLOCK\n' for ob in ("Main", "OB35"))
    text = source({"also": "".join(blocks) + 'DATA_BLOCK "Top" "F0" BEGIN END_DATA_BLOCK\n' + obs})
    link = Program.load([("hostile.scl", text)], Dialect.TIA_1200_1500).link
    return calls_of(lambda: sharing(link))


def nested(number, inside, members="abc"):
    """One FB with instances of another in it."""
    calls = " ".join(f"#{name}();" for name in members)
    declared = " ".join(f'{name} : "{inside}";' for name in members)
    return f'FUNCTION_BLOCK "F{number}" VAR {declared} END_VAR BEGIN {calls} END_FUNCTION_BLOCK\n'


@pytest.mark.slow
def test_instances_in_instances_are_bounded():
    """Three instances on each of 30 levels would be 3^30; an FB that contains itself has no end."""
    last = (
        'FUNCTION_BLOCK "F30" VAR w : WRREC; END_VAR BEGIN #w(REQ := FALSE, ID := 1, INDEX := 47); END_FUNCTION_BLOCK\n'
    )
    found, work = hostile([nested(number, f"F{number + 1}") for number in range(30)] + [last])
    assert [d.code for d in found] == ["PG840"]
    assert work < 3_000_000
    circle = nested(0, "F0", "ab").replace("#b();", "#b(); #w(REQ := FALSE, ID := 1, INDEX := 47);")
    _, work = hostile([circle.replace("VAR ", "VAR w : WRREC; ")])
    assert work < 3_000_000
