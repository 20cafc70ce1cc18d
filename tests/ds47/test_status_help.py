"""STATUS as Siemens' help for the TIA Portal lists it: extended instructions, parameter STATUS; general error codes."""

from __future__ import annotations

import pytest

from plcgen import api
from plcgen.ds47.wire.status import Retry, explain_codes, explain_status, explain_word


@pytest.mark.parametrize(
    ("status", "word"),
    [
        (0xDE809100, "index is not permitted for a CPU module"),
        (0xDE809400, "not in the table of RDREC and WRREC"),
        (0xDF80BA00, "S7-1500R/H"),
        (0xDF80C700, "restart of the DP master"),
        (0xDE80E101, "of the device or its manufacturer"),
        (0xDF80E003, "invalid structure of the record, wrong block type in the header"),
        (0xDF80E105, "a value of the record is invalid, parameter 5"),
        (0xDF80E200, "cannot be processed in this OB"),
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
    found = explain_status(status)
    assert word in found.text
    assert "recalled" not in found.text
    assert found.retry is Retry.PERMANENT


@pytest.mark.parametrize(
    ("word", "means"),
    [
        (0x80A2, "module failure: DP protocol error"),
        (0x80B5, "state conflict: module not ready"),
        (0x8094, "not in the table of RDREC and WRREC"),
        (0x80C7, "job aborted: ended by a warm or cold restart of the DP master"),
        (0x8322, "call parameter 3: outside the area when it was read"),
        (0x8228, "call parameter 2: wrong alignment when it was read"),
        (0x8143, "call parameter 1: access error when it was written to the peripheral outputs"),
    ],
)
def test_a_word_without_a_function_names_none(word: int, means: str) -> None:
    """Which block failed is in the byte in front of the word; an error is never called "no error"."""
    assert explain_word(word).text.startswith(means)


@pytest.mark.parametrize(
    ("word", "means"),
    [
        (0xE000, "invalid structure of the record"),
        (0xE001, "invalid structure of the record, versions conflict"),
        (0xE102, "a value of the record is invalid, parameter 2"),
        (0xE1FF, "a value of the record is invalid, parameter 255"),
        (0xB500, "state conflict: module not ready"),
    ],
)
def test_the_lower_word_of_a_status(word: int, means: str) -> None:
    """Help for WRREC: DF80E0xy, DF80E1xy and DF80E200 of Siemens modules; xy = 1..255 of E1h is the parameter."""
    assert explain_codes(word).text.endswith(means)
    page = api.explain(f"{word:04X}")
    assert page is not None
    assert [(name, text.endswith(means)) for name, text in page.sections] == [
        ("As the lower word of a WRREC or RDREC STATUS", True)
    ]


@pytest.mark.parametrize(
    ("word", "title", "says"),
    [("PKW", "PKW", "PKE"), ("pzd", "PZD", "STW"), ("data  set 47", "DS47", "B02E"), ("BICO", "BICO", "source")],
)
def test_terms_of_the_channel_are_explained(word: str, title: str, says: str) -> None:
    """In any spelling, each with where it is defined."""
    page = api.explain(word)
    assert page is not None
    assert page.key == title
    assert says in page.title
    assert dict(page.sections)["Source"]
