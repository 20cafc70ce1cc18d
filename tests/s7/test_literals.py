"""Constants: expected values from the S7 manuals and hand calculation."""

# ruff: noqa: PT017 - PLC clocks have no time zone; the name of a test is its claim

from __future__ import annotations

import datetime as dt
import math
import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from plcgen.s7.types.address import parse_pointer
from plcgen.s7.types.data_types import ELEMENTARY, StringType
from plcgen.s7.types.literals import LiteralError, format_literal, pack_literal, parse_literal
from plcgen.s7.types.values import RANGES, pack_value, unpack_value


@pytest.mark.parametrize(
    ("text", "type_name", "data"),
    [
        ("16#03", "BYTE", "03"),
        ("B#16#3", "BYTE", "03"),
        ("byte#16#ff", "BYTE", "ff"),
        ("2#1010", "BYTE", "0a"),
        ("8#17", "BYTE", "0f"),
        ("-1", "BYTE", "ff"),
        ("'A'", "CHAR", "41"),
        ("CHAR#'A'", "BYTE", "41"),
        ("W#16#C47F", "WORD", "c47f"),
        ("WORD#16#c47f", "WORD", "c47f"),
        ("50303", "WORD", "c47f"),
        ("B#16#7F", "WORD", "007f"),
        ("B#(1,2)", "WORD", "0102"),
        ("C#127", "WORD", "0127"),
        ("50_303", "UINT", "c47f"),
        ("DW#16#41200000", "DWORD", "41200000"),
        ("B#(1, 2, 3, 4)", "DWORD", "01020304"),
        ("-20434", "INT", "b02e"),
        ("INT#-5", "INT", "fffb"),
        ("16#7FFF", "INT", "7fff"),
        ("+5", "INT", "0005"),
        ("L#-2", "DINT", "fffffffe"),
        ("INT#3", "DINT", "00000003"),
        ("USINT#200", "INT", "00c8"),
        ("10.0", "REAL", "41200000"),
        ("1.0E+1", "REAL", "41200000"),
        ("1.000000e+001", "REAL", "41200000"),
        ("REAL#-0.5", "REAL", "bf000000"),
        ("10", "REAL", "41200000"),
        ("1.0", "LREAL", "3ff0000000000000"),
        ("TRUE", "BOOL", "01"),
        ("false", "BOOL", "00"),
        ("1", "BOOL", "01"),
        ("BOOL#0", "BOOL", "00"),
        ("2#1", "BOOL", "01"),
        ("T#10s_500ms", "TIME", "00002904"),
        ("T#-1ms", "TIME", "ffffffff"),
        ("TIME#1.5S", "TIME", "000005dc"),
        ("t#1d_2h_3m_4s_5ms", "TIME", "059707c5"),
        ("T#24D20H31M23S647MS", "TIME", "7fffffff"),
        ("S5T#10s_500ms", "S5TIME", "1105"),
        ("S5T#2H46M30S", "S5TIME", "3999"),
        ("S5TIME#500ms", "S5TIME", "0050"),
        ("TOD#00:00:01.250", "TIME_OF_DAY", "000004e2"),
        ("TIME_OF_DAY#23:59:59.999", "TIME_OF_DAY", "05265bff"),
        ("D#1990-01-01", "DATE", "0000"),
        ("D#1991-1-1", "DATE", "016d"),
        ("DT#2026-11-21-12:30:15.250", "DATE_AND_TIME", "2611211230152507"),
        ("DT#90-1-1-0:0:0.0", "DATE_AND_TIME", "9001010000000002"),
        ("DTL#2026-11-21-12:30:15.25", "DTL", "07ea0b15070c1e0f0ee6b280"),
        ("LT#1us", "LTIME", "00000000000003e8"),
        ("LTOD#00:00:01", "LTIME_OF_DAY", "000000003b9aca00"),
        ("LDT#1970-01-02-00:00:00", "LDT", "00004e94914f0000"),
        ("WCHAR#'A'", "WCHAR", "0041"),
        ("P#DB3.DBX0.0 BYTE 10", "ANY", "1002000a000384000000"),
        ("P#M50.0", "POINTER", "000083000190"),
        ("NIL", "ANY", "00" * 10),
        ("7", "BLOCK_DB", "0007"),
        ("16#FFFF", "HW_IO", "ffff"),
    ],
)
def test_constants_of_every_type(text, type_name, data):
    assert data == pack_literal(text, type_name).hex()


@pytest.mark.parametrize(
    ("text", "data"),
    [
        ("'text'", "0804" + b"text".hex() + "00" * 4),
        ("''", "0800" + "00" * 8),
        ("'a$'b$$c'", "0805" + b"a'b$c".hex() + "00" * 3),
        ("'$L$R$N$T$P'", "0806" + b"\n\r\r\n\t\x0c".hex() + "00" * 2),
        ("'$41$E9'", "080241e9" + "00" * 6),
        ("STRING#'x'", "080178" + "00" * 7),
    ],
)
def test_strings_carry_their_two_lengths(text, data):
    assert data == pack_literal(text, StringType("STRING", 8)).hex()


def test_wide_strings():
    assert pack_literal("WSTRING#'$20AC'", StringType("WSTRING", 2)).hex() == "00020001" + "20ac" + "0000"


@pytest.mark.parametrize(
    ("text", "type_name", "reason"),
    [
        ("256", "BYTE", "outside -128..255"),
        ("W#16#100", "BYTE", "WORD# does not fit"),
        ("16#B02E", "INT", "outside"),
        ("W#16#B02E", "INT", "WORD# does not fit"),
        ("abc", "INT", "not a whole number"),
        ("2#12", "BYTE", "base 2"),
        ("", "INT", "whole"),
        ("1.0", "INT", "whole"),
        ("BYTE#300", "WORD", "outside 0..255"),
        ("B#(1,2,3)", "WORD", "2 bytes"),
        ("MAYBE", "BOOL", "TRUE"),
        ("2", "BOOL", "TRUE"),
        ("10", "BOOL", "TRUE"),
        ("-1", "BOOL", "TRUE"),
        ("1e39", "REAL", "too large"),
        ("1e999", "LREAL", "too large"),
        ("nan", "REAL", "looks like"),
        ("'ab'", "CHAR", "exactly one"),
        ("a", "CHAR", "quotes"),
        ("'a'b'", "STRING", "$'"),
        ("'$'", "STRING", "$'"),
        ("'$Q'", "STRING", "no escape"),
        ("'€'", "STRING", "WSTRING"),
        ("10s", "TIME", "prefix TIME#"),
        ("T#25d", "TIME", "outside"),
        ("T#5ms_1s", "TIME", "large to small"),
        ("T#1h_60m", "TIME", "first unit"),
        ("T#1us", "TIME", "1 ms"),
        ("T#", "TIME", "looks like"),
        ("T#1.5h_3m", "TIME", "decimals"),
        ("S5T#3h", "S5TIME", "outside"),
        ("TOD#24:00:00", "TIME_OF_DAY", "no such"),
        ("D#2026-02-30", "DATE", "day"),
        ("D#1989-12-31", "DATE", "1990"),
        ("DT#1989-01-01-00:00:00", "DATE_AND_TIME", "1990"),
        ("P#X1.0", "ANY", "pointer"),
        ("C#1000", "WORD", "999"),
        ("TOD#1:2:3.1234", "TIME_OF_DAY", "3 decimals"),
        ("-1", "BLOCK_DB", "outside"),
    ],
)
def test_wrong_constants_say_why(text, type_name, reason):
    with pytest.raises(LiteralError) as caught:
        parse_literal(text, type_name)
    assert reason in caught.value.reason
    assert text == caught.value.text


def test_a_text_too_long_for_its_string():
    with pytest.raises(LiteralError, match="5 characters do not fit"):
        parse_literal("'12345'", StringType("STRING", 4))


@pytest.mark.parametrize(
    ("value", "type_name", "v5", "tia"),
    [
        (3, "BYTE", "B#16#03", "16#03"),
        (0xC47F, "WORD", "W#16#C47F", "16#C47F"),
        (1, "DWORD", "DW#16#00000001", "16#00000001"),
        (-20434, "INT", "-20434", "-20434"),
        (5, "DINT", "L#5", "5"),
        (10.0, "REAL", "10.0", "10.0"),
        (1e10, "REAL", "10000000000.0", "10000000000.0"),
        (1e20, "REAL", "1.0E+20", "1.0E+20"),
        (0.1, "REAL", "0.1", "0.1"),
        (True, "BOOL", "TRUE", "TRUE"),
        ("a'b", "CHAR", None, None),
        (10500, "TIME", "T#10s_500ms", "T#10s_500ms"),
        (0, "TIME", "T#0ms", "T#0ms"),
        (10500, "S5TIME", "S5T#10s_500ms", "S5T#10s_500ms"),
        (dt.date(2026, 11, 21), "DATE", "D#2026-11-21", "D#2026-11-21"),
        (1250, "TIME_OF_DAY", "TOD#00:00:01.250", "TOD#00:00:01.250"),
        (
            dt.datetime(2026, 11, 21, 12, 30),
            "DATE_AND_TIME",
            "DT#2026-11-21-12:30:00",
            "DT#2026-11-21-12:30:00",
        ),
        ("it's $5\n", "STRING", "'it$'s $$5$0A'", "'it$'s $$5$0A'"),
        (None, "ANY", "NIL", "NULL"),
        (parse_pointer("P#DB3.DBX0.0 BYTE 10"), "ANY", "P#DB3.DBX0.0 BYTE 10", "P#DB3.DBX0.0 BYTE 10"),
        (float("inf"), "REAL", None, None),
        (256, "BYTE", None, None),
    ],
)
def test_canonical_spelling_in_both_tool_chains(value, type_name, v5, tia):
    if tia is None:
        with pytest.raises(LiteralError):
            format_literal(value, type_name, dialect_v5=True)
    else:
        assert (v5, tia) == (format_literal(value, type_name, True), format_literal(value, type_name, False))


def moments():
    return st.datetimes(dt.datetime(1990, 1, 1), dt.datetime(2089, 12, 31)).map(
        lambda d: d.replace(microsecond=d.microsecond // 1000 * 1000)
    )


def values(name):
    if name == "BOOL":
        return st.booleans()
    if name == "S5TIME":
        return st.integers(0, 999).flatmap(lambda n: st.sampled_from([10, 100, 1000, 10000]).map(lambda b: n * b))
    if name in RANGES:
        return st.integers(*RANGES[name])
    if name in ("REAL", "LREAL"):
        return st.floats(allow_nan=False, allow_infinity=False, width=32 if name == "REAL" else 64)
    if name == "CHAR":
        return st.characters(max_codepoint=255)
    if name == "WCHAR":
        return st.characters(max_codepoint=0xD7FF)
    if name == "DATE":
        return st.dates(dt.date(1990, 1, 1), dt.date(2168, 12, 31))
    if name == "DATE_AND_TIME":
        return moments()
    if name == "DTL":
        return st.integers(0, 9 * 10**18)
    places = st.builds(
        lambda a, b, n: parse_pointer(f"P#{a}{b}.0 {n}"),
        st.sampled_from(["M", "I", "DB7.DBX"]),
        st.integers(0, 9999),
        st.sampled_from(["BYTE 3", "REAL 1"]),
    )
    return st.none() | (places if name == "ANY" else places.map(lambda p: parse_pointer(str(p).split(" ")[0])))


@given(st.data())
@pytest.mark.parametrize("name", sorted(ELEMENTARY))
def test_value_bytes_and_text_round_trip(name, data):
    """Value -> bytes -> value and value -> text -> value, in both spellings, forevery elementary type."""
    value = data.draw(values(name))
    packed = pack_value(value, ELEMENTARY[name])
    assert max(1, ELEMENTARY[name].bits // 8) == len(packed)
    assert value == unpack_value(packed, ELEMENTARY[name])
    for v5 in (True, False):
        assert value == parse_literal(format_literal(value, name, v5), name)


@given(st.text(st.characters(max_codepoint=255), max_size=20), st.booleans())
def test_strings_round_trip(text, wide):
    type_ = StringType("WSTRING" if wide else "STRING", 20)
    assert text == unpack_value(pack_value(text, type_), type_)
    assert text == parse_literal(format_literal(text, type_.name), type_)


@given(st.text(max_size=30), st.sampled_from([*sorted(ELEMENTARY), "STRING", "WSTRING"]))
def test_any_text_is_a_constant_or_a_literal_error(text, name):
    try:
        pack_literal(text, name)
    except LiteralError as error:
        assert error.reason


@given(st.floats(width=32, allow_nan=False, allow_infinity=False))
def test_real_spelling_is_read_by_every_dialect(value):
    """A decimal point is always there: STEP 7 in TIA Portal refuses 3E10."""
    text = format_literal(value, "REAL")
    assert "." in text
    assert struct.pack(">f", value) == pack_literal(text, "REAL")
    assert math.isfinite(float(text))
