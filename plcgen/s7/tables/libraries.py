"""Types of the TIA Portal's libraries whose members nobody declares: GRAPH's steps, safety blocks, technology objects.

Without their members no place behind them is known. A block with optimized access has no places, so it can be shown
all the same.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from plcgen.base.diagnostics import Diagnostic, Severity, Span
from plcgen.s7.layout.shapes import NO_MEMORY
from plcgen.s7.types.blocks import Block, BlockKind
from plcgen.s7.types.data_types import NamedType, elementary, innermost, nested
from plcgen.s7.types.system import system_block

_MARK = "InstructionName"


def with_library_types(block: Block, types: Mapping[str, Block]) -> tuple[dict[str, Block], list[Diagnostic]]:
    """All types, those of libraries that nobody declares without members, and a warning (PG806) for each of these."""
    known, warnings = dict(types), []
    owner = known.get((block.instance_of or "").upper())
    pending, seen = [block] if owner is None else [block, owner], {block.name.upper()}
    while pending:
        for type_, span, library in _used(pending.pop()):
            key = type_.name.upper()
            if key in seen:
                continue
            declared = known.get(key)
            if declared is not None:
                seen.add(key)
                pending.append(declared)
            elif library and _is_unknown(type_):
                seen.add(key)
                known[key] = Block(BlockKind.UDT, type_.name, ())
                warnings.append(_warning(type_.name, span or block.span or Span(block.name)))
    return known, warnings


def _is_unknown(type_: NamedType) -> bool:
    return elementary(type_.name) is None and type_.name.upper() not in NO_MEMORY and system_block(type_.name) is None


def _warning(name: str, place: Span) -> Diagnostic:
    message = f"the members of {name} are not known to plcgen: shown without them"
    return Diagnostic("PG806", message, place, Severity.WARNING, help="its instance DB or online view shows them")


def _used(block: Block) -> Iterator[tuple[NamedType, Span | None, bool]]:
    """Named types of all members, in their order, and whether a library of the TIA Portal has them."""
    for member in nested(block.members):
        type_ = innermost(member.type)
        if isinstance(type_, NamedType):
            yield type_, member.span, any(name == _MARK for name, _ in member.attributes)
