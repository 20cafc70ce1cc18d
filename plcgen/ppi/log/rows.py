"""A row of a log: when, how it is about the stations, and a value for each channel."""

from __future__ import annotations

import enum
from dataclasses import dataclass
from datetime import datetime, tzinfo
from typing import TYPE_CHECKING

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.ppi.client.places import Place

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from plcgen.ppi.client.values import Value

FIXED = ("time", "state", "since", "note")
"""Columns in front of those of the channels."""


class State(enum.StrEnum):
    """What a row is about; in front of START and behind STOP nothing was logged."""

    START = "start"
    GOOD = "good"
    BAD = "bad"
    LOST = "lost"
    STOP = "stop"


@dataclass(frozen=True, slots=True)
class Channel:
    """One value that is kept: its station, its column, and by how much a number must change to count."""

    station: int
    place: Place
    name: str
    deadband: float = 0.0

    def differs(self, old: Value | None, new: Value | None) -> bool:
        """Whether the value has changed so much that it counts; any number counts against none, or one that is NaN."""
        if isinstance(old, tuple) and isinstance(new, tuple):
            return any(self.differs(one, other) for one, other in zip(old, new, strict=True))
        if isinstance(old, bool) or not isinstance(old, int | float) or not isinstance(new, int | float):
            return old != new
        if old != old or new != new:  # noqa: PLR0124 - NaN
            return (old == old) != (new == new)  # noqa: PLR0124 - NaN
        return abs(new - old) > self.deadband if self.deadband else new != old


@dataclass(frozen=True, slots=True)
class Row:
    """One line of the log. ``time`` and ``since`` are seconds since 1970; a channel that could not be read has None."""

    time: float
    state: State
    values: Sequence[Value | None] = ()
    since: float | None = None
    note: str = ""


def iso(seconds: float, zone: tzinfo | None = None) -> str:
    """ISO 8601 with milliseconds and offset from UTC: ``2026-11-27T09:56:39.123+01:00``; the local zone by default."""
    return datetime.fromtimestamp(seconds, zone).astimezone(zone).isoformat(timespec="milliseconds")


def require_columns(channels: Iterable[Channel], place: str) -> None:
    """Raise DiagnosticError if two columns would have one name; letter case does not tell them apart."""
    seen = set(FIXED)
    found = []
    for channel in channels:
        name = channel.name.casefold()
        if name in seen:
            message = f'two columns would be called "{channel.name}"'
            help_ = f"name each value once; {channel.station}:{channel.name} is another name of it"
            found.append(Diagnostic("PG725", message, Span(place), help=help_))
        seen.add(name)
    if found:
        raise DiagnosticError(found)
