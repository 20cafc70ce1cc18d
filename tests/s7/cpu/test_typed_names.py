"""Functions with their type behind the name: every name with every type, against values worked out by hand."""

import datetime as dt
import math

import pytest

from plcgen.base.diagnostics import DiagnosticError
from plcgen.s7.cpu.compiler.functions import _TYPES
from plcgen.s7.cpu.testing import load_scl

NARROW = {"BYTE": "Byte", "WORD": "Byte", "DWORD": "Word", "LWORD": "Byte"}
NARROW |= {"SINT": "SInt", "INT": "SInt", "DINT": "Int", "LINT": "DInt"}
NARROW |= {"USINT": "USInt", "UINT": "USInt", "UDINT": "UInt", "ULINT": "UDInt", "REAL": "Real", "LREAL": "Real"}
"""A type that goes into the one of the function on its own, and is narrower where there is one."""
BITS = {"BYTE": 8, "WORD": 16, "DWORD": 32, "LWORD": 64, "USINT": 8, "UINT": 16, "UDINT": 32, "ULINT": 64}
SIGNED = {"SINT": 8, "INT": 16, "DINT": 32, "LINT": 64}
TIMES = {
    "TIME": ("T#1s", "T#2s", 2000), "LTIME": ("LT#1s", "LT#2s", 2_000_000_000),
    "TIME_OF_DAY": ("TOD#0:0:1", "TOD#0:0:2", 2000), "LTIME_OF_DAY": ("LTOD#0:0:1", "LTOD#0:0:2", 2_000_000_000),
    "LDT": ("LDT#1970-01-01-0:0:1", "LDT#1970-01-01-0:0:2", 2_000_000_000),
    "DTL": ("DTL#1970-01-01-00:00:01", "DTL#1970-01-01-00:00:02", 2_000_000_000),
}  # fmt: skip
OTHERS = {
    "BOOL": ("FALSE", "TRUE", True), "CHAR": ("'a'", "'b'", "b"), "WCHAR": ("WCHAR#'a'", "WCHAR#'b'", "b"),
    "STRING": ("'a'", "'b'", "b"), "WSTRING": ("WSTRING#'a'", "WSTRING#'b'", "b"),
}  # fmt: skip


def value_of(call, type_, inputs):
    """What the call gives, with variables and their start values."""
    declared = "".join(f"{name} : {kind} := {start};\n" for name, (kind, start) in inputs.items())
    text = (
        f'FUNCTION_BLOCK "T"\nVAR\ny : {type_};\n{declared}END_VAR\nBEGIN\n#y := {call};\nEND_FUNCTION_BLOCK\n'
        'DATA_BLOCK "D"\n"T"\nBEGIN\nEND_DATA_BLOCK\n'
    )
    bench = load_scl(text, iec_check="on")
    bench.call("D")
    return bench.cpu["D.y"]


def shifted(name, type_):
    """Of C7h, or -57 with a sign, by 4: the type has room for the digits that a byte loses."""
    if type_ in SIGNED:
        bits = SIGNED[type_]
        pattern = -57 & (1 << bits) - 1
    else:
        bits, pattern = BITS[type_], 0xC7
    full = (1 << bits) - 1
    ring = {"ROL": pattern << 4 | pattern >> bits - 4, "ROR": pattern >> 4 | pattern << bits - 4}
    if name in ring:
        result = ring[name] & full
    elif name == "SHL":
        result = pattern << 4 & full
    else:
        result = -57 // 16 & full if type_ in SIGNED else pattern >> 4
    return result - (1 << bits) if type_ in SIGNED and result >> bits - 1 else result


ROWS = [
    *((f"{name}_{type_}", type_, "IN := #x, N := 4", {"x": (NARROW[type_], "-57" if type_ in SIGNED else "16#C7")},
       shifted(name, type_))
      for name in ("SHL", "SHR", "ROL", "ROR") for type_ in (*BITS, *SIGNED)),
    ("SHL_WORD", "WORD", "IN := #x, N := 8", {"x": ("Byte", "16#C7")}, 0xC700),
    *((f"SWAP_{type_}", type_, "#x", {"x": (NARROW[type_], "16#C7")}, value)
      for type_, value in (("WORD", 0xC700), ("DWORD", 0xC7000000), ("LWORD", 0xC7 << 56))),
    ("ABS_INT", "INT", "#x", {"x": ("SInt", "-128")}, 128), ("ABS_DINT", "DINT", "#x", {"x": ("Int", "-32768")}, 32768),
    ("ABS_LINT", "LINT", "#x", {"x": ("DInt", "-2147483648")}, 2147483648),
    ("ABS_SINT", "SINT", "#x", {"x": ("SInt", "-5")}, 5), ("ABS_REAL", "REAL", "#x", {"x": ("Int", "-5")}, 5.0),
    ("ABS_LREAL", "LREAL", "#x", {"x": ("Real", "-1.5")}, 1.5),
    *((f"{name}_{type_}", type_, arguments, {"x": (NARROW[type_], "5"), "z": (type_, "7")}, value)
      for type_ in (*BITS, *SIGNED, "REAL", "LREAL") if type_ not in {"BYTE", "WORD", "DWORD", "LWORD"}
      for name, arguments, value in (("MIN", "IN1 := #x, IN2 := #z", 5), ("MAX", "IN1 := #x, IN2 := #z", 7),
                                     ("LIMIT", "MN := #z, IN := #x, MX := 9", 7))),
    *((f"{name}_{type_}", type_, arguments, {"x": (NARROW[type_], "5"), "z": (type_, "7")}, 5)
      for type_ in (*BITS, *SIGNED, "REAL", "LREAL")
      for name, arguments in (("SEL", "G := FALSE, IN0 := #x, IN1 := #z"), ("MUX", "K := 0, IN0 := #x, IN1 := #z"))),
    *((f"{name}_{type_}", type_, arguments, {"x": (type_, low), "z": (type_, high)}, value)
      for type_, (low, high, value) in TIMES.items()
      for name, arguments in (("MAX", "IN1 := #x, IN2 := #z"), ("LIMIT", "MN := #x, IN := #z, MX := #z"),
                              ("SEL", "G := TRUE, IN0 := #x, IN1 := #z"))),
    *((f"{name}_{type_}", type_, arguments, {"x": (type_, low), "z": (type_, high)}, value)
      for type_, (low, high, value) in OTHERS.items()
      for name, arguments in (("SEL", "G := TRUE, IN0 := #x, IN1 := #z"), ("MUX", "K := 1, IN0 := #x, IN1 := #z"))),
    *((f"{name}_{type_}", type_, "#x", {"x": ("Real", "2.5")}, value)
      for type_ in (*SIGNED, "USINT", "UINT", "UDINT", "ULINT", "REAL", "LREAL")
      for name, value in (("ROUND", 2), ("TRUNC", 2), ("FLOOR", 2), ("CEIL", 3))),
    *((f"{name}_{type_}", type_, "#x", {"x": ("LReal", "1.0E30")}, value)
      for name in ("ROUND", "TRUNC", "FLOOR", "CEIL")
      for type_, value in (("LREAL", 1e30), ("REAL", 1.0000000150474662e30), ("DINT", -2147483648))),
    ("CEIL_REAL", "REAL", "#x", {"x": ("Real", "0.5")}, 1.0),
    ("FLOOR_REAL", "REAL", "#x", {"x": ("Real", "-0.5")}, -1.0),
    ("TRUNC_SINT", "SINT", "#x", {"x": ("Real", "2.4")}, 2),
    *((f"{name}_LREAL", "LREAL", "#x", {"x": ("Real", "0.5")}, wanted)
      for name, wanted in (
          ("SQR", 0.25), ("SQRT", math.sqrt(0.5)), ("EXP", math.exp(0.5)), ("EXPD", math.pow(10, 0.5)),
          ("LN", math.log(0.5)), ("LOG", math.log10(0.5)), ("SIN", math.sin(0.5)), ("COS", math.cos(0.5)),
          ("TAN", math.tan(0.5)), ("ASIN", math.asin(0.5)), ("ACOS", math.acos(0.5)), ("ATAN", math.atan(0.5)),
          ("FRAC", 0.5))),
]  # fmt: skip


@pytest.mark.parametrize("row", ROWS, ids=[f"{number}-{row[0]}" for number, row in enumerate(ROWS)])
def test_the_type_is_that_of_what_is_computed(row):
    """A narrower operand is converted before: no digit is lost that the type of the function has room for."""
    name, type_, arguments, inputs, wanted = row
    assert value_of(f"{name}({arguments})", type_, inputs) == wanted


def test_every_name_is_tried():
    """Every function that takes a type is in the rows, with every type but REAL of those that compute in LREAL too."""
    tried = {row[0] for row in ROWS}
    listed = {f"{name}_{type_}" for name, types in _TYPES.items() for type_ in types}
    left = {name for name in listed - tried if not name.endswith("_REAL")}
    assert left <= {
        f"{name}_{type_}" for name in ("MIN", "MAX", "LIMIT", "SEL", "MUX") for type_ in (*TIMES, "DATE")
    } | {f"{name}_DATE_AND_TIME" for name in ("MIN", "MAX", "LIMIT", "SEL", "MUX")}


@pytest.mark.parametrize("call", ["SHL_REAL(IN := #x, N := 1)", "ABS_WORD(#x)", "SIN_INT(#x)", "SWAP_BYTE(#x)"])
def test_no_function_of_that_type(call):
    """A name with a type that the function does not take is no function."""
    with pytest.raises(DiagnosticError, match="PG821"):
        value_of(call, "Int", {"x": ("Int", "1")})


def test_stamps_compare_as_dates():
    """DATE_AND_TIME counts 90 before 10 in its bytes: MIN and MAX go by the date."""
    stamps = {"x": ("Date_And_Time", "DT#1995-01-01-0:0:0"), "z": ("Date_And_Time", "DT#2010-01-01-0:0:0")}
    assert value_of("MIN(IN1 := #x, IN2 := #z)", "Date_And_Time", stamps) == dt.datetime.fromisoformat("1995-01-01")
    assert value_of("MAX(IN1 := #x, IN2 := #z)", "Date_And_Time", stamps) == dt.datetime.fromisoformat("2010-01-01")
