"""Captures as text or bytes: hexadecimal lines with or without times and directions become one stream of bytes."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from itertools import pairwise

from plcgen.base.diagnostics import Diagnostic, Span
from plcgen.base.telegrams.hexbytes import HexError, HexText, hex_problem, parse_hex, strip_comment
from plcgen.ppi.texts import StreamPiece
from plcgen.ppi.wire.fdl import SD1, SD2, SD3, SD4
from plcgen.ppi.wire.stream import split

SPELLINGS = "write bytes as 68 1B 1B 68, 681B1B68, 16#68 or 0x68; times and TX/RX at the start of a line are skipped"
_TIME = r"[\[(]?[0-9][0-9:.,\-/T ]*[0-9][\])]?\s+"
_DIRECTION = r"\[?(?:TX|RX|SEND|RECV|OUT|IN|WRITE|READ|REQ|RES)\]?\s*:?|->|<-|>>|<<|>|<"
_PREFIX = re.compile(rf"\s*(?:{_TIME})?(?:{_DIRECTION})[:\s]+", re.IGNORECASE)
_STARTS = frozenset({SD1, SD2, SD3, SD4})
_HEAD = re.compile(rb"\x68(.)\1\x68|\x10[\x00-\x7f]{2}.", re.DOTALL)


@dataclass(slots=True)
class Capture:
    """A stream of bytes and where each came from: ``name`` and, for text, line and column."""

    name: str
    data: bytearray = field(default_factory=bytearray)
    problems: list[Diagnostic] = field(default_factory=list)
    _lines: list[tuple[int, int, HexText]] = field(default_factory=list)

    def add_line(self, text: str, number: int) -> None:
        """Append one line of text; what is no hexadecimal becomes a problem."""
        body = strip_comment(text)
        prefix = _PREFIX.match(body)
        if prefix is not None:
            body = " " * prefix.end() + body[prefix.end() :]
        if not body.strip():
            return
        try:
            parsed = parse_hex(body)
        except HexError as problem:
            self.problems.append(hex_problem(problem, self.name, number, SPELLINGS))
            return
        self._lines.append((len(self.data), number, parsed))
        self.data += parsed.data

    def span(self, offset: int) -> Span:
        """Where byte ``offset`` of the stream stands."""
        from bisect import bisect_right

        if not self._lines:
            return Span(self.name)
        start, number, parsed = self._lines[max(0, bisect_right(self._lines, offset, key=lambda line: line[0]) - 1)]
        column, length = parsed.place(offset - start)
        return Span(self.name, number, column + 1, number, column + 1 + length)

    def pieces(self, *, tolerant: bool) -> list[StreamPiece]:
        """Frames and what lies between them; garbage is cut where a line or something like a frame starts."""
        found: list[StreamPiece] = []
        for chunk in split(bytes(self.data), tolerant=tolerant):
            if chunk.frame:
                found.append(StreamPiece(chunk.offset, chunk.data, telegram=True))
            else:
                found += self._cut(chunk.offset, chunk.data)
        return found

    def _cut(self, offset: int, data: bytes) -> list[StreamPiece]:
        cuts = {start - offset for start, _, _ in self._lines if offset < start < offset + len(data)}
        cuts |= {match.start() for match in _HEAD.finditer(data) if match[0][0] == SD2}
        edges = sorted({0, *cuts, len(data)})
        pieces = ((offset + first, data[first:last]) for first, last in pairwise(edges))
        return [StreamPiece(start, part, telegram=part[0] in _STARTS) for start, part in pieces]


def capture_of(name: str, data: bytes) -> Capture:
    """Return the capture in a file: text if it is text, otherwise the bytes themselves."""
    capture = Capture(name)
    text = _text(data)
    if text is None:
        capture.data += data
        return capture
    for number, line in enumerate(text.replace("\r\n", "\n").replace("\r", "\n").split("\n"), 1):
        capture.add_line(line, number)
    return capture


def _text(data: bytes) -> str | None:
    """Decode text; None for bytes that are none (control characters, no UTF-8)."""
    encoding = "utf-16" if data[:2] in {b"\xff\xfe", b"\xfe\xff"} else "utf-8-sig"
    try:
        text = data.decode(encoding)
    except UnicodeDecodeError:
        return None
    return None if re.search(r"[\x00-\x08\x0e-\x1a\x1c-\x1f]", text) else text
