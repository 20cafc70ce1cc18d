"""What goes over a PPI line, one line of text or JSON per frame."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from plcgen.base.diagnostics.counting import quantity
from plcgen.base.display.cells import cut
from plcgen.base.display.view import View
from plcgen.ppi.wire.address import address_text
from plcgen.ppi.wire.codes import header_error, return_code
from plcgen.ppi.wire.dissect import title
from plcgen.ppi.wire.fdl import SD1, SD2, examine_frame
from plcgen.ppi.wire.model import (
    ErrorReply,
    FixedFrame,
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
from plcgen.ppi.wire.pdu import examine_pdu

if TYPE_CHECKING:
    from plcgen.ppi.sim.bus import Traffic

_BYTES = 40
_VALUE = 16
_OK = 0xFF


class TrafficText:
    """Turns traffic into text; it remembers what was asked, so that answers can name their items."""

    def __init__(self) -> None:
        self._asked: dict[tuple[int, int], Sequence[Item]] = {}

    def line(self, entry: Traffic, view: View) -> str:
        """``   0.012  ->  read request, station 0 to 2: VB100   68 1B ..``; a screen cuts it."""
        width = view.width if view.target == "screen" else 0
        arrow = "->" if entry.direction == ">" else "<-"
        shown = entry.data if width == 0 else entry.data[:_BYTES]
        more = f" .. {len(entry.data)} bytes" if len(shown) < len(entry.data) else ""
        text = f"{entry.time / 1000:8.3f}  {arrow}  {self.words(entry)}"
        note = f"  [{_fault(entry)}]" if _fault(entry) else ""
        raw = f"  {shown.hex(' ').upper()}{more}"
        if width:
            raw = cut(raw, max(width - len(text) - len(note), len("  68 ...")))
        return text + view.paint(note, "error") + view.paint(raw, "dim")

    def data(self, entry: Traffic) -> dict[str, Any]:
        """One frame for programs."""
        return {
            "event": "frame",
            "time": entry.time,
            "direction": "request" if entry.direction == ">" else "answer",
            "bytes": entry.data.hex(" ").upper(),
            "text": self.words(entry),
            "fault": _fault(entry) or None,
        }

    def words(self, entry: Traffic) -> str:
        """What a frame says."""
        if entry.direction == ">" and entry.frame is None:
            size = quantity(len(entry.data), "byte")
            if entry.note != "no frame":
                return f"{size} of an unfinished frame"
            return f"{size} without a frame{_flaw(entry.data)}"
        words = title(entry.data)
        frame = entry.frame
        if isinstance(frame, FixedFrame | VariableFrame):
            words += f" ({frame.function:02X})"
        if not isinstance(frame, VariableFrame):
            return words
        pdu = examine_pdu(frame.pdu)[0]
        more = "" if pdu is None else self._contents(pdu, frame)
        return f"{words}{': ' * bool(more)}{more}"

    def _contents(self, pdu: Pdu, frame: VariableFrame) -> str:
        if isinstance(pdu, ReadRequest):
            self._asked[frame.source, frame.destination] = pdu.items
            return ", ".join(address_text(item) for item in pdu.items)
        if isinstance(pdu, WriteRequest):
            self._asked[frame.source, frame.destination] = [entry.item for entry in pdu.items]
            return ", ".join(f"{address_text(entry.item)} = {_hex(entry.data)}" for entry in pdu.items)
        names = [address_text(item) for item in self._asked.get((frame.destination, frame.source), ())]
        if isinstance(pdu, ReadReply):
            texts = [_hex(result.data) if result.ok else _refused(result.code) for result in pdu.results]
            return ", ".join(_named(names, n, text) for n, text in enumerate(texts))
        if isinstance(pdu, WriteReply):
            texts = ["ok" if code == _OK else _refused(code) for code in pdu.codes]
            return ", ".join(_named(names, n, text) for n, text in enumerate(texts))
        if isinstance(pdu, ErrorReply):
            return f"{pdu.code:04X}h {header_error(pdu.code).text}"
        if isinstance(pdu, SetupRequest | SetupReply):
            return f"PDU size {pdu.pdu_size}"
        return ""


def _fault(entry: Traffic) -> str:
    """Fault behind an answer; what is noted about other bytes is in their words."""
    return entry.note if entry.direction == "<" else ""


def _flaw(data: bytes) -> str:
    """What is wrong with bytes that begin like a frame and are none."""
    found = examine_frame(data)[1] if data[0] in {SD1, SD2} else []
    return f": {found[0].message}" if found else ""


def _named(names: Sequence[str], number: int, text: str) -> str:
    return f"{names[number]} = {text}" if number < len(names) else text


def _hex(data: bytes) -> str:
    more = f" .. {len(data)} bytes" if len(data) > _VALUE else ""
    return data[:_VALUE].hex(" ").upper() + more


def _refused(code: int) -> str:
    return f"{code:02X}h {return_code(code).text}"
