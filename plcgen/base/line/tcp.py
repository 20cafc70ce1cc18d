"""TCP: the raw byte stream of a serial device server, as its client and as the server itself."""

from __future__ import annotations

import errno
import math
import select
import socket

from plcgen.base.line.model import BUSY, CANNOT_OPEN, LineError, LineLostError
from plcgen.base.line.waiting import WaitingLine

SCHEME = "socket://"
CONNECT_SECONDS = 5.0


def parse_endpoint(text: str) -> tuple[str, int]:
    """Host and port of ``HOST:PORT``, ``[::1]:PORT`` or ``socket://HOST:PORT``. Raises LineError."""
    plain = text.removeprefix(SCHEME).rstrip("/")
    host, colon, port = plain.rpartition(":")
    host = host.removeprefix("[").removesuffix("]") if host.startswith("[") else host
    if (
        not colon
        or not port.isascii()
        or not port.isdecimal()
        or int(port) > 0xFFFF
        or (":" in host and "[" not in plain)
    ):
        raise LineError(CANNOT_OPEN, text, "a TCP line is HOST:PORT", "for example 127.0.0.1:4000 or [::1]:4000")
    return host or "127.0.0.1", int(port)


def tcp_name(host: str, port: int) -> str:
    """Name of a TCP line, as pyserial spells it."""
    return f"{SCHEME}[{host}]:{port}" if ":" in host else f"{SCHEME}{host}:{port}"


class TcpLine(WaitingLine):
    """One connection, made with ``connect`` or accepted by a server."""

    def __init__(self, connection: socket.socket, name: str) -> None:
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        connection.setblocking(False)  # noqa: FBT003 - the standard library's signature
        self._socket = connection
        self._descriptor = connection.fileno()
        self._poll = select.poll() if hasattr(select, "poll") else None
        if self._poll is not None:
            self._poll.register(self._descriptor, select.POLLIN)
        super().__init__(name)

    @classmethod
    def connect(cls, address: str) -> TcpLine:
        """Connect to a serial server. Raises LineError."""
        host, port = parse_endpoint(address)
        try:
            return cls(socket.create_connection((host, port), CONNECT_SECONDS), tcp_name(host, port))
        except OSError as problem:
            raise _refused(tcp_name(host, port), problem) from problem

    def fileno(self) -> int:
        """Return the descriptor of the socket."""
        return self._descriptor

    def close(self) -> None:
        """Close the connection."""
        self._descriptor = -1
        self._socket.close()

    def _send(self, data: bytes | memoryview) -> int:
        return self._socket.send(data)

    def _receive(self, maximum: int) -> bytes:
        return self._socket.recv(maximum)

    def _ready(self, timeout: float | None) -> bool:
        """By poll where the system has it: it needs less time than select."""
        if self._poll is None:
            return super()._ready(timeout)
        return bool(self._poll.poll(None if timeout is None else math.ceil(timeout * 1000)))


class TcpServer:
    """Listens for connections; serves one after the other as a serial server with one port does."""

    def __init__(self, address: str) -> None:
        host, port = parse_endpoint(address)
        try:
            family = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)[0][0]
            self._socket = socket.create_server((host, port), family=family)
        except OSError as problem:
            raise _refused(tcp_name(host, port), problem) from problem
        self._socket.setblocking(False)  # noqa: FBT003 - the standard library's signature
        self.name = tcp_name(host, self._socket.getsockname()[1])

    def accept(self, timeout: float | None = None) -> TcpLine | None:
        """Wait for the next connection; None if none comes within ``timeout`` seconds."""
        try:
            select.select([self._socket], [], [], timeout)
            connection, partner = self._socket.accept()
        except BlockingIOError:
            return None
        except (OSError, ValueError) as problem:
            raise LineLostError(self.name, "the server was closed") from problem
        return TcpLine(connection, tcp_name(partner[0], partner[1]))

    def fileno(self) -> int:
        """Return the descriptor, for ``select``."""
        return self._socket.fileno()

    def close(self) -> None:
        """Stop listening."""
        self._socket.close()


def _refused(name: str, problem: OSError) -> LineError:
    if problem.errno == errno.EADDRINUSE:
        return LineError(
            BUSY, name, "the port is in use by another program", "choose another port, or close that program"
        )
    if isinstance(problem, socket.gaierror):
        return LineError(CANNOT_OPEN, name, "there is no host of this name", "check the spelling, or write its address")
    if isinstance(problem, TimeoutError):
        return LineError(CANNOT_OPEN, name, "nothing answers at this address", "check the address and the cable")
    if isinstance(problem, ConnectionRefusedError):
        return LineError(CANNOT_OPEN, name, "nothing listens on this port", "is the serial server switched on?")
    if isinstance(problem, PermissionError):
        return LineError(CANNOT_OPEN, name, "no permission to use the port", "ports below 1024 belong to the system")
    return LineError(CANNOT_OPEN, name, f"cannot be opened: {problem.strerror or problem}")
