"""One line about a telegram: what a log, a monitor or a short listing shows."""

from __future__ import annotations

from plcgen.ppi.wire.address import address_text
from plcgen.ppi.wire.codes import function_text, header_error, return_code
from plcgen.ppi.wire.model import (
    Acknowledgement,
    AckReply,
    DataFrame,
    ErrorReply,
    FixedFrame,
    ForceRequest,
    Frame,
    ItemResult,
    ItemWrite,
    Pdu,
    ReadReply,
    ReadRequest,
    RunRequest,
    SetupReply,
    SetupRequest,
    StopRequest,
    TokenFrame,
    UnknownJob,
    UnknownReply,
    WriteReply,
    WriteRequest,
)

_POLL = 0x4C


def frame_text(frame: Frame, pdu: Pdu | None = None) -> str:
    """``0 -> 2  read VB100, M0.0``: stations and contents of a frame; ``pdu`` is what an SD2 frame carries."""
    if isinstance(frame, Acknowledgement):
        return "acknowledgement E5" + ("" if frame.received == 0xE5 else f" (received as {frame.received:02X})")
    way = f"{frame.source} -> {frame.destination}"
    if isinstance(frame, TokenFrame):
        return f"{way}  token"
    if isinstance(frame, FixedFrame):
        poll = frame.function & 0x4F == _POLL
        return f"{way}  {'poll' if poll else function_text(frame.function)}"
    if isinstance(frame, DataFrame):
        return f"{way}  data {frame.data.hex(' ').upper()}"
    return f"{way}  {pdu_text(pdu) if pdu is not None else f'{len(frame.pdu)} bytes'}"


def pdu_text(pdu: Pdu) -> str:
    """``read VB100, M0.0``, ``write VW100 = 04 D2``, ``answer 22, error 05h address out of range``."""
    if isinstance(pdu, ReadRequest):
        return f"read {', '.join(address_text(item) for item in pdu.items)}"
    if isinstance(pdu, WriteRequest):
        return f"write {', '.join(_assignment(entry) for entry in pdu.items)}"
    if isinstance(pdu, ReadReply):
        return f"answer {', '.join(_result(result) for result in pdu.results)}"
    if isinstance(pdu, WriteReply):
        return f"written {', '.join(_code(code) for code in pdu.codes)}"
    if isinstance(pdu, SetupRequest | SetupReply):
        return f"negotiation, PDU {pdu.pdu_size} bytes"
    if isinstance(pdu, RunRequest | StopRequest):
        return "RUN" if isinstance(pdu, RunRequest) else "STOP"
    if isinstance(pdu, AckReply):
        return "done" if pdu.function is None else f"done, function {pdu.function:02X}h"
    if isinstance(pdu, ErrorReply):
        return f"error {pdu.code:04X}h {header_error(pdu.code).text}"
    if isinstance(pdu, ForceRequest):
        name = address_text(pdu.item)
        return f"unforce {name}" if pdu.data is None else f"force {name} = {pdu.data.hex(' ').upper()}"
    if isinstance(pdu, UnknownJob | UnknownReply):
        name = "job" if isinstance(pdu, UnknownJob) else "answer"
        return f"{name}, function {pdu.parameter[0]:02X}h" if pdu.parameter else name
    return f"userdata {pdu.parameter.hex(' ').upper()}"


def _assignment(entry: ItemWrite) -> str:
    return f"{address_text(entry.item)} = {entry.data.hex(' ').upper()}"


def _result(result: ItemResult) -> str:
    return result.data.hex(" ").upper() if result.ok else _code(result.code)


def _code(code: int) -> str:
    return "ok" if code == 0xFF else f"error {code:02X}h {return_code(code).text}"
