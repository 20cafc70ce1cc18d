"""The block model every reader produces and every check consumes: one block = its declaration sections.

What a setting means that a source does not write is in ``OF_BLOCKS`` and ``OF_MEMBERS``. Sources: help of the TIA
Portal ("Blocks with optimized access", "Overview of data type conversion"); 784 blocks in public exports of V16 to V18,
where ``IsIECCheckEnabled`` is false in 98.2 %, and those of V19 to V21, which write it only where it is true. The other
rows are what exports write that hold defaults, too. Of no row it is known that it differs between versions of the TIA
Portal, so there is no column for them.
"""

from __future__ import annotations

import enum
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING

from plcgen.base.frozen import frozen

if TYPE_CHECKING:
    from collections.abc import Mapping

    from plcgen.base.diagnostics import Span
    from plcgen.s7.types.data_types import Member


class BlockKind(enum.StrEnum):
    """What kind of S7 block or type a source declares."""

    UDT = "UDT"
    DB = "DB"
    FB = "FB"
    FC = "FC"
    OB = "OB"


class SectionKind(enum.StrEnum):
    """Declaration sections; a UDT has exactly one STATIC section, a global DB one for each retentivity."""

    INPUT = "Input"
    OUTPUT = "Output"
    IN_OUT = "InOut"
    STATIC = "Static"
    TEMP = "Temp"
    CONSTANT = "Constant"
    RETURN = "Return"


@dataclass(frozen=True, slots=True)
class Section:
    """The members of one declaration section, in source order.

    ``retain`` is RETAIN, NON_RETAIN, DB_SPECIFIC (each instance of the function block says it) or empty.
    """

    kind: SectionKind
    members: tuple[Member, ...]
    retain: str = ""


@frozen
class Assignment:
    """A line of a DB's BEGIN part: ``path := literal``; it overrides the declared start value."""

    path: str
    literal: str
    span: Span | None = None


@dataclass(frozen=True, slots=True)
class Block:
    """A block as declared.

    ``instance_of`` names the FB, SFB or UDT a DB is made from. ``optimized`` is None when the source does
    not say. ``attributes`` keeps every other header attribute as written. ``code`` is the text of an FB, FC or
    OB between BEGIN and its end, without the line breaks there; None if it is not SCL or was not read.
    ``inline`` are the types that its document writes out where it uses them. ``safety`` says that it belongs to a
    safety program, which no text source says.
    """

    kind: BlockKind
    name: str
    sections: tuple[Section, ...]
    number: int | None = None
    instance_of: str | None = None
    optimized: bool | None = None
    non_retain: bool = False
    title: str = ""
    comment: str = ""
    attributes: dict[str, str] = field(default_factory=dict)
    assignments: tuple[Assignment, ...] = ()
    span: Span | None = None
    code: str | None = None
    inline: tuple[Block, ...] = ()
    safety: bool = False

    @property
    def members(self) -> tuple[Member, ...]:
        """Members of all sections, in source order."""
        return tuple(m for s in self.sections for m in s.members)

    def section(self, kind: SectionKind) -> tuple[Member, ...]:
        """Members of one section; empty if the block has none of that kind."""
        return tuple(m for s in self.sections if s.kind is kind for m in s.members)


def is_retentive(block: Block) -> bool:
    """Whether a data block as a whole keeps its values: neither NON_RETAIN nor single sections say otherwise.

    Either nothing is said of any section, or all of them with members are RETAIN.
    """
    said = {s.retain for s in block.sections if s.members}
    if block.kind is not BlockKind.DB:
        return False
    return said == {"RETAIN"} or (not block.non_retain and said <= {""})


def block_title(kind: str, number: int | None, name: str) -> str:
    """``DB3 "WR_DataBuffer"``, or the name alone if it is the number."""
    numbered = f"{kind}{'' if number is None else number}"
    return numbered if name.upper() == numbered else f'{numbered} "{name}"'


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
