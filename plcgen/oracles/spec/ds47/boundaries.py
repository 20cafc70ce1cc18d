"""Answers just beside what a step waits for, and the one that just meets it."""

from __future__ import annotations

import math
import struct
from collections.abc import Mapping, Sequence

from plcgen.oracles.spec.ds47.course import Supplied
from plcgen.oracles.spec.ds47.statement import FromInput, Number, StatedCondition, StatedStep
from plcgen.oracles.spec.ds47.types import is_float, is_signed, packed, size_of, unpacked

Answer = Mapping[tuple[int, int], Number]
"""Values by number and subindex."""
FAR_MET, FAR_MISSED = 2, 3
"""Farther than the nearest value: how a condition is met or missed."""
LARGE = 1.0e30


def meeting(step: StatedStep, supplied: Supplied, *, far: bool = False) -> Answer:
    """The answer that just meets every condition; ``far``: with the lowest or highest values that meet it."""
    return _answer(step, supplied, step.until, (), FAR_MET if far else 0)


def failing(step: StatedStep, supplied: Supplied) -> Sequence[Answer]:
    """Answers of which just one condition is just not met; on both sides of an equality."""
    found = []
    for missed in step.until:
        others = [one for one in step.until if one is not missed]
        found += [_answer(step, supplied, others, [(missed, side)]) for side in sides(missed)]
    return [answer for answer in found if answer != meeting(step, supplied)]


def sides(condition: StatedCondition) -> Sequence[int]:
    """In which directions, and how far, the condition can be missed."""
    if condition.bit is not None or condition.relation == "<>":
        return (1,)
    return (1, -1) if condition.relation == "=" else (1, FAR_MISSED)


def _answer(
    step: StatedStep,
    supplied: Supplied,
    met: Sequence[StatedCondition],
    missed: Sequence[tuple[StatedCondition, int]],
    how: int = 0,
) -> Answer:
    answer: dict[tuple[int, int], Number] = {}
    bits: dict[tuple[int, int], dict[int, int]] = {}
    for condition, side in [*((one, how) for one in met), *missed]:
        access = step.accesses[condition.access]
        place = access.number, access.index + condition.element
        wanted = wanted_number(condition, supplied)
        if condition.bit is not None:
            bits.setdefault(place, {})[condition.bit] = int(wanted) ^ (side not in {0, FAR_MET})
        else:
            answer[place] = beside(access.type, condition.relation, wanted, side)
    for place, asked in bits.items():
        access = next(a for a in step.accesses if (a.number, a.index) == place)
        word = 0 if missed else (1 << 8 * size_of(access.type)) - 1  # the other bits are others if it is met
        for bit, value in asked.items():
            word = word & ~(1 << bit) | value << bit
        answer[place] = _number(access.type, word)
    return answer


def wanted_number(condition: StatedCondition, supplied: Supplied) -> Number:
    """What the condition compares with; an input stands for 1 if it is 1, and for 0 otherwise."""
    if isinstance(condition.value, FromInput):
        return int(supplied[condition.value] == 1)
    return condition.value


def beside(type_: str, relation: str, wanted: Number, side: int) -> Number:
    """The nearest value that meets (``side`` 0) or misses the comparison, or the one that is farthest from it."""
    if side in {FAR_MET, FAR_MISSED}:
        if relation not in {"<", "<=", ">", ">="}:
            return beside(type_, relation, wanted, 0)
        return extreme(type_, low=relation.startswith("<") == (side == FAR_MET))
    shift = {"=": side, "<>": int(not side), "<": side - 1, "<=": side, ">": 1 - side, ">=": -side}[relation]
    return nearest(type_, wanted, shift)


def extreme(type_: str, *, low: bool) -> Number:
    """The lowest or highest number of a type; of floating-point numbers a large one."""
    bits = 8 * size_of(type_)
    if is_float(type_):
        return -LARGE if low else LARGE
    if is_signed(type_):
        return -(1 << (bits - 1)) if low else (1 << (bits - 1)) - 1
    return 0 if low else (1 << bits) - 1


def nearest(type_: str, value: Number, shift: int) -> Number:
    """The next value of the type above (``shift`` 1) or below (-1); the other one at an end of the type."""
    if not shift:
        return value
    if is_float(type_):
        return next_float(type_, float(value), shift)
    try:
        packed(type_, int(value) + shift)
    except (struct.error, OverflowError):
        return int(value) - shift
    return int(value) + shift


def next_float(type_: str, value: float, shift: int) -> float:
    """The neighbouring number that the type has, ``shift`` units in the last place away."""
    size = size_of(type_)
    number = int.from_bytes(packed(type_, value))
    top = 1 << (8 * size - 1)
    line = number if number < top else top - number  # on one line, negative numbers below zero
    line += shift
    number = line if line >= 0 else top - line
    found = float(unpacked(type_, number.to_bytes(size)))
    return value if math.isnan(found) else found


def _number(type_: str, word: int) -> Number:
    return unpacked(type_, word.to_bytes(size_of(type_)))
