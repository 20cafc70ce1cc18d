"""Damage to shipped jobs that nothing noticed once: what verify says about it now."""

from __future__ import annotations

import pytest

from tests.mutation.cases import cases
from tests.mutation.run import notice

READBACK, SAVE, SEQUENCE = "s7-1500_g120_readback", "s7-1500_s120_save", "s7-1500_s210_sequence"
MESSAGES, RECIPE, RESTORE = "s7-1500_s120_messages", "s7-1200_s120_recipe", "s7-1500_s210_restore"
TRANSACTION = "s7-1500_s120_bico"
DAMAGE = {
    # an answer is compared before it is there: wrong only if the job is called more often than its channel
    (READBACK, "SetRamps", "= -> <>: IF #tempTurn.grant", 2): "the job is called twice as often as its channel",
    # 2.0 and 8.0 differ in the first byte only
    (READBACK, "SetRamps", "0 -> 1: IF #tempByte = 0", 1): "are far from what was sent, values odd",
    (READBACK, "SetRamps", "B#16#7F -> B#16#7E", 1): "are far from what was sent, values odd",
    # questions without a pause, a limit that is another one, a start that is refused for ever
    (SAVE, "SaveAxis", "= -> <>: IF #statLast = 0", 1): "a question 0 ms after the one before",
    (SAVE, "SaveAxis", "< -> <=: IF #statLast = 0", 1): "no question 1000 ms after the one before",
    (SAVE, "SaveAxis", ">= -> >: IF #tempSaved", 1): "a question behind the one 30000 ms after the answer",
    (SAVE, "SaveAxis", "L#1000 -> L#1200: SAVE_STEP", 1): "given up after a question 29999 ms after the answer",
    (SAVE, "SaveAxis", "L#0 -> L#1: #tempPassed", 1): "a question 999 ms after the one before",
    (SAVE, "SaveAxis", "L#0 -> L#1: IF #statRest > L#0", 1): "again behind the start that was too soon",
    (SAVE, "SaveAxis", "L#0 -> L#1: #statRefused", 1): "1 ms too soon",
    (SAVE, "SaveAxis", "L#0 -> L#1: #statRest := L#0", 1): "the next start has to wait, but nothing was saved",
    # the only fault that remains is 0100h, the first one
    (MESSAGES, "ClearFaults", "10 -> 11: FOR #tempIndex", 1): "one fault remains, which is octet 0 of all of them",
    # the second word of an error of the run before
    (
        RECIPE,
        "StoreWinding",
        "dropped: #diagnosis.errorInfos[#tempIndex] := W#16#0000",
        1,
    ): "errorInfos[5] are 16#FFFF, 261",
    # a record counts in the start only, and a zero is compared behind a number that is none
    (RECIPE, "StoreWinding", "dropped: #statExecuteOld := #execute", 1): "does not stay while execute is TRUE",
    (RECIPE, "CheckWinding", "dropped: #statExecuteOld := #execute", 1): "does not stay while execute is TRUE",
    (RECIPE, "LoadWinding", "dropped: #tempBits := (#tempSent OR #tempCame)", 3): "unit in the last place",
    # lost while it writes: that the drive may have other values is not told
    (RESTORE, "SetLimits", "2 -> 3: IF NOT #tempFailed OR", 1): "8105 does not tell that telegram 2 may have changed",
    # status says "not saved", only cause says that the drive has refused it
    (TRANSACTION, "SetMop", "L#0 -> L#1: #statRest := L#0", 1): "the next start has to wait, but nothing was saved",
    # a single value is written back although the drive runs
    (RESTORE, "SetLimits", "0 -> 1: #statRuns", 1): "parameter 3 alone is taken, the drive runs",
    # the times of a step that waits
    (SAVE, "TakeOut", ">= -> >: #tempExecute", 1): "the unit is not asked for 1000 ms after the last question",
    (SAVE, "TakeOut", "- -> +: IF #statWaited", 1): "given up after a question 59999 ms after the first",
    (SAVE, "TakeOut", ">= -> >: IF #statWaited", 1): "one more question behind the one 60000 ms after the first",
    # the times of a step that an instance has only from its last run
    (SEQUENCE, "SetUp", "dropped: #statInterval", 1): "every step waits, after a download",
    # what another job has left in the unit, the drive object of another instance, the answer of a neighbour
    (SEQUENCE, "SetUp", "dropped: #unit.expected[1]", 2): "what is expected of P10 in telegram",
    (SEQUENCE, "SetUp", "dropped: #statRequest2.driveObject", 1): "instance near addresses drive object 2 instead of 3",
    (SEQUENCE, "Release", "3 -> 4: IF #diagnosis.errors[3]", 1): "r2 is",
}
"""Spec, file, beginning and turn of a mutant, and what is said about it."""


@pytest.mark.slow
@pytest.mark.parametrize("damage", DAMAGE, ids=lambda damage: " ".join(map(str, damage[1:])))
def test_damage_is_noticed(damage: tuple[str, str, str, int]) -> None:
    """A scenario fails and says what is wrong."""
    spec, file, what, turn = damage
    kinds = ["dropped"] if what.startswith("dropped") else ["changed"]
    (case,) = (
        case
        for case in cases([spec], kinds)
        if case.file == f"scl/{file}.scl" and case.mutant.what.startswith(what) and case.turn == turn
    )
    assert DAMAGE[damage] in notice(case).text
