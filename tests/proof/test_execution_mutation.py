"""The mutation runner itself, and dropped statements that verify must notice."""

from __future__ import annotations

import sys

import pytest
from projects import ROOT

sys.path.insert(0, str(ROOT))

from mutation.cases import Case, cases, known_cases
from mutation.equivalent import reason
from mutation.known import FAQ
from mutation.operators import Mutant, mutants, numbers
from mutation.run import notice

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
def test_faults_of_other_libraries_are_noticed(case: Case) -> None:
    """The ten faults are noticed, each by a scenario or by the compiler."""
    assert notice(case).text


@pytest.mark.parametrize("file", ["ReadRampUp", "Main"])
def test_every_deleted_statement_is_noticed_and_located(file: str) -> None:
    """Without any one statement a scenario fails, and names scan and line; ``--deletions`` does it for all files."""
    chosen = [case for case in cases([FAQ], ["dropped"], main=True) if file in case.file]
    found = [(case.mutant.line, case.mutant.what, notice(case)) for case in chosen]
    assert found
    assert [entry for entry in found if not entry[2].text] == []
    assert sum(not entry[2].located for entry in found) <= 1  # what only another instance shows has no scan


def test_an_equivalent_mutant_has_a_reason() -> None:
    """The table explains a mutant by its description, in both spellings; anything else has to be noticed."""
    moved = "exchanged: {0}tempMove := {1}(SRCBLK := P#DB3.DBX0 / {0}tempMove := {1}(SRCBLK := P#DB4.DBX0"
    assert reason(Mutant(moved.format("#", "BLKMOV"), 1, ""))
    assert reason(Mutant(moved.format("", "SFC20"), 1, ""))
    assert not reason(Mutant("dropped: tempMove := SFC20(SRCBLK := P#DB3.DBX0", 1, ""))
