"""Completion of sources: members behind a dot, variables of the block behind ``#``, blocks behind a quotation mark."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from itertools import islice
from typing import TYPE_CHECKING

from plcgen.base.diagnostics import Span
from plcgen.s7.types.blocks import Block, block_title
from plcgen.s7.types.data_types import Member
from plcgen.s7.types.literals import type_text
from plcgen.s7.types.names import is_identifier
from plcgen.workbench.service.results import Edit, Offer
from plcgen.workbench.service.sources.names import Step, members_of, walk_to

if TYPE_CHECKING:
    from plcgen.workbench.service.sources.version import SourceState

_STEP = r'(?:"[^"\n]{1,128}"|\w{1,128})(?:\[[^\]\n]{0,200}\])?'
_WRITTEN = re.compile(rf'((?:#?{_STEP}\.){{0,16}})([#"]?)(\w{{0,128}})\Z')
_PART = re.compile(r'(#?)(?:"([^"]+)"|(\w+))(?:\[([^\]]*)\])?\.')
MOST = 1_000
_LONGEST = 2_000
"""Characters in front of a cursor that are looked at."""


def source_offers(state: SourceState, line: int, column: int) -> Iterator[Offer]:
    """What may stand at a place, in the order in which it is declared."""
    before = state.document.lines[line - 1][max(column - 1 - _LONGEST, 0) : column - 1] if line else ""
    written = _WRITTEN.search(before)
    if written is None:
        return
    place = Span(state.file, line, column - len(written[3]), line, column)
    unit = state.unit_at(state.offset(line, column))
    own = None if unit is None else state.block_of(unit)
    if written[1]:
        yield from _offered(_inside(state, own, written[1]), place)
    elif written[2] == "#" and own is not None:
        yield from _offered(own.members, place)
    elif written[2] == '"':
        for block in islice(state.types.values(), MOST):
            yield Offer(block.name, "type", Edit(place, block.name), block_title(block.kind, block.number, ""))


def _inside(state: SourceState, own: Block | None, text: str) -> Iterable[Member]:
    """The members of what stands in front of the last dot."""
    parts = _PART.findall(text)
    steps = [Step(quoted or plain, index) for _, quoted, plain, index in parts]
    found = None if own is None else walk_to(own, steps, state.types)
    if found is None and not parts[0][0]:
        block = state.types.get(steps[0].name.upper())
        if block is not None and len(steps) == 1:
            base = state.types.get((block.instance_of or "").upper())
            return (base or block).members
        found = None if block is None else walk_to(block, steps[1:], state.types)
    return () if found is None or found.member is None else members_of(found.member, found.owner, state.types)[1]


def _offered(members: Iterable[Member], place: Span) -> Iterator[Offer]:
    for member in islice(members, MOST):
        name = member.name if is_identifier(member.name) else f'"{member.name}"'
        yield Offer(member.name, "member", Edit(place, name), type_text(member.type), member.comment)
