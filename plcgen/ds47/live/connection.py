"""A connection to a drive or CPU that can read data blocks and do nothing else; the only importer of python-snap7.

Every request ends within its limit of time, whatever the other side does: python-snap7 waits for each piece of an
answer, so a clock of our own ends the connection.
"""

from __future__ import annotations

import contextlib
import logging
import socket
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from types import TracebackType
from typing import TYPE_CHECKING, Protocol, Self

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, PlcgenError, Span

if TYPE_CHECKING:
    from snap7.client import Client

PORT = 102
ANSWER_SECONDS = 5.0


@dataclass(frozen=True, slots=True)
class S7Partner:
    """Whom to ask: a name or IPv4 address, a TCP port, rack and slot (0 and 0 for a drive)."""

    host: str
    port: int = PORT
    rack: int = 0
    slot: int = 0

    def __str__(self) -> str:
        """As the command line has it."""
        return self.host if self.port == PORT else f"{self.host}:{self.port}"


class Reader(Protocol):
    """What the verbs need of a connection."""

    def read(self, db: int, start: int, size: int) -> bytes:
        """``size`` bytes of a data block. Raises ReadRefusedError, or DiagnosticError if the connection is lost."""


class ReadRefusedError(PlcgenError):
    """The other side answered that it has no such bytes, or that they may not be read."""


class S7Connection:
    """A connection by python-snap7, open while it is a context."""

    def __init__(self, place: S7Partner, seconds: float = ANSWER_SECONDS) -> None:
        self.place = place
        self._seconds = seconds
        self._client = _client(place)
        self._late = False

    def __enter__(self) -> Self:
        from snap7.error import S7Error

        place = self.place
        try:
            with self._limit():
                self._client.connect(place.host, place.rack, place.slot, place.port)
        except (S7Error, OSError) as problem:
            raise self._lost(f"cannot connect to {place}: {_line(problem)}") from problem
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        with contextlib.suppress(Exception):
            self._client.disconnect()

    def read(self, db: int, start: int, size: int) -> bytes:
        """``size`` bytes of data block ``db`` from byte ``start``; as many as were asked for, or an exception."""
        from snap7.error import S7ConnectionError, S7Error, S7TimeoutError
        from snap7.type import Area

        try:
            with self._limit():
                return bytes(self._client.read_area(Area.DB, db, start, size))
        except (S7ConnectionError, S7TimeoutError, OSError) as problem:
            raise self._lost(f"the connection to {self.place} was lost: {_line(problem)}") from problem
        except S7Error as problem:
            if self._late or not self._client.get_connected():
                raise self._lost(f"the connection to {self.place} was lost: {_line(problem)}") from problem
            raise ReadRefusedError(_line(problem)) from problem
        except (ValueError, IndexError, KeyError) as problem:
            raise self._lost(
                f"{self.place} answered with something that is not an S7 telegram: {_line(problem)}"
            ) from problem

    @contextlib.contextmanager
    def _limit(self) -> Iterator[None]:
        clock = threading.Timer(self._seconds, self._cut)
        clock.daemon = True
        clock.start()
        try:
            yield
        finally:
            clock.cancel()

    def _cut(self) -> None:
        self._late = True
        connection = self._client.connection
        if connection is not None and connection.socket is not None:
            with contextlib.suppress(OSError):
                connection.socket.shutdown(socket.SHUT_RDWR)

    def _lost(self, message: str) -> DiagnosticError:
        if self._late:
            message = f"{self.place} did not answer within {self._seconds:g} s"
        help_ = "is the address right, is TCP port 102 open, does the device allow S7 communication (PUT/GET)?"
        return DiagnosticError([Diagnostic("PG705", message, Span(str(self.place)), help=help_)])


def _client(place: S7Partner) -> Client:
    try:
        from snap7.client import Client
    except ImportError:
        missing = "reading from a device needs python-snap7, which is not installed"
        help_ = "pip install 'plcgen[live]'"
        raise DiagnosticError([Diagnostic("PG705", missing, Span(str(place)), help=help_)]) from None
    logging.getLogger("snap7").setLevel(logging.CRITICAL)
    return Client()


def _line(problem: BaseException) -> str:
    return " ".join(str(problem).split())[:200] or type(problem).__name__
