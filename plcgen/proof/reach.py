"""Which statements and branches of a block can run at all, and which operands can decide.

Its tree is executed with sets of values.

A static variable begins with its start value and with whatever a call of the block may leave in it; inputs, arrays,
other blocks and what calls return may be anything. What is not reached then cannot run, whatever happens around the
block. What follows from time or from the line rather than from the program is a premise of the protocol's proof.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from math import inf
from typing import TypeAlias

from plcgen.proof.conditions import OPPOSITE, Names, Premise
from plcgen.proof.values import (  # fmt: skip
    ANYTHING,
    MOST,
    TRUE,
    Env,
    Values,
    all_joined,
    calculated,
    few,
    greatest,
    join,
    least,
    narrowed,
)
from plcgen.s7.scl import ast
from plcgen.s7.scl.constants import evaluate
from plcgen.s7.scl.logic import DECIDES, decisions, demands

KINDS = ("statement", "branch", "else", "loop", "pass", *DECIDES.values())
Place: TypeAlias = tuple[int, str]
"""Offset of a node, and what about it: one of ``KINDS``."""
Loop: TypeAlias = ast.For | ast.While | ast.Repeat
Demand: TypeAlias = tuple[ast.Expression, list[tuple[ast.Expression, bool]], bool]
"""An operand, what the others must be so that it decides, and with which value."""


def reachable(unit: ast.Unit, premises: Sequence[Premise] = (), opened: Iterable[str] = ()) -> frozenset[Place]:
    """Places of a block that some sequence of calls may reach.

    Constants and variables that are ``opened`` may be anything, unless a premise follows them: what only they exclude
    counts as possible.
    """
    nodes = list(ast.walk(unit))
    if any(isinstance(node, ast.Jump | ast.Goto) for node in nodes):
        return frozenset((node.start, kind) for node in nodes for kind in KINDS)  # jumps are not followed
    followed = {name for premise in premises for name in premise.follow}
    scope = Names(unit, premises, {name.upper() for name in opened if name not in followed})
    return _Execution(unit, scope).run()


class _Execution:
    """One block, executed until nothing new is reached."""

    def __init__(self, unit: ast.Unit, scope: Names) -> None:
        self.unit, self.scope = unit, scope
        self.reached: set[Place] = set()
        self.labelled: dict[int, frozenset[int] | None] = {}
        self.named: dict[int, frozenset[str]] = {}
        self.known: dict[tuple[int, frozenset[tuple[str, Values]]], list[Env]] = {}
        self.written: dict[int, frozenset[str]] = {}
        self.undecided: dict[int, list[Demand]] = {}
        self.deciding = False
        self.limits: dict[str, list[float]] = {}
        """Where a variable that is calculated may stop counting."""
        compared = scope.compared()
        for node in ast.walk(unit):
            if isinstance(node, ast.Assign) and isinstance(node.value, ast.Binary):
                for name in _written(node):
                    self.limits[name] = sorted({-inf, inf, *compared.get(name, ())})

    def run(self) -> frozenset[Place]:
        """Everything that is reached from the start values on."""
        first = self.by_state([self.scope.statics])
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
        for last in (False, True):  # back from "forever" to what the conditions let through
            self.reached.clear()
            self.known.clear()
            self.deciding = last
            for state in starts:
                known = [end[state] for end in (first, *ends.values()) if state in end]
                ends[state] = self.call(all_joined(known))
        return frozenset(self.reached)

    def call(self, start: Env) -> dict[Values, Env]:
        """What a call that begins so may leave for the next one, by state."""
        return self.by_state(self.body(self.unit.statements, [start]))

    def by_state(self, envs: Iterable[Env]) -> dict[Values, Env]:
        """One start for every state."""
        found: dict[Values, list[Env]] = {}
        for env in envs:
            kept = {name: values for name, values in env.items() if name in self.scope.statics}
            states = kept.get(self.scope.state, ANYTHING)
            for state in [frozenset({s}) for s in states] if isinstance(states, frozenset) else [states]:
                found.setdefault(state, []).append({**kept, self.scope.state: state})
        return {state: all_joined(several) for state, several in found.items()}

    def widened(self, before: Env, now: Env, *, again: bool) -> Env:
        """Of a counter that grows from call to call it is not known where it ends."""
        found = {}
        for name, values in before.items():
            after = join(values, now.get(name, ANYTHING))
            if again and after != values and name in self.limits:
                low, high = least(after), greatest(after)
                if low < least(values):
                    low = max(limit for limit in self.limits[name] if limit <= low)
                if high > greatest(values):
                    high = min(limit for limit in self.limits[name] if limit >= high)
                after = few(low, high)
            if after != ANYTHING:
                found[name] = after
        return found

    # --- statements -----------------------------------------------------------------------------------

    def body(self, statements: ast.Body, envs: list[Env]) -> list[Env]:
        """Run statements: what may hold behind them, one environment for each state of the block."""
        envs = [env for env in envs if not self.scope.forbidden(statements, env)]
        for node in statements:
            envs = [after for before in envs for after in self.statement(node, before)]
            if len(envs) > MOST:
                envs = self.merged(envs)
        return self.merged(envs)

    def merged(self, envs: Iterable[Env]) -> list[Env]:
        """Join what is in the same state: what belongs to a state stays with it."""
        groups: dict[Values, list[Env]] = {}
        for env in envs:
            groups.setdefault(env.get(self.scope.state, ANYTHING), []).append(env)
        return [all_joined(group) for group in groups.values()]

    def statement(self, node: ast.Statement, env: Env) -> list[Env]:
        """Run one statement: what may hold behind it."""
        if isinstance(node, ast.Region):
            return self.body(node.body, [env])
        self.reached.add((node.start, "statement"))
        if isinstance(node, ast.Assign):
            self.decide(node, env)
            return [self.assign(node, env)]
        if isinstance(node, ast.CallStatement):
            self.decide(node, env)
            return [self.without(node, env)]
        if node.start not in self.named:
            inside = (inner.name.upper() for inner in ast.walk(node) if isinstance(inner, ast.Name))
            self.named[node.start] = frozenset(inside) & self.scope.locals | self.scope.given
        names = self.named[node.start]
        inner = {name: values for name, values in env.items() if name in names}
        key = node.start, frozenset(inner.items())
        if key not in self.known:
            self.known[key] = self.compound(node, inner)
        outer = {name: values for name, values in env.items() if name not in names}
        return [{**outer, **after} for after in self.known[key]]

    def decide(self, node: ast.Node, env: Env) -> None:
        """Keep which operands of the conditions in an expression may decide, once; only what is reached last counts."""
        if not self.deciding:
            return
        if id(node) not in self.undecided:
            found = [demand for condition in decisions(node) for demand in demands(condition)]
            self.undecided[id(node)] = [(*demand, value) for demand in found for value in (True, False)]
        left = []
        for operand, others, value in self.undecided[id(node)]:
            if self.scope.decides(operand, others, env, value=value):
                self.reached.add((operand.start, DECIDES[value]))
            else:
                left.append((operand, others, value))
        self.undecided[id(node)] = left

    def compound(self, node: ast.Statement, env: Env) -> list[Env]:
        """Run a statement with statements in it; ``env`` has only what it names."""
        if isinstance(node, ast.If):
            return self.merged(self.if_(node, env))
        if isinstance(node, ast.Case):
            return list(self.case(node, env))  # each branch by itself up to the end of the statements around it
        return self.merged(self.loop(node, env)) if isinstance(node, Loop) else [env]

    def without(self, node: ast.Node, env: Env) -> Env:
        """Forget every variable that a statement, or anything in it, may write."""
        names = self.written.get(node.start)
        if names is None:
            names = self.written[node.start] = frozenset(_written(node))
        return {name: values for name, values in env.items() if name not in names} if names & env.keys() else env

    def assign(self, node: ast.Assign, env: Env) -> Env:
        """Store a value in a variable of the block; arrays and everything outside are not followed."""
        value = self.scope.value(node.value, env)
        env = self.without(node, env)
        if not self.scope.elements.isdisjoint(env):  # which element was meant before, nobody knows now
            env = {name: values for name, values in env.items() if name not in self.scope.elements}
        for target in (node.target, *node.also):
            name = target.name.upper() if isinstance(target, ast.Name) else ""
            if name in self.scope.locals and node.operator == ":=" and value != ANYTHING:
                env = {**env, name: value}
        return env

    def if_(self, node: ast.If, env: Env) -> Iterator[Env]:
        """Every branch whose condition may hold, and the rest."""
        rest: Env | None = env
        for branch in node.branches:
            if rest is not None:
                self.decide(branch.condition, rest)
            true, rest = self.scope.split(branch.condition, rest) if rest is not None else (None, None)
            yield from self.branch(branch, "branch", branch.body, true)
        yield from self.branch(node, "else", node.otherwise or (), rest)

    def branch(self, node: ast.Node, kind: str, statements: ast.Body, env: Env | None) -> list[Env]:
        """A branch is reached if its condition may hold and its statements may run."""
        if env is None or self.scope.forbidden(statements, env):
            return []
        self.reached.add((node.start, kind))
        return self.body(statements, [env])

    def case(self, node: ast.Case, env: Env) -> Iterator[Env]:
        """Every branch whose labels the selector may have, and the rest."""
        rest: Values | None = self.scope.value(node.selector, env)
        for branch in node.branches:
            labels = self.labels(branch)
            if rest is None or (isinstance(rest, frozenset) and labels is not None and not rest & labels):
                continue
            if labels is None:
                yield from self.branch(branch, "branch", branch.body, env)
            elif isinstance(rest, frozenset):
                yield from self.branch(
                    branch, "branch", branch.body, self.scope.narrow(node.selector, rest & labels, env)
                )
                rest = rest - labels or None
            else:
                chosen = self.scope.narrow(node.selector, narrowed(labels, "=", rest), env)
                yield from self.branch(branch, "branch", branch.body, chosen)
        yield from self.branch(node, "else", node.otherwise or (), self.scope.narrow(node.selector, rest, env))

    def labels(self, branch: ast.CaseBranch) -> frozenset[int] | None:
        """Values of the labels of a branch; None if they are too many or not constant."""
        if branch.start not in self.labelled:
            found: set[int] = set()
            for label in branch.labels:
                low = evaluate(label.low, self.scope.constants)
                high = low if label.high is None else evaluate(label.high, self.scope.constants)
                if low is None or high is None or high - low > MOST:
                    self.labelled[branch.start] = None
                    break
                found |= set(range(low, high + 1))
            else:
                self.labelled[branch.start] = frozenset(found)
        return self.labelled[branch.start]

    # --- loops ----------------------------------------------------------------------------------------

    def loop(self, node: Loop, env: Env) -> Iterator[Env]:
        """Follow a loop pass by pass until it ends or nothing limits it; then any pass may have any values."""
        if isinstance(node, ast.For):
            self.reached.add((node.start, "loop"))
            env = self.stored(node, self.scope.value(node.first, env), env)
        last = self.scope.value(node.last, env) if isinstance(node, ast.For) else ANYTHING
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

    def head(self, node: Loop, last: Values, env: Env) -> tuple[Env | None, Env | None]:
        """What may hold in front of a pass, and if there is none."""
        if isinstance(node, ast.While):
            self.decide(node.condition, env)
            return self.scope.split(node.condition, env)
        if isinstance(node, ast.Repeat):
            return env, None
        value = self.scope.value(node.variable, env)
        step = self.scope.value(node.step, {}) if node.step is not None else TRUE
        downwards = isinstance(step, frozenset) and max(step) < 0
        ends = "<" if downwards else ">"
        inside, outside = narrowed(value, OPPOSITE[ends], last), narrowed(value, ends, last)
        return (
            None if inside is None else self.stored(node, inside, env),
            None if outside is None else self.stored(node, outside, env),
        )

    def turn(self, node: Loop, envs: list[Env]) -> tuple[list[Env], list[Env]]:
        """Behind a pass: where the loop ends, where it goes on."""
        if isinstance(node, ast.For):
            step = self.scope.value(node.step, {}) if node.step is not None else TRUE
            return [], [
                self.stored(node, calculated("+", self.scope.value(node.variable, env), step), env) for env in envs
            ]
        if isinstance(node, ast.While):
            return [], envs
        for env in envs:
            self.decide(node.condition, env)
        ends = [self.scope.split(node.condition, env) for env in envs]
        return [true for true, _ in ends if true is not None], [false for _, false in ends if false is not None]

    def stored(self, node: ast.For, value: Values, env: Env) -> Env:
        """The variable of a FOR."""
        return {**env, node.variable.name.upper(): value} if isinstance(node.variable, ast.Name) else env

    def any_pass(self, node: Loop, last: Values, env: Env) -> Iterator[Env]:
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
