"""System types whose interface the tool chain knows: record function blocks and IEC timers."""

from __future__ import annotations

from functools import cache

from plcgen.s7.blocks import Block, BlockKind, Section, SectionKind
from plcgen.s7.types import ELEMENTARY, Member

_TIMERS = (
    "IEC_TIMER",
    "TON",
    "TOF",
    "TP",
    "TONR",
    "TON_TIME",
    "TOF_TIME",
    "TP_TIME",
    "TONR_TIME",
)
_RECORD_BLOCKS = {
    "RDREC": (
        ("REQ BOOL", "ID DWORD", "INDEX INT", "MLEN INT"),
        ("VALID BOOL", "BUSY BOOL", "ERROR BOOL", "STATUS DWORD", "LEN INT"),
    ),
    "WRREC": (
        ("REQ BOOL", "ID DWORD", "INDEX INT", "LEN INT"),
        ("DONE BOOL", "BUSY BOOL", "ERROR BOOL", "STATUS DWORD"),
    ),
}
_NUMBERS = {"SFB52": "RDREC", "SFB53": "WRREC"}


def system_block(name: str) -> Block | None:
    """Interface of a system type by any spelling, or None.

    RDREC/SFB52 (28 bytes) and WRREC/SFB53 (26 bytes) have the S7-300/400 interface, confirmed by compiled
    multi-instances. IEC timers are 16 bytes: start, PT, ET, then the bits running, IN and Q (literature).
    """
    upper = name.upper()
    upper = _NUMBERS.get(upper, upper)
    if upper in _RECORD_BLOCKS:
        return _record_block(upper)
    return _timer(upper) if upper in _TIMERS else None


def is_literature(block: Block) -> bool:
    """Whether the layout of a system block rests on literature instead of compiled blocks."""
    return block.name in _TIMERS


@cache
def _record_block(name: str) -> Block:
    inputs, outputs = _RECORD_BLOCKS[name]
    return Block(
        BlockKind.FB,
        name,
        (
            Section(SectionKind.INPUT, _members(*inputs)),
            Section(SectionKind.OUTPUT, _members(*outputs)),
            Section(SectionKind.IN_OUT, _members("RECORD ANY")),
        ),
    )


@cache
def _timer(name: str) -> Block:
    members = _members("START TIME", "PT TIME", "ET TIME", "RU BOOL", "IN BOOL", "Q BOOL", "RESERVED WORD")
    return Block(BlockKind.FB, name, (Section(SectionKind.STATIC, members),))


def _members(*declarations: str) -> tuple[Member, ...]:
    pairs = (declaration.split() for declaration in declarations)
    return tuple(Member(name, ELEMENTARY[type_name]) for name, type_name in pairs)
