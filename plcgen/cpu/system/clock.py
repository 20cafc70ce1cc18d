"""The clock of the CPU: virtual time, TIME_TCK and the date that RD_SYS_T reads."""

from __future__ import annotations

import datetime as dt
import struct

from plcgen.cpu.memory import Reference

DTL_SIZE = 12
START_TIME = dt.datetime(2024, 1, 1)  # noqa: DTZ001 - the module time of a CPU has no zone
FIRST, LAST = 1970, 2262
"""Years that a DTL holds (help of RD_SYS_T)."""
OUT_OF_RANGE = 0x8081 - 0x10000


class SystemClock:
    """In ``cell`` (generated code: ``T``) the ms since the CPU was switched on, and those at which TIME_TCK was 0.

    ``start_time`` is the date at 0.
    """

    def __init__(self, start_time: dt.datetime = START_TIME) -> None:
        self.cell = [0, 0]
        self.start_time = start_time

    def restart(self) -> None:
        """A warm or cold restart: TIME_TCK begins at 0 again (help of TIME_TCK)."""
        self.cell[1] = self.cell[0]

    @property
    def now(self) -> dt.datetime:
        """Date and time of the CPU."""
        return self.start_time + dt.timedelta(milliseconds=self.cell[0])

    def read_dtl(self, target: Reference) -> int:
        """RD_SYS_T with a DTL: year, month, day, weekday (Sunday is 1), hour, minute, second, nanosecond."""
        try:
            now = self.now
        except OverflowError:
            return OUT_OF_RANGE
        memory, offset, _ = target
        if not FIRST <= now.year <= LAST or memory is None:
            return OUT_OF_RANGE
        day = (now.year, now.month, now.day, now.isoweekday() % 7 + 1)
        time = (now.hour, now.minute, now.second, now.microsecond * 1000)
        memory[offset : offset + DTL_SIZE] = struct.pack(">HBBBBBBI", *day, *time)
        return 0
