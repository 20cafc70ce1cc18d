"""The numbers of PPI: memory areas, transport sizes, functions, size codes of values.

Sources: SIMATIC S7-200 system manual (memory areas and their addressing), frames captured between STEP 7-Micro/WIN and
a CPU 226 (seed document 004), EN 50170 volume 2 for the function codes of the line.
"""

from __future__ import annotations

import enum

PDU_LIMIT = 240
"""Longest S7 PDU in bytes, in both directions, without negotiation."""

ITEM_LIMIT = 19
"""Most items of one telegram: 10 header + 2 + 12 * 19 = 240 bytes."""

READ_LIMIT = 222
"""Most bytes that one item reads: 240 - 12 header - 2 - 4."""

WRITE_LIMIT = 212
"""Most bytes that one item writes: 240 - 10 header - 2 - 12 - 4."""

JOB_HEADER, REPLY_HEADER = 10, 12
ITEM_SIZE = 12
VALUE_HEADER = 4


class Area(enum.IntEnum):
    """Memory area of an item (byte 27 of a read telegram)."""

    SYS = 0x03
    S = 0x04
    SM = 0x05
    AI = 0x06
    AQ = 0x07
    C = 0x1E
    T = 0x1F
    HC = 0x20
    I = 0x81  # noqa: E741 - the area is called I
    Q = 0x82
    M = 0x83
    V = 0x84

    @property
    def elements(self) -> bool:
        """Whether the area is addressed by element number (T32, C5, HC0) instead of byte and bit."""
        return self in _ELEMENTS

    @property
    def db(self) -> int:
        """Data block number of its items: V is data block 1, everything else 0."""
        return 1 if self is Area.V else 0

    @property
    def title(self) -> str:
        """Name in words."""
        return _TITLES[self]


_ELEMENTS = frozenset({Area.C, Area.T, Area.HC})
_TITLES = {
    Area.SYS: "system information",
    Area.S: "sequence control relays",
    Area.SM: "special memory",
    Area.AI: "analog inputs",
    Area.AQ: "analog outputs",
    Area.C: "counters",
    Area.T: "timers",
    Area.HC: "high-speed counters",
    Area.I: "inputs",
    Area.Q: "outputs",
    Area.M: "bit memory",
    Area.V: "variable memory",
}


class TransportSize(enum.IntEnum):
    """Kind of the elements of an item (byte 22 of a read telegram)."""

    BIT = 0x01
    BYTE = 0x02
    CHAR = 0x03
    WORD = 0x04
    INT = 0x05
    DWORD = 0x06
    DINT = 0x07
    REAL = 0x08
    COUNTER = 0x1E
    TIMER = 0x1F
    HIGH_SPEED_COUNTER = 0x20


OCTETS: dict[int, int] = {
    TransportSize.BIT: 1,
    TransportSize.BYTE: 1,
    TransportSize.CHAR: 1,
    TransportSize.WORD: 2,
    TransportSize.INT: 2,
    TransportSize.DWORD: 4,
    TransportSize.DINT: 4,
    TransportSize.REAL: 4,
    TransportSize.COUNTER: 3,
    TransportSize.TIMER: 5,
    TransportSize.HIGH_SPEED_COUNTER: 5,
}
"""Bytes of one element in a value: timer = status + 32 bits, counter = status + 16 bits.

The high-speed counter (status + 32 bits, like a timer) is not confirmed by a capture.
"""

ELEMENT_SIZES: dict[int, TransportSize] = {
    Area.C: TransportSize.COUNTER,
    Area.T: TransportSize.TIMER,
    Area.HC: TransportSize.HIGH_SPEED_COUNTER,
}
"""The one transport size of each area that is addressed by element number."""


class SizeCode(enum.IntEnum):
    """How a value is measured: 03 and 04 in bits, 09 in bytes, 00 for an item that failed."""

    NONE = 0x00
    BIT = 0x03
    WORDS = 0x04
    OCTETS = 0x09


class Rosctr(enum.IntEnum):
    """Kind of a PDU (its second byte)."""

    JOB = 1
    ACK = 2
    ACK_DATA = 3
    USERDATA = 7


class Function(enum.IntEnum):
    """What a PDU asks for (first byte of its parameters)."""

    READ = 0x04
    WRITE = 0x05
    PI_SERVICE = 0x28
    STOP = 0x29
    SETUP = 0xF0


class ReturnCode(enum.IntEnum):
    """Result of one item."""

    OK = 0xFF
    HARDWARE_FAULT = 0x01
    ACCESS_DENIED = 0x03
    OUT_OF_RANGE = 0x05
    TYPE_NOT_SUPPORTED = 0x06
    SIZE_MISMATCH = 0x07
    NOT_AVAILABLE = 0x0A
