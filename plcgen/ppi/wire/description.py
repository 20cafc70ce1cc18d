"""One line about a frame: what a log, a recording or a short listing shows."""

from __future__ import annotations

from collections.abc import Sequence

from plcgen.ppi.wire.address import address_text
from plcgen.ppi.wire.areas import ReturnCode
from plcgen.ppi.wire.codes import header_error, return_code
from plcgen.ppi.wire.dissect import title
from plcgen.ppi.wire.model import (
    ACKNOWLEDGE,
    Acknowledgement,
    ErrorReply,
    FixedFrame,
    ForceRequest,
    Frame,
    Item,
    Pdu,
    ReadReply,
    ReadRequest,
    SetupReply,
    SetupRequest,
    VariableFrame,
    WriteReply,
    WriteRequest,
)

_VALUE = 16


class FrameText:
    """Turns the frames of a line into text; it remembers what was asked, so that answers can name their items."""

    def __init__(self) -> None:
        self._asked: dict[tuple[int, int], Sequence[Item]] = {}

    def line(self, data: bytes, frame: Frame | None, pdu: Pdu | None) -> str:
        """``read reply, station 2 to 0 (08): VB100 = 22``; ``pdu`` is what an SD2 frame carries."""
        words = title(data)
        if isinstance(frame, Acknowledgement) and frame.received != ACKNOWLEDGE:
            words += f" (received as {frame.received:02X})"
        if isinstance(frame, FixedFrame | VariableFrame):
            words += f" ({frame.function:02X})"
        more = self._contents(pdu, frame) if isinstance(frame, VariableFrame) and pdu is not None else ""
        return f"{words}{': ' * bool(more)}{more}"

    def _contents(self, pdu: Pdu, frame: VariableFrame) -> str:
        if isinstance(pdu, ReadRequest):
            self._asked[frame.source, frame.destination] = pdu.items
            return ", ".join(address_text(item) for item in pdu.items)
        if isinstance(pdu, WriteRequest):
            self._asked[frame.source, frame.destination] = [entry.item for entry in pdu.items]
            return ", ".join(f"{address_text(entry.item)} = {_hex(entry.data)}" for entry in pdu.items)
        if isinstance(pdu, ReadReply | WriteReply):
            if isinstance(pdu, ReadReply):
                texts = [_hex(result.data) if result.ok else _refused(result.code) for result in pdu.results]
            else:
                texts = ["ok" if code == ReturnCode.OK else _refused(code) for code in pdu.codes]
            names = [f"{address_text(item)} = " for item in self._asked.get((frame.destination, frame.source), ())]
            return ", ".join((names[n] if n < len(names) else "") + text for n, text in enumerate(texts))
        if isinstance(pdu, ErrorReply):
            return f"{pdu.code:04X}h {header_error(pdu.code).text}"
        if isinstance(pdu, SetupRequest | SetupReply):
            return f"PDU size {pdu.pdu_size}"
        if isinstance(pdu, ForceRequest):
            name = address_text(pdu.item)
            return f"unforce {name}" if pdu.data is None else f"force {name} = {_hex(pdu.data)}"
        return ""


def _hex(data: bytes) -> str:
    return data[:_VALUE].hex(" ").upper() + (f" .. {len(data)} bytes" if len(data) > _VALUE else "")


def _refused(code: int) -> str:
    return f"{code:02X}h {return_code(code).text}"
