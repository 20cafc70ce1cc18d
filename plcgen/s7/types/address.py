"""Absolute addresses (``M50.0``, ``DB3.DBW6``, ``P#DB3.DBX0.0 BYTE 10``) as frozen values."""

from __future__ import annotations

import re
from dataclasses import dataclass

from plcgen.base.diagnostics import PlcgenError

AREAS = {"I": 0x81, "Q": 0x82, "M": 0x83, "DB": 0x84, "P": 0x80}
"""Memory areas by international mnemonic with their code in area pointers."""

_GERMAN = {"E": "I", "A": "Q", "PE": "PI", "PA": "PQ"}
_WIDTHS = {"X": 1, "B": 8, "W": 16, "D": 32}
_LETTERS = {width: letter for letter, width in _WIDTHS.items()}
_NAMES = {1: "BOOL", 8: "BYTE", 16: "WORD", 32: "DWORD"}
_KINDS = {"BOOL": (1, 1), "BYTE": (2, 8), "CHAR": (3, 8), "WORD": (4, 16), "INT": (5, 16), "DWORD": (6, 32)}
_KINDS |= {"DINT": (7, 32), "REAL": (8, 32), "DATE": (9, 16), "TIME_OF_DAY": (10, 32), "TIME": (11, 32)}
_KINDS |= {"S5TIME": (12, 16), "DATE_AND_TIME": (14, 64)}
_LAST_BYTE = 65535

_DB = re.compile(r"DB(?P<db>\d+)\.DB(?P<size>[XBWD])\s*(?P<byte>\d+)(?:\.(?P<bit>\d+))?", re.ASCII)
_PLAIN = re.compile(
    r"(?P<area>P[IQEA]|[IQEAM])(?P<size>[BWDX])?\s*(?P<byte>\d+)(?:\.(?P<bit>\d+))?(?P<io>:P)?",
    re.ASCII,
)
_POINTER = re.compile(
    r"P#\s*(?P<start>(?:DB\d+\.DBX|[IQEAM]|P)\s*\d+\.\d+)(?:\s+(?P<kind>[A-Z_0-9]+)\s+(?P<n>\d+))?",
    re.ASCII,
)


class AddressError(PlcgenError, ValueError):
    """A text that is no absolute address; ``text`` as given, ``reason`` says why."""

    def __init__(self, text: str, reason: str) -> None:
        self.text = text
        self.reason = reason
        super().__init__(f"{text}: {reason}")


@dataclass(frozen=True, slots=True)
class Address:
    """A place in memory: ``area`` I, Q, M, DB, PI or PQ; ``bit`` only for single bits; width in bits.

    Widths other than 1, 8, 16 and 32 are regions: whole bytes, written as ``P#`` pointers.
    """

    area: str
    db: int | None
    byte: int
    bit: int | None
    width_bits: int

    @property
    def offset(self) -> int:
        """First bit, counted from the start of the area."""
        return self.byte * 8 + (self.bit or 0)

    @property
    def type_name(self) -> str:
        """Type of what lies there by its width: ``BOOL``, ``BYTE``, ``WORD``, ``DWORD``; empty for a region."""
        return _NAMES.get(self.width_bits, "")

    def overlaps(self, other: Address) -> bool:
        """Whether the two places share at least one bit; PI and I (PQ and Q) are the same addresses."""
        if (self.area.removeprefix("P"), self.db) != (other.area.removeprefix("P"), other.db):
            return False
        return self.offset < other.offset + other.width_bits and other.offset < self.offset + self.width_bits

    def text(self, *, percent: bool = False) -> str:
        """Canonical international spelling, with a leading ``%`` if asked: ``%DB3.DBW6``."""
        place = f"{self.byte}" if self.bit is None else f"{self.byte}.{self.bit}"
        letter = _LETTERS.get(self.width_bits)
        if letter is None:
            start = f"DB{self.db}.DBX" if self.area == "DB" else self.area
            return f"P#{start}{self.byte}.{self.bit or 0} BYTE {self.width_bits // 8}"
        prefix = "%" if percent else ""
        if self.area == "DB":
            return f"{prefix}DB{self.db}.DB{letter}{place}"
        return f"{prefix}{self.area}{'' if self.bit is not None else letter}{place}"

    def __str__(self) -> str:
        return self.text()


@dataclass(frozen=True, slots=True)
class Pointer:
    """A ``P#`` constant: where it points and, for ANY, how many elements of which type lie there."""

    start: Address
    kind: str | None = None
    count: int = 1

    @property
    def region(self) -> Address:
        """Everything the pointer covers."""
        if self.kind is None:
            return self.start
        bits = _KINDS[self.kind][1] * self.count
        if bits == 1:
            return self.start
        return Address(self.start.area, self.start.db, self.start.byte, self.start.bit or None, bits)

    def __str__(self) -> str:
        where = f"P#{self.start}"
        return where if self.kind is None else f"{where} {self.kind} {self.count}"

    def pack_pointer(self) -> bytes:
        """POINTER, 6 bytes: DB number, then the area pointer."""
        area = "P" if self.start.area.startswith("P") else self.start.area
        return (self.start.db or 0).to_bytes(2) + (AREAS[area] << 24 | self.start.offset).to_bytes(4)

    def pack_any(self) -> bytes:
        """ANY, 10 bytes: 16#10, type code, count, DB number, area pointer."""
        code = _KINDS[self.kind or "BYTE"][0]
        return bytes((0x10, code)) + self.count.to_bytes(2) + self.pack_pointer()


def unpack_pointer(data: bytes) -> Pointer | None:
    """POINTER (6 bytes) or ANY (10 bytes) to a value; all zero is None. AddressError if neither."""
    if not any(data[1:] if len(data) == 10 else data):
        return None
    db, area_pointer = int.from_bytes(data[-6:-4]), int.from_bytes(data[-4:])
    areas = {code: area for area, code in AREAS.items()}
    area = areas.get(area_pointer >> 24)
    kinds = {code: kind for kind, (code, _) in _KINDS.items()}
    if area is None or (len(data) == 10 and data[1] not in kinds):
        raise AddressError(data.hex(), "not a pointer: unknown area or type code")
    offset = area_pointer & 0x7FFFF
    start = Address("PI" if area == "P" else area, db or None, offset // 8, offset % 8, 1)
    if len(data) == 6:
        return Pointer(start)
    return Pointer(start, kinds[data[1]], int.from_bytes(data[2:4]))


def parse_address(text: str) -> Address:
    """Parse any spelling: with or without ``%``, German mnemonics (E, A), ``:P``, ``P#`` regions.

    Raises AddressError with a reason.
    """
    upper = text.strip().upper()
    if upper.startswith("P#"):
        return parse_pointer(text).region
    upper = upper.removeprefix("%")
    match = _DB.fullmatch(upper)
    if match is not None:
        db = int(match["db"])
        if not 1 <= db <= 65535:
            raise AddressError(text, "a data block number is 1 to 65535")
        return _checked(text, "DB", db, match["size"], match)
    match = _PLAIN.fullmatch(upper)
    if match is None:
        raise AddressError(text, "an address looks like M50.0, MW52, DB3.DBX0.0 or DB3.DBW6")
    area = _GERMAN.get(match["area"], match["area"])
    if match["io"]:
        if area not in ("I", "Q"):
            raise AddressError(text, ":P goes with inputs and outputs only")
        area = f"P{area}"
    return _checked(text, area, None, match["size"] or "X", match)


def parse_pointer(text: str) -> Pointer:
    """Parse ``P#M50.0``, ``P#DB3.DBX0.0 BYTE 10``. Raises AddressError with a reason."""
    match = _POINTER.fullmatch(" ".join(text.upper().split()))
    if match is None:
        raise AddressError(text, "a pointer looks like P#M50.0 or P#DB3.DBX0.0 BYTE 10")
    where = match["start"].replace(" ", "")
    start = parse_address(f"PI{where[1:]}" if where.startswith("P") else where)
    kind = match["kind"]
    if kind is None:
        return Pointer(start)
    kind = {"TOD": "TIME_OF_DAY", "DT": "DATE_AND_TIME"}.get(kind, kind)
    if kind not in _KINDS:
        raise AddressError(text, f"a pointer cannot count elements of type {kind}")
    count = int(match["n"])
    if not 1 <= count <= 65535:
        raise AddressError(text, "a pointer counts 1 to 65535 elements")
    if kind != "BOOL" and start.bit:
        raise AddressError(text, f"elements of type {kind} start at bit 0")
    return Pointer(start, kind, count)


def _checked(text: str, area: str, db: int | None, size: str, match: re.Match[str]) -> Address:
    width, byte = _WIDTHS[size], int(match["byte"])
    bit = int(match["bit"]) if match["bit"] is not None else None
    if width == 1 and bit is None:
        raise AddressError(text, "a single bit needs byte and bit, for example M50.0")
    if width > 1 and bit is not None:
        raise AddressError(text, f"a {width}-bit access has no bit number")
    if bit is not None and bit > 7:
        raise AddressError(text, f"bit {bit}: a byte has bits 0 to 7")
    if byte + width // 8 - (width > 1) > _LAST_BYTE:
        raise AddressError(text, f"byte {byte} is beyond the last byte {_LAST_BYTE}")
    return Address(area, db, byte, bit, width)
