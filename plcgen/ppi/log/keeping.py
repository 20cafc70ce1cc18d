"""Rows wait in memory until the disk has them; a new file begins with a new hour or day, or when one is large enough.

A full disk loses nothing as long as the memory for waiting rows lasts; then the oldest give way, and one row says how
many and of which time.
"""

from __future__ import annotations

import re
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from itertools import groupby, islice
from pathlib import Path
from typing import Literal

from plcgen.base.diagnostics.counting import quantity
from plcgen.base.replacing import place
from plcgen.ppi.log.files import LogFile, Row, State

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
