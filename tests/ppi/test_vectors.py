"""Every frame of the seed document, and its misprints."""

import pytest

from plcgen.ppi.wire.address import address_text, parse_item
from plcgen.ppi.wire.errors import PpiError
from plcgen.ppi.wire.fdl import decode_frame, encode_frame
from plcgen.ppi.wire.model import ReadRequest, VariableFrame, WriteRequest
from plcgen.ppi.wire.pdu import decode_pdu, encode_pdu
from plcgen.ppi.wire.telegram import decode_telegram, examine
from tests.ppi.vectors import FRAMES, WRONG, frame, octets, pdu, tables


def test_every_seed_frame_is_there():
    """The seed document holds 47 frames; no vector is listed twice."""
    assert len(FRAMES) == len(tables()["frames"]) == 47
    assert len(WRONG) == len(tables()["wrong"])


@pytest.mark.parametrize("name", FRAMES)
def test_vector(name):
    """Each vector decodes to its object and encodes to its bytes, frame and PDU."""
    row = FRAMES[name]
    assert decode_frame(octets(row)) == frame(row)
    assert encode_frame(frame(row)) == octets(row)
    assert decode_telegram(octets(row)).pdu == pdu(row)
    if isinstance(frame(row), VariableFrame):
        assert decode_pdu(frame(row).pdu) == pdu(row)
        assert encode_pdu(pdu(row)) == frame(row).pdu


@pytest.mark.parametrize("name", [name for name, row in FRAMES.items() if "text" in row])
def test_vector_in_words(name):
    """The addresses an engineer writes are the items of the telegram, and back."""
    row = FRAMES[name]
    request = pdu(row)
    assert isinstance(request, ReadRequest | WriteRequest)
    items = request.items if isinstance(request, ReadRequest) else tuple(entry.item for entry in request.items)
    assert tuple(parse_item(text) for text in row["text"]) == items
    assert [address_text(item) for item in items] == row["text"]


@pytest.mark.parametrize("name", WRONG)
def test_misprint(name):
    """What the seed document prints wrong is refused for the right reasons, all of them."""
    row = WRONG[name]
    assert [violation.kind.value for violation in examine(octets(row)).violations] == row["violations"]
    with pytest.raises(PpiError) as caught:
        decode_telegram(octets(row))
    assert [kind.value for kind in caught.value.kinds] == row["violations"]
