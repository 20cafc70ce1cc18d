"""System types whose interface is documented: function blocks of the S7-300/400, IEC timers and counters, structures.

Members are spelled ``NAME TYPE`` or ``NAME 16*TYPE`` (an array from 1), separated by ``;``. Sources: Siemens,
"System Software for S7-300/400 System and Standard Functions", and the TIA Portal information system.
"""

from __future__ import annotations

from functools import cache, lru_cache
from types import MappingProxyType
from typing import TYPE_CHECKING

from plcgen.s7.types.blocks import Block, BlockKind, Section, SectionKind
from plcgen.s7.types.data_types import ArrayType, Member, NamedType, elementary
from plcgen.s7.types.serial_blocks import RECEIVE_CONDITIONS

if TYPE_CHECKING:
    from collections.abc import Mapping

_SECTIONS = (SectionKind.INPUT, SectionKind.OUTPUT, SectionKind.IN_OUT, SectionKind.STATIC)
_STATE = "BUSY BOOL;ERROR BOOL;STATUS DWORD"
_CLASSIC_RECORD = {
    "RDREC": ("REQ BOOL;ID DWORD;INDEX INT;MLEN INT", f"VALID BOOL;{_STATE};LEN INT", "RECORD ANY"),
    "WRREC": ("REQ BOOL;ID DWORD;INDEX INT;LEN INT", f"DONE BOOL;{_STATE}", "RECORD ANY"),
}
_MODERN_RECORD = {
    "RDREC": ("REQ BOOL;ID HW_IO;INDEX DINT;MLEN UINT", f"VALID BOOL;{_STATE};LEN UINT", "RECORD VARIANT"),
    "WRREC": ("REQ BOOL;ID HW_IO;INDEX DINT;LEN UINT", f"DONE BOOL;{_STATE}", "RECORD VARIANT"),
}
_TIMER = ("", "", "", "START TIME;PT TIME;ET TIME;RU BOOL;IN BOOL;Q BOOL;RESERVED WORD")
_LTIMER = ("", "", "", "START LTIME;PT LTIME;ET LTIME;RU BOOL;IN BOOL;Q BOOL;RESERVED DWORD")
_KINDS = ("TON", "TOF", "TP")
_RETENTIVE = [(*form[:3], form[3].replace("Q BOOL", "Q BOOL;R BOOL")) for form in (_TIMER, _LTIMER)]
_TIMERS = dict.fromkeys(("IEC_TIMER", *_KINDS, *(f"{kind}_TIME" for kind in _KINDS)), _TIMER)
_TIMERS |= dict.fromkeys(("IEC_LTIMER", *(f"{kind}_LTIME" for kind in _KINDS)), _LTIMER)
_TIMERS |= {"TONR": _RETENTIVE[0], "TONR_TIME": _RETENTIVE[0], "TONR_LTIME": _RETENTIVE[1]}
_CLASSIC_TIMER = ("IN BOOL;PT TIME", "Q BOOL;ET TIME", "", "STATE BYTE;STIME TIME;ATIME TIME")
_NEW_DATA = "NDR BOOL;ERROR BOOL;STATUS WORD"
_ADDRESSES = ";".join(f"{name}_{n} ANY" for name in ("ADDR", "RD") for n in range(1, 5))
_CLASSIC = {
    "SFB0": ("CU BOOL;R BOOL;PV INT", "Q BOOL;CV INT", "", "CUO BOOL"),
    "SFB1": ("CD BOOL;LOAD BOOL;PV INT", "Q BOOL;CV INT", "", "CDO BOOL"),
    "SFB2": ("CU BOOL;CD BOOL;R BOOL;LOAD BOOL;PV INT", "QU BOOL;QD BOOL;CV INT", "", "CUO BOOL;CDO BOOL"),
    "SFB3": _CLASSIC_TIMER,
    "SFB4": _CLASSIC_TIMER,
    "SFB5": _CLASSIC_TIMER,
    "SFB13": ("EN_R BOOL;ID WORD;R_ID DWORD", _NEW_DATA, "RD_1 ANY;LEN WORD", "STAT WORD"),
    "SFB14": ("REQ BOOL;ID WORD", _NEW_DATA, _ADDRESSES, "STAT WORD"),
    "SFB15": (
        "REQ BOOL;ID WORD",
        "DONE BOOL;ERROR BOOL;STATUS WORD",
        _ADDRESSES.replace("RD_", "SD_"),
        "STAT WORD",
    ),
    "SFB22": ("REQ BOOL;ID WORD", _NEW_DATA, "PHYS ANY;LOG ANY;LOCAL ANY", "STAT WORD"),
    "SFB23": ("EN_R BOOL;ID WORD", _NEW_DATA, "PHYS ANY;LOG ANY;LOCAL ANY", "STAT WORD"),
    "SFB54": (
        "MODE INT;F_ID DWORD;MLEN INT",
        "NEW BOOL;STATUS DWORD;ID DWORD;LEN INT",
        "TINFO ANY;AINFO ANY",
    ),
}
_SYMBOLS = {
    "CTU": "SFB0", "CTD": "SFB1", "CTUD": "SFB2", "TP": "SFB3", "TON": "SFB4", "TOF": "SFB5", "RALRM": "SFB54",
}  # fmt: skip
"""Names that the standard library of STEP 7 V5 puts into the symbol table, besides RDREC and WRREC."""
CONTROL = {
    "LEAD_LAG": (
        "IN REAL;SAMPLE_T INT", "OUT REAL;ERR_CODE WORD", "",
        "LD_TIME REAL;LG_TIME REAL;GAIN REAL;PREV_IN REAL;PREV_OUT REAL",
    ),
    "DCAT": (
        "CMD BOOL;O_FB BOOL;C_FB BOOL", "Q BOOL;OA BOOL;CA BOOL", "", "ET DINT;PT DINT;PREV_TIME DWORD;CMD_HIS BOOL",
    ),
    "MCAT": (
        "O_CMD BOOL;C_CMD BOOL;S_CMD BOOL;O_FB BOOL;C_FB BOOL", "OO BOOL;CO BOOL;OA BOOL;CA BOOL;Q BOOL", "",
        "ET DINT;PT DINT;PREV_TIME DWORD;O_HIS BOOL;C_HIS BOOL",
    ),
}  # fmt: skip
"""Blocks that control with values in their instance; the offsets that the help names agree with these."""
_EDGE = ("CLK BOOL", "Q BOOL", "", "STAT_BIT BOOL")
_TCON = (
    "BLOCK_LENGTH WORD;ID WORD;CONNECTION_TYPE BYTE;ACTIVE_EST BOOL;LOCAL_DEVICE_ID BYTE;LOCAL_TSAP_ID_LEN BYTE;"
    "REM_SUBNET_ID_LEN BYTE;REM_STADDR_LEN BYTE;REM_TSAP_ID_LEN BYTE;NEXT_STADDR_LEN BYTE;LOCAL_TSAP_ID 16*BYTE;"
    "REM_SUBNET_ID 6*BYTE;REM_STADDR 6*BYTE;REM_TSAP_ID 16*BYTE;NEXT_STADDR 6*BYTE;SPARE WORD"
)
_STRUCTURES = {
    "IEC_COUNTER": "CU BOOL;CD BOOL;R BOOL;LD BOOL;QU BOOL;QD BOOL;PV INT;CV INT",
    "IEC_UCOUNTER": "CU BOOL;CD BOOL;R BOOL;LD BOOL;QU BOOL;QD BOOL;PV UINT;CV UINT",
    "TCON_PAR": _TCON,
    "TCON_PARAM": _TCON,
    "TADDR_PAR": "REM_IP_ADDR 4*BYTE;REM_PORT_NR 2*BYTE;SPARE 2*BYTE",
    "TADDR_PARAM": "REM_IP_ADDR 4*USINT;REM_PORT_NR UINT;RESERVED WORD",
    "IP_V4": "ADDR 4*BYTE",
    "TCON_IP_V4": "INTERFACEID HW_ANY;ID CONN_OUC;CONNECTIONTYPE BYTE;ACTIVEESTABLISHED BOOL;"
    "REMOTEADDRESS IP_V4;REMOTEPORT UINT;LOCALPORT UINT",
    "NREF": "AREA BYTE;DB_NUMBER UINT;OFFSET UDINT",
    "CREF": "BLOCK_TYPE BYTE;CB_NUMBER UINT;OFFSET UDINT",
    "ERROR_STRUCT": "ERROR_ID WORD;FLAGS BYTE;REACTION BYTE;CODE_ADDRESS CREF;MODE BYTE;OPERAND_NUMBER UINT;"
    "POINTER_NUMBER_LOCATION UINT;SLOT_NUMBER_SCOPE UINT;DATA_ADDRESS NREF",
    "SSL_HEADER": "LENTHDR WORD;N_DR WORD",
}
for _name in ("CTU", "CTD", "CTUD"):
    _STRUCTURES |= {f"{_name}_INT": _STRUCTURES["IEC_COUNTER"], f"{_name}_UINT": _STRUCTURES["IEC_UCOUNTER"]}
_STRUCTURES["ERRORSTRUCT"] = _STRUCTURES["ERROR_STRUCT"]
_NUMBERS = {"SFB52": "RDREC", "SFB53": "WRREC"}
_EVIDENCE = "evidence"
_LITERATURE = "literature"


@lru_cache(maxsize=1024)
def system_block(name: str, *, classic: bool = False) -> Block | None:
    """Interface of a system type by any spelling, or None.

    RDREC/SFB52 (28 bytes) and WRREC/SFB53 (26 bytes) have the S7-300/400 interface, confirmed by compiled
    multi-instances. TON, TOF and TP are the 16 bytes of an IEC timer of the S7-1200/1500 (start, PT, ET, then the
    bits running, IN and Q; TONR has R behind them; the LTIME forms have 32 bytes) unless ``classic`` asks for SFB3 to
    SFB5 of the S7-300/400, 22 bytes; literature both.
    """
    upper = name.upper()
    upper = _NUMBERS.get(upper, upper)
    if upper in _CLASSIC_RECORD:
        return _block(BlockKind.FB, upper, _CLASSIC_RECORD[upper])
    number = _SYMBOLS.get(upper, upper) if classic or upper == "RALRM" else upper
    sections = _CLASSIC.get(number) or _TIMERS.get(upper) or CONTROL.get(upper)
    if sections is not None:
        return _block(BlockKind.FB, upper, sections, literature=True)
    if upper in {"R_TRIG", "F_TRIG"}:
        return _block(BlockKind.FB, upper, _EDGE, literature=True)
    if upper == RECEIVE_CONDITIONS.name:
        return RECEIVE_CONDITIONS
    structure = _STRUCTURES.get(upper)
    return None if structure is None else _block(BlockKind.UDT, upper, ("", "", "", structure), literature=True)


@cache
def s7_1500_types() -> Mapping[str, Block]:
    """RDREC and WRREC as S7-1200/1500 have them, by name: merge them into the types of a layout.

    Their interface is Siemens' documentation; nothing confirms the offsets inside an instance.
    """
    names = _MODERN_RECORD.items()
    return MappingProxyType({n: _block(BlockKind.FB, n, sections, literature=True) for n, sections in names})


def standard_library() -> frozenset[str]:
    """Names of blocks, in upper case, that the standard library of STEP 7 V5 puts into the symbol table."""
    return frozenset({*_CLASSIC_RECORD, *_SYMBOLS})


@cache
def s7_300_types() -> Mapping[str, Block]:
    """TON, TOF, TP and the counters as S7-300/400 have them, by name: merge them into the types of a layout."""
    found = {name: system_block(name, classic=True) for name in _SYMBOLS}
    return MappingProxyType({name: block for name, block in found.items() if block is not None})


def family_types(family: str | None) -> Mapping[str, Block]:
    """System types that only one family of CPUs has like this; none if the family is not known."""
    if family in {"s7-1200", "s7-1500"}:
        return s7_1500_types()
    return s7_300_types() if family in {"s7-300", "s7-400"} else {}


def is_literature(block: Block) -> bool:
    """Whether the layout of a system type rests on literature instead of compiled blocks."""
    return block.attributes.get(_EVIDENCE) == _LITERATURE


def _block(kind: BlockKind, name: str, sections: tuple[str, ...], *, literature: bool = False) -> Block:
    groups = tuple(Section(k, _members(text)) for k, text in zip(_SECTIONS, sections, strict=False) if text)
    return Block(kind, name, groups, attributes={_EVIDENCE: _LITERATURE} if literature else {})


@cache
def _members(text: str) -> tuple[Member, ...]:
    return tuple(_member(*declaration.split()) for declaration in text.split(";"))


def _member(name: str, spelling: str) -> Member:
    count, star, base = spelling.rpartition("*")
    type_ = elementary(base) or NamedType(base)
    return Member(name, ArrayType(((1, int(count)),), type_) if star else type_)
