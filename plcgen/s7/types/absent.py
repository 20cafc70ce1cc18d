"""What a setting of a block or member means that its source does not write, for every reader and writer of plcgen.

Sources: help of the TIA Portal ("Blocks with optimized access", "Overview of data type conversion"); 784 blocks in
public exports of V16 to V18, where ``IsIECCheckEnabled`` is false in 98.2 %, and those of V19 to V21, which write it
only where it is true. The other rows are what exports write that hold defaults, too. Of no row it is known that it
differs between versions of the TIA Portal, so there is no column for them.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

from plcgen.s7.types.blocks import Block, BlockKind

if TYPE_CHECKING:
    from collections.abc import Mapping

OF_BLOCKS = MappingProxyType({
    "DBACCESSIBLEFROMOPCUA": "TRUE", "DBACCESSIBLEFROMWEBSERVER": "TRUE", "ISIECCHECKENABLED": "FALSE",
    "ISONLYSTOREDINLOADMEMORY": "FALSE", "ISRETAINMEMRESENABLED": "FALSE", "ISWRITEPROTECTEDINAS": "FALSE",
    "MEMORYRESERVE": "100", "UDAENABLETAGREADBACK": "FALSE", "VERSION": "0.1",
})  # fmt: skip
"""Attributes of blocks by their names in upper case without underscores; access has a function of its own."""

OF_MEMBERS = MappingProxyType({
    "RETAIN": "NONRETAIN", "S7_SETPOINT": "FALSE", "EXTERNALVISIBLE": "TRUE", "EXTERNALACCESSIBLE": "TRUE",
    "EXTERNALWRITABLE": "TRUE",
})  # fmt: skip
"""Attributes of members by their names in upper case."""


def optimized(*, classic: bool) -> bool:
    """Whether a block has optimized access whose source says nothing: on S7-1200/1500, never on S7-300/400."""
    return not classic


def is_optimized(block: Block, types: Mapping[str, Block], *, classic: bool) -> bool:
    """Whether a block has optimized access, stated or not; an instance has that of its function block.

    ``types`` are blocks by upper-case name.
    """
    if classic:
        return False
    owner = types.get((block.instance_of or "").upper())
    counts = owner if owner is not None and owner.kind is BlockKind.FB else block
    return optimized(classic=False) if counts.optimized is None else counts.optimized


def is_numbered(block: Block) -> bool:
    """Whether the source of a block has a number: only STEP 7 V5 writes one there, which has standard access only."""
    is_text = block.span is not None and not block.span.file.lower().endswith((".xml", ".s7dcl"))
    return is_text and block.number is not None
