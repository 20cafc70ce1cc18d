"""The page of instructions says what a call of each of them does; ``python -m tests.docs.test_instructions`` writes it.

The names are headings of the help, the states are found by compiling a call.
"""

from __future__ import annotations

from pathlib import Path

from plcgen.s7.scl.instructions import S7_300, S7_1500, documented
from tests.docs.instructions import State, states

PAGE = Path(__file__).resolve().parents[2] / "docs" / "instructions.md"
HEAD = """# Instructions

What the soft CPU and `check` know of the instructions of SCL, by the headings of the help of the TIA Portal V19: the
pages "SCL" and "Extended instructions" of both families. A test compiles a call of each, so this page is what the
program does.

| state | meaning |
|---|---|
| executed | a call runs in the [soft CPU](soft-cpu.md), and its parameters are checked |
| checked | the parameters of a call are checked; a statement with it fails when it is reached (PG827) |
| known | the name is no mistake; a statement with it fails when it is reached (PG827) |

"""


def page() -> str:
    """The whole page."""
    found = {family: states(family) for family in (S7_300, S7_1500)}
    lines = ["| family | page | instructions | known | checked | executed |", "|---|---|---|---|---|---|"]
    chapters = []
    for family, state in found.items():
        places = documented(family)
        for title in ("SCL", "Extended instructions"):
            names = [name for name in state if places[name].partition(":")[0] == title]
            counts = [sum(state[name] >= least for name in names) for least in State if least != State.UNKNOWN]
            shares = (f"{count} ({100 * count // len(names)} %)" for count in counts)
            lines.append(f"| {family} | {title} | {len(names)} | {' | '.join(shares)} |")
        chapters += [f"\n## {family}\n", "| chapter | executed | checked only | known only |", "|---|---|---|---|"]
        for chapter in sorted(set(places.values()), key=lambda text: (text[0] != "S", text)):
            cells = (
                ", ".join(sorted((n for n in state if places[n] == chapter and state[n] is which), key=str.upper))
                for which in (State.EXECUTED, State.CHECKED, State.KNOWN)
            )
            chapters.append(f"| {chapter} | {' | '.join(cells)} |")
    return HEAD + "\n".join([*lines, *chapters]) + "\n"


def test_the_page_says_what_calls_do() -> None:
    """Every name is known, and the page shows how far each of them goes."""
    for family in (S7_300, S7_1500):
        assert [name for name, state in states(family).items() if state is State.UNKNOWN] == []
    assert page() == PAGE.read_text(encoding="utf-8")


def test_four_of_five_are_executed() -> None:
    """At least 80 % of the instructions of SCL run, of both families."""
    for family in (S7_300, S7_1500):
        found = [state for name, state in states(family).items() if documented(family)[name].startswith("SCL:")]
        assert found.count(State.EXECUTED) >= 0.8 * len(found)


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
