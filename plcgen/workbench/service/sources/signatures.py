"""Parameters of instructions that are no function blocks, in the order in which they may be given without names.

Source: information system of the TIA Portal, "Basic instructions" and "Extended instructions" of the S7-1200/1500, and
the manual of S7-SCL for S7-300/400, "Standard functions of SCL".
"""

from __future__ import annotations

from collections.abc import Mapping

_ONE = "ABS SQR SQRT EXP EXPD LN LOG SIN COS TAN ASIN ACOS ATAN FRAC ROUND TRUNC CEIL FLOOR SWAP LEN MAX_LEN"
FUNCTIONS: Mapping[str, tuple[str, ...]] = {
    **dict.fromkeys(_ONE.split(), ("IN",)),
    **dict.fromkeys(("MIN", "MAX"), ("IN1", "IN2")),
    "LIMIT": ("MN", "IN", "MX"),
    "SEL": ("G", "IN0", "IN1"),
    "MUX": ("K", "IN0", "IN1", "INELSE"),
    **dict.fromkeys(("SHL", "SHR", "ROL", "ROR"), ("IN", "N")),
    "NORM_X": ("MIN", "VALUE", "MAX"),
    "SCALE_X": ("MIN", "VALUE", "MAX"),
    **dict.fromkeys(("LEFT", "RIGHT"), ("IN", "L")),
    **dict.fromkeys(("MID", "DELETE"), ("IN", "L", "P")),
    **dict.fromkeys(("CONCAT", "FIND"), ("IN1", "IN2")),
    "INSERT": ("IN1", "IN2", "P"),
    "REPLACE": ("IN1", "IN2", "L", "P"),
    **dict.fromkeys(("MOVE_BLK", "UMOVE_BLK", "FILL_BLK", "UFILL_BLK"), ("IN", "COUNT", "OUT")),
    **dict.fromkeys(("PEEK", "PEEK_BYTE", "PEEK_WORD", "PEEK_DWORD"), ("AREA", "DBNUMBER", "BYTEOFFSET")),
    "PEEK_BOOL": ("AREA", "DBNUMBER", "BYTEOFFSET", "BITOFFSET"),
    "POKE": ("AREA", "DBNUMBER", "BYTEOFFSET", "VALUE"),
    "POKE_BOOL": ("AREA", "DBNUMBER", "BYTEOFFSET", "BITOFFSET", "VALUE"),
    "BLKMOV": ("SRCBLK", "DSTBLK"),
    "FILL": ("BVAL", "BLK"),
    "RD_SYS_T": ("OUT",),
    "RD_LOC_T": ("OUT",),
    "WR_SYS_T": ("IN",),
}
