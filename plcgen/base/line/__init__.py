"""Lines that carry bytes: serial ports, TCP connections to serial servers, pseudo terminals, memory.

A line knows nothing of a protocol. ``model`` says what a line is, ``endpoint`` puts a partner in memory behind one,
``pty``, ``tcp`` and ``serial`` open the real ones, ``opening`` chooses by name.
"""

from plcgen.base.line.model import Line, LineError, LineLostError

__all__ = ["Line", "LineError", "LineLostError"]
