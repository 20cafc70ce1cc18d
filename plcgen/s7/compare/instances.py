"""Start values of instance data blocks: what differs from the function block, from a text or from a document.

A text lists behind BEGIN what differs; a document repeats every member, with the value that the instance has.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from plcgen.s7.compare.starts import literal_start, normalized
from plcgen.s7.types.blocks import Block, SectionKind
from plcgen.s7.types.data_types import DataType, Member, StructType, innermost
from plcgen.s7.xml.writing.starts import single_values

_LOCALS = frozenset({SectionKind.TEMP, SectionKind.CONSTANT})


def instance_starts(block: Block, owner: Block | None) -> tuple[tuple[str, str], ...]:
    """Path and canonical literal of every start value that ``owner`` has otherwise; all if it is unknown (None).

    Paths are in upper case and without quotes or blanks; a value that is the default of its type is written out.
    """
    declared = {} if owner is None else _values(owner)
    found = _values(block)
    types = {path: member.type for b in (owner, block) if b is not None for path, member in _leaves(b)}
    changed = {}
    for path, literal in found.items():
        type_ = types.get(re.sub(r"\[[^\]]*\]", "", path))
        usual = declared.get(path)
        own = _canonical(literal, type_)
        before = "" if usual is None else _canonical(usual, type_)
        if owner is None or own != before:
            changed[path] = own or normalized(literal)
    return tuple(changed.items())


def _values(block: Block) -> dict[str, str]:
    """Literals by path: of declarations, single values of arrays by their index; lines behind BEGIN replace them."""
    members = (m for s in block.sections if s.kind not in _LOCALS for m in s.members)
    found = {".".join(name.upper() + index for name, index in way): literal for way, literal in single_values(members)}
    for assignment in block.assignments:
        found["".join(assignment.path.split()).replace('"', "").upper()] = assignment.literal
    return found


def _leaves(block: Block) -> Iterator[tuple[str, Member]]:
    """Members with upper-case paths, those of structures too, and of arrays of them."""
    pending = [("", m) for s in block.sections if s.kind not in _LOCALS for m in s.members]
    while pending:
        prefix, member = pending.pop()
        path = f"{prefix}{member.name.upper()}"
        yield path, member
        inside = innermost(member.type)
        if isinstance(inside, StructType):
            pending += [(f"{path}.", inner) for inner in inside.members]


def _canonical(literal: str, type_: DataType | None) -> str:
    """The same text for every spelling of a value; empty for the default of its type."""
    return normalized(literal) if type_ is None else literal_start(Member("", innermost(type_), literal))
