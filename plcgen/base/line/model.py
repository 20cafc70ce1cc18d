"""What a line is, and how it fails."""

from __future__ import annotations

from typing import Protocol

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span

CANNOT_OPEN, BUSY, LOST, MISSING_PACKAGE = "PG720", "PG721", "PG722", "PG723"
CHUNK = 4096
"""Most bytes that one read returns unless asked otherwise."""


class LineError(DiagnosticError):
    """A line that cannot be opened or used: one diagnostic whose place is the name of the line."""

    def __init__(self, code: str, line: str, message: str, help_: str = "") -> None:
        super().__init__([Diagnostic(code, message, Span(line), help=help_)])


class LineLostError(LineError):
    """The line ended while it was in use: unplugged, closed by the partner, switched off."""

    def __init__(self, line: str, message: str = "the line was lost", help_: str = "") -> None:
        super().__init__(LOST, line, message, help_)


class Line(Protocol):
    """A stream of bytes in both directions; nothing is promised about how it is cut into reads."""

    @property
    def name(self) -> str:
        """How people call it: ``/dev/ttyUSB0``, ``socket://10.0.0.5:4000``."""

    def write(self, data: bytes) -> None:
        """Send all of ``data``. Raises LineLostError."""

    def read(self, maximum: int = CHUNK, timeout: float | None = None) -> bytes:
        """Return what has arrived, 1 to ``maximum`` bytes; empty if nothing came within ``timeout`` seconds.

        None waits for ever, 0 does not wait. Raises LineLostError.
        """

    def close(self) -> None:
        """Give the line back; closing twice does no harm."""
