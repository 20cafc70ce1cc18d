"""Variables of every type at every place of the language: the check ends with diagnostics, whatever it finds."""

import pytest

from plcgen.s7.cpu.program import Program
from plcgen.s7.types.data_types import ELEMENTARY, HARDWARE
from tests.s7.cpu.support import DIALECTS, load

TYPES = [
    *sorted(set(ELEMENTARY) - HARDWARE), "HW_IO", "DB_ANY", "String", "WString", "String[5]", "Variant", "REF_TO Int",
    "ErrorStruct", "TON_TIME", "R_TRIG", '"U"', '"FB"', '"Gone"', "Array[0..3] of Int", "Array[*] of Int",
    "Array[0..3] of Variant", "Struct x : Int; END_STRUCT",
]  # fmt: skip
BESIDE = """TYPE "U"
STRUCT
x : Int;
END_STRUCT;
END_TYPE
FUNCTION_BLOCK "FB"
VAR_INPUT
i : Int;
END_VAR
BEGIN
;
END_FUNCTION_BLOCK
"""
STATEMENTS = """#a := #b; #b := #a; #a := #a; #a := #b := #a; #a ?= #b; #a += #b; #a := -#b; #a := NOT #b;
IF #a = #b OR #a < #b OR #a <> NULL THEN ; END_IF; IF #a THEN ; END_IF; WHILE #b DO EXIT; END_WHILE;
#a := #a + #b; #a := #b * #a; #a := #a / #b; #a := #a MOD #b; #a := #a ** #b; #a := #a AND #b;
FOR #a := #b TO #b BY #b DO #a := #b; END_FOR; CASE #a OF #b: ; 1..3: ; 'a': ; ELSE #b := #a; END_CASE;
#n[#a] := 1; #b := #a[1]; #a[1] := #b; #a.x := #b.x; #a.%X0 := #b.%X1; #a.%B0 := 1;
#a(i := 1); #a(IN := #b); #c(p := #a, q => #b, io := #a); #a := "F"(p := #a, q => #b, io := #b);
#a := 1; #a := 1.5; #a := 'a'; #a := TRUE; #a := NULL; #a := P#M0.0 BYTE 2; #a := T#1s; #a := 16#FF; #a := REF(#b);
#a := ABS(#b); #a := SQRT(#b); #a := SHL(IN := #b, N := #a); #a := ROUND(#b); #a := SWAP(#b); #a := LEN(#b);
#a := CONCAT(IN1 := #b, IN2 := #a); #a := SEL(G := TRUE, IN0 := #a, IN1 := #b); #a := MAX(IN1 := #a, IN2 := #b);
#a := LIMIT(MN := #a, IN := #b, MX := #a); #a := MUX(K := #a, IN0 := #b, IN1 := #a); #a := RD_SYS_T(#b);
#a := BLKMOV(SRCBLK := #a, DSTBLK => #b); FILL_BLK(IN := #a, COUNT := 1, OUT => #b);
#a := READ_BIG(SRC_ARRAY := #a, DEST_VARIABLE => #b, POS := #a);
#a := PEEK(area := #b, dbNumber := #b, byteOffset := #a);
#a := WRITE_BIG(SRC_VARIABLE := #b, DEST_ARRAY => #a, POS := #b);
POKE(area := 1, dbNumber := #a, byteOffset := 0, value := #b);
VariantGet(SRC := #a, DST => #b); #a := CountOfElements(#b); IF TypeOf(#a) = TypeOf(#b) THEN ; END_IF;"""


def block(kind, first, second, types):
    """A block with two variables, and called ones that have parameters of their types."""
    a, b = types
    called = f"VAR_INPUT\np : {a};\nEND_VAR\nVAR_OUTPUT\nq : {b};\nEND_VAR\nVAR_IN_OUT\nio : {a};\nEND_VAR\nBEGIN\n;\n"
    inner = 'VAR\nc : "C";\nEND_VAR\n' if kind == "FUNCTION_BLOCK" else ""
    own = (
        f"{first}\na : {a};\nEND_VAR\n{second}\nb : {b};\nEND_VAR\nVAR_TEMP\nn : Array[0..3] of Int;\nEND_VAR\n{inner}"
    )
    head = f'{kind} "T"' + (" : Void" if kind == "FUNCTION" else "")
    beside = f'FUNCTION_BLOCK "C"\n{called}END_FUNCTION_BLOCK\nFUNCTION "F" : {b}\n{called}END_FUNCTION\n'
    return f"{BESIDE}{beside}{head}\n{own}BEGIN\n{STATEMENTS}\nEND_{kind}\n"


@pytest.mark.parametrize("dialect", DIALECTS)
@pytest.mark.parametrize("kind", ["FUNCTION_BLOCK", "FUNCTION"])
def test_no_type_breaks_the_check(kind, dialect):
    """Each type beside itself, INT and VARIANT, in two sections."""
    for number, type_ in enumerate(TYPES):
        first, second = [("VAR_TEMP", "VAR_INPUT"), ("VAR_IN_OUT", "VAR_TEMP")][number % 2]
        for other in (type_, "Int", "Variant"):
            text = block(kind, first, second, (type_, other))
            assert Program.load([("t.scl", text)], DIALECTS[dialect]).diagnostics


@pytest.mark.parametrize("section", ["temp", "inout"])
def test_a_variant_takes_no_variable(section):
    """A VARIANT points to what it is given in a call (help, "Initializing VARIANT"); of pointers nothing is said."""
    case = {section: "v : Variant;", "vars": "r : Real;", "code": "#v := NULL;\n#v := P#DB1.DBX0.0 BYTE 20;\n#v := #v;"}
    assert {d.code for d in load(case).diagnostics} == {"PG827"}
    found = load(case | {"code": "#v := #r;\n#v := 3;"}).diagnostics
    assert [d.code for d in found] == ["PG821", "PG821"]
    assert "parameter" in found[0].help
