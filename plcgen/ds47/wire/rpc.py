"""Packets of the connectionless DCE/RPC that carries PROFINET's records over UDP: header, fragments, both byte orders.

Sources: The Open Group C706 (DCE 1.1 RPC), chapter 12.5, connectionless PDUs; how PROFINET uses it (interfaces, port,
operations): IEC 61158-6-10, as the dissectors of the Wireshark project show it.
"""

from __future__ import annotations

import enum
import struct
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Literal, TypeAlias
from uuid import UUID

from plcgen.base.diagnostics import PlcgenError

Order: TypeAlias = Literal["little", "big"]

PORT = 34964
NIL = UUID(int=0)
IO_DEVICE = UUID("dea00001-6c97-11d1-8271-00a02442df7d")
ENDPOINT_MAPPER = UUID("e1af8308-5d1f-11c9-91a4-08002b14a0fa")
VERSIONS = {IO_DEVICE: 1, ENDPOINT_MAPPER: 3}
"""Major versions of the interfaces."""
HEADER = 80
LONGEST = 1464
"""Octets of a packet, header and body, as the device of a capture acknowledges them (tests/vectors/pnio.toml)."""
BODY = 1384
"""Octets of a fragment but for the last one: a multiple of 8; the controller of that capture sends as many."""
MAX_BODY = 64 * 1024
"""No operation of a record needs more: what promises more is no answer."""

LAST, FRAGMENT, NO_FACK, IDEMPOTENT = 0x02, 0x04, 0x08, 0x20
_LITTLE = 0x10
_REST = "IIIHHHHHBB"
_NO_HINT = 0xFFFF


class PacketType(enum.IntEnum):
    """Kinds of packets; others are ignored."""

    REQUEST = 0
    PING = 1
    RESPONSE = 2
    FAULT = 3
    WORKING = 4
    NO_CALL = 5
    REJECT = 6
    ACK = 7
    CANCEL = 8
    FACK = 9


class Operation(enum.IntEnum):
    """Operations of the device interface that are used."""

    CONNECT = 0
    RELEASE = 1
    READ = 2
    WRITE = 3


LOOKUP = 2
"""Operation of the endpoint mapper: what is there."""


class PacketError(PlcgenError, ValueError):
    """Bytes that are no packet, or whose content contradicts itself."""


@dataclass(frozen=True, slots=True)
class Packet:
    """One packet; ``activity`` and ``sequence`` say which call it belongs to, ``order`` is that of its numbers."""

    kind: PacketType
    operation: int
    activity: UUID
    sequence: int
    body: bytes = b""
    interface: UUID = IO_DEVICE
    object: UUID = NIL
    order: Order = "little"
    flags: int = 0
    fragment: int = 0
    serial: int = 0
    boot: int = 0

    @property
    def fragmented(self) -> bool:
        """Whether more packets belong to the same body."""
        return bool(self.flags & FRAGMENT)

    def answer(self, kind: PacketType, body: bytes = b"", boot: int = 0) -> Packet:
        """A packet of the same call in the other direction, with one of the numbers it began with."""
        return replace(self, kind=kind, body=body, flags=0, fragment=0, serial=0, boot=boot)


def encode_packet(packet: Packet) -> bytes:
    """The bytes of a datagram."""
    sign = "<" if packet.order == "little" else ">"
    head = bytes((4, packet.kind, packet.flags, 0, _LITTLE if packet.order == "little" else 0, 0, 0))
    names = b"".join(encode_uuid(one, packet.order) for one in (packet.object, packet.interface, packet.activity))
    rest = struct.pack(
        f"{sign}{_REST}", packet.boot, VERSIONS.get(packet.interface, 1), packet.sequence, packet.operation,
        _NO_HINT, _NO_HINT, len(packet.body), packet.fragment, 0, packet.serial & 0xFF,
    )  # fmt: skip
    return head + bytes((packet.serial >> 8,)) + names + rest + packet.body


def decode_packet(data: bytes) -> Packet:
    """The packet in a datagram; octets behind its body are padding. Raises PacketError."""
    if len(data) < HEADER:
        raise PacketError(f"{len(data)} bytes: the header of an RPC packet has {HEADER}")
    version, kind, flags, _, form = data[:5]
    if version != 4:
        raise PacketError(f"version {version} of the RPC protocol, not 4")
    if kind not in set(PacketType):
        raise PacketError(f"packets of type {kind} are not used here")
    if form >> 4 > 1 or form & 0x0F:
        raise PacketError(f"data representation {form:02X}h: neither byte order with ASCII")
    order: Order = "little" if form & _LITTLE else "big"
    object_, interface, activity = (decode_uuid(data[at : at + 16], order) for at in (8, 24, 40))
    boot, _, sequence, operation, _, _, size, fragment, protected, low = struct.unpack_from(
        f"{'<' if order == 'little' else '>'}{_REST}", data, 56
    )
    if protected:
        raise PacketError(f"authentication {protected}: only packets without it can be read")
    if len(data) - HEADER < size:
        raise PacketError(f"a body of {size} bytes is announced, {len(data) - HEADER} came")
    body = bytes(data[HEADER : HEADER + size])
    serial = data[7] << 8 | low
    return Packet(
        PacketType(kind), operation, activity, sequence, body, interface, object_, order, flags, fragment, serial, boot
    )


def encode_uuid(value: UUID, order: Order) -> bytes:
    """Its three numbers are in the byte order of the packet, the rest is octets."""
    return value.bytes_le if order == "little" else value.bytes


def decode_uuid(data: bytes, order: Order) -> UUID:
    """The other way round."""
    return UUID(bytes_le=data) if order == "little" else UUID(bytes=data)


def fragments(packet: Packet, size: int = BODY) -> Iterator[Packet]:
    """A packet as it is if its body fits, else as fragments of ``size`` octets, which nobody needs to acknowledge."""
    if len(packet.body) <= size:
        yield packet
        return
    for number, at in enumerate(range(0, len(packet.body), size)):
        last = LAST if at + size >= len(packet.body) else 0
        flags = packet.flags | FRAGMENT | NO_FACK | last
        yield replace(packet, body=packet.body[at : at + size], fragment=number, serial=number, flags=flags)


@dataclass(slots=True)
class Assembly:
    """Puts the fragments of one body together, in whatever order and however often they come."""

    parts: dict[int, bytes] = field(default_factory=dict)
    count: int | None = None
    size: int = 0

    def add(self, packet: Packet) -> bytes | None:
        """The whole body if nothing is missing any more. Raises PacketError if it becomes too long, or is no row."""
        if not packet.fragmented:
            return packet.body
        if packet.flags & LAST:
            self.count = packet.fragment + 1
        if packet.fragment not in self.parts:
            self.parts[packet.fragment] = packet.body
            self.size += len(packet.body)
        if self.size > MAX_BODY or (self.count is not None and max(self.parts) >= self.count):
            raise PacketError(f"fragments of {self.size} bytes, up to number {max(self.parts)}, are no body")
        if self.count is None or len(self.parts) < self.count:
            return None
        return b"".join(self.parts[number] for number in range(self.count))


def acknowledgement(packet: Packet) -> Packet | None:
    """What the sender of a fragment waits for: a FACK, with a window of one packet; None if it does not.

    Version 1 is what that device sends; C706 has 0.
    """
    if not packet.fragmented or packet.flags & NO_FACK or packet.kind not in {PacketType.REQUEST, PacketType.RESPONSE}:
        return None
    sign = "<" if packet.order == "little" else ">"
    body = struct.pack(f"{sign}BBHIIHH", 1, 0, 1, LONGEST, LONGEST, packet.serial, 0)
    return replace(packet.answer(PacketType.FACK, body, packet.boot), fragment=packet.fragment)
