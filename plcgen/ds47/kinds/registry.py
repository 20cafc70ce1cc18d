"""All kinds of drive jobs: which key of a job says what it does.

A kind is a ``JobKind`` in ``SHIPPED``, or one that another distribution brings by an entry point of the group
``plcgen.kinds``. Everything else follows: schema and completion, telegrams, blocks, proof.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache, partial
from typing import Any

from plcgen.base.diagnostics import PluginError
from plcgen.base.plugins import expect_free, plugins
from plcgen.ds47.kinds.acknowledge import ACKNOWLEDGE
from plcgen.ds47.kinds.activate import ACTIVATE
from plcgen.ds47.kinds.clock import CLOCK
from plcgen.ds47.kinds.kind import JobKind
from plcgen.ds47.kinds.messages import ALARM_LIST, FAULT_LIST
from plcgen.ds47.kinds.recipe import RECIPES
from plcgen.ds47.kinds.save import SAVE
from plcgen.ds47.kinds.sequence import SEQUENCE
from plcgen.ds47.kinds.values import COMPARE, READ, WRITE

GROUP = "plcgen.kinds"
SHIPPED = (READ, WRITE, COMPARE, SAVE, FAULT_LIST, ALARM_LIST, ACKNOWLEDGE, SEQUENCE, ACTIVATE, CLOCK, *RECIPES)


@cache
def kinds() -> tuple[JobKind, ...]:
    """Every kind: the shipped ones first, then others by name. Raises PluginError."""
    brought = [_guarded(kind) for kind in plugins(GROUP, JobKind).values()]
    expect_free(GROUP, (kind.key for kind in brought), [kind.key for kind in SHIPPED])
    return (*SHIPPED, *brought)


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
