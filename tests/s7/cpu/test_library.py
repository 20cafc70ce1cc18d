"""Functions with a state, arrays of any length and VARIANT, and statements that nobody executes."""

import pytest

from plcgen.s7.cpu.state import freeze, thaw
from plcgen.s7.cpu.testing import load_scl

T3, T15 = "tia-300", "tia-1500"


def bench_of(variables, statements, *, also="", dialect=T15, tags=None):
    """One FB T with its instance D."""
    access = "{ S7_Optimized_Access := 'FALSE' }\n"
    text = (
        f'{also}FUNCTION_BLOCK "T"\n{access}VAR\n{variables}\nEND_VAR\nBEGIN\n{statements}\nEND_FUNCTION_BLOCK\n'
        f'DATA_BLOCK "D"\n{access}"T"\nBEGIN\nEND_DATA_BLOCK\n'
    )
    return load_scl(text, dialect=dialect, tags=tags)


TIMER = "s : Bool; r : Bool; q : Bool; b : Word; y : S5Time;"
S5 = {
    # S of each scan of 10 ms, Q in it; the time is 30 ms (help of the TIA Portal, each of the instructions)
    "S_PULSE": ("1111110", "1110000"),
    "S_PEXT": ("1000000", "1110000"),
    "S_ODT": ("1111101", "0001100"),
    "S_ODTS": ("1000000", "0001111"),
    "S_OFFDT": ("1100000", "1111100"),
}


@pytest.mark.parametrize("dialect", [T3, T15])
@pytest.mark.parametrize("name", S5)
def test_q_of_an_s5_timer(name, dialect):
    """Q of each of the five follows S as the help describes it."""
    call = f"#y := {name}(T_NO := %T5, S := #s, TV := S5T#30ms, R := #r, BI => #b, Q => #q);"
    bench = bench_of(TIMER, call, dialect=dialect)
    found = ""
    for state in S5[name][0]:
        bench.cpu["D.s"] = state == "1"
        bench.call("D")
        found += "1" if bench.cpu["D.q"] else "0"
    assert found == S5[name][1]


def test_rest_of_an_s5_timer():
    """BI counts units of the time base in binary, the function value is an S5TIME, R clears both."""
    bench = bench_of(
        TIMER, '#y := S_PEXT(T_NO := "late", S := #s, TV := S5T#50ms, R := #r, BI => #b);', tags={"late": "T7"}
    )
    bench.call("D")
    bench.cpu["D.s"] = True
    for _ in range(3):
        bench.call("D")
    assert (bench.cpu["D.b"], bench.cpu["D.y"]) == (3, 30)
    state = freeze(bench.cpu)
    bench.cpu["D.r"] = True
    bench.call("D")
    assert (bench.cpu["D.b"], bench.cpu["D.y"]) == (0, 0)
    thaw(bench.cpu, state)
    bench.call("D")
    assert bench.cpu["D.b"] == 2


def test_s5_counters():
    """Edges count, S loads BCD, R clears, 999 and 0 are the ends; one cell may be counted by three names."""
    bench = bench_of(
        "u : Bool; d : Bool; s : Bool; r : Bool; p : Word := 16#998; v : Word; q : Bool; y : Word;",
        "#y := S_CUD(C_NO := %C3, CU := #u, CD := #d, S := #s, PV := #p, R := #r, CV => #v, Q => #q);",
    )
    steps = [("", 0), ("s", 998), ("u", 999), ("u", 999), ("ud", 998), ("r", 0), ("d", 0), ("", 0), ("u", 1)]
    found = []
    for inputs, _ in steps:
        for name in "udsr":
            bench.cpu[f"D.{name}"] = name in inputs
        bench.call("D")
        assert bench.cpu["D.q"] == (bench.cpu["D.v"] > 0)
        assert bench.cpu["D.y"] == int(str(bench.cpu["D.v"]), 16)
        found.append(bench.cpu["D.v"])
    assert found == [count for _, count in steps]


def test_preset_and_reset_of_an_iec_timer():
    """PRESET_TIMER writes PT of a timer that runs, RESET_TIMER puts its data to 0."""
    bench = bench_of(
        "t : TON_TIME; l : TON_LTIME; p : Time; q : Bool; e : Time; x : LTime;",
        "#t(IN := TRUE, PT := T#1s); PRESET_TIMER(PT := T#20ms, TIMER := #t); #p := #t.PT; #q := #t.Q;\n"
        "PRESET_TIMER(PT := LT#3ms, TIMER := #l); #x := #l.PT; IF #q THEN RESET_TIMER(#t); END_IF; #e := #t.ET;",
    )
    bench.call("D")
    assert (bench.cpu["D.p"], bench.cpu["D.q"], bench.cpu["D.x"]) == (20, False, 3_000_000)
    bench.call("D")
    bench.call("D")
    assert (bench.cpu["D.q"], bench.cpu["D.e"]) == (True, 0)


OPEN = """FUNCTION "Sum" : Int
VAR_INPUT
x : Array[*] of Int;
END_VAR
VAR_TEMP
i : DInt;
END_VAR
BEGIN
FOR #i := LOWER_BOUND(ARR := #x, DIM := 1) TO UPPER_BOUND(ARR := #x, DIM := 1) DO
#Sum := #Sum + #x[#i];
END_FOR;
END_FUNCTION
FUNCTION_BLOCK "Any"
VAR_INPUT
v : Variant;
at : DInt;
END_VAR
VAR_IN_OUT
x : Array[*, *] of Int;
END_VAR
VAR_OUTPUT
high : DInt; count : UDInt; kind : Int;
END_VAR
VAR
m : Struct a : Int; END_STRUCT;
END_VAR
VAR_TEMP
w : Int;
END_VAR
BEGIN
#high := UPPER_BOUND(ARR := #x, DIM := 2);
#x[1, #at] := "Sum"(#x[2]) + 1;
#count := CountOfElements(#v);
#kind := 0;
IF TypeOf(#v) = Int THEN VariantGet(SRC := #v, DST => #w); #w := #w + 1; VariantPut(SRC := #w, DST := #v); #kind := 1;
ELSIF TypeOfElements(#v) = Int THEN #kind := 2;
END_IF;
CASE TypeOf(#v) OF Real: #kind := 3; END_CASE;
END_FUNCTION_BLOCK
"""


def test_open_arrays_and_variants():
    """An FC and an FB find bounds, elements and types of what they are given, also handed on."""
    bench = bench_of(
        'a : Array[3..5] of Int := [1, 2, 3]; b : Array[1..2, 0..1] of Int := [0, 0, 5, 6]; r : Real; f : "Any";\n'
        "y : Int; k1 : Int; k2 : Int; k3 : Int; n : UDInt; w : Int := 7;",
        '#y := "Sum"(#a); #f(v := #a, at := 1, x := #b); #k1 := #f.kind; #n := #f.count;\n'
        "#f(v := #w, at := 0, x := #b); #k2 := #f.kind; #f(v := #r, at := 0, x := #b); #k3 := #f.kind;",
        also=OPEN.replace('"Sum"(#x[2])', "#x[2, 0]"),
    )
    bench.call("D")
    assert bench.cpu.misuses == []
    assert bench.cpu["D.y"] == 6
    assert [bench.cpu[f"D.k{number}"] for number in (1, 2, 3)] == [2, 1, 3]
    assert (bench.cpu["D.n"], bench.cpu["D.w"], bench.cpu["D.b"], bench.cpu["D.f.high"]) == (3, 8, [6, 6, 5, 6], 1)


def test_beyond_an_open_array():
    """An index outside of what was handed over is a fault."""
    bench = bench_of(
        "a : Array[3..5] of Int; y : Int;",
        '#y := "Nth"(#a);',
        also=OPEN.replace("#Sum", "#Nth")
        .replace('"Sum" : Int', '"Nth" : Int')
        .replace("#x[#i]", "#x[#i + 1]")
        .partition("FUNCTION_BLOCK")[0],
    )
    bench.call("D")
    assert [misuse.code for misuse in bench.cpu.misuses] == ["PG834"]


def test_what_is_not_executed_fails_when_it_is_reached():
    """A statement with an instruction or a type that nobody executes ends the OB; those before it run, others too."""
    bench = bench_of(
        "f : Bool; a : Int; b : Array[0..3] of Byte; m : MC_POWER;",
        "#a := 1;\nIF #f THEN\n#a := 2;\n#a := DPRD_DAT(LADDR := 5, RECORD => #b);\n#a := 3;\nEND_IF;\n"
        "#a := #a + 10;\n#m.Enable := TRUE;\n#a := 4;",
    )
    bench.call("D")
    assert bench.cpu["D.a"] == 11
    bench.cpu["D.f"] = True
    bench.call("D")
    assert bench.cpu["D.a"] == 2
    assert [(misuse.code, misuse.line) for misuse in bench.cpu.misuses] == [("PG827", 14), ("PG827", 10)]


def test_enable_output_of_an_instruction():
    """``ENO =>`` says whether the instruction went well, in a call that stands alone and in one with a value."""
    bench = bench_of(
        "x : Real; e : Bool; f : Bool := TRUE; y : Int;",
        "#x := NORM_X(MIN := 0, VALUE := 5, MAX := 10, ENO => #e); #y := LIMIT(MN := 10, IN := 5, MX := 0, ENO => #f);",
    )
    bench.call("D")
    assert (bench.cpu["D.x"], bench.cpu["D.e"], bench.cpu["D.y"], bench.cpu["D.f"]) == (0.5, True, 5, False)


def test_stop():
    """STP ends the OB and every scan behind it, without a misuse, until a restart."""
    bench = bench_of("n : Int;", "#n := #n + 1; IF #n = 2 THEN STP(); END_IF; #n := #n + 1;")
    for _ in range(3):
        bench.call("D")
    assert (bench.cpu["D.n"], bench.cpu.misuses) == (6, [])
    bench.cpu["D.n"] = 1
    bench.call("D")
    assert bench.cpu.stopped
    bench.call("D")
    assert bench.cpu["D.n"] == 2
    bench.cpu.restart("cold")
    bench.call("D")
    assert bench.cpu["D.n"] == 2


def test_type_of_a_data_block():
    """TypeOfDB tells the FB of an instance; a data block that is none, or that does not exist, has no type."""
    also = 'FUNCTION_BLOCK "Axis"\nVAR\nx : Int;\nEND_VAR\nBEGIN\nEND_FUNCTION_BLOCK\n'
    also += 'DATA_BLOCK "A"\n"Axis"\nBEGIN\nEND_DATA_BLOCK\n'
    also += 'DATA_BLOCK "G"\nSTRUCT\ny : Int;\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n'
    ask = 'IF TypeOfDB(#d) = "Axis" THEN #n := #n * 10 + 1; ELSE #n := #n * 10; END_IF;'
    bench = bench_of("d : DB_ANY; n : Int;", f'#d := "A"; {ask} #d := "G"; {ask} #d := 0; {ask}', also=also)
    bench.call("D")
    assert bench.cpu["D.n"] == 100


def test_a_label_that_is_called_label():
    """The help of GET_ERROR jumps to ``LABEL:``; the word begins declarations elsewhere."""
    bench = bench_of("n : Int;", "#n := 0;\nLABEL: #n := #n + 1;\nIF #n < 3 THEN GOTO LABEL; END_IF;")
    bench.call("D")
    assert bench.cpu["D.n"] == 3


def test_enable_input_of_a_call():
    """A call with EN FALSE does nothing: of a timer, an FB, an FC and an instruction."""
    also = (
        'FUNCTION_BLOCK "Count"\nVAR_OUTPUT\nn : Int;\nEND_VAR\nBEGIN\n#n := #n + 1;\nEND_FUNCTION_BLOCK\n'
        'FUNCTION "Seven" : Void\nVAR_OUTPUT\ny : Int;\nEND_VAR\nBEGIN\n#y := 7;\nEND_FUNCTION\n'
    )
    bench = bench_of(
        'c : "Count"; n : Int; y : Int; z : UInt; on : Bool; t : TON_TIME; a : Array[0..3] of Char; m : Int;',
        '#c(EN := #on, n => #n); "Seven"(EN := #on, y => #y); #t(EN := #on, IN := TRUE, PT := T#1s);\n'
        "Strg_TO_Chars(EN := #on, Strg := 'ab', pChars := 0, Cnt => #z, Chars := #a); #m := #y + 1;",
        also=also,
    )
    bench.call("D")
    assert [bench.cpu[f"D.{name}"] for name in ("n", "y", "z", "t.IN", "m")] == [0, 0, 0, False, 1]
    bench.cpu["D.on"] = True
    bench.call("D")
    assert [bench.cpu[f"D.{name}"] for name in ("n", "y", "z", "t.IN", "m")] == [1, 7, 2, True, 8]
