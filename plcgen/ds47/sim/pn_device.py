"""A simulated drive as a PROFINET device on UDP: relations with device access, their records, and nothing else.

No cyclic data, no alarms, no DCP. A call that comes again is answered again and executed once. The device knows no time
of its own: whoever serves it says how much has passed.
"""

from __future__ import annotations

import socket
import time
from collections import Counter, OrderedDict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from uuid import UUID

from plcgen.ds47.sim.drive import Drive
from plcgen.ds47.wire import pnio, rpc
from plcgen.ds47.wire.pnio import Endpoint, Found, RecordBlock, Relation
from plcgen.ds47.wire.rpc import Operation, Packet, PacketError, PacketType

OBJECT = pnio.object_uuid(1, 0, 0)
"""Instance 1; device and vendor 0, which nobody has."""
_MAC = bytes.fromhex("02 00 00 00 00 01")
_ACTIVITIES = 64
_OP_RANGE, _UNKNOWN_INTERFACE = 0x1C010002, 0x1C010003
"""Reasons of a reject (C706, appendix E): there is no such operation, no such interface."""
_ARGS, _BLOCKS, _CYCLIC, _FULL, _UNKNOWN_AR = 0x4000, 0x4001, 0x4002, 0x4004, 0x4005
_TYPE, _NUMBER, _MAC_FIELD, _PROPERTIES, _TIMEOUT, _NAME = 4, 5, 7, 9, 10, 12
_CONNECT, _RELEASE, _READ, _WRITE = 0xDB810000, 0xDC810000, 0xDE810000, 0xDF810000
_NO_PLACE = 0xB200


@dataclass(slots=True)
class _Caller:
    """What is known of an activity: its last call, the answer to it, fragments of the next one."""

    sequence: int = -1
    answer: tuple[bytes, ...] = ()
    assembly: rpc.Assembly = field(default_factory=rpc.Assembly)
    gathering: int = -1


class _RefusedError(Exception):
    """A PNIO status instead of blocks."""

    def __init__(self, status: int, blocks: bytes = b"") -> None:
        self.status, self.blocks = status, blocks


class PnDevice:
    """A device whose parameter access point is ``place`` (slot and subslot); ``room`` relations at the same time.

    ``relations`` are those that there are, ``done`` counts the operations that were executed; ``fragment`` is the
    longest body of a packet that is sent.
    """

    def __init__(
        self,
        drive: Drive,
        place: tuple[int, int] = (1, 1),
        room: int = 1,
        port: int = rpc.PORT,
        api: int = pnio.PROFIDRIVE,
        fragment: int = rpc.BODY,
    ) -> None:
        self.drive, self.place, self.room, self.port, self.fragment = drive, (api, *place), room, port, fragment
        self.done: Counter[str] = Counter()
        self._callers: OrderedDict[UUID, _Caller] = OrderedDict()
        self.relations: dict[UUID, tuple[Relation, int]] = {}

    def advance(self, milliseconds: int) -> None:
        """Let time pass: for the drive, and for relations that nobody uses."""
        self.drive.advance(milliseconds)
        for ar, (relation, used) in list(self.relations.items()):
            if self.drive.time - used > relation.timeout * 100:
                del self.relations[ar]

    def receive(self, data: bytes) -> Sequence[bytes]:
        """The datagrams that answer one; none to what is no packet, or no request."""
        try:
            packet = rpc.decode_packet(data)
        except PacketError:
            return ()
        caller = self._callers.setdefault(packet.activity, _Caller())
        self._callers.move_to_end(packet.activity)
        if len(self._callers) > _ACTIVITIES:
            self._callers.popitem(last=False)
        if packet.kind is PacketType.PING:
            known = packet.sequence == caller.sequence
            return caller.answer if known else (rpc.encode_packet(packet.answer(PacketType.NO_CALL)),)
        if packet.kind is not PacketType.REQUEST or packet.sequence < caller.sequence:
            return ()
        if packet.sequence == caller.sequence:
            return caller.answer
        return self._gather(packet, caller)

    def _gather(self, packet: Packet, caller: _Caller) -> Sequence[bytes]:
        """Wait for all fragments of a request, then execute it."""
        if caller.gathering != packet.sequence:
            caller.assembly, caller.gathering = rpc.Assembly(), packet.sequence
        try:
            body = caller.assembly.add(packet)
        except PacketError:
            caller.gathering = -1
            return ()
        receipt = rpc.acknowledgement(packet)
        if body is None:
            return () if receipt is None else (rpc.encode_packet(receipt),)
        answer = self._execute(replace(packet, body=body))
        caller.sequence = packet.sequence
        caller.answer = tuple(rpc.encode_packet(part) for part in rpc.fragments(answer, self.fragment))
        return caller.answer

    def _execute(self, packet: Packet) -> Packet:
        if packet.interface == rpc.ENDPOINT_MAPPER:
            if packet.operation != rpc.LOOKUP:
                return _rejected(packet, _OP_RANGE)
            return self._look_up(packet)
        if packet.interface != rpc.IO_DEVICE or packet.object != OBJECT:
            return _rejected(packet, _UNKNOWN_INTERFACE)
        if packet.operation not in set(Operation):
            return _rejected(packet, _OP_RANGE)
        operation = Operation(packet.operation)
        execute, base = {
            Operation.CONNECT: (self._connect, _CONNECT),
            Operation.RELEASE: (self._release, _RELEASE),
            Operation.READ: (self._read, _READ),
            Operation.WRITE: (self._write, _WRITE),
        }[operation]
        status, blocks, room = 0, b"", pnio.ANSWER_ROOM
        try:
            room, asked = pnio.decode_args(packet.body, packet.order)
            blocks = execute(asked)
            if len(blocks) > room:
                status, blocks = base | _ARGS, b""
        except PacketError:
            status = base | _ARGS
        except _RefusedError as refused:
            status, blocks = refused.status, refused.blocks
        self.done[operation.name.lower()] += 1
        return packet.answer(PacketType.RESPONSE, pnio.encode_args(blocks, packet.order, status, room))

    def _look_up(self, packet: Packet) -> Packet:
        """First the endpoint mapper itself, then the device, then nothing more: the handle says how far it has gone."""
        entries = (
            Endpoint(rpc.ENDPOINT_MAPPER, rpc.NIL, self.port, "plcgen"),
            Endpoint(rpc.IO_DEVICE, OBJECT, self.port, "plcgen simulated drive"),
        )
        try:
            inquiry, handle, most = pnio.decode_lookup(packet.body, packet.order)
        except PacketError:
            return _rejected(packet, _OP_RANGE)
        at = handle[-1]
        found = Found((), bytes(20), pnio.NOT_REGISTERED)
        if inquiry == 0 and most and at < len(entries):
            found = Found((entries[at],), bytes(19) + bytes((at + 1,)), 0)
        return packet.answer(PacketType.RESPONSE, pnio.encode_found(found, packet.order))

    def _connect(self, asked: bytes) -> bytes:
        relation, more = pnio.decode_ar_request(asked)
        wrong = _wrong_field(relation)
        if wrong:
            raise _RefusedError(_CONNECT | 0x0100 | wrong)
        if not relation.properties & pnio.DEVICE_ACCESS:
            raise _RefusedError(_CONNECT | _CYCLIC)
        if more:
            raise _RefusedError(_CONNECT | _BLOCKS)
        if relation.ar not in self.relations and len(self.relations) >= self.room:
            raise _RefusedError(_CONNECT | _FULL)
        self.relations[relation.ar] = (relation, self.drive.time)
        return pnio.encode_ar_answer(relation, _MAC)

    def _release(self, asked: bytes) -> bytes:
        _, ar, session, command = pnio.decode_release(asked)
        relation = self._used(ar, _RELEASE)
        if session != relation.session or command != pnio.RELEASE:
            raise _RefusedError(_RELEASE | 0x2800 | (6 if session != relation.session else 8))
        del self.relations[ar]
        return pnio.encode_release(ar, session, answer=True)

    def _read(self, asked: bytes) -> bytes:
        block = self._record(asked, pnio.READ_REQUEST, _READ)
        status, data = self.drive.read_record(block.index, block.size)
        answer = pnio.encode_record(replace(block, kind=pnio.READ_ANSWER, size=len(data), data=data))
        if status:
            raise _RefusedError(status, answer)
        return answer

    def _write(self, asked: bytes) -> bytes:
        block = self._record(asked, pnio.WRITE_REQUEST, _WRITE)
        status = self.drive.write_record(block.index, block.data)
        answer = pnio.encode_record(replace(block, kind=pnio.WRITE_ANSWER, size=0, data=b"", status=status))
        if status:
            raise _RefusedError(status, answer)
        return answer

    def _record(self, asked: bytes, kind: int, base: int) -> RecordBlock:
        """The header of a record that this device has."""
        block = pnio.decode_record(asked, kind)
        self._used(block.ar, base)
        if (block.api, block.slot, block.subslot) != self.place:
            raise _RefusedError(base & 0xFF000000 | 0x800000 | _NO_PLACE)
        return block

    def _used(self, ar: UUID, base: int) -> Relation:
        if ar not in self.relations:
            raise _RefusedError(base | _UNKNOWN_AR)
        relation, _ = self.relations[ar]
        self.relations[ar] = (relation, self.drive.time)
        return relation


def _wrong_field(relation: Relation) -> int:
    """Number of the field of the AR block that no supervisor may send; 0 if there is none."""
    name = relation.station
    checks = (
        (_TYPE, relation.kind == pnio.SUPERVISOR),
        (_NUMBER, relation.ar != rpc.NIL),
        (_MAC_FIELD, not relation.mac[0] & 1),
        (_PROPERTIES, relation.properties & 0x17 == pnio.ACTIVE | pnio.BY_INITIATOR),
        (_TIMEOUT, 1 <= relation.timeout <= 1000),
        (_NAME, 1 <= len(name) <= 240),
    )
    return next((number for number, good in checks if not good), 0)


def _rejected(packet: Packet, reason: int) -> Packet:
    return packet.answer(PacketType.REJECT, reason.to_bytes(4, packet.order))


def serve_udp(device: PnDevice, where: socket.socket, ended: Callable[[], bool]) -> None:
    """Serve a socket until it is over; the time that passes is real. ``ended`` is asked five times a second."""
    where.settimeout(0.2)
    before = time.monotonic()
    while not ended():
        try:
            data, caller = where.recvfrom(0x10000)
        except (TimeoutError, ConnectionError):
            data = b""
        passed = int((time.monotonic() - before) * 1000)
        before += passed / 1000
        device.advance(passed)
        for answer in device.receive(data) if data else ():
            where.sendto(answer, caller)
