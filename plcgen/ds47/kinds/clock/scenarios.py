"""Scenarios of a job that sets a clock: days around every month and leap day, what is no time, a time that goes on."""

from __future__ import annotations

import datetime as dt
from collections.abc import Iterator

from plcgen.ds47.plan.nouns import DriveJob
from plcgen.ds47.proof.clock_input import DAY_MS, FIRST, LAST, Moment, Times, clock_bytes, of, values
from plcgen.ds47.proof.scenario import DriveScenario, KindScenarios
from plcgen.ds47.proof.words import WORDS

OCCUPIED_MS = 200
BEHIND = dt.timedelta(days=1)
COMMON, LEAP = 2001, 2024
"""A year with and one without a February 29."""


def clocking(job: DriveJob, _: int) -> Iterator[DriveScenario]:
    """All of them."""
    for moment in _moments():
        yield DriveScenario(name=f"it is {moment[0]}, {moment[1]} ms", parts=(Times(moment=moment),), follow=False)
    for name, data in _no_times(job):
        yield DriveScenario(
            name=f"{name}: {data.hex(' ').upper()}",
            parts=(Times(moment=data),),
            status=(WORDS["NO_TIME"],),
            checked=False,
            follow=False,
        )
    soon, late = of(2026, 11, 23, 1), of(2026, 11, 24)
    yield DriveScenario(
        name="the time goes on while another job has the unit",
        occupied=OCCUPIED_MS,
        parts=(Times(moment=soon, later=late),),
    )
    nothing = bytes(len(clock_bytes(job, *values(soon))))
    yield DriveScenario(
        name="there is no time any more while another job has the unit",
        occupied=OCCUPIED_MS,
        parts=(Times(moment=soon, later=nothing),),
    )
    yield DriveScenario(
        name="there is a time only after the edge",
        parts=(Times(moment=nothing, later=late),),  status=(WORDS["NO_TIME"],), checked=False,
    )  # fmt: skip


def _moments() -> Iterator[Moment]:
    """First and last days of the months, with both kinds of February; units of the time one by one."""
    for year in (COMMON, LEAP):
        for month in range(1, 13):
            first = dt.date(year, month, 1)
            yield from ((first, 0), (first - BEHIND, DAY_MS - 1))
    for year in (FIRST.year, 2003, 2004, 2088):
        yield from (of(year, 3, 1), (dt.date(year, 3, 1) - BEHIND, 0))
    yield from ((FIRST, 0), (LAST, DAY_MS - 1))
    for milliseconds in (1, 10, 100, 999, 1_000, 59_999, 60_000, 3_599_999, 3_600_000, 82_800_000):
        yield of(2026, 11, 23, milliseconds)


def _no_times(job: DriveJob) -> Iterator[tuple[str, bytes]]:
    """Each part of a time beside what it may be, all others right."""
    right = clock_bytes(job, *values(of(COMMON, 6, 15, 45_296_789)))
    dtl = job.clock is not None and job.clock.name == "DTL"
    parts = {"month": 2, "day": 3, "hour": 5, "minute": 6, "second": 7} if dtl else _CLASSIC
    wrong = {"month": (0, 13), "day": (0, 31), "hour": (24,), "minute": (60,), "second": (60,)}
    for name, numbers in wrong.items():
        for number in numbers:
            at = parts[name]
            yield f"{name} {number}", right[:at] + bytes((number if dtl else int(str(number), 16),)) + right[at + 1 :]
    last = {1: 32, 2: 29, 3: 32, 4: 31, 5: 32, 7: 32, 8: 32, 9: 31, 10: 32, 11: 31, 12: 32}
    for month, day in last.items():
        yield f"{COMMON}-{month:02}-{day}", _dated(job, right, month, day)
    leap = clock_bytes(job, *values(of(LEAP, 2, 28)))
    yield f"{LEAP}-02-30", _dated(job, leap, 2, 30)
    if dtl:
        for year in (1999, 2090):
            yield f"year {year}", year.to_bytes(2) + right[2:]
        yield "1,000,000,000 ns", right[:8] + (1_000_000_000).to_bytes(4)
        return
    for year in (0x90, 0x99):
        yield f"year 19{year:02X}", bytes((year,)) + right[1:]
    for at in range(8):
        yield f"digit Ah in byte {at}", right[:at] + bytes((right[at] & 0xF0 | 0x0A,)) + right[at + 1 :]
    for at in (6, 7):
        yield f"digit Ah in front in byte {at}", right[:at] + bytes((right[at] & 0x0F | 0xA0,)) + right[at + 1 :]


_CLASSIC = {"month": 1, "day": 2, "hour": 3, "minute": 4, "second": 5}


def _dated(job: DriveJob, data: bytes, month: int, day: int) -> bytes:
    """Another month and day of the same year."""
    if job.clock is not None and job.clock.name == "DTL":
        return data[:2] + bytes((month, day)) + data[4:]
    return data[:1] + bytes.fromhex(f"{month:02}{day:02}") + data[3:]


SCENARIOS = (KindScenarios(60, lambda job: job.clock is not None, clocking),)
