"""Conversions: a value as the type that its surroundings want; generated code of explicit ones, ``A_TO_B``."""

from __future__ import annotations

from plcgen.base.diagnostics import Severity
from plcgen.s7.cpu.compiler.context import Context
from plcgen.s7.cpu.compiler.literals import as_real, source_of
from plcgen.s7.cpu.compiler.scope import UNKNOWN, Val, wrapped
from plcgen.s7.cpu.type_rules import (
    BITS,
    CLOCKS,
    DURATIONS,
    INT_CONST,
    INTEGERS,
    NUMBERED,
    REAL_CONST,
    REALS,
    STAMPS,
    TEXT_CONST,
    TEXTS,
    WIDTHS,
    remedy,
    widens,
)
from plcgen.s7.scl import ast
from plcgen.s7.types.data_types import HARDWARE
from plcgen.s7.types.values import RANGES

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
        if target in REALS:
            return f"f32({code})" if target == "REAL" else code
        if target in BITS:
            return f"real_bits({code},{WIDTHS[source]})"
        signed = target in {"SINT", "INT", "DINT", "LINT"} or target in _TIMES
        return f"to_int({code},{WIDTHS[target]},{signed},'round')"
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


def coerce(context: Context, value: Val, target: str, node: ast.Expression) -> str:
    """Code of a value as ``target``; PG821 if there is no implicit conversion, PG824 out of range."""
    source = value.type
    if UNKNOWN in {source, target}:
        return value.code or "0"
    if source == target:
        return value.wrapped
    if target in NUMBERED and value.place is not None and value.place.mem[:1] == "d" and isinstance(node, ast.Name):
        return f"{value.place.mem}.number"
    if source in {INT_CONST, REAL_CONST, TEXT_CONST}:
        return constant_as(context, value, target, node)
    if not widens(source, target, context.rules) and not (target in TEXTS and source in TEXTS):
        shown = source or "a structure"
        text = f"write {source}_TO_{target}(..)" if source in WIDTHS and target in WIDTHS else ""
        text = remedy(source, target, text, context.rules)
        context.error("PG821", f"{shown} is not converted to {target} implicitly", node, text)
        return "0"
    fine = (source, target) in {("TIME", "LTIME"), ("TIME_OF_DAY", "LTIME_OF_DAY")}
    if value.const is not None and (target in TEXTS) == (source in TEXTS) and not fine:
        return constant_as(context, value, target, node)
    code = value.wrapped
    if target in REALS and source in INTEGERS:
        exact = target == "LREAL" or INTEGERS[source] <= WIDTHS["INT"]
        return f"float({code})" if exact else f"f32(float({code}))"
    if fine:
        return f"({code}*1000000)"
    if target in TEXTS:
        return f"chr({code})" if source in {"CHAR", "WCHAR"} else code
    if source in BITS and target in REALS:  # in expressions a bit string counts as an unsigned integer
        return f"f32(float({code}))" if target == "REAL" else f"float({code})"
    return convert_code(code, source, target)


def constant_as(context: Context, value: Val, target: str, node: ast.Expression) -> str:
    """Code of a constant as a type."""
    const = value.const
    if isinstance(const, str):
        if target in TEXTS:
            return repr(const)
        if target in {"CHAR", "WCHAR"} and len(const) == 1:
            return str(ord(const))
        if target in {"CHAR", "WCHAR"} and not const and not context.classic:
            context.error("PG827", f"the soft CPU does not know the code of an empty {target}", node)
            return "0"
    elif isinstance(const, float):
        if target in REALS:
            return source_of(as_real(const, target))
        if target != "BOOL" and widens("REAL", target, context.rules):
            return convert_code(source_of(as_real(const, "REAL")), "REAL", target)
    elif isinstance(const, int):
        number = integer_constant(context, const, target, node)
        if number is not None:
            return number
    context.error("PG821", f"{context.text(node)} is not a valid {target} constant", node)
    return "0"


def integer_constant(context: Context, const: int, target: str, node: ast.Expression) -> str | None:
    """Code of an integer constant as a type, None if the type takes none."""
    if target in REALS:
        return source_of(as_real(float(const), target))
    if target == "BOOL" and const in {0, 1}:
        return "True" if const else "False"
    if target in {"CHAR", "WCHAR"} and not context.rules.checked and context.rules.dialect.is_tia and 0 <= const < 256:
        return str(const)
    if target not in INTEGERS and target not in BITS and target not in HARDWARE and target != "TIME":
        return None
    low, high = RANGES.get(target, (0, 0))
    if target in BITS:
        low = -(1 << BITS[target] - 1)
    if low == 0 and target in INTEGERS and -(high + 1) // 2 <= const < 0 and context.rules.dialect.is_tia:
        # exports of the TIA Portal have it: -1 as a mark in an unsigned variable
        message = f"{context.text(node)} becomes {const + high + 1} in {target} ({low}..{high})"
        context.error("PG824", message, node, "write the value that you mean", Severity.WARNING)
        return source_of(const + high + 1)
    if not low <= const <= high:
        context.error("PG824", f"{context.text(node)} is outside {target} ({low}..{high})", node)
        return "0"
    return source_of(const & (1 << BITS[target]) - 1 if target in BITS else const)


def truth(context: Context, value: Val, node: ast.Expression) -> str:
    """Code of a condition; 1 and 0 are constants of BOOL in the TIA Portal."""
    if value.type == INT_CONST and value.const in {0, 1} and context.rules.dialect.is_tia:
        return "True" if value.const else "False"
    if value.type not in {"BOOL", UNKNOWN}:
        kind = (
            "a number"
            if value.type in {INT_CONST, REAL_CONST}
            else "a text"
            if value.type == TEXT_CONST
            else value.type
        )
        context.error("PG821", f"a condition is BOOL, not {kind or 'a structure'}", node)
        return "0"
    return value.code


def integer_code(value: Val) -> str:
    """Code of an integer that may stand behind a sign or operator."""
    if isinstance(value.const, int) and not isinstance(value.const, bool):
        return source_of(value.const)
    return value.wrapped
