"""System types whose interface the tool chain knows: record function blocks and IEC timers."""

from __future__ import annotations

from functools import cache
from types import MappingProxyType
from typing import TYPE_CHECKING

from plcgen.s7.blocks import Block, BlockKind, Section, SectionKind
from plcgen.s7.types import Member, NamedType, elementary

if TYPE_CHECKING:
    from collections.abc import Mapping

_TIMERS = frozenset(
    {"IEC_TIMER", "TON", "TOF", "TP", "TONR", "TON_TIME", "TOF_TIME", "TP_TIME", "TONR_TIME"},
)
_TIMER = ("START TIME", "PT TIME", "ET TIME", "RU BOOL", "IN BOOL", "Q BOOL", "RESERVED WORD")
_STATE = ("BUSY BOOL", "ERROR BOOL", "STATUS DWORD")
_CLASSIC = {
    "RDREC": (
        ("REQ BOOL", "ID DWORD", "INDEX INT", "MLEN INT"),
        ("VALID BOOL", *_STATE, "LEN INT"),
        ("RECORD ANY",),
    ),
    "WRREC": (
        ("REQ BOOL", "ID DWORD", "INDEX INT", "LEN INT"),
        ("DONE BOOL", *_STATE),
        ("RECORD ANY",),
    ),
}
_MODERN = {
    "RDREC": (
        ("REQ BOOL", "ID HW_IO", "INDEX DINT", "MLEN UINT"),
        ("VALID BOOL", *_STATE, "LEN UINT"),
        ("RECORD VARIANT",),
    ),
    "WRREC": (
        ("REQ BOOL", "ID HW_IO", "INDEX DINT", "LEN UINT"),
        ("DONE BOOL", *_STATE),
        ("RECORD VARIANT",),
    ),
}
_NUMBERS = {"SFB52": "RDREC", "SFB53": "WRREC"}
_EVIDENCE = "evidence"
_LITERATURE = "literature"


def system_block(name: str) -> Block | None:
    """Interface of a system type by any spelling, or None.

    RDREC/SFB52 (28 bytes) and WRREC/SFB53 (26 bytes) have the S7-300/400 interface, confirmed by compiled
    multi-instances. IEC timers are 16 bytes: start, PT, ET, then the bits running, IN and Q (literature).
    """
    upper = name.upper()
    upper = _NUMBERS.get(upper, upper)
    if upper in _CLASSIC:
        return _record_block(upper, *_CLASSIC[upper])
    return _timer(upper) if upper in _TIMERS else None


@cache
def s7_1500_types() -> Mapping[str, Block]:
    """RDREC and WRREC as S7-1200/1500 have them, by name: merge them into the types of a layout.

    Their interface is Siemens' documentation; nothing confirms the offsets inside an instance.
    """
    evidence = {_EVIDENCE: _LITERATURE}
    blocks = {name: _record_block(name, *sections) for name, sections in _MODERN.items()}
    return MappingProxyType(
        {name: Block(block.kind, name, block.sections, attributes=evidence) for name, block in blocks.items()}
    )


def is_literature(block: Block) -> bool:
    """Whether the layout of a system type rests on literature instead of compiled blocks."""
    return block.attributes.get(_EVIDENCE) == _LITERATURE


def _record_block(name: str, inputs: tuple[str, ...], outputs: tuple[str, ...], in_outs: tuple[str, ...]) -> Block:
    sections = (
        Section(SectionKind.INPUT, _members(*inputs)),
        Section(SectionKind.OUTPUT, _members(*outputs)),
        Section(SectionKind.IN_OUT, _members(*in_outs)),
    )
    return Block(BlockKind.FB, name, sections)


def _timer(name: str) -> Block:
    sections = (Section(SectionKind.STATIC, _members(*_TIMER)),)
    return Block(BlockKind.FB, name, sections, attributes={_EVIDENCE: _LITERATURE})


@cache
def _members(*declarations: str) -> tuple[Member, ...]:
    pairs = (declaration.split() for declaration in declarations)
    return tuple(Member(name, elementary(spelling) or NamedType(spelling)) for name, spelling in pairs)
