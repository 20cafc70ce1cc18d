"""Interfaces of the blocks for serial modules: CP 341 (S7-300/400), CM 1241 and CM PtP (S7-1200/1500).

Sources: TIA Portal information system, "Point-to-point" and "PtP data link CP 341". Nothing confirms the offsets
inside an instance.
"""

from __future__ import annotations

from functools import cache
from types import MappingProxyType
from typing import TYPE_CHECKING

from plcgen.s7.types.blocks import Block, BlockKind, Section, SectionKind
from plcgen.s7.types.data_types import ArrayType, DataType, Member, NamedType, StructType, elementary

if TYPE_CHECKING:
    from collections.abc import Mapping

_RESULT = "DONE BOOL;ERROR BOOL;STATUS WORD"
_MODERN = {
    "SEND_P2P": ("REQ BOOL;PORT PORT;BUFFER VARIANT;LENGTH UINT", _RESULT),
    "RECEIVE_P2P": ("PORT PORT;BUFFER VARIANT", "NDR BOOL;ERROR BOOL;STATUS WORD;LENGTH UINT"),
    "RECEIVE_RESET": ("REQ BOOL;PORT PORT", _RESULT),
    "PORT_CONFIG": (
        (
            "REQ BOOL;PORT PORT;PROTOCOL UINT;BAUD UINT;PARITY UINT;DATABITS UINT;STOPBITS UINT;FLOWCTRL UINT;"
            "XONCHAR CHAR;XOFFCHAR CHAR;WAITIME UINT;MODE USINT;LINE_PRE USINT;BRK_DET USINT"
        ),
        _RESULT,
    ),
    "RECEIVE_CONFIG": ("REQ BOOL;PORT PORT;RECEIVE_CONDITIONS VARIANT", _RESULT),
}
_CLASSIC = {
    "P_SND_RK": (
        (
            "SF CHAR;REQ BOOL;R BOOL;LADDR INT;DB_NO INT;DBB_NO INT;LEN INT;R_CPU_NO INT;R_TYP CHAR;R_NO INT;"
            "R_OFFSET INT;R_CF_BYT INT;R_CF_BIT INT"
        ),
        _RESULT,
    ),
    "P_RCV_RK": (
        "EN_R BOOL;R BOOL;LADDR INT;DB_NO INT;DBB_NO INT",
        "L_TYP CHAR;L_NO INT;L_OFFSET INT;L_CF_BYT INT;L_CF_BIT INT;NDR BOOL;ERROR BOOL;LEN INT;STATUS WORD",
    ),
}


@cache
def serial_blocks(*, classic: bool) -> Mapping[str, Block]:
    """Blocks of serial modules of a target by upper-case name: merge them into the types of a layout."""
    kinds = (SectionKind.INPUT, SectionKind.OUTPUT)
    found = {}
    for name, parts in (_CLASSIC if classic else _MODERN).items():
        sections = (Section(kind, _members(text)) for kind, text in zip(kinds, parts, strict=True))
        found[name] = Block(BlockKind.FB, name, tuple(sections), attributes={"evidence": "literature"})
    return MappingProxyType(found)


def _members(text: str) -> tuple[Member, ...]:
    pairs = (part.split() for part in text.split(";"))
    return tuple(Member(name, _type(spelling)) for name, spelling in pairs)


def _type(spelling: str) -> DataType:
    count, _, name = spelling.rpartition("*")
    found = elementary(name) or NamedType(name)
    return ArrayType(((1, int(count)),), found) if count else found


def _struct(text: str, *more: Member) -> StructType:
    return StructType((*_members(text), *more))


_SEQUENCE = _struct("CTL BYTE;STR 5*CHAR")
_START = _struct("STARTCOND WORD;IDLETIME WORD;STARTCHAR BYTE", Member("SEQ", ArrayType(((1, 4),), _SEQUENCE)))
_END = _struct(
    "ENDCOND WORD;FIXLEN WORD;MAXLEN WORD;N WORD;LENGTHSIZE WORD;LENGTHM WORD;RCVTIME WORD;MSGTIME WORD;CHARGAP WORD",
    Member("SEQ", _SEQUENCE),
)
RECEIVE_CONDITIONS = Block(
    BlockKind.UDT,
    "RECEIVE_CONDITIONS",
    (Section(SectionKind.STATIC, (Member("START", _START), Member("END", _END))),),
    attributes={"evidence": "literature"},
)
"""What begins and ends a message for Receive_Config (TIA Portal information system, "Receive_Config"). The S7-1200
system manual (A5E02486680-AK) has UINT where the information system has WORD; the size is the same.
"""
