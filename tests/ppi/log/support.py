"""A logger on a simulated bus in virtual time: a line that can be unplugged, and nobody sleeps."""

import csv
from datetime import UTC

from plcgen.base.line.endpoint import Clock as Virtual
from plcgen.base.line.endpoint import EndpointLine
from plcgen.base.line.model import LineError, LineLostError
from plcgen.ppi.client import Client, Settings
from plcgen.ppi.client.values import parse_place
from plcgen.ppi.log.files import Channel, Keeper, iso, opener
from plcgen.ppi.log.logger import Logger, Pace, Stations
from plcgen.ppi.sim import Bus, Station

MIDNIGHT = 1_795_651_200.0
"""2026-11-26T00:00:00Z: (2026 - 1970) * 365 days + 14 leap days + 329 days = 20783 days of 86400 s."""


class Day:
    """Clock, bus and line; ``down`` are the seconds in which the line is unplugged."""

    def __init__(self, *stations, faults=(), down=()):
        self.virtual = Virtual()
        self.bus = Bus(list(stations) or [Station(values={"VW100": 7})], faults=list(faults))
        self.down = down
        self.told = []
        self.jump = 0.0

    def today(self):
        """Seconds since 1970."""
        return MIDNIGHT + self.now() + self.jump

    def now(self):
        """Seconds since the beginning."""
        return self.virtual.now / 1000

    def sleep(self, seconds):
        """Let time pass, without a sleep."""
        self.virtual.advance(max(1, round(seconds * 1000)))

    def unplugged(self):
        """Whether the line is down."""
        return any(begin <= self.now() < end for begin, end in self.down)

    def connect(self, numbers):
        """Open the line."""
        if self.unplugged():
            raise LineError("PG720", "bus", "there is no such port")
        line = _Line(self)
        return {number: Client(line, Settings(station=number), now=self.now) for number in numbers}

    def logger(self, path, *words, pace=None, rotation=None, most=100_000, deadband=0.0):
        """A logger of ``3:VW100`` or ``VW100`` (station 2) into a file, and its keeper."""
        pairs = [word.split(":", 1) if word[0].isdigit() else ("2", word) for word in words or ("VW100",)]
        channels = [
            Channel(int(number), parse_place(text), word, deadband)
            for (number, text), word in zip(pairs, words or ("VW100",), strict=True)
        ]
        keeper = Keeper(
            path, opener(path, channels, UTC), lambda time: iso(time, UTC), self.told.append, rotation, most
        )
        stations = Stations(self.connect, channels, self.now)
        return Logger(channels, stations, keeper, pace or Pace(), self, self.told.append), keeper


class _Line(EndpointLine):
    """Lost as soon as it is used while unplugged."""

    def __init__(self, day):
        super().__init__(day.bus, day.virtual, "bus")
        self.day = day

    def _check(self):
        super()._check()
        if self.day.unplugged():
            raise LineLostError(self.name)


def rows_of(path):
    """Rows of a CSV log as dictionaries."""
    with path.open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


def iso_at(seconds):
    """ISO time of a second of the day, by hand."""
    whole, rest = divmod(round(seconds * 1000), 1000)
    return f"2026-11-26T{whole // 3600:02}:{whole // 60 % 60:02}:{whole % 60:02}.{rest:03}+00:00"
