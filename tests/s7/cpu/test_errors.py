"""What the check finds in wrong programs, with its place; hostile input ends in diagnostics too."""

import pytest

from plcgen.base.diagnostics import DiagnosticError, Severity
from plcgen.s7.cpu.cpu import Cpu
from plcgen.s7.cpu.program import Program
from plcgen.s7.cpu.testing import load_scl
from plcgen.s7.scl.dialect import Dialect
from tests.s7.cpu.support import cases, load, source
from tests.work import calls_of

CASES = cases("errors")
RIGHT = cases("right")
T15 = Dialect.TIA_1200_1500


@pytest.mark.parametrize("case", CASES, ids=[case["name"] for case in CASES])
def test_errors(case):
    """Each error is reported once, with its code and its place."""
    text = source(case)
    first = text[: text.rindex("BEGIN\n" + case["code"])].count("\n") + 2
    spans = [(d.span.line - first, d.span.column, d.code) for d in load(case).diagnostics]
    assert case["errors"] == [f"{line}:{column} {code}" for line, column, code in spans]


@pytest.mark.parametrize("case", RIGHT, ids=[case["name"] for case in RIGHT])
def test_idioms_of_public_sources_raise_no_alarm(case):
    """What compiles in STEP 7 is not called wrong; at most the soft CPU says that it does not execute it."""
    errors = {d.code for d in load(case).diagnostics if d.severity is Severity.ERROR or d.code == "PG827"}
    assert errors == ({"PG827"} if "not_executed" in case else set())


def test_help_names_the_near_name():
    """A slip of the pen gets a suggestion."""
    (found,) = load({"vars": "counter : Int;", "code": "#countr := 1;"}).diagnostics
    assert "counter" in found.help


def codes(text, dialect=T15):
    """Codes of a hostile source, found with less work than a plain function block of 10,000 lines takes."""
    program, work = calls_of(lambda: Program.load([("hostile.scl", text)], dialect))
    assert work < 2_500_000
    return {diagnostic.code for diagnostic in program.diagnostics}


def test_nested_parentheses():
    """10,000 nested parentheses are refused."""
    assert codes(source({"vars": "a : Int;", "code": "#a := " + "(" * 10_000 + "1" + ")" * 10_000 + ";"})) == {"PG802"}


def test_long_chain():
    """The longest chain the parser lets through compiles and runs."""
    case = {"vars": "a : Int; b : Bool;", "code": "#a := 1" + " + 1" * 250 + ";\n#b := TRUE" + " AND TRUE" * 250 + ";"}
    case["code"] += "\n#a := #a" + " + #a" * 250 + ";"
    cpu = Cpu(load(case))
    cpu.call("Test_DB")
    assert cpu["Test_DB.a"] == (251 * 251 + 32768) % 65536 - 32768
    assert cpu["Test_DB.b"] is True


@pytest.mark.parametrize(
    ("opening", "closing"),
    [("IF TRUE THEN ", "END_IF;"), ("WHILE TRUE DO ", "END_WHILE;"), ("CASE #a OF 1: ", "END_CASE;")],
)
def test_nested_statements(opening, closing):
    """95 statements inside each other are compiled or refused, never a crash."""
    code = opening * 95 + "#a := 1;" + closing * 95
    assert codes(source({"vars": "a : Int;", "code": code})) <= {"PG802"}


@pytest.mark.slow
def test_long_else_chain():
    """2,000 ELSIF are compiled or refused."""
    code = "IF #a = 0 THEN ;" + "".join(f"ELSIF #a = {n} THEN #a := 1;" for n in range(1, 2000)) + "END_IF;"
    assert codes(source({"vars": "a : Int;", "code": code})) <= {"PG802"}


@pytest.mark.parametrize("code", ["WHILE TRUE DO ; END_WHILE;", "REPEAT ; UNTIL FALSE END_REPEAT;", "a: GOTO a;"])
def test_endless_loops(code):
    """An endless loop ends with the watchdog, at its line."""
    cpu = Cpu(load({"code": code}), loop_limit=1000)
    cpu.call("Test_DB")
    assert [misuse.code for misuse in cpu.misuses] == ["PG835"]
    assert cpu.misuses[0].line == 4
    assert cpu.faulted


def test_watchdog_counts_across_calls():
    """Loops of called blocks count too."""
    also = 'FUNCTION "Wait" : Void\nVAR_TEMP i : Int; END_VAR\nBEGIN\nFOR #i := 1 TO 100 DO ; END_FOR;\nEND_FUNCTION\n'
    case = {"also": also, "vars": "i : Int; n : Int;", "code": 'FOR #i := 1 TO 100 DO "Wait"(); #n := #i; END_FOR;'}
    cpu = Cpu(load(case), loop_limit=1000)
    cpu.call("Test_DB")
    assert [misuse.code for misuse in cpu.misuses] == ["PG835"]
    assert cpu["Test_DB.n"] == 9


def test_watchdog_goes_on_behind_calls():
    """An endless loop of calls of a block without loops ends too."""
    also = 'FUNCTION "Empty" : Void\nBEGIN\n;\nEND_FUNCTION\n'
    cpu = Cpu(load({"also": also, "code": 'WHILE TRUE DO "Empty"(); END_WHILE;'}), loop_limit=1000)
    cpu.call("Test_DB")
    assert [misuse.code for misuse in cpu.misuses] == ["PG835"]


RECURSION = """FUNCTION "A" : Void
BEGIN
"B"();
END_FUNCTION
FUNCTION "B" : Void
BEGIN
"C"();
END_FUNCTION
FUNCTION "C" : Void
BEGIN
"A"();
END_FUNCTION
"""


def test_recursion():
    """Blocks that call each other in a circle are refused, with the circle."""
    program = Program.load([("r.scl", RECURSION)], T15)
    assert [(d.code, d.span.line) for d in program.diagnostics] == [("PG826", 11)]
    assert "A -> B -> C -> A" in program.diagnostics[0].message


CYCLE = """TYPE "T"
STRUCT a : "U"; END_STRUCT;
END_TYPE
TYPE "U"
STRUCT b : "T"; END_STRUCT;
END_TYPE
DATA_BLOCK "D"
"T"
BEGIN
END_DATA_BLOCK
"""


def test_cyclic_types():
    """A type that contains itself is refused, once."""
    found = Program.load([("c.scl", CYCLE)], T15).diagnostics
    assert [(d.code, d.span.line) for d in found if d.code == "PG807"] == [("PG807", 5)]


def test_missing_type_of_an_instance():
    """An instance of a block that is not there is refused."""
    assert "PG806" in codes('DATA_BLOCK "D"\n"Nobody"\nBEGIN\nEND_DATA_BLOCK\n')


def test_large_array():
    """Memory is bounded."""
    assert "PG808" in codes(
        'DATA_BLOCK "D"\nSTRUCT a : Array[0..2000000000] of Real; END_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n'
    )


@pytest.mark.parametrize("text", ["", "\n", "garbage\n", "FUNCTION_BLOCK\n", '"\n', "BEGIN END\n", "\0\n"])
def test_no_program(text):
    """Text that is no program is a diagnostic or nothing, and no traceback."""
    assert Program.load([("x.scl", text)], T15).main() is None


def test_missing_file(tmp_path):
    """A file that is not there is a diagnostic."""
    program = Program.load([tmp_path / "none.scl"], T15)
    assert [d.code for d in program.diagnostics] == ["PG804"]


def test_wrong_program_does_not_run():
    """A program with errors gives no CPU."""
    with pytest.raises(DiagnosticError):
        load_scl(source({"code": "#x := 1;"}))


def test_declared_twice():
    """Two blocks of one name are refused."""
    assert "PG805" in codes(source({"code": ";"}) + source({"code": ";"}))


def test_start_value_out_of_range():
    """A start value that does not fit is refused at its place."""
    program = load({"vars": "a : Int := 40000;", "code": ";"})
    assert "PG824" in {d.code for d in program.diagnostics}


def test_dialect():
    """What the target does not allow is reported with the rest."""
    text = 'FUNCTION_BLOCK "A"\nVAR a : INT; END_VAR\nBEGIN\na := a DIV 2;\nEND_FUNCTION_BLOCK\n'
    assert codes(text, Dialect.STEP7_V5) == set()
    assert codes(text, Dialect.TIA_300_400) == {"PG803"}


@pytest.mark.parametrize(
    ("dialect", "types", "code", "noted"),
    [
        ("T15", "Word DInt", "#b := #a;", True),
        ("T15", "Word DInt", "#b := #b + #a;", True),
        ("T15", "Real Int", "#b := #a;", True),
        ("T15", "UInt Int", "#b := #b + #a;", True),
        ("T15", "Time DInt", "#b := #a;", True),
        ("T15", "Word Real", "#b := #a;", False),
        ("T15", "Bool Int", "#b := #a;", False),
        ("T3", "Word Int", "#b := #a;", True),
        ("T3", "Real Int", "#b := #a;", False),
        ("T3", "DInt Int", "#b := #a;", False),
        ("V5", "WORD INT", "b := a;", False),
    ],
)
def test_a_conversion_that_only_the_iec_check_forbids_is_refused_with_a_word_about_it(dialect, types, code, noted):
    """The IEC check is a property of a block that its source does not carry; without it the CPU converts."""
    first, second = types.split()
    case = {"dialect": dialect, "vars": f"a : {first}; b : {second};", "code": code}
    (found,) = load(case | {"iec_check": "on"}).diagnostics
    assert found.code == "PG821"
    assert ("IEC check" in found.help) is noted
    assert found.help.count("IEC check") <= 1
    assert load(case | {"iec_check": "off"}).ok is noted
