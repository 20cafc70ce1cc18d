"""CPU families, and system types with a documented interface: function blocks, IEC timers, structures.

Blocks for serial modules: TIA Portal information system, "Point-to-point" and "PtP data link CP 341". Nothing confirms
the offsets inside an instance.

Members are spelled ``NAME TYPE`` or ``NAME 16*TYPE`` (an array from 1), separated by ``;``. Sources: Siemens,
"System Software for S7-300/400 System and Standard Functions", and the TIA Portal information system.
"""

from __future__ import annotations

from functools import cache, lru_cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Literal, get_args

from plcgen.s7.types.blocks import Block, BlockKind, Section, SectionKind
from plcgen.s7.types.data_types import ArrayType, DataType, Member, NamedType, StructType, elementary

if TYPE_CHECKING:
    from collections.abc import Mapping

Family = Literal["s7-300", "s7-400", "s7-1200", "s7-1500"]
FAMILIES: tuple[Family, ...] = get_args(Family)


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
_CLASSIC_SERIAL = {
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
    for name, parts in (_CLASSIC_SERIAL if classic else _MODERN).items():
        sections = (Section(kind, _serial_members(text)) for kind, text in zip(kinds, parts, strict=True))
        found[name] = Block(BlockKind.FB, name, tuple(sections), attributes={"evidence": "literature"})
    return MappingProxyType(found)


def _serial_members(text: str) -> tuple[Member, ...]:
    pairs = (part.split() for part in text.split(";"))
    return tuple(Member(name, _type(spelling)) for name, spelling in pairs)


def _type(spelling: str) -> DataType:
    count, _, name = spelling.rpartition("*")
    found = elementary(name) or NamedType(name)
    return ArrayType(((1, int(count)),), found) if count else found


def _struct(text: str, *more: Member) -> StructType:
    return StructType((*_serial_members(text), *more))


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
