"""Records of a PROFINET device over UDP, as an IO supervisor: look-up, connect, write, read, release.

The connection is one with device access: no cyclic data, no submodules, no alarms, nothing is taken over from a
controller. One call is under way at a time; it is repeated with the same sequence number until its answer comes, so
that a device that has answered already answers the same once more.
"""

from __future__ import annotations

import contextlib
import ipaddress
import secrets
import socket
import time
import uuid
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from types import TracebackType
from typing import Protocol, Self, TypeVar

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, PlcgenError, Span
from plcgen.ds47.wire import pnio, rpc
from plcgen.ds47.wire.pnio import RecordBlock, Relation
from plcgen.ds47.wire.rpc import IO_DEVICE, Operation, Order, Packet, PacketError, PacketType
from plcgen.ds47.wire.status import explain_pnio

T = TypeVar("T")

TRIES = 5
"""So often a call is sent before its time is over."""
_ENTRIES = 32
"""Entries of an endpoint mapper that are looked at."""
_ASKED = {PacketType.RESPONSE, PacketType.FAULT, PacketType.REJECT, PacketType.WORKING, PacketType.NO_CALL}


@dataclass(frozen=True, slots=True)
class PnPartner:
    """Whom to ask: an IPv4 address; slot, subslot and API of the parameter access point; UDP port; the record, if it is
    not the device's usual one.
    """

    host: str
    slot: int = 1
    subslot: int = 1
    port: int = rpc.PORT
    api: int = pnio.PROFIDRIVE
    record: int | None = None

    def __str__(self) -> str:
        """As the command line has it."""
        port = "" if self.port == rpc.PORT else f":{self.port}"
        return f"pn://{self.host}{port}/{self.slot}.{self.subslot}"


def unicast(host: str) -> str:
    """Why an address cannot be that of one device; empty if it can."""
    try:
        address = ipaddress.IPv4Address(host)
    except ValueError:
        return "it is no IPv4 address"
    if address.is_multicast:
        return "it is a multicast address, so several devices would take the request"
    if address == ipaddress.IPv4Address("255.255.255.255") or address.is_reserved:
        return "it is a broadcast or reserved address"
    return "it is no address of a device" if address.is_unspecified else ""


class Link(Protocol):
    """What carries datagrams, with a clock in seconds."""

    def send(self, data: bytes) -> None:
        """Send a datagram. Raises OSError."""

    def receive(self, until: float) -> bytes | None:
        """The next datagram of the partner; None when that time has come. Raises OSError."""

    def now(self) -> float:
        """The time."""

    def pause(self, seconds: float) -> None:
        """Let time pass."""


class UdpLink:
    """A UDP socket for one partner; an answer may come from any of its ports. It has no right to broadcast."""

    def __init__(self, host: str, port: int) -> None:
        self._where = (host, port)
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)

    def send(self, data: bytes) -> None:
        """Send a datagram."""
        self._socket.sendto(data, self._where)

    def receive(self, until: float) -> bytes | None:
        """The next datagram of the partner."""
        while (left := until - time.monotonic()) > 0:
            self._socket.settimeout(left)
            try:
                data, (host, _) = self._socket.recvfrom(0x10000)
            except TimeoutError:
                return None
            except ConnectionError:  # Windows tells here that nobody listens; an answer to an earlier try may come
                continue
            if host == self._where[0]:
                return data
        return None

    def now(self) -> float:
        """The time of a clock that is never set."""
        return time.monotonic()

    def pause(self, seconds: float) -> None:
        """Let time pass."""
        time.sleep(seconds)

    def close(self) -> None:
        """Give the port back."""
        self._socket.close()


class RecordRefusedError(PlcgenError):
    """The device answered a read or a write of a record with a PNIO status other than 0."""

    def __init__(self, status: int) -> None:
        self.status = status
        super().__init__(f"{explain_pnio(status)} ({status:08X})")


class PnConnection:
    """A connection, open while it is a context.

    Raises:
        DiagnosticError: PG705 without an answer in time, PG708 if the device refuses, or answers what it must not.
    """

    def __init__(
        self, place: PnPartner, index: int, seconds: float = 5.0, link: Link | None = None, order: Order = "little"
    ) -> None:
        self.place, self.index = place, index
        self.link: Link = link or UdpLink(place.host, place.port)
        self._seconds, self._order = seconds, order
        self._activity = uuid.uuid4()
        self._calls = self._records = 0
        self._object = rpc.NIL
        self._open = False
        me = pnio.object_uuid(1, 0, 0)
        self._relation = Relation(uuid.uuid4(), secrets.randbelow(0xFFFF) + 1, me, mac=_mac())

    def __enter__(self) -> Self:
        try:
            self._connect()
        except BaseException:
            self._close()
            raise
        return self

    def _connect(self) -> None:
        self._object = self._look_up()
        body = self._call(Operation.CONNECT, pnio.encode_ar_request(self._relation), "connect")
        kind, ar, session = self._read(lambda: pnio.decode_ar_answer(body))
        if (kind, ar, session) != (self._relation.kind, self._relation.ar, self._relation.session):
            raise self._wrong("it accepted another connection than the one that was asked for")
        self._open = True

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            if self._open and not isinstance(value, DiagnosticError):
                with contextlib.suppress(DiagnosticError):
                    self._call(Operation.RELEASE, self._release(), "release")
            elif self._open:  # nobody may be there any more: say good-bye, and wait for nothing
                with contextlib.suppress(OSError):
                    self.link.send(rpc.encode_packet(self._request(Operation.RELEASE, IO_DEVICE, self._args())))
        finally:
            self._close()

    def _close(self) -> None:
        if isinstance(self.link, UdpLink):
            self.link.close()

    def write(self, data: bytes) -> None:
        """Write the record. Raises RecordRefusedError."""
        self._record(Operation.WRITE, pnio.WRITE_REQUEST, pnio.WRITE_ANSWER, data, len(data))

    def read(self, size: int) -> bytes:
        """Read the record, at most ``size`` octets. Raises RecordRefusedError."""
        return self._record(Operation.READ, pnio.READ_REQUEST, pnio.READ_ANSWER, b"", size)

    def _record(self, operation: Operation, kind: int, answer: int, data: bytes, size: int) -> bytes:
        self._records = (self._records + 1) & 0xFFFF
        place = (self._records, self._relation.ar, self.place.slot, self.place.subslot, self.index)
        blocks = pnio.encode_record(RecordBlock(kind, *place, size, data, self.place.api))
        body = self._call(operation, blocks, "")
        found = self._read(lambda: pnio.decode_record(body, answer))
        for name, wanted, came in zip(
            ("sequence number", "connection", "slot", "subslot", "record", "API"), (*place, self.place.api),
            (found.sequence, found.ar, found.slot, found.subslot, found.index, found.api), strict=True,
        ):  # fmt: skip
            if wanted != came:
                raise self._wrong(f"the answer has the {name} {came}, the request had {wanted}")
        if found.status:
            raise RecordRefusedError(found.status)
        if len(found.data) > size:
            raise self._wrong(f"the answer has {len(found.data)} bytes, {size} were asked for")
        return found.data

    def _look_up(self) -> uuid.UUID:
        """The object UUID of the device, out of its endpoint mapper."""
        handle = bytes(20)
        for _ in range(_ENTRIES):
            body, order = self._exchange(rpc.LOOKUP, rpc.ENDPOINT_MAPPER, pnio.encode_lookup(self._order, handle))
            found = self._read(partial(pnio.decode_found, body, order))
            device = next((one.object for one in found.entries if one.interface == IO_DEVICE), None)
            if device is not None:
                return device
            if found.status or not found.entries:
                break
            # the handle is handed back as it came: its UUID is in the order of that answer
            handle = found.handle if order == self._order else _turned(found.handle)
        raise self._wrong(
            "its endpoint mapper has no PROFINET device", "is it a PROFINET device, and the right address?"
        )

    def _release(self) -> bytes:
        return pnio.encode_release(self._relation.ar, self._relation.session)

    def _args(self) -> bytes:
        return pnio.encode_args(self._release(), self._order)

    def _call(self, operation: Operation, blocks: bytes, service: str) -> bytes:
        """The blocks of the answer to an operation; ``service`` names what must not be refused."""
        body, order = self._exchange(operation, IO_DEVICE, pnio.encode_args(blocks, self._order))
        status, found = self._read(lambda: pnio.decode_args(body, order))
        if status and service:
            raise self._wrong(f"it refused to {service}: {explain_pnio(status)} ({status:08X})", _ROOM)
        if status:
            raise RecordRefusedError(status)
        return found

    def _request(self, operation: int, interface: uuid.UUID, body: bytes) -> Packet:
        packet = Packet(
            PacketType.REQUEST, operation, self._activity, self._calls, body, interface,
            self._object, self._order, rpc.IDEMPOTENT,
        )  # fmt: skip
        self._calls += 1
        return packet

    def _exchange(self, operation: int, interface: uuid.UUID, body: bytes) -> tuple[bytes, Order]:
        """The body of the answer to a call, and its byte order."""
        request = self._request(operation, interface, body)
        strange, assembly = "", rpc.Assembly()
        try:
            for _ in range(TRIES):
                self.link.send(rpc.encode_packet(request))
                until = self.link.now() + self._seconds / TRIES
                while (data := self.link.receive(until)) is not None:
                    packet, doubt = _understood(data, request)
                    strange = doubt or strange
                    if packet is None or packet.kind is PacketType.WORKING:
                        continue
                    if packet.kind is PacketType.NO_CALL:
                        break
                    if packet.kind is not PacketType.RESPONSE:
                        code = int.from_bytes(packet.body[:4], packet.order)
                        raise self._wrong(f"it refused the call: RPC {packet.kind.name.lower()} {code:08X}h")
                    receipt = rpc.acknowledgement(packet)
                    if receipt is not None:
                        self.link.send(rpc.encode_packet(replace(receipt, object=request.object)))
                    whole = self._read(partial(assembly.add, packet))
                    if whole is not None:
                        return whole, packet.order
        except OSError as problem:
            group = isinstance(problem, PermissionError)  # the socket has no right to broadcast
            why = "it is the broadcast address of a network" if group else problem.strerror or str(problem)
            raise self._lost(f"cannot send to {self.place}: {why}") from problem
        told = f"; what came is no answer to this: {strange}" if strange else ""
        raise self._lost(f"{self.place} did not answer within {self._seconds:g} s{told}")

    def _read(self, decode: Callable[[], T]) -> T:
        try:
            return decode()
        except PacketError as problem:
            raise self._wrong(f"its answer cannot be read: {problem}") from problem

    def _wrong(self, message: str, help_: str = "") -> DiagnosticError:
        return DiagnosticError([Diagnostic("PG708", message, Span(str(self.place)), help=help_)])

    def _lost(self, message: str) -> DiagnosticError:
        silent = "a device with PROFINET Security may stay silent"
        help_ = f"is the address right, and may UDP port {self.place.port} pass? {silent}"
        return DiagnosticError([Diagnostic("PG705", message, Span(str(self.place)), help=help_)])


_ROOM = "nothing was changed; look which others are connected (controller, panel, PC), and try again when one has gone"


def _understood(data: bytes, request: Packet) -> tuple[Packet | None, str]:
    """A packet that answers this request, or why it does not."""
    try:
        packet = rpc.decode_packet(data)
    except PacketError as problem:
        return None, str(problem)
    if packet.activity != request.activity:
        return None, "it belongs to another connection"
    if packet.sequence != request.sequence:
        return None, f"it has the sequence number {packet.sequence}, not {request.sequence}"
    if packet.kind not in _ASKED:
        return None, f"it is of type {packet.kind.name.lower()}"
    return packet, ""


def _turned(handle: bytes) -> bytes:
    """A handle in the other byte order: a number and a UUID."""
    return handle[3::-1] + uuid.UUID(bytes=handle[4:]).bytes_le


def _mac() -> bytes:
    """A MAC address for the connection: this machine's, or a made-up local one, never a multicast one."""
    return (uuid.getnode() & ~(1 << 40)).to_bytes(6)
