"""PPI telegrams as tables, as one line each and as data: frames with their PDUs, and what lies between frames."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

from plcgen.base.diagnostics import Diagnostic, has_errors
from plcgen.base.diagnostics.counting import quantity
from plcgen.base.display.cells import cut
from plcgen.base.display.data import diagnostics_data
from plcgen.base.display.results import Answer
from plcgen.base.display.view import View
from plcgen.base.telegrams.decoded import DecodedTelegram, TelegramField, telegram_text
from plcgen.base.telegrams.decoded import telegram_data as plain_data
from plcgen.ppi.wire.areas import ITEM_LIMIT
from plcgen.ppi.wire.dissect import FrameText, dissect, title
from plcgen.ppi.wire.errors import TOLERABLE, Kind, Violation
from plcgen.ppi.wire.fdl import SD1, SD2, examine_frame
from plcgen.ppi.wire.model import Item, ItemWrite, ReadReply, ReadRequest, VariableFrame, WriteReply, WriteRequest
from plcgen.ppi.wire.pack import mismatches
from plcgen.ppi.wire.pdu import examine_pdu
from plcgen.ppi.wire.stream import FrameCountCheck
from plcgen.ppi.wire.telegram import Examination, examine

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


_NO_FRAME = "no frame"
_REFERENCE = 11
"""Offset of the reference in an SD2 frame."""


class StreamPiece(NamedTuple):
    """Bytes of a stream that belong together, from ``offset`` on: what is, or starts like, a frame (``telegram``), or
    something between two frames.
    """

    offset: int
    data: bytes
    telegram: bool


@dataclass(frozen=True, slots=True)
class DecodedFrame:
    """One telegram of a stream: where it starts, its fields, one line about it, what is wrong and what was accepted."""

    offset: int
    data: bytes
    kind: str
    line: str
    fields: tuple[TelegramField, ...]
    problems: tuple[Violation, ...]
    tolerated: tuple[Violation, ...]

    @property
    def framed(self) -> bool:
        """Whether the bytes are, or start like, a frame."""
        return self.kind != _NO_FRAME

    @property
    def table(self) -> DecodedTelegram:
        """The same for the reports that all telegrams share."""
        problems = tuple((problem.offset, problem.message) for problem in self.problems)
        return DecodedTelegram(self.kind, self.data, self.fields, problems)


def decode_pieces(pieces: Iterable[StreamPiece], *, tolerant: bool = False) -> list[DecodedFrame]:
    """Take the telegrams of a stream apart, each with the request before it as context."""
    context = _Context()
    return [_telegram(piece, context, tolerant=tolerant) for piece in pieces]


class _Context:
    """What was asked last on each pair of stations."""

    def __init__(self) -> None:
        self.frame_count, self.words = FrameCountCheck(), FrameText()
        self._asked: dict[tuple[int, int], ReadRequest | WriteRequest] = {}

    def follow(self, seen: Examination) -> tuple[list[Violation], tuple[Item, ...]]:
        """Take a frame; return what is wrong with it at this place of the stream, and the items that it answers."""
        frame, pdu = seen.frame, seen.pdu
        if frame is None:
            return [], ()
        found = self.frame_count.follow(frame)
        if not isinstance(frame, VariableFrame):
            return found, ()
        if isinstance(pdu, ReadRequest | WriteRequest):
            self._asked[frame.destination, frame.source] = pdu
        if not isinstance(pdu, ReadReply | WriteReply):
            return found, ()
        request = self._asked.get((frame.source, frame.destination))
        if request is None:
            return found, ()
        wrong = mismatches(request, pdu)
        found += [Violation(Kind.MISMATCH, _REFERENCE, violation.message) for violation in wrong]
        return found, () if wrong else tuple(e.item if isinstance(e, ItemWrite) else e for e in request.items)


def _telegram(piece: StreamPiece, context: _Context, *, tolerant: bool) -> DecodedFrame:
    data = piece.data
    if not piece.telegram and (len(data) != 1 or examine(data).frame is None):
        count = quantity(len(data), "byte")
        text = f"{count} skipped: no frame starts here"
        shown = data[:16].hex(" ").upper() + (" ..." if len(data) > 16 else "")
        field = TelegramField(0, data, "skipped", shown, "", problem=True)
        return DecodedFrame(piece.offset, data, _NO_FRAME, text, (field,), (Violation(Kind.START, 0, text),), ())
    seen = examine(data)
    more, asked = context.follow(seen)
    violations = [*seen.violations, *more]
    tolerable = TOLERABLE if tolerant else frozenset()
    problems = tuple(violation for violation in violations if violation.kind not in tolerable)
    tolerated = tuple(violation for violation in violations if violation.kind in tolerable)
    fields = tuple(
        TelegramField(f.offset, data[f.offset : f.offset + f.length], f.name, f.value, f.note, f.problem)
        for f in dissect(data, problems, asked[:ITEM_LIMIT])
    )
    line = context.words.line(data, seen.frame, seen.pdu)
    kind = title(data) if seen.pdu is None else f"{title(data)}, reference {seen.pdu.reference}"
    return DecodedFrame(piece.offset, data, kind, line, fields, problems, tolerated)


def short_text(telegrams: Sequence[DecodedFrame], view: View) -> str:
    """One line a telegram: offset in the stream, ``!`` for a wrong and ``~`` for a tolerated one, contents."""
    lines = []
    for telegram in telegrams:
        mark = "!" if telegram.problems else "~" if telegram.tolerated else " "
        line = f"{telegram.offset:>8} {mark} {telegram.line}"
        lines.append(view.paint(cut(line, view.width), "error" if telegram.problems else ""))
    return "".join(line.rstrip() + "\n" for line in lines)


def telegrams_answer(
    telegrams: Sequence[DecodedFrame], diagnostics: Sequence[Diagnostic], *, short: bool = False
) -> Answer:
    """Answer of ``ppi decode``: every telegram with its fields, violations with their kinds; ``short`` for people."""
    ok = not has_errors(diagnostics)
    rows = [
        {
            **plain_data(telegram.table),
            "offset": telegram.offset,
            "text": telegram.line,
            "problems": [_violation(violation) for violation in telegram.problems],
            "tolerated": [_violation(violation) for violation in telegram.tolerated],
        }
        for telegram in telegrams
    ]
    data = {**diagnostics_data("ppi telegrams", diagnostics, ok=ok), "telegrams": rows}
    return Answer(data, partial(short_text if short else _text, telegrams), diagnostics)


def _text(telegrams: Sequence[DecodedFrame], view: View) -> str:
    return "\n".join(telegram_text(telegram.table, view) for telegram in telegrams)


def _violation(violation: Violation) -> dict[str, Any]:
    return {"kind": violation.kind.value, "offset": violation.offset, "message": violation.message}
