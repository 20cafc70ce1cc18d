"""Symmetry and robustness over generated frames and PDUs."""

import contextlib
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from plcgen.ppi.wire.dissect import FrameText, dissect, title
from plcgen.ppi.wire.errors import PpiError
from plcgen.ppi.wire.fdl import checksum, decode_frame, encode_frame
from plcgen.ppi.wire.model import VariableFrame
from plcgen.ppi.wire.pdu import decode_pdu, encode_pdu
from plcgen.ppi.wire.stream import Splitter, split
from plcgen.ppi.wire.telegram import decode_telegram, examine
from tests.ppi.strategies import damaged, frames, pdus


@given(pdus)
def test_pdu_symmetry(pdu):
    """decode(encode(pdu)) is the PDU."""
    assert decode_pdu(encode_pdu(pdu)) == pdu


@given(frames())
def test_frame_symmetry(frame):
    """decode(encode(frame)) is the frame, and bytes come back as they were."""
    data = encode_frame(frame)
    assert decode_frame(data) == frame
    assert encode_frame(decode_frame(data)) == data


encoded = frames().map(encode_frame)
anything = st.binary(max_size=60) | damaged(encoded) | damaged(pdus.map(encode_pdu))


def closed(data):
    """Give an SD2 frame right lengths, checksum and end byte again, so that the PDU is what is wrong."""
    if len(data) < 10 or data[0] != 0x68 or len(data) > 255:
        return data
    body = data[4:-2]
    return bytes((0x68, len(body), len(body), 0x68)) + body + bytes((checksum(body), 0x16))


def refused(decode_it, data):
    """Return the violations with which something is refused; none if it is accepted."""
    try:
        decode_it(data)
    except PpiError as error:
        return error.violations or pytest.fail("an error without a violation")
    return ()


@given(anything | damaged(encoded).map(closed))
def test_decoding_raises_ppi_errors_only(data):
    """Any bytes decode or raise PpiError with offsets inside; what decodes strictly encodes back to the same bytes."""
    for decode_it in (decode_frame, decode_telegram, decode_pdu):
        violations = refused(decode_it, data)
        assert all(0 <= violation.offset <= len(data) for violation in violations)
        assert list(violations) == sorted(violations, key=lambda violation: violation.offset)
    with contextlib.suppress(PpiError):
        assert encode_frame(decode_frame(data)) == data
    with contextlib.suppress(PpiError):
        telegram = decode_telegram(data)
        if isinstance(telegram.frame, VariableFrame):
            assert encode_pdu(telegram.pdu) == telegram.frame.pdu
    with contextlib.suppress(PpiError):
        pdu = decode_pdu(data)
        assert encode_pdu(pdu) == data


@pytest.mark.slow
@given(anything | damaged(encoded).map(closed))
def test_dissection_covers_every_byte_once(data):
    """Fields lie one behind the other from byte 0 to the last one; nothing raises; what is valid is not marked."""
    seen = examine(data)
    fields = dissect(data, seen.violations)
    assert sum(field.length for field in fields) == len(data)
    starts = [field.offset for field in fields] + [len(data)]
    assert all(a + field.length == b for field, (a, b) in zip(fields, pairwise(starts), strict=True))
    assert title(data)
    assert FrameText().line(data, seen.frame, seen.pdu)
    if not seen.violations:
        assert not any(field.problem for field in fields)
    for violation in seen.violations:
        inside = [f for f in fields if f.offset <= violation.offset < f.offset + f.length]
        assert all(field.problem for field in inside)


# ---- Streams --------------------------------------------------------------------------------------------------

garbage = st.binary(max_size=12).map(
    lambda data: bytes(byte for byte in data if byte not in {0x10, 0x68, 0xA2, 0xDC, 0xE5})
)


@pytest.mark.slow
@given(st.lists(st.tuples(garbage, frames()), max_size=6), garbage, st.data())
def test_splitting_finds_every_frame(parts, last, data):
    """Whatever pieces the bytes come in: frames come out whole, and everything else is reported with its place."""
    stream = b"".join(noise + encode_frame(frame) for noise, frame in parts) + last
    splitter = Splitter()
    found, at = [], 0
    while at < len(stream):
        size = data.draw(st.integers(1, 40))
        found += splitter.feed(stream[at : at + size])
        at += size
    found += splitter.finish()
    assert [chunk.data for chunk in found if chunk.frame] == [encode_frame(frame) for _, frame in parts]
    assert b"".join(chunk.data for chunk in found) == stream
    assert all(stream[chunk.offset : chunk.offset + len(chunk.data)] == chunk.data for chunk in found)
    assert splitter.pending == 0
    assert split(stream) == found


@pytest.mark.slow
@given(st.binary(max_size=400) | st.lists(damaged(encoded), max_size=5).map(b"".join), st.booleans())
def test_splitting_loses_no_byte(stream, tolerant):
    """Any bytes are frames that decode, or garbage; together they are the stream."""
    found = split(stream, tolerant=tolerant)
    assert b"".join(chunk.data for chunk in found) == stream
    assert all(a.frame or b.frame for a, b in pairwise(found))
    for chunk in found:
        if chunk.frame:
            seen = examine(chunk.data)
            assert seen.frame is not None
            assert {violation.kind for violation in seen.violations}.isdisjoint(
                {"checksum", "end", "length", "short", "trailing", "repeated length"}
            )
