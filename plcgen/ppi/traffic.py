"""What goes over a PPI line, one line of text or JSON per frame."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from plcgen.base.diagnostics.counting import quantity
from plcgen.base.display.cells import cut
from plcgen.base.display.view import View
from plcgen.ppi.wire.description import FrameText
from plcgen.ppi.wire.fdl import SD1, SD2, examine_frame
from plcgen.ppi.wire.model import VariableFrame
from plcgen.ppi.wire.pdu import examine_pdu

if TYPE_CHECKING:
    from plcgen.ppi.sim.bus import Traffic

_BYTES = 40


class TrafficText:
    """Turns traffic into text, with the words of ``FrameText``."""

    def __init__(self) -> None:
        self._frames = FrameText()

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
            wrong = examine_frame(entry.data)[1] if entry.data[0] in {SD1, SD2} else []
            return f"{size} without a frame{f': {wrong[0].message}' if wrong else ''}"
        frame = entry.frame
        pdu = examine_pdu(frame.pdu)[0] if isinstance(frame, VariableFrame) else None
        return self._frames.line(entry.data, frame, pdu)


def _fault(entry: Traffic) -> str:
    """Fault behind an answer; what is noted about other bytes is in their words."""
    return entry.note if entry.direction == "<" else ""
