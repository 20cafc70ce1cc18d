"""Damaged and hostile sources: diagnostics with places, in linear time, and never an exception."""

from __future__ import annotations

import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from plcgen.s7.read.text import parse_source
from plcgen.s7.scl.cursor import MAX_ERRORS
from plcgen.s7.scl.dialect import Dialect
from tests.s7.scl.support import source

FB = "FUNCTION_BLOCK a\nBEGIN\n"
SOURCES = [source("job_v5.scl"), source("job_t15.scl"), source("faq_buffers.db")]
PARTS = re.compile(r"\w+|\s+|[^\w\s]")
WORDS = """IF THEN END_IF := => .. (* *) /* */ // 16#FF T#1s %M0.0 CASE OF ELSE REGION END_REGION VAR END_VAR
    VAR_STAT STRUCT END_STRUCT ELSEIF ENDIF AT TYPE NOT ** GOTO 10: a: 1e999 INT# 2#2 TOD#99:99:99 D#2024-13-45
    STRING[99999] REF_TO DATA_BLOCK BEGIN ENO""".split()
PAIRS = ["METHOD x", "CLASS x", "EXTENDS y", "END IF", "DB 10", "EW 10", "TITLE = x", "P#DB1.DBX0.0 BYTE 10", "\n"]
STRANGE = st.sampled_from([*WORDS, *PAIRS, "9" * 30, *"()[]{};:=#'\"-^\0\ufeffİ²"])
MUTATION = st.tuples(st.integers(0, 10_000), st.integers(0, 40), st.sampled_from("dris"), STRANGE)


@pytest.mark.slow
@given(
    st.sampled_from(SOURCES),
    st.lists(MUTATION, min_size=1, max_size=8),
    st.sampled_from([None, *Dialect]),
    st.booleans(),
)
@settings(max_examples=150)
def test_damaged_sources_give_diagnostics_only(
    text: str, mutations: list[tuple[int, int, str, str]], dialect: Dialect | None, bodies: bool
) -> None:
    """Whatever is deleted, repeated, inserted or moved: blocks and diagnostics with places, never an exception."""
    parts = PARTS.findall(text)
    for place, length, how, strange in mutations:
        at = place % max(1, len(parts))
        piece = parts[at : at + length]
        if how == "d":
            del parts[at : at + length]
        elif how == "r":
            parts[at:at] = piece
        elif how == "i":
            parts.insert(at, strange)
        else:
            parts[at : at + length] = piece[::-1]
    lines = "".join(parts).count("\n") + 2
    _, diagnostics = parse_source("".join(parts), "t.scl", dialect, bodies=bodies)
    assert len(diagnostics) <= 5 * MAX_ERRORS
    assert all(d.span.line is not None and 0 <= d.span.line <= lines for d in diagnostics)


@pytest.mark.slow
@pytest.mark.parametrize(
    "text",
    [
        FB + "#" + "a" * 1_000_000 + " := 1;",
        FB + "'" * 300_000,
        FB + "'" + "$> $<" * 100_000,
        FB + "x := " + "9" * 300_000 + ";",
        FB + "CASE x OF " + "( " * 200_000,
        FB + "CASE x OF 1: " + "a.b := 1; " * 20_000 + "END_CASE;",
        FB + "IF a {" * 20_000,
        FB + "P#1.0 BYTE " * 30_000,
        FB + "B#(1," * 60_000,
        FB + "(* " + "/* " * 200_000 + "*)",
        FB + "/*" * 200_000,
        FB + "METHOD x " * 50_000,
        "FUNCTION x " * 50_000,
        "TYPE a STRUCT " + "m : INT; " * 10_000 + "END_STRUCT; END_TYPE",
    ],
    ids=range(14),
)  # fmt: skip
@pytest.mark.parametrize("bodies", [True, False])
def test_long_lines_are_read_in_linear_time(text: str, bodies: bool) -> None:
    """A megabyte of any one thing ends in diagnostics, not in a search that grows with its square."""
    _, diagnostics = parse_source(text, "t.scl", Dialect.TIA_1200_1500, bodies=bodies)
    assert len(diagnostics) <= 5 * MAX_ERRORS
