"""What local data holds at the start of a call, with garbage in it.

Help of the TIA Portal, "Parameter assignment to functions", temporary local data: random with standard access, but
texts are empty; with optimised access the default of the type.
"""

import pytest

from plcgen.s7.cpu.cpu import Cpu
from plcgen.s7.cpu.program import Program
from tests.s7.cpu.support import DIALECTS

SOURCE = """FUNCTION_BLOCK "Test"
{access}
VAR a : Int; b : Bool; c : DInt; s : String[9]; r : Int; END_VAR
VAR_TEMP t : Int; u : Bool; x : Array[0..3] of DInt; d : Struct n : Int; e : String[9]; END_STRUCT; END_VAR
VAR_TEMP m : Array[0..1] of String[3]; i : Int; END_VAR
BEGIN
#a := #t;
#b := #u;
#i := 2;
#c := #x[#i];
#s := CONCAT(IN1 := #d.e, IN2 := 'z');
#i := 1;
#r := LEN(#m[#i]);
END_FUNCTION_BLOCK
DATA_BLOCK "Test_DB"
{access}
"Test"
BEGIN
END_DATA_BLOCK
"""


def found(dialect: str, *, optimized: bool) -> list[list[object]]:
    """Values of a, b and c behind two calls, and both texts."""
    access = f"{{ S7_Optimized_Access := '{str(optimized).upper()}' }}"
    program = Program.load([("test.scl", SOURCE.replace("{access}", access))], DIALECTS[dialect], litter=True)
    assert program.diagnostics == []
    cpu = Cpu(program)
    rows: list[list[object]] = []
    for _ in range(2):
        cpu.call("Test_DB")
        rows.append([cpu[f"Test_DB.{name}"] for name in "abcsr"])
    return rows


@pytest.mark.parametrize("dialect", ["T3", "T15"])
def test_standard_access(dialect: str) -> None:
    """Numbers are garbage of two kinds in turn, texts are empty."""
    rows = found(dialect, optimized=False)
    assert all(row[0] != 0 and row[2] != 0 and row[3:] == ["z", 0] for row in rows)
    assert rows[0][0] != rows[1][0]
    assert {row[1] for row in rows} == {False, True}


@pytest.mark.parametrize(("access", "expected"), [("TRUE", 7), ("FALSE", 0)])
def test_members_of_types_have_the_defaults_of_the_type(access: str, expected: int) -> None:
    """In blocks with optimised access; elsewhere the soft CPU has zeros where it has no garbage."""
    source = """TYPE "u"
STRUCT n : Int := 7; END_STRUCT;
END_TYPE
FUNCTION_BLOCK "Test"
{ S7_Optimized_Access := 'ACCESS' }
VAR a : Int; END_VAR
VAR_TEMP t : "u"; END_VAR
BEGIN
#a := #t.n;
#t.n := 9;
END_FUNCTION_BLOCK
DATA_BLOCK "Test_DB"
{ S7_Optimized_Access := 'ACCESS' }
"Test"
BEGIN
END_DATA_BLOCK
"""
    cpu = Cpu(Program.load([("test.scl", source.replace("ACCESS", access))], DIALECTS["T15"]))
    for _ in range(2):
        cpu.call("Test_DB")
        assert cpu["Test_DB.a"] == expected


def test_optimised_access() -> None:
    """Everything has its default."""
    assert found("T15", optimized=True) == [[0, False, 0, "z", 0]] * 2
