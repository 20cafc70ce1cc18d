"""In which order the parts of an expression are evaluated: the leftmost operand first (IEC 61131-3, 3.3.1)."""

import pytest

from plcgen.s7.cpu.cpu import Cpu
from tests.s7.cpu.support import load

ALSO = """DATA_BLOCK "Data"
{ S7_Optimized_Access := 'FALSE' }
STRUCT n : Int := 1; a : Array[0..3] of Int; END_STRUCT;
BEGIN
END_DATA_BLOCK
FUNCTION "Inc" : Int
{ S7_Optimized_Access := 'FALSE' }
BEGIN
"Data".n := "Data".n + 1;
#Inc := 10;
END_FUNCTION
FUNCTION "Pair" : Int
{ S7_Optimized_Access := 'FALSE' }
VAR_INPUT x : Int; y : Int; END_VAR
BEGIN
#Pair := #x * 100 + #y;
END_FUNCTION
FUNCTION "Out" : Int
{ S7_Optimized_Access := 'FALSE' }
VAR_OUTPUT x : Int; END_VAR
BEGIN
#x := 5;
#Out := 10;
END_FUNCTION
"""
CASES = [
    ('"Data".n + "Inc"()', 11),
    ('"Inc"() + "Data".n', 12),
    ('"Data".n + "Inc"() + "Data".n', 13),
    ('"Pair"(x := "Data".n, y := "Inc"())', 110),
    ('"Pair"(y := "Data".n, x := "Inc"())', 1002),  # in the order of the declaration
    ('"Pair"(x := "Data".n + 1, y := "Pair"(x := "Data".n, y := "Inc"()))', 310),
    ('#s + "Out"(x => #s)', 13),
    ('#t + "Out"(x => #t)', 14),
    ('BOOL_TO_INT("Data".n = "Inc"() - 9)', 1),
    ('BOOL_TO_INT(#s = 3 AND "Out"(x => #s) = 10 AND #s = 5)', 1),
    ('BOOL_TO_INT(#f AND #s = 3 OR "Out"(x => #s) = 11 OR #s = 3)', 1),
    ('BOOL_TO_INT(NOT (#s = 3 XOR "Out"(x => #s) = 10))', 1),
    ('"Data".a["Data".n] + "Inc"()', 17),
    ('MIN(IN1 := "Data".n, IN2 := "Inc"())', 1),
    ('LIMIT(MN := "Data".n, IN := "Inc"() - 10, MX := 9)', 1),
    ('SEL(G := "Data".n = 1, IN0 := 20, IN1 := "Inc"())', 10),
]


@pytest.mark.parametrize("coverage", [False, True])
@pytest.mark.parametrize(("expression", "expected"), CASES, ids=[case[0] for case in CASES])
def test_the_left_operand_is_evaluated_first(expression, expected, coverage):
    """What a function changes counts to the right of its call only."""
    variables = "r : Int; s : Int; f : Bool := TRUE;"
    code = f'"Data".a[1] := 7; #s := 3; #t := 4; #r := {expression};'
    cpu = Cpu(load({"also": ALSO, "vars": variables, "temp": "t : Int;", "code": code}, coverage=coverage))
    cpu.call("Test_DB")
    assert (cpu["Test_DB.r"], cpu.misuses) == (expected, [])
