"""Hypothesis strategies for frames and PDUs."""

from hypothesis import strategies as st

from plcgen.ppi.wire import model
from plcgen.ppi.wire.areas import ELEMENT_SIZES, Area, SizeCode, TransportSize
from plcgen.ppi.wire.model import Item

byte = st.integers(0, 255)
reference = st.integers(0, 0xFFFF)
station = st.integers(0, 126)
MEMORY = [area for area in Area if area not in ELEMENT_SIZES]
SIZES = [size for size in TransportSize if size not in ELEMENT_SIZES.values() and size != TransportSize.BIT]

bits = st.builds(Item.bit, st.sampled_from(MEMORY), st.integers(0, 2097151), st.integers(0, 7))
elements = st.builds(Item.element, st.sampled_from(list(ELEMENT_SIZES)), st.integers(0, 0xFFFFFF), st.integers(1, 3))


def memory(most):
    """Items of whole bytes with up to ``most`` elements."""
    return st.builds(
        Item.memory, st.sampled_from(MEMORY), st.integers(0, 2097151), st.integers(1, most), st.sampled_from(SIZES)
    )


read_requests = st.builds(
    lambda number, items: model.ReadRequest(number, tuple(items)),
    reference,
    st.lists(bits | memory(1) | elements, min_size=1, max_size=8) | st.lists(memory(55), min_size=1, max_size=1),
)


@st.composite
def values(draw, item):
    """Bytes for an item."""
    if item.size == TransportSize.BIT:
        return draw(st.sampled_from([b"\x00", b"\x01"]))
    return draw(st.binary(min_size=item.octets, max_size=item.octets))


@st.composite
def write_requests(draw):
    """Draw a write; the last odd value with or without pad."""
    items = draw(st.lists(bits | memory(2) | elements, min_size=1, max_size=6))
    entries = tuple(model.ItemWrite(item, draw(values(item))) for item in items)
    padded = len(entries[-1].data) % 2 == 1 and draw(st.booleans())
    return model.WriteRequest(draw(reference), entries, padded)


@st.composite
def force_requests(draw):
    """Draw a force or unforce."""
    item = draw(bits | memory(3))
    return model.ForceRequest(draw(reference), item, draw(values(item)) if draw(st.booleans()) else None)


codes = st.sampled_from([0xFF, 0x01, 0x03, 0x05, 0x06, 0x07, 0x0A])
results = (
    st.builds(model.ItemResult, codes.filter(lambda code: code != 0xFF))
    | st.builds(lambda bit: model.ItemResult(0xFF, bytes([bit]), SizeCode.BIT), st.integers(0, 1))
    | st.builds(
        lambda data, size: model.ItemResult(0xFF, data, size),
        st.binary(min_size=1, max_size=9),
        st.sampled_from([SizeCode.WORDS, SizeCode.OCTETS]),
    )
)
word = st.integers(0, 0xFFFF)
jobs = st.sampled_from([0x1A, 0x1D, 0x00]).map(lambda function: bytes([function, 1, 2]))
requests = (
    read_requests
    | write_requests()
    | force_requests()
    | st.builds(model.RunRequest, reference)
    | st.builds(model.StopRequest, reference)
    | st.builds(model.SetupRequest, reference, word, word, word)
    | st.builds(model.UnknownJob, reference, jobs, st.binary(max_size=20))
    | st.builds(model.Userdata, reference, st.binary(max_size=8), st.binary(max_size=20))
)
rosctr = st.sampled_from([2, 3])
error_class = st.integers(1, 255)
replies = (
    st.builds(model.ReadReply, reference, st.lists(results, min_size=1, max_size=15).map(tuple))
    | st.builds(model.WriteReply, reference, st.lists(codes, min_size=1, max_size=19).map(tuple))
    | st.builds(model.SetupReply, reference, word, word, word)
    | st.builds(model.AckReply, reference, st.sampled_from([None, 0x28, 0x29]))
    | st.builds(model.ErrorReply, reference, error_class, byte, rosctr, st.binary(max_size=5), st.binary(max_size=9))
    | st.builds(model.UnknownReply, reference, st.just(b"\x1a\x00"), st.binary(max_size=20), rosctr)
)
pdus = requests | replies

REQUEST_CODES = [0x6C, 0x5C, 0x7C, 0x49, 0x6D]
ANSWER_CODES = [0x00, 0x02, 0x03, 0x08, 0x0A, 0x38]


@st.composite
def frames(draw):
    """Draw a valid frame of each kind; SD2 carries a valid PDU."""
    kind = draw(st.sampled_from(["variable", "fixed", "data", "token", "acknowledgement"]))
    if kind == "acknowledgement":
        return model.Acknowledgement()
    destination, source = draw(st.tuples(station, station).filter(lambda pair: pair[0] != pair[1]))
    if kind == "token":
        if {destination, source} & {0x10, 0x68}:  # start bytes: not believed before the station has spoken
            return model.TokenFrame(0, 1)
        return model.TokenFrame(destination, source)
    function = draw(st.sampled_from(REQUEST_CODES + ANSWER_CODES))
    if kind == "fixed":
        return model.FixedFrame(destination, source, function)
    if kind == "data":
        return model.DataFrame(destination, source, function, draw(st.binary(min_size=8, max_size=8)))
    from plcgen.ppi.wire.pdu import encode_pdu

    return model.VariableFrame(destination, source, function, encode_pdu(draw(pdus)))


@st.composite
def damaged(draw, valid):
    """Valid bytes with some bytes changed, cut short, or prolonged."""
    data = bytearray(draw(valid))
    for _ in range(draw(st.integers(0, 3))):
        data[draw(st.integers(0, len(data) - 1))] = draw(byte)
    data += draw(st.binary(max_size=3))
    return bytes(data[: draw(st.integers(0, len(data)))]) if draw(st.booleans()) else bytes(data)
