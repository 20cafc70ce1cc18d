"""What "did you mean" offers."""

from __future__ import annotations

import pytest

from plcgen.base.diagnostics.suggest import near, one_letter_wrong

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


@pytest.mark.parametrize(
    ("word", "meant"),
    [("every", "verify"), ("devices", "review"), ("persist", "on_error"), ("raed", "read"), ("verfy", "verify")],
)
def test_letters_in_common_are_not_enough(word: str, meant: str) -> None:
    """More than a third of the letters differs: it is another word, and the wrong offer sends the reader astray."""
    assert near(word, ["verify", "review", "on_error", "read", "simulate"]) == (
        [meant] if word in {"raed", "verfy"} else []
    )


@pytest.mark.parametrize("word", ["plcs", "lpc", "pcl", "pl", "plx", "p1c"])
def test_one_letter_wrong(word: str) -> None:
    """One more, changed places, one less, another."""
    assert one_letter_wrong(word, "plc")


@pytest.mark.parametrize("word", ["plc", "ppi", "plcss", "clp", "", "p"])
def test_more_than_one_letter_wrong(word: str) -> None:
    """Also none."""
    assert not one_letter_wrong(word, "plc")
