"""Frames and PDUs of PPI as frozen values; ``fdl`` and ``pdu`` turn them into bytes and back."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypeAlias

from plcgen.ppi.wire.areas import ELEMENT_SIZES, OCTETS, PDU_LIMIT, Area, ReturnCode, Rosctr, SizeCode, TransportSize

ACKNOWLEDGE = 0xE5
CLIPPED = frozenset({0xF9, 0xFE})
"""E5 whose first bits were lost while the RS-485 driver turned around."""


# ---- Frames on the line (FDL, EN 50170) -----------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class VariableFrame:
    """SD2, ``68 LE LE 68 DA SA FC PDU FCS 16``: the frame that carries a PDU (1 to 246 bytes)."""

    destination: int
    source: int
    function: int
    pdu: bytes


@dataclass(frozen=True, slots=True)
class FixedFrame:
    """SD1, ``10 DA SA FC FCS 16``: poll, status request, short answer."""

    destination: int
    source: int
    function: int


@dataclass(frozen=True, slots=True)
class DataFrame:
    """SD3, ``A2 DA SA FC data FCS 16``: exactly eight bytes of data."""

    destination: int
    source: int
    function: int
    data: bytes


@dataclass(frozen=True, slots=True)
class TokenFrame:
    """SD4, ``DC DA SA``: a master hands the bus over."""

    destination: int
    source: int


@dataclass(frozen=True, slots=True)
class Acknowledgement:
    """SC, the single byte E5: "received, ask me later". ``received`` is what came in, F9 or FE if it was clipped."""

    received: int = field(default=ACKNOWLEDGE, compare=False)


Frame: TypeAlias = VariableFrame | FixedFrame | DataFrame | TokenFrame | Acknowledgement


# ---- Items ----------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Item:
    """One item of a read or write: ``count`` elements of ``size`` in ``area`` from ``address`` on.

    ``address`` is the number on the wire: byte * 8 + bit, or the element number for T, C and HC. ``area`` and ``size``
    are members of Area and TransportSize unless they came from a wrong telegram.
    """

    area: int
    size: int
    count: int
    address: int
    db: int = 0

    @classmethod
    def bit(cls, area: Area, byte: int, bit: int) -> Item:
        """One bit: ``Item.bit(Area.M, 0, 3)`` is M0.3."""
        return cls(area, TransportSize.BIT, 1, byte * 8 + bit, area.db)

    @classmethod
    def memory(cls, area: Area, byte: int, count: int = 1, size: TransportSize = TransportSize.BYTE) -> Item:
        """Bytes, words or double words from a byte address on: ``Item.memory(Area.V, 100, 20)`` is VB100[20]."""
        return cls(area, size, count, byte * 8, area.db)

    @classmethod
    def element(cls, area: Area, number: int, count: int = 1) -> Item:
        """Timers, counters or high-speed counters: ``Item.element(Area.T, 32)`` is T32."""
        return cls(area, ELEMENT_SIZES[area], count, number)

    @property
    def octets(self) -> int:
        """Length of its value in bytes, without pad; 0 if the size is unknown."""
        return OCTETS.get(self.size, 0) * self.count

    @property
    def by_element(self) -> bool:
        """Whether ``address`` counts elements (T, C, HC) instead of bits."""
        return self.area in ELEMENT_SIZES

    @property
    def byte(self) -> int:
        """Byte address (element number for T, C, HC)."""
        return self.address if self.by_element else self.address >> 3

    @property
    def bit_number(self) -> int:
        """Bit in the byte, 0 to 7."""
        return 0 if self.by_element else self.address & 7

    @property
    def size_code(self) -> SizeCode:
        """How its value is measured on the wire."""
        if self.size == TransportSize.BIT:
            return SizeCode.BIT
        return SizeCode.OCTETS if self.size in _ELEMENT_CODES else SizeCode.WORDS


_ELEMENT_CODES = frozenset(ELEMENT_SIZES.values())


@dataclass(frozen=True, slots=True)
class ItemWrite:
    """One item and the bytes to be written to it, big-endian, without pad; a bit is 00 or 01."""

    item: Item
    data: bytes


@dataclass(frozen=True, slots=True)
class ItemResult:
    """Answer of one item of a read: return code, and if it is FFh the value's size code and bytes without pad."""

    code: int
    data: bytes = b""
    size_code: int = SizeCode.NONE

    @classmethod
    def of(cls, item: Item, data: bytes) -> ItemResult:
        """Positive answer to an item."""
        return cls(ReturnCode.OK, data, item.size_code)

    @property
    def ok(self) -> bool:
        """Whether the item was read."""
        return self.code == ReturnCode.OK


# ---- PDUs -----------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class ReadRequest:
    """Function 04: read up to 19 items."""

    reference: int
    items: tuple[Item, ...]


@dataclass(frozen=True, slots=True)
class WriteRequest:
    """Function 05: write items. ``trailing_pad``: the last odd value has a pad byte, as STEP 7-Micro/WIN sends it."""

    reference: int
    items: tuple[ItemWrite, ...]
    trailing_pad: bool = False

    @classmethod
    def padded(cls, reference: int, items: tuple[ItemWrite, ...]) -> WriteRequest:
        """A request as STEP 7-Micro/WIN sends it: a last value of odd length has its pad byte, too."""
        return cls(reference, items, trailing_pad=bool(items and items[-1].item.octets % 2))


@dataclass(frozen=True, slots=True)
class SetupRequest:
    """Function F0: negotiate the PDU size (optional for an S7-200)."""

    reference: int
    pdu_size: int = PDU_LIMIT
    calling: int = 1
    called: int = 1


@dataclass(frozen=True, slots=True)
class RunRequest:
    """Function 28 with P_PROGRAM: put the CPU into RUN."""

    reference: int


@dataclass(frozen=True, slots=True)
class StopRequest:
    """Function 29 with P_PROGRAM: put the CPU into STOP."""

    reference: int


@dataclass(frozen=True, slots=True)
class ForceRequest:
    """Userdata 12 48 0B: force one item to ``data``, or end forcing it if ``data`` is None. Unconfirmed."""

    reference: int
    item: Item
    data: bytes | None


@dataclass(frozen=True, slots=True)
class Userdata:
    """Any other PDU with ROSCTR 7, taken as it is."""

    reference: int
    parameter: bytes
    data: bytes


@dataclass(frozen=True, slots=True)
class UnknownJob:
    """A job with a function that is none of the above, taken as it is; a CPU answers 8104h."""

    reference: int
    parameter: bytes
    data: bytes


@dataclass(frozen=True, slots=True)
class ReadReply:
    """Answer to a read: one result per item, in the order asked."""

    reference: int
    results: tuple[ItemResult, ...]


@dataclass(frozen=True, slots=True)
class WriteReply:
    """Answer to a write: one return code per item, in the order asked."""

    reference: int
    codes: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class SetupReply:
    """Answer to a negotiation."""

    reference: int
    pdu_size: int = PDU_LIMIT
    calling: int = 1
    called: int = 1


@dataclass(frozen=True, slots=True)
class AckReply:
    """Positive answer without data: to RUN (28h) and STOP (29h), or a bare ROSCTR 2 (``function`` None)."""

    reference: int
    function: int | None = None


@dataclass(frozen=True, slots=True)
class ErrorReply:
    """Answer with an error in its header: the job as a whole was refused."""

    reference: int
    error_class: int
    error_code: int
    rosctr: int = Rosctr.ACK
    parameter: bytes = b""
    data: bytes = b""

    @property
    def code(self) -> int:
        """Error class and code as one number, 8104h for example."""
        return self.error_class << 8 | self.error_code


@dataclass(frozen=True, slots=True)
class UnknownReply:
    """A positive answer to a function that is none of the above, taken as it is."""

    reference: int
    parameter: bytes
    data: bytes
    rosctr: int = Rosctr.ACK_DATA


Request: TypeAlias = (
    ReadRequest | WriteRequest | SetupRequest | RunRequest | StopRequest | ForceRequest | Userdata | UnknownJob
)
Reply: TypeAlias = ReadReply | WriteReply | SetupReply | AckReply | ErrorReply | UnknownReply
Pdu: TypeAlias = Request | Reply


@dataclass(slots=True)
class FrameCount:
    """Function codes of a master's requests to one station: 6C, 5C, 7C, 5C, ...

    6Ch sets the frame count bit and starts the sequence; from then on bit 5 alternates and a repetition keeps it.
    """

    last: int | None = None

    def following(self) -> int:
        """Return the function code of the next request, and remember it."""
        self.last = FIRST if self.last is None else 0x5C | (~self.last & FCB)
        return self.last

    def restart(self) -> None:
        """Begin with 6Ch again: after silence, the station may have forgotten the sequence."""
        self.last = None


FIRST = 0x6C
FCB, FCV, REQUEST = 0x20, 0x10, 0x40
"""Bits of a function code: frame count bit, frame count bit valid, request."""
