"""A fixed sample of specs by combination: every value of every dimension; make pairs tries all."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.pairs import drives, ppi
from tests.pairs.cover import Row, cover, sample
from tests.pairs.refusals import DRIVES, impossible, possible
from tests.pairs.trial import tried

DRIVE_ROWS = sample(cover(drives.DIMENSIONS, possible(DRIVES)))
PPI_ROWS = sample(cover(ppi.DIMENSIONS, possible(ppi.REFUSALS)))


@pytest.mark.slow
@pytest.mark.parametrize("row", DRIVE_ROWS, ids=range(len(DRIVE_ROWS)))
def test_a_spec_with_drives_is_generated_and_verified(row: Row, tmp_path) -> None:
    """It is accepted, generated, the same again, verified, equal to itself, and locked."""
    assert not tried(drives.spec(row), tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("row", PPI_ROWS, ids=range(len(PPI_ROWS)))
def test_a_spec_with_a_master_is_generated_and_verified(row: Row, tmp_path) -> None:
    """The same for masters."""
    assert not tried(ppi.spec(row), tmp_path)


@pytest.mark.slow
def test_what_does_not_go_together_is_refused_with_its_code(tmp_path) -> None:
    """Each pair on its own, and nothing else is wrong with the spec: the code says which."""
    for row, code in impossible(drives.BASE, DRIVES):
        assert code in tried(drives.spec(row), tmp_path), row
    for row, code in impossible(ppi.BASE, ppi.REFUSALS):
        assert code in tried(ppi.spec(row), tmp_path), row


def test_every_pair_occurs() -> None:
    """Of a small example, counted by hand: 3 x 2 + 3 x 2 + 2 x 2 pairs, without a1 b1 and what it takes with it."""
    rows = cover(
        {"a": ("1", "2", "3"), "b": ("1", "2"), "c": ("1", "2")}, lambda row: (row.get("a"), row.get("b")) != ("1", "1")
    )
    pairs = {(one, row[one], other, row[other]) for row in rows for one, other in ("ab", "ac", "bc")}
    assert len(pairs) == 6 + 6 + 4 - 1
    assert not [row for row in rows if row["a"] == row["b"] == "1"]


def test_what_does_not_go_together_is_in_no_row() -> None:
    """All sides of a refusal must be there, and each may have another of its values."""
    goes = possible((((("a", ("1", "2")), ("b", ("1",))), "PG1"), ((("c", ("3",)),), "PG2")))
    assert [goes(row) for row in ({"a": "1", "b": "1"}, {"a": "2", "b": "1", "c": "1"}, {"c": "3"})] == [False] * 3
    assert [goes(row) for row in ({}, {"a": "1"}, {"a": "3", "b": "1"}, {"b": "1", "c": "1"})] == [True] * 4


NUMBERS = st.one_of(st.sampled_from([0, 1, -1, 2**31 - 1, -(2**31), 32767, -32768]), st.integers(-(2**31), 2**31 - 1))
TEXTS = st.text(st.characters(min_codepoint=32, max_codepoint=126), min_size=1, max_size=12)


@pytest.mark.slow
@settings(max_examples=6)
@given(
    number=NUMBERS,
    real=st.floats(width=32, allow_nan=False, allow_infinity=False, allow_subnormal=False),
    text=TEXTS,
    index=st.sampled_from([0, 1, 254, 255, 256, 32767, 32768, 65534]),
    seconds=st.integers(2, 3600),
)
def test_whatever_the_values_are(
    tmp_path_factory, number: int, real: float, text: str, index: int, seconds: int
) -> None:
    """Numbers to the ends of their types, texts of any character, times, indexes: it works."""
    parameters = {"P43001": {"type": "Integer32"}, "P43002": {"type": "FloatingPoint"}}
    parameters |= {"P43003": {"type": f"VisibleString[{len(text)}]"}, "P43004": {"type": "Unsigned16"}}
    written = {"P43001": number, "P43002": real, "P43003": text, f"P43004[{index}]": 65535}
    job = {"drive": "axis", "timeout": f"{seconds}s", "write": written}
    spec = {
        "plc": {"name": "Values", "family": "s7-1500", "toolchain": "tia-v19"},
        "drives": {"axis": {"device": "sinamics-s120", "hardware_id": 281, "parameters": parameters}},
        "jobs": {"j": job},
    }
    assert not tried(spec, tmp_path_factory.mktemp("values"))
