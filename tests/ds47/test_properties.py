"""Symmetry and robustness over generated telegrams."""

import contextlib
from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st

from plcgen.ds47.wire import formats
from plcgen.ds47.wire.codec import TelegramError, decode_request, decode_response, encode_request, encode_response
from plcgen.ds47.wire.dissect import dissect_request, dissect_response, looks_like
from plcgen.ds47.wire.formats import FormatKind
from plcgen.ds47.wire.model import ErrorBlock, ParameterAddress, Request, Response, ValueBlock, ZeroBlock

WRITABLE = [item for item in formats.FORMATS if item.writable]
byte = st.integers(0, 255)
reference = st.integers(1, 255)


@st.composite
def blocks(draw, most=6):
    """Draw a value block of any format."""
    fmt = draw(st.sampled_from(WRITABLE))
    count = draw(st.integers(0, most))
    return ValueBlock(fmt.code, count, draw(st.binary(min_size=count * fmt.size, max_size=count * fmt.size)))


@st.composite
def requests(draw):
    """Draw a valid request: up to 3 parameters keeps it below the record limit."""
    change = draw(st.booleans())
    values = tuple(draw(st.lists(blocks(), min_size=1, max_size=3)))
    addresses = tuple(
        ParameterAddress(
            draw(st.integers(1, 65535)),
            draw(st.integers(0, 0xFFFE)),
            block.count if change else draw(st.integers(0, 234)),
            draw(st.sampled_from([0x10, 0x20, 0x30])),
        )
        for block in values
    )
    return Request(draw(reference), 2 if change else 1, draw(byte), addresses, values if change else ())


errors = st.builds(ErrorBlock, byte, st.none() | st.integers(0, 65535))


@st.composite
def responses(draw):
    """Draw a valid response of each kind."""
    kind = draw(st.sampled_from([0x01, 0x02, 0x80, 0x81, 0x82]))
    good = st.just(ZeroBlock()) if kind == 0x82 else blocks(4)
    if kind == 0x02:
        items, count = [], draw(st.integers(1, 39))
    elif kind == 0x80 or (kind > 0x80 and draw(st.booleans())):
        items, count = [draw(errors)], draw(st.integers(1, 39))
    else:
        items = draw(st.lists(good | errors if kind > 0x80 else good, min_size=1, max_size=4))
        if kind > 0x80:
            items.append(draw(errors))
        count = len(items)
    return Response(draw(reference), kind, draw(byte), count, tuple(items))


@given(requests())
def test_request_symmetry(value):
    """decode(encode(request)) is the request."""
    assert decode_request(encode_request(value)) == value


@given(responses())
def test_response_symmetry(value):
    """decode(encode(response)) is the response."""
    assert decode_response(encode_response(value)) == value


def near(valid):
    """Arbitrary bytes, and valid telegrams with one byte changed or cut short."""

    def damage(item):
        data, position, value, length = item
        changed = bytearray(data)
        changed[position % len(data)] = value
        return bytes(changed)[: length % (len(data) + 2)]

    damaged = st.tuples(valid, st.integers(0, 300), byte, st.integers(0, 300)).map(damage)
    header = st.tuples(byte, st.sampled_from([1, 2, 0x80, 0x81, 0x82]), byte, st.integers(0, 4)).map(bytes)
    return st.binary(max_size=60) | damaged | st.tuples(header, st.binary(max_size=60)).map(b"".join)


telegrams = near(requests().map(encode_request) | responses().map(encode_response))


@given(telegrams)
def test_decoding_raises_telegram_errors_only(data):
    """Any bytes decode or raise TelegramError with offsets inside the telegram; what decodes encodes back."""
    for decode, encode in ((decode_request, encode_request), (decode_response, encode_response)):
        try:
            value = decode(data)
        except TelegramError as error:
            offsets = [problem.offset for problem in error.problems]
        else:
            offsets = []
            assert encode(value) == data
        assert offsets == sorted(offsets)
        assert all(0 <= offset <= len(data) for offset in offsets)
        with contextlib.suppress(TelegramError):
            decode(data, strict=False)


@given(telegrams)
def test_dissection_covers_every_byte_once(data):
    """Fields lie one behind the other from byte 0 to the last one; nothing raises."""
    looks_like(data)
    for dissect in (dissect_request, dissect_response):
        fields = dissect(data)
        assert sum(field.length for field in fields) == len(data)
        starts = [field.offset for field in fields] + [len(data)]
        assert all(a + field.length == b for field, (a, b) in zip(fields, pairwise(starts), strict=True))


@given(telegrams)
def test_what_decodes_is_not_marked(data):
    """A telegram that decodes strictly has no marked field."""
    for decode, dissect in ((decode_request, dissect_request), (decode_response, dissect_response)):
        with contextlib.suppress(TelegramError):
            decode(data)
            assert not any(field.problem for field in dissect(data))


@st.composite
def format_values(draw):
    """Draw a format and values it takes."""
    fmt = draw(st.sampled_from([item for item in WRITABLE if not item.is_string]))
    limits = formats.integer_range(fmt)
    if fmt.kind is FormatKind.BOOLEAN:
        value = st.booleans()
    elif limits:
        value = st.integers(*limits)
    elif fmt.kind is FormatKind.FLOAT:
        value = st.floats(allow_nan=False, allow_infinity=False, width=8 * fmt.size)
    else:
        value = st.binary(min_size=fmt.size, max_size=fmt.size)
    return fmt, draw(st.lists(value, max_size=5))


@given(format_values())
def test_values_symmetry(case):
    """unpack(pack(values)) is the values, forevery format."""
    fmt, values = case
    assert formats.unpack_values(fmt, len(values), formats.pack_values(fmt, values)) == values
