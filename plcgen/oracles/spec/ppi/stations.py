"""The telegrams of an S7-200, and a line whose stations only record and answer. Written from documents alone:

- EN 50170 volume 2 (FDL): SD1, SD2 and E5; FCS is the sum of the bytes from DA on; the frame count bit;
- telegrams between STEP 7-Micro/WIN and a CPU 226 as an article prints them, with its errors corrected by their FCS:
  reads, writes, RUN and STOP;
- libnodave, nodave.h and testPPI: areas, several items in one request, timers and counters;
- S7-200 system manual, A5E00307987: areas and what can be written.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

AREAS: Mapping[str, int] = {
    "SYS": 0x03, "S": 0x04, "SM": 0x05, "AI": 0x06, "AQ": 0x07, "C": 0x1E, "T": 0x1F, "HC": 0x20,
    "I": 0x81, "Q": 0x82, "M": 0x83, "V": 0x84,
}  # fmt: skip
# Bytes of one element behind its status byte: a timer has 32 bits, a counter 16, a high-speed counter 32.
ELEMENTS: Mapping[int, int] = {0x1F: 4, 0x1E: 2, 0x20: 4}
# Transport sizes: bit, byte, char, word, int, dword, dint, real.
SIZES: Mapping[int, int] = {0x02: 1, 0x03: 1, 0x04: 2, 0x05: 2, 0x06: 4, 0x07: 4, 0x08: 4}
BIT, IN_BITS, IN_BYTES = 0x01, 0x04, 0x09
VARIABLE_MEMORY = 0x84
READ, WRITE, RUN, STOP = 0x04, 0x05, 0x28, 0x29
FIRST, POLLS = 0x6C, (0x5C, 0x7C)
GOOD = 0xFF
ACKNOWLEDGED = b"\xe5"
LONGEST_PDU = 240
SERVICES: Mapping[int, bytes] = {
    RUN: bytes.fromhex("28 00 00 00 00 00 00 FD 00 00 09") + b"P_PROGRAM",
    STOP: bytes.fromhex("29 00 00 00 00 00 09") + b"P_PROGRAM",
}
FORMS: Mapping[str, str] = {
    "BYTE": "B", "USINT": "B", "SINT": "b", "CHAR": "B", "WORD": "H", "UINT": "H", "INT": "h",
    "DWORD": "I", "UDINT": "I", "DINT": "i", "REAL": "f",
}  # fmt: skip

Number = int | float


class UndescribedError(ValueError):
    """Bytes that the documents do not describe."""


@dataclass(frozen=True, order=True)
class Extent:
    """Neighbouring bits of an area of bytes (``first`` is byte * 8 + bit), or elements of T, C, HC."""

    area: int
    first: int
    length: int

    @property
    def cells(self) -> range:
        """Numbers of its bits or elements."""
        return range(self.first, self.first + self.length)

    @property
    def counted(self) -> bool:
        """Whether it consists of elements with a status byte."""
        return self.area in ELEMENTS

    def __str__(self) -> str:
        name = next(name for name, area in AREAS.items() if area == self.area)
        if self.counted:
            return f"{name}{self.first}" + (f"[{self.length}]" if self.length > 1 else "")
        if self.length == 1:
            return f"{name}{self.first // 8}.{self.first % 8}"
        return f"{name}B{self.first // 8}" + (f"[{self.length // 8}]" if self.length > 8 else "")


def to_number(data: bytes, kind: str) -> Number:
    """The number that big-endian bytes are as an S7 type; a BOOL is 0 or 1."""
    if kind == "BOOL":
        return data[0]
    found: Number = struct.unpack(">" + FORMS[kind], data)[0]
    return found


def to_bytes(number: Number, kind: str) -> bytes:
    """The big-endian bytes of a number. Raises struct.error if it does not fit."""
    if kind == "BOOL":
        return bytes((bool(number),))
    return struct.pack(">" + FORMS[kind], number if kind == "REAL" else int(number))


@dataclass(frozen=True)
class AskedItem:
    """One item of a request: the place, and the bytes that are written there (a bit is one byte)."""

    place: Extent
    data: bytes = b""

    def bits(self) -> Iterator[tuple[int, int, int]]:
        """Area, cell and state of every bit that is written."""
        if self.place.length == 1:
            yield self.place.area, self.place.first, self.data[0]
            return
        for cell in self.place.cells:
            octet = self.data[(cell - self.place.first) // 8]
            yield self.place.area, cell, octet >> cell % 8 & 1


@dataclass(frozen=True)
class HeardRequest:
    """A request as a station understands it."""

    station: int
    source: int
    function_code: int
    reference: int
    service: int
    items: tuple[AskedItem, ...]


@dataclass(frozen=True)
class HeardPoll:
    """SD1: the station may send what it has."""

    station: int
    source: int
    function_code: int


def heard_frame_of(frame: bytes) -> HeardRequest | HeardPoll:
    """A frame of a master. Raises UndescribedError with what is wrong."""
    if len(frame) == 6 and frame[0] == 0x10:
        station, source, code = frame[1:4]
        _same(frame[4], (station + source + code) & 0xFF, "FCS")
        _same(frame[5], 0x16, "the end byte")
        if code not in POLLS:
            raise UndescribedError(f"function code {code:02X}h of a poll: 5Ch and 7Ch are defined")
        return HeardPoll(station, source, code)
    if len(frame) < 9 or frame[0] != 0x68 or frame[3] != 0x68:
        raise UndescribedError(f"no frame: {frame.hex(' ').upper()}")
    length = frame[1]
    _same(frame[2], length, "the repeated length")
    _same(len(frame), length + 6, "the length of the frame")
    _same(frame[-1], 0x16, "the end byte")
    _same(frame[-2], sum(frame[4:-2]) & 0xFF, "FCS")
    station, source, code = frame[4:7]
    if code != FIRST and code not in POLLS:
        raise UndescribedError(f"function code {code:02X}h: 6Ch, 5Ch and 7Ch are defined")
    return _job(frame[7:-2], station, source, code)


def _same(found: int, wanted: int, what: str) -> None:
    if found != wanted:
        raise UndescribedError(f"{what} is {found}, not {wanted}")


def _job(pdu: bytes, station: int, source: int, code: int) -> HeardRequest:
    if len(pdu) < 11 or len(pdu) > LONGEST_PDU:
        raise UndescribedError(f"a PDU of {len(pdu)} bytes")
    protocol, kind, reserved, reference, parameters, data = struct.unpack(">BBHHHH", pdu[:10])
    _same(protocol, 0x32, "the protocol")
    _same(kind, 1, "ROSCTR")
    _same(reserved, 0, "the reserved word")
    _same(len(pdu), 10 + parameters + data, "the length of the PDU")
    body, values = pdu[10 : 10 + parameters], pdu[10 + parameters :]
    service = body[0]
    if service in SERVICES:
        if body != SERVICES[service] or values:
            raise UndescribedError(f"{body.hex(' ').upper()} is neither RUN nor STOP")
        return HeardRequest(station, source, code, reference, service, ())
    if service not in (READ, WRITE) or len(body) < 2 or len(body) != 2 + 12 * body[1] or not body[1]:
        raise UndescribedError(f"parameters of service {service:02X}h: {body.hex(' ').upper()}")
    found = [_item(body[at : at + 12]) for at in range(2, len(body), 12)]
    if service == READ:
        _same(len(values), 0, "the length of the data of a read")
        return HeardRequest(station, source, code, reference, service, tuple(AskedItem(place) for place, _ in found))
    return HeardRequest(station, source, code, reference, service, tuple(_written(found, values)))


def _item(data: bytes) -> tuple[Extent, int]:
    """Extent and transport size of 12 bytes."""
    head, size, count, block, area, high, low = struct.unpack(">3sBHHBBH", data)
    address = high << 16 | low
    if head != b"\x12\x0a\x10" or area not in AREAS.values() or not count:
        raise UndescribedError(f"no item: {data.hex(' ').upper()}")
    _same(block, int(area == VARIABLE_MEMORY), "the data block")
    if area in ELEMENTS:
        _same(size, area, "the transport size of elements")
        return Extent(area, address, count), size
    if size == BIT:
        _same(count, 1, "the number of bits")
        return Extent(area, address, 1), size
    if size not in SIZES or address % 8:
        raise UndescribedError(f"transport size {size:02X}h at bit address {address}")
    if area in (AREAS["AI"], AREAS["AQ"]) and (SIZES[size] == 1 or address % 16):
        raise UndescribedError("analog inputs and outputs are words at even addresses")
    return Extent(area, address, 8 * SIZES[size] * count), size


def _written(items: list[tuple[Extent, int]], data: bytes) -> Iterator[AskedItem]:
    """Values of a write: 00, size code, length, value; a fill byte behind an odd one, free behind the last."""
    at = 0
    for place, size in items:
        octets = 1 if size == BIT else place.length // 8
        head = data[at : at + 4]
        wanted = (0, BIT + 2, 1) if size == BIT else (0, IN_BITS, 8 * octets)
        if place.counted or len(head) < 4 or struct.unpack(">BBH", head) != wanted:
            raise UndescribedError(f"value of {place}: {head.hex(' ').upper()}")
        value = data[at + 4 : at + 4 + octets]
        _same(len(value), octets, f"the number of bytes for {place}")
        if size == BIT and value[0] > 1:
            raise UndescribedError(f"bit {place} is {value[0]:02X}h")
        yield AskedItem(place, value)
        at += 4 + octets + octets % 2
    if len(data) not in (at, at - octets % 2):
        raise UndescribedError(f"{len(data)} bytes of values instead of {at}")


@dataclass
class AnsweringMemory:
    """What a station holds: bytes by area, elements by area and number; what was never set reads as ``rest``."""

    octets: dict[tuple[int, int], int] = field(default_factory=dict)
    elements: dict[tuple[int, int], bytes] = field(default_factory=dict)
    rest: int = 0

    def read(self, place: Extent) -> bytes:
        """Bytes at a place, without status bytes; a bit is 0 or 1."""
        if place.counted:
            size = ELEMENTS[place.area]
            return b"".join(self.elements.get((place.area, n), bytes((self.rest,)) * size) for n in place.cells)
        if place.length == 1:
            return bytes((self._octet(place.area, place.first // 8) >> place.first % 8 & 1,))
        return bytes(self._octet(place.area, at) for at in range(place.first // 8, place.cells.stop // 8))

    def put(self, place: Extent, data: bytes) -> None:
        """Store bytes as ``read`` returns them."""
        if place.counted:
            size = ELEMENTS[place.area]
            for number, cell in enumerate(place.cells):
                self.elements[place.area, cell] = data[number * size : (number + 1) * size]
        elif place.length == 1:
            at, mask = (place.area, place.first // 8), 1 << place.first % 8
            self.octets[at] = self._octet(*at) & ~mask | (mask if data[0] else 0)
        else:
            self.octets.update(((place.area, place.first // 8 + n), octet) for n, octet in enumerate(data))

    def _octet(self, area: int, at: int) -> int:
        return self.octets.get((area, at), self.rest)


@dataclass(frozen=True)
class HeardFrame:
    """A frame of the master: when its last character had left (ms), its bytes, and what it is."""

    time: int
    frame: bytes
    meaning: HeardRequest | HeardPoll
    again: bool
    """Whether it repeats the frame before, which the frame count bit tells: nothing is executed."""


@dataclass
class RecordingLine:
    """Stations on a line that execute nothing: they record, acknowledge and answer what their memory holds.

    ``deaf``: requests get no answer; ``mute``: polls get none; ``busy``: every poll gets E5; ``refuse``: every item
    gets a return code of its own, counted from 1. ``wrong`` collects what no document describes.
    """

    stations: dict[int, AnsweringMemory]
    deaf: bool = False
    mute: bool = False
    busy: bool = False
    refuse: bool = False
    heard: list[HeardFrame] = field(default_factory=list)
    codes: list[tuple[Extent, int]] = field(default_factory=list)
    wrong: list[str] = field(default_factory=list)
    longest: int = 0
    _last: dict[int, int] = field(default_factory=dict)
    _answers: dict[int, bytes] = field(default_factory=dict)
    _queue: list[tuple[int, bytes]] = field(default_factory=list)

    def receive(self, data: bytes, now: int) -> None:
        """Take the characters of one transmission."""
        try:
            meaning = heard_frame_of(data)
        except UndescribedError as problem:
            self.wrong.append(str(problem))
            return
        station, code = meaning.station, meaning.function_code
        again = code != FIRST and self._last.get(station, FIRST) & 0x20 == code & 0x20
        self.heard.append(HeardFrame(now, data, meaning, again))
        if station not in self.stations:
            return
        self._last[station] = code
        if isinstance(meaning, HeardRequest):
            if not self.deaf:
                self._answers[station] = self._answer(meaning)
                self._queue.append((now, ACKNOWLEDGED))
        elif not self.mute:
            answer = self._answers.get(station, b"")
            self._queue.append((now, ACKNOWLEDGED if self.busy or not answer else answer))

    @property
    def answers(self) -> bool:
        """Whether the last frame gets an answer."""
        last = self.heard[-1].meaning if self.heard else None
        return not (self.mute if isinstance(last, HeardPoll) else self.deaf)

    def due(self) -> int | None:
        """When the next answer begins."""
        return self._queue[0][0] if self._queue else None

    def transmit(self, now: int) -> bytes:
        """The answers that have begun."""
        ready = b"".join(data for time, data in self._queue if time <= now)
        self._queue = [entry for entry in self._queue if entry[0] > now]
        return ready

    def forget(self) -> None:
        """Begin a new record; the stations know what they heard last."""
        self.heard.clear()
        self.wrong.clear()
        self.codes.clear()
        self._queue.clear()

    def requests(self) -> list[HeardFrame]:
        """Requests that a station would execute."""
        return [heard for heard in self.heard if isinstance(heard.meaning, HeardRequest) and not heard.again]

    def _answer(self, request: HeardRequest) -> bytes:
        memory = self.stations[request.station]
        head = bytes((request.service, len(request.items))) if request.items else bytes((request.service,))
        codes = [self._code(asked) for asked in request.items]
        if request.service == WRITE:
            data = bytes(codes)
        else:
            data = b""
            for code, asked in zip(codes, request.items, strict=True):
                data += bytes(len(data) % 2) + (_value(memory, asked.place) if code == GOOD else bytes((code, 0, 0, 0)))
        pdu = struct.pack(">BBHHHHH", 0x32, 3, 0, request.reference, len(head), len(data), 0) + head + data
        body = bytes((request.source, request.station, 0x08)) + pdu
        self.longest = max(self.longest, len(body) + 6)
        return bytes((0x68, len(body), len(body), 0x68)) + body + bytes((sum(body) & 0xFF, 0x16))

    def _code(self, asked: AskedItem) -> int:
        if not self.refuse:
            return GOOD
        code = len(self.codes) % (GOOD - 1) + 1
        self.codes.append((asked.place, code))
        return code


def _value(memory: AnsweringMemory, place: Extent) -> bytes:
    """One item of a reply to a read."""
    data = memory.read(place)
    if place.counted:
        size = ELEMENTS[place.area]
        data = b"".join(b"\0" + data[at : at + size] for at in range(0, len(data), size))
        return struct.pack(">BBH", GOOD, IN_BYTES, len(data)) + data
    if place.length == 1:
        return struct.pack(">BBH", GOOD, BIT + 2, 1) + data
    return struct.pack(">BBH", GOOD, IN_BITS, 8 * len(data)) + data
