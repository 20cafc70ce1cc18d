"""Start values of documents: what is accepted at a glance is what is accepted after a close look."""

from __future__ import annotations

import time

import pytest
from hypothesis import given
from hypothesis import strategies as st

from plcgen.base.diagnostics import DiagnosticError
from plcgen.s7.layout.layout import layout_block
from plcgen.s7.layout.shapes import TypeTable
from plcgen.s7.scl.lexer import tokenize
from plcgen.s7.types.blocks import Block, BlockKind, Section, SectionKind
from plcgen.s7.types.data_types import ELEMENTARY, Member, NamedType, StringType
from plcgen.s7.types.literals import parse_literal
from plcgen.s7.xml.reading import types


@pytest.mark.parametrize("name", sorted(types._SURE))
@given(st.data())
def test_what_surely_fits_is_a_literal_of_the_type(name, data):
    """Every text that the pattern of a type takes is a constant of it: STEP 7 would take it as well."""
    text = data.draw(st.from_regex(types._surely_fitting(name), fullmatch=True))
    parse_literal(text, StringType("STRING", 254) if name == "STRING" else ELEMENTARY[name])


@given(st.from_regex(types._PLAIN_TEXT, fullmatch=True))
def test_a_plain_text_is_one_token(text):
    """Nothing in it ends the text, and no comment begins behind it."""
    tokens = tokenize(text, "")
    assert (tokens.kinds[0], tokens.texts[0], len(tokens.kinds)) == ("string", text, 2)


@pytest.mark.parametrize(("text", "length", "fits"), [("'abc'", 3, True), ("'abcd'", 3, False), ("''", 1, True)])
def test_a_text_must_not_be_longer_than_its_string(text, length, fits):
    """The length counts characters between the quotes (S7-1200 manual, String)."""
    assert (types.unfit(text, StringType("STRING", length)) == "") == fits


def test_many_unknown_types_take_linear_time():
    """An export without its types asks for each of them: the list of what there is instead is made once."""
    times = []
    for count in (100, 800):
        types = TypeTable.of({f"TYPE{n}": Block(BlockKind.UDT, f"Type{n}", ()) for n in range(count)})
        began = time.process_time()
        for number in range(count):
            member = Member("m", NamedType(f"Other{number}", quoted=True))
            with pytest.raises(DiagnosticError, match="unknown data type"):
                layout_block(Block(BlockKind.UDT, f"U{number}", (Section(SectionKind.STATIC, (member,)),)), types)
        times.append(time.process_time() - began)
    assert times[1] < 8 * times[0] * 2
