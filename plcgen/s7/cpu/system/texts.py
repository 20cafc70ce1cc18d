"""Numbers as text and back: STRG_VAL and VAL_STRG, hexadecimal digits."""

from __future__ import annotations

import math
import re

from plcgen.s7.cpu.memory import single
from plcgen.s7.types.values import RANGES

_NUMBER = re.compile(r" *([+-]?)([0-9.,]*)(?:[eE]([+-]?[0-9]+))?")
_COMMA, _EXPONENT, _PLUS = 1, 2, 4
"""Bits of FORMAT: decimal comma, exponential notation, plus sign (help of VAL_STRG)."""
_REAL_DIGITS = {"REAL": 7, "LREAL": 15}
_LEAST = {"REAL": 1.1754943508222875e-38, "LREAL": 2.2250738585072014e-308}
"""Smallest normalised number: what is smaller becomes 0 (help of STRG_VAL)."""


def string_to_value(types: tuple[str, ...], text: str, form: int, position: int) -> tuple[bool, None, int | float]:
    """STRG_VAL: up to the first character that is not permitted, without separators other than the decimal one."""
    target = types[-1]
    zero: int | float = 0.0 if target in _REAL_DIGITS else 0
    if form > 3 or not 1 <= position <= len(text):
        return False, None, zero
    found = _NUMBER.match(text, position - 1)
    digits = found[2] if found is not None else ""
    decimal, other = (",", ".") if form & _COMMA else (".", ",")
    whole, point, rest = digits.replace(other, "").partition(decimal)
    rest = rest.partition(decimal)[0]
    if found is None or not (whole + rest).isdigit():
        return False, None, zero
    exponent = found[3] if form & _EXPONENT and found[3] else "0"
    try:
        number = float(f"{found[1]}{whole or 0}.{rest or 0}e{exponent}")
    except OverflowError:
        number = math.inf
    if target in _REAL_DIGITS:
        number = 0.0 if abs(number) < _LEAST[target] else number
        number = single(number) if target == "REAL" else number
        return not math.isinf(number), None, number
    low, high = RANGES[target]
    exact = exponent == "0" and not (point and rest.strip("0"))
    value = int(f"{found[1]}{whole or 0}") if exact else (round(number) if math.isfinite(number) else high + 1)
    return (True, None, value) if low <= value <= high else (False, None, 0)


def value_to_string(
    types: tuple[str, ...], value: float, size: int, digits: int, form: int, position: int, old: str
) -> tuple[bool, None, str]:
    """VAL_STRG: so many characters from a position on, to the right; blanks if they are too few."""
    source = types[0]
    width = size or 0
    if form > 7 or position < 1 or width > 254:
        return False, None, old
    fits, text = _written(value, source, digits, form)
    if width and len(text) > width:
        fits, text = False, " " * width
    text = text.rjust(width)
    head = old[: position - 1].ljust(position - 1)
    return fits, None, head + text + old[position - 1 + len(text) :]


def _written(value: float, source: str, digits: int, form: int) -> tuple[bool, str]:
    if source in _REAL_DIGITS and not math.isfinite(value):
        return False, "NaN" if math.isnan(value) else f"{'-' if value < 0 else '+'}INF"
    sign = "-" if value < 0 else "+" if form & _PLUS else ""
    comma = "," if form & _COMMA else "."
    if source not in _REAL_DIGITS:
        body = str(abs(int(value))).rjust(digits + 1, "0")
        return True, sign + (f"{body[:-digits]}{comma}{body[-digits:]}" if digits else body)
    places = min(digits, _REAL_DIGITS[source])
    if form & _EXPONENT:
        mantissa, _, exponent = f"{abs(value):.{places}E}".partition("E")
        return digits == places, f"{sign}{mantissa.replace('.', comma)}E{int(exponent)}"
    return digits == places, sign + f"{abs(value):.{places}f}".replace(".", comma)
