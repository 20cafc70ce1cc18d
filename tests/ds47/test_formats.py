"""Formats: codes, names, sizes, values to bytes and back, ranges."""

import math

import pytest

from plcgen.ds47.wire import formats
from plcgen.ds47.wire.formats import FormatValueError, by_code, by_name, find, pack_values, unpack_values
from plcgen.ds47.wire.model import ValueBlock
from tests.ds47.vectors import tables

ROWS = tables()["formats"]["values"]


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row[1])
def test_value_of_every_format(row):
    """Code, name, size and bytes of one value of each format agree with the table worked out by hand."""
    code, name, value, data = row[0], row[1], row[2], bytes.fromhex(row[3])
    fmt = by_code(code)
    assert (fmt.name, fmt.size) == (name, len(data))
    assert by_name(name.upper()) is fmt
    assert pack_values(fmt, [value, value]) == data * 2
    assert unpack_values(fmt, 2, data * 2) == [value, value]
    assert fmt.source


def test_table_is_complete():
    """The 28 codes of the profile (OPC 30144 table 59), 34h..36h of G120X OI p. 222, and 40h..44h, once each."""
    profile = {*range(0x01, 0x0B), 0x0C, 0x0D, 0x0F, 0x32, *range(0x34, 0x39), *range(0x71, 0x7D)}
    assert sorted(f.code for f in formats.FORMATS) == sorted({*profile, *range(0x40, 0x45)})
    assert len({f.name.lower() for f in formats.FORMATS}) == len(formats.FORMATS)


def test_strings_count_octets():
    """VisibleString and OctetString are one value of count octets."""
    text, octets = by_code(9), by_code(10)
    assert pack_values(text, ["Ab"]) == b"Ab"
    assert unpack_values(text, 2, b"Ab") == ["Ab"]
    assert pack_values(octets, [b"\x01\x02\x03"]) == b"\x01\x02\x03"
    assert unpack_values(octets, 3, b"\x01\x02\x03") == [b"\x01\x02\x03"]
    assert ValueBlock.of(text, ["abc"]) == ValueBlock(9, 3, b"abc")
    assert ValueBlock.text("x") == ValueBlock(9, 1, b"x")


def test_dates_are_octets():
    """BinaryDate, 32h = 50, has 7 and TimeOfDay 6 octets, TimeDifference 4; with date 6 (OPC 30144, table 59)."""
    assert by_name("BinaryDate").code == 50
    assert find(0x0B) is None
    assert by_code(0x35) is by_name("TimeDifferenceWithDate")
    assert unpack_values(by_code(0x35), 1, bytes(6)) == [bytes(6)]
    assert [by_name(n).size for n in ("BinaryDate", "TimeOfDay", "TimeDifference")] == [7, 6, 4]
    assert unpack_values(by_name("TimeOfDay"), 2, bytes(range(12))) == [bytes(range(6)), bytes(range(6, 12))]
    with pytest.raises(FormatValueError, match="exactly 7 bytes"):
        pack_values(by_name("BinaryDate"), [bytes(6)])


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("Unsigned8", 256, "from 0 to 255"),
        ("Unsigned8", -1, "from 0 to 255"),
        ("Integer8", 128, "from -128 to 127"),
        ("Integer16", -32769, "from -32768 to 32767"),
        ("Integer32", 2**31, "from -2147483648 to 2147483647"),
        ("Unsigned64", 2**64, "from 0 to 18446744073709551615"),
        ("Unsigned16", 1.5, "an integer"),
        ("Unsigned16", True, "an integer"),
        ("Unsigned16", "7", "an integer"),
        ("Integer16", math.inf, "an integer"),
        ("FloatingPoint", 3.5e38, "finite number from -3.4028235e"),
        ("FloatingPoint", math.inf, "finite"),
        ("FloatingPoint", math.nan, "finite"),
        ("FloatingPoint", "1.0", "finite"),
        ("FloatingPoint", 10**400, "finite"),
        ("Float64", 10**400, "1.7976931348623157e"),
        ("Boolean", 2, "false or true"),
        ("Boolean", 1.0, "false or true"),
        ("VisibleString", "€", "characters 00h to FFh"),
        ("VisibleString", 7, "takes text"),
        ("OctetString", "ab", "takes bytes"),
        ("Zero", 0, "no values"),
    ],
)
def test_value_out_of_range(name, value, message):
    """A value that does not fit raises FormatValueError that says what does."""
    with pytest.raises(FormatValueError, match=message):
        pack_values(by_name(name), [value])


def test_whole_floats_are_integers():
    """11.0 written to an integer parameter is 11."""
    assert pack_values(by_name("Integer16"), [11.0]) == b"\x00\x0b"


def test_infinity_and_nan_can_be_read():
    """A drive may answer infinity (7F800000h) or NaN (7FC00000h); both are numbers when read."""
    values = unpack_values(by_code(8), 2, bytes.fromhex("7F800000 7FC00000"))
    assert values[0] == math.inf
    assert math.isnan(values[1])


def test_length_must_fit():
    """Too few or too many bytes are refused with both numbers."""
    with pytest.raises(FormatValueError, match="2 x Integer16 takes 4 bytes, not 3"):
        unpack_values(by_code(3), 2, bytes(3))


def test_unknown_code_and_name():
    """A reserved code or an unknown name is a KeyError; find answers None."""
    with pytest.raises(KeyError, match="0Eh"):
        by_code(0x0E)
    with pytest.raises(KeyError, match="'Real'"):
        by_name("Real")
    assert formats.find(0x0E) is None


def test_generic_formats():
    """41h, 42h and 43h stand for 1, 2 and 4 bytes; 8 bytes and strings have no generic format."""
    assert [f and f.code for f in map(formats.generic_of, (1, 2, 4, 8, 7))] == [0x41, 0x42, 0x43, None, None]
    real = by_name("FloatingPoint")
    assert [formats.accepts(real, code) for code in (0x08, 0x43, 0x42, 0x07)] == [True, True, False, False]
    assert not formats.accepts(by_name("VisibleString"), 0x41)
    assert formats.by_code(0x43).generic
    assert not real.generic


def test_declared_type_reads_generic_values():
    """43h with 41200000h is 10.0 when the parameter is declared FloatingPoint, a bit pattern otherwise."""
    block = ValueBlock(0x43, 1, bytes.fromhex("41200000"))
    assert block.values(by_name("FloatingPoint")) == [10.0]
    assert block.values() == [0x41200000]
    with pytest.raises(FormatValueError, match="does not carry Integer16"):
        block.values(by_name("Integer16"))
    with pytest.raises(FormatValueError, match="0Eh is unknown"):
        ValueBlock(0x0E, 1, b"").values()


@pytest.mark.parametrize("wire", [0x0D, 0x36, 0x43])
def test_a_time_difference_has_two_codes(wire):
    """r0948 answers 36h on newer firmware, 0Dh on older; a change takes its own code or 43h only."""
    block = ValueBlock(wire, 1, bytes.fromhex("000003E8"))
    assert [block.values(by_code(code)) for code in (0x0D, 0x36)] == [[1000], [1000]]
    assert formats.accepts(by_code(0x0D), wire) == (wire != 0x36)
    with pytest.raises(FormatValueError, match="does not carry Unsigned32"):
        ValueBlock(0x36, 1, bytes(4)).values(by_name("Unsigned32"))


def test_pad():
    """Odd lengths grow by one, even ones stay."""
    assert [formats.padded(n) for n in (0, 1, 2, 3)] == [0, 2, 2, 4]


def test_true_is_any_octet_but_zero():
    """A Boolean read as FFh is true as well."""
    assert unpack_values(by_code(1), 3, b"\x00\x01\xff") == [False, True, True]
