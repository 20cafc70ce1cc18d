"""All kinds of drive jobs: which key of a job says what it does, and what else a kind brings.

Every folder of ``plcgen.ds47.kinds`` is found by itself: its ``KINDS`` are read at once, its other modules when they
are asked for. Other distributions bring a ``JobKind`` by an entry point of the group ``plcgen.kinds``.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache, partial
from importlib import import_module
from importlib.util import find_spec
from pkgutil import iter_modules
from typing import Any

from plcgen.base.diagnostics import PluginError
from plcgen.base.plugins import expect_free, plugins
from plcgen.ds47.kind import JobKind

GROUP = "plcgen.kinds"
FOLDER = "plcgen.ds47.kinds"


@cache
def shipped() -> tuple[JobKind, ...]:
    """The kinds of all folders, in the order of the table in docs/spec.md."""
    found: list[JobKind] = [kind for package in _packages() for kind in getattr(import_module(package), "KINDS", ())]
    return tuple(sorted(found, key=lambda kind: kind.place))


@cache
def kinds() -> tuple[JobKind, ...]:
    """Every kind: the shipped ones first, then others by name. Raises PluginError."""
    brought = [_guarded(kind) for kind in plugins(GROUP, JobKind).values()]
    expect_free(GROUP, (kind.key for kind in brought), [kind.key for kind in shipped()])
    return (*shipped(), *brought)


@cache
def brought(module: str, name: str) -> tuple[Any, ...]:
    """What a module of the folders has under a name, of all that have such a module."""
    places = (f"{package}.{module}" for package in _packages())
    return tuple(one for place in places if find_spec(place) for one in getattr(import_module(place), name))


@cache
def _packages() -> tuple[str, ...]:
    paths = import_module(FOLDER).__path__
    return tuple(f"{FOLDER}.{one.name}" for one in iter_modules(paths) if one.ispkg)


def _guarded(kind: JobKind) -> JobKind:
    """A kind of somebody else: whatever it raises is not a bug of plcgen."""
    parts = ("items", "poll", "messages", "steps", "title", "permits")
    made: dict[str, Any] = {part: partial(_made, kind, part) for part in parts if getattr(kind, part) is not None}
    return replace(kind, **made)


def _made(kind: JobKind, part: str, value: Any) -> Any:
    """What a part of a kind makes of the value of a job."""
    try:
        made = getattr(kind, part)(value)
        return tuple(made) if part in {"items", "steps"} else made
    except Exception as problem:
        raise PluginError(f"the kind of job {kind.key} cannot be planned: {problem!r}") from problem


def kind_called(key: str) -> JobKind:
    """The kind with this key. Raises KeyError."""
    return {kind.key: kind for kind in kinds()}[key]
