"""Data blocks as memory: every elementary member with its bytes, type, declaration and start value."""

from __future__ import annotations

import itertools
import re
from collections.abc import Mapping
from dataclasses import dataclass

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.s7.layout.image import image
from plcgen.s7.layout.layout import Layout, layout_block, leaves
from plcgen.s7.read.blocks import SourceBlock, Sources
from plcgen.s7.types.blocks import Block, BlockKind, block_title
from plcgen.s7.types.data_types import DataType
from plcgen.s7.types.literals import LiteralError

LARGEST = 4096
"""A data block with more bytes is no buffer: a record has 240."""


@dataclass(frozen=True, slots=True)
class Slot:
    """One elementary member, or one element of an array: place in bytes, type, declaration.

    ``given`` says that the source gives it a start value of its own; ``bits`` is 1 for a BOOL.
    """

    path: str
    offset: int
    size: int
    bits: int
    type: DataType
    span: Span
    given: bool

    @property
    def end(self) -> int:
        """First byte behind it."""
        return self.offset + self.size


@dataclass(frozen=True, slots=True)
class FoundBuffer:
    """A data block with its members in memory order; ``memory`` is its start image, None if that has errors."""

    block: Block
    file: str
    size: int
    slots: tuple[Slot, ...]
    memory: bytes | None

    @property
    def title(self) -> str:
        """``DB3 "WR_DataBuffer"``, or the name alone if the source gives no number."""
        return block_title(self.block.kind, self.block.number, self.block.name)

    @property
    def span(self) -> Span:
        """Where the block begins."""
        return self.block.span or Span(self.file)


def find_buffers(sources: Sources, diagnostics: list[Diagnostic]) -> list[FoundBuffer]:
    """Every data block that is small enough to be a buffer, and has a layout."""
    found: list[FoundBuffer] = []
    for source in sources.blocks:
        if source.block.kind is not BlockKind.DB or _is_instance(source.block, sources.types):
            continue
        try:
            layout = layout_block(source.block, sources.types)
        except DiagnosticError as problem:
            diagnostics += problem.diagnostics
            continue
        if layout.size <= LARGEST:
            found.append(_buffer(source, layout, sources.types, diagnostics))
    return found


def _is_instance(block: Block, types: Mapping[str, Block]) -> bool:
    owner = types.get((block.instance_of or "").upper())
    return block.instance_of is not None and (owner is None or owner.kind is not BlockKind.UDT)


def _buffer(
    source: SourceBlock, layout: Layout, types: Mapping[str, Block], diagnostics: list[Diagnostic]
) -> FoundBuffer:
    memory: bytes | None = None
    try:
        memory = bytes(image(source.block, types))
    except (LiteralError, DiagnosticError) as error:
        place = getattr(error, "span", None) or source.block.span or Span(source.file)
        message = f'DB "{source.block.name}": {error}'
        diagnostics.append(Diagnostic("PG656", message, place, help="correct the start value"))
    assigned = {"".join(a.path.split()).replace('"', "").upper() for a in source.block.assignments}
    slots = []
    for leaf in leaves(layout):
        path = leaf.path.replace('"', "")
        parents = itertools.accumulate(re.split(r"(?=[.\[])", path.upper()))
        given = leaf.member.start is not None or not assigned.isdisjoint(parents)
        place = leaf.member.span or source.block.span or Span(source.file)
        size = max(leaf.size // 8, 1)
        slots.append(Slot(path, leaf.byte, size, leaf.size, leaf.type, place, given))
    return FoundBuffer(source.block, source.file, layout.size, tuple(slots), memory)
