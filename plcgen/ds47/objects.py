"""Types of drive objects: what a unit consists of, as the lists of its parameters name them.

Siemens' lists name the drive objects that have a parameter by their types, as p0107 of the control unit numbers them:
CU_S120_PN, SERVO, VECTOR, A_INF, TM31 (TIA Portal information system, lists of SINAMICS parameters, firmware 5.2).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Literal, TypeAlias, get_args

ObjectType: TypeAlias = Literal[
    "control_unit", "drive", "servo", "vector", "infeed", "a_inf", "b_inf", "s_inf", "terminal_module", "tm15di_do",
    "tm31", "tm41", "tm120", "tm150", "tb30", "other",
]  # fmt: skip
"""What a spec calls them; ``drive``, ``infeed`` and ``terminal_module`` are one of several, ``other`` none of them."""
OTHER: ObjectType = "other"
CONTROL_UNIT_TYPE: ObjectType = "control_unit"
ListedType: TypeAlias = Literal[
    "all", "control_unit", "drive", "servo", "vector", "infeed", "a_inf", "b_inf", "s_inf",
    "terminal_module", "tm15di_do", "tm31", "tm41", "tm120", "tm150", "tb30",
]  # fmt: skip
"""What a profile says of the objects that have a parameter."""

GROUPS: Mapping[str, frozenset[str]] = {
    "drive": frozenset({"servo", "vector"}),
    "infeed": frozenset({"a_inf", "b_inf", "s_inf"}),
    "terminal_module": frozenset({"tm15di_do", "tm31", "tm41", "tm120", "tm150", "tb30"}),
}
_ALL = frozenset(get_args(ListedType)) - {"all", *GROUPS}
_CALLED = {
    "control_unit": "the control unit",
    "drive": "drives",
    "infeed": "infeeds",
    "terminal_module": "terminal modules",
}


def single_types(types: Iterable[str]) -> frozenset[str]:
    """The single types that some words stand for."""
    return frozenset().union(*(_ALL if one == "all" else GROUPS.get(one, {one}) for one in types))


def kindred(types: frozenset[str]) -> frozenset[str]:
    """The same with every type of the same group: what the one has may well be in the other."""
    return types.union(*(group for group in GROUPS.values() if group & types))


def singular(object_type: str) -> str:
    """One object of a type for a message: ``control unit``, ``A_INF``."""
    return object_type.replace("_", " ") if object_type in _CALLED else object_type.upper()


def spoken(types: frozenset[str]) -> str:
    """Types for a message: groups in words, single ones as in p0107."""
    whole = [name for name, group in GROUPS.items() if group <= types]
    left = types - single_types(whole)
    words = [CONTROL_UNIT_TYPE] * (CONTROL_UNIT_TYPE in types) + whole + sorted(left - {CONTROL_UNIT_TYPE})
    shown = [_CALLED.get(word, word.upper()) for word in words]
    return " and ".join([", ".join(shown[:-1]), shown[-1]] if len(shown) > 1 else shown)
