"""A pseudo terminal: a serial port that exists in software, for programs on the same machine."""

from __future__ import annotations

import os

from plcgen.base.line.model import CANNOT_OPEN, CHUNK, LineError
from plcgen.base.line.waiting import WaitingLine

_REFRESH_SECONDS = 0.25


class PtyLine(WaitingLine):
    """The master side; programs open ``name``. The other side stays open here, so they may come and go.

    Linux refuses ``tcsetattr`` if nothing of what it asks for can be changed, and a pseudo terminal has no parity:
    a second program that sets 9600 bit/s, 8E1 would fail. So its speed, which means nothing, is kept at 50 bit/s.
    """

    def __init__(self) -> None:
        try:
            import pty
            import termios
            import tty
        except ImportError as problem:
            raise LineError(
                CANNOT_OPEN, "pty", "this system has no pseudo terminals", "use --tcp HOST:PORT or --port DEVICE"
            ) from problem
        try:
            self._master, self._slave = pty.openpty()
        except OSError as problem:
            raise LineError(CANNOT_OPEN, "pty", f"no pseudo terminal is free: {problem.strerror}") from problem
        tty.setraw(self._slave)
        self._termios = termios
        self._refresh()
        os.set_blocking(self._master, False)
        super().__init__(os.ttyname(self._slave))

    def read(self, maximum: int = CHUNK, timeout: float | None = None) -> bytes:
        """Return what has arrived; empty after ``timeout`` seconds."""
        while True:
            step = _REFRESH_SECONDS if timeout is None else min(timeout, _REFRESH_SECONDS)
            found = super().read(maximum, step)
            self._refresh()
            if timeout is not None:
                timeout -= step
            if found or (timeout is not None and timeout <= 0):
                return found

    def fileno(self) -> int:
        """Return the descriptor of the master side."""
        return self._master

    def close(self) -> None:
        """Close both sides; programs that have it open see the end of the line."""
        for descriptor in (self._master, self._slave):
            if descriptor >= 0:
                os.close(descriptor)
        self._master = self._slave = -1

    def _refresh(self) -> None:
        """Leave something that the next program can change."""
        attributes = self._termios.tcgetattr(self._slave)
        if attributes[4:6] != [self._termios.B50] * 2:
            attributes[4:6] = [self._termios.B50] * 2
            self._termios.tcsetattr(self._slave, self._termios.TCSANOW, attributes)

    def _send(self, data: bytes | memoryview) -> int:
        return os.write(self._master, data)

    def _receive(self, maximum: int) -> bytes:
        return os.read(self._master, maximum)
