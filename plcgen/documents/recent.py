"""Recent results of a function of a plan and one of its parts; they are forgotten with the plan."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import TypeVar
from weakref import WeakKeyDictionary

Plan = TypeVar("Plan")
Part = TypeVar("Part")
Result = TypeVar("Result")

_KEPT = 8
"""Documents ask again for the part at hand and its neighbours, not for all of them."""


def recent(function: Callable[[Plan, Part], Result]) -> Callable[[Plan, Part], Result]:
    """Remember the last results; nothing in them may refer to the plan, or it would live as long as the process."""
    kept: WeakKeyDictionary[Plan, dict[Part, Result]] = WeakKeyDictionary()

    @wraps(function)
    def remembered(plan: Plan, part: Part) -> Result:
        known = kept.setdefault(plan, {})
        if part in known:
            return known[part]
        result = function(plan, part)
        while len(known) >= _KEPT:
            known.pop(next(iter(known)))
        known[part] = result
        return result

    return remembered
