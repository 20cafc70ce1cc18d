"""How many scans a job takes: as many as record calls by hand, and two more."""

from __future__ import annotations

import pytest

from tests.bench.scans import BUSY, GOAL, READ, RESTORE, RESTORE_MS, idle, scans

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("busy", BUSY)
def test_a_telegram(busy: int) -> None:
    """By hand each record call takes a scan and those in which it is busy; the job asks, and hears the result."""
    assert scans(READ, busy) == 2 * (busy + 1) + GOAL


def test_a_drive_that_needs_50_ms() -> None:
    """Busy for one scan of 10 ms: WRREC in scans 2 and 3, RDREC in 4 and 5; its answer is there from 80 ms on.

    It is not yet at 50 ms, so RDREC comes again in scan 7 and ends in scan 8; the job hears of it in scan 9.
    """
    assert scans(READ, 1, needs=50) == 9


def test_a_restore_of_six_telegrams() -> None:
    """A scan to ask for the unit, four for each telegram, one to hear the result."""
    assert scans(RESTORE, 1, RESTORE_MS, status=0x8530) == 1 + 6 * 4 + 1


def test_an_idle_scan() -> None:
    """It was 77 statements and branches when the channel went through its states one by one."""
    assert idle() < 77
