"""Absolute addresses and pointers."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from plcgen.s7.types.address import Address, AddressError, parse_address, parse_pointer, unpack_pointer


@pytest.mark.parametrize(
    ("text", "fields", "canonical"),
    [
        ("M50.0", ("M", None, 50, 0, 1), "%M50.0"),
        ("MB20", ("M", None, 20, None, 8), "%MB20"),
        ("mw52", ("M", None, 52, None, 16), "%MW52"),
        ("MD22", ("M", None, 22, None, 32), "%MD22"),
        ("%M50.0", ("M", None, 50, 0, 1), "%M50.0"),
        ("DB3.DBX0.0", ("DB", 3, 0, 0, 1), "%DB3.DBX0.0"),
        ("DB3.DBB4", ("DB", 3, 4, None, 8), "%DB3.DBB4"),
        ("%DB3.DBW6", ("DB", 3, 6, None, 16), "%DB3.DBW6"),
        ("DB4.DBD6", ("DB", 4, 6, None, 32), "%DB4.DBD6"),
        ("E0.7", ("I", None, 0, 7, 1), "%I0.7"),
        ("AW 4", ("Q", None, 4, None, 16), "%QW4"),
        ("PEW256", ("PI", None, 256, None, 16), "%PIW256"),
        ("%IW256:P", ("PI", None, 256, None, 16), "%PIW256"),
        ("QB1", ("Q", None, 1, None, 8), "%QB1"),
        ("P#DB3.DBX0.0 BYTE 10", ("DB", 3, 0, None, 80), "P#DB3.DBX0.0 BYTE 10"),
        ("P#M 10.0 WORD 3", ("M", None, 10, None, 48), "P#M10.0 BYTE 6"),
    ],
)
def test_spellings(text, fields, canonical):
    address = parse_address(text)
    assert Address(*fields) == address
    assert canonical == address.text(percent=True)
    assert canonical.removeprefix("%") == str(address)
    assert address == parse_address(str(address))


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("M50", "byte and bit"),
        ("M50.8", "bits 0 to 7"),
        ("MW5.1", "no bit number"),
        ("DB0.DBB1", "1 to 65535"),
        ("DB70000.DBB1", "1 to 65535"),
        ("DB3.DBX4", "byte and bit"),
        ("MB70000", "last byte"),
        ("MW65535", "last byte"),
        ("X1.0", "looks like"),
        ("", "looks like"),
        ("M50.0:P", "inputs and outputs"),
        ("P#DB3.DBX0.0 FOO 1", "FOO"),
        ("P#DB3.DBX0.0 BYTE 0", "1 to 65535"),
        ("P#DB3.DBX0.1 BYTE 1", "bit 0"),
        ("P#", "pointer looks like"),
        ("DB3.DBW٣", "looks like"),
    ],
)
def test_errors_say_why(text, reason):
    with pytest.raises(AddressError) as caught:
        parse_address(text)
    assert reason in caught.value.reason


@pytest.mark.parametrize(
    ("one", "two", "expected"),
    [
        ("MB20", "M20.7", True),
        ("MB20", "M21.0", False),
        ("MD22", "MW24", True),
        ("MD22", "MW26", False),
        ("DB3.DBW6", "DB4.DBW6", False),
        ("P#DB3.DBX0.0 BYTE 10", "DB3.DBW8", True),
        ("M0.0", "M0.1", False),
        ("P#DB3.DBX0.0 BYTE 10", "DB3.DBW10", False),
        ("PIW0", "IB1", True),
        ("I0.0", "Q0.0", False),
        ("P#M0.0 BOOL 1", "M0.0", True),
        ("P#M0.0 BOOL 1", "M0.1", False),
    ],
)
def test_overlaps(one, two, expected):
    assert expected is parse_address(one).overlaps(parse_address(two))
    assert expected is parse_address(two).overlaps(parse_address(one))


@given(st.integers(0, 7), st.integers(0, 65535), st.sampled_from(["BOOL 1", "BYTE 12", "REAL 3", ""]))
def test_pointers_round_trip_through_text_and_bytes(bit, byte, kind):
    bit = bit if kind.startswith("BOOL") or not kind else 0
    pointer = parse_pointer(f"P#DB9.DBX{byte}.{bit} {kind}".strip())
    assert pointer == parse_pointer(str(pointer))
    assert pointer == unpack_pointer(pointer.pack_any() if kind else pointer.pack_pointer())


@given(st.text(max_size=20))
def test_any_text_is_an_address_or_an_address_error(text):
    try:
        address = parse_address(text)
    except AddressError:
        return
    assert address == parse_address(str(address))
