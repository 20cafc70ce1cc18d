"""Type rules of the three targets: families, implicit conversions, the common type of two operands."""

from __future__ import annotations

import enum
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

from plcgen.s7.scl.dialect import Dialect
from plcgen.s7.types.data_types import ALIASES, ELEMENTARY, HARDWARE


class IecCheck(enum.StrEnum):
    """IEC check of the blocks about which nothing is stated: on, off, or as the tool sets it that compiles them."""

    ON = "on"
    OFF = "off"
    AS_STATED = "as-stated"


INT_CONST, REAL_CONST, TEXT_CONST = "#int", "#real", "#text"
"""Types of literals that take the type of their surroundings."""
TYPE_NAME = "#type"
"""Type of what TypeOf gives, and of the name of a type beside it."""

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
CLOCKS = frozenset({"DATE", "TIME_OF_DAY", "LTIME_OF_DAY"})
"""A day, or the time of one."""
TEXTS = frozenset({"STRING", "WSTRING"})
STAMPS = frozenset({"DATE_AND_TIME", "LDT", "DTL"})
"""Date and time of day together."""
POINTERS = frozenset({"ANY", "POINTER", "VARIANT"})
WIDTHS = {**INTEGERS, **BITS, **REALS, "TIME": 32, "DATE": 16, "TIME_OF_DAY": 32, "S5TIME": 16, "CHAR": 8}
WIDTHS |= {"WCHAR": 16, "LTIME": 64, "LTIME_OF_DAY": 64, "LDT": 64} | {
    name: ELEMENTARY[name].bits for name in HARDWARE | BLOCK_NUMBERS
}
SIGNED_WIDTHS = {**SIGNED, "TIME": 32, "LTIME": 64, "LDT": 64}
"""Types whose memory is read with a sign."""

_CLASSIC = {
    "BYTE": "WORD DWORD",
    "WORD": "DWORD",
    "INT": "DINT REAL",
    "CHAR": "STRING",
}
_ALWAYS_IN_SCL = {"BOOL": "BYTE WORD DWORD", "DINT": "REAL"}
"""S7-SCL V5, conversion functions of class A; Berger, "Automating with SIMATIC S7-300 inside TIA Portal", table 13.8.

The help of the TIA Portal has them neither with nor without IEC check.
"""
_UNCHECKED_CLASSIC = {
    "BYTE": "INT DINT CHAR",
    "WORD": "BYTE INT DINT S5TIME DATE",
    "DWORD": "BYTE WORD DINT TIME TIME_OF_DAY",
    "INT": "WORD",
    "DINT": "DWORD TIME",
    "TIME": "DWORD DINT",
    "S5TIME": "WORD",
    "DATE": "WORD",
    "TIME_OF_DAY": "DWORD",
    "CHAR": "BYTE",
}
"""Help of the TIA Portal, "Implicit conversions (S7-300, S7-400)".

Its table has BYTE to DINT and not BYTE to INT; its overview says of SCL that bit strings go into every type that is no
shorter and no floating-point number.
"""
_STAMPS_CHECKED = {"DATE_AND_TIME": "LDT DTL", "LDT": "DTL", "DTL": "LDT"}
_UNCHECKED = {
    "WORD": "S5TIME DATE",
    "DWORD": "REAL TIME TIME_OF_DAY",
    "LWORD": "LREAL LTIME LDT LTIME_OF_DAY",
    "INT": "DATE",
    "UINT": "DATE",
    "DINT": "REAL TIME TIME_OF_DAY",
    "UDINT": "REAL TIME TIME_OF_DAY",
    "LINT": "REAL LREAL LTIME LDT LTIME_OF_DAY",
    "ULINT": "REAL LREAL LTIME LDT LTIME_OF_DAY",
    "REAL": "DWORD SINT USINT INT UINT DINT UDINT LINT ULINT",
    "LREAL": "LWORD SINT USINT INT UINT DINT UDINT LINT ULINT REAL",
    "S5TIME": "WORD",
    "TIME": "DWORD DINT UDINT TIME_OF_DAY",
    "LTIME": "LWORD LINT ULINT TIME LDT LTIME_OF_DAY",
    "LDT": "LWORD LINT ULINT LTIME DATE_AND_TIME",
    "DTL": "DATE_AND_TIME",
    "DATE": "WORD INT UINT",
    "TIME_OF_DAY": "DWORD DINT UDINT TIME",
    "LTIME_OF_DAY": "LWORD LINT ULINT LTIME TIME_OF_DAY",
    "STRING": "CHAR",
    "WSTRING": "WCHAR",
}
"""Beyond bit strings, integers and characters, which go into each other.

Source of these tables: help of the TIA Portal, "Implicit conversions", columns "With" and "Without IEC check".
"""
_PATTERNS = frozenset({*INTEGERS, *BITS})


@dataclass(frozen=True, slots=True)
class TypeRules:
    """What a block may mix: the target that compiles it, and whether its IEC check is on.

    The IEC check is a property of a block of the TIA Portal; STEP 7 V5 has none, there ``checked`` means nothing.
    """

    dialect: Dialect
    checked: bool

    @property
    def classic(self) -> bool:
        """Whether the target is an S7-300/400."""
        return self.dialect.classic

    @classmethod
    def of(cls, dialect: Dialect, check: IecCheck = IecCheck.AS_STATED, *, stated: bool | None = None) -> TypeRules:
        """Rules of one block: what is ``stated`` about it, otherwise ``check`` of all blocks.

        Where nothing is said, the check is on for S7-1200/1500 and off for S7-300/400.

        Source of the default: help of the TIA Portal, "Overview of data type conversion" of both families.
        """
        if stated is not None:
            return cls(dialect, stated)
        if check is not IecCheck.AS_STATED:
            return cls(dialect, check is IecCheck.ON)
        return cls(dialect, not dialect.classic)


@cache
def widening(rules: TypeRules) -> dict[str, frozenset[str]]:
    """Return the implicit conversions under some rules, by source type."""
    if rules.dialect is Dialect.STEP7_V5:
        return _joined(_CLASSIC, _ALWAYS_IN_SCL)
    if rules.classic:
        return _joined(_CLASSIC) if rules.checked else _joined(_CLASSIC, _ALWAYS_IN_SCL, _UNCHECKED_CLASSIC)
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
    if rules.checked:
        return _joined(table, _STAMPS_CHECKED)
    for name in _PATTERNS:
        table[name] |= _PATTERNS | {"CHAR", "WCHAR"}
    for name in ("CHAR", "WCHAR"):
        table[name] |= _PATTERNS
    return _joined(table, _STAMPS_CHECKED, _UNCHECKED)


def _joined(*tables: Mapping[str, str | set[str]]) -> dict[str, frozenset[str]]:
    """Put tables together whose rows are sets, or names with blanks between them."""
    found: dict[str, set[str]] = {}
    for table in tables:
        for source, targets in table.items():
            found.setdefault(source, set()).update(targets.split() if isinstance(targets, str) else targets)
    return {source: frozenset(targets - {source}) for source, targets in found.items()}


def widens(source: str, target: str, rules: TypeRules) -> bool:
    """Whether a value of ``source`` may stand where ``target`` is wanted."""
    return source == target or target in widening(rules).get(source, ())


def remedy(source: str, target: str, text: str, rules: TypeRules) -> str:
    """Help about a refused conversion; with a word when only the IEC check of the block forbids it."""
    unchecked = TypeRules(rules.dialect, checked=False)
    if not rules.dialect.is_tia or not rules.checked or not widens(source, target, unchecked):
        return text
    return f"{text}; without IEC check the TIA Portal converts on its own (--iec-check off)"


def common_type(left: str, right: str, rules: TypeRules) -> str | None:
    """Type in which two operands meet; None if they have none."""
    if left == right:
        return left
    for type_, constant in ((left, right), (right, left)):
        if constant in {INT_CONST, REAL_CONST, TEXT_CONST}:
            if constant == INT_CONST and type_ in DURATIONS and not rules.checked and rules.dialect.is_tia:
                return type_
            if constant == INT_CONST and type_ == "BOOL":
                return type_
            if constant == INT_CONST:
                fits = (
                    type_ in INTEGERS or type_ in BITS or type_ in REALS or type_ in HARDWARE or type_ in BLOCK_NUMBERS
                )
                return type_ if fits or type_ in {REAL_CONST, INT_CONST} else None
            if constant == REAL_CONST:
                return (
                    type_
                    if type_ in REALS
                    else REAL_CONST
                    if type_ == INT_CONST
                    else "REAL"
                    if type_ in INTEGERS
                    else None
                )
            return type_ if type_ in TEXTS or type_ in {"CHAR", "WCHAR", TEXT_CONST} else None
    table = widening(rules)
    ways = right in table.get(left, ()), left in table.get(right, ())
    if all(ways):
        return _wider(left, right)
    if any(ways):
        return right if ways[0] else left
    shared = table.get(left, frozenset()) & table.get(right, frozenset())
    return min(shared, key=lambda name: (WIDTHS.get(name, 99), name in REALS), default=None)


def _wider(left: str, right: str) -> str:
    """Of two types that go into each other without IEC check, the one that an expression computes in.

    A bit string counts as the unsigned integer of its width; a signed and an unsigned integer meet in the next signed
    one that has room for both (help of the TIA Portal, "Arithmetic expressions").
    """
    for name, other in ((left, right), (right, left)):
        if name in REALS or (name not in _PATTERNS and other in _PATTERNS):
            return name if other not in REALS or REALS.get(name, 0) >= REALS[other] else other
    if {left, right} <= BITS.keys():
        return max(left, right, key=BITS.__getitem__)
    if not {left, right} <= _PATTERNS:
        return max(left, right, key=lambda name: WIDTHS.get(name, 0))
    unsigned = {bits: name for name, bits in UNSIGNED.items()}
    kinds = {unsigned[BITS[name]] if name in BITS else name for name in (left, right)}
    if len(kinds & SIGNED.keys()) == 1 and len(kinds) > 1:
        bits = max(max(SIGNED.get(name, 0), 2 * UNSIGNED.get(name, 0)) for name in kinds)
        return next((name for name, width in SIGNED.items() if width >= bits), "LINT")
    return max(kinds, key=INTEGERS.__getitem__)


def bit_string(type_: str) -> str:
    """Bit string as wide as an integer."""
    return next(name for name, bits in BITS.items() if bits == WIDTHS[type_])


def integer_of(type_: str, *, classic: bool) -> str:
    """Integer that a bit string counts as in an arithmetic expression: unsigned, or one with a sign that has room."""
    if classic:
        return "INT" if type_ in {"BYTE", "WORD"} else "DINT"
    return next(name for name, bits in UNSIGNED.items() if bits == BITS[type_])


def common_bits(left: str, right: str, rules: TypeRules) -> str | None:
    """Type in which AND, OR and XOR join two operands; without IEC check integers count as bit strings."""
    common = common_type(left, right, rules)
    if rules.checked or rules.dialect is Dialect.STEP7_V5 or common in BITS or common in {"BOOL", None}:
        return common
    widths = [WIDTHS[name] for name in (left, right) if name in _PATTERNS]
    if len(widths) < sum(name != INT_CONST for name in (left, right)):
        return None
    return next((name for name, bits in BITS.items() if widths and bits == max(widths)), None)


def canonical(name: str) -> str:
    """Canonical spelling of an elementary type name."""
    upper = name.upper()
    return ALIASES.get(upper, upper)


_CLASSIC_CONVERSIONS = {
    "BOOL": "BYTE WORD DWORD INT DINT",
    "BYTE": "BOOL WORD DWORD INT DINT CHAR",
    "WORD": "BOOL BYTE DWORD INT DINT CHAR S5TIME BLOCK_DB",
    "DWORD": "BOOL BYTE WORD INT DINT REAL",
    "INT": "BOOL BYTE WORD DWORD DINT REAL CHAR STRING",
    "DINT": "BOOL BYTE WORD DWORD INT REAL TIME TIME_OF_DAY DATE STRING CHAR",
    "REAL": "INT DINT DWORD STRING",
    "CHAR": "BYTE INT STRING",
    "STRING": "CHAR INT DINT REAL",
    "TIME": "DINT S5TIME",
    "S5TIME": "TIME WORD",
    "TIME_OF_DAY": "DINT DWORD",
    "DATE": "DINT INT WORD",
    "DATE_AND_TIME": "DATE TIME_OF_DAY",
    "BLOCK_DB": "WORD",
}


_STAMPS = ("DATE", "TIME_OF_DAY", "LTIME_OF_DAY", "DATE_AND_TIME", "LDT", "DTL")
_CLOCKS = {("TIME", "TIME_OF_DAY"), ("LTIME", "LTIME_OF_DAY"), ("LTIME", "LDT"), ("DATE", "LDT")}
_MODERN_CONVERSIONS = frozenset(
    {("STRING", "WSTRING"), ("WSTRING", "STRING"), ("CHAR", "WCHAR"), ("WCHAR", "CHAR"), ("STRING", "CHAR"),
     ("WCHAR", "WSTRING"), ("WSTRING", "WCHAR"), *((name, "WSTRING") for name in (*INTEGERS, *REALS)),
     *(("WSTRING", name) for name in (*INTEGERS, *REALS)),
     *((source, target) for source in ("DTL", "LDT", "DATE_AND_TIME") for target in _STAMPS if source != target),
     *((source, target) for source in _STAMPS for target in ("DTL", "LDT", "DATE_AND_TIME") if source != target),
     *_CLOCKS, *((target, source) for source, target in _CLOCKS), ("LTIME", "S5TIME"), ("S5TIME", "LTIME"),
     ("TIME_OF_DAY", "LTIME_OF_DAY"), ("LTIME_OF_DAY", "TIME_OF_DAY"), ("STRING", "ULINT"), ("STRING", "LREAL"),
     *((name, "WCHAR") for name in (*INTEGERS, *BITS)), *(("WCHAR", name) for name in (*INTEGERS, *BITS))}
)  # fmt: skip
"""Conversions of texts, dates and times of the S7-1200/1500 (help of the TIA Portal, "Explicit conversion")."""


@cache
def conversions(*, classic: bool) -> frozenset[tuple[str, str]]:
    """Every ``A_TO_B`` function of a target as a pair of canonical type names."""
    pairs = {(source, target) for source, row in _CLASSIC_CONVERSIONS.items() for target in row.split()}
    if not classic:
        scalars = [*INTEGERS, *BITS, *REALS, "BOOL"]
        pairs |= {(source, target) for source in scalars for target in scalars if source != target}
        pairs |= {(source, "STRING") for source in (*INTEGERS, *REALS)} | {("STRING", name) for name in scalars[:8]}
        pairs |= {(name, "CHAR") for name in (*INTEGERS, *BITS)} | {("CHAR", name) for name in (*INTEGERS, *BITS)}
        times = ("TIME", "TIME_OF_DAY", "DATE", "LTIME", "LTIME_OF_DAY", "LDT")
        pairs |= {(source, target) for source in times for target in (*INTEGERS, *BITS)}
        pairs |= {(source, target) for source in (*INTEGERS, *BITS) for target in times}
        pairs |= {("TIME", "LTIME"), ("LTIME", "TIME"), ("TIME", "S5TIME"), ("S5TIME", "TIME")}
        pairs |= {("WORD", "S5TIME"), ("S5TIME", "WORD")}
        pairs |= {("UINT", name) for name in HARDWARE} | {(name, "UINT") for name in HARDWARE}
        pairs |= {("WORD", name) for name in HARDWARE} | {(name, "WORD") for name in HARDWARE}
        pairs |= _MODERN_CONVERSIONS
    return frozenset(pairs)
