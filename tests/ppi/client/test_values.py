"""Text, Python values and bytes; every refusal says what would do."""

import contextlib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from plcgen.ppi.client.values import PlaceError, pack_item, parse_assignment, parse_place, unpack
from plcgen.ppi.wire.address import parse_item


@pytest.mark.parametrize(
    ("text", "data"),
    [
        ("VB0=200", "C8"),
        ("VB0=16#5a", "5A"),
        ("VB0=0x5A", "5A"),
        ("VB0=2#1010_0101", "A5"),
        ("VB0=8#17", "0F"),
        ("VB0=$ff", "FF"),
        ("VW0=1234", "04 D2"),
        ("VW0=-32768", "80 00"),
        ("VW0=65535", "FF FF"),
        ("VW0:INT=-2", "FF FE"),
        ("VW0=-2:INT", "FF FE"),
        ("VD0=70000", "00 01 11 70"),
        ("VD0=1.5", "3F C0 00 00"),
        ("VD0=-2.5e0", "C0 20 00 00"),
        ("VD0:REAL=3", "40 40 00 00"),
        ("VD0=3:REAL", "40 40 00 00"),
        ("M0.0=1", "01"),
        ("M0.0=false", "00"),
        ("M0.0=ON", "01"),
        ("VB0[3]=1,2,16#FF", "01 02 FF"),
        ("VW0[2]=-1, 2", "FF FF 00 02"),
        ("VB0[5]:STRING=abc", "03 61 62 63 00"),
        ("VB0[5]:STRING='abc'", "03 61 62 63 00"),
        ('VB0[5]:CHAR="a:b"', "61 3A 62 20 20"),
        ("VB0[3]:CHAR==x", "3D 78 20"),
        ("T32=5", "00 00 00 00 05"),
        ("C5=300", "00 01 2C"),
    ],
)  # fmt: skip
def test_what_people_type(text, data):
    """Numbers in every spelling, signs, reals, bits, lists, texts."""
    _, entry = parse_assignment(text)
    assert entry.data == bytes.fromhex(data)
    assert len(entry.data) == entry.item.octets


@pytest.mark.parametrize(
    ("text", "code", "message"),
    [
        ("VB0", "PG716", '"VB0" has no value'),
        ("VB0=", "PG716", '"VB0=" has no value'),
        ("VB0=256", "PG716", '"VB0=256": 256 is outside 0..255'),
        ("VW0=-32769", "PG716", '"VW0=-32769": -32769 is outside -32768..65535'),
        ("VW0:INT=32768", "PG716", '"VW0:INT=32768": 32768 is outside -32768..32767 of a INT'),
        ("VW0=1.5", "PG716", '"VW0=1.5": "1.5" is not a whole number'),
        ("VB0=zwei", "PG716", '"VB0=zwei": "zwei" is not a whole number'),
        ("VB0=2#12", "PG716", '"VB0=2#12": "2#12" is not a whole number'),
        ("VB0=" + "9" * 60, "PG716", '"VB0='),
        ("VD0:REAL=1e99", "PG716", '"VD0:REAL=1e99": 1e+99 is too large for a REAL'),
        ("VD0:REAL=nan", "PG716", '"VD0:REAL=nan": "nan" is not a number'),
        ("VW0:REAL=1", "PG716", '"VW0:REAL": REAL does not suit VW0'),
        ("VD0:RAEL=1", "PG716", '"VD0:RAEL": "RAEL" is not a data type'),
        ("VD0:=1", "PG716", '"VD0:": the data type is missing'),
        ("M0.0=2", "PG716", '"M0.0=2": "2" is not a bit'),
        ("M0.0:BYTE=2", "PG716", '"M0.0:BYTE": BYTE does not suit M0.0'),
        ("VB0[2]=1", "PG716", '"VB0[2]=1": VB0[2] takes 2 values, not 1'),
        ("VB0=1,2", "PG716", '"VB0=1,2": VB0 takes 1 value, not 2'),
        ("VB0:STRING=a", "PG716", '"VB0:STRING": a STRING has more than one byte'),
        ("VB0[3]:STRING=abc", "PG716", '"VB0[3]:STRING=abc": the text has 3 characters, VB0[3] holds 2'),
        ("VB0[3]:CHAR=中", "PG716", '"VB0[3]:CHAR=中": the text has characters that an S7-200 cannot hold'),
        ("T32:REAL=1", "PG716", '"T32:REAL": T32 has a type of its own'),
        ("M0.9=1", "PG712", '"M0.9": bit 9 is outside 0..7'),
        ("=1", "PG711", '"" is not an S7-200 address'),
    ],
)
def test_what_does_not_fit(text, code, message):
    """A code and a sentence; the way out is in the help."""
    with pytest.raises(PlaceError) as caught:
        parse_assignment(text)
    assert caught.value.code == code
    assert caught.value.message.startswith(message)


def test_reading_types():
    """The type behind the colon decides; the name stays as it was written."""
    place = parse_place("VD100:real")
    assert (place.name, place.address, place.type_name) == ("VD100:real", "VD100", "REAL")
    assert place.value(bytes.fromhex("3FC00000")) == 1.5
    assert parse_place("SYS").value(b"CPU 226").startswith("CPU")
    assert parse_place("VB0[4]:STRING").value(b"\xffabc") == "abc"


CASES = {
    "VB0[3]": st.tuples(*[st.integers(0, 255)] * 3),
    "VW0": st.integers(0, 65535),
    "VW0:INT": st.integers(-32768, 32767),
    "VD0": st.integers(0, 2**32 - 1),
    "VD0[2]:DINT": st.tuples(*[st.integers(-(2**31), 2**31 - 1)] * 2),
    "VD0:REAL": st.floats(width=32, allow_nan=False),
    "V0.3": st.booleans(),
    "T5": st.integers(0, 2**32 - 1),
    "C5[2]": st.tuples(*[st.integers(-32768, 32767)] * 2),
    "HC0": st.integers(-(2**31), 2**31 - 1),
    "VB0[9]:STRING": st.text(st.characters(max_codepoint=255), max_size=8),
}


@pytest.mark.parametrize("text", CASES)
@given(data=st.data())
def test_values_come_back(text, data):
    """unpack(pack(value)) is the value."""
    place = parse_place(text)
    value = data.draw(CASES[text])
    assert unpack(place.item, pack_item(place.item, value, place.type), place.type) == value


@pytest.mark.slow
@given(
    st.text(max_size=30) | st.from_regex(r"[VMTCSQI][BWD]?[0-9]{1,6}(\.[0-9])?(\[[0-9]{0,3}\])?(:[A-Z]{0,6})?=?.{0,9}")
)
def test_any_text(text):
    """Whatever is typed: a place within the memory of a station, or PlaceError."""
    with contextlib.suppress(PlaceError):
        assert parse_place(text).item.count >= 1
    with contextlib.suppress(PlaceError):
        assert parse_assignment(text)[0].item.count >= 1


def test_items_are_those_of_the_address():
    """A place has the item of its address."""
    assert parse_place("VW100:INT").item == parse_item("VW100")


def test_high_speed_counters_with_and_without_status():
    """Five bytes or four: the value is the last four, with sign."""
    place = parse_place("HC0[2]")
    assert place.value(bytes.fromhex("00 FFFFFFFE 00 00000007")) == (-2, 7)
    assert place.value(bytes.fromhex("FFFFFFFE 00000007")) == (-2, 7)
    assert parse_place("C5").value(bytes.fromhex("00 FFFE")) == -2
    assert parse_place("T5").value(bytes.fromhex("00 FFFFFFFE")) == 0xFFFFFFFE
