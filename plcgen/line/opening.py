"""Open a line by its name."""

from __future__ import annotations

from plcgen.line.model import Line
from plcgen.line.tcp import CONNECT_SECONDS, SCHEME


def open_line(name: str, rate: int = 9600, timeout: float = CONNECT_SECONDS) -> Line:
    """Open ``socket://HOST:PORT`` as a TCP connection and everything else as a serial port.

    ``rate`` in bit/s counts for serial ports only, ``timeout`` in seconds for connections only. Raises LineError.
    """
    if name.lower().startswith(SCHEME):
        from plcgen.line.tcp import TcpLine

        return TcpLine.connect(SCHEME + name[len(SCHEME) :], timeout)
    from plcgen.line.serial import SerialLine

    return SerialLine(name, rate)
