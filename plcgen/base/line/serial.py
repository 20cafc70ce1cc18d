"""Serial ports, through pyserial (extra ``serial``), the only importer of it."""

from __future__ import annotations

import errno
import os
import select
from typing import Any

from plcgen.base.line.model import BUSY, CANNOT_OPEN, CHUNK, MISSING_PACKAGE, LineError, LineLostError

_WRITE_SECONDS = 10.0
"""A port that takes no byte for so long is gone."""


class SerialLine:
    """A serial port with 8 data bits, even parity and 1 stop bit, as PPI needs it; also one behind RFC 2217."""

    def __init__(self, port: str, rate: int = 9600) -> None:
        try:
            import serial
        except ImportError as problem:
            raise LineError(
                MISSING_PACKAGE,
                port,
                "serial ports need the package pyserial",
                "pip install pyserial (with pipx: pipx inject plcgen pyserial)",
            ) from problem
        self._failures: tuple[type[Exception], ...] = (
            *_terminal_errors(),
            serial.SerialException,
            OSError,
            TypeError,
            ValueError,
        )
        self._name = port
        # Linux refuses to change nothing but the parity of a pseudo terminal, which has none.
        parity = serial.PARITY_NONE if _is_pseudo_terminal(port) else serial.PARITY_EVEN
        settings = rate, serial.EIGHTBITS, parity, serial.STOPBITS_ONE
        remote = "://" in port
        try:
            self._port: Any = (
                serial.serial_for_url(port, *settings, timeout=0)
                if remote
                else serial.Serial(port, *settings, timeout=0, exclusive=True)
            )
        except self._failures as problem:
            raise _refused(port, problem) from problem
        self._pseudo = _is_pseudo_terminal(port)
        self._descriptor: Any = self._port.fileno() if os.name == "posix" and not remote else None

    @property
    def name(self) -> str:
        """Name of the port."""
        return self._name

    def write(self, data: bytes) -> None:
        """Send all of ``data`` and wait until it is on the line. Raises LineLostError."""
        try:
            self._port.write(data) if self._descriptor is None else self._send(memoryview(data))
            if not self._pseudo:
                self._port.flush()
        except self._failures as problem:
            raise self._lost(problem) from problem

    def _send(self, rest: memoryview) -> None:
        """Write without pyserial's own waiting, which costs more than the writing."""
        while rest:
            try:
                rest = rest[os.write(self._descriptor, rest) :]
            except BlockingIOError:
                if not select.select([], [self._descriptor], [], _WRITE_SECONDS)[1]:
                    raise LineLostError(self._name, f"no data was accepted for {_WRITE_SECONDS:.0f} s") from None

    def read(self, maximum: int = CHUNK, timeout: float | None = None) -> bytes:
        """Return what has arrived; empty after ``timeout`` seconds. Raises LineLostError."""
        try:
            found = self._read(maximum, timeout)
        except self._failures as problem:
            raise self._lost(problem) from problem
        if found is None:
            raise LineLostError(self._name, "the port ended", "was the cable pulled out?")
        return found

    def _read(self, maximum: int, timeout: float | None) -> bytes | None:
        """Bytes, empty after ``timeout``, None at the end of the port."""
        if self._descriptor is not None:
            if not select.select([self._descriptor], [], [], timeout)[0]:
                return b""
            return os.read(self._descriptor, maximum) or None
        self._port.timeout = timeout
        first: bytes = self._port.read(1)
        if not first:
            return b""
        return first + bytes(self._port.read(min(self._port.in_waiting, maximum - 1)))

    def close(self) -> None:
        """Give the port back."""
        if self._descriptor is not None:
            self._descriptor = -1
        self._port.close()

    def _lost(self, problem: Exception) -> LineLostError:
        return LineLostError(self._name, f"the port was lost: {_reason(problem)}", "was the cable pulled out?")


def _terminal_errors() -> tuple[type[Exception], ...]:
    """What pyserial lets through from the system where there are terminals; it is no OSError."""
    try:
        import termios
    except ImportError:
        return ()
    return (termios.error,)


def _is_pseudo_terminal(port: str) -> bool:
    return os.path.realpath(port).startswith(("/dev/pts/", "/dev/ttys"))


def _refused(port: str, problem: Exception) -> LineError:
    if "://" in port:
        return LineError(
            CANNOT_OPEN, port, f"cannot be opened: {_reason(problem)}", "is the serial server switched on?"
        )
    number = getattr(problem, "errno", None)
    if number in {errno.ENOENT, errno.ENXIO, errno.ENODEV}:
        return LineError(CANNOT_OPEN, port, "there is no such port", _known())
    if number in {errno.EBUSY, errno.EAGAIN}:
        return LineError(BUSY, port, "the port is in use by another program", "close that program first")
    if number in {errno.EACCES, errno.EPERM}:
        return LineError(CANNOT_OPEN, port, "no permission to use the port", "on Linux, join the group dialout")
    return LineError(CANNOT_OPEN, port, f"cannot be opened: {_reason(problem)}", _known())


def _reason(problem: Exception) -> str:
    return " ".join(str(getattr(problem, "strerror", None) or problem).split())


def _known() -> str:
    from serial.tools.list_ports import comports

    ports = [str(port.device) for port in comports()]
    return f"ports here: {', '.join(ports)}" if ports else "this machine has no serial port"
