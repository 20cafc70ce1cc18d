"""A stream of bytes split into frames: captures, and what a line delivers in pieces.

Garbage is skipped and reported. After a start byte whose frame cannot be one (lengths that contradict each other, no
end byte where it belongs, stations or a function that do not exist) the search goes on at the next byte, so that a
frame hidden in it is found. What has no checksum, a token, gives way to a good frame that begins inside it, and is
not believed if its stations look like start bytes and nobody with such an address has spoken.
"""

from __future__ import annotations

from typing import NamedTuple

from plcgen.ppi.wire.errors import Kind, Violation
from plcgen.ppi.wire.fdl import BROADCAST, FIXED_SIZES, LEAST_LENGTH, MOST_LENGTH, SD1, SD2, SD3, SD4
from plcgen.ppi.wire.fdl import END as END_BYTE
from plcgen.ppi.wire.model import ACKNOWLEDGE, CLIPPED, FCB, FCV, REQUEST, FixedFrame, Frame, VariableFrame

_STARTS = frozenset({SD1, SD2, SD3})
"""First bytes of frames with a checksum."""


class Chunk(NamedTuple):
    """Consecutive bytes of the stream from ``offset`` on: one frame, or garbage between frames (``frame`` False)."""

    offset: int
    data: bytes
    frame: bool


def _is_frame(data: bytes) -> bool:
    """Whether bytes are exactly one frame of the usual kinds (E5, SD1, SD2): what a line mostly delivers."""
    size = len(data)
    if size == 1:
        return data[0] == ACKNOWLEDGE
    if size == 6:
        return data[0] == SD1 and data[5] == END_BYTE and sum(data[1:4]) & 0xFF == data[4]
    return (
        LEAST_LENGTH + 6 <= size <= MOST_LENGTH + 6
        and data[0] == SD2 == data[3]
        and data[1] == size - 6 == data[2]
        and data[-1] == END_BYTE
        and sum(data[4:-2]) & 0xFF == data[-2]
    )


class Splitter:
    """Splits a stream into frames; feed it whatever arrives, in any pieces.

    ``tolerant`` takes the single bytes F9 and FE between frames as clipped acknowledgements instead of garbage.
    """

    def __init__(self, *, tolerant: bool = False) -> None:
        self._single = frozenset({ACKNOWLEDGE}) | (CLIPPED if tolerant else frozenset())
        self._pending = bytearray()
        self._offset = 0
        self._garbage = bytearray()
        self._stations: set[int] = set()
        """Stations that have sent a frame with a checksum."""

    @property
    def pending(self) -> int:
        """Bytes that wait for more: the beginning of a frame."""
        return len(self._pending)

    @property
    def rest(self) -> bytes:
        """The bytes that wait for more."""
        return bytes(self._pending)

    def clear(self) -> None:
        """Forget what waits for more."""
        self._offset += len(self._pending)
        self._pending.clear()
        self._garbage.clear()

    def whole(self, data: bytes) -> bool:
        """Take bytes if they are exactly one frame and nothing waits; otherwise they are to be fed."""
        if self._pending or self._garbage or not _is_frame(data):
            return False
        self._offset += len(data)
        if len(data) > 1:
            self._stations.add(data[5 if data[0] == SD2 else 2])
        return True

    def feed(self, data: bytes) -> list[Chunk]:
        """Take bytes and return what is complete, in order."""
        if self.whole(data):
            return [Chunk(self._offset - len(data), bytes(data), frame=True)]
        self._pending += data
        return self._split(last=False)

    def finish(self) -> list[Chunk]:
        """Return what is left at the end of the stream or after a pause: frames inside it, and garbage."""
        return self._split(last=True)

    def _split(self, *, last: bool) -> list[Chunk]:
        found: list[Chunk] = []
        pending, at, end = self._pending, 0, len(self._pending)
        while at < end:
            size, good = self._size(at, end, last=last)
            if size < 0 and not last:
                break
            if good:
                self._flush(found, self._offset + at)
                found.append(Chunk(self._offset + at, bytes(pending[at : at + size]), frame=True))
            else:
                size = max(size, 1)
                self._garbage += pending[at : at + size]
            at += size
        self._offset += at
        del pending[:at]
        if last:
            self._flush(found, self._offset)
        return found

    def _flush(self, found: list[Chunk], end: int) -> None:
        if self._garbage:
            found.append(Chunk(end - len(self._garbage), bytes(self._garbage), frame=False))
            self._garbage.clear()

    def _size(self, at: int, end: int, *, last: bool) -> tuple[int, bool]:
        """Length of what starts at ``at`` and whether it is a frame; -1 if more bytes are needed to tell.

        A frame that is complete except for its checksum is skipped as a whole, as its contents may look like frames,
        unless a good one reaches to its end or beyond: then it was none itself.
        """
        pending = self._pending
        start = pending[at]
        if start in self._single:
            return 1, True
        if start == SD4:
            return self._token(at, end, last=last)
        if start not in _STARTS:
            return 0, False
        size, good = self._checked(at, end)
        if good:
            self._stations.add(pending[at + (5 if start == SD2 else 2)])
            return size, True
        if size <= 0:
            return size, False
        return self._hidden(at, size, end, last=last) if self._plausible(at) else 0, False

    def _checked(self, at: int, end: int) -> tuple[int, bool]:
        """Length of the frame with a checksum at ``at``, and whether it is right; 0 if there is none, -1 as above."""
        pending = self._pending
        start = pending[at]
        if start == SD2:
            size, first = self._variable_size(at, end), at + 4
        else:
            size, first = FIXED_SIZES[start], at + 1
        if size <= 0:
            return size, False
        if at + size > end:
            return -1, False
        if pending[at + size - 1] != END_BYTE:
            return 0, False
        return size, sum(pending[first : at + size - 2]) & 0xFF == pending[at + size - 2]

    def _plausible(self, at: int) -> bool:
        first = at + (4 if self._pending[at] == SD2 else 1)
        destination, source, function = self._pending[first : first + 3]
        return destination <= BROADCAST and source < BROADCAST and function < 0x80

    def _hidden(self, at: int, size: int, end: int, *, last: bool) -> int:
        """What to skip of damaged bytes: nothing if a good frame begins in them and reaches to their end or beyond."""
        for inner in range(at + 1, at + size):
            if self._pending[inner] in _STARTS:
                length, good = self._checked(inner, end)
                if good and inner + length >= at + size:
                    return 0
                if length < 0 and not last:
                    return -1
        return size

    def _token(self, at: int, end: int, *, last: bool) -> tuple[int, bool]:
        """A token frame: it has no checksum, so what else its bytes may be counts more."""
        size = FIXED_SIZES[SD4]
        if at + size > end:
            return -1, False
        stations = self._pending[at + 1 : at + size]
        if max(stations) >= BROADCAST:
            return 0, False
        for inner in (at + 1, at + 2):
            if self._pending[inner] in _STARTS:
                length, good = self._checked(inner, end)
                if good or (length < 0 and not last):
                    return (0 if good else -1), False
        return (size, True) if self._stations.issuperset(_STARTS.intersection(stations)) else (0, False)

    def _variable_size(self, at: int, end: int) -> int:
        """Length of the SD2 frame at ``at`` by its own account, 0 if its head contradicts itself, -1 if cut short."""
        head = self._pending[at : min(at + 4, end)]
        wrong = (
            (len(head) > 1 and not LEAST_LENGTH <= head[1] <= MOST_LENGTH)
            or (len(head) > 2 and head[2] != head[1])
            or (len(head) > 3 and head[3] != SD2)
        )
        if wrong:
            return 0
        return head[1] + 6 if len(head) == 4 else -1


def split(data: bytes, *, tolerant: bool = False) -> list[Chunk]:
    """Split a complete capture into frames and the garbage between them."""
    splitter = Splitter(tolerant=tolerant)
    return splitter.feed(data) + splitter.finish()


_COUNTED = frozenset({0x3, 0x5, 0xC, 0xD})


class FrameCountCheck:
    """Follows the requests of a capture, each pair of stations on its own: the frame count bit must alternate.

    EN 50170: a station that sees the same bit again (FCV = 1) repeats its last answer and executes nothing. A master
    that never toggles it gets old answers; some stations do not mind, hence tolerable.
    """

    def __init__(self) -> None:
        self._last: dict[tuple[int, int], Frame] = {}

    def follow(self, frame: Frame) -> list[Violation]:
        """Take the next frame; return what is wrong with its function code (offset in the frame)."""
        if not isinstance(frame, VariableFrame | FixedFrame):
            return []
        function = frame.function
        if not function & REQUEST or function & 0x0F not in _COUNTED:
            return []
        pair = (frame.destination, frame.source)
        before = self._last.get(pair)
        self._last[pair] = frame
        if not function & FCV or not isinstance(before, VariableFrame | FixedFrame) or before == frame:
            return []
        if (before.function ^ function) & FCB:
            return []
        text = (
            f"the function code {function:02X}h has the frame count bit of the request before: "
            "a station repeats its last answer instead of executing this"
        )
        return [Violation(Kind.FRAME_COUNT, 6 if isinstance(frame, VariableFrame) else 3, text)]
