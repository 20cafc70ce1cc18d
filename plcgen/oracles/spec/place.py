"""Where something stands in a spec, and what is read of it."""

from __future__ import annotations

import re
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
    ``lists`` are the lines of the lists of parameters that they name; ``family`` has all profiles that are shipped of
    the family of a device.
    """

    data: Mapping[str, Any]
    place: Callable[[Keys], SpecPlace]
    profiles: Mapping[str, Mapping[str, Any]]
    lists: Mapping[str, Sequence[str]] = field(default_factory=dict)
    family: Callable[[str], SpecSource] | None = None


def texts(given: Any) -> frozenset[str]:
    """A comment of a spec in each of its languages; one text stands for the first of them."""
    said = given.values() if isinstance(given, Mapping) else (given,)
    return frozenset(str(one) for one in said if one)


class NotStatedError(ValueError):
    """Nothing here says what the spec demands."""


_UNITS = {"ms": 1, "s": 1000, "min": 60_000, "h": 3_600_000}
_TIME = re.compile(r"\s*(\d+)\s*(ms|s|min|h)\s*")


def milliseconds(text: Any, default: int) -> int:
    """A time as a spec writes it, ``200ms``, ``10s``, ``2min``, ``1h``; ``default`` if none is given."""
    if text is None:
        return default
    match = _TIME.fullmatch(str(text))
    if match is None:
        raise NotStatedError(f"{text!r} is no time")
    return int(match[1]) * _UNITS[match[2]]
