"""Sets of values: a few integers, or everything between two ends."""

from __future__ import annotations

from collections.abc import Callable
from math import inf
from operator import add, mul, sub
from typing import TypeAlias

Values: TypeAlias = frozenset[int] | tuple[float, float]
"""A few integers (TRUE is 1), or everything from a lower to an upper end."""
Env: TypeAlias = dict[str, Values]
"""Values of local variables by upper-case name; a missing one may be anything."""
ANYTHING: Values = (-inf, inf)
FALSE, TRUE = frozenset({0}), frozenset({1})
MOST = 64
"""So many values are kept apart."""


OPERATIONS: dict[str, Callable[[int, int], int]] = {"+": add, "-": sub, "*": mul}


def least(values: Values) -> float:
    """The lower end."""
    return values[0] if isinstance(values, tuple) else min(values)


def greatest(values: Values) -> float:
    """The upper end."""
    return values[1] if isinstance(values, tuple) else max(values)


def join(one: Values, two: Values) -> Values:
    """What is in one of two sets; more, if it would be many."""
    if one == two:
        return one
    if isinstance(one, frozenset) and isinstance(two, frozenset) and len(one | two) <= MOST:
        return one | two
    return min(least(one), least(two)), max(greatest(one), greatest(two))


def either(one: Env | None, two: Env | None) -> Env | None:
    """What may hold behind two ways, of which one may not exist."""
    if one is None or two is None:
        return one if two is None else two
    return all_joined([one, two])


def all_joined(envs: list[Env]) -> Env:
    """What may hold behind several ways."""
    joined = envs[0]
    for env in envs[1:]:
        both = {}
        for name, values in joined.items():
            other = env.get(name)
            if other is values:
                both[name] = values
            elif other is not None:
                both[name] = join(values, other)
        joined = both
    return joined


def narrowed(values: Values, operator: str, other: Values) -> Values | None:
    """Those of ``values`` for which the comparison with some of ``other`` holds; None if there is none."""
    low, high = least(other), greatest(other)
    if isinstance(values, frozenset):
        return _some(values, operator, other, low, high) or None
    if operator == "=":
        found = narrowed(other, ">=", values)
        return narrowed(found, "<=", values) if found is not None and isinstance(other, frozenset) else other
    first, last = values
    if operator in {"<", "<="}:
        last = min(last, high - (operator == "<"))
    elif operator in {">", ">="}:
        first = max(first, low + (operator == ">"))
    return few(first, last) if first <= last else None


def _some(values: frozenset[int], operator: str, other: Values, low: float, high: float) -> frozenset[int]:
    """Those of a few values for which a comparison with something from ``low`` to ``high`` may hold."""
    if operator == "=":
        return values & other if isinstance(other, frozenset) else frozenset(v for v in values if low <= v <= high)
    if operator == "<>":
        return values if low != high else frozenset(v for v in values if v != low)
    if operator in {"<", "<="}:
        last = high - (operator == "<")
        return values if max(values) <= last else frozenset(v for v in values if v <= last)
    first = low + (operator == ">")
    return values if min(values) >= first else frozenset(v for v in values if v >= first)


def few(low: float, high: float) -> Values:
    """Everything between two ends, one by one if it is little."""
    return frozenset(range(int(low), int(high) + 1)) if high - low < MOST else (low, high)


def calculated(operator: str, one: Values, two: Values) -> Values:
    """Sums, differences and products."""
    if isinstance(one, frozenset) and isinstance(two, frozenset) and len(one) * len(two) <= MOST:
        calculate = OPERATIONS[operator]
        return frozenset(calculate(a, b) for a in one for b in two)
    if operator == "+":
        return least(one) + least(two), greatest(one) + greatest(two)
    return (least(one) - greatest(two), greatest(one) - least(two)) if operator == "-" else ANYTHING
