"""The estimate of work memory: every rule of plcgen/s7/memory/README.md by a sum that is written down here.

Lengths of single instructions: a load or store of a variable 4, a 16-bit constant 4, a 32-bit constant 6, an operation
2, a jump 4. The machine code in comments is what compiled SCL blocks of the standard library hold at such places.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from plcgen.s7.memory.estimate import Estimate, estimate
from plcgen.s7.read.blocks import read_texts
from plcgen.s7.scl.dialect import Dialect

HEADER = 36
OK_FLAG = 18  # SET 2, SAVE 2, = L 4 in front; CLR 2, A L 4, SAVE 2, BE 2 behind

PROGRAM = """
TYPE "pair" STRUCT a : INT; b : REAL; END_STRUCT END_TYPE
DATA_BLOCK DB200 STRUCT x : INT; y : INT; END_STRUCT BEGIN END_DATA_BLOCK
DATA_BLOCK "shared" STRUCT x : INT; y : INT; p : "pair"; list : ARRAY[0..9] OF INT; END_STRUCT BEGIN END_DATA_BLOCK
FUNCTION_BLOCK "inner"
VAR_INPUT go : BOOL; n : INT; where : ANY; END_VAR
VAR_OUTPUT ready : BOOL; END_VAR
VAR_IN_OUT data : "pair"; count : INT; END_VAR
BEGIN END_FUNCTION_BLOCK
DATA_BLOCK "innerDb" "inner" BEGIN END_DATA_BLOCK
FUNCTION "twice" : INT
VAR_INPUT v : INT; w : "pair"; END_VAR
BEGIN twice := v + v; END_FUNCTION
FUNCTION_BLOCK "block"
VAR_INPUT in1 : INT; on : BOOL; off : BOOL; third : BOOL; END_VAR
VAR_IN_OUT io : "pair"; END_VAR
VAR i : INT; k : INT; d : DINT; r : REAL; s : REAL; bits : BYTE; q : BOOL; st : "pair"; w : WORD; dw : DWORD;
  list : ARRAY[1..10] OF INT; zero : ARRAY[0..10] OF INT; table : ARRAY[1..3, 0..4] OF INT;
  pairs : ARRAY[1..4] OF "pair"; one : "inner"; dt : DATE_AND_TIME; END_VAR
VAR_TEMP t : INT; any1 : ANY; local : ARRAY[0..7] OF INT; END_VAR
CONST LIMIT_OF_I := 100; END_CONST
BEGIN
%s
END_FUNCTION_BLOCK
"""


def program(statements: str) -> Estimate:
    """The program with these statements in the FB "block"."""
    found = estimate(read_texts([("program.scl", PROGRAM % statements)]), Dialect.STEP7_V5)
    assert not found.diagnostics, [d.message for d in found.diagnostics]
    return found


def code(statements: str) -> int:
    """Bytes of these statements alone."""
    block = next(block for block in program(statements).blocks if block.name == "block")
    return block.code - HEADER - OK_FLAG


@pytest.mark.parametrize(
    ("statement", "parts"),
    [
        ("i := k;", (4, 4)),  # L DIW[AR2]; T DIW[AR2]
        ("t := in1;", (4, 4)),  # L DIW[AR2]; T LW
        ("i := 5;", (4, 4)),  # L 5; T
        ("i := LIMIT_OF_I;", (4, 4)),  # a constant of CONST is a constant
        ("d := 5;", (6, 4)),  # L L#5 for a DINT; T
        ("r := 2.5;", (6, 4)),  # L 2.5; T
        ("bits := B#16#7F;", (2, 4)),  # L B#16#7F has 2 bytes; T
        ("q := TRUE;", (2, 4)),  # SET; =
        ("q := on;", (2, 4, 4)),  # CLR; A; =
        ("i := MW10;", (2, 4)),  # L MW10 has 2 bytes below MW256; T
        ("i := MW300;", (4, 4)),
        ("M10.1 := TRUE;", (2, 2)),  # SET; = M10.1 has 2 bytes
        ('i := "shared".x;', (4, 4, 4)),  # OPN DB; L DBW; T
        ("i := DB200.DBW0;", (2, 4, 4)),  # OPN DB200 has 2 bytes up to 255
        ('i := "shared".x + "shared".y;', (4, 4, 4, 2, 4)),  # the data block is opened once: OPN, L, L, +I, T
        ("st := io;", (84,)),  # SFC 20 with two pointers of type ANY
        ("dt := dt;", (4, 4, 4, 4)),  # two loads, two stores
        ("i := io.a;", (44, 4)),  # structured IN_OUT of an FB
        ("io.a := 1;", (4, 44)),
    ],
)
def test_operands_and_assignments(statement: str, parts: tuple[int, ...]) -> None:
    """Loads and stores have the lengths of their instructions."""
    assert code(statement) == sum(parts)


@pytest.mark.parametrize(
    ("statement", "parts"),
    [
        ("i := i + 1;", (4, 4, 2, 4)),  # L; L 1; +I; T
        ("r := r * s + 2.0;", (4, 4, 2, 6, 2, 4)),  # L; L; *R; L 2.0; +R; T
        ("r := 2.0 / (r + s);", (6, 4 + 4 + 2, 2, 2, 4)),  # r + s first; L 2.0; TAK; /R; T
        ("r := (r + s) / (r - s);", (10, 10, 10, 2, 4)),  # the left one is kept: T L, L L, TAK
        ("d := d + i;", (4, 4, 2, 2, 4)),  # ITD
        ("d := d + 1;", (4, 6, 2, 4)),  # L L#1
        ("r := -r;", (4, 2, 4)),  # NEGR
        ("d := INT_TO_DINT(i);", (4, 2, 4)),  # ITD
        ("r := DINT_TO_REAL(d);", (4, 2, 4)),  # DTR
        ("r := INT_TO_REAL(i);", (4, 4, 4)),  # ITD; DTR
        ("d := ROUND(r);", (4, 2, 4)),  # RND
        ("w := INT_TO_WORD(i);", (4, 4)),  # nothing
        ("w := BYTE_TO_WORD(bits);", (4, 6, 4)),  # AD DW#16#FF
        ("w := DWORD_TO_WORD(dw);", (4, 8, 4)),  # L DW#16#FFFF; AD
        ("dw := SHR(IN := dw, N := 8);", (4, 2, 4)),  # SRD 8
        ("dw := SHR(IN := dw, N := i);", (4, 4 + 34, 4)),
        ("r := ABS(r);", (4, 2, 4)),
        ("q := i = k;", (4, 4, 2, 4)),  # L; L; ==I; =
        ("q := on AND off;", (2, 4, 4, 4)),  # CLR; A; A; =
        ("q := on AND NOT off;", (2, 4, 4, 4)),  # CLR; A; AN; =
        ("q := on OR off;", (2, 4, 4, 8, 4)),  # CLR; A; = L; A; O L; =
        ("q := i > 1 AND k < 5;", (10, 10, 8, 4)),  # L,L,>I; L,L, = L, <I, A L; =
        ("q := NOT on;", (2, 4, 2, 4)),  # CLR; A; NOT; =
    ],
)
def test_operators_and_conversions(statement: str, parts: tuple[int, ...]) -> None:
    """An operation costs its operands, its instruction and what keeps the other operand meanwhile."""
    assert code(statement) == sum(parts)


@pytest.mark.parametrize(
    ("statement", "parts"),
    [
        ("i := list[3];", (4, 4)),  # the compiler knows the address
        # L i; ITD; L L#1; -D; L L#16; *D; TAR2; +D; LAR1; L W[AR1, start of the array]; T
        ("i := list[i];", (4, 2, 8, 8, 4, 2, 4, 4)),
        ("i := zero[i];", (4, 2, 8, 4, 2, 4, 4)),
        ("i := local[i];", (4, 2, 8, 2, 4, 4)),  # temporary data have no AR2
        ("i := local[t + 1];", (10, 2, 8, 2, 4, 4)),
        ("zero[i] := k;", (4, 4, 2, 8, 4, 2, 4, 14)),  # T L, TAK, L L, TAK, TAK around it
        ("i := table[i, k];", (4, 2, 8, 8, 4, 2, 8, 2, 4, 2, 4, 4)),
        ('i := "shared".list[i];', (4, 4, 2, 8, 2, 4, 4)),  # OPN
        ("i := pairs[i].a;", (4, 2, 8, 8, 8, 4, 2, 4, 4)),  # L L#offset; +D for the member of the element
        ("w := WORD_TO_BLOCK_DB(w).DW[i];", (4, 4, 26, 4)),
    ],
)
def test_indices(statement: str, parts: tuple[int, ...]) -> None:
    """An index that is not constant is computed in the accumulator and goes through AR1."""
    assert code(statement) == sum(parts)


BODY = "i := k;"  # 8


@pytest.mark.parametrize(
    ("statement", "parts"),
    [
        (f"IF on THEN {BODY} END_IF;", (2, 4, 4, 8)),  # CLR; A; JCN; body
        (f"IF i = 1 THEN {BODY} ELSE {BODY} END_IF;", (10, 4, 8, 4, 8)),  # compare; JCN; body; JU; body
        (f"IF on THEN {BODY} ELSIF off THEN {BODY} END_IF;", (6, 4, 8, 4, 6, 4, 8)),
        # selector: L, T L; label: L, TAK, ==I, JC = 12; range: L, TAK, <=I, L, TAK, = L, >=I, A L, JC = 28; JU, JU
        (f"CASE i OF 1: {BODY} 2..5: {BODY} END_CASE;", (4, 4, 12, 8, 8, 28, 8, 8)),
        (f"CASE i OF 1, 2: {BODY} ELSE {BODY} END_CASE;", (8, 24, 8, 8, 8)),
        # L 1, T; round: L, L 9, <=I, JCN, and L, L 1, +I, T, JU: 28 without the last value
        (f"FOR t := 1 TO 9 DO {BODY} END_FOR;", (4, 4, 4, 28, 8)),
        (f"FOR t := 1 TO k DO {BODY} END_FOR;", (4, 4, 4 + 4 + 4, 28, 8)),  # the last value is kept
        (f"WHILE i < 5 DO {BODY} END_WHILE;", (10, 4, 8, 4)),
        (f"REPEAT {BODY} UNTIL i > 5 END_REPEAT;", (8, 10, 4)),
        ("RETURN;", (4,)),
        ('IF "shared".x = 1 THEN "shared".y := 2; END_IF;', (4, 4, 4, 2, 4, 4, 4, 4)),  # opened again behind the jump
    ],
)
def test_control(statement: str, parts: tuple[int, ...]) -> None:
    """Conditions and jumps of the statements that branch."""
    assert code(statement) == sum(parts)


@pytest.mark.parametrize(
    ("statement", "parts"),
    [
        ("d := TIME_TO_DINT(SFC64());", (8, 8, 4, 4, 4)),  # UC, JU; TAR2, LAR2; address of the result; L; T
        (
            'i := "twice"(v := t, w := st);',
            (8, 8, 4, 4 + 0, 4 + 18, 4, 4),
        ),  # a variable of TEMP is handed over as it is
        ('i := "twice"(v := k, w := st);', (8, 8, 4, 4 + 8, 4 + 18, 4, 4)),  # others are copied first
        ("i := SFC20(SRCBLK := any1, DSTBLK := list);", (8, 8, 4, 4 + 0, 4 + 28, 4, 4)),
        ("i := SFC20(SRCBLK := P#DB3.DBX0.0 BYTE 4, DSTBLK := list);", (8, 8, 4, 4 + 28, 4 + 28, 4, 4)),
        ("one(go := TRUE, n := t);", (12, 2 + 4, 4 + 4)),  # +AR2, UC, +AR2
        ("one(go := on, data := st, count := k);", (12, 2 + 4 + 4, 18, 4 + 8)),
        ("one(where := list);", (12, 28)),
        ('"inner"."innerDb"(go := TRUE, n := t);', (26, 2 + 4, 4 + 4)),  # CDB, OPN DI, TAR2, LAR2, UC, LAR2, CDB
        ('"inner"."innerDb"(n := k);', (26, 4 + 4 + 8)),  # the caller's data and back
        ('q := "innerDb".ready;', (4 + 2 + 4, 4)),  # CLR, OPN, A; =
        ("q := one.ready;", (2 + 4, 4)),
    ],
)
def test_calls(statement: str, parts: tuple[int, ...]) -> None:
    """A call costs its frame and the making of its parameters."""
    assert code(statement) == sum(parts)


def test_functions_have_no_registers_to_save() -> None:
    """An FC reads its parameters directly, and a structured one by pointer in 28 bytes."""
    text = """
    TYPE "pair" STRUCT a : INT; b : REAL; END_STRUCT END_TYPE
    FUNCTION "sum" : INT
    VAR_INPUT v : INT; END_VAR
    VAR_IN_OUT p : "pair"; END_VAR
    BEGIN sum := v + p.a; END_FUNCTION
    """
    block = estimate(read_texts([("f.scl", text)]), Dialect.STEP7_V5).blocks[1]
    assert block.code == HEADER + OK_FLAG + 4 + 28 + 2 + 2 + 4  # L v; p.a first, so TAK; +I; T


def test_data_blocks_are_their_values_and_a_header() -> None:
    """Types take nothing; an instance DB takes what its FB declares."""
    sizes = {block.name: block for block in program("").blocks}
    assert sizes["pair"].total == 0
    assert sizes["DB200"].data == HEADER + 4
    assert sizes["shared"].data == HEADER + 2 + 2 + 6 + 20
    # go 2 (even), n 2, ANY 10; ready 2; pointer 6, count 2
    assert sizes["innerDb"].data == HEADER + 14 + 2 + 8


def test_sums_and_counts() -> None:
    """Totals are sums over blocks; lines are those of code blocks, statement lines without comments and blanks."""
    found = program("i := 1;\n\n// a comment\nk := 2;")
    assert found.count("FB") == 2
    assert found.count("DB") == 3
    assert found.count() == 6
    assert found.total == sum(block.code + block.data for block in found.blocks)
    block = next(block for block in found.blocks if block.name == "block")
    assert block.code_lines == 2
    assert block.lines == 14
    assert found.summary()["total"] == found.total


def test_a_long_sum_is_as_long_as_its_terms() -> None:
    """1,000 operators, which is what the parser takes, and nested negations take linear time and no deep recursion."""
    assert code("i := " + " + ".join(["k"] * 1000) + ";") == 4 + 999 * (4 + 2) + 4
    assert code("q := " + "on AND NOT (" * 40 + "off" + ")" * 40 + ";") > 40 * (4 + 8 + 2)


def test_a_block_that_is_too_deep_is_said_and_not_counted() -> None:
    """990 members behind each other are a diagnostic; the rest of the program is counted."""
    found = estimate(read_texts([("p.scl", PROGRAM % ("i := st" + ".a" * 990 + ";"))]), Dialect.STEP7_V5)
    assert [d.message for d in found.diagnostics] == ["block is nested too deeply"]
    assert found.data == program("").data


def test_other_families_have_only_data_blocks() -> None:
    """The rules were made for the S7-300/400; elsewhere there is no figure for code, and 2 + 4 bytes of data are 6."""
    text = 'FUNCTION_BLOCK "a"\nVAR i : Int; END_VAR\nBEGIN\n#i := 1;\nEND_FUNCTION_BLOCK\n'
    text += 'DATA_BLOCK "b"\nVAR i : Int; d : DInt; END_VAR\nBEGIN\nEND_DATA_BLOCK\n'
    found = estimate(read_texts([("a.scl", text)]), Dialect.TIA_1200_1500)
    assert (found.code, found.total, found.data, found.lines) == (None, None, 6, 5)
    old = estimate(read_texts([("a.scl", text)]), Dialect.TIA_300_400)
    assert (old.code, old.data) == (HEADER + 18 + 8, HEADER + 6)  # L 1; T


def test_files_on_disk_are_read(tmp_path: Path) -> None:
    """The estimate of a folder is that of its files; what cannot be laid out is said and not counted."""
    (tmp_path / "a.scl").write_text(
        "DATA_BLOCK DB1 STRUCT x : INT; END_STRUCT BEGIN END_DATA_BLOCK\n", encoding="utf-8"
    )
    (tmp_path / "b.scl").write_text('DATA_BLOCK DB2 "nobody" BEGIN END_DATA_BLOCK\n', encoding="utf-8")
    found = estimate(tmp_path, Dialect.STEP7_V5)
    assert found.data == HEADER + 2
    assert [d.code for d in found.diagnostics] == ["PG806"]
