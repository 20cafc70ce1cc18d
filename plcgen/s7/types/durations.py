"""Time literals: ``T#10s_500ms``, ``S5T#..``, ``TOD#..``, ``D#..``, ``DT#..``, their values and spellings.

Durations and times of day are integers in milliseconds (nanoseconds for the L.. types); dates are
``datetime.date`` and ``datetime.datetime``. Every function raises ValueError with a reason.
"""

from __future__ import annotations

import datetime as dt
import re
from decimal import Decimal

from plcgen.s7.types.data_types import UnfitValueError

_UNITS = {"D": 86_400_000_000_000, "H": 3_600_000_000_000, "M": 60_000_000_000, "S": 1_000_000_000}
_UNITS |= {"MS": 1_000_000, "US": 1_000, "NS": 1}
_CEILING = {"H": 24, "M": 60, "S": 60, "MS": 1000, "US": 1000, "NS": 1000}
_PART = re.compile(r"_?(\d[\d_]*(?:\.\d+)?)(MS|US|NS|D|H|M|S)", re.IGNORECASE | re.ASCII)
_DATE = re.compile(r"(\d{4}|\d{2})-(\d{1,2})-(\d{1,2})", re.ASCII)
_CLOCK = re.compile(r"(\d{1,2}):(\d{1,2}):(\d{1,2})(?:\.(\d{1,9}))?", re.ASCII)
NS_PER_MS = 1_000_000
NS_PER_DAY = _UNITS["D"]
EPOCH = dt.datetime(1970, 1, 1)  # noqa: DTZ001 - PLC clocks carry no time zone
DAY_ZERO = dt.date(1990, 1, 1)


def parse_duration(text: str) -> int:
    """Nanoseconds of ``10s_500ms``, ``-1d2h``, ``1.5s``; units descend, only the first may overflow."""
    sign, rest = (-1, text[1:]) if text.startswith("-") else (1, text.removeprefix("+"))
    total, position, last = 0, 0, ""
    order = list(_UNITS)
    while match := _PART.match(rest, position):
        number, unit = Decimal(match[1].replace("_", "")), match[2].upper()
        if last and order.index(unit) <= order.index(last):
            raise UnfitValueError(f"{unit.lower()} after {last.lower()}: units go from large to small")
        if last and number >= _CEILING[unit]:
            raise UnfitValueError(f"{number}{unit.lower()}: only the first unit may exceed its range")
        if "." in match[1] and match.end() != len(rest):
            raise UnfitValueError("only the last unit may have decimals")
        total += int(number * _UNITS[unit])
        position, last = match.end(), unit
    if not last or position != len(rest):
        raise UnfitValueError("a duration looks like 1d_2h_3m_4s_5ms")
    return sign * total


def format_duration(nanoseconds: int) -> str:
    """``10s_500ms``: the units that are not zero, or ``0ms``."""
    sign, rest = ("-", -nanoseconds) if nanoseconds < 0 else ("", nanoseconds)
    parts: list[str] = []
    for unit, size in _UNITS.items():
        count, rest = divmod(rest, size)
        if count:
            parts.append(f"{count}{unit.lower()}")
    return sign + "_".join(parts or ["0ms"])


def parse_date(text: str) -> dt.date:
    """``2026-11-21``, or with a two-digit year: 90..99 are 19xx, 00..89 are 20xx."""
    match = _DATE.fullmatch(text)
    if match is None:
        raise UnfitValueError("a date looks like 2026-11-21")
    year = int(match[1])
    if len(match[1]) == 2:
        year += 1900 if year >= 90 else 2000
    return dt.date(year, int(match[2]), int(match[3]))


def parse_clock(text: str, digits: int) -> int:
    """Nanoseconds since midnight of ``12:30:15.250`` with at most ``digits`` decimals."""
    match = _CLOCK.fullmatch(text)
    if match is None:
        raise UnfitValueError("a time of day looks like 12:30:15.250")
    hour, minute, second = (int(match[i]) for i in (1, 2, 3))
    if hour > 23 or minute > 59 or second > 59:
        raise UnfitValueError("no such time of day")
    fraction = match[4] or ""
    if len(fraction.rstrip("0")) > digits:
        raise UnfitValueError(f"at most {digits} decimals")
    seconds = hour * 3600 + minute * 60 + second
    return seconds * _UNITS["S"] + int(fraction.ljust(9, "0") or 0)


def format_clock(nanoseconds: int, digits: int) -> str:
    """``12:30:15.250``; the decimals are left out when they are all zero."""
    seconds, fraction = divmod(nanoseconds, _UNITS["S"])
    shown = f"{seconds // 3600:02d}:{seconds // 60 % 60:02d}:{seconds % 60:02d}"
    return f"{shown}.{fraction:09d}"[: 9 + digits] if fraction else shown


def parse_moment(text: str, digits: int) -> tuple[dt.date, int]:
    """Date and nanoseconds since midnight of ``2026-11-21-12:30:15.250``."""
    date, _, clock = text.rpartition("-")
    return parse_date(date), parse_clock(clock, digits)


def to_s5time(milliseconds: int) -> int:
    """S5TIME word: the finest base that holds the value, three BCD digits; finer rest is cut off."""
    for code, base in enumerate((10, 100, 1000, 10_000)):
        count = milliseconds // base
        if count <= 999:
            return code << 12 | to_bcd(count)
    raise UnfitValueError("S5TIME ends at 2h_46m_30s")


def from_s5time(word: int) -> int:
    """Milliseconds of an S5TIME word."""
    return from_bcd(word & 0xFFF) * (10, 100, 1000, 10_000)[word >> 12 & 3]


def to_bcd(value: int) -> int:
    """Decimal digits as hexadecimal digits: 127 -> 16#127."""
    return int(str(value), 16)


def from_bcd(value: int) -> int:
    """Hexadecimal digits read as decimal digits; raises ValueError for digits A..F."""
    return int(f"{value:x}", 10)


def pack_dt(value: dt.datetime) -> bytes:
    """DATE_AND_TIME: 8 bytes BCD, year 1990..2089, milliseconds, weekday 1 = Sunday."""
    if not 1990 <= value.year <= 2089:
        raise UnfitValueError("DATE_AND_TIME runs from 1990 to 2089")
    fields = (value.year % 100, value.month, value.day, value.hour, value.minute, value.second)
    milliseconds = value.microsecond // 1000
    weekday = value.isoweekday() % 7 + 1
    tail = (to_bcd(milliseconds // 10), to_bcd(milliseconds % 10) << 4 | weekday)
    return bytes((*map(to_bcd, fields), *tail))


def unpack_dt(data: bytes) -> dt.datetime:
    """Inverse of :func:`pack_dt`; the weekday is not checked."""
    year, month, day, hour, minute, second, centi = (from_bcd(byte) for byte in data[:7])
    year += 1900 if year >= 90 else 2000
    micro = (centi * 10 + from_bcd(data[7] >> 4)) * 1000
    return dt.datetime(year, month, day, hour, minute, second, micro)  # noqa: DTZ001 - no time zone in a PLC


def pack_dtl(nanoseconds: int) -> bytes:
    """DTL of nanoseconds since 1970: year u16, month, day, weekday (1 = Sunday), h, m, s, nanosecond u32."""
    days, rest = divmod(nanoseconds, NS_PER_DAY)
    date = EPOCH.date() + dt.timedelta(days=days)
    if not 1970 <= date.year <= 2262:
        raise UnfitValueError("DTL runs from 1970 to 2262")
    seconds, fraction = divmod(rest, _UNITS["S"])
    clock = (seconds // 3600, seconds // 60 % 60, seconds % 60)
    head = date.year.to_bytes(2) + bytes((date.month, date.day, date.isoweekday() % 7 + 1, *clock))
    return head + fraction.to_bytes(4)


def unpack_dtl(data: bytes) -> int:
    """Inverse of :func:`pack_dtl`; the weekday is not checked."""
    date = dt.date(int.from_bytes(data[:2]), data[2], data[3])
    seconds = data[5] * 3600 + data[6] * 60 + data[7]
    return since_epoch(date, seconds * _UNITS["S"] + int.from_bytes(data[8:12]))


def since_epoch(date: dt.date, nanoseconds: int) -> int:
    """Nanoseconds since 1970-01-01."""
    return (date - EPOCH.date()).days * NS_PER_DAY + nanoseconds


def format_moment(nanoseconds: int, digits: int) -> str:
    """``2026-11-21-12:30:15.25`` of nanoseconds since 1970."""
    days, rest = divmod(nanoseconds, NS_PER_DAY)
    date = EPOCH.date() + dt.timedelta(days=days)
    return f"{date.isoformat()}-{format_clock(rest, digits)}"


def spelled(milliseconds: int) -> str:
    """A duration as messages write it."""
    seconds, rest = divmod(milliseconds, 1000)
    return f"{milliseconds} ms" if rest else f"{seconds} s"
