"""What cannot run follows from the block: constants, selectors, states, counters; and what must stay possible."""

from __future__ import annotations

import pytest

from plcgen.proof.conditions import Premise
from plcgen.proof.reach import reachable
from plcgen.s7.scl.parser import parse

HEAD = """FUNCTION_BLOCK f
VAR_INPUT
  go : BOOL;
END_VAR
VAR
  statState : INT;
  statCount : INT;
  statCodes : ARRAY[1..2] OF INT;
END_VAR
VAR_TEMP
  i : INT;
  x : INT;
END_VAR
CONST
  NONE := 0;
  MOST := 3;
  STATE_IDLE := 0;
  STATE_RUN := 1;
  STATE_LOST := 2;
END_CONST
BEGIN
"""


def dead(code: str, *premises: Premise, opened: tuple[str, ...] = ()) -> set[str]:
    """The marked places that cannot be reached, by their numbers: ``x := number`` is a mark."""
    text = HEAD + code + "\nEND_FUNCTION_BLOCK\n"
    result = parse(text, "test")
    assert not result.diagnostics
    (unit,) = result.units
    places = {start for start, kind in reachable(unit, premises, opened) if kind == "statement"}
    marks = [at for at in range(len(text)) if text.startswith("x := ", at)]
    return {text[at + 5 : text.index(";", at)] for at in marks if at not in places}


DEAD = {
    "a constant condition": ("IF NONE > 0 THEN x := 1; ELSE x := 2; END_IF;", {"1"}),
    "an input may be anything": ("IF go THEN x := 1; ELSE x := 2; END_IF;", set()),
    "a selector that a loop counts": (
        "FOR i := 1 TO MOST DO CASE i OF 1, 2: x := 1; 3: x := 2; ELSE x := 3; END_CASE; END_FOR;",
        {"3"},
    ),
    "a selector that a loop counts down": (
        "FOR i := MOST TO 1 BY -1 DO CASE i OF 1, 2: x := 1; 3: x := 2; ELSE x := 3; END_CASE; END_FOR; x := 4;",
        {"3"},
    ),
    "a label that no pass has": ("FOR i := 1 TO MOST DO CASE i OF 4: x := 4; END_CASE; END_FOR; x := 5;", {"4"}),
    "a state that nothing assigns": (
        "IF go THEN statState := STATE_RUN; END_IF; CASE statState OF STATE_RUN: x := 1; STATE_LOST: x := 2; END_CASE;",
        {"2"},
    ),
    "a state from the call before": (
        (
            "IF statState = STATE_LOST THEN x := 1; END_IF;"
            "IF statState = STATE_RUN THEN statState := STATE_LOST; END_IF;"
            "IF go THEN statState := STATE_RUN; END_IF;"
        ),
        set(),
    ),
    "a counter within its guard": (
        (
            "IF statCount < MOST THEN statCount := statCount + 1; END_IF;"
            "CASE statCount OF 1..3: x := 1; 0: x := 2; ELSE x := 3; END_CASE;"
        ),
        {"2", "3"},
    ),
    "a counter that grows forever": (
        "statCount := statCount + 1; IF statCount > 30000 THEN x := 1; END_IF; IF statCount < 1 THEN x := 2; END_IF;",
        {"2"},
    ),
    "what belongs together in the branches of a CASE": (
        (
            "CASE statCount OF 1: i := 1; x := 10; 0: i := 0; x := 20; END_CASE; IF go THEN statCount := 1 - i; END_IF;"
            "IF i <> statCount THEN x := 1; END_IF;"
        ),
        set(),
    ),
    "an array is not followed": ("IF statCodes[1] = 7 THEN x := 1; END_IF;", set()),
    "what a condition excludes": (
        "IF go AND statState = STATE_IDLE THEN IF statState > 0 THEN x := 1; END_IF; END_IF;",
        {"1"},
    ),
    "a repetition until its end": (
        "i := 0; REPEAT i := i + 1; UNTIL i = MOST END_REPEAT; IF i <> MOST THEN x := 1; END_IF;",
        {"1"},
    ),
    "a block with jumps": ("IF NONE > 0 THEN x := 1; RETURN; END_IF;", set()),
    "a loop without a bound": ("WHILE go DO x := 1; END_WHILE; x := 2;", set()),
}  # fmt: skip


@pytest.mark.parametrize("name", DEAD)
def test_what_cannot_run(name: str) -> None:
    """Each with what is reached in it by hand calculation."""
    code, expected = DEAD[name]
    assert dead(code) == expected


def test_a_premise_excludes_what_assigns_its_constant() -> None:
    """The whole body cannot run, also what stands in front of the assignment; other bodies can."""
    code = "IF go THEN x := 1; statState := STATE_LOST; ELSE x := 2; END_IF;"
    code += "IF statState = STATE_LOST THEN x := 3; END_IF;"
    assert dead(code) == set()
    assert dead(code, Premise("never lost", never="STATE_LOST")) == {"1", "3"}


def test_a_premise_holds_in_its_states_only() -> None:
    """The elements of an array are 1 or 2 in state RUN; what excludes one of them leaves the other."""
    ask = "IF statCodes[i] = 1 THEN x := {0}1; ELSIF statCodes[i] <> 2 THEN x := {0}2; ELSE x := {0}3; END_IF;"
    code = f"CASE statState OF STATE_RUN: {ask.format(1)} STATE_IDLE: {ask.format(2)} END_CASE; statState := STATE_RUN;"
    two = Premise("two codes", variable="statCodes", values=frozenset({1, 2}), among=frozenset({1}))
    assert dead(code) == set()
    assert dead(code, two) == {"12"}


def test_what_is_opened_counts_as_possible() -> None:
    """A constant that another project may set is an excuse only with a premise that follows it."""
    code = "IF statCount < NONE THEN x := 1; statCount := statCount + 1; END_IF; IF statCount > 0 THEN x := 2; END_IF;"
    assert dead(code, opened=("NONE",)) == set()
    assert dead(code, Premise("none", follow=("NONE",)), opened=("NONE",)) == {"1", "2"}


def test_which_operands_may_decide() -> None:
    """The second of two that hang together never settles the outcome; behind a premise the first one is settled."""
    text = HEAD + "IF go THEN statCount := 2; END_IF;\nIF statCount > 0 OR statCount > 1 THEN x := 1; END_IF;\n"
    (unit,) = parse(text + "END_FUNCTION_BLOCK\n", "test").units
    found = {(text[start : start + 13], kind) for start, kind in reachable(unit) if kind.startswith("decides")}
    assert found == {
        ("statCount > 0", "decides FALSE"),  # statCount is 0 or 2: both are FALSE, or both TRUE
        ("statCount > 1", "decides FALSE"),
    }
