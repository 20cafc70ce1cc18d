"""Conditions of several operands, joined by AND, OR, XOR and NOT: which operand decides the outcome.

An operand decides if the outcome would be another one with the opposite of its value, all others as they are. Shown for
TRUE and for FALSE it is what masking MC/DC demands of a condition (Chilenski and Miller, 1994; DO-178C).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from plcgen.s7.scl import ast

MOST = 100
"""Operands of a condition that is looked at."""
JOINING = frozenset({"AND", "&", "OR", "XOR"})
DECIDES = {True: "decides TRUE", False: "decides FALSE"}
"""Kinds of probes: an operand with this value has decided."""
Value = bool | None
"""Of an operand that was not looked at nothing is known."""


@dataclass(frozen=True, slots=True)
class Leaf:
    """The ``number``-th operand of a condition, from 0 on."""

    number: int


@dataclass(frozen=True, slots=True)
class Joined:
    """``operator`` is AND, OR, XOR, or NOT with one side."""

    operator: str
    sides: tuple[Logic, ...]


Logic = Leaf | Joined


def decisions(node: ast.Node) -> Iterator[ast.Expression]:
    """Conditions of two operands or more in a node, those inside operands of others included."""
    inside: set[int] = set()
    for found in ast.walk(node):
        if (
            isinstance(found, ast.Binary | ast.Unary)
            and id(found) not in inside
            and 1 < len(operands_of(found)) <= MOST
        ):
            inside |= joints(found)
            yield found


def joints(node: ast.Expression) -> set[int]:
    """Identities of the nodes that join the operands of a condition."""
    found: set[int] = set()
    waiting = [node]
    while waiting:
        node = waiting.pop()
        if isinstance(node, ast.Unary) and node.operator == "NOT":
            waiting.append(node.operand)
        elif isinstance(node, ast.Binary) and node.operator in JOINING:
            waiting += (node.left, node.right)
        else:
            continue
        found.add(id(node))
    return found


def operands_of(node: ast.Expression) -> list[ast.Expression]:
    """Operands of a condition from left to right; the expression itself if it is none."""
    if isinstance(node, ast.Unary) and node.operator == "NOT":
        return operands_of(node.operand)
    spine: list[ast.Expression] = []
    while isinstance(node, ast.Binary) and node.operator in JOINING:
        spine.append(node.right)
        node = node.left
    if not spine:
        return [node]
    return [*operands_of(node), *(leaf for right in reversed(spine) for leaf in operands_of(right))]


def logic_of(node: ast.Expression, first: int = 0) -> Logic:
    """How the operands of a condition are joined; ``first`` is the number of the first one."""
    if isinstance(node, ast.Unary) and node.operator == "NOT":
        return Joined("NOT", (logic_of(node.operand, first),))
    if not isinstance(node, ast.Binary) or node.operator not in JOINING:
        return Leaf(first)
    left = logic_of(node.left, first)
    right = logic_of(node.right, first + len(operands_of(node.left)))
    return Joined("AND" if node.operator == "&" else node.operator, (left, right))


def outcome(logic: Logic, values: Sequence[Value]) -> Value:
    """What a condition is; None if what is not known matters."""
    if isinstance(logic, Leaf):
        return values[logic.number]
    found = [outcome(side, values) for side in logic.sides]
    if logic.operator in {"AND", "OR"}:
        strong = logic.operator == "OR"
        return strong if strong in found else None if None in found else not strong
    if None in found:
        return None
    return not found[0] if logic.operator == "NOT" else found[0] is not found[1]


def deciding(logic: Logic, values: Sequence[Value]) -> Iterator[int]:
    """Numbers of the operands that decide: on their way up nothing else does."""
    if isinstance(logic, Leaf):
        if values[logic.number] is not None:
            yield logic.number
        return
    for side in logic.sides:
        others = [outcome(other, values) for other in logic.sides if other is not side]
        if None not in others and not (logic.operator in {"AND", "OR"} and others == [logic.operator == "OR"]):
            yield from deciding(side, values)


def demands(node: ast.Expression) -> Iterator[tuple[ast.Expression, list[tuple[ast.Expression, bool]]]]:
    """Every operand of a condition with what all the others must be for it to decide."""
    if isinstance(node, ast.Unary) and node.operator == "NOT":
        yield from demands(node.operand)
    elif isinstance(node, ast.Binary) and node.operator in JOINING:
        for side, other in ((node.left, node.right), (node.right, node.left)):
            more = [] if node.operator == "XOR" else [(other, node.operator != "OR")]
            yield from ((leaf, [*more, *known]) for leaf, known in demands(side))
    else:
        yield node, []
