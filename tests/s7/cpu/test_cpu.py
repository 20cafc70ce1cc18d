"""The CPU itself: cycle, start-up, retained data, symbols, coverage, speed of building."""

import datetime as dt

import pytest

from plcgen.s7.cpu.cpu import Cpu
from plcgen.s7.cpu.program import Program
from plcgen.s7.cpu.testing import load_scl
from plcgen.s7.scl.dialect import Dialect
from tests.s7.cpu.support import load, run

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


def test_coverage_behind_jumps():
    """Each statement is counted as often as it runs: behind RETURN and EXIT less often, behind a label more often."""
    code = """#n := #n + 1;
REPEAT
IF #n = 2 THEN
RETURN;
END_IF;
#a := #a + 1;
UNTIL #a >= 3 END_REPEAT;
WHILE TRUE DO
#b := #b + 1;
IF #b > 4 THEN
EXIT;
END_IF;
#c := #b;
END_WHILE;
again:
#d := #d + 1;
IF #d < 3 THEN
GOTO again;
END_IF;
#e := #d;"""
    found = Cpu(load({"vars": "n : Int; a : Int; b : Int; c : Int; d : Int; e : Int;", "code": code}, coverage=True))
    found.call("Test_DB")
    found.call("Test_DB")  # n = 2: it returns
    statements = {
        probe.line - 7: count
        for probe, count in zip(found.program.probes, found.coverage, strict=True)
        if probe.kind == "statement"
    }
    assert found.misuses == []
    assert statements == {
        0: 2, 1: 2, 2: 4, 3: 1, 5: 3, 7: 1, 8: 5, 9: 5, 10: 1, 12: 4, 15: 3, 16: 3, 17: 2, 19: 1,
    }  # fmt: skip


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


INFORMED = """DATA_BLOCK DB1
STRUCT first : ARRAY[0..19] OF BYTE; cyclic : ARRAY[0..19] OF BYTE; start : ARRAY[0..19] OF BYTE; END_STRUCT
BEGIN
END_DATA_BLOCK
ORGANIZATION_BLOCK OB1
VAR_TEMP
info : ARRAY[0..19] OF BYTE; own : INT;
END_VAR
BEGIN
DB1.first := info; own := 1;
END_ORGANIZATION_BLOCK
ORGANIZATION_BLOCK OB35
VAR_TEMP
class : BYTE; inf : BYTE; rest : ARRAY[0..17] OF BYTE;
whole AT class : ARRAY[0..19] OF BYTE;
END_VAR
BEGIN
DB1.cyclic := whole;
END_ORGANIZATION_BLOCK
ORGANIZATION_BLOCK OB100
VAR_TEMP
info : ARRAY[0..19] OF BYTE;
END_VAR
BEGIN
DB1.start := info;
END_ORGANIZATION_BLOCK
"""


def test_start_information():
    """The 20 bytes of OB1, OB35 and OB100: System and Standard Functions A5E00709327-01, pages 1-5, 1-13 and 1-57."""
    found = load_scl(INFORMED, dialect="v5").cpu
    found.time.start_time = dt.datetime(2026, 11, 22, 12, 34, 56)  # a CPU has no zone
    date = "26 11 22 12 34 56"

    def info(member):
        return bytes(found[f"DB1.{member}"]).hex(" ").upper()

    found.scan(10)
    # behind a cold restart: 04; previous, shortest and longest cycle 10 ms; Sunday is 1
    assert info("start") == f"13 85 1B 64 00 00 00 00 00 00 00 00 {date} 00 01"
    assert info("first") == f"11 04 01 01 00 00 00 0A 00 0A 00 0A {date} 01 01"
    found.scan(30)
    assert info("first") == f"11 03 01 01 00 00 00 1E 00 0A 00 1E {date} 04 01"
    found.restart("warm")
    found.scan(5)
    assert info("start") == f"13 81 1B 64 00 00 00 00 00 00 00 00 {date} 04 01"
    assert info("first") == f"11 01 01 01 00 00 00 05 00 05 00 05 {date} 04 51"
    found.run("OB35")
    assert info("cyclic") == f"11 36 0C 23 00 00 00 00 00 00 00 64 {date} 04 51"


def test_blocks_that_call_each_other_twice():
    """40 levels with two calls each are 2**40 calls: the watchdog of the CPU ends that scan."""
    blocks = ['FUNCTION "f0" : Void\nBEGIN\n;\nEND_FUNCTION\n']
    for level in range(1, 41):
        call = f'"f{level - 1}"();\n'
        blocks.append(f'FUNCTION "f{level}" : Void\nBEGIN\n{call}{call}END_FUNCTION\n')
    blocks.append('ORGANIZATION_BLOCK "Main"\nBEGIN\n"f40"();\nEND_ORGANIZATION_BLOCK\n')
    found = load_scl("".join(blocks)).cpu
    found.scan()
    assert [misuse.code for misuse in found.misuses] == ["PG835"]
    assert found.faulted


@pytest.mark.parametrize("move", ["#a := #b;", "#n := BLKMOV(SRCBLK := #b, DSTBLK => #a);"])
def test_bytes_without_end(move):
    """A loop of 900,000 passes with 30,000 bytes each would move 27 GB."""
    code = f"FOR #i := 1 TO 900000 DO\n{move}\nEND_FOR;"
    vars_ = "a : Array[0..29999] of Byte; b : Array[0..29999] of Byte; i : DInt; n : Int;"
    found = run({"vars": vars_, "code": code})
    assert [misuse.code for misuse in found.misuses] == ["PG835"]


def test_copies_for_another_access_count():
    """An IN_OUT of the other kind of access is copied there and back in every call: 9,000 times 60,000 bytes."""
    also = 'TYPE "big"\nSTRUCT\na : Array[0..29999] of Byte;\nEND_STRUCT;\nEND_TYPE\n'
    also += "DATA_BLOCK \"Far\"\n{ S7_Optimized_Access := 'TRUE' }\n"
    also += 'STRUCT\nu : "big";\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n'
    also += 'FUNCTION "Use" : Void\n{ S7_Optimized_Access := \'FALSE\' }\nVAR_IN_OUT\np : "big";\nEND_VAR\nBEGIN\n'
    also += "#p.a[0] := 1;\nEND_FUNCTION\n"
    found = run({"also": also, "vars": "i : Int;", "code": 'FOR #i := 1 TO 9000 DO "Use"(p := "Far".u); END_FOR;'})
    assert [misuse.code for misuse in found.misuses] == ["PG835"]


def test_enable_output():
    """ENO belongs to a block: TRUE at its start, FALSE where it says so; calls hand it out with ENO => only.

    Help of the TIA Portal, "EN/ENO mechanism in SCL", with "Set ENO automatically" off.
    """
    also = """FUNCTION "bad" : Void
BEGIN
ENO := FALSE;
END_FUNCTION
FUNCTION_BLOCK "outer"
{ S7_Optimized_Access := 'FALSE' }
BEGIN
"bad"();
END_FUNCTION_BLOCK
"""
    code = """"bad"(ENO => #a);
#b := ENO;
#o(ENO => #c);
ENO := FALSE;
"bad"();
#o();
#d := ENO;"""
    vars_ = 'a : Bool := TRUE; b : Bool; c : Bool; d : Bool := TRUE; o : "outer";'
    found = run({"also": also, "vars": vars_, "code": code})
    assert [found[f"Test_DB.{name}"] for name in "abcd"] == [False, True, True, False]


def test_enable_output_of_a_record_block():
    """FALSE in the call that reports an error (help, "Overview" of asynchronous instructions)."""
    code = "#w(REQ := TRUE, ID := 5, INDEX := 47, LEN := 1, RECORD := #q, ENO => #a);"
    code += "#t(IN := TRUE, PT := T#1s, ENO => #b);"
    found = run({"vars": "w : WRREC; q : Array[0..1] of Byte; a : Bool := TRUE; b : Bool; t : TON_TIME;", "code": code})
    assert (found["Test_DB.a"], found["Test_DB.b"]) == (False, True)


@pytest.mark.parametrize("interrupt", [None, {}])
def test_litter_in_local_data(interrupt):
    """On request temporaries that nobody wrote hold something, in the next call something else."""
    case = {
        "temp": "w : Word; r : Real; f : Bool; s : Struct a : Word; b : Word; END_STRUCT;",
        "vars": "a : Word; b : Real; c : Bool; d : Word;",
        "code": "#a := #w; #b := #r; #c := #f; #s.a := 1; #d := #s.b;",
    }
    names = ("a", "b", "c", "d")
    clean, dirty = (Cpu(load(case, litter=litter)) for litter in (False, True))
    found = []
    for cpu in (clean, dirty, dirty):
        cpu.run("Test_DB", interrupt=interrupt)
        found.append([cpu[f"Test_DB.{name}"] for name in names])
    assert not any(found[0])
    assert all(found[1])
    assert all(one != other for one, other in zip(*found[1:], strict=True))
