"""A stream of bytes split into frames: captures, and what a line delivers in pieces.

Garbage is skipped and reported. After a start byte whose frame cannot be one (lengths that contradict each other, no
end byte where it belongs) the search goes on at the next byte, so that a frame hidden in it is found.
"""

from __future__ import annotations

from typing import NamedTuple

from plcgen.protocols.ppi.wire.fdl import END as END_BYTE
from plcgen.protocols.ppi.wire.fdl import FIXED_SIZES, LEAST_LENGTH, MOST_LENGTH, SD1, SD2, SD4
from plcgen.protocols.ppi.wire.model import ACKNOWLEDGE, CLIPPED


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

    @property
    def pending(self) -> int:
        """Bytes that wait for more: the beginning of a frame."""
        return len(self._pending)

    def clear(self) -> None:
        """Forget what waits for more."""
        self._offset += len(self._pending)
        self._pending.clear()
        self._garbage.clear()

    def feed(self, data: bytes) -> list[Chunk]:
        """Take bytes and return what is complete, in order."""
        if not self._pending and not self._garbage and _is_frame(data):
            self._offset += len(data)
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
            size, good = self._size(at, end)
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
        """Report the garbage that ends at ``end``."""
        if self._garbage:
            found.append(Chunk(end - len(self._garbage), bytes(self._garbage), frame=False))
            self._garbage.clear()

    def _size(self, at: int, end: int) -> tuple[int, bool]:
        """Length of what starts at ``at`` and whether it is a frame; -1 if more bytes are needed to tell.

        A frame that is complete except for its checksum is skipped as a whole: its contents may look like frames.
        """
        pending = self._pending
        start = pending[at]
        if start in self._single:
            return 1, True
        if start == SD2:
            size = self._variable_size(at, end)
            first = at + 4
        else:
            size = FIXED_SIZES.get(start, 0) if start != ACKNOWLEDGE else 0
            first = at + 1
        if size <= 0:
            return size, False
        if at + size > end:
            return -1, False
        if start == SD4:
            return (size, True) if pending[at + 1] < 0x80 and pending[at + 2] < 0x80 else (0, False)
        if pending[at + size - 1] != END_BYTE:
            return 0, False
        return size, sum(pending[first : at + size - 2]) & 0xFF == pending[at + size - 2]

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
