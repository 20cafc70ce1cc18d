"""Signals that end a program: they unwind it like Ctrl-C, so that everything is tidied up, and wait for a change."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import NoReturn

ENDING = tuple(getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP", "SIGBREAK") if hasattr(signal, name))
"""Ctrl-C, ``kill``, a terminal that is closed, Ctrl-Break of Windows."""


class EndedError(SystemExit):
    """A signal ended the program: its code is 128 + the number, as shells report it."""

    def __init__(self, number: int) -> None:
        super().__init__(128 + number)
        self.number = number

    def __str__(self) -> str:
        return signal.Signals(self.number).name


@contextmanager
def unwinding() -> Iterator[None]:
    """Let what would end the process at once raise EndedError instead.

    What somebody else decided stays: Python's Ctrl-C, a SIGHUP that ``nohup`` lets us ignore.
    """
    ours = [number for number in ENDING if signal.getsignal(number) is signal.SIG_DFL] if _main_thread() else []
    try:
        for number in ours:
            signal.signal(number, _unwind)
        yield
    finally:
        for number in ours:
            signal.signal(number, signal.SIG_DFL)


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Hold back what would end the program until a change is through."""
    waiting: list[int] = []
    before = {number: signal.getsignal(number) for number in ENDING} if _main_thread() else {}
    theirs = {number: handler for number, handler in before.items() if handler is not None}  # None: set by C code
    try:
        for number in theirs:
            signal.signal(number, lambda number, _: waiting.append(number))
        yield
    finally:
        for number, handler in theirs.items():
            signal.signal(number, handler)
        if waiting:
            signal.raise_signal(waiting[0])


def _main_thread() -> bool:
    """Whether handlers can be set: others leave that to it."""
    return threading.current_thread() is threading.main_thread()


def _unwind(number: int, _frame: FrameType | None) -> NoReturn:
    raise EndedError(number)
