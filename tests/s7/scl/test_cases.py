"""Every case of ``cases/*.yaml``: source text on one side, tree or diagnostics on the other."""

from __future__ import annotations

import pytest

from plcgen.base.diagnostics import Severity
from plcgen.s7.read.text import parse_source
from plcgen.s7.scl import ast
from plcgen.s7.scl.dialect import Dialect
from plcgen.s7.scl.parser import parse
from tests.s7.scl import sexpr
from tests.s7.scl.support import assert_begins, load, short

DIALECTS = {"V5": Dialect.STEP7_V5, "T3": Dialect.TIA_300_400, "T15": Dialect.TIA_1200_1500}


def _code(text: str) -> ast.Body:
    result = parse(f"FUNCTION_BLOCK a\nBEGIN\n{text}\nEND_FUNCTION_BLOCK", "t.scl")
    assert [short(d) for d in result.diagnostics] == []
    return result.units[0].statements


@pytest.mark.parametrize(("text", "expected"), [pytest.param(c[1], c[2], id=c[0]) for c in load("expressions")])
def test_expression_becomes_the_tree(text: str, expected: str) -> None:
    """An expression has exactly the tree that precedence and the manual give it."""
    (statement,) = _code(f"r := {text};")
    assert isinstance(statement, ast.Assign)
    assert expected == sexpr.expression(statement.value)


@pytest.mark.parametrize(("text", "expected"), [pytest.param(c[1], c[2], id=c[0]) for c in load("statements")])
def test_statements_become_the_tree(text: str, expected: str) -> None:
    """Statements have exactly the expected tree and no diagnostics."""
    assert expected == sexpr.body(_code(text))


@pytest.mark.parametrize("case", [pytest.param(c, id=c["name"]) for c in load("idioms")])
def test_idioms_of_public_sources_are_read(case: dict) -> None:
    """What other people's sources contain is no error: without a target, and for the targets that have it."""
    frame = f'FUNCTION_BLOCK "a"\nVAR\n{case.get("vars", "")}\nEND_VAR\nBEGIN\n{case.get("code")}\nEND_FUNCTION_BLOCK'
    text = case.get("source", frame)
    for dialect in (None, *(DIALECTS[name] for name in case.get("targets", []))):
        _, diagnostics = parse_source(text, "t.scl", dialect)
        assert [short(d) for d in diagnostics if d.severity is Severity.ERROR] == []


@pytest.mark.parametrize("case", [pytest.param(c, id=c["name"]) for c in load("typos")])
def test_typical_mistakes_get_one_helpful_message_each(case: dict) -> None:
    """Place, message and help of what engineers mistype; no mistake causes a second message."""
    _, diagnostics = parse_source(case["source"], "t.scl")
    assert case["expected"] == [short(d) + (f" | {d.help}" if d.help else "") for d in diagnostics]


@pytest.mark.parametrize("case", [pytest.param(c, id=c["name"]) for c in load("errors")])
def test_errors_come_together_with_their_places(case: dict) -> None:
    """Every mistake of a file is reported once, at its line and column, and nothing else is."""
    dialect = Dialect(case["dialect"]) if "dialect" in case else None
    _, diagnostics = parse_source(case["source"], "t.scl", dialect)
    assert_begins(case["expected"], [short(d) for d in diagnostics])


@pytest.mark.parametrize("dialect", list(Dialect))
@pytest.mark.parametrize("case", [pytest.param(c, id=c["name"]) for c in load("dialects")])
def test_a_target_refuses_what_it_does_not_know(case: dict, dialect: Dialect) -> None:
    """PG803 names the construct for the targets that lack it; the others, and no target, accept it."""
    frame = f"FUNCTION_BLOCK a\nBEGIN\n{case.get('code')}\nEND_FUNCTION_BLOCK"
    text = case.get("source", frame)
    expected = []
    for line in case["refused"].get(dialect.value, []):
        place, _, what = line.partition(" ")
        expected.append(f"{place} PG803 {dialect.label} does not support {what}")
    assert_begins(expected, [short(d) for d in parse(text, "t.scl", dialect).diagnostics])
    assert parse(text, "t.scl").diagnostics == ()
