"""The time at the input of a job that sets a clock: as days and milliseconds, and as a CPU has it; by hand.

A DTL is year (2 bytes), month, day, weekday (Sunday is 1), hour, minute, second, nanosecond (4 bytes); a DATE_AND_TIME
year, month, day, hour, minute, second, milliseconds in decimal digits, the last one the weekday.
"""

from __future__ import annotations

import datetime as dt
from dataclasses import dataclass

from plcgen.ds47.plan.nouns import DriveJob

TIME = "utc"
FIRST, LAST = dt.date(2000, 1, 1), dt.date(2089, 12, 31)
DAY_MS = 86_400_000

Moment = tuple[dt.date, int]
"""A day, and milliseconds of it."""


@dataclass(frozen=True, slots=True)
class Times:
    """A scenario with this ``moment`` at the input, or bytes that are none; ``later`` comes after the first call."""

    moment: Moment | bytes | None = None
    later: Moment | bytes | None = None


def of(year: int, month: int, day: int, milliseconds: int = 0) -> Moment:
    """A moment."""
    return dt.date(year, month, day), milliseconds


def inputs(job: DriveJob) -> list[str]:
    """Names of the inputs with values."""
    return [*(use.member for use in job.inputs), *([TIME] if job.clock is not None else [])]


def values(moment: Moment) -> tuple[int, int]:
    """Days since 1970-01-01, milliseconds."""
    return (moment[0] - dt.date(1970, 1, 1)).days, moment[1]


def clock_bytes(job: DriveJob, days: int, milliseconds: int) -> bytes:
    """What stands at the input."""
    date = dt.date(1970, 1, 1) + dt.timedelta(days=days)
    seconds, rest = divmod(milliseconds, 1000)
    clock = seconds // 3600, seconds // 60 % 60, seconds % 60
    weekday = date.isoweekday() % 7 + 1
    if job.clock is not None and job.clock.name == "DTL":
        return bytes((*divmod(date.year, 256), date.month, date.day, weekday, *clock)) + (rest * 1_000_000).to_bytes(4)
    digits = (
        f"{date.year % 100:02}{date.month:02}{date.day:02}{clock[0]:02}{clock[1]:02}{clock[2]:02}{rest:03}{weekday}"
    )
    return bytes.fromhex(digits)
