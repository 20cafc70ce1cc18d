"""One sentence for every telegram, whatever its bytes are."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from plcgen.ds47.recording.exchange import contact_text
from plcgen.report.trace.model import Contact
from plcgen.report.trace.spelling import value_text

READ = "01 01 02 01 10 01 C47F 0000"
TWO = "05 01 00 02 10 01 0460 0000 10 02 086B 0001"


def text(direction: str, data: str, request: str = "", status: int = 0) -> str:
    found = Contact("job", "dcm", direction, 47, status, bytes.fromhex(data), bytes.fromhex(request))
    return contact_text(found, {50303: "P", 965: "r"})


@pytest.mark.parametrize(
    ("direction", "data", "asked", "expected"),
    [
        ("write", READ, "", "reference 1, object 2, read P50303"),
        ("write", TWO, "", "reference 5, object 0, read P1120, P2155[1..2]"),
        ("write", "02 02 02 01 10 01 C480 0000 08 01 42C80000", "", "reference 2, object 2, change P50304 := 100.0"),
        ("write", "01 01 01 01 10 01 03C5 0001", "", "reference 1, object 1, read r965[1]"),
        ("write", "01 02", "", "not a valid request: "),
        ("read", "01 01 02 01 08 01 41200000", READ, "reference 1, P50303 = 10.0"),
        ("read", "01 01 02 01 43 01 41200000", READ, "reference 1, P50303 = 16#41200000 (as REAL 10.0)"),
        ("read", "01 01 02 01 08 01 41200000", "", "reference 1, parameter 1 = 10.0"),
        ("read", "01 81 02 01 44 02 0002 0000", READ, "reference 1, P50303: error 02h "),
        ("read", "02 02 02 01", "02 02 02 01 10 01 C480 0000 08 01 42C80000", "reference 2, accepted: P50304"),
        ("read", "05 81 00 02 44 01 0017", TWO, "reference 5, the whole request: error 17h "),
        ("read", "02 01 02 01 08 01 41200000", READ, "not a valid answer: "),
    ],
)
def test_what_a_telegram_says(direction: str, data: str, asked: str, expected: str) -> None:
    """Requests and answers by parameter; an answer that is not the request's own is said to be wrong."""
    found = text(direction, data, asked)
    assert found == expected or (expected.endswith(" ") and found.startswith(expected)), found


def test_what_a_refusal_says() -> None:
    """Meaning and whether repeating helps."""
    assert text("read", "", READ, 0xDE80B500).endswith("(temporary)")
    assert text("read", "", READ, 0xDE80A000).endswith("(write the request again)")
    assert text("write", READ, "", 0xDF80B000).endswith("(permanent)")


@given(st.sampled_from(["read", "write"]), st.binary(max_size=40), st.binary(max_size=20), st.integers(0, 2**32 - 1))
def test_no_bytes_are_too_strange(direction: str, data: bytes, request: bytes, status: int) -> None:
    """Anything gives a sentence, never an exception."""
    assert contact_text(Contact("g", "d", direction, 47, 0, data, request))
    assert contact_text(Contact("g", "d", direction, 47, status or 1, data, request))


def test_values() -> None:
    """Constants as SCL writes them; long arrays are cut, strange numbers survive."""
    assert value_text(True) == "TRUE"
    assert value_text(255, bits=16) == "16#00FF"
    assert value_text(-5) == "-5"
    assert value_text(float("inf")) == "inf"
    assert value_text([1, 2]) == "[1, 2]"
    assert value_text(list(range(9))) == "[0, 1, 2, 3, 4, 5, .. 9 values]"
    assert value_text("abc") == "'abc'"
    assert value_text({"a": 1.5}) == "(a := 1.5)"
