"""The CPU itself: cycle, start-up, retained data, symbols, coverage, speed of building."""

import pytest
from cpu.support import load, run

from plcgen.cpu.cpu import Cpu
from plcgen.cpu.program import Program
from plcgen.cpu.testing import load_scl
from plcgen.scl.dialect import Dialect

PROGRAM = """DATA_BLOCK "Kept"
{ S7_Optimized_Access := 'FALSE' }
STRUCT
n : Int := 5; r : Real; s : String[6]; x : Array[1..3] of Int; t : Struct a : Bool; b : DInt; END_STRUCT; END_STRUCT;
BEGIN
END_DATA_BLOCK
DATA_BLOCK "Lost"
{ S7_Optimized_Access := 'FALSE' }
NON_RETAIN
STRUCT n : Int := 7; END_STRUCT;
BEGIN
n := 8;
END_DATA_BLOCK
ORGANIZATION_BLOCK "Main"
BEGIN
"Kept".n := "Kept".n + 1;
"Lost".n := "Lost".n + 1;
%MW2 := W#16#0001;
END_ORGANIZATION_BLOCK
ORGANIZATION_BLOCK "Startup"
BEGIN
"Kept".t.b := "Kept".t.b + 1;
END_ORGANIZATION_BLOCK
"""


def cpu():
    """CPU with retained and other data."""
    return load_scl(PROGRAM).cpu


def test_scan():
    """The first scan starts the CPU; every scan runs Main once and moves the clock."""
    found = cpu()
    found.scan(10, 3)
    assert (found["Kept.n"], found["Lost.n"], found["MW2"]) == (8, 11, 1)
    assert (found.clock, found.scans, found["Kept.t.b"]) == (30, 3, 1)


@pytest.mark.parametrize(("kind", "kept", "started"), [("warm", 8, 2), ("cold", 5, 1)])
def test_restart(kind, kept, started):
    """A warm restart keeps retentive blocks, a cold one none; flags are cleared, the start-up OB runs."""
    found = cpu()
    found.scan(10, 3)
    found.restart(kind)
    assert (found["Kept.n"], found["Lost.n"], found["MW2"], found["Kept.t.b"]) == (kept, 8, 0, started)


def test_symbols():
    """Values of every kind by path; names in any letter case."""
    found = cpu()
    found["Kept.r"] = 3
    found["kept.S"] = "abc"
    found["Kept.x"] = [1, -2, 3]
    found['"Kept".t'] = {"a": True, "b": 70000}
    assert found["Kept.r"] == 3.0
    assert found["Kept.s"] == "abc"
    assert found["Kept.x[2]"] == -2
    assert found["Kept.t"] == {"a": True, "b": 70000}
    assert found.db("Kept")[0:2] == b"\0\5"


@pytest.mark.parametrize("path", ["Nobody.x", "Kept.y", "Kept.x[4]", "DB99.DBW0", "level"])
def test_unknown_symbols(path):
    """A wrong path is a KeyError that names it."""
    with pytest.raises(KeyError, match=path.split(".", maxsplit=1)[0].split("[")[0]):
        cpu()[path]


@pytest.mark.parametrize(("path", "value"), [("Kept.n", 40000), ("Kept.s", "1234567"), ("Kept.n", "x"), ("Kept", 1)])
def test_values_that_do_not_fit(path, value):
    """A wrong value is a ValueError."""
    with pytest.raises(ValueError):
        cpu()[path] = value


def test_a_fault_ends_one_scan():
    """A fault ends the OB and is kept with its line; the next scan runs again."""
    case = {"vars": "x : Array[0..1] of Int; i : Int := 2; n : Int;", "code": "#n := #n + 1;\n#x[#i] := 1;\n#n := 100;"}
    found = run({**case, "calls": 3})
    assert found["Test_DB.n"] == 3
    assert [(misuse.code, misuse.file, misuse.line) for misuse in found.misuses] == [("PG834", "test.scl", 8)]
    assert str(found.misuses[0]) == "test.scl:8: PG834 index 2 is outside 0..1"


def test_coverage():
    """Statements, branches and loop passes that never ran."""
    case = {
        "vars": "a : Int; i : Int;",
        "code": "IF #a = 0 THEN\n#a := 1;\nELSE\n#a := 2;\nEND_IF;\nFOR #i := 1 TO 0 DO\n#a := 3;\nEND_FOR;",
    }
    found = Cpu(load(case, coverage=True))
    found.call("Test_DB")
    assert [(probe.line - 7, probe.kind) for probe in found.uncovered()] == [
        (0, "else"), (3, "statement"), (5, "pass"), (6, "statement"),
    ]  # fmt: skip
    found.call("Test_DB")
    assert [(probe.line - 7, probe.kind) for probe in found.uncovered()] == [(5, "pass"), (6, "statement")]


def test_no_coverage_costs_nothing():
    """Without coverage the generated code has no counters."""
    program = load({"vars": "a : Int;", "code": "#a := 1;"})
    assert program.probes == []
    assert "H[" not in program.compiled[0].source


def test_two_cpus_do_not_share_memory():
    """A program can run in many CPUs."""
    program = Program.load([("p.scl", PROGRAM)], Dialect.TIA_1200_1500)
    one, two = Cpu(program), Cpu(program)
    one.scan(10, 3)
    two.scan()
    assert (one["Kept.n"], two["Kept.n"]) == (8, 6)
