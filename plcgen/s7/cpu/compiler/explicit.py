"""Generated code of explicit conversions, ``A_TO_B``."""

from __future__ import annotations

from plcgen.s7.cpu.compiler.values import wrapped
from plcgen.s7.cpu.type_rules import BITS, CLOCKS, DURATIONS, REALS, STAMPS, TEXTS, WIDTHS

_MOMENTS = DURATIONS | CLOCKS | STAMPS
_TIMES = frozenset({"TIME", "LTIME", "DATE", "TIME_OF_DAY", "LTIME_OF_DAY", "LDT"})


def convert_code(code: str, source: str, target: str, *, classic: bool = False) -> str:
    """Generated code of an explicit conversion; ``classic`` is about numbers as text."""
    form = "_v5" if classic else ""
    if source == "BOOL":
        return f"(1.0 if {code} else 0.0)" if target in REALS else f"(1 if {code} else 0)"
    if target == "BOOL":
        return f"({code}&1)" if source not in REALS else f"({code}!=0.0)"
    if source in TEXTS:
        if target in TEXTS:
            return code
        return f"ord(({code}+' ')[0])" if target in {"CHAR", "WCHAR"} else f"text_to{form}({code},{target!r})"
    if target in TEXTS:
        return f"chr({code})" if source in {"CHAR", "WCHAR"} else f"to_text{form}({code},{source!r})"
    if source in REALS:
        return _from_real(code, source, target)
    if target in REALS:
        if source in BITS:
            return f"bits_real({code},{BITS[source]})"
        return f"f32(float({code}))" if target == "REAL" else f"float({code})"
    if {source, target} == {"S5TIME", "WORD"}:  # time base and BCD digits as they are
        return code
    if {source, target} == {"S5TIME", "LTIME"}:
        return f"(from_s5({code})*1000000)" if source == "S5TIME" else f"to_s5({code}//1000000)"
    if source == "S5TIME" or target == "S5TIME":
        return f"from_s5({code})" if source == "S5TIME" else f"to_s5({code})"
    if {source, target} & STAMPS and {source, target} <= _MOMENTS:
        return f"moment({code},{source!r},{target!r})"
    if {source, target} & {"TIME", "TIME_OF_DAY"} and {source, target} & {"LTIME", "LTIME_OF_DAY"}:
        code = f"({code}*1000000)" if target.startswith("L") else f"({code}//1000000)"
    return wrapped(code, target) if _may_overflow(source, target) else code


def _may_overflow(source: str, target: str) -> bool:
    """Whether the integer of one type need not be in the range of another."""
    signed = {"SINT", "INT", "DINT", "LINT", "TIME", "LTIME", "LDT"}
    bits = WIDTHS.get(source, 64), WIDTHS.get(target, 64)
    if (source in signed) == (target in signed):
        return bits[1] < bits[0]
    return not (source not in signed and bits[1] > bits[0])


def _from_real(code: str, source: str, target: str) -> str:
    if target in REALS:
        return f"f32({code})" if target == "REAL" else code
    if target in BITS:
        return f"real_bits({code},{WIDTHS[source]})"
    signed = target in {"SINT", "INT", "DINT", "LINT"} or target in _TIMES
    return f"to_int({code},{WIDTHS[target]},{signed},'round')"
