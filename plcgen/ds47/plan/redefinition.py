"""A parameter of the catalogue that a spec defines again: what it adds, and where it says more than is allowed.

What was read in a manual may be narrowed: closer limits, fewer indexes, reading only. Widening it would lift the check
that the catalogue is there for. What was not read gives way to the spec.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from plcgen.ds47.device import Fact, Parameter, ParameterDef

_OWN = ("name", "title", "unit", "default")


def merged(known: Parameter, own: Parameter) -> Parameter:
    """What the spec says, and of the catalogue what the spec does not speak of; who defines a type has looked it up."""
    texts = {key: getattr(own, key) for key in _OWN if getattr(own, key) not in {None, ""}}
    ends: dict[Fact, float | None] = {"min": own.minimum, "max": own.maximum, "array": own.array}
    stated = {fact for fact, value in ends.items() if value is not None}
    return replace(
        known,
        **texts,
        type=own.type,
        access=own.access,
        array=known.array if own.array is None else own.array,
        indexes=known.indexes if own.array is None else own.indexes,
        minimum=known.minimum if own.minimum is None else own.minimum,
        maximum=known.maximum if own.maximum is None else own.maximum,
        bico=known.bico or own.bico,
        values={**known.values, **own.values},
        scale=own.scale or known.scale,
        observed=known.observed if own.type == known.type else None,
        grades={**known.grades, **dict.fromkeys(stated, "read"), "type": "read", "access": "read"},
        doubted={fact: value for fact, value in known.doubted.items() if fact not in stated},
    )


def widened(known: Parameter, own: ParameterDef, meant: Parameter) -> Iterator[tuple[str, str]]:
    """Each key of a definition that contradicts what was read, with what was read; ``meant`` has its values."""
    if known.read("type") and own.type.lower() != known.type.lower():
        yield "type", f"is {known.type}, not {own.type}"
    if known.read("unit") and own.unit and meant.unit.lower() != known.unit.lower():
        yield "unit", f"is in {known.unit}, not {meant.unit}"
    if meant.minimum is not None and known.minimum is not None and meant.minimum < known.minimum:
        yield "min", f"begins at {known.minimum:g}, not {meant.minimum:g}"
    if meant.maximum is not None and known.maximum is not None and meant.maximum > known.maximum:
        yield "max", f"ends at {known.maximum:g}, not {meant.maximum:g}"
    if known.array is not None and own.array is not None and (isinstance(own.array, str) or own.array > known.array):
        yield "array", f"has {known.array} indexes, not {own.array}"
    elif known.array is None and not known.indexes and own.array not in {None, 1}:
        yield "array", "has no index"
