"""What pseudo terminals and sockets have in common: ``select`` tells when they are ready."""

from __future__ import annotations

import select
import time
from abc import ABC, abstractmethod

from plcgen.base.line.model import CHUNK, LineLostError

_WRITE_SECONDS = 10.0
"""A partner that takes no byte for so long is gone."""


class WaitingLine(ABC):
    """Writes until everything is sent and reads until something is there; the rest is the business of the kinds."""

    def __init__(self, name: str) -> None:
        self._name = name

    @property
    def name(self) -> str:
        """Name it was opened by."""
        return self._name

    @abstractmethod
    def fileno(self) -> int:
        """Return the descriptor, for ``select``; -1 if the line is closed."""

    @abstractmethod
    def close(self) -> None:
        """Close the line."""

    @abstractmethod
    def _send(self, data: bytes | memoryview) -> int:
        """Send some bytes without waiting and return how many."""

    @abstractmethod
    def _receive(self, maximum: int) -> bytes:
        """Return what is there without waiting; empty at the end of the line."""

    def write(self, data: bytes) -> None:
        """Send all of ``data``, waiting for room. Raises LineLostError."""
        if self.fileno() < 0:
            raise self._closed()
        rest: bytes | memoryview = bytes(data)
        while rest:
            try:
                sent = self._send(rest)
                rest = b"" if sent == len(rest) else memoryview(rest)[sent:]
            except BlockingIOError:
                if not select.select([], [self], [], _WRITE_SECONDS)[1]:
                    raise LineLostError(self._name, f"no data was accepted for {_WRITE_SECONDS:.0f} s") from None
            except OSError as problem:
                raise self._lost(problem) from problem

    def read(self, maximum: int = CHUNK, timeout: float | None = None) -> bytes:
        """Return what has arrived; empty after ``timeout`` seconds. Raises LineLostError at its end."""
        if self.fileno() < 0:
            raise self._closed()
        end = None if timeout is None else time.monotonic() + timeout
        left = timeout
        while True:
            if left != 0 and not self._ready(left):
                return b""
            try:
                found = self._receive(maximum)
            except BlockingIOError:
                left = None if end is None else max(0.0, end - time.monotonic())
                if left == 0:
                    return b""
                continue
            except OSError as problem:
                raise self._lost(problem) from problem
            if not found:
                raise LineLostError(self._name, "the partner closed the line")
            return found

    def _ready(self, timeout: float | None) -> bool:
        """Wait until bytes are there or the line has ended."""
        return bool(select.select((self.fileno(),), (), (), timeout)[0])

    def _closed(self) -> LineLostError:
        return LineLostError(self._name, "the line is closed")

    def _lost(self, problem: OSError) -> LineLostError:
        return LineLostError(self._name, f"the line was lost: {problem.strerror or problem}")
