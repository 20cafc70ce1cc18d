"""What the rules rest on: each one is switched off in an independent calculator, and the vectors must notice or not."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from plcgen.s7.layout.evidence import COMPILED, RULES, SIZES, rule
from plcgen.s7.layout.layout import layout_block, leaves, locate
from plcgen.s7.types.data_types import ELEMENTARY
from tests.layout_vectors import block, cases, db
from tests.rulebook import Rulebook

WITHOUT = {
    "bit": [("bit",)],
    "bit-array-end": [("bit-array-end", "array-end")],
    "byte": [("byte",)],
    "word": [("word-even",), ("word-only-even",)],
    "string": [("string-start",), ("string-head",)],
    "struct-end": [("struct-end", "struct-start")],
    "sections": [("sections",)],
    "in-out": [("any",)],
    "block-end": [("block-end",)],
    "composite-start": [("array-start",), ("struct-start", "struct-end-absolute")],
    "array-end": [("array-end",)],
    "string-stride": [("string-stride",)],
    "bit-rows": [("bit-rows",)],
}
"""Rule -> the switches of ``rulebook`` that contradict it; a structure may also be even in itself at an odd byte."""


def failing(*off):
    """Compiled blocks whose length or start values come out wrong without some rules."""
    book = Rulebook(*off)
    wrong = set()
    for name, case in cases().items():
        size, places = book.block(case)
        anchors = case.get("anchors", ())
        if size != case["size"] or any(places.get(anchor["path"]) != anchor["offset"] for anchor in anchors):
            wrong.add(name)
    return {name for name in wrong if name.startswith("c")}


def test_the_independent_calculator_agrees_with_every_vector():
    assert failing() == set()


@pytest.mark.parametrize("key", RULES)
def test_a_compiled_rule_names_the_blocks_that_need_it_and_a_literature_rule_has_none(key):
    """A rule is compiled if some vector contradicts its opposite; the vectors listed are exactly those."""
    found = set().union(*(failing(*off) for off in WITHOUT[key]))
    assert found == set(RULES[key].vectors)
    assert bool(found) is (RULES[key].evidence == COMPILED)


def test_every_doubt_has_a_sentence():
    """Sizes of types give their number of bytes; the widths are those of the table of types."""
    assert rule("LREAL").text == "LREAL takes 8 bytes"
    assert rule("WSTRING").text == "WSTRING[n] takes 2n + 4 bytes"
    assert rule("TON_TIME").text.startswith("TON_TIME has the members")
    assert {rule(key).evidence for key in SIZES} == {"literature"}
    assert SIZES - {"WSTRING"} <= set(ELEMENTARY)


@pytest.mark.parametrize(
    ("declarations", "path", "doubts"),
    [
        (["b : BYTE", "a : ARRAY[1..10] OF BYTE"], "a", {"composite-start"}),
        (["b : BYTE", "a : ARRAY[1..10] OF BYTE", "w : WORD"], "w", set()),  # 11 or 12: even is 12
        (["b : BYTE", "a : ARRAY[1..9] OF BYTE", "w : WORD"], "w", {"composite-start", "array-end"}),  # 10 or 12
        (["a : ARRAY[1..3] OF BYTE", "b : BYTE", "w : WORD"], "b", {"array-end"}),  # 3 or 4
        (["a : ARRAY[1..3] OF BYTE", "b : BYTE", "w : WORD"], "w", {"array-end"}),  # 4 or 6
        (["a : ARRAY[1..3] OF BYTE", "b : BYTE", "c : BYTE", "w : WORD"], "w", set()),  # 5 -> 6 or 6
        (["a : ARRAY[1..10] OF BOOL", "x : BOOL"], "x", set()),  # whole byte, and that is even
        (["a : ARRAY[1..3] OF BOOL", "x : BOOL"], "x", {"array-end"}),  # byte 1 or 2
        (["a : ARRAY[0..1] OF ARRAY[1..3] OF BYTE"], "a[1]", {"array-end"}),  # 3 or 4
        (["a : ARRAY[0..1] OF ARRAY[1..4] OF BYTE"], "a[1]", set()),
        (["a : ARRAY[1..2,1..3] OF BYTE", "l : LREAL", "b : BYTE"], "b", {"LREAL"}),
        (["s : WSTRING[1]", "b : BYTE"], "b", {"WSTRING"}),
        (["t : TON_TIME", "b : BYTE"], "b", {"TON_TIME"}),
        (["a : ARRAY[1..2] OF STRING[3]", "b : BYTE"], "b", {"string-stride"}),
        (["a : ARRAY[1..2,1..3] OF BOOL", "b : BOOL"], "a[2,1]", {"bit-rows"}),
    ],
)
def test_a_place_names_the_rules_it_rests_on(declarations, path, doubts):
    """The alternatives worked out by hand stand beside each case, in bytes."""
    assert doubts == locate(layout_block(db(*declarations), {}), path).doubts


@pytest.mark.parametrize("last", [7, 8, 13])
def test_bits_that_would_begin_in_the_middle_of_a_byte(last):
    """By the manual x at 0.0, a from 2.0 on, b at 4.0; without it a could follow at 0.1 and b at 2.0."""
    inside = named([{"type": "BOOL"}, {"type": f"ARRAY[0..{last}] OF BOOL"}])
    built, types = block(
        {"id": "bits", "kind": "GlobalDB", "members": named([{"type": "STRUCT", "members": inside}, {"type": "BOOL"}])}
    )
    place = locate(layout_block(built, types), "m1")
    assert place.offset == 32
    assert "composite-start" in place.doubts


plain_types = st.sampled_from(
    ["BOOL", "BYTE", "CHAR", "WORD", "INT", "DWORD", "REAL", "DATE_AND_TIME", "ANY", "STRING[3]", "STRING[4]"]
) | st.builds(
    lambda low, size, type_: f"ARRAY[{low}..{low + size}] OF {type_}",
    st.integers(-2, 2),
    st.integers(0, 17),
    st.sampled_from(["BOOL", "BYTE", "WORD", "REAL", "STRING[3]"]),
)
nested = st.recursive(
    plain_types.map(lambda text: {"type": text}),
    lambda inner: st.lists(inner, min_size=1, max_size=4).map(lambda ms: {"type": "STRUCT", "members": named(ms)}),
    max_leaves=8,
)


def named(members):
    return [{**member, "name": f"m{n}"} for n, member in enumerate(members)]


@pytest.mark.slow
@given(st.lists(nested, min_size=1, max_size=8))
def test_any_declaration_lies_where_the_independent_calculator_puts_it(members):
    """Two calculators written apart; every leaf and the length."""
    case = {"id": "any", "kind": "GlobalDB", "members": named(members)}
    built, types = block(case)
    layout = layout_block(built, types)
    size, places = Rulebook().block(case)
    assert size == layout.size
    for entry in leaves(layout):
        assert places[entry.path] == entry.offset


@pytest.mark.slow
@given(st.lists(nested, min_size=1, max_size=8))
def test_a_place_without_doubts_needs_no_literature_rule(members):
    """Switch both rules of arrays and structures off: a confirmed member stays where it is."""
    case = {"id": "any", "kind": "GlobalDB", "members": named(members)}
    built, types = block(case)
    layout = layout_block(built, types)
    start = ("array-start", "struct-start")
    for off in (start, ("array-end",), (*start, "array-end"), ("string-stride",)):
        _, places = Rulebook(*off).block(case)
        for entry in leaves(layout):
            if entry.confirmed:
                assert places[entry.path] == entry.offset, (off, entry.path)
