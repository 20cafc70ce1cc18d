"""ISO-on-TCP as bytes: published telegrams, pieces, and what is none."""

import pytest

from plcgen.ppi.wire.iso import MOST, Connect, IsoError, IsoStream, carry, connect_confirm, connect_request

# RFC 1006 and ISO 8073 class 0: 03 00 length | 11 E0 destination source class | C0 01 0A size | C1 02 TSAP | C2 02 TSAP
REQUEST = bytes.fromhex("03 00 00 16 11 E0 00 00 00 01 00 C0 01 0A C1 02 01 00 C2 02 03 01")
CONFIRM = bytes.fromhex("03 00 00 16 11 D0 00 01 00 01 00 C0 01 0A C1 02 01 00 C2 02 03 01")
SETUP = bytes.fromhex("03 00 00 19 02 F0 80 32 01 00 00 04 00 00 08 00 00 F0 00 00 01 00 01 01 E0")
"""The negotiation that every S7 client sends (Wireshark wiki, S7comm sample captures)."""


def test_connecting():
    """Request and confirmation as the standard has them; the confirmation returns the reference of the request."""
    assert connect_request(b"\x01\x00", b"\x03\x01") == REQUEST
    (found,) = IsoStream().feed(REQUEST)
    assert found == Connect(1, b"\x01\x00", b"\x03\x01")
    assert connect_confirm(found) == CONFIRM
    assert IsoStream().feed(CONFIRM) == [found]


def test_data():
    """A PDU is carried with 02 F0 80 in front of it."""
    assert IsoStream().feed(SETUP) == [SETUP[7:]]
    assert carry(SETUP[7:]) == SETUP


@pytest.mark.parametrize("size", [1, 3, 7, 20])
def test_pieces(size):
    """However TCP cuts the stream, the same comes out."""
    stream, data = IsoStream(), REQUEST + SETUP + SETUP
    found = [entry for at in range(0, len(data), size) for entry in stream.feed(data[at : at + size])]
    assert found == [Connect(1, b"\x01\x00", b"\x03\x01"), SETUP[7:], SETUP[7:]]


def test_a_pdu_of_several_pieces():
    """Bit 7 of the third byte says which one is the last."""
    first = bytes.fromhex("03 00 00 09 02 F0 00 32 01")
    last = bytes.fromhex("03 00 00 08 02 F0 80 FF")
    assert IsoStream().feed(first + last) == [b"\x32\x01\xff"]


@pytest.mark.parametrize(
    "data",
    [
        "47 45 54 20 2F", "03 00 00 06 02 F0", "03 00 FF FF", "03 00 00 09 20 F0 80 32 01",
        "03 00 00 09 02 70 80 32 01",
        "03 00 00 0B 06 80 00 00 00 00 00", "03 00 00 07 00 F0 80",
    ],
)  # fmt: skip
def test_what_is_none(data):
    """HTTP, lengths that cannot be, other kinds (an error, a disconnect): the connection is of no use."""
    with pytest.raises(IsoError):
        IsoStream().feed(bytes.fromhex(data))


def test_memory_is_bounded():
    """A PDU whose last piece never comes ends at the bound."""
    stream, piece = IsoStream(), bytes.fromhex("03 00 01 00 02 F0 00") + bytes(249)
    with pytest.raises(IsoError):
        stream.feed(piece * (MOST // 249 + 1))
