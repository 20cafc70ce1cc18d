"""What expressions of a block may be, and what holds where a condition is true or false."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from plcgen.proof.values import ANYTHING, FALSE, TRUE, Env, Values, calculated, either, narrowed
from plcgen.s7.scl import ast
from plcgen.s7.scl.constants import evaluate

MIRRORED = {"<": ">", ">": "<", "<=": ">=", ">=": "<=", "=": "=", "<>": "<>"}
OPPOSITE = {"<": ">=", ">=": "<", ">": "<=", "<=": ">", "=": "<>", "<>": "="}
ELEMENT = "[]"
"""Behind the name of an array: the element that the conditions around a place look at."""
STATE = "statState"
"""The variable that every generated block keeps its state in: what belongs to a state is told apart by it."""
WORK_SECTIONS = frozenset({"VAR", "VAR_TEMP"})


@dataclass(frozen=True, slots=True)
class Premise:
    """Something that holds for this project for a reason that does not stand in the block.

    Either nothing assigns the constant ``never``, or ``variable`` has one of ``values`` whenever it is looked at, both
    while the variable ``given`` has one of the values ``among``, and always without ``given``. Or the names ``follow``,
    which otherwise may be anything, are what the block makes of them.
    """

    reason: str
    never: str = ""
    variable: str = ""
    values: frozenset[int] = frozenset()
    given: str = STATE
    among: frozenset[int] = frozenset()
    follow: tuple[str, ...] = ()


class Names:
    """The names of a block: constants, variables that nothing but its own code can change, and what premises say.

    ``opened`` are names that may be anything.
    """

    def __init__(self, unit: ast.Unit, premises: Sequence[Premise], opened: set[str]) -> None:
        self.unit, self.state = unit, STATE.upper()
        self.never = {premise.never.upper(): premise for premise in premises if premise.never}
        self.held = [premise for premise in premises if premise.variable]
        self.arrays = {premise.variable.upper() for premise in self.held}
        self.elements = {name + ELEMENT for name in self.arrays}
        self.given = {premise.given.upper() for premise in premises} | {self.state}
        self.constants: dict[str, int] = {}
        self.locals: set[str] = set()
        self.statics: Env = {}
        """Start values of the variables that keep theirs from call to call."""
        for section in unit.sections:
            self.declare(section, opened)

    def declare(self, section: ast.Section, opened: set[str]) -> None:
        """Take in a section of declarations."""
        constant = section.keyword == "CONST" or "CONSTANT" in section.modifiers
        views = {entry.at.upper() for entry in section.declarations if entry.at}
        for entry in section.declarations:
            value = evaluate(entry.initial, self.constants) if entry.initial is not None else 0
            for name in {declared.name.upper() for declared in entry.names} - opened:
                if constant and value is not None:
                    self.constants[name] = value
                elif section.keyword in WORK_SECTIONS and not constant and entry.at is None and name not in views:
                    self.locals.add(name)
                    if section.keyword == "VAR" and value is not None:
                        self.statics[name] = frozenset({value})

    def forbidden(self, statements: ast.Body, env: Env) -> bool:
        """Whether one of the statements assigns what a premise excludes."""
        for node in statements if self.never else ():
            value = node.value if isinstance(node, ast.Assign) else None
            premise = self.never.get(value.name.upper()) if isinstance(value, ast.Name) else None
            if premise is not None and (not premise.among or self.applies(premise, env)):
                return True
        return False

    def compared(self) -> dict[str, set[int]]:
        """Constants that variables are compared with, and their neighbours: where a counter may stop counting."""
        found: dict[str, set[int]] = {}
        for node in ast.walk(self.unit):
            if isinstance(node, ast.Binary) and node.operator in OPPOSITE:
                for one, other in ((node.left, node.right), (node.right, node.left)):
                    value = evaluate(other, self.constants) if isinstance(one, ast.Name) else None
                    if isinstance(one, ast.Name) and value is not None:
                        found.setdefault(one.name.upper(), set()).update((value - 1, value, value + 1))
        return found

    def value(self, node: ast.Expression, env: Env) -> Values:
        """What an expression may be."""
        if isinstance(node, ast.Literal) and node.kind == "bool":
            return TRUE if node.text.upper() == "TRUE" else FALSE
        if isinstance(node, ast.Literal):
            constant = evaluate(node, {})
            return ANYTHING if constant is None else frozenset({constant})
        if isinstance(node, ast.Name | ast.Index):
            return self.held_or(node, env)
        if isinstance(node, ast.Member):
            path = _path(node)
            return next((p.values for p in self.held if p.variable.upper() == path and self.applies(p, env)), ANYTHING)
        if isinstance(node, ast.Unary) and node.operator == "-":
            return calculated("-", FALSE, self.value(node.operand, env))
        if isinstance(node, ast.Binary) and node.operator in {"+", "-", "*"}:
            return calculated(node.operator, self.value(node.left, env), self.value(node.right, env))
        if isinstance(node, ast.Binary | ast.Unary):
            true, false = self.split(node, env)
            if true is None or false is None:
                return FALSE if true is None else TRUE
        return ANYTHING

    def held_or(self, node: ast.Name | ast.Index, env: Env) -> Values:
        """A constant, a variable of the block, or what a premise says about a variable or array in this state."""
        base = node.base if isinstance(node, ast.Index) else node
        if not isinstance(base, ast.Name) or base.scope == "quoted":
            return ANYTHING
        name = base.name.upper()
        if name in self.constants:
            return frozenset({self.constants[name]})
        known = env.get(name if isinstance(node, ast.Name) else name + ELEMENT, ANYTHING)
        for premise in self.held:
            if premise.variable.upper() == name and self.applies(premise, env):
                return narrowed(premise.values, "=", known) or premise.values
        return known

    @staticmethod
    def applies(premise: Premise, env: Env) -> bool:
        """Whether the variable that a premise is about the states of can only have those."""
        if not premise.given:
            return True
        values = env.get(premise.given.upper(), ANYTHING)
        return isinstance(values, frozenset) and values <= premise.among

    def split(self, node: ast.Expression, env: Env) -> tuple[Env | None, Env | None]:
        """What may hold if a condition is true, and if it is false; None if it never is."""
        if isinstance(node, ast.Unary) and node.operator == "NOT":
            true, false = self.split(node.operand, env)
            return false, true
        if isinstance(node, ast.Binary) and node.operator in {"AND", "&", "OR"}:
            true, false = self.split(node.left, env)
            if node.operator == "OR":
                second = self.split(node.right, false) if false is not None else (None, None)
                return either(true, second[0]), second[1]
            second = self.split(node.right, true) if true is not None else (None, None)
            return second[0], either(false, second[1])
        if isinstance(node, ast.Binary) and node.operator in OPPOSITE:
            return self.compare(node.operator, node.left, node.right, env)
        if isinstance(node, ast.Name | ast.Literal):
            return self.compare("=", node, ast.Literal(0, 0, "TRUE", "bool"), env)
        return env, env

    def decides(
        self, operand: ast.Expression, others: Sequence[tuple[ast.Expression, bool]], env: Env, *, value: bool
    ) -> bool:
        """Whether an operand may have a value and decide with it: the others may let it through."""
        found: Env | None = env
        for one, wanted in ((operand, value), *others):
            found = None if found is None else self.split(one, found)[not wanted]
        return found is not None

    def compare(
        self, operator: str, left: ast.Expression, right: ast.Expression, env: Env
    ) -> tuple[Env | None, Env | None]:
        """A comparison narrows both sides."""
        one, two = self.value(left, env), self.value(right, env)
        return self.kept(operator, (left, one), (right, two), env), self.kept(
            OPPOSITE[operator], (left, one), (right, two), env
        )

    def kept(
        self, operator: str, left: tuple[ast.Expression, Values], right: tuple[ast.Expression, Values], env: Env
    ) -> Env | None:
        """The values for which a comparison may hold; None if for none."""
        one = self.narrow(left[0], narrowed(left[1], operator, right[1]), env)
        two = narrowed(right[1], MIRRORED[operator], left[1])
        return None if one is None else self.narrow(right[0], two, one)

    def narrow(self, node: ast.Expression, values: Values | None, env: Env) -> Env | None:
        """The environment in which an expression has these values; None if it has none."""
        base = node.base if isinstance(node, ast.Index) else node
        if values is None or not isinstance(base, ast.Name) or base.scope == "quoted":
            return None if values is None else env
        name = base.name.upper()
        if isinstance(node, ast.Index) and name in self.arrays:
            return {**env, name + ELEMENT: values}
        if name not in self.locals or isinstance(node, ast.Index) or values == env.get(name, ANYTHING):
            return env
        return {**env, name: values}


def _path(node: ast.Expression) -> str:
    """A member of a structure or of an instance as it is written, in upper case; empty for anything else."""
    if isinstance(node, ast.Member):
        base = _path(node.base)
        return f"{base}.{node.name.upper()}" if base else ""
    return node.name.upper() if isinstance(node, ast.Name) and node.scope != "quoted" else ""
