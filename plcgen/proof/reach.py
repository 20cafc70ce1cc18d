"""Which statements and branches of a block can run at all: its tree is executed with sets of values.

A static variable begins with its start value and with whatever a call of the block may leave in it; inputs, arrays,
other blocks and what calls return may be anything. What is not reached then cannot run, whatever happens around the
block. What follows from time or from the line rather than from the program is a premise of the protocol's proof.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from math import inf
from typing import TypeAlias

from plcgen.scl import ast
from plcgen.scl.constants import evaluate

Values: TypeAlias = frozenset[int] | tuple[float, float]
"""A few integers (TRUE is 1), or everything from a lower to an upper end."""
Env: TypeAlias = dict[str, Values]
"""Values of local variables by upper-case name; a missing one may be anything."""
Place: TypeAlias = tuple[int, str]
"""Offset of a node and what about it: statement, branch, else, loop, pass."""

ANYTHING: Values = (-inf, inf)
FALSE, TRUE = frozenset({0}), frozenset({1})
MOST = 64
"""So many values are kept apart, so many passes of a loop are followed one by one."""
PATIENCE = 3
"""Passes over the block until a counter that still grows is taken to grow forever."""
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
    while the variable ``given`` has one of the values ``among``. Or the names ``follow``, which otherwise may be
    anything, are what the block makes of them.
    """

    reason: str
    never: str = ""
    variable: str = ""
    values: frozenset[int] = frozenset()
    given: str = STATE
    among: frozenset[int] = frozenset()
    follow: tuple[str, ...] = ()


def reachable(unit: ast.Unit, premises: Sequence[Premise] = (), opened: Iterable[str] = ()) -> frozenset[Place]:
    """Places of a block that some sequence of calls may reach.

    Constants and variables that are ``opened`` may be anything, unless a premise follows them: what only they exclude
    counts as possible.
    """
    followed = {name for premise in premises for name in premise.follow}
    return _Execution(unit, premises, {name.upper() for name in opened if name not in followed}).run()


# --- values ---------------------------------------------------------------------------------------------------


def _low(values: Values) -> float:
    return values[0] if isinstance(values, tuple) else min(values)


def _high(values: Values) -> float:
    return values[1] if isinstance(values, tuple) else max(values)


def _join(one: Values, two: Values) -> Values:
    if one == two:
        return one
    if isinstance(one, frozenset) and isinstance(two, frozenset) and len(one | two) <= MOST:
        return one | two
    return min(_low(one), _low(two)), max(_high(one), _high(two))


def _joined(one: Env | None, two: Env | None) -> Env | None:
    if one is None or two is None:
        return one if two is None else two
    return _all_joined([one, two])


def _all_joined(envs: list[Env]) -> Env:
    joined = envs[0]
    for env in envs[1:]:
        both = {}
        for name, values in joined.items():
            other = env.get(name)
            if other is values:
                both[name] = values
            elif other is not None:
                both[name] = _join(values, other)
        joined = both
    return joined


def _narrowed(values: Values, operator: str, other: Values) -> Values | None:
    """Those of ``values`` for which the comparison with some of ``other`` holds; None if there is none."""
    low, high = _low(other), _high(other)
    if isinstance(values, frozenset):
        tests: dict[str, Callable[[int], bool]] = {
            "<": lambda v: v < high,
            "<=": lambda v: v <= high,
            ">": lambda v: v > low,
            ">=": lambda v: v >= low,
            "=": lambda v: v in other if isinstance(other, frozenset) else low <= v <= high,
            "<>": lambda v: not low == high == v,
        }
        return frozenset(filter(tests[operator], values)) or None
    if operator == "=":
        found = _narrowed(other, ">=", values)
        return _narrowed(found, "<=", values) if found is not None and isinstance(other, frozenset) else other
    first, last = values
    if operator in {"<", "<="}:
        last = min(last, high - (operator == "<"))
    elif operator in {">", ">="}:
        first = max(first, low + (operator == ">"))
    return _few(first, last) if first <= last else None


def _few(low: float, high: float) -> Values:
    """Everything between two ends, one by one if it is little."""
    return frozenset(range(int(low), int(high) + 1)) if high - low < MOST else (low, high)


def _calculated(operator: str, one: Values, two: Values) -> Values:
    if isinstance(one, frozenset) and isinstance(two, frozenset) and len(one) * len(two) <= MOST:
        signs: dict[str, Callable[[int, int], int]] = {
            "+": lambda a, b: a + b,
            "-": lambda a, b: a - b,
            "*": lambda a, b: a * b,
        }
        return frozenset(signs[operator](a, b) for a in one for b in two)
    if operator == "+":
        return _low(one) + _low(two), _high(one) + _high(two)
    return (_low(one) - _high(two), _high(one) - _low(two)) if operator == "-" else ANYTHING


# --- execution ------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Conditions:
    """What expressions of a block may be, and what follows from conditions that hold.

    ``constants`` have values, ``variables`` are those that nothing but the block changes; ``held`` are premises about
    variables, by ``arrays`` the upper-case names of these.
    """

    constants: dict[str, int]
    variables: set[str]
    held: Sequence[Premise]
    arrays: frozenset[str]

    def value(self, node: ast.Expression, env: Env) -> Values:
        """What an expression may be."""
        if isinstance(node, ast.Literal) and node.kind == "bool":
            return TRUE if node.text.upper() == "TRUE" else FALSE
        if isinstance(node, ast.Literal):
            constant = evaluate(node, {})
            return ANYTHING if constant is None else frozenset({constant})
        if isinstance(node, ast.Name | ast.Index):
            return self.held_or(node, env)
        if isinstance(node, ast.Unary) and node.operator == "-":
            return _calculated("-", FALSE, self.value(node.operand, env))
        if isinstance(node, ast.Binary) and node.operator in {"+", "-", "*"}:
            return _calculated(node.operator, self.value(node.left, env), self.value(node.right, env))
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
                return _narrowed(premise.values, "=", known) or premise.values
        return known

    @staticmethod
    def applies(premise: Premise, env: Env) -> bool:
        """Whether the variable that a premise is about the states of can only have those."""
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
                return _joined(true, second[0]), second[1]
            second = self.split(node.right, true) if true is not None else (None, None)
            return second[0], _joined(false, second[1])
        if isinstance(node, ast.Binary) and node.operator in OPPOSITE:
            return self.compare(node.operator, node.left, node.right, env)
        if isinstance(node, ast.Name | ast.Literal):
            return self.compare("=", node, ast.Literal(0, 0, "TRUE", "bool"), env)
        return env, env

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
        one = self.narrow(left[0], _narrowed(left[1], operator, right[1]), env)
        two = _narrowed(right[1], MIRRORED[operator], left[1])
        return None if one is None else self.narrow(right[0], two, one)

    def narrow(self, node: ast.Expression, values: Values | None, env: Env) -> Env | None:
        """The environment in which an expression has these values; None if it has none."""
        base = node.base if isinstance(node, ast.Index) else node
        if values is None or not isinstance(base, ast.Name) or base.scope == "quoted":
            return None if values is None else env
        name = base.name.upper()
        if isinstance(node, ast.Index) and name in self.arrays:
            return {**env, name + ELEMENT: values}
        if name not in self.variables or isinstance(node, ast.Index) or values == env.get(name, ANYTHING):
            return env
        return {**env, name: values}


class _Execution:
    """One block, executed until nothing new is reached."""

    def __init__(self, unit: ast.Unit, premises: Sequence[Premise], opened: set[str]) -> None:
        self.unit, self.state, self.opened = unit, STATE.upper(), opened
        self.never = {premise.never.upper(): premise for premise in premises if premise.never}
        held = [premise for premise in premises if premise.variable]
        self.conditions = _Conditions({}, set(), held, frozenset(premise.variable.upper() for premise in held))
        self.given = {premise.given.upper() for premise in premises} | {self.state}
        self.reached: set[Place] = set()
        self.constants, self.locals = self.conditions.constants, self.conditions.variables
        self.statics: Env = {}
        self.labelled: dict[int, frozenset[int] | None] = {}
        self.named: dict[int, frozenset[str]] = {}
        self.known: dict[tuple[int, frozenset[tuple[str, Values]]], list[Env]] = {}
        self.written: dict[int, frozenset[str]] = {}
        for section in unit.sections:
            self.declare(section)
        self.limits: dict[str, list[float]] = {}
        for node in ast.walk(unit):
            if (
                isinstance(node, ast.Assign)
                and isinstance(node.target, ast.Name)
                and isinstance(node.value, ast.Binary)
            ):
                self.limits[node.target.name.upper()] = self.compared_with(node.target.name)

    def declare(self, section: ast.Section) -> None:
        """Constants, and variables that nothing but the code of this block can change."""
        views = {entry.at for entry in section.declarations if entry.at}
        for entry in section.declarations:
            value = evaluate(entry.initial, self.constants) if entry.initial is not None else 0
            for name in (declared.name for declared in entry.names if declared.name.upper() not in self.opened):
                if section.keyword == "CONST" or "CONSTANT" in section.modifiers:
                    if value is not None:
                        self.constants[name.upper()] = value
                elif section.keyword in WORK_SECTIONS and entry.at is None and name not in views:
                    self.locals.add(name.upper())
                    if section.keyword == "VAR" and value is not None:
                        self.statics[name.upper()] = frozenset({value})

    def compared_with(self, name: str) -> list[float]:
        """Constants that a counter is compared with, and their neighbours: where it may stop counting."""
        found = {-inf, inf}
        for node in ast.walk(self.unit):
            if isinstance(node, ast.Binary) and node.operator in OPPOSITE:
                for one, other in ((node.left, node.right), (node.right, node.left)):
                    value = evaluate(other, self.constants)
                    if isinstance(one, ast.Name) and one.name.upper() == name.upper() and value is not None:
                        found |= {value - 1, value, value + 1}
        return sorted(found)

    def run(self) -> frozenset[Place]:
        """Everything that is reached from the start values on."""
        first = self.by_state([self.statics])
        starts, waiting = dict(first), list(first)
        ends: dict[Values, dict[Values, Env]] = {}
        while waiting:
            state = waiting.pop(0)
            again = state in ends
            ends[state] = self.call(starts[state])
            for after, env in ends[state].items():
                before = starts.get(after)
                grown = env if before is None else self.widened(before, env, again=again)
                if grown != before:
                    starts[after] = grown
                    waiting += [after] if after not in waiting else []
        for _ in range(2):  # back from "forever" to what the conditions let through
            self.reached.clear()
            self.known.clear()
            for state in starts:
                known = [end[state] for end in (first, *ends.values()) if state in end]
                ends[state] = self.call(_all_joined(known))
        return frozenset(self.reached)

    def call(self, start: Env) -> dict[Values, Env]:
        """What a call that begins so may leave for the next one, by state."""
        return self.by_state(self.body(self.unit.statements, [start]))

    def by_state(self, envs: Iterable[Env]) -> dict[Values, Env]:
        """One start for every state."""
        found: dict[Values, list[Env]] = {}
        for env in envs:
            kept = {name: values for name, values in env.items() if name in self.statics}
            states = kept.get(self.state, ANYTHING)
            for state in [frozenset({s}) for s in states] if isinstance(states, frozenset) else [states]:
                found.setdefault(state, []).append({**kept, self.state: state})
        return {state: _all_joined(several) for state, several in found.items()}

    def widened(self, before: Env, now: Env, *, again: bool) -> Env:
        """Of a counter that grows from call to call it is not known where it ends."""
        found = {}
        for name, values in before.items():
            after = _join(values, now.get(name, ANYTHING))
            if again and after != values and name in self.limits:
                low, high = _low(after), _high(after)
                if low < _low(values):
                    low = max(limit for limit in self.limits[name] if limit <= low)
                if high > _high(values):
                    high = min(limit for limit in self.limits[name] if limit >= high)
                after = _few(low, high)
            if after != ANYTHING:
                found[name] = after
        return found

    # --- statements -----------------------------------------------------------------------------------

    def body(self, statements: ast.Body, envs: list[Env]) -> list[Env]:
        """Run statements: what may hold behind them, one environment for each state of the block."""
        envs = [env for env in envs if not self.forbidden(statements, env)]
        for node in statements:
            envs = [after for before in envs for after in self.statement(node, before)]
            if len(envs) > MOST:
                envs = self.merged(envs)
        return self.merged(envs)

    def merged(self, envs: Iterable[Env]) -> list[Env]:
        """Join what is in the same state: what belongs to a state stays with it."""
        groups: dict[Values, list[Env]] = {}
        for env in envs:
            groups.setdefault(env.get(self.state, ANYTHING), []).append(env)
        return [_all_joined(group) for group in groups.values()]

    def forbidden(self, statements: ast.Body, env: Env) -> bool:
        """Whether one of the statements assigns what a premise excludes."""
        for node in statements if self.never else ():
            value = node.value if isinstance(node, ast.Assign) else None
            premise = self.never.get(value.name.upper()) if isinstance(value, ast.Name) else None
            if premise is not None and (not premise.among or self.conditions.applies(premise, env)):
                return True
        return False

    def statement(self, node: ast.Statement, env: Env) -> list[Env]:
        """Run one statement: what may hold behind it."""
        if isinstance(node, ast.Region):
            return self.body(node.body, [env])
        self.reached.add((node.start, "statement"))
        if isinstance(node, ast.Assign):
            return [self.assign(node, env)]
        if isinstance(node, ast.CallStatement):
            return [self.without(node, env)]
        if node.start not in self.named:
            inside = (inner.name.upper() for inner in ast.walk(node) if isinstance(inner, ast.Name))
            self.named[node.start] = frozenset(inside) & self.locals | self.given
        names = self.named[node.start]
        inner = {name: values for name, values in env.items() if name in names}
        key = node.start, frozenset(inner.items())
        if key not in self.known:
            self.known[key] = self.compound(node, inner)
        outer = {name: values for name, values in env.items() if name not in names}
        return [{**outer, **after} for after in self.known[key]]

    def compound(self, node: ast.Statement, env: Env) -> list[Env]:
        """Run a statement with statements in it; ``env`` has only what it names."""
        if isinstance(node, ast.If):
            return self.merged(self.if_(node, env))
        if isinstance(node, ast.Case):
            return list(self.case(node, env))  # each branch by itself up to the end of the statements around it
        if isinstance(node, ast.For | ast.While | ast.Repeat):
            return self.merged(self.loop(node, env))
        raise TypeError("jumps are not followed")

    def without(self, node: ast.Node, env: Env) -> Env:
        """Forget every variable that a statement, or anything in it, may write."""
        names = self.written.get(node.start)
        if names is None:
            names = self.written[node.start] = frozenset(_written(node))
        return {name: values for name, values in env.items() if name not in names} if names & env.keys() else env

    def assign(self, node: ast.Assign, env: Env) -> Env:
        """Store a value in a variable of the block; arrays and everything outside are not followed."""
        value = self.conditions.value(node.value, env)
        env = self.without(node, env)
        if self.conditions.arrays:  # which element was meant before, nobody knows now
            env = {name: values for name, values in env.items() if not name.endswith(ELEMENT)}
        for target in (node.target, *node.also):
            name = target.name.upper() if isinstance(target, ast.Name) else ""
            if name in self.locals and node.operator == ":=" and value != ANYTHING:
                env = {**env, name: value}
        return env

    def if_(self, node: ast.If, env: Env) -> Iterator[Env]:
        """Every branch whose condition may hold, and the rest."""
        rest: Env | None = env
        for branch in node.branches:
            true, rest = self.conditions.split(branch.condition, rest) if rest is not None else (None, None)
            yield from self.branch(branch, "branch", branch.body, true)
        yield from self.branch(node, "else", node.otherwise or (), rest)

    def branch(self, node: ast.Node, kind: str, statements: ast.Body, env: Env | None) -> list[Env]:
        """A branch is reached if its condition may hold and its statements may run."""
        if env is None or self.forbidden(statements, env):
            return []
        self.reached.add((node.start, kind))
        return self.body(statements, [env])

    def case(self, node: ast.Case, env: Env) -> Iterator[Env]:
        """Every branch whose labels the selector may have, and the rest."""
        rest: Values | None = self.conditions.value(node.selector, env)
        for branch in node.branches:
            labels = self.labels(branch)
            if rest is None or (isinstance(rest, frozenset) and labels is not None and not rest & labels):
                continue
            if labels is None:
                yield from self.branch(branch, "branch", branch.body, env)
            elif isinstance(rest, frozenset):
                yield from self.branch(
                    branch, "branch", branch.body, self.conditions.narrow(node.selector, rest & labels, env)
                )
                rest = rest - labels or None
            else:
                chosen = _narrowed(labels, "=", rest)
                yield from self.branch(
                    branch, "branch", branch.body, self.conditions.narrow(node.selector, chosen, env)
                )
        yield from self.branch(node, "else", node.otherwise or (), self.conditions.narrow(node.selector, rest, env))

    def labels(self, branch: ast.CaseBranch) -> frozenset[int] | None:
        """Values of the labels of a branch; None if they are too many or not constant."""
        if branch.start not in self.labelled:
            found: set[int] = set()
            for label in branch.labels:
                low = evaluate(label.low, self.constants)
                high = low if label.high is None else evaluate(label.high, self.constants)
                if low is None or high is None or high - low > MOST:
                    self.labelled[branch.start] = None
                    break
                found |= set(range(low, high + 1))
            else:
                self.labelled[branch.start] = frozenset(found)
        return self.labelled[branch.start]

    # --- loops ----------------------------------------------------------------------------------------

    def loop(self, node: ast.For | ast.While | ast.Repeat, env: Env) -> Iterator[Env]:
        """Follow a loop pass by pass until it ends or nothing limits it; then any pass may have any values."""
        if isinstance(node, ast.For):
            self.reached.add((node.start, "loop"))
            env = self.stored(node, self.conditions.value(node.first, env), env)
        last = self.conditions.value(node.last, env) if isinstance(node, ast.For) else ANYTHING
        envs = [env]
        for _ in range(MOST):
            before, envs = envs, []
            for now in before:
                inside, outside = self.head(node, last, now)
                if outside is not None:
                    yield outside
                if inside is not None and not inside == outside == now:
                    self.reached.add((node.start, "pass"))
                    ended, again = self.turn(node, self.body(node.body, [inside]))
                    yield from ended
                    envs += again
                elif inside is not None:
                    yield from self.any_pass(node, last, now)
            envs = self.merged(envs)
            if not envs or envs == before:
                return
        for now in envs:
            yield from self.any_pass(node, last, now)

    def head(self, node: ast.For | ast.While | ast.Repeat, last: Values, env: Env) -> tuple[Env | None, Env | None]:
        """What may hold in front of a pass, and if there is none."""
        if isinstance(node, ast.While):
            return self.conditions.split(node.condition, env)
        if isinstance(node, ast.Repeat):
            return env, None
        value = self.conditions.value(node.variable, env)
        inside, outside = _narrowed(value, "<=", last), _narrowed(value, ">", last)
        return (
            None if inside is None else self.stored(node, inside, env),
            None if outside is None else self.stored(node, outside, env),
        )

    def turn(self, node: ast.For | ast.While | ast.Repeat, envs: list[Env]) -> tuple[list[Env], list[Env]]:
        """Behind a pass: where the loop ends, where it goes on."""
        if isinstance(node, ast.For):
            step = self.conditions.value(node.step, {}) if node.step is not None else TRUE
            return [], [
                self.stored(node, _calculated("+", self.conditions.value(node.variable, env), step), env)
                for env in envs
            ]
        if isinstance(node, ast.While):
            return [], envs
        ends = [self.conditions.split(node.condition, env) for env in envs]
        return [true for true, _ in ends if true is not None], [false for _, false in ends if false is not None]

    def stored(self, node: ast.For, value: Values, env: Env) -> Env:
        """The variable of a FOR."""
        return {**env, node.variable.name.upper(): value} if isinstance(node.variable, ast.Name) else env

    def any_pass(self, node: ast.For | ast.While | ast.Repeat, last: Values, env: Env) -> Iterator[Env]:
        """Behind a loop that is not followed."""
        inside, outside = self.head(node, last, self.without(node, env))
        if inside is not None:
            self.reached.add((node.start, "pass"))
            yield from self.turn(node, self.body(node.body, [inside]))[0]
        if outside is not None:
            yield outside


def _written(node: ast.Node) -> Iterator[str]:
    """Variables of the block that a statement and everything in it may write."""
    for inner in ast.walk(node):
        targets: Iterable[ast.Expression] = ()
        if isinstance(inner, ast.Assign):
            targets = (inner.target, *inner.also)
        elif isinstance(inner, ast.For):
            targets = (inner.variable,)
        elif isinstance(inner, ast.Argument) and inner.operator:
            targets = (inner.value,)  # also an input: it may be an in-out
        for target in targets:
            if isinstance(target, ast.Name):
                yield target.name.upper()
