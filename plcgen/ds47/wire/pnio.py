"""What PROFINET's connect, release, read and write carry, and the look-up of the endpoint mapper.

Numbers of blocks are big-endian, those around them (NDR) in the order of the packet. Source: IEC 61158-6-10, PROFINET
IO protocol, as the dissectors of the Wireshark project show it; captures are in ``tests/vectors/pnio.toml``.

Only one kind of application relation can be built here: an IO supervisor's with device access, which gets no cyclic
data, expects no submodules and takes none over.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from uuid import UUID

from plcgen.ds47.wire.rpc import ENDPOINT_MAPPER, NIL, Order, PacketError, decode_uuid, encode_uuid

AR_REQUEST, AR_ANSWER = 0x0101, 0x8101
RELEASE_REQUEST, RELEASE_ANSWER = 0x0114, 0x8114
WRITE_REQUEST, WRITE_ANSWER = 0x0008, 0x8008
READ_REQUEST, READ_ANSWER = 0x0009, 0x8009

SUPERVISOR = 0x0006
"""AR type of an IO supervisor; that of a controller is 1."""
ACTIVE, TAKEOVER, BY_INITIATOR, DEVICE_ACCESS = 1, 1 << 3, 1 << 4, 1 << 8
PROPERTIES = ACTIVE | BY_INITIATOR | DEVICE_ACCESS
"""Bits of the only relation that is sent: neither takeover (bit 3) nor a companion."""
REAL_TIME_PORT = 0x8892
RELEASE, DONE = 0x0004, 0x0008
STATION = b"plcgen"
ANSWER_ROOM = 4096
"""Octets that an answer may have, as controllers announce it."""

_AR = ">HHBBH16sH6s16sIHHH"
_AR_ANSWER = ">HHBBH16sH6sH"
_CONTROL = ">HHBBH16sHHHH"
_RECORD = ">HHBBH16sIHHHHI"
PROFIDRIVE = 0x3A00
"""API of the PROFIdrive profile; 0 is that of the device (Magnetek IMPULSE G+, PROFINET manual 08/2014, table 20)."""
RECORD_HEADER = 64
"""Octets of the header of a record, in both directions."""


@dataclass(frozen=True, slots=True)
class Relation:
    """An application relation as its two ends know it: number, session, and the object UUID of the initiator."""

    ar: UUID
    session: int
    initiator: UUID
    kind: int = SUPERVISOR
    properties: int = PROPERTIES
    timeout: int = 100
    mac: bytes = bytes(6)
    station: bytes = STATION


@dataclass(frozen=True, slots=True)
class RecordBlock:
    """Header of a record that is read or written, or of its answer; ``size`` octets of data follow or are wanted.

    ``status`` is the PNIO status that the answer to a write has once more.
    """

    kind: int
    sequence: int
    ar: UUID
    slot: int
    subslot: int
    index: int
    size: int
    data: bytes = b""
    api: int = PROFIDRIVE
    status: int = 0


def object_uuid(instance: int, device: int, vendor: int) -> UUID:
    """The object UUID of a station: its instance, device ID and vendor ID."""
    return UUID(f"dea00000-6c97-11d1-8271-{instance:04x}{device:04x}{vendor:04x}")


def encode_args(blocks: bytes, order: Order, first: int = ANSWER_ROOM, room: int = ANSWER_ROOM) -> bytes:
    """Blocks as NDR: ``first`` is the room for an answer, or in an answer its status; then length and array."""
    sign = "<" if order == "little" else ">"
    return struct.pack(f"{sign}IIIII", first, len(blocks), max(room, len(blocks)), 0, len(blocks)) + blocks


def decode_args(body: bytes, order: Order) -> tuple[int, bytes]:
    """The first number and the blocks. Raises PacketError."""
    if len(body) < 20:
        raise PacketError(f"the arguments of an operation have 20 bytes at least, not {len(body)}")
    first, length, maximum, offset, actual = struct.unpack_from(f"{'<' if order == 'little' else '>'}IIIII", body)
    if offset or length != actual or actual > maximum or len(body) - 20 < actual:
        told = f"length {length}, array of {actual} from {offset} of {maximum}, {len(body) - 20} bytes"
        raise PacketError(f"the arguments contradict each other: {told}")
    return first, body[20 : 20 + actual]


def _head(data: bytes, kinds: tuple[int, ...], least: int) -> int:
    """Type of the block in front, whose length and version must fit. Raises PacketError."""
    if len(data) < 6:
        raise PacketError(f"{len(data)} bytes are no block")
    kind, length, high, low = struct.unpack_from(">HHBB", data)
    if kind not in kinds:
        raise PacketError(f"a block of type {kind:04X}h came, not {' or '.join(f'{one:04X}h' for one in kinds)}")
    if high != 1:
        raise PacketError(f"version {high}.{low} of block {kind:04X}h is unknown")
    if length + 4 < least or len(data) < length + 4:
        raise PacketError(f"block {kind:04X}h says that it has {length} bytes more, {len(data) - 4} came")
    return int(kind)


def encode_ar_request(relation: Relation) -> bytes:
    """The only block of a connect request."""
    size = struct.calcsize(_AR)
    return struct.pack(
        _AR, AR_REQUEST, size - 4 + len(relation.station), 1, 0, relation.kind, relation.ar.bytes, relation.session,
        relation.mac, relation.initiator.bytes, relation.properties, relation.timeout, REAL_TIME_PORT,
        len(relation.station),
    ) + relation.station  # fmt: skip


def decode_ar_request(data: bytes) -> tuple[Relation, bytes]:
    """The relation that a connect request asks for, and the blocks behind it. Raises PacketError."""
    size = struct.calcsize(_AR)
    _head(data, (AR_REQUEST,), size)
    _, length, _, _, kind, ar, session, mac, initiator, properties, timeout, _, name = struct.unpack_from(_AR, data)
    if size + name > length + 4:
        raise PacketError(f"a station name of {name} bytes does not fit into the block")
    station = data[size : size + name]
    found = Relation(UUID(bytes=ar), session, UUID(bytes=initiator), kind, properties, timeout, mac, station)
    return found, data[length + 4 :]


def encode_ar_answer(relation: Relation, mac: bytes) -> bytes:
    """The only block of the answer."""
    size = struct.calcsize(_AR_ANSWER) - 4
    return struct.pack(
        _AR_ANSWER, AR_ANSWER, size, 1, 0, relation.kind, relation.ar.bytes, relation.session, mac, REAL_TIME_PORT
    )


def decode_ar_answer(data: bytes) -> tuple[int, UUID, int]:
    """Type, number and session of the relation that was accepted. Raises PacketError."""
    _head(data, (AR_ANSWER,), struct.calcsize(_AR_ANSWER))
    _, _, _, _, kind, ar, session, _, _ = struct.unpack_from(_AR_ANSWER, data)
    return kind, UUID(bytes=ar), session


def encode_release(ar: UUID, session: int, *, answer: bool = False) -> bytes:
    """The block that ends a relation, or that says that it has ended."""
    kind, command = (RELEASE_ANSWER, DONE) if answer else (RELEASE_REQUEST, RELEASE)
    return struct.pack(_CONTROL, kind, struct.calcsize(_CONTROL) - 4, 1, 0, 0, ar.bytes, session, 0, command, 0)


def decode_release(data: bytes) -> tuple[int, UUID, int, int]:
    """Type of block, number and session of the relation, and the command. Raises PacketError."""
    kind = _head(data, (RELEASE_REQUEST, RELEASE_ANSWER), struct.calcsize(_CONTROL))
    _, _, _, _, _, ar, session, _, command, _ = struct.unpack_from(_CONTROL, data)
    return kind, UUID(bytes=ar), session, command


def encode_record(block: RecordBlock) -> bytes:
    """A record's header of 64 octets, and its data."""
    head = struct.pack(
        _RECORD, block.kind, RECORD_HEADER - 4, 1, 0, block.sequence, block.ar.bytes, block.api, block.slot,
        block.subslot, 0, block.index, block.size,
    )  # fmt: skip
    if block.kind == WRITE_ANSWER:
        head += struct.pack(">HHI", 0, 0, block.status)
    return head.ljust(RECORD_HEADER, b"\0") + block.data


def decode_record(data: bytes, kind: int) -> RecordBlock:
    """The header, and the data that came with it: as many octets as it says, if it brings any. Raises PacketError."""
    _head(data, (kind,), RECORD_HEADER)
    _, _, _, _, sequence, ar, api, slot, subslot, _, index, size = struct.unpack_from(_RECORD, data)
    brings = kind in {WRITE_REQUEST, READ_ANSWER}
    if brings and len(data) - RECORD_HEADER < size:
        raise PacketError(f"the record has {size} bytes by its header, {len(data) - RECORD_HEADER} came")
    content = data[RECORD_HEADER : RECORD_HEADER + size] if brings else b""
    status = int.from_bytes(data[44:48]) if kind == WRITE_ANSWER else 0
    return RecordBlock(kind, sequence, UUID(bytes=ar), slot, subslot, index, size, content, api, status)


@dataclass(frozen=True, slots=True)
class Endpoint:
    """One entry of the endpoint mapper: the interface, the object that offers it, where, and a text."""

    interface: UUID
    object: UUID
    port: int = 0
    text: str = ""


@dataclass(frozen=True, slots=True)
class Found:
    """An answer of the endpoint mapper: entries, the handle to ask on with, the status (0: good)."""

    entries: tuple[Endpoint, ...]
    handle: bytes
    status: int


NOT_REGISTERED = 0x16C9A0D6
"""Status of the endpoint mapper: there are no more entries."""
_NDR = UUID("8a885d04-1ceb-11c9-9fe8-08002b104860")
_HANDLE = 20
_UUID_FLOOR, _CONNECTIONLESS, _UDP, _IP = 0x0D, 0x0A, 0x08, 0x09


def encode_lookup(order: Order, handle: bytes = bytes(_HANDLE), most: int = 1) -> bytes:
    """Ask for all entries (inquiry 0): the object and the interface do not matter then."""
    sign = "<" if order == "little" else ">"
    nothing = encode_uuid(NIL, order)
    head = struct.pack(f"{sign}II", 0, 1) + nothing + struct.pack(f"{sign}I", 2) + nothing
    return head + struct.pack(f"{sign}HHI", 0, 0, 1) + handle + struct.pack(f"{sign}I", most)


def decode_lookup(body: bytes, order: Order) -> tuple[int, bytes, int]:
    """Kind of inquiry, handle, and the number of entries that are wanted. Raises PacketError."""
    if len(body) < 76:
        raise PacketError(f"a look-up has 76 bytes, not {len(body)}")
    sign = "<" if order == "little" else ">"
    (inquiry,) = struct.unpack_from(f"{sign}I", body)
    (most,) = struct.unpack_from(f"{sign}I", body, 72)
    return inquiry, body[52:72], most


def encode_found(found: Found, order: Order, address: bytes = bytes(4)) -> bytes:
    """An answer of the endpoint mapper with one entry, or with none."""
    sign = "<" if order == "little" else ">"
    count = len(found.entries)
    out = found.handle + struct.pack(f"{sign}IIII", count, count, 0, count)
    for entry in found.entries:
        text = entry.text.encode("ascii", "replace")[:63] + b"\0"
        out += encode_uuid(entry.object, order) + struct.pack(f"{sign}III", 3, 0, len(text))
        out += text + bytes(-len(text) % 4)
        tower = _tower(entry, address)
        out += struct.pack(f"{sign}II", len(tower), len(tower)) + tower + bytes(-len(tower) % 4)
    return out + struct.pack(f"{sign}I", found.status)


def _tower(entry: Endpoint, address: bytes) -> bytes:
    """Five floors, little-endian in every packet: interface, NDR, protocol, port, address."""
    version = 3 if entry.interface == ENDPOINT_MAPPER else 1
    names = [(_UUID_FLOOR, one.bytes_le + struct.pack("<H", major), bytes(2))
             for one, major in ((entry.interface, version), (_NDR, 2))]  # fmt: skip
    floors = [*names, (_CONNECTIONLESS, b"", bytes(2)), (_UDP, b"", struct.pack(">H", entry.port)), (_IP, b"", address)]
    return struct.pack("<H", len(floors)) + b"".join(
        struct.pack("<HB", 1 + len(left), kind) + left + struct.pack("<H", len(right)) + right
        for kind, left, right in floors
    )


def decode_found(body: bytes, order: Order) -> Found:
    """The handle, the first entry, the status. Raises PacketError."""
    reader = _Bytes(body, order)
    handle, count = reader.take(_HANDLE), reader.number(4)
    reader.take(12)
    entries = []
    if count > 1:
        raise PacketError(f"{count} entries came, one was asked for")
    for _ in range(count):
        object_ = decode_uuid(reader.take(16), order)
        reader.take(8)
        text = reader.take(reader.number(4))
        reader.take(-reader.at % 4)
        reader.take(4)
        tower = reader.take(reader.number(4))
        reader.take(-reader.at % 4)
        shown = text.split(b"\0")[0].decode("ascii", "replace")
        entries.append(
            _endpoint(tower, object_, " ".join("".join(c if c.isprintable() else "?" for c in shown).split()))
        )
    reader.at = len(body) - 4
    return Found(tuple(entries), handle, reader.number(4))


def _endpoint(tower: bytes, object_: UUID, text: str) -> Endpoint:
    """What the floors of a tower say."""
    reader = _Bytes(tower, "little")
    interface, port = NIL, 0
    for number in range(min(reader.number(2), 8)):
        left, right = (reader.take(reader.number(2)) for _ in range(2))
        if number == 0 and len(left) == 19 and left[0] == _UUID_FLOOR:
            interface = decode_uuid(left[1:17], "little")
        elif left[:1] == bytes((_UDP,)) and len(right) == 2:
            port = int.from_bytes(right, "big")
    return Endpoint(interface, object_, port, text)


@dataclass(slots=True)
class _Bytes:
    """A cursor. Its methods raise PacketError where the bytes end."""

    data: bytes
    order: Order
    at: int = 0

    def take(self, size: int) -> bytes:
        """The next octets."""
        if self.at < 0 or len(self.data) - self.at < size:
            raise PacketError(f"the answer ends after {len(self.data)} bytes, inside a field")
        self.at += size
        return self.data[self.at - size : self.at]

    def number(self, size: int) -> int:
        """The next number."""
        return int.from_bytes(self.take(size), self.order)
