"""Arithmetic of the CPU where Python's differs; the names are those that generated code uses."""

from __future__ import annotations

import math
import re
import struct
from collections.abc import Callable
from typing import Any

from plcgen.s7.cpu.memory import single
from plcgen.s7.types import durations
from plcgen.s7.types.values import RANGES

_ROUNDING: dict[str, Callable[[float], int]] = {
    "round": round,
    "trunc": math.trunc,
    "floor": math.floor,
    "ceil": math.ceil,
}
_PACK = {32: (">f", ">I"), 64: (">d", ">Q")}
_NUMBER = re.compile(r" *([+-]?[0-9][0-9,]*)(\.[0-9]*)?")
"""The part of a text that counts as a number: up to the first character that is not permitted."""


def mod(left: int, right: int) -> int:
    """MOD: the sign is that of the dividend."""
    result = abs(left) % abs(right)
    return -result if left < 0 else result


def quotient(left: int, right: int) -> int:
    """Integer division towards zero."""
    result = abs(left) // abs(right)
    return result if (left < 0) == (right < 0) else -result


def real_ne(left: float, right: float) -> bool:
    """``<>`` of S7-300/400: FALSE if one of the two is no number."""
    return left < right or left > right


def power(base: float, exponent: float) -> float:
    """``**`` without exceptions."""
    try:
        result = float(base) ** exponent
    except OverflowError:
        return math.copysign(math.inf, base) if exponent % 2 == 1 else math.inf
    except ZeroDivisionError:
        return math.inf
    return result if isinstance(result, float) else math.nan


def to_int(value: float, bits: int, signed: bool, how: str) -> int:  # noqa: FBT001 - called from generated code
    """REAL to integer; what does not fit becomes the lowest value."""
    low, high = (-(1 << bits - 1), (1 << bits - 1) - 1) if signed else (0, (1 << bits) - 1)
    if not math.isfinite(value):
        return low
    rounded = _ROUNDING[how](value)
    return rounded if low <= rounded <= high else low


def whole(value: float, how: str) -> float:
    """Rounded, as a floating-point number; what is infinite or no number stays so."""
    return float(_ROUNDING[how](value)) if math.isfinite(value) else value


def bits_real(value: int, bits: int) -> float:
    """Bit pattern to REAL (LREAL for 64 bits)."""
    real, whole = _PACK[64 if bits == 64 else 32]
    result: float = struct.unpack(real, struct.pack(whole, value))[0]
    return result


def real_bits(value: float, bits: int) -> int:
    """REAL or LREAL to its bit pattern."""
    real, whole = _PACK[bits]
    result: int = struct.unpack(whole, struct.pack(real, value))[0]
    return result


def shl(value: int, count: int, bits: int) -> int:
    """Shift left, zeros come in."""
    return value << count & (1 << bits) - 1 if 0 <= count < bits else 0


def shr(value: int, count: int, bits: int) -> int:
    """Shift right: zeros come in, the sign for signed integers; a negative count is a large one without its sign."""
    return value >> (count if 0 <= count < bits else bits)


def rol(value: int, count: int, bits: int) -> int:
    """Rotate left."""
    count %= bits
    value &= (1 << bits) - 1
    return (value << count | value >> bits - count) & (1 << bits) - 1


def ror(value: int, count: int, bits: int) -> int:
    """Rotate right."""
    return rol(value, bits - count % bits, bits)


def limit(enable: list[bool], low: Any, value: Any, high: Any) -> Any:
    """LIMIT(MN, IN, MX); limits that contradict each other leave IN as it is and reset ENO."""
    if low > high:
        enable[0] = False
        return value
    return low if value < low else min(value, high)


def mux(selector: int, *values: Any) -> Any:
    """SEL and MUX; a selector out of range takes the last input."""
    return values[selector] if 0 <= selector < len(values) else values[-1]


def bcd_to_int(value: int, digits: int) -> int:
    """BCD with a sign digit to an integer; no BCD gives 0."""
    body = value & (1 << 4 * digits) - 1
    try:
        number = durations.from_bcd(body)
    except ValueError:
        return 0
    return -number if value >> 4 * digits + 3 & 1 else number


def int_to_bcd(value: int, digits: int) -> int:
    """Integer to BCD with a sign digit."""
    return durations.to_bcd(abs(value) % 10**digits) | (0xF << 4 * digits if value < 0 else 0)


def to_s5(milliseconds: int) -> int:
    """TIME to an S5TIME word; what does not fit becomes the longest one."""
    return durations.to_s5time(min(max(milliseconds, 0), 9_990_000))


def from_s5(word: int) -> int:
    """S5TIME word to milliseconds; no BCD gives 0."""
    try:
        return durations.from_s5time(word)
    except ValueError:
        return 0


def _real(function: Callable[[float], float]) -> Callable[[float], float]:
    def safe(value: float) -> float:
        try:
            return function(value)
        except OverflowError:
            return math.inf
        except ValueError:
            return math.nan

    return safe


def text_to(text: str, target: str) -> Any:
    """Text to a number: up to the first character that is none of it; no number, or one that does not fit, gives 0.

    S7-1200 System Manual (11/2011), table 8-35: 123.45 is the integer 123, 00123AB is 123, 1.23e-4 is 1.23, 12,345.67
    is 12345.67, ++123 is 0, 12345 as SINT is 0.
    """
    found = _NUMBER.match(text)
    whole, rest = (found[1].replace(",", ""), found[2] or "") if found is not None else ("0", "")
    if target in {"REAL", "LREAL"}:
        return single(float(whole + rest)) if target == "REAL" else float(whole + rest)
    low, high = RANGES[target]
    return int(whole) if low <= int(whole) <= high else 0


def text_to_v5(text: str, target: str) -> Any:
    """Text to a number on S7-300/400: nothing but digits, limited to the type, or the form of ``to_text_v5``; else 0.

    Help of the TIA Portal, S_CONV of S7-300/400 (FC37 to FC39 of STEP 7 V5).
    """
    if target == "REAL":
        return single(float(text)) if re.fullmatch(r"[+-][0-9]\.[0-9]{7}E[+-][0-9]{2}", text) else 0.0
    low, high = RANGES[target]
    fits = re.fullmatch(r"[+-]?[0-9]+", text) and len(text) <= len(str(low))
    return min(max(int(text), low), high) if fits else 0


def to_text(value: Any, source: str) -> str:
    """Write a number as the CPU does: in SCL with a sign, REAL with an exponent (help of S_CONV)."""
    return f"{value:+.6E}" if source in {"REAL", "LREAL"} else f"{value:+d}"


def to_text_v5(value: Any, source: str) -> str:
    """Write a number as S7-300/400 do: REAL has 14 characters, +v.nnnnnnnE+xx (help of S_CONV of S7-300/400)."""
    return f"{value:+.7E}" if source == "REAL" else f"{value:+d}"


def _left(text: str, length: int) -> str:
    return text[: max(length, 0)]


def _right(text: str, length: int) -> str:
    return text[-length:] if length > 0 else ""


def _mid(text: str, length: int, position: int) -> str:
    return text[position - 1 : position - 1 + max(length, 0)] if position > 0 else ""


def _insert(text: str, other: str, position: int) -> str:
    return text[:position] + other + text[position:] if position >= 0 else ""


def _delete(text: str, length: int, position: int) -> str:
    return text[: position - 1] + text[position - 1 + length :] if position > 0 and length >= 0 else ""


def _replace(text: str, other: str, length: int, position: int) -> str:
    return text[: position - 1] + other + text[position - 1 + length :] if position > 0 and length >= 0 else ""


def _delete_v5(text: str, length: int, position: int) -> str:
    """On S7-300/400 a position of 0 deletes nothing."""
    return text if position == 0 and length >= 0 else _delete(text, length, position)


def _replace_v5(text: str, other: str, length: int, position: int) -> str:
    """On S7-300/400 a length of 0 replaces nothing, a position of 0 counts as 1; of both the text goes in front."""
    if length == 0 and position > 0:
        return text
    return _replace(text, other, length, position or 1)


class Division:
    """What is reported (PG836) and goes on: a division by zero, with 0 or what a REAL has for it; digits of no BCD.

    The latter on S7-300/400 only: there it is a programming error, elsewhere a bit of the status word (help of the TIA
    Portal, explicit conversion of WORD, of both families).
    """

    def __init__(self, report: Callable[[str, str], None]) -> None:
        self._report = report

    def functions(self) -> dict[str, Callable[..., Any]]:
        """What generated code calls."""
        return {"div": self._div, "mod": self._mod, "fdiv": self._fdiv, "bcd": self._bcd}

    def _bcd(self, value: int, digits: int) -> int:
        if any(value >> 4 * place & 15 > 9 for place in range(digits)):
            self._report("PG836", f"16#{value:X} is no BCD number")
        return bcd_to_int(value, digits)

    def _div(self, left: int, right: int) -> int:
        if not right:
            self._report("PG836", "division by zero")
            return 0
        return quotient(left, right)

    def _mod(self, left: int, right: int) -> int:
        if not right:
            self._report("PG836", "division by zero")
            return 0
        return mod(left, right)

    def _fdiv(self, left: float, right: float) -> float:
        if right:
            return left / right
        self._report("PG836", "division by zero")
        return math.nan if not left or math.isnan(left) else math.copysign(math.inf, left) * math.copysign(1.0, right)


def functions() -> dict[str, Callable[..., Any]]:
    """Everything that generated code calls and that needs no CPU."""
    reals: dict[str, Callable[[float], float]] = {
        "sqr": lambda x: x * x, "sqrt": math.sqrt, "exp": math.exp, "expd": lambda x: math.pow(10.0, x),
        "ln": math.log, "log": math.log10, "sin": math.sin, "cos": math.cos, "tan": math.tan, "asin": math.asin,
        "acos": math.acos, "atan": math.atan, "frac": lambda x: math.modf(x)[0],
    }  # fmt: skip
    texts: dict[str, Callable[..., Any]] = {
        "len": len, "concat": lambda *parts: "".join(parts), "left": _left, "right": _right, "mid": _mid,
        "find": lambda a, b: a.find(b) + 1, "delete": _delete, "insert": _insert, "replace": _replace,
        "delete_v5": _delete_v5, "replace_v5": _replace_v5,
    }  # fmt: skip
    found: dict[str, Callable[..., Any]] = {f"m_{name}": _real(function) for name, function in reals.items()}
    found |= {f"t_{name}": function for name, function in texts.items()}
    own = (real_ne, power, to_int, whole, bits_real, real_bits, shl, shr, rol, ror, limit, mux, bcd_to_int, int_to_bcd)
    found |= {function.__name__: function for function in own}
    times = (to_s5, from_s5, text_to, text_to_v5, to_text, to_text_v5)
    found |= {function.__name__: function for function in times}
    return found | {"f32": single, "sqr": lambda x: x * x}
