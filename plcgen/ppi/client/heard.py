"""What was heard while an answer was waited for, so that "no answer" names the right cause; answers known from before.

Everything but the values is compared with an answer that was examined and found right, so nothing else gets through.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum

from plcgen.base.diagnostics.counting import quantity
from plcgen.ppi.wire.areas import SizeCode
from plcgen.ppi.wire.fdl import LEAST_LENGTH, MOST_LENGTH, SD2
from plcgen.ppi.wire.model import ItemResult, ReadReply

_HEAD = 6
"""Bytes of an SD2 frame that tell whose it is: 68 LE LE 68 DA SA."""


class HeardKind(Enum):
    """What one frame that we sent was answered with; in front stands what tells most about the cause."""

    BROKEN = "broken"
    DAMAGED = "damaged"
    OTHER = "other"
    BUSY = "busy"
    NOT_READY = "not ready"
    SILENCE = "silence"


@dataclass(slots=True)
class Heard:
    """One exchange: ``outcomes`` in their order, ``damaged`` pieces that are no frame, ``broken`` the bytes of the last
    frame that broke off, ``other`` what was wrong with the last answer to something else.
    """

    outcomes: list[HeardKind] = field(default_factory=list)
    damaged: int = 0
    broken: int = 0
    other: str = ""

    def nothing(self, damaged_before: int, rest: bytes, own: int, station: int, *, garbage: bool) -> None:
        """No frame came in time: ``rest`` is what waits for more, ``garbage`` says that bytes were no frame."""
        answer = begins(rest, own, station)
        if answer and len(rest) < rest[1] + _HEAD:  # LE counts from DA to the byte before FCS
            self.broken = len(rest)
            self.outcomes.append(HeardKind.BROKEN)
            return
        self.damaged += garbage or answer
        self.outcomes.append(HeardKind.DAMAGED if self.damaged > damaged_before else HeardKind.SILENCE)

    @property
    def cause(self) -> HeardKind:
        """What tells most, however rare it was: an answer that is lost once is followed by E5 without end."""
        return next((each for each in HeardKind if each in self.outcomes), HeardKind.SILENCE)

    def text(self, station: int, tries: str) -> tuple[str, str]:
        """Message and help; ``tries`` says what was done in vain: ``3 times sent``."""
        cause = self.cause
        if cause is HeardKind.BUSY:
            return f"station {station} has no resource (NACK 02h, {tries})", "the CPU is busy: try again later"
        if cause is HeardKind.BROKEN:
            what = f"a frame from station {station} broke off after {self.broken} bytes ({tries})"
            return what, "raise --timeout: the line is slow or delivers in pieces"
        if cause is HeardKind.DAMAGED:
            frames = quantity(self.damaged, "damaged frame")
            return (
                f"{frames} instead of an answer from station {station} ({tries})",
                "check baud rate, parity and wiring",
            )
        if cause is HeardKind.NOT_READY:
            return f"station {station} is not ready: E5 without end ({tries})", "the CPU is busy: try again later"
        if cause is HeardKind.OTHER:
            help_ = "try again; plcgen ppi decode explains a capture of the line"
            return f"no answer from station {station} ({tries}): {self.other}", help_
        help_ = "check station address, baud rate, cable and adapter, and that the CPU is on"
        return f"station {station} does not answer ({tries})", help_


def begins(data: bytes, own: int, station: int) -> bool:
    """Whether bytes are surely the beginning of an answer: its head with both lengths, for us, from the station."""
    return (
        len(data) >= _HEAD
        and data[0] == data[3] == SD2
        and LEAST_LENGTH <= data[1] == data[2] <= MOST_LENGTH
        and (data[4], data[5]) == (own, station)
    )


_MOST = 256
_DATA, _HEADER = 14, 4
"""Where the items of an answer begin, and the bytes in front of a value."""
_VALUES = frozenset({SizeCode.WORDS, SizeCode.OCTETS})


@dataclass(frozen=True, slots=True)
class KnownReply:
    """An answer without reference and values: ``fixed`` are places and bytes of the rest, ``values`` lie between."""

    size: int
    fixed: tuple[tuple[int, int, bytes], ...]
    values: tuple[tuple[int, int, int, int], ...]

    def read(self, pdu: bytes, reference: int) -> ReadReply | None:
        """The answer, None if it must be examined."""
        if len(pdu) != self.size or any(pdu[first:end] != data for first, end, data in self.fixed):
            return None
        return ReadReply(
            reference, tuple([ItemResult(code, pdu[first:end], size) for first, end, code, size in self.values])
        )


class KnownReplies:
    """Layouts of answers by the request without its reference."""

    def __init__(self) -> None:
        self._known: dict[bytes, KnownReply] = {}

    def find(self, request: bytes) -> KnownReply | None:
        """What the answer to a request looked like."""
        return self._known.get(request[6:])

    def keep(self, request: bytes, pdu: bytes, reply: ReadReply) -> None:
        """Keep what an examined answer looks like; bits are examined each time, as not every byte is one."""
        if any(not result.ok or result.size_code not in _VALUES for result in reply.results):
            return
        at, before = _DATA, 6
        fixed, values = [(0, 4, pdu[:4])], []
        for result in reply.results:
            first, end = at + _HEADER, at + _HEADER + len(result.data)
            fixed.append((before, first, pdu[before:first]))
            values.append((first, end, result.code, result.size_code))
            before, at = end, end + len(result.data) % 2
        if before < len(pdu):
            fixed.append((before, len(pdu), pdu[before:]))
        if len(self._known) >= _MOST:
            self._known.clear()
        self._known[request[6:]] = KnownReply(len(pdu), tuple(fixed), tuple(values))
