"""When the data of an IEC timer change.

Help of the TIA Portal, TON, TOF, TP and TONR. S7-1200/1500, "Updating the actual values in the instance data": PT is
taken over when IN changes; Q and ET are brought up to date by the call and by every access to them (likewise S7-1200
System Manual, "Timer operations"). S7-300/400: the data are updated by the call only, "not when the Q or ET outputs are
accessed".
"""

import pytest

from plcgen.s7.cpu.cpu import Cpu
from tests.s7.cpu.support import load

CALL = {"T15": "#t{m}(IN := #x, PT := T#30ms)", "T3": "#t(IN := #x, PT := T#30ms)", "V5": "t(IN := x, PT := T#30ms)"}
SKIPPED = [
    ("T15", "TON_TIME", ""), ("T15", "TON", ""), ("T15", "IEC_TIMER", ".TON"), ("T3", "TON", ""), ("V5", "TON", ""),
]  # fmt: skip


def skipped(dialect, kind, method, inputs, wait):
    """Q and ET of a timer that is called for these inputs, 10 ms apart, and then not for some calls."""
    own = "#" if dialect != "V5" else ""
    code = f"IF {own}c THEN {CALL[dialect].format(m=method)}; END_IF; {own}q := {own}t.Q; {own}et := {own}t.ET;"
    case = {"dialect": dialect, "in": "x : Bool; c : Bool;", "out": "q : Bool; et : Time;", "code": code}
    cpu = Cpu(load(case | {"vars": f"t : {kind};"}))
    for value in inputs:
        cpu.call("Test_DB", 10, x=bool(value), c=True)
    found = []
    for _ in range(wait):
        cpu.call("Test_DB", 10, c=False)
        found.append((int(cpu["Test_DB.q"]), cpu["Test_DB.et"]))
    return found


@pytest.mark.parametrize(("dialect", "kind", "method"), SKIPPED)
def test_a_timer_that_is_not_called(dialect, kind, method):
    """A TON of 30 ms started in its last call."""
    modern = [(0, 10), (0, 20), (1, 30), (1, 30)]
    assert skipped(dialect, kind, method, [0, 1], 4) == (modern if dialect == "T15" else [(0, 0)] * 4)


GOING_ON = [
    ("TOF", [1, 0], [(1, 10), (1, 20), (0, 30), (0, 30)]),
    ("TP", [0, 1], [(1, 10), (1, 20), (0, 30), (0, 30)]),  # ET goes back only when IN is FALSE
    ("TP", [0, 1, 0], [(1, 20), (0, 0), (0, 0), (0, 0)]),
    ("TONR", [1], [(0, 10), (0, 20), (1, 30), (1, 30)]),
    ("TON", [1, 0], [(0, 0)] * 4),
]
FORMS = ("_TIME", "", "IEC")


@pytest.mark.parametrize(
    ("kind", "inputs", "expected", "form"),
    [(*row, form) for row in GOING_ON for form in FORMS if (row[0], form) != ("TONR", "IEC")],
)
def test_every_kind_goes_on(kind, inputs, expected, form):
    """Of an S7-1500, by any name of its type; an IEC_TIMER, which is no TONR, is what it was called as."""
    names = ("IEC_TIMER", f".{kind}") if form == "IEC" else (f"{kind}{form}", "")
    assert skipped("T15", *names, inputs, 4) == expected


def test_a_query_before_the_call_sees_that_the_time_is_over():
    """NOT Q at IN: the query ends the time, so the call takes IN away, and Q is never seen behind it (S7-1500)."""
    code = "{c}; {p}q := {p}t.Q; IF {p}q THEN {p}n := {p}n + 1; END_IF;"
    rows = {"T15": "#t(IN := NOT #t.Q, PT := T#30ms)", "V5": "t(IN := NOT t.Q, PT := T#30ms)"}
    found = {}
    for dialect, call in rows.items():
        own = "#" if dialect == "T15" else ""
        case = {"dialect": dialect, "vars": "t : TON; q : Bool; n : Int;", "code": code.format(c=call, p=own)}
        cpu = Cpu(load(case))
        for _ in range(20):
            cpu.call("Test_DB", 10)
        found[dialect] = cpu["Test_DB.n"]
    # V5: starts in call 1, over in call 4, IN falls in call 5, starts in call 6: Q in calls 4, 9, 14, 19
    assert found == {"T15": 0, "V5": 4}


BLOCKS = """DATA_BLOCK "Timer"
{InstructionName := 'IEC_TIMER'; LibVersion := '1.0'; S7_Optimized_Access := 'FALSE'}
IEC_TIMER
BEGIN
END_DATA_BLOCK
DATA_BLOCK "Data"
{ S7_Optimized_Access := 'FALSE' }
STRUCT t : TON_TIME; END_STRUCT;
BEGIN
END_DATA_BLOCK
"""


@pytest.mark.parametrize("access", ["#q[#i].Q", "#s.t.Q", '"Timer".Q', '"Data".t.Q'])
def test_timers_anywhere(access):
    """In an array, a structure, a data block of their own and in one with others."""
    target = access.removesuffix(".Q")
    method = ".TON" if target == '"Timer"' else ""
    variables = "q : Array[0..2] of TON_TIME; i : Int := 1; s : Struct n : Int; t : TON_TIME; END_STRUCT;"
    variables += "a : Bool; n : Int;"
    code = f"IF #n = 0 THEN {target}{method}(IN := TRUE, PT := T#20ms); END_IF; #n := #n + 1; #a := {access};"
    cpu = Cpu(load({"also": BLOCKS, "vars": variables, "code": code}))
    found = []
    for _ in range(4):
        cpu.call("Test_DB", 10)
        found.append(cpu["Test_DB.a"])
    assert found == [False, False, True, True]


def test_conditions_of_loops():
    """A timer queried in a condition is up to date every time the condition is."""
    code = "IF #n = 0 THEN #t(IN := TRUE, PT := T#20ms); END_IF; #n := #n + 1;\n"
    code += "#w := 0; WHILE #w < 3 AND #t.Q DO #w := #w + 1; END_WHILE;\n"
    code += "#r := 0; REPEAT #r := #r + 1; UNTIL #r >= 3 OR NOT #t.Q END_REPEAT;\n"
    code += "IF #n = 0 THEN ; ELSIF #t.ET >= T#20ms THEN #e := #e + 1; END_IF;"
    cpu = Cpu(load({"vars": "t : TON_TIME; n : Int; w : Int; r : Int; e : Int;", "code": code}))
    found = []
    for _ in range(3):
        cpu.call("Test_DB", 10)
        found.append((cpu["Test_DB.w"], cpu["Test_DB.r"], cpu["Test_DB.e"]))
    assert found == [(0, 1, 0), (0, 1, 0), (3, 3, 1)]


@pytest.mark.parametrize(
    ("kind", "inputs", "modern"),
    [
        # PT is 30 ms in the first call and 10 ms from then on
        ("TON", [1, 1, 1, 1], [0, 0, 0, 1]),
        ("TON", [0, 1, 1, 1], [0, 0, 1, 1]),
        ("TON", [1, 0, 1, 1], [0, 0, 0, 1]),
        ("TP", [1, 1, 0, 1, 0], [1, 1, 1, 0, 0]),
        ("TOF", [1, 0, 0, 0], [1, 1, 0, 0]),
    ],
)
def test_the_time_is_taken_over_at_an_edge(kind, inputs, modern):
    """S7-1500: PT of the call in which IN changed counts, whatever is given later."""
    code = "#t(IN := #x, PT := #pt, Q => #q);"
    case = {"in": "x : Bool; pt : Time;", "out": "q : Bool;", "vars": f"t : {kind}_TIME;", "code": code}
    cpu = Cpu(load(case))
    found = []
    for number, value in enumerate(inputs):
        cpu.call("Test_DB", 10, x=bool(value), pt=10 if number else 30)
        found.append(int(cpu["Test_DB.q"]))
    assert found == modern


def test_the_time_may_be_computed_from_the_timer():
    """PT is evaluated before the call, whatever stands behind it."""
    code = "#t(PT := #t.ET + #n * T#10ms, IN := #n > 0, ET => #e); #n := #n + 1;"
    cpu = Cpu(load({"vars": "t : TON_TIME; n : Int; e : Time;", "code": code}))
    for _ in range(4):
        cpu.call("Test_DB", 10)
    assert cpu["Test_DB.e"] == 10  # started in the second call with PT = 10 ms
