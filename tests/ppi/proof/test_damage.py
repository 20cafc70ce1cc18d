"""Damage to PPI masters that nothing noticed once: what verify says about it now."""

from __future__ import annotations

import pytest

from tests.mutation.cases import cases
from tests.mutation.run import notice

CM, CP = "ppi_cm1241", "ppi_cp341"
DAMAGE = {
    # a CPU whose scans are shorter than a millisecond
    (CM, "< -> <=: IF #tempElapsed < 0", 1): "two calls in every millisecond, scan 2: status is 16#8101",
    (CM, "0 -> 1: IF #tempElapsed < 0", 1): "two calls in every millisecond, scan 2: status is 16#8101",
    # a telegram more behind power-up
    (CM, "3 -> 4: #statSync := 3", 1): "84 00 06 F0 67 16, which is not the planned telegram",
    # what docs/ppi-master.md says that ends a message
    (CM, "512 -> 513: #statConditions.END.MAXLEN", 1): "a message ends after a gap of 35 bit times or 513 bytes",
    (CM, "35 -> 36: #statConditions.END.CHARGAP", 1): "a message ends after a gap of 36 bit times or 512 bytes",
    # a reply that comes in the very scan in which a pause is over
    (CP, "dropped: #statState := #STATE_WAIT", 1): "16#8205, although the reply came",
    # the first byte behind E5 is passed over
    (CM, "1 -> 2: #tempSize := 1", 1): "a frame of others right behind E5, scan 28: diagnostics.ignoredFrames counts 0",
    # the pad behind a value
    (CM, "2 -> 3: FOR #tempIndex := 0 TO 2", 1): '"MAll_Response".data3 is',
    # a CPU whose scan is as long as the timeout: what the job before had left, a poll instead of the request
    (CP, "dropped: #statRetries := 0", 1): "a timeout before the first frame, scan 2: diagnostics.retries is 3",
    (CP, "dropped: #statNewPoll := FALSE", 1): "the job after: scan 20 is as long as the timeout",
    # 1 ms too early behind the end of the clock
    (CP, "1 -> 2: #tempElapsed := #tempElapsed + #CLOCK_END + 1", 2): "state 5 ends 259 ms after it began, not 260",
}
"""Spec, beginning and turn of a mutant, and what is said about it."""


@pytest.mark.slow
@pytest.mark.parametrize("damage", DAMAGE, ids=lambda damage: " ".join(map(str, damage)))
def test_damage_is_noticed(damage: tuple[str, str, int]) -> None:
    """A scenario fails and says what is wrong."""
    spec, what, turn = damage
    kinds = ["dropped"] if what.startswith("dropped") else ["changed"]
    (case,) = (case for case in cases([spec], kinds) if case.mutant.what.startswith(what) and case.turn == turn)
    assert DAMAGE[damage] in notice(case).text
