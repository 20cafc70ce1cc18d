"""Addresses: every spelling, and every refusal with its code and its way out."""

import pytest
from hypothesis import given

from plcgen.ppi.wire.address import PpiAddressError, address_text, parse_item
from plcgen.ppi.wire.areas import Area, TransportSize
from plcgen.ppi.wire.model import Item
from tests.ppi.strategies import bits, elements, memory

BYTE, WORD, DWORD = TransportSize.BYTE, TransportSize.WORD, TransportSize.DWORD


@pytest.mark.parametrize(
    ("text", "item"),
    [
        ("VB100", Item(0x84, 2, 1, 800, 1)),
        ("vw100", Item(0x84, 4, 1, 800, 1)),
        (" VD100 ", Item(0x84, 6, 1, 800, 1)),
        ("V100.3", Item(0x84, 1, 1, 803, 1)),
        ("VX100.3", Item(0x84, 1, 1, 803, 1)),
        ("VB100[20]", Item(0x84, 2, 20, 800, 1)),
        ("M0.0", Item(0x83, 1, 1, 0, 0)),
        ("I0.5", Item(0x81, 1, 1, 5, 0)),
        ("E0.5", Item(0x81, 1, 1, 5, 0)),
        ("EB1", Item(0x81, 2, 1, 8, 0)),
        ("A0.1", Item(0x82, 1, 1, 1, 0)),
        ("AB0", Item(0x82, 2, 1, 0, 0)),
        ("AW2", Item(0x82, 4, 1, 16, 0)),
        ("QD4", Item(0x82, 6, 1, 32, 0)),
        ("%QB0", Item(0x82, 2, 1, 0, 0)),
        ("SMB34", Item(0x05, 2, 1, 272, 0)),
        ("SM0.1", Item(0x05, 1, 1, 1, 0)),
        ("S0.1", Item(0x04, 1, 1, 1, 0)),
        ("SB3", Item(0x04, 2, 1, 24, 0)),
        ("AIW0", Item(0x06, 4, 1, 0, 0)),
        ("AEW4", Item(0x06, 4, 1, 32, 0)),
        ("AQW2", Item(0x07, 4, 1, 16, 0)),
        ("AAW2", Item(0x07, 4, 1, 16, 0)),
        ("T32", Item(0x1F, 0x1F, 1, 32, 0)),
        ("T32[4]", Item(0x1F, 0x1F, 4, 32, 0)),
        ("C5", Item(0x1E, 0x1E, 1, 5, 0)),
        ("Z5", Item(0x1E, 0x1E, 1, 5, 0)),
        ("HC0", Item(0x20, 0x20, 1, 0, 0)),
        ("SYS", Item(0x03, 2, 20, 0, 0)),
        ("SYS0[4]", Item(0x03, 2, 4, 0, 0)),
        ("SYSB0", Item(0x03, 2, 1, 0, 0)),
        ("DB1.DBB100", Item(0x84, 2, 1, 800, 1)),
        ("DB1.DBW100", Item(0x84, 4, 1, 800, 1)),
        ("db1.dbx100.3", Item(0x84, 1, 1, 803, 1)),
        ("DB1.DBD8[2]", Item(0x84, 6, 2, 64, 1)),
    ],
)
def test_spelling(text, item):
    """International and German mnemonics, counts, V as a data block; areas and sizes by their numbers."""
    assert parse_item(text) == item


@pytest.mark.parametrize(
    ("text", "code", "message", "help_"),
    [
        ("XB3", "PG711", 'there is no memory area "X"', "areas: SYS, S, SM"),
        ("SNB3", "PG711", 'there is no memory area "SN"', 'did you mean "S"?'),
        ("LB0", "PG711", 'there is no memory area "L"', "areas"),
        ("V100", "PG711", "the width is missing", "VB100, VW100, VD100 or V100.0"),
        ("VB100.3", "PG711", "a bit has no width", "V100.3"),
        ("AIB0", "PG711", "analog inputs are words", "AIW0"),
        ("AI0", "PG711", "analog inputs are words", "AIW0"),
        ("AIW3", "PG711", "even addresses", "AIW2 or AIW4"),
        ("AQ0.1", "PG711", "have no bits", "AQW0"),
        ("T32.1", "PG711", "have a number only", "T32"),
        ("TW32", "PG711", "have a number only", "T32"),
        ("SYS0.1", "PG711", "have no bits", "SYS0"),
        ("DB2.DBB0", "PG711", "one data block", "VB"),
        ("DB1.DBX0", "PG711", "the bit is missing", "DB1.DBX0.0"),
        ("M0.9", "PG712", "bit 9 is outside 0..7", "M0.0 to M0.7"),
        ("V5.8", "PG712", "bit 8 is outside 0..7", "V5.0 to V5.7"),
        ("VB2097152", "PG713", "24 bits", "2097151"),
        ("T16777216", "PG713", "24 bits", ""),
        ("VB0[0]", "PG714", "the count is 0", ""),
        ("VB0[65536]", "PG714", "the count is 65536", ""),
        ("M0.0[2]", "PG714", "one at a time", "MB0"),
        ("M0.7[2]", "PG714", "one at a time", "MB0[2]"),
        ("", "PG711", "is not an S7-200 address", "VB100"),
        ("VB", "PG711", "is not an S7-200 address", ""),
        ("VB-1", "PG711", "is not an S7-200 address", ""),
        ("VB1 2", "PG711", "is not an S7-200 address", ""),
        ("VB１", "PG711", "is not an S7-200 address", ""),
        ("V" * 1000, "PG711", "is not an S7-200 address", ""),
        ("100", "PG711", "is not an S7-200 address", ""),
    ],
)
def test_refusal(text, code, message, help_):
    """What is no address, why, and what to write instead."""
    with pytest.raises(PpiAddressError) as caught:
        parse_item(text)
    assert caught.value.code == code
    assert message in caught.value.message
    assert help_ in caught.value.help


@given(bits | memory(300) | elements)
def test_text_of_an_item(item):
    """An item that an address can mean is written as that address."""
    text = address_text(item)
    try:
        again = parse_item(text)
    except PpiAddressError:
        assert item.area in {Area.SYS, Area.AI, Area.AQ} or item.size not in {BYTE, WORD, DWORD}
    else:
        assert again == item


def test_text_of_what_has_no_address():
    """Unknown areas and sizes are written with their numbers."""
    assert address_text(Item(0x99, 2, 1, 8, 0)) == "area 99h size 02h address 8"
    assert address_text(Item(0x84, 0x55, 1, 8, 1)) == "VB1 (size 55h)"
    assert address_text(Item(0x84, 2, 1, 9, 1)) == "VB1.1"
    assert address_text(Item(0x84, 8, 2, 8, 1)) == "VD1[2] (REAL)"
    assert address_text(Item(0x1F, 4, 1, 8, 0)) == "T8 (size 04h)"
    assert address_text(Item(0x84, 2, 0, 8, 1)) == "VB1[0]"
