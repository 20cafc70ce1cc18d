"""FDL frames of the PPI line (EN 50170): bytes <-> frozen frames, with every violation named.

``examine_frame`` returns what could be read and everything that is wrong; ``decode_frame`` raises PpiError instead.
The checksum FCS is the sum of all bytes from DA to the last one before it, modulo 256. There are no DSAP and SSAP
bytes on a PPI line.
"""

from __future__ import annotations

from plcgen.base.diagnostics.counting import quantity
from plcgen.ppi.wire.errors import Kind, PpiError, Violation
from plcgen.ppi.wire.model import (
    ACKNOWLEDGE,
    CLIPPED,
    FCB,
    FCV,
    REQUEST,
    Acknowledgement,
    DataFrame,
    FixedFrame,
    Frame,
    TokenFrame,
    VariableFrame,
)

SD1, SD2, SD3, SD4 = 0x10, 0x68, 0xA2, 0xDC
END = 0x16
BROADCAST = 127
LEAST_LENGTH, MOST_LENGTH = 4, 249
FIXED_SIZES = {SD1: 6, SD3: 14, SD4: 3, ACKNOWLEDGE: 1}
"""Bytes of the frames whose length does not vary, by their first byte."""

_REQUESTS = frozenset({0x0, 0x3, 0x4, 0x5, 0x6, 0x7, 0x9, 0xC, 0xD, 0xE, 0xF})
_RESPONSES = frozenset({0x0, 0x1, 0x2, 0x3, 0x8, 0x9, 0xA, 0xC, 0xD})
_WITH_FRAME_COUNT = frozenset({0x3, 0x5, 0xC, 0xD})

Examined = tuple[Frame | None, list[Violation]]


_E5 = Acknowledgement()


def checksum(data: bytes) -> int:
    """FCS of the bytes from DA to the last byte of the PDU."""
    return sum(data) & 0xFF


def encode_frame(frame: Frame) -> bytes:
    """Return the bytes of a frame; PpiError if an address, a function code or a length does not fit."""
    if isinstance(frame, Acknowledgement):
        return bytes((ACKNOWLEDGE,))
    found: list[Violation] = []
    function = None if isinstance(frame, TokenFrame) else frame.function
    for value in (frame.destination, frame.source, 0 if function is None else function):
        if not 0 <= value <= 0xFF:
            raise PpiError.of(Kind.STATION, f"{value} is not a byte")
    _check_stations(found, frame.destination, frame.source, 0, token=function is None)
    if function is not None:
        _check_function(found, function, 0)
    if isinstance(frame, DataFrame) and len(frame.data) != 8:
        found.append(Violation(Kind.LENGTH, 0, f"an SD3 frame carries 8 bytes, not {len(frame.data)}"))
    if isinstance(frame, VariableFrame) and not LEAST_LENGTH <= len(frame.pdu) + 3 <= MOST_LENGTH:
        found.append(Violation(Kind.LENGTH, 0, f"an SD2 frame carries 1 to 246 bytes, not {len(frame.pdu)}"))
    if found:
        raise PpiError(found)
    if isinstance(frame, TokenFrame):
        return bytes((SD4, frame.destination, frame.source))
    head = bytes((frame.destination, frame.source, frame.function))
    if isinstance(frame, FixedFrame):
        return bytes((SD1, *head, checksum(head), END))
    if isinstance(frame, DataFrame):
        body = head + frame.data
        return bytes((SD3,)) + body + bytes((checksum(body), END))
    return sd2(head + frame.pdu)


def sd2(body: bytes) -> bytes:
    """Put DA, SA, FC and PDU between start and checksum; nothing is checked."""
    length = len(body)
    return bytes((SD2, length, length, SD2)) + body + bytes((sum(body) & 0xFF, END))


def decode_frame(data: bytes) -> Frame:
    """Return the one frame in ``data``; PpiError with every violation. The PDU of an SD2 frame is not looked into."""
    frame, found = examine_frame(data)
    if found or frame is None:
        raise PpiError(found)
    return frame


def found_frame(data: bytes) -> Frame:
    """Return the frame in bytes that a Splitter has found: lengths, checksum and end byte are right already.

    Stations and function code are taken as they are.
    """
    start = data[0]
    if start == SD2:
        return VariableFrame(data[4], data[5], data[6], data[7:-2])
    if start == SD1:
        return FixedFrame(data[1], data[2], data[3])
    if start == SD3:
        return DataFrame(data[1], data[2], data[3], data[4:12])
    if start == SD4:
        return TokenFrame(data[1], data[2])
    return _E5 if start == ACKNOWLEDGE else Acknowledgement(start)


def examine_frame(data: bytes) -> Examined:
    """Return the frame as far as it can be read (None if not at all) and everything that is wrong with it."""
    if not data:
        return None, [Violation(Kind.SHORT, 0, "there are no bytes")]
    start = data[0]
    if start == SD2:
        return _variable(data)
    found: list[Violation] = []
    if start in {SD1, SD3}:  # a fixed length, a checksum and an end byte
        size = FIXED_SIZES[start]
        if len(data) < size:
            name = "SD1" if start == SD1 else "SD3"
            fields = "10 DA SA FC FCS 16" if start == SD1 else "A2 DA SA FC, 8 bytes of data, FCS 16"
            found.append(
                Violation(Kind.SHORT, len(data), f"an {name} frame has {size} bytes ({fields}), not {len(data)}")
            )
            return None, found
        _check_end(found, data, size)
        _check_tail(found, data, 1, size)
        _check_stations(found, data[1], data[2], 1)
        _check_function(found, data[3], 3)
        if start == SD1:
            return FixedFrame(data[1], data[2], data[3]), found
        return DataFrame(data[1], data[2], data[3], data[4:12]), found
    if start == ACKNOWLEDGE or start in CLIPPED:
        if start != ACKNOWLEDGE:
            text = f"{start:02X}h is an acknowledgement E5h whose first bits were lost"
            found.append(Violation(Kind.ACKNOWLEDGEMENT, 0, text))
        _check_end(found, data, 1)
        return Acknowledgement(start), found
    if start != SD4:
        text = f"{start:02X}h does not start a frame; frames start with 10h, 68h, A2h, DCh or are E5h"
        return None, [Violation(Kind.START, 0, text)]
    if len(data) < 3:
        return None, [Violation(Kind.SHORT, len(data), f"a token frame has 3 bytes, but there are {len(data)}")]
    _check_end(found, data, 3)
    _check_stations(found, data[1], data[2], 1, token=True)
    return TokenFrame(data[1], data[2]), found


def _variable(data: bytes) -> Examined:
    """SD2: both lengths, the second start byte, checksum and end byte are checked each on its own."""
    found: list[Violation] = []
    if len(data) < 4:
        text = f"an SD2 frame starts with 68 LE LE 68, but there are {len(data)} bytes"
        return None, [Violation(Kind.SHORT, len(data), text)]
    length, repeated = data[1], data[2]
    if not LEAST_LENGTH <= length <= MOST_LENGTH:
        found.append(Violation(Kind.LENGTH, 1, f"the length LE is {length}; it is 4 to 249"))
    if length != repeated:
        found.append(Violation(Kind.REPEATED_LENGTH, 2, f"the repeated length {repeated} differs from LE = {length}"))
    if data[3] != SD2:
        found.append(Violation(Kind.REPEATED_START, 3, f"the second start byte is {data[3]:02X}h instead of 68h"))
    size = length + 6
    if len(data) != size and len(data) == repeated + 6:
        size = len(data)
    if len(data) < size:
        text = f"LE = {length} makes a frame of {size} bytes, but there are {len(data)}"
        found.append(Violation(Kind.SHORT, len(data), text))
        return None, found
    _check_end(found, data, size)
    if size < 9:
        return None, found
    _check_tail(found, data, 4, size)
    _check_stations(found, data[4], data[5], 4)
    _check_function(found, data[6], 6)
    return VariableFrame(data[4], data[5], data[6], bytes(data[7 : size - 2])), found


def _check_end(found: list[Violation], data: bytes, size: int) -> None:
    if len(data) > size:
        more = len(data) - size
        found.append(Violation(Kind.TRAILING, size, f"{quantity(more, 'byte')} beyond the end of the frame"))


def _check_tail(found: list[Violation], data: bytes, first: int, size: int) -> None:
    """Check FCS and end byte of a frame of ``size`` bytes, summing from byte ``first`` on."""
    total = sum(data[first : size - 2]) & 0xFF
    if data[size - 2] != total:
        text = f"the checksum FCS is {data[size - 2]:02X}h, the bytes add up to {total:02X}h"
        found.append(Violation(Kind.CHECKSUM, size - 2, text))
    if data[size - 1] != END:
        found.append(Violation(Kind.END, size - 1, f"the end byte is {data[size - 1]:02X}h instead of 16h"))


def _check_stations(found: list[Violation], destination: int, source: int, at: int, *, token: bool = False) -> None:
    for offset, name, station in ((at, "destination", destination), (at + 1, "source", source)):
        if station > BROADCAST:
            text = f"the {name} {station:02X}h has bit 7 set: an address extension, which PPI does not have"
            found.append(Violation(Kind.STATION, offset, text))
    if source == BROADCAST:
        found.append(Violation(Kind.STATION, at + 1, "the source is 127, the broadcast address"))
    if token and destination == BROADCAST:
        found.append(Violation(Kind.STATION, at, "the token goes to 127, the broadcast address"))
    if destination == source and not token:
        found.append(Violation(Kind.STATION, at + 1, f"station {source} talks to itself"))


def _check_function(found: list[Violation], function: int, at: int) -> None:
    low, request = function & 0x0F, bool(function & REQUEST)
    if function & 0x80:
        found.append(Violation(Kind.FUNCTION_CODE, at, f"the function code {function:02X}h has the reserved bit 7 set"))
    elif low not in (_REQUESTS if request else _RESPONSES):
        kind = "request" if request else "answer"
        found.append(Violation(Kind.FUNCTION_CODE, at, f"the function code {function:02X}h is a reserved {kind}"))
    elif request and low in _WITH_FRAME_COUNT and not function & (FCB | FCV):
        text = f"the function code {function:02X}h has neither FCB nor FCV: a first request is {function | FCB:02X}h"
        found.append(Violation(Kind.FUNCTION_CODE, at, text))
