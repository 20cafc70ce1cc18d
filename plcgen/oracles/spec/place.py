"""Where something stands in a spec, and what is read of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

Keys = tuple[str | int, ...]
"""The way from the root of a spec to a value: keys of mappings, positions in lists."""


@dataclass(frozen=True, slots=True)
class SpecPlace:
    """File, line and column, both from 1."""

    file: str
    line: int
    column: int = 1


@dataclass(frozen=True, slots=True)
class SpecSource:
    """A spec with its includes and variables resolved: ``data`` is plain, ``place`` says where a value stands.

    ``profiles`` are device profiles as plain mappings, by what a spec calls them, with those that they are ``like``;
    ``lists`` are the lines of the lists of parameters that they name.
    """

    data: Mapping[str, Any]
    place: Callable[[Keys], SpecPlace]
    profiles: Mapping[str, Mapping[str, Any]]
    lists: Mapping[str, Sequence[str]] = field(default_factory=dict)


def texts(given: Any) -> frozenset[str]:
    """A comment of a spec in each of its languages; one text stands for the first of them."""
    said = given.values() if isinstance(given, Mapping) else (given,)
    return frozenset(str(one) for one in said if one)


class NotStatedError(ValueError):
    """Nothing here says what the spec demands."""
