"""All kinds of drive jobs: which key of a job says what it does.

A kind is a ``JobKind`` in ``SHIPPED``, or one that another distribution brings by an entry point of the group
``plcgen.kinds``. Everything else follows: schema and completion, telegrams, blocks, proof.
"""

from __future__ import annotations

from functools import cache

from plcgen.plugins import plugins
from plcgen.protocols.ds47.kinds.acknowledge import ACKNOWLEDGE
from plcgen.protocols.ds47.kinds.activate import ACTIVATE
from plcgen.protocols.ds47.kinds.clock import CLOCK
from plcgen.protocols.ds47.kinds.kind import JobKind
from plcgen.protocols.ds47.kinds.messages import ALARM_LIST, FAULT_LIST
from plcgen.protocols.ds47.kinds.recipe import RECIPES
from plcgen.protocols.ds47.kinds.save import SAVE
from plcgen.protocols.ds47.kinds.sequence import SEQUENCE
from plcgen.protocols.ds47.kinds.values import COMPARE, READ, WRITE

GROUP = "plcgen.kinds"
SHIPPED = (READ, WRITE, COMPARE, SAVE, FAULT_LIST, ALARM_LIST, ACKNOWLEDGE, SEQUENCE, ACTIVATE, CLOCK, *RECIPES)


@cache
def kinds() -> tuple[JobKind, ...]:
    """Every kind: the shipped ones first, then others by name."""
    return (*SHIPPED, *plugins(GROUP, JobKind).values())


def kind_called(key: str) -> JobKind:
    """The kind with this key. Raises KeyError."""
    return {kind.key: kind for kind in kinds()}[key]
