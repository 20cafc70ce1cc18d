"""A simulated bus on a real line: bytes from the line to the bus and back, until someone ends it.

Over a pseudo terminal or TCP the speed of a real line means nothing: answers go out at once, late ones when their
time has come. Time is counted in milliseconds from the start.
"""

from __future__ import annotations

import select
import threading
import time
from collections.abc import Callable
from types import TracebackType

from plcgen.base.line.model import Line, LineLostError
from plcgen.base.line.tcp import TcpLine, TcpServer
from plcgen.ppi.sim.bus import Bus

_PATIENCE = 0.25
"""Seconds after which a server looks whether it shall end."""

MOST_CONNECTIONS = 64
"""One more connection ends the one that was silent longest: nobody keeps others out by doing nothing."""

IDLE = 600.0
"""Seconds of silence after which a connection is ended: its client may be gone without a word."""

Ended = Callable[[], bool]


class Stopwatch:
    """Milliseconds since it was made."""

    def __init__(self) -> None:
        self._start = time.monotonic()

    @property
    def now(self) -> int:
        """Whole milliseconds."""
        return int((time.monotonic() - self._start) * 1000)


def serve_line(bus: Bus, line: Line, ended: Ended, patience: float = _PATIENCE) -> None:
    """Serve one line until ``ended()`` is true. Raises LineLostError if the line goes away."""
    clock = Stopwatch()
    while not ended():
        due = bus.due()
        wait = patience if due is None else min(patience, max(0.0, (due - clock.now) / 1000))
        data = line.read(timeout=wait)
        if data:
            bus.receive(data, clock.now)
        answer = bus.transmit(clock.now)
        if answer:
            line.write(answer)


def serve_tcp(
    bus: Bus,
    server: TcpServer,
    ended: Ended,
    tell: Callable[[str], None] | None = None,
    patience: float = _PATIENCE,
    idle: float = IDLE,
) -> None:
    """Serve connections, one after the other or several at once, until ``ended()`` is true.

    Every connection is a line of its own to the same CPUs: it begins with fresh frame counts, and nobody waits because
    another client holds its connection, or many of them. One that is silent for ``idle`` seconds is ended, 0: none is.
    """
    clock, tell = Stopwatch(), tell or _quiet
    branches: dict[TcpLine, Bus] = {}
    heard: dict[TcpLine, int] = {}
    try:
        while not ended():
            dues = [due for due in (branch.due() for branch in branches.values()) if due is not None]
            wait = min([patience, *(max(0.0, (due - clock.now) / 1000) for due in dues)])
            sources: list[TcpServer | TcpLine] = [server, *branches]
            ready = select.select(sources, [], [], wait)[0]
            fresh = server.accept(0) if server in ready else None
            if fresh is not None:
                if len(branches) >= MOST_CONNECTIONS:
                    _leave(next(iter(branches)), branches, tell)
                branches[fresh] = bus.branch()
                heard[fresh] = clock.now
                tell(f"{fresh.name} connected")
            for line, branch in list(branches.items()):
                try:
                    _attend(branch, line, clock, readable=line in ready)
                except LineLostError:
                    _leave(line, branches, tell)
                    continue
                if line in ready:
                    branches[line] = branches.pop(line)  # the order is that of silence
                    heard[line] = clock.now
                elif idle and clock.now - heard[line] >= idle * 1000:
                    _leave(line, branches, tell, "silent for too long")
    finally:
        for line in branches:
            line.close()


def _leave(line: TcpLine, branches: dict[TcpLine, Bus], tell: Callable[[str], None], why: str = "") -> None:
    del branches[line]
    line.close()
    tell(f"{line.name} disconnected{f', {why}' if why else ''}")


def _attend(bus: Bus, line: Line, clock: Stopwatch, *, readable: bool) -> None:
    if readable:
        data = line.read(timeout=0)
        if data:
            bus.receive(data, clock.now)
    answer = bus.transmit(clock.now)
    if answer:
        line.write(answer)


def _quiet(_text: str) -> None:
    """Tell nobody."""


class Serving:
    """A bus served in a thread of its own, for tests and for programs that want a station beside them.

    ``with Serving(bus, PtyLine()) as name:`` gives the name of the line to open; leaving it ends the thread and closes
    the line. ``failure`` is what ended the thread early.
    """

    def __init__(self, bus: Bus, line: Line | TcpServer, patience: float = 0.02) -> None:
        self.bus = bus
        self.line = line
        self.failure: Exception | None = None
        self._patience = patience
        self._end = threading.Event()
        self._thread = threading.Thread(target=self._run, name=f"serve {line.name}", daemon=True)

    def __enter__(self) -> str:
        self._thread.start()
        return self.line.name

    def __exit__(
        self, kind: type[BaseException] | None, problem: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._end.set()
        self._thread.join()
        self.line.close()

    def _run(self) -> None:
        try:
            if isinstance(self.line, TcpServer):
                serve_tcp(self.bus, self.line, self._end.is_set, patience=self._patience)
            else:
                serve_line(self.bus, self.line, self._end.is_set, patience=self._patience)
        except Exception as problem:  # noqa: BLE001 - told to whoever leaves the block
            self.failure = problem
