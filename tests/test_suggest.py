"""What "did you mean" offers."""

from __future__ import annotations

import pytest

from plcgen.base.diagnostics.suggest import near

DEVICES = ["micromaster-4", "profidrive", "sinamics-dcm", "sinamics-g120", "unit-of-the-axis", "cover_of_the_axis"]


@pytest.mark.parametrize(
    ("word", "expected"),
    [
        ("g120", ["sinamics-g120"]),
        ("G120", ["sinamics-g120"]),
        ("sinamics-g12", ["sinamics-g120"]),
        ("axis", []),  # two names have it
        ("4", []),  # too short to tell
        ("g12", []),  # no whole part
        ("frobnicate", []),
    ],
)
def test_a_whole_part_of_one_name_is_enough(word: str, expected: list[str]) -> None:
    """``g120`` is the usual name of ``sinamics-g120``; a part of several names suggests none of them."""
    assert near(word, DEVICES) == expected
