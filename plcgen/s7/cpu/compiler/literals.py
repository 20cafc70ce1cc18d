"""Constants of the source as the values that generated code works with."""

from __future__ import annotations

from functools import lru_cache

from plcgen.s7.cpu.memory import single
from plcgen.s7.cpu.type_rules import INT_CONST, REAL_CONST, TEXT_CONST, WIDTHS
from plcgen.s7.scl.constants import filled, integer
from plcgen.s7.types.data_types import ALIASES, ELEMENTARY, StringType
from plcgen.s7.types.literals import LiteralError, pack_literal, parse_literal

Constant = bool | int | float | str | bytes

_PREFIXES = {
    "B": "BYTE", "W": "WORD", "DW": "DWORD", "LW": "LWORD", "I": "INT", "L": "DINT", "T": "TIME",
    "S5T": "S5TIME", "LT": "LTIME", "D": "DATE", "C": "WORD", **ALIASES,
}  # fmt: skip
_SIGNED_RAW = frozenset({"SINT", "INT", "DINT", "LINT", "TIME", "LTIME", "LDT"})


@lru_cache(maxsize=4096)
def literal_value(text: str, type_name: str) -> Constant | None:
    """Value of a constant written for a type, None if it does not fit it."""
    try:
        if type_name in {"STRING", "WSTRING"}:
            value = parse_literal(text, StringType(type_name, 254 if type_name == "STRING" else 16382))
            return value if isinstance(value, str) else None
        if type_name in {"REAL", "LREAL"}:
            number = parse_literal(text, type_name)
            return float(number) if isinstance(number, int | float) else None
        data = pack_literal(text, type_name)
    except (LiteralError, KeyError):
        return None
    if type_name == "BOOL":
        return bool(data[0])
    if type_name not in WIDTHS:
        return data
    return int.from_bytes(data, signed=type_name in _SIGNED_RAW)


@lru_cache(maxsize=4096)
def classify(text: str, kind: str) -> tuple[str, Constant] | None:
    """Type and value of a literal of the tree; None if it is no constant of the language."""
    if kind == "int":
        value = integer(text)
        return None if value is None else (INT_CONST, value)
    if kind == "real":
        return REAL_CONST, float(text.replace("_", ""))
    if kind == "bool":
        return "BOOL", text.upper() == "TRUE"
    if kind == "string":
        found = literal_value(text, "STRING") or literal_value(text, "WSTRING")
        return (TEXT_CONST, found) if found is not None else (TEXT_CONST, "") if text == "''" else None
    prefix = text.partition("#")[0].upper()
    type_name = _PREFIXES.get(prefix, prefix)
    if type_name not in ELEMENTARY and type_name not in {"STRING", "WSTRING"}:
        return None
    number = filled(text, type_name)
    typed = literal_value(text, type_name) if number is None else number
    return None if typed is None else (type_name, typed)


def source_of(value: Constant) -> str:
    """Python source of a constant."""
    if isinstance(value, float) and value in {float("inf"), float("-inf")}:
        return f"({'-' if value < 0 else ''}inf)"
    text = repr(value)
    return f"({text})" if text.startswith("-") else text


def as_real(value: float, type_name: str) -> float:
    """Round a constant to its type."""
    return single(value) if type_name == "REAL" else float(value)
