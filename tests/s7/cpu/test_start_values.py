"""Start values that do not fit their type: each is reported at its place, whatever declares it."""

import pytest

from plcgen.s7.cpu.program import Program
from plcgen.s7.cpu.sources import check_source
from plcgen.s7.scl.dialect import Dialect

UDT = 'TYPE "U"\nVERSION : 0.1\n   STRUCT\n{}\n   END_STRUCT;\nEND_TYPE\n'
DB = 'DATA_BLOCK "D"\nVERSION : 0.1\n   STRUCT\n{}\n   END_STRUCT;\nBEGIN\n{}\nEND_DATA_BLOCK\n'
FB = (
    'FUNCTION_BLOCK "F"\nVERSION : 0.1\n   VAR\n{}\n   END_VAR\n   VAR CONSTANT\n{}\n   END_VAR\n'
    "BEGIN\n;\nEND_FUNCTION_BLOCK\n"
)

UNFIT = """
Int := 70000                                 | 70000
Int := -32769                                | -32769
USInt := 300                                 | 300
UInt := -1                                   | -1
Word := 16#12345                             | 16#12345
Real := 16#1_7F80_0000                       | 16#1_7F80_0000
Bool := 5                                    | 5
Real := TRUE                                 | TRUE
Time := 5                                    | 5
Char := 'ab'                                 | 'ab'
Block_FB := FC 5                             | FC 5
Block_FB := FB 70000                         | FB 70000
String[3] := 'abcd'                          | 'abcd'
Array[0..2] of Int := [1, 70000, 3, 4]       | 70000, more than 3 values
Array[0..9] of Int := [10(70000)]            | 70000
Array[0..2] of Int := [1, 70000, -40000]     | 70000, -40000
Struct q : USInt := 300; r : Int := 40000; END_STRUCT | 300, 40000
"""
"""A declaration, and the values that do not fit it: ranges of Siemens' help, "Overview of the valid data types"."""

FIT = """
Int := -32768
Int := 16#8001
SInt := SINT#255
Word := -1
Real := 5
Real := 16#0000000F
Real := 16#7F80_0000
LReal := 16#FFF0_0000_0000_0000
Time := T#-24d20h31m23s648ms
String[3] := 'abc'
Block_FB := FB 12
Block_FC := fc 5678
Timer := 654
Array[0..2] of Int := [3(7)]
Array[1..2] of Struct q : Int; END_STRUCT := [(1), ()]
Int := "LIMIT_OF_THE_PROJECT"
TO_Struct_Modulo := ((), (), 360.0)
"U_of_another_file" := (1, 2, 3)
"""


def rows(table):
    return [tuple(part.strip() for part in row.split("|")) for row in table.strip().splitlines()]


def unfit(tmp_path, name, text):
    """Lines and messages of PG824, of the file alone and as a program, which must agree."""
    path = tmp_path / name
    path.write_text(text)
    alone = [
        (d.span.line, d.message) for d in check_source(path, Dialect.TIA_1200_1500).diagnostics if d.code == "PG824"
    ]
    whole = Program.load([path], Dialect.TIA_1200_1500).diagnostics
    assert alone == [(d.span.line, d.message) for d in whole if d.code == "PG824"]
    return alone


@pytest.mark.parametrize(("declared", "values"), rows(UNFIT))
def test_unfit_start_values_are_reported_in_every_kind_of_block(tmp_path, declared, values):
    """Two members each: not only the first one is said."""
    members = f"a : {declared};\nb : {declared};"
    for name, text in (
        ("u.udt", UDT.format(members)),
        ("d.db", DB.format(members, "")),
        ("f.scl", FB.format(members, "")),
    ):
        found = unfit(tmp_path, name, text)
        wanted = values.split(", ")
        assert len(found) == 2 * len(wanted), found
        assert all(sum(value in message for _, message in found) >= 2 for value in wanted)
        first = text.splitlines().index(members.splitlines()[0]) + 1
        assert {line for line, _ in found} == {first, first + 1}


@pytest.mark.parametrize("declared", FIT.strip().splitlines())
def test_values_that_fit_or_that_nobody_here_can_judge_raise_nothing(tmp_path, declared):
    for name, text in (("u.udt", UDT.format(f"a : {declared};")), ("f.scl", FB.format(f"a : {declared};", ""))):
        assert unfit(tmp_path, name, text) == []


def test_assignments_of_a_data_block_are_checked_each(tmp_path):
    members = "a : Int;\nb : Array[0..1] of Byte;"
    text = DB.format(members, "a := 70000;\nb[0] := 16#100;\nb[1] := 16#FF;\nb[2] := 0;\nnone := 1;")
    lines = text.splitlines()
    found = unfit(tmp_path, "d.db", text)
    assert [lines[line - 1] for line, _ in found] == ["a := 70000;", "b[0] := 16#100;", "b[2] := 0;", "none := 1;"]


def test_constants_are_checked_and_stand_for_their_value(tmp_path):
    """One without a value has the default of its type, as in Siemens' library LSimaHydTO: ``Byte := #UNDEFINED``."""
    constants = "LARGE : Int := 99999;\nNONE : Byte;\nFIVE : Int := 5;\nFAR : DInt := 70000;"
    members = "a : Byte := #NONE;\nb : Int := #FIVE;\nc : Int := #FAR;\nd : Array[0..1] of Byte := [#NONE, #FIVE];"
    text = FB.format(members, constants)
    found = [text.splitlines()[line - 1] for line, _ in unfit(tmp_path, "f.scl", text)]
    assert found == ["c : Int := #FAR;", "LARGE : Int := 99999;"]


def test_timers_and_counters_of_step7_v5_are_named_by_their_number(tmp_path):
    path = tmp_path / "d.db"
    path.write_text(
        "DATA_BLOCK D\nSTRUCT\nt : TIMER; c : COUNTER;\nEND_STRUCT;\nBEGIN\nt := T 0;\nc := Z 24;\nEND_DATA_BLOCK\n"
    )
    assert check_source(path, Dialect.STEP7_V5).diagnostics == ()
