"""Faults that are seeded into sources: each one is something that no compiler of STEP 7 takes, wherever it stands.

What may go unnoticed is left out: a deleted sign or NOT, another constant, another variable of the same type.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from plcgen.s7.scl import ast
from plcgen.s7.scl.parser import ParseResult
from plcgen.s7.types.data_types import elementary

TOKEN, TYPE = "token", "type"
_DELETED = frozenset("THEN DO OF END_IF END_FOR END_CASE END_WHILE UNTIL END_REPEAT ) ]".split())
_NUMBERS = frozenset({"SINT", "INT", "DINT", "USINT", "UINT", "UDINT", "REAL"})
_UNKNOWN = "plcgen_unknown"


@dataclass(frozen=True, slots=True)
class Fault:
    """Text between two offsets that is replaced; ``kind`` is token or type, ``name`` says what was done."""

    kind: str
    name: str
    start: int
    end: int
    text: str

    def applied(self, source: str) -> str:
        """The source with the fault in it."""
        return source[: self.start] + self.text + source[self.end :]


def faults(result: ParseResult, count: int, seed: str) -> list[Fault]:
    """At most ``count`` faults of each kind; the same for the same ``seed``."""
    chosen: list[Fault] = []
    chance = random.Random(seed)  # a sample, no secret
    for found in (list(_tokens(result)), list(_types(result))):
        chosen += chance.sample(found, min(count, len(found)))
    return chosen


def _tokens(result: ParseResult) -> Iterator[Fault]:
    """Deleted words and brackets, and assignments that lost their colon."""
    tokens = result.tokens
    for unit in result.units:
        begin, stop = unit.code
        if unit.keyword in {"DATA_BLOCK", "TYPE"} or not unit.statements:
            continue
        for index, kind in enumerate(tokens.kinds):
            start, end = tokens.starts[index], tokens.end(index)
            if not begin <= start < stop:
                continue
            if kind in _DELETED:
                yield Fault(TOKEN, f"{kind} deleted", start, end, " ")
    for node in _nodes(result):
        if isinstance(node, ast.Assign) and node.operator == ":=" and not node.also:
            at = tokens.source.find(":=", node.target.end, node.value.start)
            if at >= 0:
                yield Fault(TOKEN, ":= without its colon", at, at + 2, "= ")


def _types(result: ParseResult) -> Iterator[Fault]:
    """Values of another type, names that nobody declared, indices of what is no array."""
    for unit in result.units:
        if unit.keyword in {"DATA_BLOCK", "TYPE"}:
            continue
        declared = _declared(unit)
        for node in (inner for statement in unit.statements for inner in ast.walk(statement)):
            if isinstance(node, ast.IfBranch):
                yield Fault(TYPE, "a REAL as a condition", node.condition.start, node.condition.end, "2.5")
            if not isinstance(node, ast.Assign) or node.operator != ":=" or node.also:
                continue
            target = node.target
            if not isinstance(target, ast.Name) or target.scope == "quoted":
                continue
            type_ = declared.get(target.name.upper(), "")
            mark = "#" if target.scope == "local" else ""
            if type_ in _NUMBERS:
                yield Fault(TYPE, f"a text for {type_}", node.value.start, node.value.end, "'abc'")
                yield Fault(TYPE, f"TRUE for {type_}", node.value.start, node.value.end, "TRUE AND FALSE")
                yield Fault(TYPE, f"an index of {type_}", target.end, target.end, "[1]")
                yield Fault(TYPE, f"a member of {type_}", target.end, target.end, f".{_UNKNOWN}")
            if type_ == "BOOL":
                yield Fault(TYPE, "a REAL for BOOL", node.value.start, node.value.end, "2.5")
                yield Fault(TYPE, "a TIME for BOOL", node.value.start, node.value.end, "T#5s")
            if type_ == "INT":
                yield Fault(TYPE, "70000 for INT", node.value.start, node.value.end, "70000")
            if type_:
                yield Fault(TYPE, "an unknown variable", node.value.start, node.value.end, f"{mark}{_UNKNOWN}")
                yield Fault(TYPE, "an unknown function", node.value.start, node.value.end, f"{_UNKNOWN}(1)")


def _nodes(result: ParseResult) -> Iterator[ast.Node]:
    code = (unit for unit in result.units if unit.keyword not in {"DATA_BLOCK", "TYPE"})
    return (node for unit in code for statement in unit.statements for node in ast.walk(statement))


def _declared(unit: ast.Unit) -> dict[str, str]:
    """Upper-case names of the variables of a block with elementary types; inputs are left out, and what has views."""
    viewed = {d.at.strip('"#').upper() for s in unit.sections for d in s.declarations if d.at is not None}
    found: dict[str, str] = {}
    for section in unit.sections:
        if section.keyword == "VAR_INPUT" or "CONSTANT" in section.modifiers:
            continue
        for declaration in section.declarations:
            spec = declaration.type
            type_ = elementary(spec.name) if isinstance(spec, ast.TypeName) and not spec.quoted else None
            if type_ is not None and declaration.at is None:
                found.update((name.name.upper(), type_.name) for name in declaration.names)
    return {name: type_ for name, type_ in found.items() if name not in viewed}


Check = Callable[[str], frozenset[tuple[str, str]]]
"""What is wrong with a source, as pairs of a code and a message."""


def found(source: str, fault: Fault, before: frozenset[tuple[str, str]], check: Check) -> bool:
    """Whether a fault brings a message that was not there before."""
    return bool(check(fault.applied(source)) - before)
