"""Stations on one line, read again and again: what they say, or why they say nothing; the line is opened again."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from plcgen.base.diagnostics import DiagnosticError
from plcgen.base.line.model import LineError
from plcgen.ppi.client import Client, ClientError
from plcgen.ppi.client.values import Value
from plcgen.ppi.log.rows import Channel

PAUSE = 10.0
"""Seconds for which a station that failed ``PATIENCE`` times in a row, or a line that cannot be opened, is left alone.

A silent station takes seconds of everybody's time, so it is not asked in every cycle.
"""
PATIENCE = 3

Connect = Callable[[Sequence[int]], Mapping[int, Client]]
"""Opens the line and returns a client for each of its stations. Raises LineError."""


@dataclass(slots=True)
class Answers:
    """One cycle: a value or None for each channel, and what is bad: whose problem it is, and its words."""

    values: list[Value | None]
    troubles: dict[str, str] = field(default_factory=dict)


@dataclass(slots=True)
class _Patience:
    """How often somebody failed in a row, and until when he is left alone."""

    failures: int = 0
    until: float = 0.0
    words: str = ""

    def failed(self, words: str, now: float, patience: int = PATIENCE) -> None:
        self.failures, self.words = self.failures + 1, words
        if self.failures >= patience:
            self.until = now + PAUSE


class Stations:
    """Everything that is read; ``now`` are seconds of a clock that only runs forwards."""

    def __init__(self, connect: Connect, channels: Sequence[Channel], now: Callable[[], float]) -> None:
        self._connect, self._now, self._width = connect, now, len(channels)
        self._channels: dict[int, list[tuple[int, Channel]]] = {}
        for number, channel in enumerate(channels):
            self._channels.setdefault(channel.station, []).append((number, channel))
        self._clients: Mapping[int, Client] = {}
        self._line = _Patience()
        self._patience = {station: _Patience() for station in self._channels}

    def read(self) -> Answers:
        """Read all stations once; what fails is told in the answers and tried again in a later cycle."""
        answers = Answers([None] * self._width)
        if not self._clients and self._now() >= self._line.until:
            try:
                self._clients = self._connect(tuple(self._patience))
                self._line = _Patience()
            except LineError as problem:
                self._line.failed(words_of(problem), self._now(), 1)
        for station, patience in self._patience.items():
            if self._clients and self._now() >= patience.until:
                self._ask(station, patience, answers)
            elif self._clients:
                answers.troubles[f"station {station}"] = patience.words
        if not self._clients:
            answers.troubles["line"] = self._line.words
        return answers

    def _ask(self, station: int, patience: _Patience, answers: Answers) -> None:
        wanted = self._channels[station]
        try:
            readings = self._clients[station].read(*(channel.place for _, channel in wanted))
        except ClientError as problem:
            patience.failed(words_of(problem), self._now())
            answers.troubles[f"station {station}"] = patience.words
        except LineError as problem:
            self._line.words = words_of(problem)
            self.close()
        else:
            self._patience[station] = _Patience()
            for (number, channel), reading in zip(wanted, readings, strict=True):
                answers.values[number] = reading.value
                if not reading.ok:
                    answers.troubles[channel.name] = f"{channel.name}: {reading.error}"

    def close(self) -> None:
        """Give the line back."""
        for client in self._clients.values():
            client.close()
        self._clients = {}


def words_of(problem: DiagnosticError) -> str:
    """What went wrong, in one line."""
    return "; ".join(f"{each.code} {each.message}" for each in problem.diagnostics)
