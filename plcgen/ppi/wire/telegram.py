"""Whole telegrams: an FDL frame and the S7 PDU in it, with offsets that count from the first byte of the frame."""

from __future__ import annotations

from dataclasses import dataclass

from plcgen.ppi.wire.errors import PpiError, Violation
from plcgen.ppi.wire.fdl import encode_frame, examine_frame
from plcgen.ppi.wire.model import FIRST, FixedFrame, Frame, Pdu, Reply, Request, VariableFrame
from plcgen.ppi.wire.pdu import encode_pdu, examine_pdu

PDU_OFFSET = 7
"""Bytes in front of the PDU: 68 LE LE 68 DA SA FC."""

DATA_FUNCTION = 0x08
"""Function code of an answer that carries data."""


@dataclass(frozen=True, slots=True)
class WireTelegram:
    """A decoded telegram: its frame, and the PDU of an SD2 frame."""

    frame: Frame
    pdu: Pdu | None = None


@dataclass(frozen=True, slots=True)
class Examination:
    """What could be read of a telegram, and everything that is wrong with it, in order of the offsets."""

    frame: Frame | None
    pdu: Pdu | None
    violations: tuple[Violation, ...]


def examine(data: bytes) -> Examination:
    """Read a telegram as far as possible; nothing raises."""
    frame, found = examine_frame(data)
    pdu: Pdu | None = None
    if isinstance(frame, VariableFrame):
        pdu, more = examine_pdu(frame.pdu, PDU_OFFSET)
        found = sorted(found + more, key=lambda violation: violation.offset) if found else more
    return Examination(frame, pdu, tuple(found))


def decode_telegram(data: bytes) -> WireTelegram:
    """Return the telegram in ``data``; PpiError with every violation of frame and PDU."""
    seen = examine(data)
    if seen.violations or seen.frame is None or (isinstance(seen.frame, VariableFrame) and seen.pdu is None):
        raise PpiError(seen.violations)
    return WireTelegram(seen.frame, seen.pdu)


def encode_request(pdu: Request, *, destination: int = 2, source: int = 0, function: int = FIRST) -> bytes:
    """Return the SD2 frame of a request; stations default to the usual PLC (2) and PC (0)."""
    return encode_frame(VariableFrame(destination, source, function, encode_pdu(pdu)))


def encode_reply(pdu: Reply, *, destination: int = 0, source: int = 2) -> bytes:
    """Return the SD2 frame of an answer."""
    return encode_frame(VariableFrame(destination, source, DATA_FUNCTION, encode_pdu(pdu)))


def encode_poll(*, destination: int = 2, source: int = 0, function: int) -> bytes:
    """Return the SD1 frame with which a master asks for the answer."""
    return encode_frame(FixedFrame(destination, source, function))
