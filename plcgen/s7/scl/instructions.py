"""Names that STEP 7 V5 and the TIA Portal bring along: functions, instructions with memory, system data types.

The table beside has the headings of the help of the TIA Portal V19 (en-US): "SCL" and "Extended instructions" of both
families, with the chapter of each, and parameters of functions in the order in which they may be given without names,
of those that take any number of inputs the first ones. The names below stand elsewhere: in the manuals of S7-SCL V5
and "System Software for S7-300/400, System and Standard Functions", or in the palettes of LAD. Conversions ``A_TO_B``
are not among them.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from types import MappingProxyType

from plcgen.s7.types.data_types import elementary

S7_300, S7_1500 = "S7-300/400", "S7-1200/1500"
"""Families of the table."""
_TABLE = Path(__file__).with_name("instructions.tsv")
_TEXTS = "LEN CONCAT LEFT RIGHT MID DELETE INSERT REPLACE FIND MAX_LEN".split()
_OTHERS = frozenset(
    """AD_DT_TM AG_LOCK AG_LRECV AG_LSEND AG_RECV AG_SEND AG_UNLOCK ASSIGNMENT_ATTEMPT BITCMP BLOCK_DB_TO_WORD CALCULATE
    CONCAT_DATE_LTOD CONCAT_DATE_TOD COPY_HW CPU_RT DATALOGTYPEDEF DEC DI_STRNG DT_DATE DT_DAY DT_TIME DT_TOD
    D_ACT_DP_2 D_TOD_DT EQ_DT EQ_ELEMTYPE EQ_STRNG EQ_TYPE EXPD GEO_ADR GET_ERRORID GE_DT GE_STRNG GT_DT GT_STRNG INC
    IP_CONF I_ABORT I_GET I_PUT I_STRNG LEDSTAT LE_DT LE_STRNG LOG LT_DT LT_STRNG MCTA MOVE NE_DT NE_ELEMTYPE NE_STRNG
    NE_TYPE PARITY PEEK_BYTE PEEK_DWORD PEEK_LWORD PEEK_WORD PN_DP PN_IN PN_OUT PORT_CFG PORT_CONFIG RCV_CFG READ_CLK
    RECEIVE_CONFIG RTM_S R_STRNG S5TI_TIM SB_DT_DT SB_DT_TM SEND_CFG SEND_CONFIG SET_CLK SHA256 STRNG_DI STRNG_I
    STRNG_R SUM_BIT S_AVERZ S_EVERZ S_IMPULS S_SEVERZ S_VIMP TIM_S5TI TI_WKDAY UUID WORD_TO_BLOCK_DB X_ABORT X_GET
    X_PUT X_RCV X_SEND ZAEHLER""".split()
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


_TECHNOLOGY_OBJECT = re.compile(r"TO_\w+")
SYSTEM_TYPES = frozenset(
    """VARIANT VOID REMOTE IEC_TIMER IEC_LTIMER IEC_COUNTER IEC_SCOUNTER IEC_DCOUNTER IEC_UCOUNTER IEC_USCOUNTER
    IEC_UDCOUNTER IEC_LCOUNTER IEC_ULCOUNTER TON TOF TP TONR TON_TIME TOF_TIME TP_TIME TONR_TIME TON_LTIME
    TOF_LTIME TP_LTIME TONR_LTIME CTU CTD CTUD R_TRIG F_TRIG WRREC
    RDREC RALRM TCON TSEND TRCV TDISCON TSEND_C TRCV_C TUSEND TURCV PID_COMPACT ERROR_STRUCT ERRORSTRUCT NREF CREF
    TADDR_PARAM TCON_PARAM TCON_IP_V4 CONN_OUC CONN_ANY CONN_PRG CONN_R_ID HW_SUBMODULE HW_IOSYSTEM HW_HSC
    HW_PWM HW_PTO HW_DPMASTER HW_DPSLAVE HW_INTERRUPT OB_ANY OB_PCYCLE OB_CYCLIC OB_DELAY OB_TOD OB_ATT
    OB_HWINT OB_DIAG OB_TIMEERROR OB_STARTUP EVENT_ANY EVENT_ATT EVENT_HWINT AOM_IDENT RTM PIP INSTANCE
    TIMEVALUE BLOCK_SFC BLOCK_SFB VREF SSL_HEADER CONDITIONS HSC_PERIOD ASSOCVALUES RESOLVEDSYMBOL HW_MODULE
    HW_IEPORT DB_WWW DB_DYN C_ALARM C_ALARM_S C_ALARM_8 C_ALARM_8P C_AR_SEND C_NOTIFY C_NOTIFY_8P C_ALARM_SD
    TCON_PAR TCON_IP_RFC TCON_QDN TCON_QDN_SEC TCON_IP_V4_SEC TCON_CONFIGURED TCON_FDL TADDR_PAR
    TADDR_SEND_QDN TADDR_RCV_IP IP_V4 IF_CONF_V4 QDN PUT GET USEND URCV BSEND BRCV TRCV_C TMAIL_C T_CONFIG
    MB_CLIENT MB_SERVER MB_RED_CLIENT MB_RED_SERVER MODBUS_COMM_LOAD MODBUS_MASTER MODBUS_SLAVE P_SEND P_RCV
    RECEIVE_RESET PORT_CONFIG RECEIVE_CONFIG RECEIVE_CONDITIONS P_SND_RK P_RCV_RK
    SEND_PTP RCV_PTP SEND_P2P RECEIVE_P2P PROGRAM_ALARM PID_3STEP PID_TEMP PID_CYCLE PID_COMPACTCONFIG
    PID_COMPACTCONTROLPARAMS PID_COMPACTSELFTUNE CONT_C CONT_S PULSEGEN CTRL_HSC CTRL_HSC_EXT CTRL_PWM
    CTRL_PTO RS SR ALARM_S ALARM_SQ ALARM_8P NOTIFY_8P SET_TIMEZONE DPNRM_DG RD_REC WR_REC RCVREC PRVREC
    SINA_POS SINA_SPEED SINA_PARA SINA_PARA_S TO_SPEEDAXIS TO_POSITIONINGAXIS TO_SYNCHRONOUSAXIS
    TO_EXTERNALENCODER TO_AXIS TO_PTO TO_BASICPOS MC_POWER MC_RESET MC_HOME MC_HALT MC_STOP MC_MOVEABSOLUTE
    MC_MOVERELATIVE MC_MOVEVELOCITY MC_MOVEJOG MC_MOVESUPERIMPOSED MC_GEARIN MC_CAMIN MC_CHANGEDYNAMIC
    DATALOGOPEN DATALOGWRITE DATALOGCLOSE DATALOGCLEAR DATALOGDELETE DATALOGNEWFILE T_DIAG T_RESET TCONSETTINGS
    COMMCONFIG GET_ALARM ACK_ALARMS RECONFIGIOSYSTEM MB_COMM_LOAD MB_MASTER MB_SLAVE P3964_CONFIG SIGNAL_GET SIGNAL_SET
    GET_FEATURES SET_FEATURES OPC_UA_CONNECT OPC_UA_DISCONNECT OPC_UA_READLIST OPC_UA_WRITELIST OPC_UA_METHODCALL
    OPC_UA_NODEGETHANDLELIST OPC_UA_NODERELEASEHANDLELIST OPC_UA_METHODGETHANDLELIST OPC_UA_METHODRELEASEHANDLELIST
    OPC_UA_NAMESPACEGETINDEXLIST OPC_UA_TRANSLATEPATHLIST OPC_UA_CONNECTIONGETSTATUS OPC_UA_SERVERMETHODPRE
    OPC_UA_SERVERMETHODPOST LEAD_LAG DCAT MCAT DRUM IMC SMC""".split()
) | {
    f"{kind}_{unsigned}{size}INT"
    for kind in ("CTU", "CTD", "CTUD")
    for unsigned in ("", "U")
    for size in ("S", "", "D", "L")
}
"""Types by name that need no declaration and that are no elementary type of the block model."""


def is_type_name(name: str) -> bool:
    """Whether a name without quotes is a type that code can compare with: ``TypeOf(#v) = Int``, ``TO_SpeedAxis``."""
    upper = name.upper()
    return elementary(name) is not None or upper in {"STRING", "WSTRING"} or bool(_TECHNOLOGY_OBJECT.fullmatch(upper))
