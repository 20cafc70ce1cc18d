"""SIMATIC SD documents: what they say is what a source of the same block says, and what is wrong with them is told.

The constructs are those of public exports and of Siemens' own description of the format (docs/scl-sources.md).
"""

from __future__ import annotations

import time

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from plcgen.base.diagnostics import Severity
from plcgen.s7.compare import compare_sources
from plcgen.s7.read.blocks import read_sources
from plcgen.s7.read.files import read_files
from plcgen.s7.read.text import parse_source, read_source
from plcgen.s7.read.texts import parse_texts
from plcgen.s7.scl.dialect import Dialect
from plcgen.s7.types.blocks import BlockKind, SectionKind
from tests.s7.sd_documents import MOTOR, PAIRS, TEXTS


@pytest.mark.parametrize("what", PAIRS)
def test_a_document_says_what_the_source_says(tmp_path, what):
    """Nothing of a block is lost or added, in either direction, and there is nothing to complain about."""
    sides = []
    for name, text in zip(("a.s7dcl", "b.scl"), PAIRS[what], strict=True):
        (tmp_path / name).write_text(text, encoding="utf-8-sig")
        sides.append(read_sources([tmp_path / name]))
        assert sides[-1].diagnostics == []
    blocks = [[(each.block.kind, each.block.name) for each in side.blocks] for side in sides]
    assert blocks[0] == blocks[1] != []
    for old, new in (sides, sides[::-1]):
        assert [change.text for change in compare_sources(old, new)] == []


@pytest.mark.parametrize(
    ("what", "was", "becomes", "kind"),
    [
        ("data block", "heat", "heating", "member-renamed"),
        ("data block", '"TRUE"', '"FALSE"', "access-changed"),
        ("data block", '"FALSE"', '"TRUE"', "retain-changed"),
        ("start values behind the declarations", "s.a := -7", "s.a := -8", "start-value"),
        ("instance of a type of the same unit, with start values", "n := 5", "n := 6", "start-value"),
        ("array data block", "100", "99", "length-changed"),
        ("function block in one network", "n < #", "n > #", "code-changed"),
        ("function in two networks, one of comments", "#x / 2", "#x / 3", "code-changed"),
    ],
)
def test_a_change_of_a_document_is_a_change(tmp_path, what, was, becomes, kind):
    """What is read is not only the same by having been left out."""
    text = PAIRS[what][0]
    (tmp_path / "a.s7dcl").write_text(text.replace(was, becomes, 1), encoding="utf-8-sig")
    (tmp_path / "b.scl").write_text(PAIRS[what][1], encoding="utf-8-sig")
    changes = compare_sources(read_sources([tmp_path / "b.scl"]), read_sources([tmp_path / "a.s7dcl"]))
    assert kind in {change.kind for change in changes}


@pytest.fixture
def motor(tmp_path):
    """A block with a drawn network, with its texts beside it."""
    path = tmp_path / "Motor.s7dcl"
    path.write_text(MOTOR, encoding="utf-8-sig")
    (tmp_path / "Motor.s7res").write_text(TEXTS, encoding="utf-8-sig")
    return path


def test_texts_are_those_of_the_file_beside_the_document(motor):
    """In the language that the file names first where a text has it; ``NO`` is a text, not a truth value."""
    (block,), (note,) = read_source(motor)
    assert (block.title, block.comment, block.number) == ("Motor", "Runs: yes", 903)
    assert [member.comment for member in block.section(SectionKind.INPUT)] == ["NO", ""]
    assert (note.code, note.severity, note.span.line) == ("PG814", Severity.NOTE, 20)
    assert (block.code, block.attributes) == (None, {"VERSION": "0.1"})


def test_a_drawn_network_is_text_to_compare(motor):
    """Comments and layout do not count, an operand, a wire and the language of a network do; the line is told."""
    old = read_sources([motor])
    for was, becomes, shown in [
        ("in2 := 100", "in2 := 101", "in2 := 101"),
        ("END_RUNG wire#w1", "END_RUNG", ""),
        ("I_Contact", "Contact", "Contact( #on )"),
        ("SrcType := Int", "SrcType := DInt", "DInt"),
        ('S7_Language := "LAD"', 'S7_Language := "FBD"', ""),
        ("#v > 2", "#v > 3", "#v > 3"),
    ]:
        motor.write_text(MOTOR.replace(was, becomes, 1), encoding="utf-8-sig")
        (change,) = [c for c in compare_sources(old, read_sources([motor])) if c.kind == "code-changed"]
        assert shown in change.new
        assert change.new_span.line == MOTOR[: MOTOR.index(was)].count("\n") + 1 or not shown
    motor.write_text(MOTOR.replace("            Coil(", "// words\n  Coil("), encoding="utf-8-sig")
    assert compare_sources(old, read_sources([motor])) == []


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        ("", 0, ""),
        ("MultiLingualTexts:\n", 0, ""),
        ("Texts:\n  - id: A\n", 1, "a file of texts begins with MultiLingualTexts:"),
        ("MultiLingualTexts:\n  - name: A\n", 2, "a text is written as"),
        ("MultiLingualTexts:\n  - id: A\n    en-US: [a]\n", 2, "a text is written as"),
        ("MultiLingualTexts:\n  - A\n", 2, "a text is written as"),
        ("MultiLingualTexts:\n  - id: A\n    en-US: a: b: c\n", 3, ""),
        ("MultiLingualTexts:\n\t- id: A\n", 2, ""),
    ],
)
def test_broken_texts_cost_the_comments_only(text, line, message):
    """All of it is a warning with its place: the block is read all the same."""
    _, found = parse_texts(text, "A.s7res")
    assert all((one.code, one.severity) == ("PG804", Severity.WARNING) for one in found)
    assert not found if not line else found[0].span.line == line and message in found[0].message


@pytest.mark.parametrize(
    ("was", "becomes", "line", "message"),
    [
        ("        END_RUNG wire#w1\n", "", 39, "RUNG without END_RUNG"),
        ("        RUNG wire#powerrail\n            Contact", "            Contact", 37, "END_RUNG without RUNG"),
        ("Contact( #on )", "Contact( #on", 26, "the bracket is not closed"),
        ("Contact( #on )", "Contact #on )", 26, "the bracket was not opened"),
        ("    END_NETWORK\n    {", "    {", 43, "expected END_NETWORK"),
        ("    NETWORK\n        #run", "        #run", 44, "expected NETWORK"),
        ("#run := #v > 2;", "#run := ;", 45, "expected"),
        ("#run := #v > 2;", "END_IF;", 45, "END_IF without its beginning"),
        ('"903";', '"903"', 4, "expected ';' or '}'"),
        ("v : Int;", "v : Intt;", 13, "unknown type Intt"),
    ],
)
def test_what_is_wrong_is_told_at_its_place(motor, was, becomes, line, message):
    """One message, with the line; what follows is read."""
    assert MOTOR.count(was) >= 1
    motor.write_text(MOTOR.replace(was, becomes, 1), encoding="utf-8-sig")
    _, found = read_source(motor, Dialect.TIA_1200_1500)
    errors = [(one.span.line, one.message) for one in found if one.severity is Severity.ERROR]
    assert len(errors) == 1
    assert message in errors[0][1]
    assert errors[0][0] == line


@pytest.mark.parametrize("target", [Dialect.STEP7_V5, Dialect.TIA_300_400])
def test_documents_are_of_s7_1200_and_1500(motor, target):
    """Siemens names no other CPU for them."""
    assert "PG803" in {one.code for one in read_source(motor, target)[1]}


def test_texts_alone_are_no_document(motor):
    """The message says which file to name."""
    _, (found,) = read_source(motor.with_suffix(".s7res"))
    assert (found.code, "Motor.s7dcl" in found.help) == ("PG804", True)


def test_of_source_and_documents_the_source_counts_and_keeps_the_number(motor):
    """In the order source, SIMATIC SD, SimaticML, whatever is read first; no word about it."""
    source = 'FUNCTION_BLOCK "Motor"\nVAR\n  only : Int;\nEND_VAR\nBEGIN\nEND_FUNCTION_BLOCK\n'
    motor.with_name("a.scl").write_text(source)
    files = read_files([motor.parent])
    assert [(b.number, [m.name for m in b.members]) for b in files.blocks] == [(903, ["only"])]
    assert not [one for one in files.diagnostics if one.code == "PG805"]


def test_a_safety_block_is_one(motor):
    """So that convert leaves it out, as one of SimaticML."""
    motor.write_text(MOTOR.replace("S7_Optimized", 'S7_Safety := "True";\n    S7_Optimized', 1), encoding="utf-8-sig")
    assert read_source(motor)[0][0].safety


PIECES = ["", "{", "}", "NETWORK", "END_NETWORK", "RUNG", "_.", '"', "()"]


@given(st.data())
@settings(max_examples=150, deadline=None, suppress_health_check=list(HealthCheck))
def test_damaged_documents_are_read_without_a_crash(data):
    """Pieces cut out, doubled and exchanged: diagnostics, all of them inside of the file."""
    text = data.draw(st.sampled_from([MOTOR, *(pair[0] for pair in PAIRS.values())]))
    for _ in range(data.draw(st.integers(1, 4))):
        begin, end = sorted(data.draw(st.tuples(st.integers(0, len(text)), st.integers(0, len(text)))))
        piece = data.draw(
            st.sampled_from(["", "{", "}", "NETWORK", "END_NETWORK", "RUNG", "_.", '"', "()", text[begin:end] * 2])
        )
        text = text[:begin] + piece + text[min(end, begin + data.draw(st.integers(0, 40))) :]
    found, problems = parse_source(text, "x.s7dcl", Dialect.TIA_1200_1500)
    lines = text.count("\n") + 1
    assert all(1 <= one.span.line <= lines for one in problems)
    assert all(block.kind in BlockKind for block in found)


def test_a_long_document_takes_linear_time():
    """A megabyte of rungs, networks, attributes or names of the own unit: no door is quadratic."""
    for piece in ("RUNG ", "END_RUNG ", "( ", "_.a ", "{ a } ", "NETWORK END_NETWORK "):
        times = []
        for count in (20_000, 80_000):
            text = MOTOR.replace("        RUNG wire#powerrail\n", piece * count, 1)
            began = time.process_time()
            parse_source(text, "x.s7dcl")
            times.append(time.process_time() - began)
        assert times[1] < 10 * times[0] + 0.5, piece
