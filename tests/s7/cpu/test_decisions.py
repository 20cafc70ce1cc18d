"""Which operand of a condition decides, as truth tables have it, and that looking at all of them changes nothing."""

from __future__ import annotations

import itertools

import pytest

from plcgen.s7.cpu.cpu import Cpu
from plcgen.s7.cpu.program import Program
from plcgen.s7.scl.dialect import Dialect
from plcgen.s7.scl.logic import DECIDES

FRAME = """FUNCTION_BLOCK "Test"
VAR a : Bool; b : Bool; c : Bool; r : Bool; n : Int; x : Array[0..3] of Int; END_VAR
BEGIN
{code}
END_FUNCTION_BLOCK
DATA_BLOCK "Test_DB"
"Test"
BEGIN
END_DATA_BLOCK
"""
SIDES = frozenset(DECIDES.values())


def cpu(code: str, *, coverage: bool = True) -> Cpu:
    """A CPU with one block."""
    program = Program.load([("test.scl", FRAME.format(code=code))], Dialect.TIA_1200_1500, coverage=coverage)
    assert program.diagnostics == []
    return Cpu(program)


def call(one: Cpu, **values: bool | int) -> bool:
    """Call the block; r behind it."""
    for name, value in values.items():
        one[f"Test_DB.{name}"] = value
    one.call("Test_DB")
    return bool(one["Test_DB.r"])


def decided(one: Cpu) -> list[tuple[int, str]]:
    """Columns and values of the operands that have decided."""
    found = zip(one.program.probes, one.coverage, strict=True)
    return sorted(
        (probe.column, probe.kind.removeprefix("decides ")) for probe, n in found if n and probe.kind in SIDES
    )


@pytest.mark.parametrize(
    ("condition", "values", "wanted"),
    [
        # with b TRUE, a lets r be what it is; with a TRUE, b does: both decide
        ("#a AND #b", {"a": True, "b": True}, [(7, "TRUE"), (14, "TRUE")]),
        ("#a AND #b", {"a": False, "b": True}, [(7, "FALSE")]),
        ("#a AND #b", {"a": False, "b": False}, []),  # the other one holds it FALSE
        ("#a OR #b", {"a": True, "b": True}, []),
        ("#a OR #b", {"a": True, "b": False}, [(7, "TRUE")]),
        ("#a OR #b", {"a": False, "b": False}, [(7, "FALSE"), (13, "FALSE")]),
        ("#a XOR #b", {"a": True, "b": True}, [(7, "TRUE"), (14, "TRUE")]),
        ("#a AND NOT #b", {"a": True, "b": True}, [(18, "TRUE")]),
        # a decides only where b OR c is TRUE, b only where c is FALSE
        ("#a AND (#b OR #c)", {"a": True, "b": True, "c": False}, [(7, "TRUE"), (15, "TRUE")]),
        ("#a AND (#b OR #c)", {"a": True, "b": True, "c": True}, [(7, "TRUE")]),
        ("#n > 3 AND #b", {"n": 2, "b": True}, [(7, "FALSE")]),
    ],
)
def test_an_operand_decides_if_its_opposite_would_change_the_outcome(
    condition: str, values: dict[str, bool | int], wanted: list[tuple[int, str]]
) -> None:
    """Worked out by hand from the truth tables."""
    one = cpu(f"#r := {condition};")
    call(one, **values)
    assert decided(one) == wanted


@pytest.mark.parametrize(
    "condition", ["#a AND #b OR NOT #c", "NOT (#a OR #b) XOR #c", "#a & (#b XOR #c)", "#a AND #b AND #c = #a"]
)
def test_the_outcome_is_the_same_with_and_without_coverage(condition: str) -> None:
    """All operands are looked at, and the outcome stays."""
    plain, counted = cpu(f"#r := {condition};", coverage=False), cpu(f"#r := {condition};")
    for a, b, c in itertools.product((False, True), repeat=3):
        assert call(counted, a=a, b=b, c=c) == call(plain, a=a, b=b, c=c)


@pytest.mark.parametrize("coverage", [True, False])
def test_what_is_a_fault_is_one_behind_a_condition_too(coverage: bool) -> None:
    """An index outside its array behind a condition that is FALSE already: a CPU evaluates every operand."""
    one = cpu("#r := #n <= 3 AND #x[#n] = 0;", coverage=coverage)
    call(one, n=4)
    assert [misuse.code for misuse in one.misuses] == ["PG834"]
    assert call(one, n=3) is True
    assert not coverage or decided(one) == [(7, "TRUE"), (19, "TRUE")]


def test_coverage_is_forgotten() -> None:
    """Counters begin at 0 again, and the same values count again."""
    one = cpu("#r := #a AND #b;")
    call(one, a=True, b=True)
    one.forget_coverage()
    assert sum(one.coverage) == 0
    call(one, a=True, b=True)
    assert decided(one) == [(7, "TRUE"), (14, "TRUE")]


def test_without_coverage_there_is_no_table() -> None:
    """The generated code is what it was."""
    one = cpu("#r := #a AND #b;", coverage=False)
    assert one.program.link.decisions == []
    assert "D[" not in one.program.compiled[0].source
