"""Bytes to telegrams and back, and every violation with its offset."""

import pytest

from plcgen.ds47.wire import codec, formats, model
from plcgen.ds47.wire.codec import TelegramError, decode_request, decode_response, encode_request, encode_response
from plcgen.ds47.wire.model import ErrorBlock, ParameterAddress, Request, Response, ValueBlock
from tests.ds47.vectors import REQUESTS, RESPONSES, octets, request, response

REAL = formats.by_name("FloatingPoint")


@pytest.mark.parametrize("name", REQUESTS)
def test_request_vector(name):
    """Each request vector decodes to its object, encodes to its bytes and has the computed length."""
    row = REQUESTS[name]
    assert decode_request(octets(row)) == request(row)
    assert encode_request(request(row)) == octets(row)
    assert model.request_size(request(row)) == len(octets(row))


@pytest.mark.parametrize("name", RESPONSES)
def test_response_vector(name):
    """Each response vector decodes to its object, encodes to its bytes and has the computed length."""
    row = RESPONSES[name]
    asked = request(REQUESTS[row["answers"]]) if "answers" in row else None
    assert decode_response(octets(row), request=asked) == response(row)
    assert encode_response(response(row)) == octets(row)
    assert model.response_size(response(row)) == len(octets(row))


def _problems(call, data, **options):
    with pytest.raises(TelegramError) as caught:
        call(bytes.fromhex(data), **options)
    return [(p.offset, p.message) for p in caught.value.problems]


BAD_REQUESTS = {
    "": [(0, "header needs 4 bytes")],
    "01 01 01": [(0, "header needs 4 bytes")],
    "00 01 01 01 10 01 00 01 00 00": [(0, "reference 00h")],
    "01 03 01 01 10 01 00 01 00 00": [(1, "request id 03h is reserved")],
    "01 40 01 01 10 01 00 01 00 00": [(1, "manufacturer-specific")],
    "01 7F 01 01 10 01 00 01 00 00": [(1, "manufacturer-specific")],
    "01 80 01 01 10 01 00 01 00 00": [(1, "request id 80h is reserved")],
    "01 01 01 00": [(3, "0 parameters")],
    "01 01 01 01 11 01 00 01 00 00": [(4, "attribute 11h")],
    "01 01 01 01 10 EB 00 01 00 00": [(5, "235 elements")],
    "01 01 01 01 10 01 00 00 00 00": [(6, "parameter number 0")],
    "01 01 01 01 10 01 00 01 FF FF": [(8, "subindex FFFFh")],
    "01 01 01 01 10 01 00 01 00": [(4, "address of parameter 1 needs 6 bytes, the telegram has 5 left")],
    "01 01 01 01 10 01 00 01 00 00 00": [(10, "1 bytes follow")],
    "01 02 01 01 10 01 00 01 00 00": [(10, "value of parameter 1 needs 2 bytes")],
    "01 02 01 01 10 01 00 01 00 00 08 01 00 00 00": [(12, "1 x FloatingPoint needs 4 bytes")],
    "01 02 01 01 10 01 00 01 00 00 05 01 07": [(13, "pad byte of the value of parameter 1 needs 1")],
    "01 02 01 01 10 01 00 01 00 00 05 01 07 01": [(13, "pad byte of the value of parameter 1 is 01h")],
    "01 02 01 01 10 01 00 01 00 00 0E 01 07 01": [(10, "format 0Eh is unknown")],
    "01 02 01 01 10 01 00 01 00 00 44 01 00 01": [(10, "occurs in responses only")],
    "01 02 01 01 10 02 00 01 00 00 06 01 00 01": [(5, "2 elements, but 1 values")],
    "01 02 01 01 10 00 00 01 00 00 06 02 00 01 00 02": [(5, "0 elements, but 2 values")],
}


@pytest.mark.parametrize("data", BAD_REQUESTS)
def test_wrong_request(data):
    """A wrong request raises TelegramError with what is wrong at which byte."""
    found = _problems(decode_request, data)
    assert len(found) == len(BAD_REQUESTS[data])
    for (offset, message), (want_offset, want) in zip(found, BAD_REQUESTS[data], strict=True):
        assert (offset, want in message) == (want_offset, True), message


def test_all_violations_at_once():
    """Six violations of one request are reported together, in the order of the bytes."""
    found = _problems(decode_request, "00 05 02 02 11 FF 00 00 FF FF")
    assert [offset for offset, _ in found] == [0, 1, 4, 5, 6, 8, 10]


BAD_RESPONSES = {
    "03 03 02 01 08 01 41 20 00 00": [1],
    "00 01 02 01 08 01 41 20 00 00": [0],
    "03 01 02 01 08 01 41 20 00": [6],
    "03 01 02 01 44 01 00 02": [4],
    "03 01 02 02 08 01 41 20 00 00": [10],
    "03 01 02 01 40 00": [4],
    "03 81 02 01 08 01 41 20 00 00": [1],
    "03 82 02 01 40 00": [1],
    "03 82 02 02 44 01 00 02 08 01 41 20 00 00": [8],
    "03 81 02 02 44 01 00 02 40 00": [8],
    "03 81 02 01 44 03 00 02 00 00 00 00": [5],
    "03 81 02 01 44 00": [5],
    "03 81 02 01 44 01 01 00": [6],
    "03 81 02 01 44 02 00 02": [8],
    "02 02 00 02 00": [4],
    "03 01 02 01 42 EB" + " 00" * 470: [5, 240],
    "03 82 02 02 44 01 00 02 40 01": [8, 9],
    "05 80 01 02 44 01 00 21 44 01 00 21": [8],
}


@pytest.mark.parametrize("data", BAD_RESPONSES)
def test_wrong_response(data):
    """A wrong response raises TelegramError; the list names the offset of each violation."""
    assert [offset for offset, _ in _problems(decode_response, data)] == BAD_RESPONSES[data]


def test_mirror_is_checked():
    """Against its request a response must mirror reference, kind, drive object and n."""
    asked = request(REQUESTS["dcm-read-p50303"])
    found = _problems(decode_response, "04 02 01 02", request=asked)
    assert [offset for offset, _ in found] == [0, 1, 2, 3]


def test_count_is_checked_against_the_request():
    """One value for two elements is a violation; the information in 80h has no kind to mirror."""
    asked = request(REQUESTS["mm4-read-p1120-p2155"])
    data = "01 01 00 02 43 01 41 20 00 00 43 01 41 F0 00 00"
    assert _problems(decode_response, data, request=asked)[0][0] == 11
    decode_response(bytes.fromhex("01 80 00 02 44 01 00 21"), request=asked)


def test_tolerant_request():
    """Without strict a server sees wrong ids, reserved fields, unknown formats and trailing bytes."""
    data = bytes.fromhex("00 02 01 02 10 01 00 00 FF FF 50 01 00 01 00 00 0E 01 07 08 09")
    found = decode_request(data, strict=False)
    assert [a.attribute for a in found.addresses] == [0x10, 0x50]
    assert found.values == (ValueBlock(0x0E, 1, b"\x07\x08\x09"),)
    trailing = decode_request(bytes.fromhex("01 01 01 01 10 01 00 01 00 00 AA"), strict=False)
    assert trailing == Request(1, 1, 1, (ParameterAddress(1),))


def test_tolerant_response():
    """Without strict a pad other than 00h and trailing bytes are accepted."""
    data = bytes.fromhex("01 01 01 01 05 01 07 55 AA")
    assert decode_response(data, strict=False).blocks == (ValueBlock(5, 1, b"\x07"),)


def test_values_must_suit_their_addresses():
    """A change without values, or a read with values, is no request that can be encoded."""
    address = (ParameterAddress(1),)
    block = ValueBlock.of(REAL, [1.0])
    for wrong in (Request(1, 2, 1, address), Request(1, 1, 1, address, (block,))):
        with pytest.raises(TelegramError):
            encode_request(wrong)
    assert len(encode_request(Request(1, 2, 1, address), strict=False)) == 10


def test_block_bytes_must_suit_their_format():
    """Three bytes are no FloatingPoint and an even misfit is found too."""
    for data in (b"\x00\x00\x00", bytes(8)):
        with pytest.raises(TelegramError):
            encode_response(Response(1, 1, 1, 1, (ValueBlock(8, 1, data),)))


@pytest.mark.parametrize(
    "wrong",
    [
        Request(256, 1, 1, (ParameterAddress(1),)),
        Request(1, 1, -1, (ParameterAddress(1),)),
        Request(1, 1, 1, (ParameterAddress(65536),)),
        Request(1, 1, 1, (ParameterAddress(1, subindex=65536),)),
        Request(1, 1, 1, (ParameterAddress(1, elements=256),)),
        Request(1, 1, 1, (ParameterAddress(1),) * 256),
    ],
)
def test_field_that_does_not_fit(wrong):
    """A number that does not fit its field is a TelegramError even without strict."""
    with pytest.raises(TelegramError, match="takes 0 to"):
        encode_request(wrong, strict=False)


def test_error_words():
    """An error block has one or two words and always sixteen bits each."""
    with pytest.raises(TelegramError):
        encode_response(Response(1, 0x81, 1, 1, (ErrorBlock(0x10000),)))
    assert encode_response(Response(1, 0x81, 1, 1, (ErrorBlock(2),)))[4:] == bytes.fromhex("44 01 00 02")


def _changes(fmt, count):
    block = ValueBlock.of(formats.by_name(fmt), [0])
    return model.change_request(1, 1, [(ParameterAddress(n + 1), block) for n in range(count)])


@pytest.mark.parametrize(
    ("fmt", "most", "size"),
    [
        ("FloatingPoint", 19, 232),  # 4 + 19 x (6 + 2 + 4)
        ("DoubleWord", 19, 232),
        ("Word", 23, 234),  # 4 + 23 x (6 + 2 + 2)
        ("Byte", 23, 234),  # 4 + 23 x (6 + 2 + 1 + pad)
        ("Float64", 14, 228),  # 4 + 14 x (6 + 2 + 8)
    ],
)
def test_most_single_writes(fmt, most, size):
    """The 240-byte record holds this many single writes; one more is refused."""
    assert len(encode_request(_changes(fmt, most))) == size
    with pytest.raises(TelegramError, match="record limit of 240"):
        encode_request(_changes(fmt, most + 1))


def test_most_single_reads():
    """39 single reads make 4 + 39 x 6 = 238 bytes; 40 exceed the count and the record limit."""
    addresses = [ParameterAddress(n) for n in range(1, 41)]
    assert len(encode_request(model.read_request(1, 1, addresses[:39]))) == 238
    found = _problems(decode_request, encode_request(model.read_request(1, 1, addresses), strict=False).hex())
    assert [offset for offset, _ in found] == [3, 240]


@pytest.mark.parametrize(("fmt", "read", "write"), [("Byte", 234, 228), ("Word", 117, 114), ("DoubleWord", 58, 57)])
def test_longest_array(fmt, read, write):
    """One record carries an array of 234 B, 117 W or 58 DW to the master and 228, 114 or 57 back."""
    item = formats.by_name(fmt)
    for count, good in ((read, True), (read + 1, False)):
        answer = Response(1, 1, 1, 1, (ValueBlock.of(item, [0] * count),))
        assert (model.response_size(answer) <= model.RECORD_LIMIT) is good
    for count, good in ((write, True), (write + 1, False)):
        change = model.change_request(1, 1, [(ParameterAddress(1, 0, count), ValueBlock.of(item, [0] * count))])
        assert (model.request_size(change) <= model.RECORD_LIMIT) is good


def test_negative_answer_size():
    """A negative write answer takes 4 + 6n bytes with two words, 4 + 4n with one."""
    assert [model.negative_size(1), model.negative_size(2), model.negative_size(2, 1)] == [10, 16, 12]
    blocks = (ErrorBlock(2, 0), ErrorBlock(2, 0))
    assert len(encode_response(Response(1, 0x82, 1, 2, blocks))) == 16


def test_counts():
    """The number of elements equals the count, or is 0 with one value."""
    pairs = {
        (0, 1): True,
        (1, 1): True,
        (2, 2): True,
        (0, 0): True,
        (0, 2): False,
        (1, 2): False,
        (1, 0): False,
    }
    assert {pair: codec.count_matches(*pair) for pair in pairs} == pairs
