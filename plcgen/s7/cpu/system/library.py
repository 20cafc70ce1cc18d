"""Functions of the CPU that only compute, as a table: what they take, what they give, the Python function of each.

Each row names its inputs as ``NAME type``; a type in lower case stands for a group: ``same`` are operands that meet in
one type, ``num``, ``int``, ``real``, ``bits``, ``text`` and ``time`` any of these. The result is a type, or what makes
one of those of the inputs. Values are tested with the tables of results of the help of the TIA Portal.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from functools import partial
from types import MappingProxyType
from typing import Any

from plcgen.s7.cpu import kinds
from plcgen.s7.cpu.arithmetic import to_int
from plcgen.s7.cpu.memory import Memory, Reference
from plcgen.s7.cpu.system import moments, texts
from plcgen.s7.cpu.system.clock import SystemClock
from plcgen.s7.cpu.system.timers import Cells
from plcgen.s7.cpu.type_rules import BITS, INTEGERS, REALS, STAMPS, TYPE_NAME, WIDTHS
from plcgen.s7.scl.dialect import Dialect
from plcgen.s7.types import durations
from plcgen.s7.types.values import RANGES


@dataclass(frozen=True, slots=True)
class Row:
    """One function.

    ``checked``: it returns first whether ENO stays TRUE; then comes the result, then each of ``outputs``. ``typed``:
    its first argument are the types of the inputs, the outputs and the result. ``named`` are the types that may stand
    behind the name: that of the result. An output with ``+`` is also an input, in the state before; what has
    ``=value`` behind it may be left out. ``of`` names the part of the CPU that is the first argument of all.
    """

    inputs: str
    result: str | Callable[[tuple[str, ...]], str | None]
    function: Callable[..., Any]
    outputs: str = ""
    checked: bool = False
    typed: bool = False
    named: Collection[str] = ()
    of: str = ""
    targets: Collection[Dialect] = tuple(Dialect)


@dataclass(frozen=True, slots=True)
class Part:
    """One parameter: ``before``: the function is given what an output held before."""

    name: str
    type: str
    default: str = ""
    before: bool = False


def parts(text: str) -> list[Part]:
    """Parameters of ``inputs`` or ``outputs``."""
    found = []
    for spelled in filter(None, text.split(";")):
        name, _, rest = spelled.partition(" ")
        type_, _, default = rest.partition("=")
        found.append(Part(name, type_.rstrip("+"), default, type_.endswith("+")))
    return found


NUMBERS = frozenset({*INTEGERS, *REALS})
GROUPS: Mapping[str, frozenset[str]] = MappingProxyType(
    {
        "num": NUMBERS, "int": frozenset(INTEGERS), "real": frozenset(REALS), "bits": frozenset(BITS),
        "stamp": STAMPS,
        "text": frozenset({"STRING", "WSTRING"}),
        "time": frozenset({"TIME", "LTIME", "TIME_OF_DAY", "LTIME_OF_DAY", "DATE", *STAMPS}),
    }
)  # fmt: skip
_FULL = 27648


def normalize(low: float, value: float, high: float) -> tuple[bool, float]:
    """NORM_X."""
    if not low < high or math.isnan(value):
        span = high - low
        return False, (value - low) / span if span else math.nan
    return True, (value - low) / (high - low)


def scale(types: tuple[str, ...], low: float, value: float, high: float) -> tuple[bool, float]:
    """SCALE_X; an integer is rounded, one that does not fit becomes the lowest."""
    result = value * (high - low) + low
    target = types[-1]
    fits = low < high and not math.isnan(value)
    if target in REALS:
        return fits, result
    least, most = RANGES[target]
    whole = to_int(result, WIDTHS[target], least < 0, "round")
    return fits and math.isfinite(result) and least <= round(result) <= most, whole


def scale_analog(value: int, high: float, low: float, bipolar: object) -> tuple[int, float]:
    """SCALE (FC105): RET_VAL and the value in physical units."""
    first = -_FULL if bipolar else 0
    if not first <= value <= _FULL:
        return 8, low if value < first else high
    return 0, (value - first) / (_FULL - first) * (high - low) + low


def unscale_analog(value: float, high: float, low: float, bipolar: object) -> tuple[int, int]:
    """UNSCALE (FC106): RET_VAL and the value of the module."""
    first = -_FULL if bipolar else 0
    least, most = min(low, high), max(low, high)
    if not least <= value <= most:
        at_low = (value < least) == (low <= high)
        return 8, first if at_low else _FULL
    if low == high:
        return 0, first
    return 0, round((value - low) / (high - low) * (_FULL - first) + first)


def decode(types: tuple[str, ...], number: int) -> int:
    """DECO: one bit; the number counts modulo the width."""
    return 1 << number % WIDTHS[types[-1]]


def encode(value: int) -> tuple[bool, int]:
    """ENCO: the lowest bit that is set."""
    return value != 0, (value & -value).bit_length() - 1 if value else 0


def segments(value: int) -> int:
    """SEG: bits g f e d c b a of four hexadecimal digits."""
    return int.from_bytes(_SEGMENTS[value >> shift & 15] for shift in (12, 8, 4, 0))


_SEGMENTS = bytes.fromhex("3F065B4F666D7D077F67777C395E7971")


def tens_complement(value: int) -> int:
    """BCDCPL of seven digits."""
    try:
        number = durations.from_bcd(value & 0xFFFFFFF)
    except ValueError:
        return 0
    return durations.to_bcd((10**7 - number) % 10**8)


def parity(value: int) -> bool:
    """Whether an odd number of bits is set."""
    return bool(value.bit_count() & 1)


_DT = "DATE_AND_TIME"
_COMPARISONS: Mapping[str, Callable[[Any, Any], bool]] = MappingProxyType(
    {"EQ": operator.eq, "NE": operator.ne, "LT": operator.lt, "LE": operator.le, "GT": operator.gt, "GE": operator.ge}
)


def dates_compared(symbol: str) -> Callable[[bytes, bytes], bool]:
    """EQ_DT and its like."""
    judge = _COMPARISONS[symbol]
    return lambda left, right: judge(moments.to_ns(left, _DT), moments.to_ns(right, _DT))


def preset_timer(types: tuple[str, ...], preset: int, timer: Reference) -> None:
    """PRESET_TIMER: PT of an IEC timer, in ms or in ns."""
    memory, offset, size = timer
    width = 8 if size > 22 else 4
    if memory is not None:
        value = moments.to_ns(preset, types[0]) // (1 if width == 8 else durations.NS_PER_MS)
        memory[offset + width : offset + 2 * width] = value.to_bytes(width, signed=True)


Bit = tuple[Memory | None, int]
"""Memory and the number of a bit in it."""


def set_bits(value: bool, first: Bit, count: int) -> None:  # noqa: FBT001 - bound in the table
    """SET and RESET: so many bits from one on."""
    memory, start = first
    if memory is None or memory.area == "P":
        return
    for bit in range(start, min(start + max(count, 0), 8 * len(memory))):
        mask = 1 << bit % 8
        memory[bit // 8] = memory[bit // 8] | mask if value else memory[bit // 8] & 255 - mask


def set_bytes(value: int, first: Bit, count: int) -> None:
    """SETI and RESETI: whole bytes of the periphery."""
    memory, start = first
    if memory is None or memory.area != "P" or start % 8 or count % 8:
        return
    for byte in range(start // 8, min((start + count) // 8, len(memory))):
        memory[byte] = value


def shift_bit(data: object, reset: object, first: Bit, count: int) -> None:
    """SHRB: the bits move up by one, the first one becomes DATA; RESET clears them."""
    memory, start = first
    if memory is None or start + count > 8 * len(memory):
        return
    bits = [memory[bit // 8] >> bit % 8 & 1 for bit in range(start, start + count)]
    shifted = [0] * count if reset else [int(bool(data)), *bits[:-1]]
    for bit, value in enumerate(shifted, start):
        mask = 1 << bit % 8
        memory[bit // 8] = memory[bit // 8] | mask if value else memory[bit // 8] & 255 - mask


_ELEMENTS = {4: 2, 5: 2, 6: 4, 7: 4, 8: 4}
"""E_TYPE of WSR: WORD, INT, DWORD, DINT, REAL, and their bytes."""


def shift_word(reset: object, source: Bit, first: Bit, count: int, type_: int) -> tuple[None, bool]:
    """WSR: the elements move up by one, the first one becomes that of the source; Q: all of them are 0."""
    size = _ELEMENTS.get(type_, 0)
    memory, at = first[0], first[1] // 8
    if memory is None or source[0] is None or not size or at + count * size > len(memory):
        return None, False
    taken = source[0][source[1] // 8 : source[1] // 8 + size]
    moved = memory[at : at + (count - 1) * size]
    memory[at : at + count * size] = bytes(count * size) if reset else bytes(taken + moved)
    return None, not any(memory[at : at + count * size])


def add_time(enabled: object, reset: object, preset: int, passed: int, elapsed: int) -> tuple[None, bool, int]:
    """TONR_X: Q and ET."""
    if reset:
        return None, False, 0
    elapsed = min(elapsed + passed, preset) if enabled and elapsed < preset else elapsed
    return None, elapsed >= preset, elapsed


Tail = tuple[Memory | None, int, int, int, int]
"""Memory, begin of an array, an element of it, its end, and the width of an element, in bits."""


def scatter_block(source: Tail, count: int, target: Tail) -> tuple[bool, None]:
    """SCATTER_BLK: as many bit strings as there are and as find room; a target that begins in one gets nothing."""
    return _join_bits(source, target, count, source[4], reading=True)


def gather_block(source: Tail, count: int, target: Tail) -> tuple[bool, None]:
    """GATHER_BLK."""
    return _join_bits(target, source, count, target[4], reading=False)


def _join_bits(words: Tail, bits: Tail, count: int, width: int, *, reading: bool) -> tuple[bool, None]:
    (memory, _, at, end, _), (other, begin, first, last, _) = words, bits
    if memory is None or other is None or (first - begin) % width:
        return False, None
    done = min(count, (end - at) // width, (last - first) // width)
    size = width // 8
    for number in range(done):
        place, single = at // 8 + number * size, first // 8 + number * size
        if reading:
            other[single : single + size] = memory[place : place + size][::-1]
        else:
            memory[place : place + size] = other[single : single + size][::-1]
    return done == count, None


@dataclass(frozen=True, slots=True)
class Hooks:
    """What functions ask of the CPU: the type of the instance with a number, and that it stops."""

    type_of: Callable[[int], str]
    stop: Callable[[], None]


def _wider_real(types: tuple[str, ...]) -> str:
    return "LREAL" if "LREAL" in types else "REAL"


def _sum(types: tuple[str, ...]) -> str | None:
    return moments.SUMS.get((types[0], types[1]))


def _span(types: tuple[str, ...]) -> str | None:
    return moments.DIFFERENCES.get(types[0]) if types[0] == types[1] else None


_DATED = "IN1 DATE;IN2 time", "DTL", moments.combine
_STAMP_NAMES = frozenset({"DTL", "LDT", "DATE_AND_TIME"})
_ANALOG = "HI_LIM REAL;LO_LIM REAL;BIPOLAR BOOL"
_PRESET = "S BOOL=False;PV WORD=0;R BOOL=False"
_COUNT = "Q BOOL=-;CV WORD=-"
_S5_TIMERS = {
    "S_PULSE": Cells.pulse, "S_PEXT": Cells.extended, "S_ODT": Cells.on_delay, "S_ODTS": Cells.retentive,
    "S_OFFDT": Cells.off_delay,
}  # fmt: skip
_MODERN = (Dialect.TIA_1200_1500,)
_CLASSIC = (Dialect.STEP7_V5, Dialect.TIA_300_400)
_TIA = (Dialect.TIA_300_400, Dialect.TIA_1200_1500)
ROWS: Mapping[str, Row] = MappingProxyType(
    {
        "NORM_X": Row(
            "MIN same;VALUE same;MAX same", _wider_real, normalize, checked=True, named=REALS, targets=_MODERN
        ),
        "SCALE_X": Row(
            "MIN same;VALUE real;MAX same", lambda types: types[0], scale, checked=True, typed=True, named=NUMBERS,
            targets=_MODERN,
        ),
        "SCALE": Row(f"IN INT;{_ANALOG}", "WORD", scale_analog, "OUT REAL"),
        "UNSCALE": Row(f"IN REAL;{_ANALOG}", "WORD", unscale_analog, "OUT INT"),
        "DECO": Row("IN int", "DWORD", decode, typed=True, named=BITS),
        "ENCO": Row("IN bits", "INT", encode, checked=True, named=BITS),
        "SEG": Row("IN WORD", "", lambda value: (None, segments(value)), "OUT DWORD"),
        "BCDCPL": Row("IN DWORD", "DWORD", tens_complement),
        "BITSUM": Row("IN DWORD", "INT", int.bit_count),
        "PARITY": Row("IN bits", "BOOL", parity, targets=_MODERN),
        "T_ADD": Row("IN1 time;IN2 time", _sum, moments.add, checked=True, typed=True, targets=_TIA),
        "T_SUB": Row("IN1 time;IN2 time", _sum, moments.subtract, checked=True, typed=True, targets=_TIA),
        "T_DIFF": Row(
            "IN1 time;IN2 time", _span, moments.difference, checked=True, typed=True, named={"INT", "TIME", "LTIME"},
            targets=_TIA,
        ),
        "T_COMBINE": Row(*_DATED, checked=True, typed=True, named=_STAMP_NAMES, targets=_TIA),
        "CONCAT_DATE_TOD": Row(*_DATED, checked=True, typed=True, named=_STAMP_NAMES, targets=_TIA),
        "CONCAT_DATE_LTOD": Row(*_DATED, checked=True, typed=True, named=_STAMP_NAMES, targets=_MODERN),
        "D_TOD_DT": Row("IN1 DATE;IN2 TIME_OF_DAY", _DT, moments.combine, checked=True, typed=True, targets=_CLASSIC),
        "AD_DT_TM": Row(f"T {_DT};D TIME", _DT, moments.add, checked=True, typed=True, targets=_CLASSIC),
        "SB_DT_TM": Row(f"T {_DT};D TIME", _DT, moments.subtract, checked=True, typed=True, targets=_CLASSIC),
        "SB_DT_DT": Row(f"DT1 {_DT};DT2 {_DT}", "TIME", moments.subtract, checked=True, typed=True, targets=_CLASSIC),
        "DT_DATE": Row(f"IN {_DT}", "DATE", lambda stamp: moments.convert(stamp, _DT, "DATE"), targets=_CLASSIC),
        "DT_TOD": Row(
            f"IN {_DT}", "TIME_OF_DAY", lambda stamp: moments.convert(stamp, _DT, "TIME_OF_DAY"), targets=_CLASSIC
        ),
        "DT_DAY": Row(f"IN {_DT}", "INT", lambda stamp: moments.weekday(stamp, _DT), targets=_CLASSIC),
        "STRG_VAL": Row(
            "IN text;FORMAT WORD=0;P UINT=1", "", texts.string_to_value, "OUT num", checked=True, typed=True,
            targets=_MODERN,
        ),
        "VAL_STRG": Row(
            "IN num;SIZE USINT=0;PREC USINT=0;FORMAT WORD=0;P UINT=1", "", texts.value_to_string, "OUT text+",
            checked=True, typed=True,
            targets=_MODERN,
        ),
        "LOWER_BOUND": Row("ARR ref;DIM UDINT", "DINT", partial(kinds.bound, 0), checked=True, targets=_MODERN),
        "UPPER_BOUND": Row("ARR ref;DIM UDINT", "DINT", partial(kinds.bound, 1), checked=True, targets=_MODERN),
        "COUNTOFELEMENTS": Row("IN ref", "UDINT", lambda ref: kinds.kind_at(ref).count, targets=_MODERN),
        "IS_ARRAY": Row("IN ref", "BOOL", lambda ref: kinds.kind_at(ref).element is not None, targets=_MODERN),
        "TYPEOF": Row("IN ref", TYPE_NAME, lambda ref: kinds.kind_at(ref).name, targets=_MODERN),
        "TYPEOFELEMENTS": Row("IN ref", TYPE_NAME, kinds.type_of_elements, targets=_MODERN),
        "VARIANTGET": Row("SRC ref;DST ref", "", kinds.get_value, checked=True, targets=_MODERN),
        "VARIANTPUT": Row("SRC ref;DST ref", "", kinds.get_value, checked=True, targets=_MODERN),
        "MOVE_BLK_VARIANT": Row(
            "SRC ref;COUNT UDINT;SRC_INDEX DINT;DEST_INDEX DINT;DEST ref", "INT", kinds.move_elements, targets=_MODERN
        ),
        "SERIALIZE": Row(
            "SRC_VARIABLE ref;DEST_ARRAY ref", "INT", kinds.serialize, "POS DINT+", targets=_MODERN
        ),
        "DESERIALIZE": Row(
            "SRC_ARRAY ref;DEST_VARIABLE ref", "INT", kinds.deserialize, "POS DINT+", targets=_MODERN
        ),
        "SCATTER": Row("IN bits;OUT ref", "", kinds.scatter, checked=True, typed=True, targets=_MODERN),
        "GATHER": Row("IN ref", "", kinds.gather, "OUT bits", checked=True, typed=True, targets=_MODERN),
        "SCATTER_BLK": Row("IN tail;COUNT_IN UDINT;OUT tail", "", scatter_block, checked=True, targets=_MODERN),
        "GATHER_BLK": Row("IN tail;COUNT_OUT UDINT;OUT tail", "", gather_block, checked=True, targets=_MODERN),
        "TYPEOFDB": Row(
            "DB DB_ANY", TYPE_NAME, lambda hooks, number: hooks.type_of(number), of="hooks", targets=_MODERN
        ),
        "STP": Row("", "", lambda hooks: hooks.stop(), of="hooks"),
        "STRG_TO_CHARS": Row(
            "STRG text;PCHARS DINT=0;CHARS ref", "", kinds.to_characters, "CNT UINT", checked=True, targets=_MODERN
        ),
        "CHARS_TO_STRG": Row(
            "CHARS ref;PCHARS DINT=0;CNT UINT=0", "", kinds.from_characters, "STRG text", checked=True, targets=_MODERN
        ),
        "ATH": Row("IN ref;N INT;OUT ref", "WORD", kinds.from_hexadecimal),
        "HTA": Row("IN ref;N UINT;OUT ref", "WORD", kinds.to_hexadecimal),
        "MAX_LEN": Row("IN ref", "INT", lambda ref: kinds.kind_at(ref).room, targets=_MODERN),
        **{
            name: Row(
                "T_NO timer;S BOOL=False;TV s5=0;R BOOL=False", "S5TIME", function, "Q BOOL=-;BI WORD=-", of="cells",
                targets=tuple(Dialect),
            )
            for name, function in _S5_TIMERS.items()
        },
        "S_CU": Row(f"C_NO counter;CU BOOL=False;{_PRESET}", "WORD", Cells.count_up, _COUNT, of="cells"),
        "S_CD": Row(f"C_NO counter;CD BOOL=False;{_PRESET}", "WORD", Cells.count_down, _COUNT, of="cells"),
        "S_CUD": Row(
            f"C_NO counter;CU BOOL=False;CD BOOL=False;{_PRESET}", "WORD", Cells.count, _COUNT, of="cells"
        ),
        "RESET_TIMER": Row("TIMER ref", "", kinds.clear, targets=_MODERN),
        "PRESET_TIMER": Row("PT time;TIMER ref", "", preset_timer, typed=True, targets=_MODERN),
        "RD_SYS_T": Row("", "INT", SystemClock.read, "OUT stamp", typed=True, of="time", targets=_TIA),
        "RD_LOC_T": Row("", "INT", SystemClock.read_local, "OUT stamp", typed=True, of="time", targets=_MODERN),
        "WR_SYS_T": Row("IN stamp", "INT", SystemClock.set, typed=True, of="time", targets=_TIA),
        "WR_LOC_T": Row(
            "LOCTIME stamp;DST BOOL=False", "INT", SystemClock.set_local, typed=True, of="time", targets=_MODERN
        ),
        "READ_CLK": Row("", "INT", SystemClock.read, f"CDT {_DT}", typed=True, of="time", targets=_CLASSIC),
        "SET_CLK": Row(f"PDT {_DT}", "INT", SystemClock.set, typed=True, of="time", targets=_CLASSIC),
        "RUNTIME": Row("MEM LREAL", "LREAL", SystemClock.runtime, "MEM LREAL", of="time", targets=_MODERN),
        "WAIT": Row("WT INT", "", lambda span: (span >= 0, None), checked=True),
        "RE_TRIGR": Row("", "", lambda: None),
        "SET": Row("S_BIT bit;N INT", "", partial(set_bits, True), targets=_CLASSIC),  # noqa: FBT003
        "RESET": Row("S_BIT bit;N INT", "", partial(set_bits, False), targets=_CLASSIC),  # noqa: FBT003
        "SETI": Row("S_BYTE bit;N INT", "", partial(set_bytes, 0xFF), targets=_CLASSIC),
        "RESETI": Row("S_BYTE bit;N INT", "", partial(set_bytes, 0), targets=_CLASSIC),
        "SHRB": Row("DATA BOOL;RESET BOOL;S_BIT bit;N WORD", "", shift_bit, targets=_CLASSIC),
        "WSR": Row(
            "RESET BOOL;S_DATA bit;START bit;LEN WORD;E_TYPE BYTE", "", shift_word, "Q BOOL", targets=_CLASSIC
        ),
        "TONR_X": Row(
            "TMR_EN BOOL;RESET BOOL;PV DINT;DELTA_T INT", "", add_time, "Q BOOL;ET DINT+", targets=_CLASSIC
        ),
        "REPL_VAL": Row("VAL DWORD", "INT", lambda _: 0, targets=_CLASSIC),
        "S_MOVE": Row("IN text", "", lambda text: (None, text), "OUT text", targets=_MODERN),
        **{
            f"{symbol}_STRNG": Row("S1 text;S2 text", "BOOL", judge, targets=_CLASSIC)
            for symbol, judge in _COMPARISONS.items()
        },
        **{
            f"{symbol}_DT": Row(f"DT1 {_DT};DT2 {_DT}", "BOOL", dates_compared(symbol), targets=_CLASSIC)
            for symbol in _COMPARISONS
        },
    }
)  # fmt: skip
