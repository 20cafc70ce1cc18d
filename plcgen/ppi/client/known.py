"""Answers that look like one before: the same read again, all of it good, at the same places. None need be examined.

Everything but the values is compared with an answer that was examined and found right, so nothing else gets through.
"""

from __future__ import annotations

from dataclasses import dataclass

from plcgen.ppi.wire.areas import SizeCode
from plcgen.ppi.wire.model import ItemResult, ReadReply

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
