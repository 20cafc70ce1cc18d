"""An ISO-on-TCP server in front of a PPI line, so that S7 clients of any make reach an S7-200.

What goes to the line is built by our own client from decoded items; no byte of a foreign PDU is passed on. RUN, STOP,
force, blocks, passwords and every other service are answered with 8104h, function not supported.

Requests of all clients are served in turn. While the line is busy the others wait in their sockets; who sends without
reading his answers is not served further.
"""

from __future__ import annotations

import select
import time
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

from plcgen.base.diagnostics import DiagnosticError
from plcgen.base.line.model import LineError, LineLostError
from plcgen.base.line.tcp import TcpLine, TcpServer
from plcgen.ppi.client import Client, ClientError, RefusedError
from plcgen.ppi.client.values import Place
from plcgen.ppi.wire.address import address_text, parse_item
from plcgen.ppi.wire.areas import ELEMENT_SIZES, JOB_HEADER, OCTETS, PDU_LIMIT, Area, ReturnCode, Rosctr
from plcgen.ppi.wire.codes import return_code
from plcgen.ppi.wire.errors import TOLERABLE, Kind, PpiError
from plcgen.ppi.wire.iso import Connect, IsoError, IsoStream, carry, connect_confirm
from plcgen.ppi.wire.model import (
    ErrorReply,
    Item,
    ItemResult,
    ItemWrite,
    ReadReply,
    ReadRequest,
    Reply,
    SetupReply,
    SetupRequest,
    WriteReply,
    WriteRequest,
)
from plcgen.ppi.wire.pdu import PROTOCOL, encode_pdu, examine_pdu

NOT_SUPPORTED, LENGTH_ERROR, BUSY = 0x8104, 0x8500, 0x8404
PAUSE = 2.0
"""Seconds for which a line that cannot be opened is not tried again; clients hear of it at once."""

_JUDGED_BY_ITEM = TOLERABLE | {
    Kind.RESERVED, Kind.TRANSPORT_SIZE, Kind.COUNT, Kind.DATA_BLOCK, Kind.AREA, Kind.ADDRESS, Kind.VALUE_LENGTH,
    Kind.VALUE, Kind.SIZE_CODE, Kind.LIMIT, Kind.SERVICE,
}  # fmt: skip
"""The structure of the PDU is known all the same: what is wrong is answered by item, or as a whole later on."""

_AREAS = frozenset(Area)
_PLAIN = frozenset(OCTETS) - frozenset(ELEMENT_SIZES.values())
_END = 1 << 27


@dataclass(frozen=True, slots=True)
class Allowed:
    """What clients may write: ranges of bits of areas, from and to behind the last."""

    ranges: tuple[tuple[int, int, int], ...] = ()

    @classmethod
    def of(cls, words: Sequence[str]) -> Allowed:
        """``V``, ``VB100[20]``, ``M0.3``: an area or an address in it. Raises PpiAddressError."""
        return cls(tuple(map(_range, words)))

    def permits(self, item: Item) -> bool:
        """Whether all of an item lies in one of the ranges."""
        begin, end = _bits(item)
        return any(area == item.area and low <= begin and end <= high for area, low, high in self.ranges)


def _range(word: str) -> tuple[int, int, int]:
    whole = Area.__members__.get(word.strip().upper())
    if whole is not None and whole not in ELEMENT_SIZES:
        return whole, 0, _END
    item = parse_item(word)
    return item.area, *_bits(item)


def _bits(item: Item) -> tuple[int, int]:
    return item.address, item.address + (1 if item.size == 1 else item.octets * 8)


@dataclass(slots=True)
class Passing:
    """One station for all clients. ``connect`` opens its line; ``tell`` hears of each write and its result."""

    connect: Callable[[], Client]
    allowed: Allowed
    tell: Callable[[str, str, str], None]
    now: Callable[[], float]
    _client: Client | None = None
    _until: float = 0.0
    _words: str = field(default="", repr=False)

    def answer(self, data: bytes, who: str) -> bytes | None:
        """The answer to a PDU of a client; None if it is none, and the connection is of no use."""
        if len(data) < JOB_HEADER or data[0] != PROTOCOL or data[1] not in {Rosctr.JOB, Rosctr.USERDATA}:
            return None
        reference = data[4] << 8 | data[5]
        pdu, found = examine_pdu(data)
        if any(violation.kind not in _JUDGED_BY_ITEM for violation in found):
            return encode_pdu(_refusal(reference, LENGTH_ERROR))
        if isinstance(pdu, SetupRequest):
            return encode_pdu(SetupReply(reference, max(60, min(pdu.pdu_size, PDU_LIMIT)), 1, 1))
        try:
            if isinstance(pdu, ReadRequest):
                return encode_pdu(self._read(pdu))
            if isinstance(pdu, WriteRequest):
                return encode_pdu(self._write(pdu, who))
        except PpiError:  # an answer that is longer than a PDU
            return encode_pdu(_refusal(reference, LENGTH_ERROR))
        return encode_pdu(_refusal(reference, NOT_SUPPORTED))

    def close(self) -> None:
        """Give the line back."""
        if self._client is not None:
            self._client.close()
            self._client = None

    def _read(self, pdu: ReadRequest) -> Reply:
        items = [_plain(item) for item in pdu.items]
        codes = [_judge(item) for item in items]
        good = [item for item, code in zip(items, codes, strict=True) if code == ReturnCode.OK]
        if sum(item.octets for item in good) > PDU_LIMIT:
            return _refusal(pdu.reference, LENGTH_ERROR)
        try:
            results = iter(self._reach().read_items(good) if good else ())
        except RefusedError as problem:
            return _refusal(pdu.reference, problem.error or BUSY)
        except (ClientError, LineError) as problem:
            self._failed(problem)
            results = iter([ItemResult(ReturnCode.HARDWARE_FAULT)] * len(good))
        return ReadReply(
            pdu.reference, tuple(next(results) if code == ReturnCode.OK else ItemResult(code) for code in codes)
        )

    def _write(self, pdu: WriteRequest, who: str) -> Reply:
        entries = [replace(entry, item=_plain(entry.item)) for entry in pdu.items]
        codes: list[int] = [self._may_write(entry) for entry in entries]
        good = [entry for entry, code in zip(entries, codes, strict=True) if code == ReturnCode.OK]
        try:
            written = iter(self._write_items(good) if good else ())
            codes = [next(written) if code == ReturnCode.OK else code for code in codes]
            words = [return_code(code).text for code in codes]
        except RefusedError as problem:
            for entry in entries:
                self.tell(who, _text(entry), f"refused by the station: {problem.error:04X}h")
            return _refusal(pdu.reference, problem.error or BUSY)
        except (ClientError, LineError) as problem:
            self._failed(problem)
            fault = f"{return_code(ReturnCode.HARDWARE_FAULT).text}: {problem.diagnostics[0].message}"
            words = [fault if code == ReturnCode.OK else return_code(code).text for code in codes]
            codes = [ReturnCode.HARDWARE_FAULT if code == ReturnCode.OK else code for code in codes]
        for entry, word in zip(entries, words, strict=True):
            self.tell(who, _text(entry), word)
        return WriteReply(pdu.reference, tuple(codes))

    def _may_write(self, entry: ItemWrite) -> ReturnCode:
        code = _judge(entry.item)
        if code != ReturnCode.OK:
            return code
        if entry.item.by_element or not self.allowed.permits(entry.item):
            return ReturnCode.ACCESS_DENIED
        return ReturnCode.OK if len(entry.data) == entry.item.octets else ReturnCode.SIZE_MISMATCH

    def _write_items(self, entries: Sequence[ItemWrite]) -> list[int]:
        """Return codes; items that overlap, which one telegram of ours does not carry, are written one by one."""
        client, pairs = self._reach(), [(Place(address_text(each.item), each.item), each) for each in entries]
        try:
            return [written.code for written in client.write_items(pairs)]
        except (ClientError, LineError):
            raise
        except DiagnosticError:
            return [client.write_items([pair])[0].code for pair in pairs]

    def _reach(self) -> Client:
        """The client, with a line that is opened again if it is gone. Raises LineError."""
        if self._client is None:
            if self.now() < self._until:
                raise LineError("PG722", "", self._words)
            self._client = self.connect()
        return self._client

    def _failed(self, problem: ClientError | LineError) -> None:
        """After a lost line the next request opens it again, but not at once if it cannot be opened."""
        if isinstance(problem, LineError):
            if self._client is None and self.now() >= self._until:
                self._until = self.now() + PAUSE
                self._words = problem.diagnostics[0].message
            self.close()


def _plain(item: Item) -> Item:
    """The item with the data block that PPI wants: 1 for V if the client means that one, 0 elsewhere."""
    return item if item.area == Area.V else replace(item, db=0)


def _judge(item: Item) -> ReturnCode:
    """Whether an S7-200 has such an item, as far as that can be told without asking it."""
    if item.area not in _AREAS or (item.area == Area.V and item.db != Area.V.db):
        return ReturnCode.NOT_AVAILABLE
    if item.by_element:
        return ReturnCode.OK if item.size == ELEMENT_SIZES[item.area] and item.count else ReturnCode.TYPE_NOT_SUPPORTED
    if item.size not in _PLAIN or (item.size == 1 and item.count != 1):
        return ReturnCode.TYPE_NOT_SUPPORTED
    if not item.count:
        return ReturnCode.SIZE_MISMATCH
    return ReturnCode.OK if item.size == 1 or not item.bit_number else ReturnCode.OUT_OF_RANGE


def _refusal(reference: int, code: int) -> ErrorReply:
    return ErrorReply(reference, code >> 8, code & 0xFF)


def _text(entry: ItemWrite) -> str:
    return f"{address_text(entry.item)} = {entry.data.hex(' ').upper()}"


MOST_CONNECTIONS = 16
"""One more connection ends the one that was silent longest: nobody keeps others out by doing nothing."""
MOST_WAITING = 8
"""Requests of one connection that wait; a client that sends more without waiting for answers is cut off."""
IDLE = 600.0
_GREETING = 10.0
"""Seconds in which a new connection must have asked for its ISO connection."""
_PATIENCE = 0.25


@dataclass(slots=True)
class _Guest:
    """One connection."""

    heard: float
    stream: IsoStream = field(default_factory=IsoStream)
    waiting: deque[bytes] = field(default_factory=deque)
    greeted: bool = False


class Gateway:
    """Serves clients until ``ended()`` is true; ``tell`` hears who comes and goes."""

    def __init__(
        self,
        server: TcpServer,
        passing: Passing,
        tell: Callable[[str], None],
        *,
        most: int = MOST_CONNECTIONS,
        idle: float = IDLE,
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        self._server, self._passing, self._tell = server, passing, tell
        self._most, self._idle, self._now = most, idle, now
        self._guests: dict[TcpLine, _Guest] = {}

    def serve(self, ended: Callable[[], bool], patience: float = _PATIENCE) -> None:
        """Serve; returns when it is told to end, with all connections closed."""
        try:
            while not ended():
                self._turn(patience)
        finally:
            for line in list(self._guests):
                self._leave(line, "the gateway ends")
            self._passing.close()

    def _turn(self, patience: float) -> None:
        """Take what has arrived, then serve one request of each connection that can take its answer."""
        pending = [line for line, guest in self._guests.items() if guest.waiting]
        sources: list[TcpServer | TcpLine] = [self._server]
        sources += [line for line, guest in self._guests.items() if not guest.waiting]
        readable, writable, _ = select.select(sources, pending, [], patience)
        for source in readable:
            if isinstance(source, TcpServer):
                self._welcome()
            else:
                self._hear(source)
        for line in writable:
            self._serve(line)
        now = self._now()
        for line, guest in list(self._guests.items()):
            if now - guest.heard > (self._idle if guest.greeted else _GREETING) and not guest.waiting:
                self._leave(line, "silent for too long")

    def _welcome(self) -> None:
        line = self._server.accept(0)
        if line is None:
            return
        if len(self._guests) >= self._most:
            self._leave(min(self._guests, key=lambda each: self._guests[each].heard), "too many connections")
        self._guests[line] = _Guest(self._now())
        self._tell(f"{line.name} connected")

    def _hear(self, line: TcpLine) -> None:
        guest = self._guests.get(line)
        if guest is None:  # has left in this turn
            return
        try:
            for entry in guest.stream.feed(line.read(timeout=0)):
                guest.heard = self._now()
                if isinstance(entry, Connect) is guest.greeted or len(guest.waiting) >= MOST_WAITING:
                    self._leave(line, "requests out of order, or too many of them")
                    return
                if isinstance(entry, Connect):
                    line.write(connect_confirm(entry))
                    guest.greeted = True
                else:
                    guest.waiting.append(entry)
        except (IsoError, LineLostError) as problem:
            self._leave(line, str(problem))

    def _serve(self, line: TcpLine) -> None:
        guest = self._guests.get(line)
        if guest is None:
            return
        answer = self._passing.answer(guest.waiting.popleft(), line.name)
        guest.heard = self._now()
        if answer is None:
            self._leave(line, "no S7 PDU")
            return
        try:
            line.write(carry(answer))
        except LineLostError as problem:
            self._leave(line, str(problem))

    def _leave(self, line: TcpLine, why: str) -> None:
        del self._guests[line]
        line.close()
        self._tell(f"{line.name} disconnected: {why}")
