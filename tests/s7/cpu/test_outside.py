"""Functions called from Python without a wrapper, and blocks that Python stands in for."""

import pytest

from plcgen.base.diagnostics import DiagnosticError
from plcgen.s7.cpu.outside import Stub
from plcgen.s7.cpu.testing import load_scl

FUNCTIONS = """FUNCTION "Scaled" : Real
VAR_INPUT
x : Int;
name : String[10];
END_VAR
VAR_OUTPUT
high : Bool;
text : String[20];
END_VAR
VAR_IN_OUT
count : DInt;
rows : Array[1..3] of Int;
END_VAR
BEGIN
#Scaled := INT_TO_REAL(#x) / 2.0;
#high := #x > 10;
#text := CONCAT(IN1 := #name, IN2 := '!');
#count := #count + 1;
#rows[2] := #x;
END_FUNCTION
FUNCTION "Sum" : DInt
VAR_INPUT
values : Array[*] of DInt;
END_VAR
VAR_TEMP
i : DInt;
END_VAR
BEGIN
FOR #i := LOWER_BOUND(ARR := #values, DIM := 1) TO UPPER_BOUND(ARR := #values, DIM := 1) DO
#Sum := #Sum + #values[#i];
END_FOR;
END_FUNCTION
FUNCTION "Nothing" : Void
VAR_OUTPUT
y : Int;
END_VAR
BEGIN
#y := 7;
END_FUNCTION
"""


def test_a_function_with_python_values():
    """Values, texts and arrays go in; outputs, in-outs and the value of the FC come back by name."""
    bench = load_scl(FUNCTIONS)
    found = bench.call("Scaled", x=25, name="pump", count=4, rows=[1, 2, 3])
    assert found == {"high": True, "text": "pump!", "count": 5, "rows": [1, 25, 3], "Scaled": 12.5}
    assert bench.call("Sum", values=[1, 2, 3, 4]) == {"Sum": 10}
    assert bench.call("Nothing") == {"y": 7}


def test_a_function_of_s7_300():
    """The same on an S7-300, where outputs are handed in."""
    text = FUNCTIONS.partition('FUNCTION "Sum"')[0]
    found = load_scl(text, dialect="tia-300").call("Scaled", x=3, name="a", count=-1, rows=[0, 0, 0])
    assert found == {"high": False, "text": "a!", "count": 0, "rows": [0, 3, 0], "Scaled": 1.5}


def test_an_input_that_is_none():
    """A wrong name is told, with the right ones."""
    with pytest.raises(ValueError, match="no parameter y: x, name"):
        load_scl(FUNCTIONS).call("Scaled", y=1)


CALLER = """FUNCTION_BLOCK "Use"
VAR
f : "Valve";
n : Int;
opened : Bool;
position : Real;
END_VAR
BEGIN
#n := "Lookup"(key := 3, found => #opened);
#f(go := TRUE, speed := 5, position => #position);
END_FUNCTION_BLOCK
DATA_BLOCK "D"
"Use"
BEGIN
END_DATA_BLOCK
"""
LOOKUP = 'FUNCTION "Lookup" : Int\nVAR_INPUT\nkey : Int;\nEND_VAR\nVAR_OUTPUT\nfound : Bool;\nEND_VAR\nEND_FUNCTION\n'
VALVE = (
    'FUNCTION_BLOCK "Valve"\nVAR_INPUT\ngo : Bool;\nspeed : Int;\nEND_VAR\nVAR_OUTPUT\nposition : Real;\nEND_VAR\n'
    "VAR\nsteps : Int;\nEND_VAR\nEND_FUNCTION_BLOCK\n"
)


def test_stubs_from_python():
    """Inputs arrive by name, outputs go back; an instance keeps what the stub writes into it."""
    seen = []

    def valve(*, go, speed):
        seen.append((go, speed))
        return {"position": 2.5 * len(seen), "steps": len(seen)}

    stubs = [Stub(LOOKUP, lambda key: {"Lookup": key * 11, "found": True}), Stub(VALVE, valve)]
    bench = load_scl(CALLER, stubs=stubs)
    bench.call("D")
    bench.call("D")
    assert seen == [(True, 5), (True, 5)]
    assert [bench.cpu[f"D.{name}"] for name in ("n", "opened", "position", "f.steps")] == [33, True, 5.0, 2]


def test_stubs_from_yaml(tmp_path):
    """A file has the interface of each block and what every call of it gives."""
    path = tmp_path / "stubs.yaml"
    body = "".join(
        f"- interface: |\n{''.join(f'    {line}' + chr(10) for line in text.splitlines())}  outputs: {outputs}\n"
        for text, outputs in ((LOOKUP, "{Lookup: 5, found: true}"), (VALVE, "{position: 1.5}"))
    )
    path.write_text(body, encoding="utf-8")
    bench = load_scl(CALLER, stubs=path)
    bench.call("D")
    assert [bench.cpu[f"D.{name}"] for name in ("n", "opened", "position")] == [5, True, 1.5]
    path.write_text("- name: x\n", encoding="utf-8")
    with pytest.raises(DiagnosticError, match="no stub"):
        load_scl(CALLER, stubs=path)


def test_a_block_that_is_missing_is_still_told():
    """Without a stub a missing block is an error, as before."""
    with pytest.raises(DiagnosticError, match=r"PG806|PG825"):
        load_scl(CALLER)
