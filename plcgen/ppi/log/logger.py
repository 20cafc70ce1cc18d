"""Cycle after cycle: read stations on a line, decide whether that is worth a row, hand it on; gaps are marked."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from plcgen.base.diagnostics import DiagnosticError
from plcgen.base.diagnostics.counting import quantity
from plcgen.base.display.cells import clean
from plcgen.base.line.model import LineError
from plcgen.ppi.client import Client, ClientError
from plcgen.ppi.client.values import Value
from plcgen.ppi.log.files import Channel, Keeper, Row, State

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


_NAP = 0.2
"""Longest sleep in seconds: a request to end is heard after it."""


class Clock:
    """The time of a logger: that of the day for the rows, one that only runs forwards for the cycles, and waiting."""

    def today(self) -> float:
        """Seconds since 1970."""
        return time.time()

    def now(self) -> float:
        """Seconds of a clock that nobody sets."""
        return time.monotonic()

    def sleep(self, seconds: float) -> None:
        """Wait."""
        time.sleep(seconds)


@dataclass(frozen=True, slots=True)
class Pace:
    """Seconds from one cycle to the next; rows of changes only, at the latest ``heartbeat`` seconds after another."""

    interval: float = 1.0
    changes: bool = False
    heartbeat: float = 60.0


class Logger:
    """Logs until ``ended()`` is true. ``tell`` gets what people at the terminal want to know, ``publish`` every row."""

    def __init__(
        self,
        channels: Sequence[Channel],
        stations: Stations,
        keeper: Keeper,
        pace: Pace,
        clock: Clock,
        tell: Callable[[str], None],
        publish: Callable[[Row], None] = lambda _: None,
    ) -> None:
        self._channels, self._stations, self._keeper = channels, stations, keeper
        self._pace, self._clock, self._tell, self._publish = pace, clock, tell, publish
        self._since: dict[str, float] = {}
        self._last: Row | None = None
        self._before: float | None = None

    def run(self, ended: Callable[[], bool], count: int | None = None) -> bool:
        """Log until told to end or for ``count`` cycles; whether the last cycle was good and every row is on disk."""
        self._keeper.add(Row(self._clock.today(), State.START, note=self._keeper.opening))
        due, number = self._clock.now(), 0
        while not ended() and (count is None or number < count):
            self.cycle()
            number += 1
            due = max(due + self._pace.interval, self._clock.now())
            while not ended() and number != count and (left := due - self._clock.now()) > 0:
                self._clock.sleep(min(left, _NAP))
        self._stations.close()
        self._keeper.add(Row(self._clock.today(), State.STOP))
        return self._keeper.close() and not self._since

    def cycle(self) -> None:
        """Read once and keep what is worth it; rows that found no place before are tried again."""
        now = self._clock.today()
        answers = self._stations.read()
        row = self._row(now, answers)
        if self._worth(row):
            self._last = row
            self._keeper.add(row)
        else:
            self._keeper.flush()
        self._publish(row)

    def _row(self, now: float, answers: Answers) -> Row:
        before, self._before = self._before, now
        gap = "" if before is None else self._gap(now - before)
        for key, words in answers.troubles.items():
            if key not in self._since:
                self._since[key] = now
                self._tell(f"bad: {words}")
        for key in self._since.keys() - answers.troubles.keys():
            self._tell(f"good again: {key}, bad for {now - self._since.pop(key):.0f} s")
        note = clean("; ".join(filter(None, (gap, *answers.troubles.values()))))
        if not answers.troubles:
            return Row(now, State.GOOD, answers.values, None, note)
        return Row(now, State.BAD, answers.values, min(self._since.values()), note)

    def _gap(self, passed: float) -> str:
        """What is to be marked between two cycles: missed ones, or a clock that was set back."""
        if passed < 0:
            return f"the clock was set back by {-passed:.1f} s"
        missed = round(passed / self._pace.interval) - 1 if self._pace.interval else 0
        return f"{quantity(missed, 'cycle')} missed" if missed > 0 else ""

    def _worth(self, row: Row) -> bool:
        last, pace = self._last, self._pace
        if not pace.changes or last is None or not 0 <= row.time - last.time < pace.heartbeat:
            return True
        if (row.state, row.since, row.note) != (last.state, last.since, last.note):
            return True
        return any(map(_differs, self._channels, last.values, row.values))


def _differs(channel: Channel, old: Value | None, new: Value | None) -> bool:
    return channel.differs(old, new)
