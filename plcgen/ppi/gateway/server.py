"""The connections of the gateway: bounded, each with one request at a time on its way to the one line.

Requests of all clients are served in turn. While the line is busy the others wait in their sockets; who sends without
reading his answers is not served further.
"""

from __future__ import annotations

import select
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field

from plcgen.base.line.model import LineLostError
from plcgen.base.line.tcp import TcpLine, TcpServer
from plcgen.ppi.gateway.passing import Passing
from plcgen.ppi.wire.iso import Connect, IsoError, IsoStream, carry, connect_confirm

MOST_CONNECTIONS = 16
"""One more connection ends the one that was silent longest: nobody keeps others out by doing nothing."""
MOST_WAITING = 8
"""Requests of one connection that wait; a client that sends more without waiting for answers is cut off."""
IDLE = 600.0
_GREETING = 10.0
"""Seconds in which a new connection must have asked for its ISO connection."""
_PATIENCE = 0.25


@dataclass(slots=True)
class _Guest:
    """One connection."""

    heard: float
    stream: IsoStream = field(default_factory=IsoStream)
    waiting: deque[bytes] = field(default_factory=deque)
    greeted: bool = False


class Gateway:
    """Serves clients until ``ended()`` is true; ``tell`` hears who comes and goes."""

    def __init__(
        self,
        server: TcpServer,
        passing: Passing,
        tell: Callable[[str], None],
        *,
        most: int = MOST_CONNECTIONS,
        idle: float = IDLE,
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        self._server, self._passing, self._tell = server, passing, tell
        self._most, self._idle, self._now = most, idle, now
        self._guests: dict[TcpLine, _Guest] = {}

    def serve(self, ended: Callable[[], bool], patience: float = _PATIENCE) -> None:
        """Serve; returns when it is told to end, with all connections closed."""
        try:
            while not ended():
                self._turn(patience)
        finally:
            for line in list(self._guests):
                self._leave(line, "the gateway ends")
            self._passing.close()

    def _turn(self, patience: float) -> None:
        """Take what has arrived, then serve one request of each connection that can take its answer."""
        pending = [line for line, guest in self._guests.items() if guest.waiting]
        sources: list[TcpServer | TcpLine] = [self._server]
        sources += [line for line, guest in self._guests.items() if not guest.waiting]
        readable, writable, _ = select.select(sources, pending, [], patience)
        for source in readable:
            if isinstance(source, TcpServer):
                self._welcome()
            else:
                self._hear(source)
        for line in writable:
            self._serve(line)
        now = self._now()
        for line, guest in list(self._guests.items()):
            if now - guest.heard > (self._idle if guest.greeted else _GREETING) and not guest.waiting:
                self._leave(line, "silent for too long")

    def _welcome(self) -> None:
        line = self._server.accept(0)
        if line is None:
            return
        if len(self._guests) >= self._most:
            self._leave(min(self._guests, key=lambda each: self._guests[each].heard), "too many connections")
        self._guests[line] = _Guest(self._now())
        self._tell(f"{line.name} connected")

    def _hear(self, line: TcpLine) -> None:
        guest = self._guests.get(line)
        if guest is None:  # has left in this turn
            return
        try:
            for entry in guest.stream.feed(line.read(timeout=0)):
                guest.heard = self._now()
                if isinstance(entry, Connect) is guest.greeted or len(guest.waiting) >= MOST_WAITING:
                    self._leave(line, "requests out of order, or too many of them")
                    return
                if isinstance(entry, Connect):
                    line.write(connect_confirm(entry))
                    guest.greeted = True
                else:
                    guest.waiting.append(entry)
        except (IsoError, LineLostError) as problem:
            self._leave(line, str(problem))

    def _serve(self, line: TcpLine) -> None:
        guest = self._guests.get(line)
        if guest is None:
            return
        answer = self._passing.answer(guest.waiting.popleft(), line.name)
        guest.heard = self._now()
        if answer is None:
            self._leave(line, "no S7 PDU")
            return
        try:
            line.write(carry(answer))
        except LineLostError as problem:
            self._leave(line, str(problem))

    def _leave(self, line: TcpLine, why: str) -> None:
        del self._guests[line]
        line.close()
        self._tell(f"{line.name} disconnected: {why}")
