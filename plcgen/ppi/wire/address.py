"""Addresses as engineers write them: VB100, VW100, V100.3, M0.0, SMB34, AIW0, T32, HC0, VB100[20].

International and German mnemonics are read (E0.0 = I0.0, A0.0 = Q0.0, Z5 = C5, AEW0 = AIW0, AAW0 = AQW0), and
V as data block 1 (DB1.DBW100 = VW100). Source: SIMATIC S7-200 system manual, "Accessing data in the S7-200".
"""

from __future__ import annotations

import re

from plcgen.base.diagnostics import PlcgenError
from plcgen.base.diagnostics.suggest import did_you_mean
from plcgen.ppi.wire.areas import ELEMENT_SIZES, Area, TransportSize
from plcgen.ppi.wire.model import Item

HIGHEST = 0xFFFFFF
"""An item address has 24 bits: byte 2097151 bit 7, or element 16777215."""

SYS_SIZE = 20
"""``SYS`` alone is the CPU type: 20 bytes from byte 0."""

_AREAS = {area.name: area for area in Area} | {
    "E": Area.I, "A": Area.Q, "Z": Area.C, "AE": Area.AI, "AA": Area.AQ, "DB": Area.V,
}  # fmt: skip
_WIDTHS = {"B": TransportSize.BYTE, "W": TransportSize.WORD, "D": TransportSize.DWORD}
_LETTERS = {TransportSize.BYTE: "B", TransportSize.WORD: "W", TransportSize.DWORD: "D"}
_SIZES = {1: "B", 2: "W", 4: "D"}
_NAMES = "|".join(sorted((name for name in _AREAS if name != "DB"), key=len, reverse=True))
_PLAIN = re.compile(rf"({_NAMES})([BWDX]?)([0-9]+)(?:\.([0-9]+))?(?:\[([0-9]+)\])?", re.IGNORECASE)
_BLOCK = re.compile(r"(DB)([0-9]+)\.DB([BWDX])([0-9]+)(?:\.([0-9]+))?(?:\[([0-9]+)\])?", re.IGNORECASE)
_LONGEST = 40
_SPELLINGS = "write VB100, VW100, VD100, V100.3, M0.0, SMB34, AIW0, T32, C5, HC0 or VB100[20]"


class PpiAddressError(PlcgenError, ValueError):
    """Text that is not an S7-200 address: diagnostic code, what is wrong, how to write it."""

    def __init__(self, code: str, message: str, help_: str = _SPELLINGS) -> None:
        self.code, self.message, self.help = code, message, help_
        super().__init__(message)


def parse_item(text: str) -> Item:
    """Return the item an address means. Raises AddressError.

    ``VB100[20]`` are 20 bytes, ``T32[4]`` the timers T32 to T35, ``SYS`` the 20 bytes of the CPU type. A bit has no
    count: read the bytes.
    """
    spelling = text.strip().lstrip("%")
    if spelling.upper() == "SYS":
        return Item.memory(Area.SYS, 0, SYS_SIZE)
    block = _BLOCK.fullmatch(spelling) if len(spelling) <= _LONGEST else None
    if block is not None:
        return _from_block(text, block)
    match = _PLAIN.fullmatch(spelling) if len(spelling) <= _LONGEST else None
    if match is None:
        raise _unreadable(text)
    letters, width, number, bit, count = match.groups()
    area = _AREAS[letters.upper()]
    return _item(text, area, width.upper(), int(number), bit, _count(text, count))


def _from_block(text: str, match: re.Match[str]) -> Item:
    _, block, width, number, bit, count = match.groups()
    if int(block) != 1:
        raise PpiAddressError(
            "PG711", f'"{text}": an S7-200 has one data block, DB1, which is its V memory', "use VB, VW"
        )
    if width.upper() == "X" and bit is None:
        raise PpiAddressError("PG711", f'"{text}": the bit is missing', f"write DB1.DBX{number}.0")
    return _item(text, Area.V, width.upper(), int(number), bit, _count(text, count))


def _count(text: str, count: str | None) -> int:
    number = 1 if count is None else int(count)
    if not 1 <= number <= 0xFFFF:
        raise PpiAddressError("PG714", f'"{text}": the count is {number}; it is 1 to 65535', "write VB100[20]")
    return number


def _item(text: str, area: Area, width: str, number: int, bit: str | None, count: int) -> Item:
    if area.elements:
        if width or bit is not None:
            raise PpiAddressError("PG711", f'"{text}": {area.title} have a number only', f"write {area.name}{number}")
        _within(text, number)
        return Item.element(area, number, count)
    if bit is not None:
        if width not in {"", "X"}:
            raise PpiAddressError("PG711", f'"{text}": a bit has no width', f"write {area.name}{number}.{int(bit)}")
        return _bit(text, area, number, int(bit), count)
    if area is Area.SYS and not width:
        width = "B"
    if width in {"", "X"}:
        what = f"{area.title} are words" if area in {Area.AI, Area.AQ} else "the width is missing"
        raise PpiAddressError("PG711", f'"{text}": {what}', _ways(area, number))
    if area in {Area.AI, Area.AQ}:
        if width != "W":
            raise PpiAddressError(
                "PG711", f'"{text}": {area.title} are words', f"write {area.name}W{number - number % 2}"
            )
        if number % 2:
            help_ = f"write {area.name}W{number - 1} or {area.name}W{number + 1}"
            raise PpiAddressError("PG711", f'"{text}": {area.title} have even addresses', help_)
    _within(text, number * 8)
    return Item.memory(area, number, count, _WIDTHS[width])


def _bit(text: str, area: Area, byte: int, bit: int, count: int) -> Item:
    if area in {Area.AI, Area.AQ, Area.SYS}:
        raise PpiAddressError("PG711", f'"{text}": {area.title} have no bits', _ways(area, byte))
    if bit > 7:
        right = f"the bits of {area.name}B{byte} are {area.name}{byte}.0 to {area.name}{byte}.7"
        raise PpiAddressError("PG712", f'"{text}": bit {bit} is outside 0..7', right)
    if count != 1:
        bytes_ = f"{area.name}B{byte}" + (f"[{(bit + count + 7) // 8}]" if bit + count > 8 else "")
        raise PpiAddressError("PG714", f'"{text}": bits are read one at a time', f"read the bytes: {bytes_}")
    _within(text, byte * 8 + bit)
    return Item.bit(area, byte, bit)


def _within(text: str, address: int) -> None:
    if address > HIGHEST:
        raise PpiAddressError("PG713", f'"{text}": an item address has 24 bits', "the highest byte address is 2097151")


def _ways(area: Area, number: int) -> str:
    if area in {Area.AI, Area.AQ}:
        return f"write {area.name}W{number}"
    if area is Area.SYS:
        return f"write SYS{number}"
    name = area.name
    return f"write {name}B{number}, {name}W{number}, {name}D{number} or {name}{number}.0"


def _unreadable(text: str) -> PpiAddressError:
    letters = re.match(r"%?[A-Za-z]+", text.strip())
    if letters is None or len(text) > _LONGEST:
        return PpiAddressError("PG711", f'"{text[:_LONGEST]}" is not an S7-200 address')
    name = letters[0].lstrip("%").upper()
    stem = name[:-1] if len(name) > 1 and name[-1] in _WIDTHS else name
    if name in _AREAS or stem in _AREAS:
        return PpiAddressError("PG711", f'"{text}" is not an S7-200 address')
    known = ", ".join(area.name for area in Area)
    hint = did_you_mean(stem, [area.name for area in Area])
    return PpiAddressError("PG711", f'"{text}": there is no memory area "{stem}"', f"{hint} areas: {known}".strip())


def address_text(item: Item) -> str:
    """Write an item as an address; what has none (unknown area or size) is written with its numbers."""
    count = f"[{item.count}]" if item.count != 1 else ""
    try:
        area = Area(item.area)
    except ValueError:
        return f"area {item.area:02X}h size {item.size:02X}h address {item.address}{count}"
    if area.elements:
        kind = "" if item.size == ELEMENT_SIZES[area] else f" (size {item.size:02X}h)"
        return f"{area.name}{item.address}{count}{kind}"
    if item.size == TransportSize.BIT:
        return f"{area.name}{item.byte}.{item.bit_number}{count}"
    return f"{area.name}{_width(area, item)}{count}{_kind(item)}"


def _width(area: Area, item: Item) -> str:
    letter = _SIZES.get(item.octets // item.count if item.count else 0, "B")
    if area is Area.SYS and letter == "B":
        letter = ""
    return f"{letter}{item.byte}" + (f".{item.bit_number}" if item.bit_number else "")


def _kind(item: Item) -> str:
    if item.size in _LETTERS:
        return ""
    known = item.size in {TransportSize.CHAR, TransportSize.INT, TransportSize.DINT, TransportSize.REAL}
    return f" ({TransportSize(item.size).name})" if known else f" (size {item.size:02X}h)"
