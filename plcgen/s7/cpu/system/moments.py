"""Dates, times of day and durations: all of them as nanoseconds, since 1970 where there is a date.

Values are those of generated code: DATE_AND_TIME and DTL are bytes, the rest integers in the unit of the type.
"""

from __future__ import annotations

import datetime as dt

from plcgen.s7.types import durations
from plcgen.s7.types.durations import NS_PER_DAY, NS_PER_MS

Moment = int | bytes

_DAYS_TO_1990 = 7305
_UNITS = {"TIME": NS_PER_MS, "TIME_OF_DAY": NS_PER_MS, "DATE": NS_PER_DAY}
"""Nanoseconds that count 1; 1 for the rest."""
_BITS = {"TIME": 32, "LTIME": 64, "LDT": 64}
_DAYS = frozenset({"DATE", "DATE_AND_TIME", "DTL", "LDT"})
_CLOCKS = frozenset({"TIME_OF_DAY", "LTIME_OF_DAY"})
_LATEST = (1 << 63) - 1
"""LDT and DTL end on 2262-04-11 at 23:47:16.854775807 (help of RD_SYS_T)."""
_LAST_DATE = 65_535
SUMS = {
    ("TIME", "TIME"): "TIME", ("TIME", "LTIME"): "LTIME", ("LTIME", "TIME"): "LTIME", ("LTIME", "LTIME"): "LTIME",
    **{(clock, span): clock for clock in (*_CLOCKS, "DATE_AND_TIME", "LDT", "DTL") for span in ("TIME", "LTIME")},
}  # fmt: skip
"""Types of what T_ADD and T_SUB take, and of what comes out."""
DIFFERENCES = {
    "DTL": "TIME", "DATE": "TIME", "DATE_AND_TIME": "TIME", "TIME_OF_DAY": "TIME", "LTIME_OF_DAY": "LTIME",
    "LDT": "LTIME",
}  # fmt: skip


def to_ns(value: Moment, type_: str) -> int:
    """Nanoseconds; what is no date counts as 1970-01-01 or 1990-01-01, where its type begins."""
    if isinstance(value, bytes):
        try:
            if type_ == "DTL":
                return durations.unpack_dtl(value)
            moment = durations.unpack_dt(value)
        except ValueError:
            return 0 if type_ == "DTL" else _DAYS_TO_1990 * NS_PER_DAY
        return durations.since_epoch(moment.date(), 0) + (
            ((moment.hour * 60 + moment.minute) * 60 + moment.second) * 10**9 + moment.microsecond * 1000
        )
    return value * _UNITS.get(type_, 1) + (_DAYS_TO_1990 * NS_PER_DAY if type_ == "DATE" else 0)


def from_ns(nanoseconds: int, type_: str) -> tuple[bool, Moment]:
    """Whether a type holds so many nanoseconds, and its value: nearest, or of a time of day the rest of a day."""
    if type_ in _CLOCKS:
        return 0 <= nanoseconds < NS_PER_DAY, nanoseconds % NS_PER_DAY // _UNITS.get(type_, 1)
    if type_ in {"TIME", "LTIME"}:
        half = 1 << _BITS[type_] - 1
        count = nanoseconds // _UNITS.get(type_, 1)
        return -half <= count < half, min(max(count, -half), half - 1)
    first = _DAYS_TO_1990 * NS_PER_DAY if type_ in {"DATE", "DATE_AND_TIME"} else 0
    last = _LATEST if type_ in {"LDT", "DTL"} else (_DAYS_TO_1990 + _LAST_DATE + 1) * NS_PER_DAY - 1
    if type_ == "DATE_AND_TIME":
        last = durations.since_epoch(dt.date(2090, 1, 1), 0) - 1
    near = min(max(nanoseconds, first), last)
    if type_ == "DTL":
        return near == nanoseconds, durations.pack_dtl(near)
    if type_ == "DATE_AND_TIME":
        moment = durations.EPOCH + dt.timedelta(milliseconds=near // NS_PER_MS)
        return near == nanoseconds, durations.pack_dt(moment)
    if type_ == "DATE":
        return near == nanoseconds, near // NS_PER_DAY - _DAYS_TO_1990
    return near == nanoseconds, near


def add(types: tuple[str, ...], left: Moment, right: Moment) -> tuple[bool, Moment]:
    """T_ADD of two types; the last of ``types`` is that of the result."""
    return from_ns(to_ns(left, types[0]) + to_ns(right, types[1]), types[-1])


def subtract(types: tuple[str, ...], left: Moment, right: Moment) -> tuple[bool, Moment]:
    """T_SUB."""
    return from_ns(to_ns(left, types[0]) - to_ns(right, types[1]), types[-1])


def difference(types: tuple[str, ...], left: Moment, right: Moment) -> tuple[bool, Moment]:
    """T_DIFF: 0 if the result does not fit (help of T_DIFF, DTL: at most 24 days); days as INT."""
    span = to_ns(left, types[0]) - to_ns(right, types[1])
    if types[-1] == "INT":
        days = span // NS_PER_DAY
        return (True, days) if -32768 <= days <= 32767 else (False, 0)
    fits, value = from_ns(span, types[-1])
    return fits, value if fits else 0


def combine(types: tuple[str, ...], date: Moment, clock: Moment) -> tuple[bool, Moment]:
    """T_COMBINE: a day and the time of it."""
    return from_ns(to_ns(date, types[0]) + to_ns(clock, types[1]), types[-1])


def convert(value: Moment, source: str, target: str) -> Moment:
    """Explicit conversion of dates and times: the parts that the target has no room for are left out."""
    nanoseconds = to_ns(value, source)
    if source in _DAYS and target in _CLOCKS:
        nanoseconds %= NS_PER_DAY
    return from_ns(nanoseconds, target)[1]


def weekday(value: Moment, type_: str) -> int:
    """1 is Sunday (DT_DAY of S7-300/400)."""
    return (to_ns(value, type_) // NS_PER_DAY + 4) % 7 + 1
