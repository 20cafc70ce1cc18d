"""Blocks and cells that keep values: IEC timers, counters, edges, LEAD_LAG, DCAT, MCAT, S5 timers, S5 counters.

Sources: help of the TIA Portal V19, pages of SCL of both families for LEAD_LAG, DCAT and MCAT; the equation of LEAD_LAG
gives its example; S_PULSE to S_OFFDT and S_CU to S_CUD of SCL for S5 timers and counters.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from struct import Struct
from typing import Any

from plcgen.s7.cpu.memory import AREA_L, Memory
from plcgen.s7.cpu.system.interfaces import TIMERS, SystemFb
from plcgen.s7.layout.image import read_entry, write_member
from plcgen.s7.layout.layout import Layout, locate
from plcgen.s7.layout.shapes import Shape
from plcgen.s7.types import durations

Runner = Callable[..., None]
"""What a call runs: the memory of an instance and its offset there; of a modern timer also PT, see ``timer``."""


class Fields:
    """Access to the members of an instance by name."""

    def __init__(self, shape: Shape) -> None:
        self.places = {
            name: (field.offset // 8, field.offset % 8, field.shape.bits) for name, field in shape.index.items()
        }

    def flag(self, name: str) -> tuple[int, int]:
        """Byte and mask of a BOOL, or of the lowest bit of a byte."""
        byte, bit, _ = self.places[name]
        return byte, 1 << bit

    def number(self, memory: Memory, offset: int, name: str) -> int:
        """Signed value of an integer or time."""
        byte, _, bits = self.places[name]
        return int.from_bytes(memory[offset + byte : offset + byte + bits // 8], signed=True)

    def put(self, memory: Memory, offset: int, name: str, value: int) -> None:
        """Store an integer or time."""
        byte, _, bits = self.places[name]
        size = bits // 8
        memory[offset + byte : offset + byte + size] = (value & (1 << bits) - 1).to_bytes(size)


def timer(kind: str, shape: Shape, clock: list[int]) -> Runner:
    """Make the timer function: TON, TOF, TP or TONR over the declared members, in ms, or in ns with LTIME.

    ``given`` is the PT of a call on an S7-1200/1500: it is taken over when IN changes, by a TP not in its time (help of
    the TIA Portal, TON: "Updating the actual values"; S7-1200 System Manual, "Timer operations"). ``again`` is the IN
    of the call before where no call, but a query brings the data up to date.
    """
    fields = Fields(shape)
    classic = "STATE" in fields.places
    start = "STIME" if classic else "START"
    running = (fields.places["STATE"][0], 1) if classic else fields.flag("RU")
    old = (fields.places["STATE"][0], 2) if classic else (fields.places["RESERVED"][0], 1)
    code, code_byte = (0 if classic else TIMERS.index(kind)), old[0] + 1
    in_byte, in_mask = fields.flag("IN")
    q_byte, q_mask = fields.flag("Q")
    et_byte, _, bits = fields.places["ET"]
    zero = bytes(bits // 8)
    unit, whole = (1_000_000 if bits == 64 else 1), (1 << bits) - 1
    r_byte, r_mask = fields.flag("R") if kind == "TONR" else (0, 0)
    step = {"TON": _on_v5 if classic else _on, "TOF": _off, "TP": _pulse, "TONR": _sum}[kind]
    number = Struct(">q" if bits == 64 else ">i")  # PT, ET and the start have one type
    read, write = number.unpack_from, number.pack_into
    pt_byte, start_byte, wrap = fields.places["PT"][0], fields.places[start][0], (1 << bits - 1)
    delays_on, pulse = kind == "TON", kind == "TP"

    def run(memory: Memory, offset: int, given: int | None = None, *, again: bool | None = None) -> None:
        active = memory[offset + in_byte] & in_mask != 0 if again is None else again
        if delays_on and not active:
            if memory[offset + running[0]] & running[1] or memory[offset + q_byte] & q_mask:
                memory[offset + running[0]] &= 255 - running[1]
                memory[offset + q_byte] &= 255 - q_mask
                memory[offset + old[0]] &= 255 - old[1]
                memory[offset + et_byte : offset + et_byte + len(zero)] = zero
            return
        if r_mask and memory[offset + r_byte] & r_mask:
            memory[offset + running[0]] &= 255 - running[1]
            memory[offset + et_byte : offset + et_byte + len(zero)] = zero
        now = clock[0] * unit
        was_active = memory[offset + old[0]] & old[1] != 0
        was_running = memory[offset + running[0]] & running[1] != 0
        if given is not None and active != was_active and not (pulse and was_running):
            write(memory, offset + pt_byte, given)
        passed = (now - read(memory, offset + start_byte)[0]) & whole
        elapsed, preset = read(memory, offset + et_byte)[0], read(memory, offset + pt_byte)[0]
        is_running, q, et, restart = step(active, was_active, was_running, passed, elapsed, preset)
        if restart:
            write(memory, offset + start_byte, (now + wrap & whole) - wrap)
        write(memory, offset + et_byte, et)
        if (is_running, q, active) != (was_running, memory[offset + q_byte] & q_mask != 0, was_active):
            for (byte, mask), value in ((running, is_running), ((q_byte, q_mask), q), (old, active)):
                memory[offset + byte] = memory[offset + byte] | mask if value else memory[offset + byte] & (255 - mask)
            if code:
                memory[offset + code_byte] = code

    return run


def query(shape: Shape, clock: list[int]) -> Runner:
    """Make the function that a query of Q or ET on an S7-1200/1500 runs before: the timer goes on as it was called.

    ``shape`` is that of the timer with the most members, TONR.
    """
    runs = [timer(kind or "TON", shape, clock) for kind in TIMERS]
    fields = Fields(shape)
    _, mask = fields.flag("RU")
    et_byte, _, bits = fields.places["ET"]
    unit, whole, letter = (1_000_000, (1 << 64) - 1, "q") if bits == 64 else (1, (1 << 32) - 1, "i")
    read = Struct(f">3{letter}BxBB").unpack_from  # START, PT, ET; RU, IN, Q, R; RESERVED
    write = Struct(f">{letter}").pack_into
    adds_up = TIMERS.index("TONR")

    def run(memory: Memory, offset: int) -> None:
        start, preset, _, flags, old, code = read(memory, offset)
        if flags & mask:
            passed = clock[0] * unit - start & whole
            if passed < preset and code != adds_up:  # nothing is over, as mostly
                write(memory, offset + et_byte, passed)
            else:
                runs[code](memory, offset, again=old & 1 != 0)

    return run


State = tuple[bool, bool, int, bool]


def _on(active: bool, _was: bool, running: bool, passed: int, _et: int, preset: int) -> State:  # noqa: FBT001
    """TON: Q follows IN after PT."""
    if not active:
        return False, False, 0, False
    et = min(passed, preset) if running else 0
    return True, et >= preset, et, not running


def _on_v5(active: bool, was: bool, running: bool, passed: int, et: int, preset: int) -> State:  # noqa: FBT001
    """SFB4: a call with PT 0 initializes it (System Software for S7-300/400, SFB 4): Q does not come."""
    return _on(active, was, running, passed, et, preset) if preset > 0 else (False, False, 0, False)


def _off(active: bool, was: bool, running: bool, passed: int, et: int, preset: int) -> State:  # noqa: FBT001
    """TOF: Q stays for PT after IN has fallen."""
    if active:
        return False, True, 0, False
    if was:
        return preset > 0, preset > 0, 0, True
    if not running:
        return False, False, et, False
    et = min(passed, preset)
    return et < preset, et < preset, et, False


def _pulse(active: bool, was: bool, running: bool, passed: int, et: int, preset: int) -> State:  # noqa: FBT001
    """TP: Q for PT from a rising edge, whatever IN does."""
    if running:
        et = min(passed, preset)
        if et < preset:
            return True, True, et, False
        return False, False, et if active else 0, False
    if active and not was:
        return preset > 0, preset > 0, 0, True
    return False, False, et if active else 0, False


def _sum(active: bool, _was: bool, running: bool, passed: int, et: int, preset: int) -> State:  # noqa: FBT001
    """TONR: adds up the times of IN until R; Q stays when IN falls."""
    et = min(et + passed, preset) if active and running else et
    return active, et >= preset and (active or et > 0), et, active


def counter(system: SystemFb, shape: Shape) -> Runner:
    """Make the counter function: CTU, CTD or CTUD."""
    fields = Fields(shape)
    load = "LOAD" if "LOAD" in fields.places else "LD"
    bits = fields.places["CV"][2]
    unsigned = "_U" in system.block.name
    low, high = (0, (1 << bits) - 1) if unsigned else (-(1 << bits - 1), (1 << bits - 1) - 1)

    def read(memory: Memory, offset: int, name: str) -> bool:
        if name not in fields.places:
            return False
        byte, mask = fields.flag(name)
        return bool(memory[offset + byte] & mask)

    def write(memory: Memory, offset: int, name: str, *, value: bool) -> None:
        if name in fields.places:
            byte, mask = fields.flag(name)
            memory[offset + byte] = memory[offset + byte] | mask if value else memory[offset + byte] & (255 - mask)

    def run(memory: Memory, offset: int) -> None:
        preset = fields.number(memory, offset, "PV") & ((1 << bits) - 1 if unsigned else -1)
        value = fields.number(memory, offset, "CV") & ((1 << bits) - 1 if unsigned else -1)
        up, down = read(memory, offset, "CU"), read(memory, offset, "CD")
        if read(memory, offset, "R"):
            value = 0
        elif read(memory, offset, load):
            value = preset
        else:
            value += up and not read(memory, offset, "CUO") and value < high
            value -= down and not read(memory, offset, "CDO") and value > low
        fields.put(memory, offset, "CV", value)
        write(memory, offset, "CUO", value=up)
        write(memory, offset, "CDO", value=down)
        write(memory, offset, "Q", value=value >= preset if system.kind == "CTU" else value <= 0)
        write(memory, offset, "QU", value=value >= preset)
        write(memory, offset, "QD", value=value <= 0)

    return run


def edge(system: SystemFb, shape: Shape) -> Runner:
    """Make the edge function: R_TRIG or F_TRIG."""
    fields = Fields(shape)
    clk, old, q = fields.flag("CLK"), fields.flag("STAT_BIT"), fields.flag("Q")
    rising = system.kind == "R_TRIG"

    def run(memory: Memory, offset: int) -> None:
        now = bool(memory[offset + clk[0]] & clk[1])
        before = bool(memory[offset + old[0]] & old[1])
        found = now and not before if rising else before and not now
        for (byte, mask), value in ((old, now), (q, found)):
            memory[offset + byte] = memory[offset + byte] | mask if value else memory[offset + byte] & (255 - mask)

    return run


def lead_lag(values: dict[str, Any], _now: int) -> None:
    """LEAD_LAG."""
    if values["GAIN"] <= 0:
        values["ERR_CODE"] = 9
        return
    span, lead, lag = values["SAMPLE_T"], values["LD_TIME"], values["LG_TIME"]
    ahead = (lead + span) * values["IN"] - lead * values["PREV_IN"]
    out = (lag * values["PREV_OUT"] + values["GAIN"] * ahead) / (lag + span) if lag + span else 0.0
    values.update(OUT=out, PREV_OUT=out, PREV_IN=values["IN"], ERR_CODE=0)


def discrete_alarm(values: dict[str, Any], now: int) -> None:
    """DCAT: Q and the history follow CMD; the time runs until the feedback comes."""
    passed, values["PREV_TIME"] = now - values["PREV_TIME"], now
    command = values["CMD"]
    if command != values["CMD_HIS"]:
        values.update(Q=command, CMD_HIS=command, ET=0, OA=False, CA=False)
        return
    arrived, alarm = ("O_FB", "OA") if command else ("C_FB", "CA")
    if values["O_FB"] and values["C_FB"]:
        values.update(OA=True, CA=True)
    elif values[arrived]:
        values.update({alarm: False, "ET": values["PT"]})
    else:
        elapsed = values["ET"] + passed
        values.update({"ET": min(elapsed, values["PT"]), alarm: elapsed > values["PT"]})


def motor_alarm(values: dict[str, Any], now: int) -> None:
    """MCAT: the table of the help, from its first row to its last."""
    passed, values["PREV_TIME"] = now - values["PREV_TIME"], now
    opening, closing = values["O_HIS"], values["C_HIS"]
    outputs = dict.fromkeys(("OO", "CO", "OA", "CA"), False)
    if (opening and closing) or (values["O_FB"] and values["C_FB"]):
        values.update(outputs, OA=True, CA=True, ET=values["PT"], O_HIS=False, C_HIS=False, Q=False)
    elif values["S_CMD"] or (values["O_CMD"] and values["C_CMD"]):
        values.update(outputs, O_HIS=False, C_HIS=False, Q=True)
    elif values["O_CMD"] and not opening:
        values.update(outputs, OO=True, ET=0, O_HIS=True, C_HIS=False, Q=True)
    elif values["C_CMD"] and not closing:
        values.update(outputs, CO=True, ET=0, O_HIS=False, C_HIS=True, Q=True)
    elif opening or closing:
        run, alarm, arrived = ("OO", "OA", "O_FB") if opening else ("CO", "CA", "C_FB")
        late = values["ET"] >= values["PT"] and not values[arrived]
        elapsed = values["PT"] if late or values[arrived] else values["ET"] + passed
        values.update(outputs, ET=elapsed, Q=not late)
        values[alarm if late else run] = not values[arrived]
    else:
        values.update(outputs, Q=True)


_BODIES: dict[str, Callable[[dict[str, Any], int], None]] = {
    "LEAD_LAG": lead_lag, "DCAT": discrete_alarm, "MCAT": motor_alarm,
}  # fmt: skip


def control(kind: str, shape: Shape, clock: list[int]) -> Callable[[Memory, int], None]:
    """Make what a call runs: the members of the instance go in, and come back changed."""
    layout, body = Layout(shape.bits // 8, shape), _BODIES[kind]
    entries = {name: locate(layout, name) for name in shape.index}

    def run(memory: Memory, offset: int) -> None:
        own = Memory(memory[offset : offset + layout.size], AREA_L)
        values: dict[str, Any] = {name: read_entry(own, entry) for name, entry in entries.items()}
        body(values, clock[0])
        for name, value in values.items():
            write_member(own, layout, name, value)
        memory[offset : offset + layout.size] = own

    return run


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
