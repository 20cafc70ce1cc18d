"""Type rules of the three targets: families, implicit conversions, the common type of two operands."""

from __future__ import annotations

from functools import cache

from plcgen.s7.types import ALIASES, ELEMENTARY, HARDWARE
from plcgen.s7.values import RANGES
from plcgen.scl.dialect import Dialect

INT_CONST, REAL_CONST, TEXT_CONST = "#int", "#real", "#text"
"""Types of literals that take the type of their surroundings."""

SIGNED = {"SINT": 8, "INT": 16, "DINT": 32, "LINT": 64}
UNSIGNED = {"USINT": 8, "UINT": 16, "UDINT": 32, "ULINT": 64}
BITS = {"BYTE": 8, "WORD": 16, "DWORD": 32, "LWORD": 64}
INTEGERS = {**SIGNED, **UNSIGNED}
REALS = {"REAL": 32, "LREAL": 64}
NUMERIC = frozenset({*INTEGERS, *REALS, INT_CONST, REAL_CONST})
BLOCK_NUMBERS = frozenset({"TIMER", "COUNTER", *(name for name in ELEMENTARY if name.startswith("BLOCK_"))})
NUMBERED = frozenset({"BLOCK_DB", "DB_ANY"})
"""Types whose value is the number of a data block."""
DURATIONS = frozenset({"TIME", "LTIME"})
TEXTS = frozenset({"STRING", "WSTRING"})
POINTERS = frozenset({"ANY", "POINTER", "VARIANT"})
WIDTHS = {**INTEGERS, **BITS, **REALS, "TIME": 32, "DATE": 16, "TIME_OF_DAY": 32, "S5TIME": 16, "CHAR": 8}
WIDTHS |= {"WCHAR": 16, "LTIME": 64, "LTIME_OF_DAY": 64, "LDT": 64} | {
    name: ELEMENTARY[name].bits for name in HARDWARE | BLOCK_NUMBERS
}
SIGNED_WIDTHS = {**SIGNED, "TIME": 32, "LTIME": 64, "LDT": 64}
"""Types whose memory is read with a sign."""

_CLASSIC = {
    "BYTE": {"WORD", "DWORD"},
    "WORD": {"DWORD"},
    "INT": {"DINT", "REAL"},
    "CHAR": {"STRING"},
}


@cache
def widening(*, classic: bool) -> dict[str, frozenset[str]]:
    """Return the implicit conversions of a target with IEC check, by source type."""
    if classic:
        return {source: frozenset(targets) for source, targets in _CLASSIC.items()}
    table: dict[str, set[str]] = {"TIME": {"LTIME"}, "CHAR": {"STRING"}, "WCHAR": {"WSTRING"}, "REAL": {"LREAL"}}
    table["TIME_OF_DAY"] = {"LTIME_OF_DAY"}
    for family in (BITS, SIGNED, UNSIGNED):
        for source, bits in family.items():
            table[source] = {target for target, wider in family.items() if wider > bits}
    for source, bits in UNSIGNED.items():
        table[source] |= {target for target, wider in SIGNED.items() if wider > bits}
    for source, bits in INTEGERS.items():
        table[source] |= {target for target, mantissa in (("REAL", 16), ("LREAL", 32)) if bits <= mantissa}
    table["UINT"] |= HARDWARE
    table["WORD"] |= HARDWARE
    for name in HARDWARE:
        table[name] = {"UINT", "WORD", "DWORD", "UDINT", *HARDWARE}
    return {source: frozenset(targets) for source, targets in table.items()}


def widens(source: str, target: str, *, classic: bool) -> bool:
    """Whether a value of ``source`` may stand where ``target`` is wanted."""
    return source == target or target in widening(classic=classic).get(source, ())


_PATTERNS = frozenset({*INTEGERS, *BITS})
_UNCHECKED_CLASSIC = frozenset(
    {("BYTE", "DINT"), ("BYTE", "CHAR"), ("WORD", "BYTE"), ("WORD", "INT"), ("WORD", "DINT"), ("WORD", "S5TIME"),
     ("WORD", "DATE"), ("DWORD", "BYTE"), ("DWORD", "WORD"), ("DWORD", "DINT"), ("DWORD", "TIME"),
     ("DWORD", "TIME_OF_DAY"), ("INT", "WORD"), ("DINT", "DWORD"), ("DINT", "TIME"), ("TIME", "DWORD"),
     ("TIME", "DINT"), ("S5TIME", "WORD"), ("DATE", "WORD")}
)  # fmt: skip
_UNCHECKED = frozenset(
    {("DWORD", "REAL"), ("LWORD", "LREAL"), ("REAL", "DWORD"), ("LREAL", "LWORD"), ("LREAL", "REAL"),
     ("WORD", "S5TIME"), ("S5TIME", "WORD"), ("LTIME", "TIME"), ("TIME", "TIME_OF_DAY"), ("TIME_OF_DAY", "TIME"),
     *((name, "DATE") for name in ("WORD", "INT", "UINT")), *(("DATE", name) for name in ("WORD", "INT", "UINT")),
     *((name, real) for name in ("DINT", "UDINT", "LINT", "ULINT") for real in REALS),
     *((real, name) for name in INTEGERS for real in REALS),
     *((name, text) for name in _PATTERNS for text in ("CHAR", "WCHAR")),
     *((name, time) for name in ("DWORD", "DINT", "UDINT") for time in ("TIME", "TIME_OF_DAY")),
     *((time, name) for name in ("DWORD", "DINT", "UDINT") for time in ("TIME", "TIME_OF_DAY")),
     *((name, "LTIME") for name in ("LWORD", "LINT", "ULINT")),
     *(("LTIME", name) for name in ("LWORD", "LINT", "ULINT"))}
)  # fmt: skip


def remedy(source: str, target: str, text: str, dialect: Dialect) -> str:
    """Help about a refused conversion; with a word when only the IEC check of a block forbids it.

    The IEC check is a property of the block that a source does not carry (help of the TIA Portal, "Implicit
    conversions"), so the stricter rule holds.
    """
    new = dialect is Dialect.TIA_1200_1500
    off = (source, target) in (_UNCHECKED if new else _UNCHECKED_CLASSIC) or (new and {source, target} <= _PATTERNS)
    return f"{text}; without IEC check the TIA Portal converts on its own" if dialect.is_tia and off else text


def common_type(left: str, right: str, *, classic: bool) -> str | None:
    """Type in which two operands meet; None if they have none."""
    if left == right:
        return left
    if right in {INT_CONST, REAL_CONST, TEXT_CONST}:
        return _with_constant(left, right)
    if left in {INT_CONST, REAL_CONST, TEXT_CONST}:
        return _with_constant(right, left)
    table = widening(classic=classic)
    if right in table.get(left, ()):
        return right
    if left in table.get(right, ()):
        return left
    shared = table.get(left, frozenset()) & table.get(right, frozenset())
    return min(shared, key=lambda name: (WIDTHS.get(name, 99), name in REALS), default=None)


def _with_constant(type_: str, constant: str) -> str | None:
    if constant == INT_CONST and type_ == "BOOL":
        return type_
    if constant == INT_CONST:
        fits = type_ in INTEGERS or type_ in BITS or type_ in REALS or type_ in HARDWARE or type_ in BLOCK_NUMBERS
        return type_ if fits or type_ in {REAL_CONST, INT_CONST} else None
    if constant == REAL_CONST:
        return type_ if type_ in REALS else REAL_CONST if type_ == INT_CONST else "REAL" if type_ in INTEGERS else None
    return type_ if type_ in TEXTS or type_ in {"CHAR", "WCHAR", TEXT_CONST} else None


def canonical(name: str) -> str:
    """Canonical spelling of an elementary type name."""
    upper = name.upper()
    return ALIASES.get(upper, upper)


def limits(type_: str) -> tuple[int, int] | None:
    """Range of an integer or bit string type."""
    return RANGES.get(type_)


_CLASSIC_CONVERSIONS = {
    "BOOL": "BYTE WORD DWORD INT DINT",
    "BYTE": "BOOL WORD DWORD INT DINT CHAR",
    "WORD": "BOOL BYTE DWORD INT DINT BLOCK_DB",
    "DWORD": "BOOL BYTE WORD INT DINT REAL",
    "INT": "BOOL BYTE WORD DWORD DINT REAL CHAR STRING",
    "DINT": "BOOL BYTE WORD DWORD INT REAL TIME TIME_OF_DAY DATE STRING",
    "REAL": "INT DINT DWORD STRING",
    "CHAR": "BYTE INT STRING",
    "STRING": "CHAR INT DINT REAL",
    "TIME": "DINT S5TIME",
    "S5TIME": "TIME",
    "TIME_OF_DAY": "DINT",
    "DATE": "DINT",
    "DATE_AND_TIME": "DATE TIME_OF_DAY",
    "BLOCK_DB": "WORD",
}


_STAMPS = ("DATE", "TIME_OF_DAY", "LTIME_OF_DAY", "DATE_AND_TIME", "LDT", "DTL")
NOT_EXECUTED = frozenset(
    {("STRING", "WSTRING"), ("WSTRING", "STRING"), ("CHAR", "WCHAR"), ("WCHAR", "CHAR"), ("STRING", "CHAR"),
     ("WCHAR", "WSTRING"), ("WSTRING", "WCHAR"), *((name, "WSTRING") for name in (*INTEGERS, *REALS)),
     *(("WSTRING", name) for name in (*INTEGERS, *REALS)),
     *((source, target) for source in ("DTL", "LDT", "DATE_AND_TIME") for target in _STAMPS if source != target)}
)  # fmt: skip
"""Conversions of the S7-1200/1500 that the soft CPU does not have."""


@cache
def conversions(*, classic: bool) -> frozenset[tuple[str, str]]:
    """Every ``A_TO_B`` function of a target as a pair of canonical type names."""
    pairs = {(source, target) for source, row in _CLASSIC_CONVERSIONS.items() for target in row.split()}
    if not classic:
        scalars = [*INTEGERS, *BITS, *REALS, "BOOL"]
        pairs |= {(source, target) for source in scalars for target in scalars if source != target}
        pairs |= {(source, "STRING") for source in (*INTEGERS, *REALS)} | {("STRING", name) for name in scalars[:8]}
        pairs |= {(name, "CHAR") for name in (*INTEGERS, *BITS)} | {("CHAR", name) for name in (*INTEGERS, *BITS)}
        times = ("TIME", "TIME_OF_DAY", "DATE", "LTIME", "LTIME_OF_DAY", "LDT", "S5TIME")
        pairs |= {(source, target) for source in times for target in (*INTEGERS, *BITS)}
        pairs |= {(source, target) for source in (*INTEGERS, *BITS) for target in times}
        pairs |= {("TIME", "LTIME"), ("LTIME", "TIME"), ("TIME", "S5TIME"), ("S5TIME", "TIME")}
        pairs |= {("UINT", name) for name in HARDWARE} | {(name, "UINT") for name in HARDWARE}
        pairs |= {("WORD", name) for name in HARDWARE} | {(name, "WORD") for name in HARDWARE}
    return frozenset(pairs)
