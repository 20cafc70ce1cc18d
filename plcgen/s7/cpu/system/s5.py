"""S5 timers and counters of the CPU: cells by number.

Source: help of the TIA Portal, S_PULSE to S_OFFDT and S_CU to S_CUD of SCL.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from plcgen.s7.types import durations

_BASES = (10, 100, 1000, 10_000)


@dataclass(slots=True)
class Cell:
    """A timer or counter: ``value`` is the rest of the time in ms, or the count."""

    value: int = 0
    base: int = 0
    since: int = 0
    running: bool = False
    over: bool = False
    edges: list[bool] = field(default_factory=lambda: [False, False, False])

    def rises(self, input_: int, value: object) -> bool:
        """Whether an input is TRUE now and was not before."""
        before, self.edges[input_] = self.edges[input_], bool(value)
        return not before and bool(value)


class Cells:
    """Timers and counters; ``clock`` has the ms since the CPU was switched on."""

    def __init__(self, clock: list[int]) -> None:
        self.clock = clock
        self.timers: dict[int, Cell] = {}
        self.counters: dict[int, Cell] = {}

    def pulse(self, number: int, start: object, preset: int, reset: object) -> tuple[int, bool, int]:
        """S_PULSE: as long as S, at most the time."""
        cell = self._timed(number)
        self._start(cell, preset, when=cell.rises(0, start))
        cell.running = cell.running and bool(start)
        return self._result(cell, reset, cell.running)

    def extended(self, number: int, start: object, preset: int, reset: object) -> tuple[int, bool, int]:
        """S_PEXT: the time from the last rising edge of S."""
        cell = self._timed(number)
        self._start(cell, preset, when=cell.rises(0, start))
        return self._result(cell, reset, cell.running)

    def on_delay(self, number: int, start: object, preset: int, reset: object) -> tuple[int, bool, int]:
        """S_ODT: Q follows S after the time."""
        cell = self._timed(number)
        self._start(cell, preset, when=cell.rises(0, start))
        cell.running = cell.running and bool(start)
        cell.over = cell.over and bool(start)
        return self._result(cell, reset, cell.over)

    def retentive(self, number: int, start: object, preset: int, reset: object) -> tuple[int, bool, int]:
        """S_ODTS: Q after the time, whatever S does, until R."""
        cell = self._timed(number)
        if not reset:
            self._start(cell, preset, when=cell.rises(0, start))
        return self._result(cell, reset, cell.over)

    def off_delay(self, number: int, start: object, preset: int, reset: object) -> tuple[int, bool, int]:
        """S_OFFDT: Q with S, and for the time behind it."""
        cell = self._timed(number)
        fallen = cell.edges[0] and not start
        cell.edges[0] = bool(start)
        self._start(cell, preset, when=fallen and not reset)
        cell.running = cell.running and not start
        return self._result(cell, reset, bool(start) or cell.running)

    def _timed(self, number: int) -> Cell:
        """Cell of a timer, brought up to date."""
        cell = self.timers.setdefault(number, Cell())
        passed, cell.since = self.clock[0] - cell.since, self.clock[0]
        if cell.running:
            cell.value = max(cell.value - passed, 0)
            cell.over = cell.value == 0
            cell.running = not cell.over
        return cell

    @staticmethod
    def _start(cell: Cell, preset: int, *, when: bool) -> None:
        if when:
            cell.base = preset >> 12 & 3
            try:
                cell.value = durations.from_s5time(preset)
            except ValueError:
                cell.value = 0
            cell.running, cell.over = cell.value > 0, cell.value == 0

    @staticmethod
    def _result(cell: Cell, reset: object, state: bool) -> tuple[int, bool, int]:  # noqa: FBT001 - the last step
        """Function value, Q and BI."""
        if reset:
            cell.value = cell.base = 0
            cell.running = cell.over = state = False
        count = -(-cell.value // _BASES[cell.base])
        return cell.base << 12 | durations.to_bcd(count), state, count

    def count(
        self, number: int, up: object, down: object, preset_now: object, preset: int, reset: object
    ) -> tuple[int, bool, int]:
        """S_CUD, and with one input only S_CU and S_CD: function value in BCD, Q and CV."""
        cell = self.counters.setdefault(number, Cell())
        if cell.rises(0, up) and cell.value < 999:
            cell.value += 1
        if cell.rises(1, down) and cell.value > 0:
            cell.value -= 1
        if cell.rises(2, preset_now):
            try:
                cell.value = durations.from_bcd(preset & 0xFFF)
            except ValueError:
                cell.value = 0
        if reset:
            cell.value = 0
        return durations.to_bcd(cell.value), cell.value > 0, cell.value

    def count_up(self, number: int, up: object, now: object, preset: int, reset: object) -> tuple[int, bool, int]:
        """S_CU."""
        return self.count(number, up, None, now, preset, reset)

    def count_down(self, number: int, down: object, now: object, preset: int, reset: object) -> tuple[int, bool, int]:
        """S_CD."""
        return self.count(number, None, down, now, preset, reset)
