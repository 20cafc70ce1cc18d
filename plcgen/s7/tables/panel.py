"""What a panel is given to reach a member of a data block: its name in the PLC, and its address."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import islice
from typing import TYPE_CHECKING, NamedTuple

from plcgen.s7.layout.layout import Entry, layout_block, leaves
from plcgen.s7.tables.tables import member_address
from plcgen.s7.types.blocks import Block, BlockKind
from plcgen.s7.types.literals import type_text

if TYPE_CHECKING:
    from plcgen.s7.types.data_types import Member

_BYTE_SIZES = (8, 16, 32)
MOST = 5_000
"""Members of a block that are listed."""


class PanelTag(NamedTuple):
    """A member of a data block for a panel.

    ``symbolic`` is how the PLC names it, ``"DriveJobs".ramps.start``: S7-1200/1500, with any access. ``absolute`` is
    ``%DB5.DBX0.0``: for a block with standard access and a number; empty for others, whose members have no address.
    """

    symbolic: str
    absolute: str
    type: str
    comment: str


def panel_tag(block: Block, entry: Entry) -> PanelTag:
    """The member at an entry of a block's layout."""
    single = None if entry.size in _BYTE_SIZES or entry.size > max(_BYTE_SIZES) else entry.bit
    reached = block.number is not None and not block.optimized
    absolute = f"%{member_address(block.number, entry.byte, single, entry.size)}" if reached else ""
    member: Member = entry.member
    return PanelTag(f'"{block.name}".{entry.path}', absolute, type_text(entry.type), member.comment)


def panel_tags(block: Block, types: Mapping[str, Block]) -> Iterator[PanelTag]:
    """Every elementary member of a data block, in the order of memory; nothing for other blocks.

    Raises DiagnosticError as :func:`layout_block` does.
    """
    if block.kind is BlockKind.DB:
        yield from (panel_tag(block, entry) for entry in islice(leaves(layout_block(block, types)), MOST))
