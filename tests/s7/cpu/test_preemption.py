"""One OB runs into another: which points there are, and what an interrupt sees and spoils there."""

import itertools

import pytest

from plcgen.s7.cpu.cpu import Cpu
from plcgen.s7.cpu.preemption import Interrupt
from plcgen.s7.cpu.testing import load_scl
from tests.s7.cpu.support import cases, load

COUNTER = """DATA_BLOCK "Shared"
{ S7_Optimized_Access := 'FALSE' }
STRUCT n : Int; a : Int; b : Int; r : Int; END_STRUCT;
BEGIN
END_DATA_BLOCK
ORGANIZATION_BLOCK "Main"
BEGIN
%s
END_ORGANIZATION_BLOCK
ORGANIZATION_BLOCK "Fast"
BEGIN
%s
END_ORGANIZATION_BLOCK
ORGANIZATION_BLOCK "Faster"
BEGIN
"Shared".r := "Shared".r + 100;
END_ORGANIZATION_BLOCK
"""


def cpu(main, fast, also="", **options):
    """A CPU with Main and an OB that interrupts it."""
    found = load_scl(also + COUNTER % (main, fast), **options).cpu
    found.restart("cold")
    return found


def outcomes(main, fast, member="n", also=""):
    """Value of a member for every point of Main at which Fast comes."""
    count = len(cpu(main, fast, also).run("Main", interrupt={}).points)
    found = []
    for number in range(count):
        one = cpu(main, fast, also)
        one.run("Main", interrupt={number: "Fast"})
        found.append(one[f"Shared.{member}"])
    return found


def test_between_the_read_and_the_write():
    """Both add 1: 2 in the end, unless Fast comes between the read and the store of Main; then one is lost."""
    add = '"Shared".n := "Shared".n + 1;'
    assert outcomes(add, add) == [2, 1]
    points = cpu(add, add).run("Main", interrupt={}).points
    assert [(point.number, point.depth, point.kind, point.line) for point in points] == [
        (0, 0, "statement", 8), (1, 0, "store", 8),
    ]  # fmt: skip


def test_between_two_reads():
    """Two variables in one expression: the second may be from after the interrupt, the first from before."""
    assert outcomes('"Shared".r := "Shared".a - "Shared".b;', '"Shared".a := 5; "Shared".b := 5;', "r") == [0, -5, 0]


def test_by_number():
    """PEEK and POKE have the same points as names have."""
    also = """DATA_BLOCK "Raw"
{ S7_Optimized_Access := 'FALSE' }
STRUCT a : Byte; b : Byte; END_STRUCT;
BEGIN
END_DATA_BLOCK
"""
    number = 60000  # the first block without a number of its own
    peek = "PEEK(area := 16#84, dbNumber := {}, byteOffset := {})"
    main = f'"Shared".r := BYTE_TO_INT({peek.format(number, 0)}) - BYTE_TO_INT({peek.format(number, 1)});'
    assert outcomes(main, '"Raw".a := 5; "Raw".b := 5;', "r", also) == [0, -5, 0]
    main = f'POKE(area := 16#84, dbNumber := {number}, byteOffset := 0, value := INT_TO_BYTE("Shared".n));'
    assert outcomes(main + '"Shared".r := BYTE_TO_INT("Raw".a);', '"Shared".n := 3;', "r", also)[:3] == [3, 0, 0]


def test_constant_inputs():
    """Constants go to the instance of another block one after the other; each can be seen alone."""
    main = '"Pair_DB"(x := 1, y := 1);'
    fast = '"Shared".r := "Pair_DB".x * 10 + "Pair_DB".y;'
    assert outcomes(main, fast, "r", PAIR) == [0, 10]


def test_conditions():
    """Between a condition and what it guards; between IF and ELSIF; before the condition of each pass of a WHILE."""
    main = 'IF "Shared".n = 0 THEN\n"Shared".r := 1;\nELSIF "Shared".n = 7 THEN\n"Shared".r := 2;\nEND_IF;'
    assert outcomes(main, '"Shared".n := 7;', "r") == [2, 1]
    kinds = [point.kind for point in cpu(main, '"Shared".n := 7;').run("Main", interrupt={0: "Fast"}).points]
    assert kinds == ["statement", "condition", "statement"]
    loop = 'WHILE "Shared".n < 2 DO\n"Shared".n := "Shared".n + 1;\nEND_WHILE;'
    kinds = [point.kind for point in cpu(loop, ";").run("Main", interrupt={}).points]
    assert kinds == ["statement", *["condition", "statement", "store"] * 2, "condition"]


PAIR = """FUNCTION_BLOCK "Pair"
{ S7_Optimized_Access := 'FALSE' }
VAR_INPUT
x : Int; y : Int;
END_VAR
BEGIN
;
END_FUNCTION_BLOCK
DATA_BLOCK "Pair_DB"
{ S7_Optimized_Access := 'FALSE' }
"Pair"
BEGIN
END_DATA_BLOCK
"""
TWICE = """FUNCTION_BLOCK "Double"
{ S7_Optimized_Access := 'FALSE' }
VAR_INPUT
x : Int;
END_VAR
VAR_OUTPUT
y : Int;
END_VAR
BEGIN
#y := #x * 2;
END_FUNCTION_BLOCK
DATA_BLOCK "Double_DB"
{ S7_Optimized_Access := 'FALSE' }
"Double"
BEGIN
END_DATA_BLOCK
"""


def test_calls():
    """Fast doubles n: it is in time before the input is copied, too late behind; the output comes last."""
    main = '"Double_DB"(x := "Shared".n + 1, y => "Shared".r);'
    points = cpu(main, ";", TWICE).run("Main", interrupt={}).points
    assert [point.kind for point in points] == ["statement", "store", "statement", "store", "output", "store"]
    fast = '"Shared".n := 20;'
    assert outcomes(main, fast, "r", TWICE) == [42, 2, 2, 2, 2, 2]
    assert outcomes(main, '"Double_DB".y := 7;', "r", TWICE) == [2, 2, 2, 2, 7, 2]


def test_copies():
    """A structure is copied in two parts: an interrupt leaves the old and the new half side by side."""
    also = """TYPE "Pair"
STRUCT a : DInt; b : DInt; END_STRUCT;
END_TYPE
DATA_BLOCK "From"
{ S7_Optimized_Access := 'FALSE' }
STRUCT p : "Pair"; q : "Pair"; END_STRUCT;
BEGIN
END_DATA_BLOCK
"""
    main = '"From".q := "From".p; "Shared".r := DINT_TO_INT("From".q.a * 10 + "From".q.b);'
    fast = '"From".p.a := 1; "From".p.b := 1;'
    assert outcomes(main, fast, "r", also)[:3] == [11, 1, 0]


def test_nested():
    """Faster comes into Fast, which came into Main: 1 + 10 + 100, and each may lose what the others add."""
    main, fast = '"Shared".r := "Shared".r + 1;', '"Shared".r := "Shared".r + 10;'
    found = {}
    for outer, inner in itertools.product(range(2), repeat=2):
        one = cpu(main, fast)
        one.run("Main", interrupt={outer: Interrupt("Fast", {inner: "Faster"})})
        found[outer, inner] = one["Shared.r"]
    # Main stores what it read before: 1 alone if Fast came between; Fast stores 10 over the 100 likewise
    assert found == {(0, 0): 111, (0, 1): 11, (1, 0): 1, (1, 1): 1}


def test_a_function_as_plan():
    """A function is asked at every point of every depth."""
    one = cpu('"Shared".r := "Shared".r + 1;', '"Shared".r := "Shared".r + 10;')
    seen = []

    def plan(point):
        seen.append((point.depth, point.number, point.kind))
        return {(0, 1): "Fast", (1, 0): "Faster"}.get((point.depth, point.number))

    run = one.run("Main", interrupt=plan)
    assert seen == [
        (0, 0, "statement"), (0, 1, "store"), (1, 0, "statement"), (2, 0, "statement"), (2, 1, "store"),
        (1, 1, "store"),
    ]  # fmt: skip
    assert [(point.depth, point.number) for point in run.interrupts] == [(0, 1)]
    assert run.statements == 1


@pytest.mark.parametrize("dialect", ["v5", "tia-300", "tia-1500"])
def test_delayed_interrupts(dialect):
    """DIS_AIRT counts its calls; what came waits until EN_AIRT has been called as often (help of DIS_AIRT, EN_AIRT)."""
    main = """"Shared".a := DIS_AIRT();
"Shared".b := DIS_AIRT();
"Shared".n := "Shared".n + 1;
"Shared".b := "Shared".b * 10 + EN_AIRT();
"Shared".a := "Shared".a * 10 + EN_AIRT();
"Shared".n := "Shared".n * 2;"""
    add = '"Shared".n := "Shared".n + 1;'
    source = COUNTER % (main, add)
    source = source if dialect != "v5" else source.replace("{ S7_Optimized_Access := 'FALSE' }\n", "")
    points = load_scl(source, dialect=dialect).cpu.run("Main", interrupt={}).points
    found = set()
    for point in points:
        one = load_scl(source, dialect=dialect).cpu
        one.run("Main", interrupt={point.number: "Fast"})
        assert (one["Shared.a"], one["Shared.b"]) == (10, 21)
        found.add(one["Shared.n"])
    # behind EN_AIRT at the latest: (1 + 1) * 2; before the last store it is lost: 1 * 2; never in the first addition
    assert found == {4, 2}


def test_delays_end_with_the_block():
    """Without EN_AIRT what waits runs behind the end of the OB; EN_AIRT alone gives 8080h."""
    one = cpu('DIS_AIRT();\n"Shared".n := 5;', '"Shared".r := "Shared".n;')
    one.run("Main", interrupt={1: "Fast"})
    assert one["Shared.r"] == 5
    two = cpu('"Shared".n := EN_AIRT();', ";")
    two.run("Main")
    assert two["Shared.n"] == 0x8080 - 0x10000


def test_a_fault_inside():
    """What interrupts may fail; the interrupted OB goes on, the misuse has the place of the one that failed."""
    one = cpu('"Shared".n := 1;\n"Shared".a := 2;', '"Shared".r := 1 / "Shared".b;')
    one.run("Main", interrupt={1: "Fast"})
    assert (one["Shared.n"], one["Shared.a"]) == (1, 2)
    assert [(misuse.code, misuse.line) for misuse in one.misuses] == [("PG836", 13)]


def test_without_a_plan_nothing_is_compiled_for_it():
    """The plain code has no points, and no second form is made."""
    one = cpu('"Shared".n := "Shared".n + 1;', ";")
    assert one.run("Main").points == []
    assert (one["Shared.n"], one.program.interruptible) == (1, [])
    assert all("Z(" not in compiled.source for compiled in one.program.compiled)


def test_coverage_counts_both_forms_together():
    """A statement has one counter for each form of its block, whether it can be interrupted or not."""
    one = cpu('"Shared".n := "Shared".n + 1;', ";", coverage=True)
    probes = len(one.program.probes)
    one.run("Main", interrupt={})
    one.run("Main")
    assert len(one.program.probes) == probes
    assert sum(one.coverage) == 2


def test_statements_of_a_scan():
    """Statements are counted with those of called blocks: the call, the assignment inside."""
    assert cpu('"Double_DB"(x := 1);\nIF FALSE THEN\n;\nEND_IF;', ";", TWICE).run("Main", interrupt={}).statements == 3


def test_unknown_blocks():
    """A block that is not there is named before anything runs."""
    with pytest.raises(KeyError, match="Nobody"):
        cpu(";", ";").run("Nobody", interrupt={})


CASES = cases("values") + cases("memory")


@pytest.mark.parametrize("case", CASES, ids=[case["name"] for case in CASES])
def test_the_form_with_points_computes_the_same(case):
    """Nobody interrupts: everything is as in the plain form, on every target, with multi-instances and views."""
    one = Cpu(load(case))
    for _ in range(case.get("calls", 1)):
        one.run("Test_DB", 10, interrupt={})
    expected, elsewhere = case.get("expect", {}), case.get("elsewhere", {})
    assert expected == {path: one[f'"Test_DB".{path}'] for path in expected}
    assert elsewhere == {path: one[path] for path in elsewhere}
    assert case.get("misuses", []) == [misuse.code for misuse in one.misuses]
