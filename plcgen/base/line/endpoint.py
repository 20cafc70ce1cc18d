"""A partner in memory behind a line, in virtual time: what tests and in-process exchanges talk to."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

from plcgen.base.line.model import CHUNK, LineLostError


class Endpoint(Protocol):
    """A partner that takes bytes and has bytes to send, at times in milliseconds that never run backwards."""

    def receive(self, data: bytes, now: int) -> None:
        """Take bytes that arrive at ``now``."""

    def transmit(self, now: int) -> bytes:
        """Hand out everything that has been sent up to ``now``; empty if there is nothing."""

    def due(self) -> int | None:
        """When the next bytes will be sent, None if nothing is under way."""


@dataclass(slots=True)
class Clock:
    """Virtual time in milliseconds, shared by the lines of one test."""

    now: int = 0

    def advance(self, milliseconds: int) -> None:
        """Let time pass."""
        if milliseconds < 0:
            raise ValueError(f"time does not run backwards: {milliseconds} ms")
        self.now += milliseconds


class EndpointLine:
    """A line to an endpoint. Waiting in ``read`` lets the virtual time pass instead of sleeping.

    A read returns as soon as bytes are there, and moves the clock only as far as it had to wait.
    """

    def __init__(self, endpoint: Endpoint, clock: Clock | None = None, name: str = "memory") -> None:
        self.endpoint = endpoint
        self.clock = clock or Clock()
        self._name = name
        self._pending = bytearray()
        self._closed = False

    @property
    def name(self) -> str:
        """Name given to it."""
        return self._name

    def write(self, data: bytes) -> None:
        """Hand bytes to the endpoint at the time of the clock."""
        self._check()
        self.endpoint.receive(bytes(data), self.clock.now)

    def read(self, maximum: int = CHUNK, timeout: float | None = None) -> bytes:
        """Return bytes of the endpoint; waiting for ever for nothing is a mistake and raises LineLostError."""
        self._check()
        end = None if timeout is None else self.clock.now + math.ceil(timeout * 1000)
        while not self._pending:
            self._pending += self.endpoint.transmit(self.clock.now)
            if self._pending:
                break
            due = self.endpoint.due()
            if due is not None and (end is None or due <= end):
                self.clock.now = max(self.clock.now, due)
                continue
            if end is None:
                raise LineLostError(self._name, "nothing will ever arrive on this line")
            self.clock.now = max(self.clock.now, end)
            return b""
        found = bytes(self._pending[:maximum])
        del self._pending[:maximum]
        return found

    def close(self) -> None:
        """Refuse further use."""
        self._closed = True

    def _check(self) -> None:
        if self._closed:
            raise LineLostError(self._name, "the line is closed")
