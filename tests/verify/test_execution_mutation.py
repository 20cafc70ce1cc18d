"""The mutation runner itself, and a handful of dropped statements that verify must notice."""

from __future__ import annotations

import sys

import pytest
from projects import ROOT

sys.path.insert(0, str(ROOT))

from mutation.__main__ import cases, known_cases, notice
from mutation.equivalent import reason
from mutation.known import FAQ
from mutation.operators import mutants, numbers

SOURCE = "FUNCTION_BLOCK f\nVAR\n  a : INT;\nEND_VAR\nBEGIN\n"
SOURCE += "IF a > 1 THEN\n  a := 2;\n  a := a + 1;\nEND_IF;\nEND_FUNCTION_BLOCK\n"


def test_every_kind_of_mutant_is_made() -> None:
    """Dropped statements, exchanged ones, operators and constants."""
    made = [mutant.what for mutant in mutants(SOURCE)]
    assert [what for what in made if what.startswith("dropped")] == [
        "dropped: IF a > 1 THEN a := 2; a := a + 1; END_IF;",
        "dropped: a := 2",
        "dropped: a := a + 1",
    ]
    assert "exchanged: a := 2 / a := a + 1" in made
    assert "> -> >=: IF a > 1 THEN" in made
    assert "2 -> 3: a := 2;" in made


def test_numbers_change_within_their_type() -> None:
    """Hexadecimal ones by a bit, times by a fifth, others by one."""
    assert numbers("B#16#44") == ("B#16#45",)
    assert numbers("T#200ms") == ("T#240ms",)
    assert numbers("7") == ("8",)


@pytest.mark.parametrize("case", [pytest.param(case, id=case.mutant.what) for case in known_cases()])
def test_faults_of_other_libraries_are_noticed(case: object) -> None:
    """The ten faults are noticed, each by a scenario or by the compiler."""
    assert notice(case)  # type: ignore[arg-type]


def test_a_sample_of_dropped_statements_is_noticed() -> None:
    """Every 12th statement of one block: the scenario and the scan are named."""
    chosen = [case for case in cases([FAQ], 1) if "ReadRampUp" in case.file and case.mutant.what.startswith("dropped")]
    silent = [case.mutant.what for case in chosen[::12] if not (notice(case) or reason(case.mutant, single=True))]
    assert silent == []
