"""Names of the functions that STEP 7 V5 and the TIA Portal bring along, in upper case.

The table beside has the headings of the help of the TIA Portal V19 (en-US): "SCL" and "Extended instructions" of both
families, with the chapter of each, and parameters of functions in the order in which they may be given without names,
of those that take any number of inputs the first ones. The names below stand elsewhere: in the manuals of S7-SCL V5
and "System Software for S7-300/400, System and Standard Functions", or in the palettes of LAD. Conversions ``A_TO_B``
are not among them.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from types import MappingProxyType

S7_300, S7_1500 = "S7-300/400", "S7-1200/1500"
"""Families of the table."""
_TABLE = Path(__file__).with_name("instructions.tsv")
_TEXTS = "LEN CONCAT LEFT RIGHT MID DELETE INSERT REPLACE FIND MAX_LEN".split()  # noqa: SIM905
_OTHERS = frozenset(
    """AD_DT_TM AG_LOCK AG_LRECV AG_LSEND AG_RECV AG_SEND AG_UNLOCK ASSIGNMENT_ATTEMPT BITCMP BLOCK_DB_TO_WORD CALCULATE
    CONCAT_DATE_LTOD CONCAT_DATE_TOD COPY_HW CPU_RT DATALOGTYPEDEF DEC DI_STRNG DT_DATE DT_DAY DT_TIME DT_TOD
    D_ACT_DP_2 D_TOD_DT EQ_DT EQ_ELEMTYPE EQ_STRNG EQ_TYPE EXPD GEO_ADR GET_ERRORID GE_DT GE_STRNG GT_DT GT_STRNG INC
    IP_CONF I_ABORT I_GET I_PUT I_STRNG LEDSTAT LE_DT LE_STRNG LOG LT_DT LT_STRNG MCTA MOVE NE_DT NE_ELEMTYPE NE_STRNG
    NE_TYPE PARITY PEEK_BYTE PEEK_DWORD PEEK_LWORD PEEK_WORD PN_DP PN_IN PN_OUT PORT_CFG PORT_CONFIG RCV_CFG READ_CLK
    RECEIVE_CONFIG RTM_S R_STRNG S5TI_TIM SB_DT_DT SB_DT_TM SEND_CFG SEND_CONFIG SET_CLK SHA256 STRNG_DI STRNG_I
    STRNG_R SUM_BIT S_AVERZ S_EVERZ S_IMPULS S_SEVERZ S_VIMP TIM_S5TI TI_WKDAY UUID WORD_TO_BLOCK_DB X_ABORT X_GET
    X_PUT X_RCV X_SEND ZAEHLER""".split()  # noqa: SIM905
)


@cache
def _columns(head: str) -> Mapping[str, str]:
    """A column of the table: what is stated of each name."""
    heads, *rows = (line.split("\t") for line in _TABLE.read_text(encoding="utf-8").splitlines())
    column = heads.index(head)
    return MappingProxyType({row[0]: row[column] for row in rows if row[column]})


def documented(family: str) -> Mapping[str, str]:
    """Instructions of a family as the help spells them, each with its page and chapter: ``SCL: Move operations``."""
    return _columns(family)


@cache
def parameters() -> Mapping[str, tuple[str, ...]]:
    """Parameters of functions by name in upper case; of those that compute, and of a few others."""
    return MappingProxyType({name.upper(): tuple(text.split()) for name, text in _columns("parameters").items()})


INSTRUCTIONS = (
    _OTHERS
    | {f"{name}_{type_}" for name in _TEXTS for type_ in ("STRING", "WSTRING")}
    | {name.upper() for family in (S7_300, S7_1500) for name in documented(family)}
)

BY_NUMBER = {
    "SFB0": "CTU", "SFB1": "CTD", "SFB2": "CTUD", "SFB3": "TP", "SFB4": "TON", "SFB5": "TOF", "SFB8": "USEND",
    "SFB9": "URCV", "SFB12": "BSEND", "SFB13": "BRCV", "SFB14": "GET", "SFB15": "PUT", "SFB52": "RDREC",
    "SFB53": "WRREC", "SFB54": "RALRM", "SFC0": "SET_CLK", "SFC1": "READ_CLK", "SFC6": "RD_SINFO",
    "SFC14": "DPRD_DAT", "SFC15": "DPWR_DAT", "SFC20": "BLKMOV", "SFC21": "FILL", "SFC22": "CREAT_DB",
    "SFC41": "DIS_AIRT", "SFC42": "EN_AIRT", "SFC43": "RE_TRIGR", "SFC46": "STP", "SFC47": "WAIT", "SFC51": "RDSYSST",
    "SFC52": "WR_USMSG", "SFC58": "WR_REC", "SFC59": "RD_REC", "SFC64": "TIME_TCK", "SFC81": "UBLKMOV",
}  # fmt: skip
"""Instructions of the system function blocks and functions of the S7-300/400 by their numbers.

Source: "System Software for S7-300/400, System and Standard Functions", lists of the SFCs and SFBs.
"""
_DIFFERS = "its parameters are others"
ON_S7_1500 = {
    "SET_CLK": f"write WR_SYS_T(..): {_DIFFERS}",
    "READ_CLK": f"write RD_SYS_T(..): {_DIFFERS}",
    "CREAT_DB": f"write CREATE_DB(..): {_DIFFERS}",
    "RDSYSST": "there is none; GET_DIAG, DeviceStates and ModuleStates read some of what it reads",
    "WR_USMSG": "there is none, and none replaces it",
}
"""What to do about those of them that the S7-1200/1500 do not have.

Source: help of the TIA Portal, lists of the extended instructions of both families, and "Migrating PLC programs to a
S7-1500 CPU".
"""
