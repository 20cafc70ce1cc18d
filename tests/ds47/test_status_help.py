"""STATUS as Siemens' help for the TIA Portal lists it: extended instructions, parameter STATUS; general error codes."""

from __future__ import annotations

import pytest

from plcgen.protocols.ds47.wire.status import Retry, explain


@pytest.mark.parametrize(
    ("status", "word"),
    [
        (0xDE809100, "index is not permitted for a CPU module"),
        (0xDE809400, "not in the table of RDREC and WRREC"),
        (0xDF80BA00, "S7-1500R/H"),
        (0xDF80C700, "restart of the DP master"),
        (0xDE80E101, "of the device or its manufacturer"),
        (0xDE832200, "call parameter 3: outside the area when it was read"),
        (0xDE882900, "bit address is not 0"),
        (0xDE883000, "write-protected global data block"),
        (0xDE843100, "write-protected instance data block"),
        (0xDE844200, "peripheral inputs"),
        (0xDE844300, "peripheral outputs"),
        (0xDE847F00, "internal error"),
    ],
)
def test_what_the_help_lists_is_explained(status: int, word: str) -> None:
    """None of it is marked as recalled, and none of these is tried again."""
    found = explain(status)
    assert word in found.text
    assert "recalled" not in found.text
    assert found.retry is Retry.PERMANENT
