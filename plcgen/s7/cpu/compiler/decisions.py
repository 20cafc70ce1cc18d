"""Conditions of several operands, for coverage: all operands are looked at, and what they were is kept."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from plcgen.s7.cpu.compiler.context import Context, Listing
from plcgen.s7.cpu.compiler.values import Expressions, Val
from plcgen.s7.cpu.linkage import Decision
from plcgen.s7.scl import ast
from plcgen.s7.scl.logic import DECIDES, MOST, Joined, Leaf, Logic, joints, logic_of, operands_of

_HARD = re.compile(r"\b(?:power|Z)\(")
"""Code that takes long, or lets another OB run: only where the operands before ask for it."""


@dataclass(slots=True, eq=False)
class Decisions:
    """Binary and unary operators, of which the outermost AND, OR, XOR and NOT are kept in a table.

    ``plain`` compiles an operator; ``inside`` are the nodes of the condition that is being compiled.
    """

    context: Context
    out: Listing
    expressions: Expressions
    plain: dict[type[ast.Expression], Callable[[Any], Val]]
    inside: set[int] = field(default_factory=set)

    def value(self, node: ast.Binary | ast.Unary) -> Val:
        """Compile an operator."""
        operands = [] if id(node) in self.inside else operands_of(node)
        if not 1 < len(operands) <= MOST:
            return self.plain[type(node)](node)
        wanted = {id(operand) for operand in operands}
        shown: dict[int, Val] = {}

        pending = self.context.pending

        def watch(operand: ast.Expression, value: Val) -> None:
            if id(operand) in wanted and id(operand) not in shown:
                shown[id(operand)] = value
                pending.append(value)

        around = self.inside, self.expressions.watch
        self.inside, self.expressions.watch = joints(node), watch
        before = len(pending)
        whole = self.plain[type(node)](node)
        del pending[before:]
        self.inside, self.expressions.watch = around
        found = [shown[id(operand)] for operand in operands]
        boolean = whole.type == "BOOL" and all(each.type == "BOOL" and each.pure for each in found)
        return Val(self.code(logic_of(node), operands, found), "BOOL", pure=whole.pure) if boolean else whole

    def code(self, logic: Logic, operands: list[ast.Expression], found: list[Val]) -> str:
        """Look the outcome up by the negated values."""
        counter, decisions = self.context.counter, self.context.link.decisions
        rows = [(counter(operand, DECIDES[True]), counter(operand, DECIDES[False])) for operand in operands]
        decisions.append(Decision(logic, tuple(rows)))
        hard = [_HARD.search(each.code) is not None for each in found]
        names: list[str] = []
        parts = []
        for number, each in enumerate(found):
            code, asked = f"not {each.code}", _asked(logic, number, names) if hard[number] else []
            if any(hard[number + 1 :]):
                names.append(self.out.temporary())
                code = f"({names[-1]}:={code})"
            if asked:
                code = f"({code} if {' and '.join(asked)} else None)"
            parts.append(code)
        return f"D[{len(decisions) - 1}][{','.join(parts)}]"


def _asked(logic: Logic, number: int, names: list[str]) -> list[str]:
    """Conditions under which an operand is looked at: what stands before it lets it through."""
    found: list[str] = []
    while isinstance(logic, Joined):
        if len(logic.sides) == 2 and number > _last(logic.sides[0]):
            if logic.operator != "XOR":
                before = _shown(logic.sides[0], names)
                found.append(before if logic.operator == "AND" else f"not {before}")
            logic = logic.sides[1]
        else:
            logic = logic.sides[0]
    return found


def _last(logic: Logic) -> int:
    """Number of the last operand."""
    while isinstance(logic, Joined):
        logic = logic.sides[-1]
    return logic.number


def _shown(logic: Logic, names: list[str]) -> str:
    """Code of a condition over the names that hold its negated operands."""
    if isinstance(logic, Leaf):
        return f"(not {names[logic.number]})"
    sides = [_shown(side, names) for side in logic.sides]
    word = {"AND": " and ", "OR": " or ", "XOR": "!="}.get(logic.operator)
    return f"({word.join(sides)})" if word else f"(not {sides[0]})"
