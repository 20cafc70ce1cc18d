"""Absolute operands: ``%DB3.DBW6``, ``%MW2``, ``%IW256:P`` as area, type and bit offset, and back."""

from __future__ import annotations

import re
from dataclasses import dataclass

_DATA = re.compile(r"%?DB(\d{1,5})\.DB([XBWDL])(\d{1,5})(?:\.([0-7]))?", re.IGNORECASE | re.ASCII)
_MEMORY = re.compile(r"%?(P?)([IQMEA])([XBWDL]?)(\d{1,5})(?:\.([0-7]))?(:P)?", re.IGNORECASE | re.ASCII)
_NUMBERED = re.compile(r"%(DB|T|C)(\d{1,5})", re.IGNORECASE | re.ASCII)
_TYPES = {"": "Bool", "X": "Bool", "B": "Byte", "W": "Word", "D": "DWord", "L": "LWord"}
_WIDTHS = {"Bool": "X", "Byte": "B", "Word": "W", "DWord": "D", "LWord": "L"}
_AREAS = {"I": "Input", "E": "Input", "Q": "Output", "A": "Output", "M": "Memory"}
_LETTERS = {"Input": "I", "Output": "Q", "Memory": "M", "PeripheryInput": "I", "PeripheryOutput": "Q"}
_WHOLE = {"DB": ("DB", "Block_DB"), "T": ("Timer", "Timer"), "C": ("Counter", "Counter")}


@dataclass(frozen=True, slots=True)
class Operand:
    """An absolute operand; ``bits`` is byte * 8 + bit, or the number of a DB, timer or counter as a whole."""

    area: str
    type: str
    bits: int
    block: int | None = None

    @property
    def text(self) -> str:
        """How SCL writes it, with the mnemonics I, Q, M."""
        if self.type in {"Block_DB", "Timer", "Counter"}:
            return f"%{'DB' if self.area == 'DB' else self.type[0]}{self.bits}"
        width = _WIDTHS.get(self.type, "")
        byte, bit = divmod(self.bits, 8)
        place = f"{byte}.{bit}" if width == "X" else str(byte)
        if self.block is not None:
            return f"%DB{self.block}.DB{width}{place}"
        peripheral = ":P" if self.area.startswith("Periphery") else ""
        return f"%{_LETTERS.get(self.area, 'M')}{'' if width == 'X' else width}{place}{peripheral}"


def address(text: str) -> Operand | None:
    """Read an operand of a source; None if it is no plain one, such as an indexed one."""
    if data := _DATA.fullmatch(text):
        block, letter, byte, bit = data.groups()
        if (letter.upper() == "X") != (bit is not None):
            return None
        return Operand("DB", _TYPES[letter.upper()], int(byte) * 8 + int(bit or 0), int(block))
    if memory := _MEMORY.fullmatch(text):
        early, area, letter, byte, bit, late = memory.groups()
        if (letter.upper() in {"", "X"}) != (bit is not None):
            return None
        name = _AREAS[area.upper()]
        if early or late:
            if name == "Memory":
                return None
            name = f"Periphery{name}"
        return Operand(name, _TYPES[letter.upper()], int(byte) * 8 + int(bit or 0))
    if whole := _NUMBERED.fullmatch(text):
        area, kind = _WHOLE[whole[1].upper()]
        return Operand(area, kind, int(whole[2]))
    return None
