"""Every violation by itself, with its kind and its offset; and all of them at once."""

import pytest

from plcgen.ppi.wire.areas import Area
from plcgen.ppi.wire.errors import TOLERABLE, Kind, PpiError
from plcgen.ppi.wire.fdl import checksum, encode_frame
from plcgen.ppi.wire.model import (
    Acknowledgement,
    AckReply,
    DataFrame,
    ErrorReply,
    FixedFrame,
    FrameCount,
    Item,
    ItemResult,
    ItemWrite,
    ReadReply,
    ReadRequest,
    RunRequest,
    SetupRequest,
    TokenFrame,
    VariableFrame,
    WriteRequest,
)
from plcgen.ppi.wire.pdu import decode_pdu, encode_pdu, examine_pdu
from plcgen.ppi.wire.stream import FrameCountCheck
from plcgen.ppi.wire.telegram import decode_telegram, examine
from tests.ppi.vectors import FRAMES, octets

READ = octets(FRAMES["t1-read-vb100"])
WRITE = octets(FRAMES["vb-write-vb100=0c-7c"])
PADDED = octets(FRAMES["t2-write-vb100=10"])
REPLY = octets(FRAMES["vb-read-response-vb100=22"])
MULTI = octets(FRAMES["multi-read-response-m=5a-v=22-q=0f"])
POLL = bytes.fromhex("10 02 00 5C 5E 16")


def changed(data, *changes, fcs=True):
    """Return a frame with bytes changed as (offset, value), its checksum made right again."""
    damaged = bytearray(data)
    for offset, value in changes:
        damaged[offset] = value
    if fcs:
        first = 4 if damaged[0] == 0x68 else 1
        damaged[-2] = checksum(damaged[first:-2])
    return bytes(damaged)


def found(data):
    """Return kinds and offsets of the violations."""
    return [(violation.kind.value, violation.offset) for violation in examine(data).violations]


@pytest.mark.parametrize(
    ("data", "expected"),
    [
        (b"", [("short", 0)]),
        (b"\x00", [("start", 0)]),
        (b"\x68\x1b", [("short", 2)]),
        (READ[:-1], [("short", 32)]),
        (READ + b"\x00", [("trailing", 33)]),
        (b"\xe5\xe5", [("trailing", 1)]),
        (b"\xfe", [("acknowledgement", 0)]),
        (b"\xdc\x02", [("short", 2)]),
        (b"\xdc\x82\x00", [("station", 1)]),
        (b"\xdc\x7f\x00", [("station", 1)]),
        (b"\xa2" + bytes(12), [("short", 13)]),
        (POLL[:-1] + b"\x17", [("end", 5)]),
        (changed(POLL, (4, 0x5F), fcs=False), [("checksum", 4)]),
        (changed(POLL, (1, 0x82)), [("station", 1)]),
        (changed(POLL, (2, 0xFF)), [("station", 2)]),
        (changed(POLL, (2, 0x7F)), [("station", 2)]),
        (changed(POLL, (2, 0x02)), [("station", 2)]),
        (changed(POLL, (3, 0x4C)), [("function code", 3)]),
        (changed(POLL, (3, 0xDC)), [("function code", 3)]),
        (changed(POLL, (3, 0x5B)), [("function code", 3)]),
        (changed(POLL, (3, 0x0F)), [("function code", 3)]),
        (changed(READ, (1, 0x1C)), [("repeated length", 2)]),
        (changed(READ, (2, 0x1C)), [("repeated length", 2)]),
        (changed(READ, (3, 0x69)), [("repeated start", 3)]),
        (bytes.fromhex("68 03 03 68 02 00 6C 6E 16"), [("length", 1), ("short", 7)]),
        (bytes.fromhex("68 04 04 68 02 00 6C 32 A0 16"), [("short", 8)]),
        (changed(READ, (7, 0x33)), [("protocol", 7)]),
        (changed(READ, (8, 0x04)), [("rosctr", 8)]),
        (changed(READ, (9, 0x01)), [("reserved", 9)]),
        (changed(READ, (14, 0x0D)), [("parameter length", 13)]),
        (changed(READ, (16, 0x01)), [("data length", 15)]),
        (changed(READ, (18, 0x00)), [("parameter length", 13), ("data length", 15), ("item count", 18)]),
        (changed(READ, (18, 0x02)), [("parameter length", 13), ("parameter length", 13)]),
        (changed(READ, (19, 0x13)), [("item header", 19)]),
        (changed(READ, (20, 0x0B)), [("item header", 19)]),
        (changed(READ, (21, 0x11)), [("item header", 19)]),
        (changed(READ, (22, 0x09)), [("transport size", 22)]),
        (changed(READ, (22, 0x1E)), [("transport size", 22)]),
        (changed(READ, (22, 0x01), (24, 0x02)), [("count", 23)]),
        (changed(READ, (24, 0x00)), [("count", 23)]),
        (changed(READ, (24, 0xDF)), [("limit", 19)]),
        (changed(READ, (26, 0x00)), [("data block", 25)]),
        (changed(READ, (27, 0x85)), [("area", 27)]),
        (changed(READ, (27, 0x1F), (26, 0x00)), [("transport size", 22)]),
        (changed(READ, (30, 0x21)), [("address", 28)]),
        (changed(WRITE, (16, 0x04)), [("data length", 15)]),
        (changed(WRITE, (31, 0x01)), [("reserved", 31)]),
        (changed(WRITE, (32, 0x09)), [("data length", 31)]),
        (changed(WRITE, (32, 0x03), (34, 0x01)), [("value", 35), ("size code", 32)]),
        (changed(WRITE, (34, 0x00)), [("value length", 33), ("data length", 35), ("value length", 33)]),
        (changed(WRITE, (34, 0x07)), [("value length", 33)]),
        (changed(PADDED, (36, 0x01)), [("pad", 36)]),
        (changed(REPLY, (20, 0x02)), [("data length", 26)]),
        (changed(REPLY, (22, 0x05)), [("size code", 22)]),
        (changed(REPLY, (21, 0x05)), [("reserved", 22), ("data length", 25)]),
        (changed(MULTI, (26, 0x01)), [("pad", 26)]),
    ],
)  # fmt: skip
def test_violation(data, expected):
    """One change, its violations: kind and byte."""
    assert sorted(found(data), key=lambda entry: entry[1]) == sorted(expected, key=lambda entry: entry[1])
    with pytest.raises(PpiError) as caught:
        decode_telegram(data)
    assert sorted(kind.value for kind in caught.value.kinds) == sorted(kind for kind, _ in expected)


def test_all_violations_at_once():
    """A telegram with ten mistakes names ten, in the order of the bytes."""
    data = changed(
        READ, (2, 0x1C), (3, 0), (4, 0x82), (6, 0xEC), (7, 0), (9, 1), (19, 0), (23, 1), (26, 2), (32, 0), fcs=False
    )
    assert [kind for kind, _ in found(data)] == [
        "repeated length", "repeated start", "station", "function code", "protocol", "reserved", "item header",
        "limit", "data block", "checksum", "end",
    ]  # fmt: skip


def test_what_is_tolerable_is_read_all_the_same():
    """F9 and FE for E5, a pad after the last value of a reply, values without pads in between; nothing else."""
    seen = examine(b"\xf9")
    assert (seen.frame, [found.kind for found in seen.violations]) == (Acknowledgement(), [Kind.ACKNOWLEDGEMENT])
    assert not examine(b"\xe5").violations
    padded = bytes.fromhex("32 03 00 00 00 00 00 02 00 06 00 00 04 01 FF 04 00 08 22 00")
    bare = bytes.fromhex("32 03 00 00 00 00 00 02 00 0A 00 00 04 02 FF 04 00 08 5A FF 04 00 08 22")
    for pdu, values in ((padded, (b"\x22",)), (bare, (b"\x5a", b"\x22"))):
        with pytest.raises(PpiError) as caught:
            decode_pdu(pdu)
        assert caught.value.kinds == (Kind.PAD,)
        assert {Kind.PAD, Kind.ACKNOWLEDGEMENT} <= TOLERABLE
        reply = examine_pdu(pdu)[0]
        assert isinstance(reply, ReadReply)
        assert tuple(result.data for result in reply.results) == values
    assert {found.kind for found in examine(changed(POLL, (4, 0), fcs=False)).violations} - TOLERABLE


def test_a_station_answers_wrong_items():
    """An unknown area, a count of 0, a wrong data block: the structure is known, so a server can answer."""
    pdu = bytearray(READ[7:-2])
    pdu[20] = 0x85
    with pytest.raises(PpiError):
        decode_pdu(bytes(pdu))
    request = examine_pdu(bytes(pdu))[0]
    assert request == ReadRequest(0, (Item(0x85, 2, 1, 800, 1),))


def test_failed_items_are_four_bytes():
    """A failed item in the middle: the walk goes on four bytes behind it."""
    pdu = bytes.fromhex("32 03 00 00 00 07 00 02 00 10 00 00 04 03 FF 04 00 08 5A 00 05 00 00 00 FF 03 00 01 01")
    assert len(pdu) - 14 != 0x10
    pdu = pdu[:9] + bytes([len(pdu) - 14]) + pdu[10:]
    assert decode_pdu(pdu) == ReadReply(7, (ItemResult(0xFF, b"\x5a", 4), ItemResult(5), ItemResult(0xFF, b"\x01", 3)))


@pytest.mark.parametrize(
    ("pdu", "kinds"),
    [
        ("32 03 00 00 00 00 00 02 00 04 00 00 04 01 05 00 00 04", ["reserved"]),
        ("32 03 00 00 00 00 00 02 00 04 00 00 04 01 55 00 00 00", ["return code"]),
        ("32 03 00 00 00 00 00 02 00 01 00 00 05 01 55", ["return code"]),
        ("32 03 00 00 00 00 00 02 00 02 00 00 05 01 FF FF", ["data length"]),
        ("32 01 00 00 00 00 00 08 00 00 F0 01 00 01 00 01 00 F0", ["reserved"]),
        ("32 01 00 01 00 00 00 08 00 00 F0 00 00 01 00 01 00 F0", ["reserved"]),
        ("32 01 00 00 00 00 00 08 00 01 F0 00 00 01 00 01 00 F0", ["data length"]),
        ("32 01 00 00 00 00 00 00 00 00", ["parameter length"]),
        ("32 01 00 00 00 00 00 01 00 00", ["parameter length", "parameter length"]),
        ("32 03 00 00 00 00 00 00 00 00 00 00", ["parameter length"]),
        ("32 03 00 00 00 00 00 00 00 00", ["short"]),
        ("32 07 00 00 00 00 00 01 00 00", ["parameter length"]),
    ],
)
def test_violation_of_a_pdu(pdu, kinds):
    """Failed items, negotiation, empty PDUs: what is wrong with their bytes."""
    with pytest.raises(PpiError) as caught:
        decode_pdu(bytes.fromhex(pdu))
    assert [kind.value for kind in caught.value.kinds] == kinds


@pytest.mark.parametrize(("size", "kinds"), [(240, []), (241, ["limit"])])
def test_the_limit_of_a_pdu(size, kinds):
    """240 bytes are the most: header 10, function 1, the rest."""
    pdu = bytes.fromhex("32 01 00 00 00 00 00") + bytes((size - 10, 0, 0, 0x1A)) + bytes(size - 11)
    assert len(pdu) == size
    assert [violation.kind.value for violation in examine_pdu(pdu)[1]] == kinds


def test_frame_count():
    """6C starts, then 5C and 7C alternate; a restart begins with 6C again."""
    count = FrameCount()
    assert [count.following() for _ in range(5)] == [0x6C, 0x5C, 0x7C, 0x5C, 0x7C]
    assert count.last == 0x7C
    count.restart()
    assert count.following() == 0x6C


def test_a_constant_function_code_is_noticed():
    """Another request with the same frame count bit gets the old answer; a repetition of the same is good."""
    check = FrameCountCheck()
    first = VariableFrame(2, 0, 0x6C, b"\x01")
    assert check.follow(first) == []
    assert check.follow(Acknowledgement()) == []
    assert check.follow(FixedFrame(2, 0, 0x5C)) == []
    assert check.follow(FixedFrame(2, 0, 0x5C)) == []
    assert check.follow(VariableFrame(0, 2, 0x08, b"\x01")) == []
    assert check.follow(VariableFrame(3, 0, 0x5C, b"\x02")) == []
    (violation,) = check.follow(VariableFrame(2, 0, 0x5C, b"\x02"))
    assert (violation.kind, violation.offset) == (Kind.FRAME_COUNT, 6)
    (violation,) = check.follow(FixedFrame(2, 0, 0x5C))
    assert (violation.kind, violation.offset) == (Kind.FRAME_COUNT, 3)
    assert check.follow(first) == []


VB = Item.memory(Area.V, 0)


@pytest.mark.parametrize(
    ("pdu", "kind"),
    [
        (ReadRequest(0, ()), Kind.ITEM_COUNT),
        (ReadRequest(0x10000, (VB,)), Kind.VALUE),
        (ReadRequest(0, (VB,) * 20), Kind.LIMIT),
        (ReadRequest(0, (Item.memory(Area.V, 0, 223),)), Kind.LIMIT),
        (ReadRequest(0, (Item(0x84, 1, 2, 0, 1),)), Kind.COUNT),
        (ReadRequest(0, (Item(0x84, 2, 1, 1 << 24, 1),)), Kind.ADDRESS),
        (ReadRequest(0, (Item(0x99, 2, 1, 0, 0),)), Kind.AREA),
        (WriteRequest(0, (ItemWrite(Item.memory(Area.V, 0, 213), bytes(213)),)), Kind.LIMIT),
        (WriteRequest(0, (ItemWrite(VB, b"\x00\x00"),)), Kind.VALUE_LENGTH),
        (WriteRequest(0, (ItemWrite(Item.bit(Area.M, 0, 0), b"\x02"),)), Kind.VALUE),
        (SetupRequest(0, 70000), Kind.VALUE),
        (AckReply(0, 0x04), Kind.VALUE),
        (AckReply(0, 300), Kind.VALUE),
        (ErrorReply(0, 0, 0), Kind.VALUE),
        (ReadReply(0, (ItemResult(0xFF, b"", 4),)), Kind.VALUE_LENGTH),
        (ReadReply(0, (ItemResult(0xFF, b"\x01", 5),)), Kind.SIZE_CODE),
        (ReadReply(0, (ItemResult(0xFF, b"\x02", 3),)), Kind.VALUE),
        (ReadReply(0, (ItemResult(5, b"\x02", 4),)), Kind.VALUE_LENGTH),
    ],
)
def test_values_that_make_no_pdu(pdu, kind):
    """Encoding refuses what decoding would refuse."""
    with pytest.raises(PpiError) as caught:
        encode_pdu(pdu)
    assert caught.value.kinds == (kind,)


def test_longest_telegrams():
    """222 bytes are read with one item, 212 are written, 19 items fit: PDUs of exactly 240 bytes."""
    assert len(encode_pdu(ReadRequest(0, (VB,) * 19))) == 240
    assert len(encode_pdu(WriteRequest(0, (ItemWrite(Item.memory(Area.V, 0, 212), bytes(212)),)))) == 240
    reply = ReadReply(0, (ItemResult.of(Item.memory(Area.V, 0, 222), bytes(222)),))
    assert len(encode_pdu(reply)) == 240
    assert encode_pdu(ReadRequest(0, (Item.memory(Area.V, 0, 222),)))


@pytest.mark.parametrize(
    "frame",
    [
        VariableFrame(2, 2, 0x6C, b"\x32"),
        VariableFrame(128, 0, 0x6C, b"\x32"),
        VariableFrame(300, 0, 0x6C, b"\x32"),
        VariableFrame(2, 0, 0x4C, b"\x32"),
        VariableFrame(2, 0, 0x6C, b""),
        VariableFrame(2, 0, 0x6C, bytes(247)),
        DataFrame(2, 0, 0x6C, bytes(7)),
        TokenFrame(127, 0),
        FixedFrame(2, 127, 0x49),
        FixedFrame(2, -1, 0x49),
    ],
)
def test_values_that_make_no_frame(frame):
    """Addresses over 126, reserved function codes and impossible lengths are refused."""
    with pytest.raises(PpiError):
        encode_frame(frame)


def test_run_is_fixed_byte_by_byte():
    """Every byte of RUN and STOP counts."""
    pdu = encode_pdu(RunRequest(1))
    for offset in range(11, len(pdu)):
        damaged = bytearray(pdu)
        damaged[offset] ^= 0x01
        if b"P_PROGRAM" not in damaged or damaged[20] != 9:
            continue
        with pytest.raises(PpiError) as caught:
            decode_pdu(bytes(damaged))
        assert caught.value.kinds == (Kind.SERVICE,)
        assert caught.value.violations[0].offset == offset
