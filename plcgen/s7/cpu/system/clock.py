"""The clock of the CPU: virtual time, TIME_TCK, the date, and the start information of organization blocks."""

from __future__ import annotations

import datetime as dt

from plcgen.s7.cpu.memory import Memory
from plcgen.s7.cpu.system import moments
from plcgen.s7.types import durations

START_TIME = dt.datetime(2024, 1, 1)  # noqa: DTZ001 - the module time of a CPU has no zone
OUT_OF_RANGE = 0x8081 - 0x10000
"""RET_VAL of RD_SYS_T: a DTL does not hold the date."""

START_SIZE = 20
PRIORITIES = {1: 1, 100: 27, **{30 + number: 7 + number for number in range(9)}}
"""Priority classes of OBs of an S7-300/400 as they are set at first."""
_WARM, _CYCLE, _COLD = 0x01, 0x03, 0x04
"""OB1_SCAN_1: behind a warm restart, a cycle, a cold restart."""
_FREQUENCIES = {30: 5000, 31: 2000, 32: 1000, 33: 500, 34: 200, 35: 100, 36: 50, 37: 20, 38: 10}


class SystemClock:
    """In ``cell`` (generated code: ``T``) the ms since the CPU was switched on, and those at which TIME_TCK was 0.

    ``start_time`` is the date at 0.
    """

    def __init__(self, start_time: dt.datetime = START_TIME) -> None:
        self.cell = [0, 0]
        self.start_time = start_time
        self.local_offset = dt.timedelta()
        self.daylight_saving = False
        self.start_up = _COLD
        self.scan_info = _COLD
        self.cycles: tuple[int, int, int] = (0, 0, 0)

    def restart(self, *, cold: bool, keep_ticks: bool) -> None:
        """A warm or cold restart: TIME_TCK begins at 0 again (help of TIME_TCK), the next OB1 is the first."""
        if not keep_ticks:
            self.cell[1] = self.cell[0]
        self.scan_info = self.start_up = _COLD if cold else _WARM
        self.cycles = (0, 0, 0)

    def pass_time(self, milliseconds: int) -> None:
        """A scan begins: that of before took so long."""
        self.cell[0] += milliseconds
        _, least, most = self.cycles
        shortest = milliseconds if not least or milliseconds < least else least
        self.cycles = milliseconds, shortest, max(most, milliseconds)

    @property
    def now(self) -> dt.datetime:
        """Date and time of the CPU."""
        return self.start_time + dt.timedelta(milliseconds=self.cell[0])

    def read(self, types: tuple[str, ...]) -> tuple[int, moments.Moment]:
        """RD_SYS_T: RET_VAL, 8081h outside the years that the type holds, and the date."""
        since_1970 = (self.now - durations.EPOCH) // dt.timedelta(microseconds=1) * 1000
        fits, value = moments.from_ns(since_1970, types[0])
        return 0 if fits else OUT_OF_RANGE, value

    def read_local(self, types: tuple[str, ...]) -> tuple[int, moments.Moment]:
        """RD_LOC_T: ``local_offset`` is that of the configuration, 0001h says daylight saving time."""
        moment = self.now + self.local_offset
        since_1970 = (moment - durations.EPOCH) // dt.timedelta(microseconds=1) * 1000
        fits, value = moments.from_ns(since_1970, types[0])
        return int(self.daylight_saving) if fits else OUT_OF_RANGE, value

    def set(self, types: tuple[str, ...], value: moments.Moment) -> int:
        """WR_SYS_T: RET_VAL; the date is that of now."""
        moment = durations.EPOCH + dt.timedelta(microseconds=moments.to_ns(value, types[0]) // 1000)
        self.start_time = moment - dt.timedelta(milliseconds=self.cell[0])
        return 0

    def set_local(self, types: tuple[str, ...], value: moments.Moment, _saving: object) -> int:
        """WR_LOC_T."""
        self.set(types, value)
        self.start_time -= self.local_offset
        return 0

    def runtime(self, before: float) -> tuple[float, float]:
        """RUNTIME: seconds since the call before; time passes between scans only."""
        now = self.cell[0] / 1000
        return (now - before if before else 0.0), now

    def start_information(self, local: Memory, number: int) -> None:
        """Put the 20 bytes that an OB of an S7-300/400 finds at the start of its local data, as far as it has room.

        OB1, OB30 to OB38 and OB100 as in System and Standard Functions for S7-300/400, chapter 1; of others number and
        date only.
        """
        head, rest = bytes((0x11, 0)), bytes(6)
        if number == 1:
            head = bytes((0x11, self.scan_info))
            rest = b"".join(min(time, 0x7FFF).to_bytes(2) for time in self.cycles)
            self.scan_info = _CYCLE
        elif number in _FREQUENCIES:
            head = bytes((0x11, 0x31 + number - 30))
            rest = bytes(4) + _FREQUENCIES[number].to_bytes(2)
        elif number == 100:
            head = bytes((0x13, 0x85 if self.start_up == _COLD else 0x81))
        try:
            date = durations.pack_dt(self.now)
        except (ValueError, OverflowError):
            date = bytes(8)
        data = head + bytes((PRIORITIES.get(number, 0), min(number, 255), 0, 0)) + rest + date
        size = min(START_SIZE, len(local))
        local[:size] = data[:size]
