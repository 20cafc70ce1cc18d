"""What the gateway passes on: reads, allowed writes, nothing else; what clients hear when something is wrong."""

import pytest

from plcgen.base.line.model import LineError, LineLostError
from plcgen.ppi.gateway import PAUSE, Allowed, Passing
from plcgen.ppi.wire.address import PpiAddressError, parse_item
from plcgen.ppi.wire.model import (
    ErrorReply,
    ForceRequest,
    Item,
    ItemWrite,
    ReadRequest,
    RunRequest,
    SetupReply,
    SetupRequest,
    StopRequest,
    UnknownJob,
    Userdata,
    WriteRequest,
)
from plcgen.ppi.wire.pdu import decode_pdu, encode_pdu
from tests.ppi.client.support import connect
from tests.ppi.client.test_client import requests


class Rig:
    """A gateway's inner part in front of a simulated station."""

    def __init__(self, *allowed, faults=(), **station):
        self.client, self.plc, self.bus, self.line = connect(faults, **station)
        self.told = []
        self.time = 0.0
        self.opened = 0
        self.broken = None
        self.passing = Passing(
            self.open, Allowed.of(allowed), lambda *words: self.told.append(words), lambda: self.time
        )

    def open(self):
        """Open the line."""
        self.opened += 1
        if self.broken:
            raise self.broken
        return self.client

    def ask(self, request):
        """Answer to a request of a client."""
        answer = self.passing.answer(encode_pdu(request), "client")
        return decode_pdu(answer)


def read(*addresses):
    """A read request of addresses, or of items."""
    items = (parse_item(each) if isinstance(each, str) else each for each in addresses)
    return ReadRequest(0x1234, tuple(items))


def write(**values):
    """A write request: ``write(VB1="0A")``."""
    items = [parse_item(name.replace("_", ".")) for name in values]
    data = map(bytes.fromhex, values.values())
    return WriteRequest(0x1234, tuple(ItemWrite(item, each) for item, each in zip(items, data, strict=True)))


def test_a_read_is_passed_on():
    """Values in the order asked, with the client's reference; V is data block 1."""
    rig = Rig(values={"VB100": 0x22, "M0.0": True, "T32": 5})
    reply = rig.ask(read("VB100", "M0.0", "T32"))
    assert reply.reference == 0x1234
    assert [result.data.hex() for result in reply.results] == ["22", "01", "0000000005"]


def test_negotiation_is_answered_here():
    """PDU of at most 240 bytes, one job at a time; nothing reaches the line."""
    rig = Rig()
    assert rig.ask(SetupRequest(7, 960, 8, 8)) == SetupReply(7, 240, 1, 1)
    assert rig.ask(SetupRequest(7, 100, 8, 8)).pdu_size == 100
    assert rig.opened == 0


@pytest.mark.parametrize(
    ("item", "code"),
    [
        (Item(0x84, 2, 1, 0, db=2), 0x0A), (Item(0x1D, 0x1D, 1, 0), 0x0A), (Item(0x85, 2, 1, 0), 0x0A),
        (Item(0x84, 1, 8, 0, db=1), 0x06), (Item(0x84, 0x1C, 1, 0, db=1), 0x06), (Item(0x84, 2, 0, 0, db=1), 0x07),
        (Item(0x84, 2, 1, 3, db=1), 0x05), (Item(0x84, 2, 1, 9000 * 8, db=1), 0x05),
    ],
)  # fmt: skip
def test_items_that_no_s7_200_has(item, code):
    """DB2, S7-300 timers, local data, eight bits, a counter in V, no bytes, a crooked address, beyond V; its neighbour
    is read all the same.
    """
    rig = Rig(values={"VB0": 9})
    pdu = bytearray(encode_pdu(read("VB1", "VB0")))
    pdu[12 + 3] = item.size
    pdu[12 + 4 : 12 + 6] = item.count.to_bytes(2)
    pdu[12 + 6 : 12 + 8] = item.db.to_bytes(2)
    pdu[12 + 8] = item.area
    pdu[12 + 9 : 12 + 12] = item.address.to_bytes(3)
    reply = decode_pdu(rig.passing.answer(bytes(pdu), "client"))
    assert [result.code for result in reply.results] == [code, 0xFF]
    assert reply.results[1].data == b"\x09"


@pytest.mark.parametrize(
    "request_",
    [
        RunRequest(1), StopRequest(1), ForceRequest(1, parse_item("QB0"), b"\x01"),
        Userdata(1, b"\x00\x01\x12\x04", b""),
        UnknownJob(1, b"\x1a\x00", b""), UnknownJob(1, b"\x28\x00\x00\x00\x00\x00\x00\xfd\x00\x0a\x01\x00", b""),
    ],
)  # fmt: skip
def test_nothing_else_is_ever_passed_on(request_):
    """RUN, STOP, force, SZL, download, another program service: 8104h, and the line is not even opened."""
    rig = Rig("V", "M", "Q")
    assert rig.ask(request_) == ErrorReply(1, 0x81, 0x04)
    assert rig.opened == 0
    assert rig.plc.executed == 0


def test_read_only_by_default():
    """A write is refused with 03, told, and does not reach the line."""
    rig = Rig()
    assert rig.ask(write(VB100="22")).codes == (3,)
    assert rig.told == [("client", "VB100 = 22", "access denied")]
    assert rig.plc.executed == 0


@pytest.mark.parametrize(
    ("allowed", "address", "good"),
    [
        ("V", "VB8000[2]", True), ("VB100[20]", "VB100[20]", True), ("VB100[20]", "VW118", True),
        ("VB100[20]", "VW119", False), ("VB100[20]", "VB99", False), ("VB100[20]", "MB100", False),
        ("VB100", "V100.7", True), ("M0.3", "M0.3", True), ("M0.3", "M0.4", False), ("M0.3", "MB0", False),
        ("VW100", "VB101", True), ("Q", "Q0.0", True),
    ],
)  # fmt: skip
def test_where_writing_is_allowed(allowed, address, good):
    """The whole of an item must lie in one allowed range."""
    assert Allowed.of([allowed]).permits(parse_item(address)) is good


@pytest.mark.parametrize("word", ["X", "T", "", "V100", "VB0[0]"])
def test_what_cannot_be_allowed(word):
    """Timers cannot be written, a typing error is one."""
    with pytest.raises(PpiAddressError):
        Allowed.of([word])


def test_an_allowed_write_is_passed_on_and_told():
    """Only the item that may be written is; both are in the log."""
    rig = Rig("VB100[20]")
    assert rig.ask(write(VB100="22", MB0="01", V101_3="01")).codes == (0xFF, 3, 0xFF)
    assert (rig.plc["VB100"], rig.plc["MB0"], rig.plc["VB101"]) == (0x22, 0, 8)
    assert [words[1:] for words in rig.told] == [
        ("VB100 = 22", "ok"), ("MB0 = 01", "access denied"), ("V101.3 = 01", "ok"),
    ]  # fmt: skip


def test_writes_that_overlap_are_written_in_their_order():
    """S7 allows one request to write a place twice; the last value stays."""
    rig = Rig("V")
    assert rig.ask(write(VB100="01", VW100="0203")).codes == (0xFF, 0xFF)
    assert rig.plc["VW100"] == 0x0203


def test_timers_are_never_written():
    """Not even where everything of V and M is allowed."""
    rig = Rig("V", "M")
    assert rig.ask(write(T32="0000000005")).codes == (3,)


def test_a_silent_station():
    """Hardware fault, 01, for what was asked; the gateway stays."""
    rig = Rig("V", faults=["deaf:times=always"])
    assert [result.code for result in rig.ask(read("VB100", "VB1")).results] == [1, 1]
    assert rig.ask(write(VB100="01")).codes == (1,)
    assert rig.told[0][2].startswith("hardware fault: station 2 does not answer")


def test_a_station_that_refuses_the_job():
    """Its own code reaches the client."""
    rig = Rig("V", faults=["header:code=D602,times=2"])
    assert rig.ask(read("VB100")) == ErrorReply(0x1234, 0xD6, 0x02)
    assert rig.ask(write(VB100="01")) == ErrorReply(0x1234, 0xD6, 0x02)


def test_a_lost_line_is_opened_again():
    """The next request opens it; if that fails, it is left alone for two seconds."""
    rig = Rig()
    rig.ask(read("VB1"))
    rig.line.close()
    assert rig.ask(read("VB1")).results[0].code == 1
    rig.broken = LineError("PG720", "COM3", "there is no such port")
    for _ in range(3):
        assert rig.ask(read("VB1")).results[0].code == 1
    assert rig.opened == 2
    rig.time += PAUSE
    rig.broken = LineLostError("COM3")
    rig.ask(read("VB1"))
    assert rig.opened == 3


@pytest.mark.parametrize("data", [b"", b"\x32\x01", bytes(10), b"\x32\x03" + bytes(10), b"GET / HTTP"])
def test_what_is_no_pdu(data):
    """No answer: the server ends such a connection."""
    assert Rig().passing.answer(data, "client") is None


def test_lengths_that_contradict():
    """8500h, as a CPU says."""
    pdu = bytearray(encode_pdu(read("VB1")))
    pdu[7] += 1
    assert decode_pdu(Rig().passing.answer(bytes(pdu), "client")) == ErrorReply(0x1234, 0x85, 0)


def test_an_answer_that_is_too_long():
    """Two items of 200 bytes do not fit into a PDU of 240: 8500h, nothing is read."""
    rig = Rig()
    pdu = bytearray(encode_pdu(read("VB0", "VB1")))
    pdu[12 + 5] = pdu[24 + 5] = 200
    assert decode_pdu(rig.passing.answer(bytes(pdu), "client")) == ErrorReply(0x1234, 0x85, 0)
    assert requests(rig.bus) == []


def test_the_line_sees_what_our_client_builds():
    """Redundancy bytes and pads of a foreign PDU do not get onto the line."""
    rig = Rig(values={"VB1": 4})
    pdu = bytearray(encode_pdu(read("VB1")))
    pdu[2:4] = b"\xab\xcd"
    assert decode_pdu(rig.passing.answer(bytes(pdu), "client")).results[0].data == b"\x04"
    assert b"\xab\xcd" not in b"".join(entry.data for entry in rig.bus.journal)
