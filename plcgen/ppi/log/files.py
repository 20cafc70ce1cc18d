"""Log files and their rows: CSV, JSON lines, SQLite. What a killed process left is repaired, nothing else touched.

Rows are on the disk (``fsync``, or a committed transaction) when ``append`` returns, or not at all: what a full disk
took of them is cut off again.

A full disk loses nothing as long as the memory for waiting rows lasts; then the oldest give way, and one row says how
many and of which time.
"""

from __future__ import annotations

import csv
import enum
import errno
import io
import json
import math
import os
import re
import sqlite3
import stat
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import datetime, tzinfo
from functools import partial
from itertools import groupby, islice
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Protocol

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.base.diagnostics.counting import quantity
from plcgen.base.display.cells import clean
from plcgen.base.replacing import place
from plcgen.ppi.client.texts import plain
from plcgen.ppi.client.values import Place, Value, text_of

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


_MOST_LINE = 1024 * 1024
"""Longest line of ours in bytes; a torn one is not looked for further from the end."""
TORN = "a torn row of the run before was cut off"


class LogFile(Protocol):
    """An open log. ``first`` is the time of its first row, empty if there is none; ``repaired`` what was torn."""

    first: str
    repaired: str

    @property
    def size(self) -> int:
        """Bytes on the disk."""

    def append(self, rows: Sequence[Row]) -> None:
        """Write rows. Raises OSError; then none of them is there."""

    def close(self) -> None:
        """Close it."""


def opener(path: Path, channels: Sequence[Channel], zone: tzinfo | None = None) -> Callable[[Path], LogFile]:
    """What opens logs of the kind that the suffix names. Raises DiagnosticError (PG725) for another suffix."""
    names = [clean(channel.name) for channel in channels]
    suffix = path.suffix.lower()
    if suffix == ".csv":
        return partial(TextLog, _Csv(names, zone))
    if suffix in {".jsonl", ".ndjson"}:
        return partial(TextLog, _JsonLines(names, zone))
    if suffix in {".sqlite", ".sqlite3", ".db"}:
        return partial(SqliteLog, names, zone)
    help_ = ".csv, .jsonl (a JSON object per line) or .sqlite"
    raise DiagnosticError([Diagnostic("PG725", f'a log has no kind "{path.suffix}"', Span(str(path)), help=help_)])


def _other(path: Path, what: str) -> DiagnosticError:
    message = f"the file exists and {what}: nothing is appended to it"
    return DiagnosticError(
        [Diagnostic("PG725", message, Span(str(path)), help="log to another file, or move this one")]
    )


class _Csv:
    """Comma-separated values with a header; a text is in single quotes, so no program takes it for a formula."""

    def __init__(self, names: Sequence[str], zone: tzinfo | None) -> None:
        self._zone = zone
        safe = [f"'{name}" if name[:1] in "=+-@" else name for name in names]
        self._width = len(names)
        self.header = self._line([*FIXED, *safe])

    def line(self, row: Row) -> bytes:
        since = "" if row.since is None else iso(row.since, self._zone)
        cells = ["" if value is None else clean(text_of(value)) for value in row.values] or [""] * self._width
        return self._line([iso(row.time, self._zone), row.state.value, since, row.note, *cells])

    @staticmethod
    def _line(cells: Sequence[str]) -> bytes:
        stream = io.StringIO()
        csv.writer(stream, lineterminator="\n").writerow(cells)
        return stream.getvalue().encode()

    @staticmethod
    def time_of(line: bytes) -> str | None:
        """Time of a row in a file with the right header."""
        return line.partition(b",")[0].decode("ascii", "replace")


class _JsonLines:
    """A JSON object per row; no header, so the keys of the first row are what tells ours."""

    header = b""

    def __init__(self, names: Sequence[str], zone: tzinfo | None) -> None:
        self._names, self._zone = tuple(names), zone

    def line(self, row: Row) -> bytes:
        since = None if row.since is None else iso(row.since, self._zone)
        values = {name: plain(value) for name, value in zip(self._names, row.values, strict=False)}
        values = values or dict.fromkeys(self._names)
        head = dict(zip(FIXED, (iso(row.time, self._zone), row.state.value, since, row.note), strict=True))
        return json.dumps({**head, "values": values}, ensure_ascii=False, allow_nan=False).encode() + b"\n"

    def time_of(self, line: bytes) -> str | None:
        """Time of a row, None if it is none of ours."""
        try:
            found = json.loads(line)
        except (ValueError, RecursionError):
            return None
        if not isinstance(found, dict) or tuple(found) != (*FIXED, "values") or not isinstance(found["values"], dict):
            return None
        return found["time"] if tuple(found["values"]) == self._names and isinstance(found["time"], str) else None


class TextLog:
    """A text file with a line per row. Raises OSError, DiagnosticError (PG725) if it is none of ours."""

    def __init__(self, format_: _Csv | _JsonLines, path: Path) -> None:
        self._format, self._path = format_, path
        self.first = self.repaired = ""
        self._descriptor = os.open(path, os.O_RDWR | os.O_CREAT | getattr(os, "O_BINARY", 0), 0o666)
        try:
            self.size = os.lseek(self._descriptor, 0, os.SEEK_END)
            self._examine()
        except BaseException:
            self.close()
            raise

    def _examine(self) -> None:
        """See that the file is ours, cut off a torn last line, and write the header that is missing."""
        if not stat.S_ISREG(os.fstat(self._descriptor).st_mode):
            raise _other(self._path, "is no file")
        header = self._format.header
        begin = self._read(0, len(header))
        if begin != header[: len(begin)]:
            raise _other(self._path, "has other columns")
        if len(begin) < len(header):
            self._cut(0)
            self._write(header)
            return
        line, end, _ = self._read(len(header), _MOST_LINE).partition(b"\n")
        if line and end:
            time = self._format.time_of(line)
            if time is None:
                raise _other(self._path, "has other columns")
            self.first = time
        elif line and not (header or line.startswith(b'{"time": "'[: len(line)])):
            raise _other(self._path, "is no log of plcgen")
        tail = self._read(max(len(header), self.size - _MOST_LINE), _MOST_LINE)
        torn = len(tail) - tail.rfind(b"\n") - 1
        if torn:
            self.repaired = TORN
            self._cut(self.size - torn)

    def _read(self, offset: int, size: int) -> bytes:
        os.lseek(self._descriptor, offset, os.SEEK_SET)
        found = b""
        while len(found) < size and (more := os.read(self._descriptor, size - len(found))):
            found += more
        return found

    def _cut(self, size: int) -> None:
        os.ftruncate(self._descriptor, size)
        self.size = size

    def _write(self, data: bytes) -> None:
        rest = memoryview(data)
        os.lseek(self._descriptor, self.size, os.SEEK_SET)
        try:
            while rest:
                rest = rest[os.write(self._descriptor, rest) :]
            os.fsync(self._descriptor)
        except OSError:
            os.ftruncate(self._descriptor, self.size)
            raise
        self.size += len(data)

    def append(self, rows: Sequence[Row]) -> None:
        """Write rows; all or none."""
        lines = [self._format.line(row) for row in rows]
        self._write(b"".join(lines))
        self.first = self.first or self._format.time_of(lines[0]) or ""

    def close(self) -> None:
        """Close the file; twice is harmless."""
        if self._descriptor >= 0:
            os.close(self._descriptor)
            self._descriptor = -1


class SqliteLog:
    """A table ``log`` with a column per channel. Raises OSError, DiagnosticError (PG725) if it is not ours."""

    repaired = ""
    """A killed process leaves a journal, with which SQLite takes back what was not committed."""

    def __init__(self, names: Sequence[str], zone: tzinfo | None, path: Path) -> None:
        self._path, self._zone, self._names = path, zone, tuple(names)
        if path.exists() and not path.is_file():
            raise _other(path, "is no file")
        try:
            self._base = sqlite3.connect(path, timeout=1.0, isolation_level=None)
        except sqlite3.Error as problem:
            raise _failed(problem, path) from problem
        try:
            self._examine()
        except sqlite3.Error as problem:
            self._base.close()
            if getattr(problem, "sqlite_errorname", "") in {"SQLITE_NOTADB", "SQLITE_CORRUPT"}:
                raise _other(path, "is no SQLite database") from problem
            raise _failed(problem, path) from problem
        except BaseException:
            self._base.close()
            raise

    def _examine(self) -> None:
        tables = [name for (name,) in self._base.execute("SELECT name FROM sqlite_master WHERE type = 'table' LIMIT 2")]
        if not tables:
            columns = ", ".join(f'"{name.replace(chr(34), chr(34) * 2)}"' for name in self._names)
            self._base.execute(f"CREATE TABLE log (time TEXT, state TEXT, since TEXT, note TEXT, {columns})")
        elif tables != ["log"] or self._columns() != (*FIXED, *self._names):
            raise _other(self._path, "has other tables or columns")
        row = self._base.execute("SELECT time FROM log ORDER BY rowid LIMIT 1").fetchone()
        self.first = str(row[0]) if row else ""

    def _columns(self) -> tuple[str, ...]:
        return tuple(row[1] for row in self._base.execute("PRAGMA table_info(log)"))

    @property
    def size(self) -> int:
        """Bytes on the disk."""
        return self._path.stat().st_size

    def append(self, rows: Sequence[Row]) -> None:
        """Write rows in one transaction."""
        marks = ", ".join("?" * (len(FIXED) + len(self._names)))
        found = [self._cells(row) for row in rows]
        try:
            self._base.execute("BEGIN IMMEDIATE")
            try:
                self._base.executemany(f"INSERT INTO log VALUES ({marks})", found)  # noqa: S608 - question marks only
                self._base.execute("COMMIT")
            except sqlite3.Error:
                if self._base.in_transaction:
                    self._base.execute("ROLLBACK")
                raise
        except sqlite3.Error as problem:
            raise _failed(problem, self._path) from problem
        self.first = self.first or str(found[0][0])

    def _cells(self, row: Row) -> tuple[Any, ...]:
        since = None if row.since is None else iso(row.since, self._zone)
        values = [_cell(value) for value in row.values] or [None] * len(self._names)
        return (iso(row.time, self._zone), row.state.value, since, row.note, *values)

    def close(self) -> None:
        """Close the database."""
        self._base.close()


def _failed(problem: sqlite3.Error, path: Path) -> OSError:
    return OSError(errno.EIO, str(problem), str(path))


def _cell(value: Value | None) -> Any:
    """A value as SQLite has it: numbers, and texts for the rest."""
    if isinstance(value, tuple) or (isinstance(value, float) and not math.isfinite(value)):
        return text_of(value)
    return clean(value) if isinstance(value, str) else value


def json_lines(channels: Sequence[Channel], rows: Sequence[Row]) -> str:
    """Rows as JSON lines: what is left if they cannot be written anywhere else."""
    format_ = _JsonLines([clean(channel.name) for channel in channels], None)
    return b"".join(map(format_.line, rows)).decode()


MOST_WAITING = 100_000
"""Rows that wait for room on the disk: more than a day at one per second."""
_AT_ONCE = 1000
_TRIES = 1000
_LENGTHS = {"hour": 13, "day": 10}
"""Characters of ISO time that tell one file from the next: ``2026-11-27T09``, ``2026-11-27``."""


@dataclass(frozen=True, slots=True)
class Rotation:
    """When a new file begins: with an hour or a day, or from ``size`` bytes on; ``keep`` old files stay, None: all."""

    period: Literal["", "hour", "day"] = ""
    size: int | None = None
    keep: int | None = None


class Keeper:
    """Writes rows to ``path``; ``open_`` opens a log file there, ``stamp`` writes times as its rows do."""

    def __init__(
        self,
        path: Path,
        open_: Callable[[Path], LogFile],
        stamp: Callable[[float], str],
        tell: Callable[[str], None],
        rotation: Rotation | None = None,
        most: int = MOST_WAITING,
    ) -> None:
        self._path, self._open, self._stamp, self._tell, self._most = path, open_, stamp, tell, most
        self._rotation = rotation or Rotation()
        self._waiting: deque[Row] = deque()
        self._lost = 0
        self._lost_from = self._lost_to = 0.0
        self._trouble = ""
        self._file: LogFile | None = open_(path)
        self.opening = self._file.repaired

    @property
    def waiting(self) -> tuple[Row, ...]:
        """Rows that are not on the disk, in order; in front the mark of those that gave way."""
        if not self._lost:
            return tuple(self._waiting)
        return (self._mark(), *self._waiting)

    def _mark(self) -> Row:
        text = f"no room on the disk: {quantity(self._lost, 'row')} lost up to {self._stamp(self._lost_to)}"
        return Row(self._lost_from, State.LOST, note=text)

    def add(self, row: Row) -> None:
        """Take a row and write whatever waits, as far as the disk takes it."""
        if len(self._waiting) >= self._most:
            gone = self._waiting.popleft()
            self._lost_from = self._lost_from if self._lost else gone.time
            self._lost, self._lost_to = self._lost + 1, gone.time
        self._waiting.append(row)
        self.flush()

    def flush(self) -> bool:
        """Write whatever waits; whether all of it is on the disk."""
        try:
            while self._waiting or self._lost:
                self._write()
        except OSError as problem:
            if not self._trouble:
                self._trouble = problem.strerror or str(problem)
                self._tell(f"cannot write {self._path}: {self._trouble}; rows are kept in memory")
            return False
        if self._trouble:
            self._trouble = ""
            self._tell(f"{self._path} is written again")
        return True

    def _write(self) -> None:
        """Write the mark of lost rows, or some rows that belong into one file."""
        if self._lost:
            rows = [self._mark()]
        else:
            _, same = next(groupby(islice(self._waiting, _AT_ONCE), key=self._period))
            rows = list(same)
        file = self._current(rows[0])
        file.append(rows)
        if self._lost:
            self._lost = 0
        else:
            for _ in rows:
                self._waiting.popleft()

    def _period(self, row: Row) -> str:
        length = _LENGTHS.get(self._rotation.period, 0)
        return self._stamp(row.time)[:length] if length else ""

    def _current(self, row: Row) -> LogFile:
        """The file into which a row belongs, a new one if its time has come."""
        if self._file is None:
            self._file = self._open(self._path)
        rotation, file = self._rotation, self._file
        full = rotation.size is not None and file.size >= rotation.size
        length = _LENGTHS.get(rotation.period, 0)
        if not file.first or not (full or file.first[:length] != self._period(row)):
            return file
        file.close()
        self._file = None
        stamp = re.sub(r"[^0-9T]", "", file.first[:19])
        # give the file the name of its first row's time, and remove the oldest ones if only some are to stay
        path = self._path
        for number in range(_TRIES):
            mark = f"-{number}" if number else ""
            try:
                place(path, path.with_name(f"{path.stem}.{stamp}{mark}{path.suffix}"))
                break
            except FileExistsError:
                continue
        else:
            raise FileExistsError(f"{path.stem}.{stamp}: all names are taken")
        if self._rotation.keep is not None:
            ours = re.compile(rf"{re.escape(path.stem)}\.\d{{8}}T\d{{6}}(-\d+)?{re.escape(path.suffix)}")
            old = sorted(each for each in path.parent.iterdir() if ours.fullmatch(each.name))
            for each in old[: max(0, len(old) - self._rotation.keep)]:
                each.unlink()
        self._file = self._open(self._path)
        return self._file

    def close(self) -> bool:
        """Write what waits and close the file; whether all of it is on the disk."""
        done = self.flush()
        if self._file is not None:
            self._file.close()
            self._file = None
        return done
