"""The mutation runner itself, and dropped statements that verify must notice."""

from __future__ import annotations

import pytest

from tests.mutation.__main__ import counted
from tests.mutation.cases import Case, cases, known_cases, spread
from tests.mutation.engine import ENGINE
from tests.mutation.equivalent import reason
from tests.mutation.known import FAQ, MM4, PUMP
from tests.mutation.operators import Mutant, mutants, numbers
from tests.mutation.run import Verdict, notice

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


def test_a_block_without_a_statement_is_noticed() -> None:
    """A block whose only statement is gone fails in its first call; it has no line but the first."""
    whole = "dropped: IF #execute OR #status <> W#16#7000 THEN"
    found = [case for case in cases([PUMP], ["dropped"]) if "SetRamps" in case.file and whole in case.mutant.what]
    verdicts = [notice(case) for case in found]
    assert [verdict.text.partition(" (")[0] for verdict in verdicts] == [
        "first run, scan 1: busy False, done False, error False at the same time"
    ]


def argued(block: str, what: str, turn: int = 1, spec: str = MM4) -> bool:
    """Whether a mutant of a block has a reason."""
    return bool(reason(Case(spec, f"scl/{block}.scl", ENGINE, Mutant(what, 1, ""), turn)))


def test_an_equivalent_mutant_has_a_reason() -> None:
    """The table explains a mutant by block, description and turn, in both spellings; others have to be noticed."""
    assert argued("DriveChannel", "dropped: #statTimer := 0")
    assert argued("DriveChannel", "dropped: statTimer := 0")
    assert not argued("DriveChannel", "dropped: statTimer := 0", turn=2)
    assert not argued("DriveChannel", "dropped: tempDone := FALSE")
    assert not argued("Other", "dropped: statTimer := 0")
    assert argued("PpiMaster", "3 -> 4: EVENT_REPLY : Int := 3;")
    assert argued("PpiMaster", "< -> <=: IF #tempFailed = 0 OR #tempIndex < #tempFailed THEN")
    assert argued("PpiMaster", "0 -> 1: #tempCount := 0;")
    assert argued("DriveChannel", "W#16#8105 -> W#16#8104: STATUS_LOST : Word := W#16#8105;")
    assert not argued("PpiMaster", "3 -> 4: #tempCount := 3;")
    sums = "0 -> 1: FOR #tempIndex := 0 TO #tempLength - 1 DO"  # with a CP 341 a loop that copies is in front of it
    assert [argued("MPpiMaster", sums, turn, "ppi_cp341") for turn in (1, 2)] == [False, True]
    assert [argued("MPpiMaster", sums, turn, "ppi_cm1241") for turn in (1, 2)] == [True, False]


def test_what_targets_share_is_damaged_in_one_of_them() -> None:
    """Each statement of the engine once, in every target some."""
    every = list(cases([FAQ, MM4, PUMP], ["dropped"]))
    chosen = spread(every)
    plain = [(case.file, case.mutant.what.replace("#", "")) for case in every if case.key == ENGINE]
    kept = [(case.file, case.mutant.what.replace("#", "")) for case in chosen if case.key == ENGINE]
    assert set(kept) == set(plain)
    assert len(kept) < len(plain) / 2
    assert {case.spec for case in chosen if case.key == ENGINE} == {FAQ, MM4, PUMP}
    assert [case for case in chosen if case.key != ENGINE] == [case for case in every if case.key != ENGINE]


def test_the_table() -> None:
    """What was not noticed is open unless it has a reason; the share is of those that change something."""
    good, equal, bad = (
        Case(MM4, "scl/DriveChannel.scl", ENGINE, Mutant(what, 1, ""))
        for what in ("1 -> 2: x", "dropped: statTimer := 0", "2 -> 3: x")
    )
    found = {good: Verdict("noticed", located=True, seconds=1.0), bad: Verdict()}
    table = counted([good, equal, bad], found)
    assert list(table) == ["engine, STEP 7 V5", "all"]
    line = table["all"]
    assert (line.all, line.noticed, line.argued, line.located, line.share) == (3, 1, 1, 1, 50.0)
