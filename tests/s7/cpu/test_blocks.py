"""System blocks against timing worked out by hand: timers, counters, edges."""

import datetime as dt

import pytest

from plcgen.s7.cpu.cpu import Cpu
from tests.s7.cpu.support import load

TIMER = {"in": "x : Bool;", "out": "q : Bool; et : Time;", "code": "#t(IN := #x, PT := T#30ms, Q => #q, ET => #et);"}


def trace(kind, dialect, inputs, name="TON"):
    """Q and ET of a timer with PT 30 ms, called every 10 ms with these inputs."""
    del name
    case = {**TIMER, "dialect": dialect, "vars": f"t : {kind};"}
    if dialect == "V5":
        case["code"] = "t(IN := x, PT := T#30ms); q := t.Q; et := t.ET;"
    cpu = Cpu(load(case))
    found = []
    for value in inputs:
        cpu.call("Test_DB", 10, x=bool(value))
        found.append((int(cpu["Test_DB.q"]), cpu["Test_DB.et"]))
    return found


ON = [0, 1, 1, 1, 1, 1, 0, 1, 1, 0]
ON_Q = [(0, 0), (0, 0), (0, 10), (0, 20), (1, 30), (1, 30), (0, 0), (0, 0), (0, 10), (0, 0)]
OFF = [0, 1, 1, 0, 0, 0, 0, 0, 1, 0, 0, 1]
OFF_Q = [(0, 0), (1, 0), (1, 0), (1, 0), (1, 10), (1, 20), (0, 30), (0, 30), (1, 0), (1, 0), (1, 10), (1, 0)]
PULSE = [0, 1, 0, 1, 1, 1, 0, 1, 1]
PULSE_Q = [(0, 0), (1, 0), (1, 10), (1, 20), (0, 30), (0, 30), (0, 0), (1, 0), (1, 10)]


SUM = [1, 1, 1, 0, 0, 1, 1, 1, 0, "r", 0, 1, 1]
SUM_Q = [(0, 0), (0, 10), (0, 20), (0, 20), (0, 20), (0, 20), (1, 30), (1, 30), (1, 30)]
SUM_Q += [(0, 0), (0, 0), (0, 0), (0, 10)]


@pytest.mark.parametrize("form", ["TONR", "TONR_TIME", "TONR_LTIME"])
def test_retentive_timer(form):
    """TONR adds up the times in which IN is TRUE; only R takes Q and ET back, in every form."""
    long = "LTIME" in form
    code = f"#t(IN := #x, R := #r, PT := {'LT' if long else 'T'}#30ms, Q => #q, ET => #et);"
    outputs = f"q : Bool; et : {'LTime' if long else 'Time'};"
    cpu = Cpu(
        load({"in": "x : Bool; r : Bool;", "out": outputs, "code": code, "dialect": "T15", "vars": f"t : {form};"})
    )
    found = []
    for value in SUM:
        cpu.call("Test_DB", 10, x=value == 1, r=value == "r")
        found.append((int(cpu["Test_DB.q"]), cpu["Test_DB.et"] // (1_000_000 if long else 1)))
    assert found == SUM_Q


@pytest.mark.parametrize(
    ("kind", "inputs", "expected"), [("TON", ON, ON_Q), ("TOF", OFF, OFF_Q), ("TP", PULSE, PULSE_Q)]
)
def test_timers_with_ltime(kind, inputs, expected):
    """The forms with LTIME count nanoseconds and switch in the same calls."""
    code = "#t(IN := #x, PT := LT#30ms, Q => #q, ET => #et);"
    case = {**TIMER, "out": "q : Bool; et : LTime;", "code": code, "dialect": "T15", "vars": f"t : {kind}_LTIME;"}
    cpu = Cpu(load(case))
    found = []
    for value in inputs:
        cpu.call("Test_DB", 10, x=bool(value))
        found.append((int(cpu["Test_DB.q"]), cpu["Test_DB.et"] // 1_000_000))
    assert found == expected


@pytest.mark.parametrize("dialect", ["V5", "T3", "T15"])
@pytest.mark.parametrize(
    ("kind", "inputs", "expected"), [("TON", ON, ON_Q), ("TOF", OFF, OFF_Q), ("TP", PULSE, PULSE_Q)]
)
def test_timers(kind, inputs, expected, dialect):
    """TON, TOF and TP, on every target."""
    assert expected == trace(kind, dialect, inputs)


@pytest.mark.parametrize("kind", ["TON_TIME", "TON"])
def test_timer_spellings(kind):
    """The instruction types of S7-1500 are the same timers."""
    assert trace(kind, "T15", ON) == ON_Q


@pytest.mark.parametrize(("dialect", "expected"), [("V5", [0, 0, 0, 1]), ("T3", [0, 0, 0, 1]), ("T15", [1, 1, 1, 1])])
def test_ton_without_a_time(dialect, expected):
    """SFB4 with PT = 0 is initialized (System Software for S7-300/400, SFB 4): no Q; a modern TON is over.

    PT is 0 in two calls and 10 ms in two more; on S7-300/400 the time starts in the first of these.
    """
    own = "" if dialect == "V5" else "#"
    code = f"{own}t(IN := TRUE, PT := {own}pt); {own}q := {own}t.Q;"
    cpu = Cpu(load({"dialect": dialect, "in": "pt : Time;", "out": "q : Bool;", "vars": "t : TON;", "code": code}))
    found = []
    for time in (0, 0, 10, 10):
        cpu.call("Test_DB", 10, pt=time)
        found.append(int(cpu["Test_DB.q"]))
    assert found == expected


def test_timer_data_block():
    """An SFB4 with its own instance data block."""
    also = "DATA_BLOCK DB10 SFB4\nBEGIN\nEND_DATA_BLOCK\n"
    code = "SFB4.DB10(IN := x, PT := T#20ms); q := DB10.Q;"
    cpu = Cpu(load({"dialect": "V5", "also": also, "in": "x : BOOL;", "out": "q : BOOL;", "code": code}))
    found = []
    for _ in range(4):
        cpu.call("Test_DB", 10, x=True)
        found.append(cpu["Test_DB.q"])
    assert found == [False, False, True, True]


def test_timer_over_the_end_of_the_clock():
    """A TON keeps its time when the clock of 32 bits wraps."""
    cpu = Cpu(load({**TIMER, "vars": "t : TON_TIME;"}))
    cpu.clock = 0xFFFFFFF8
    for _ in range(3):
        cpu.call("Test_DB", 10, x=True)
    assert cpu["Test_DB.et"] == 20


def test_time_tick_wraps():
    """TIME_TCK starts again at 0 after 31 bits."""
    cpu = Cpu(load({"dialect": "T3", "vars": "t : Time;", "code": "#t := TIME_TCK();"}))
    cpu.clock = 0x7FFFFFFF
    cpu.call("Test_DB", 0)
    first = cpu["Test_DB.t"]
    cpu.call("Test_DB", 1)
    assert (first, cpu["Test_DB.t"]) == (0x7FFFFFFF, 0)


def count(kind, names, steps, dialect="T15"):
    """CV and outputs of a counter for steps of inputs by name."""
    inputs = " ".join(f"{name.lower()}i : Bool;" for name in names)
    passed = ", ".join(f"{name} := #{name.lower()}i" for name in names)
    outputs = "QU => #q, QD => #d" if kind.startswith("CTUD") else "Q => #q"
    case = {
        "dialect": dialect, "in": inputs, "out": "q : Bool; d : Bool; cv : Int;", "vars": f"c : {kind};",
        "code": f"#c({passed}, PV := 2, {outputs}, CV => #cv);",
    }  # fmt: skip
    cpu = Cpu(load(case))
    found = []
    for step in steps:
        cpu.call("Test_DB", 10, **{f"{name.lower()}i": name in step for name in names})
        found.append((cpu["Test_DB.cv"], cpu["Test_DB.q"], cpu["Test_DB.d"]))
    return found


def test_count_up():
    """CTU counts edges, Q from PV on, R resets."""
    steps = [["CU"], ["CU"], [], ["CU"], [], ["CU"], ["R"], []]
    expected = [1, 1, 1, 2, 2, 3, 0, 0]
    found = count("CTU", ["CU", "R"], steps)
    assert [row[0] for row in found] == expected
    assert [row[1] for row in found] == [value >= 2 for value in expected]
    assert found == count("CTU", ["CU", "R"], steps, "T3")


def test_count_down():
    """CTD loads PV and counts down to 0 and below."""
    found = count("CTD", ["CD", "LD"], [["LD"], ["CD"], [], ["CD"], [], ["CD"]])
    assert [row[:2] for row in found] == [(2, False), (1, False), (1, False), (0, True), (0, True), (-1, True)]


def test_count_both():
    """CTUD counts both ways; R goes before LD."""
    steps = [["CU"], ["CD"], ["CU", "CD"], [], ["CU", "CD"], ["LD"], ["R", "LD"]]
    found = count("CTUD", ["CU", "CD", "R", "LD"], steps)
    assert [row[0] for row in found] == [1, 0, 1, 1, 1, 2, 0]
    assert found[5][1:] == (True, False)


@pytest.mark.parametrize(
    ("kind", "expected"),
    [("R_TRIG", [False, True, False, False, False]), ("F_TRIG", [False, False, False, True, False])],
)
def test_edges(kind, expected):
    """R_TRIG and F_TRIG answer for one call."""
    cpu = Cpu(load({"in": "x : Bool;", "out": "q : Bool;", "vars": f"e : {kind};", "code": "#e(CLK := #x, Q => #q);"}))
    found = []
    for value in (0, 1, 1, 0, 0):
        cpu.call("Test_DB", 10, x=bool(value))
        found.append(cpu["Test_DB.q"])
    assert found == expected


def test_date_and_time():
    """RD_SYS_T gives the module time: the date at switching on, and what has passed (help of RD_SYS_T; Sunday is 1)."""
    cpu = Cpu(load({"vars": "d : DTL; r : Int; h : USInt;", "code": "#r := RD_SYS_T(#d); #h := #d.HOUR;"}))
    cpu.time.start_time = dt.datetime(2026, 11, 22, 23, 59, 59)  # a CPU has no zone
    cpu.call("Test_DB", 250)
    assert bytes(cpu.db("Test_DB")[:12]) == bytes.fromhex("07EA 0B 16 01 17 3B 3B 0EE6B280")  # 250,000,000 ns
    cpu.call("Test_DB", 750)
    assert bytes(cpu.db("Test_DB")[:12]) == bytes.fromhex("07EA 0B 17 02 00 00 00 00000000")
    assert (cpu["Test_DB.r"], cpu["Test_DB.h"]) == (0, 0)
    cpu.time.start_time = dt.datetime(1969, 12, 31)
    cpu.call("Test_DB")
    assert cpu["Test_DB.r"] == 0x8081 - 0x10000
