"""Whole sources, bounds, and text that nobody would write."""

from __future__ import annotations

import sys

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from plcgen.s7.read.text import parse_source
from plcgen.s7.scl import ast, parser
from plcgen.s7.scl.cursor import MAX_ERRORS, MAX_NESTING
from plcgen.s7.scl.dialect import Dialect
from plcgen.s7.scl.parser import parse
from tests.s7.scl import sexpr
from tests.s7.scl.support import short, source

FB = "FUNCTION_BLOCK a\nBEGIN\n"
WORDS = st.sampled_from(
    """IF THEN ELSE END_IF CASE OF END_CASE FOR TO DO END_FOR REPEAT UNTIL END_REPEAT REGION END_REGION VAR VAR_INPUT
    END_VAR STRUCT END_STRUCT CONST END_CONST LABEL END_LABEL TYPE END_TYPE FUNCTION_BLOCK END_FUNCTION_BLOCK
    DATA_BLOCK END_DATA_BLOCK BEGIN ARRAY [ ] ( ) { } , ; : := => .. . + - NOT AND ** #x "y" z INT STRING 1 2.5 'a'
    T#1s P#M0.0 %DB1.DBX0.0 %X1 M1.1 (* *) // ' " # TITLE = VERSION AT GOTO ^ &""".split()
)


def test_the_job_for_step7_v5_is_read_and_accepted() -> None:
    """A complete V5 source has no diagnostics for V5, and every statement is in the tree."""
    result = parse(source("job_v5.scl"), "job_v5.scl", Dialect.STEP7_V5)
    assert [short(d) for d in result.diagnostics] == []
    block, function = result.units
    assert [s.keyword for s in block.sections] == [
        "CONST", "VAR_INPUT", "VAR_OUTPUT", "VAR", "VAR_TEMP", "LABEL",
    ]  # fmt: skip
    texts = [sexpr.statement(s) for s in block.statements]
    assert texts[0] == (
        "(if ((NOT execute) (:= done FALSE) (:= error FALSE) (:= edge FALSE) (if ((= state IDLE) (goto finish)))))"
    )
    assert texts[2:] == ["(label finish)", "(:= OK (NOT error))"]
    case = block.statements[1]
    assert isinstance(case, ast.Case)
    assert [sexpr.expression(b.labels[0].low) for b in case.branches] == ["IDLE", "WRITING", "READING"]
    assert sexpr.statement(case.branches[1].body[0]) == (
        "(call (. SFB53 DB53) (REQ := FALSE) (ID := id) (INDEX := 47) (LEN := 10) (RECORD := P#DB3.DBX0.0 BYTE 10))"
    )
    assert sexpr.body(function.statements) == ('(call (. "Read drive" DB471) (execute := go) (id := DW#16#100))')


def test_the_job_for_s7_1500_is_read_and_accepted() -> None:
    """A complete T15 source has no diagnostics for T15; REGION across CASE labels keeps its title."""
    result = parse(source("job_t15.scl"), "job_t15.scl", Dialect.TIA_1200_1500)
    assert [short(d) for d in result.diagnostics] == []
    udt, block, main = result.units
    assert (udt.keyword, block.comment, main.name) == ("TYPE", "One job at a time\nper drive", "Main")
    region, case = block.statements
    assert isinstance(region, ast.Region)
    assert isinstance(case, ast.Case)
    assert region.title == "Start // it's free text"
    assert case.branches[0].regions == ("running",)
    assert sexpr.statement(case.branches[0].body[0]) == (
        "(call #wr (REQ := TRUE) (ID := #hwId) (INDEX := 47) (LEN := 10) (DONE => #done) (RECORD := #request))"
    )
    assert sexpr.body(case.branches[1].body[1:]) == (
        "(:= (. ([] (. #result errors) 1) index) (* (call BYTE_TO_UINT ([] #answer #i)) 256))"
        " (:= (slice (. #result status) X31) (<> (slice (. #rd STATUS) B3) 16#DE))"
    )
    assert sexpr.body(main.statements) == (
        '(call "ReadParameters_DB" (execute := (:P "start")) (hwId := 270) (result := ([] (. "results" drive) 1)))'
    )


def test_each_job_is_refused_by_the_other_target() -> None:
    """The V5 source shows TIA's refusals and the other way round, all PG803."""
    for name, dialect in (("job_v5.scl", Dialect.TIA_1200_1500), ("job_t15.scl", Dialect.STEP7_V5)):
        codes = {d.code for d in parse(source(name), name, dialect).diagnostics}
        assert codes == {"PG803"}


def test_a_node_knows_its_place() -> None:
    """Spans of nodes are the text they came from."""
    result = parse(FB + "  x := y +\n z(1);\nEND_FUNCTION_BLOCK", "t.scl")
    (statement,) = result.units[0].statements
    assert isinstance(statement, ast.Assign)
    span = result.span(statement.value)
    assert (span.line, span.column, span.end_line, span.end_column) == (3, 8, 4, 6)


def test_parentheses_belong_to_the_place_of_what_they_hold() -> None:
    """The text of an operand or of a whole expression includes its parentheses."""
    result = parse(FB + "x := ((a + b) * (c));\nEND_FUNCTION_BLOCK", "t.scl")
    (statement,) = result.units[0].statements
    assert isinstance(statement, ast.Assign)
    value = statement.value
    assert isinstance(value, ast.Binary)
    texts = [result.tokens.source[n.start : n.end] for n in (value, value.left, value.right)]
    assert texts == ["((a + b) * (c))", "(a + b)", "(c)"]


def test_trees_that_say_the_same_are_equal() -> None:
    """Places take no part in comparisons."""
    one = parse(FB + "x:=1;END_FUNCTION_BLOCK", "t.scl").units
    two = parse(FB + "\n\n  x  :=  1 ; END_FUNCTION_BLOCK", "t.scl").units
    assert one == two


def test_an_open_statement_is_noted() -> None:
    """The diagnostic about a wrong END also points to the statement that is open."""
    (found,) = parse(FB + "IF x THEN\nEND_WHILE;\nEND_FUNCTION_BLOCK", "t.scl").diagnostics
    assert [(n.message, n.span.line, n.span.column) for n in found.notes] == [("this IF is open", 3, 1)]


@pytest.mark.parametrize(
    "text",
    [
        FB + "x := " + "(" * 5000,
        FB + "x := " + "NOT " * 5000,
        FB + "x := " + "f(" * 5000,
        FB + "x" + "[x" * 5000,
        FB + "IF a THEN " * 5000,
        FB + "CASE a OF 1: " * 5000,
        FB + "REGION a\n" * 5000,
        "TYPE a STRUCT " + "b : STRUCT " * 5000,
        "TYPE a STRUCT b : " + "ARRAY[0..1] OF " * 5000,
        "TYPE a STRUCT b : INT := " + "[" * 5000,
        FB + "x := " + "1+" * 5000 + "1;",
        FB + "x" + ".y" * 5000 + " := 1;",
    ],
)
def test_nesting_is_bounded(text: str) -> None:
    """Depth and chains beyond the limit give one PG802 and never a RecursionError."""
    limit = sys.getrecursionlimit()
    _, diagnostics = parse_source(text, "t.scl")
    assert [d.code for d in diagnostics] == ["PG802"]
    assert sys.getrecursionlimit() == limit


def test_nesting_up_to_the_limit_is_fine() -> None:
    """Code as deep as the limit allows is read, also for a target."""
    depth = MAX_NESTING - 1
    text = FB + "x := " + "(" * depth + "1" + ")" * depth + ";\nEND_FUNCTION_BLOCK"
    assert parse(text, "t.scl", Dialect.STEP7_V5).diagnostics == ()
    deeper = FB + "x := " + "(" * (depth + 1) + "1" + ")" * (depth + 1) + ";\nEND_FUNCTION_BLOCK"
    assert [d.code for d in parse(deeper, "t.scl").diagnostics] == ["PG802"]


def test_errors_do_not_add_up_to_nesting() -> None:
    """Statements that fail inside parentheses leave no depth behind."""
    found = parse(FB + "x := ((1;\n" * 80 + "END_FUNCTION_BLOCK", "t.scl").diagnostics
    assert [d.code for d in found] == ["PG801"] * 80


def test_a_call_may_have_many_arguments() -> None:
    """The bound on operators counts per argument of a call statement, not for all of them."""
    text = FB + "f(" + ", ".join(["a + b + c"] * 300) + ");\nEND_FUNCTION_BLOCK"
    assert parse(text, "t.scl").diagnostics == ()


def test_the_number_of_errors_is_bounded() -> None:
    """After so many errors the rest is not read, and that is said."""
    found = parse(FB + "x := ;\n" * 5000 + "END_FUNCTION_BLOCK", "t.scl").diagnostics
    assert len(found) == MAX_ERRORS + 1
    assert any(d.message.startswith("too many errors") for d in found)


def test_the_number_of_refusals_and_unknown_types_is_bounded() -> None:
    """PG803 and PG806 stop at the bound as well."""
    found = parse(FB + "#x := 1;\n" * 500 + "END_FUNCTION_BLOCK", "t.scl", Dialect.STEP7_V5).diagnostics
    assert len(found) == MAX_ERRORS
    members = "".join(f"m{i} : Unknown{i};\n" for i in range(500))
    _, diagnostics = parse_source(f"TYPE a STRUCT {members} END_STRUCT; END_TYPE", "t.scl", Dialect.TIA_1200_1500)
    assert len(diagnostics) == MAX_ERRORS


def test_a_source_that_is_too_large_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """PG802 for the file as a whole."""
    monkeypatch.setattr(parser, "MAX_CHARACTERS", 10)
    (found,) = parse("x" * 11, "t.scl").diagnostics
    assert (found.code, found.span.line) == ("PG802", 0)


def test_walk_visits_everything_in_source_order() -> None:
    """No node is missed, however it is nested."""
    unit = parse(FB + "IF a THEN b := c[1]; END_IF; d(e := 2);\nEND_FUNCTION_BLOCK", "t.scl").units[0]
    names = [n.name for n in ast.walk(unit) if isinstance(n, ast.Name)]
    literals = [n.text for n in ast.walk(unit) if isinstance(n, ast.Literal)]
    assert (names, literals) == (["a", "b", "c", "d"], ["1", "2"])


def survives(text: str, dialect: Dialect | None) -> None:
    """Units and diagnostics with places inside the text, never an exception."""
    blocks, diagnostics = parse_source(text, "t.scl", dialect)
    lines = len(text.splitlines()) + 1
    assert all(0 <= d.span.line <= lines for d in diagnostics)
    assert all(d.code.startswith("PG80") for d in diagnostics)
    assert len(blocks) < len(text) + 2


@settings(max_examples=300)
@given(st.lists(WORDS, max_size=80).map(" ".join), st.sampled_from([None, *Dialect]))
def test_any_sequence_of_words_is_survived(text: str, dialect: Dialect | None) -> None:
    """Words in any order are survived, behind the head of a block too."""
    for prefix in ("", FB, "DATA_BLOCK a STRUCT "):
        survives(prefix + text, dialect)


@settings(max_examples=200)
@given(st.text(max_size=200))
def test_any_text_is_survived(text: str) -> None:
    """Arbitrary Unicode is survived."""
    survives(text, Dialect.TIA_1200_1500)


@settings(max_examples=150)
@given(st.data())
def test_a_damaged_source_is_survived(data: st.DataObject) -> None:
    """A cut or a doubled piece anywhere in a good source is survived, whatever the dialect."""
    text = source(data.draw(st.sampled_from(["job_v5.scl", "job_t15.scl", "faq_buffers.db"])))
    start = data.draw(st.integers(0, len(text)))
    end = data.draw(st.integers(start, min(len(text), start + 60)))
    damaged = data.draw(st.sampled_from([text[:start] + text[end:], text[:end] + text[start:], text[:start]]))
    survives(damaged, data.draw(st.sampled_from(list(Dialect))))


def test_a_source_that_ends_anywhere_is_survived() -> None:
    """A source cut at any character is survived; the dot of a qualified CASE label is such a place."""
    text = 'FUNCTION "f" : VOID\nBEGIN\nCASE #s OF\n_.Unit.Mode#RUN, 2..3: "a".b[%ID(1):P].x := w.%X0;\nEND_CASE;\n'
    for end in range(len(text)):
        survives(text[:end], Dialect.TIA_1200_1500)


@pytest.mark.parametrize(
    ("dialect", "text", "tree"),
    [
        (None, "-a ** b", "(- (** a b))"),
        (Dialect.STEP7_V5, "-a ** b", "(- (** a b))"),
        (Dialect.TIA_300_400, "-a ** b", "(** (- a) b)"),
        (Dialect.TIA_1200_1500, "-a ** b * c", "(* (** (- a) b) c)"),
        (Dialect.TIA_1200_1500, "-(a ** b)", "(- (** a b))"),
        (Dialect.TIA_1200_1500, "2.0 ** -a", "(** 2.0 (- a))"),
        (Dialect.TIA_1200_1500, "NOT a = b", "(= (NOT a) b)"),
    ],
)
def test_a_sign_binds_more_tightly_than_a_power_in_tia(dialect: Dialect | None, text: str, tree: str) -> None:
    """Operator precedence of the TIA Portal: sign 2, power 3; of S7-SCL V5: power 2, sign 3."""
    result = parse(f"FUNCTION_BLOCK a\nBEGIN\nr := {text};\nEND_FUNCTION_BLOCK", "t.scl", dialect)
    (statement,) = result.units[0].statements
    assert isinstance(statement, ast.Assign)
    assert sexpr.expression(statement.value) == tree


@pytest.mark.parametrize(
    ("code", "help_"),
    [
        ("VAR w : SFB53; END_VAR\nBEGIN\n;", "{InstructionName := 'WRREC'; LibVersion := '1.1'} WRREC"),
        ("VAR w : SFB52; END_VAR\nBEGIN\n;", "{InstructionName := 'RDREC'; LibVersion := '1.0'} RDREC"),
        ("VAR w : SFB4; END_VAR\nBEGIN\n;", "name the instruction: TON"),
        ("VAR w : SFB2; END_VAR\nBEGIN\n;", "name the instruction: CTUD"),
        ("VAR w : SFB99; END_VAR\nBEGIN\n;", "name the instruction that replaces it"),
        ("BEGIN\n#n := SFC20(SRCBLK := #a, DSTBLK := #b);", "write BLKMOV(..)"),
        ("BEGIN\n#n := SFC64();", "write TIME_TCK(..)"),
        ("BEGIN\n#n := SFC199();", "write the name of the instruction"),
    ],
)
def test_a_system_block_by_number_is_named_by_its_instruction(code: str, help_: str) -> None:
    """Numbers of "System and Standard Functions for S7-300/400"; the TIA Portal for S7-1500 has names only."""
    (found,) = parse(f"FUNCTION_BLOCK a\n{code}\nEND_FUNCTION_BLOCK", "t.scl", Dialect.TIA_1200_1500).diagnostics
    assert found.code == "PG803"
    assert help_ in found.help


@pytest.mark.parametrize(
    ("number", "classic", "modern"),
    [
        ("SFC0", "SET_CLK", "WR_SYS_T"),
        ("SFC1", "READ_CLK", "RD_SYS_T"),
        ("SFC22", "CREAT_DB", "CREATE_DB"),
        ("SFC51", "RDSYSST", ""),
        ("SFC52", "WR_USMSG", ""),
        ("SFC20", "BLKMOV", "BLKMOV"),
    ],
)
def test_the_instruction_is_one_of_the_target(number: str, classic: str, modern: str) -> None:
    """Help of the TIA Portal: the S7-1200/1500 have other clocks, other data blocks and no system status list."""
    text = f"FUNCTION_BLOCK a\nBEGIN\n#n := {number}();\nEND_FUNCTION_BLOCK"
    for dialect, name in ((Dialect.TIA_300_400, classic), (Dialect.TIA_1200_1500, modern)):
        (found,) = parse(text, "t.scl", dialect).diagnostics
        assert found.help.startswith(f"write {name}(..)" if name else "there is none")
