"""ISO-on-TCP: what carries S7 PDUs over port 102, as bytes.

TPKT (RFC 1006) ``03 00 LEN LEN`` counts everything; in it a TPDU of ISO 8073 class 0: its length, its kind, its
fields. ``E0`` asks for a connection, ``D0`` confirms it, ``F0 80`` carries data whose last piece has bit 7 set.
"""

from __future__ import annotations

from dataclasses import dataclass

from plcgen.base.diagnostics import PlcgenError

PORT = 102
MOST = 1024
"""Longest TPKT that is taken, and longest PDU of several pieces: a PDU here has 240 bytes."""

_TPKT, _HEAD = 3, 4
_REQUEST, _CONFIRM, _DATA = 0xE0, 0xD0, 0xF0
_LAST = 0x80
_SIZE, _CALLING, _CALLED = 0xC0, 0xC1, 0xC2


class IsoError(PlcgenError, ValueError):
    """Bytes that are no ISO-on-TCP: the connection is of no use any more."""


@dataclass(frozen=True, slots=True)
class Connect:
    """A request for a connection, or its confirmation: own reference, TSAPs of who asks and who is asked."""

    reference: int
    calling: bytes
    called: bytes


class IsoStream:
    """What arrives on one connection: connects and whole PDUs."""

    def __init__(self) -> None:
        self._pending = bytearray()
        self._pdu = bytearray()

    def feed(self, data: bytes) -> list[Connect | bytes]:
        """Take bytes and return what is complete, in order. Raises IsoError."""
        self._pending += data
        found: list[Connect | bytes] = []
        at = 0
        while len(self._pending) - at >= _HEAD:
            version, size = self._pending[at], int.from_bytes(self._pending[at + 2 : at + _HEAD])
            if version != _TPKT or not _HEAD + 3 <= size <= MOST:
                raise IsoError(f"no TPKT: {self._pending[at : at + _HEAD].hex(' ').upper()}")
            if len(self._pending) - at < size:
                break
            tpdu = bytes(self._pending[at + _HEAD : at + size])
            at += size
            entry = self._tpdu(tpdu)
            if entry is not None:
                found.append(entry)
        del self._pending[:at]
        return found

    def _tpdu(self, tpdu: bytes) -> Connect | bytes | None:
        length, kind = tpdu[0] + 1, tpdu[1] & 0xF0
        if length > len(tpdu):
            raise IsoError(f"a TPDU of {length} bytes in {len(tpdu)}")
        if kind in {_REQUEST, _CONFIRM} and length >= 7:
            return _connect(tpdu[:length])
        if kind != _DATA or length != 3:
            raise IsoError(f"a TPDU of kind {tpdu[1]:02X}h: the partner refuses, or speaks something else")
        self._pdu += tpdu[length:]
        if len(self._pdu) > MOST:
            raise IsoError(f"a PDU of more than {MOST} bytes")
        if not tpdu[2] & _LAST:
            return None
        pdu = bytes(self._pdu)
        self._pdu.clear()
        return pdu


def _connect(tpdu: bytes) -> Connect:
    fields, at = {}, 7
    while at + 2 <= len(tpdu):
        code, size = tpdu[at], tpdu[at + 1]
        fields[code] = tpdu[at + 2 : at + 2 + size]
        at += 2 + size
    return Connect(int.from_bytes(tpdu[4:6]), fields.get(_CALLING, b""), fields.get(_CALLED, b""))


def connect_request(calling: bytes, called: bytes, reference: int = 1) -> bytes:
    """Ask for a connection between two TSAPs, with TPDUs of at most 1024 bytes."""
    return _connecting(_REQUEST, bytes(2) + reference.to_bytes(2), calling, called)


def connect_confirm(request: Connect, reference: int = 1) -> bytes:
    """Confirm what was asked for."""
    ends = request.reference.to_bytes(2) + reference.to_bytes(2)
    return _connecting(_CONFIRM, ends, request.calling, request.called)


def _connecting(kind: int, ends: bytes, calling: bytes, called: bytes) -> bytes:
    fields = bytes((_SIZE, 1, 0x0A, _CALLING, len(calling))) + calling + bytes((_CALLED, len(called))) + called
    tpdu = bytes((kind,)) + ends + b"\x00" + fields
    return _tpkt(bytes((len(tpdu),)) + tpdu)


def carry(pdu: bytes) -> bytes:
    """A PDU on its way."""
    return _tpkt(bytes((2, _DATA, _LAST)) + pdu)


def _tpkt(tpdu: bytes) -> bytes:
    return bytes((_TPKT, 0)) + (_HEAD + len(tpdu)).to_bytes(2) + tpdu
