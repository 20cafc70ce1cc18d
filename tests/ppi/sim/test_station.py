"""A simulated S7-200 answers the captured frames byte by byte, and keeps the rules of the line."""

from __future__ import annotations

import pytest

from plcgen.ppi.sim import Bus, Station
from plcgen.ppi.sim.station import Mode, Switch
from plcgen.ppi.wire.areas import Area
from plcgen.ppi.wire.model import (
    AckReply,
    ErrorReply,
    FixedFrame,
    Item,
    ItemWrite,
    ReadRequest,
    RunRequest,
    SetupReply,
    SetupRequest,
    StopRequest,
    WriteRequest,
)
from tests.s7_200_talk import E5, Talk

POLL = bytes.fromhex("10 02 00 5C 5E 16")
READ_VB100 = bytes.fromhex(
    "68 1B 1B 68 02 00 6C 32 01 00 00 00 00 00 0E 00 00 04 01 12 0A 10 02 00 01 00 01 84 00 03 20 8B 16"
)
VB100_IS_22 = bytes.fromhex("68 16 16 68 00 02 08 32 03 00 00 00 00 00 02 00 05 00 00 04 01 FF 04 00 08 22 78 16")
WRITE_VB100_0C = bytes.fromhex(
    "68 20 20 68 02 00 7C 32 01 00 00 00 00 00 0E 00 05 05 01 12 0A 10 02 00 01 00 01 84 00 03 20 00 04 00 08 0C B9 16"
)
WRITTEN = bytes.fromhex("68 12 12 68 00 02 08 32 03 00 00 00 00 00 02 00 01 00 00 05 01 FF 47 16")
STOP = bytes.fromhex(
    "68 1D 1D 68 02 00 6C 32 01 00 00 00 00 00 10 00 00 29 00 00 00 00 00 09 50 5F 50 52 4F 47 52 41 4D AA 16"
)
STOPPED = bytes.fromhex("68 10 10 68 00 02 08 32 03 00 00 00 00 00 01 00 00 00 00 29 69 16")
RUN = bytes.fromhex(
    "68 21 21 68 02 00 6C 32 01 00 00 00 00 00 14 00 00 28 00 00 00 00 00 00 FD 00 00"
    " 09 50 5F 50 52 4F 47 52 41 4D AA 16"
)
RUNNING = bytes.fromhex("68 10 10 68 00 02 08 32 03 00 00 00 00 00 01 00 00 00 00 28 68 16")


@pytest.fixture
def station() -> Station:
    return Station(values={"VB100": 0x22})


@pytest.fixture
def talk(station: Station) -> Talk:
    return Talk(Bus([station]))


# ---- Captured exchanges (seed document 004, section 4) -------------------------------------------------------


def test_the_captured_read_of_vb100(talk: Talk) -> None:
    assert talk.send(READ_VB100) == E5
    assert talk.send(POLL) == VB100_IS_22


def test_the_captured_write_of_vb100(talk: Talk, station: Station) -> None:
    """The capture writes with 7Ch and reads with 6Ch: both are frame count bits, not kinds of access."""
    assert talk.send(WRITE_VB100_0C) == E5
    assert talk.send(POLL) == WRITTEN
    assert station["VB100"] == 0x0C


def test_the_captured_stop_and_run(talk: Talk, station: Station) -> None:
    assert (talk.send(STOP), talk.send(POLL)) == (E5, STOPPED)
    assert station.mode is Mode.STOP
    assert (talk.send(RUN), talk.send(POLL)) == (E5, RUNNING)
    assert station.mode is Mode.RUN


def test_three_items_in_one_telegram() -> None:
    """M, V and Q bytes: every odd value but the last one is followed by a pad byte."""
    talk = Talk(Bus([Station(values={"MB0": 0x5A, "VB100": 0x22, "QB0": 0x0F})]))
    request = bytes.fromhex(
        "68 33 33 68 02 00 6C 32 01 00 00 00 00 00 26 00 00 04 03 12 0A 10 02 00 01 00 00 83 00 00 00"
        " 12 0A 10 02 00 01 00 01 84 00 03 20 12 0A 10 02 00 01 00 00 82 00 00 00 08 16"
    )
    answer = bytes.fromhex(
        "68 22 22 68 00 02 08 32 03 00 00 00 00 00 02 00 11 00 00 04 03 FF 04 00 08 5A 00 FF 04 00 08 22 00"
        " FF 04 00 08 0F 05 16"
    )
    assert talk.send(request) == E5
    assert talk.send(POLL) == answer


# ---- Frame count bit -----------------------------------------------------------------------------------------


def test_a_repeated_request_is_acknowledged_again_and_not_executed_twice(talk: Talk, station: Station) -> None:
    """E5 was lost: the master repeats 7Ch. A write in between through the process shows that nothing is executed."""
    assert talk.send(WRITE_VB100_0C) == E5
    station["VB100"] = 0x55
    assert talk.send(WRITE_VB100_0C) == E5
    assert station["VB100"] == 0x55
    assert station.executed == 1
    assert talk.send(POLL) == WRITTEN


def test_a_repeated_poll_gets_the_same_answer(talk: Talk, station: Station) -> None:
    """The answer was lost: the master polls with the same bit, and the old value comes although memory has changed."""
    talk.send(READ_VB100)
    assert talk.send(POLL) == VB100_IS_22
    station["VB100"] = 0
    assert talk.send(POLL) == VB100_IS_22


def test_a_poll_with_the_next_bit_finds_nothing(talk: Talk) -> None:
    """The answer has been delivered: there is no second one."""
    talk.send(READ_VB100)
    talk.send(POLL)
    assert talk.poll(0x7C) == E5


def test_6c_starts_again_and_executes_again(talk: Talk, station: Station) -> None:
    """Clients that send 6Ch for every request (libnodave, python-snap7) are never taken for repeating."""
    for value in (0x22, 0x23):
        station["VB100"] = value
        assert talk.send(READ_VB100) == E5
        assert talk.send(POLL)[-3] == value
    assert station.executed == 2


def test_a_request_takes_the_place_of_one_that_nobody_polled(talk: Talk, station: Station) -> None:
    assert talk.request(ReadRequest(1, (Item.memory(Area.V, 0),))) == E5
    assert talk.request(ReadRequest(2, (Item.memory(Area.V, 100),))) == E5
    assert talk.poll()[11:13] == b"\x00\x02"
    assert station.executed == 2


def test_each_master_has_its_own_sequence(station: Station) -> None:
    """Two masters use the same bit: neither is taken for a repetition of the other."""
    bus = Bus([station])
    first, second = Talk(bus, source=0), Talk(bus, source=1)
    for master in (first, second):
        assert master.request(ReadRequest(1, (Item.memory(Area.V, 100),)), 0x7C) == E5
    assert station.executed == 2
    assert first.poll(0x5C)[4:6] == b"\x00\x02"
    assert second.poll(0x5C)[4:6] == b"\x01\x02"


def test_polling_with_5c_only_gets_through_after_not_ready() -> None:
    """Many masters never alternate the polls; only the strict rule leaves them with E5 for ever."""
    for rule, expected in (("standard", VB100_IS_22), ("ignore", VB100_IS_22), ("strict", E5)):
        talk = Talk(Bus([Station(values={"VB100": 0x22}, not_ready=2, frame_count=rule)]))  # type: ignore[arg-type]
        talk.send(READ_VB100)
        assert [talk.send(POLL), talk.send(POLL)] == [E5, E5]
        assert talk.send(POLL) == expected


def test_a_master_that_never_alternates_is_served_by_the_rule_ignore() -> None:
    """7Ch for all requests and polls: by the standard the second request is a repetition."""
    for rule, executed in (("standard", 1), ("strict", 1), ("ignore", 2)):
        station = Station(frame_count=rule)  # type: ignore[arg-type]
        talk = Talk(Bus([station]))
        for byte in (1, 2):
            talk.request(ReadRequest(byte, (Item.memory(Area.V, 0),)), 0x7C)
            talk.poll(0x7C)
        assert station.executed == executed, rule


def test_not_ready_counts_for_every_request() -> None:
    talk = Talk(Bus([Station(not_ready=1)]))
    for _ in range(2):
        assert talk.request(ReadRequest(1, (Item.memory(Area.V, 0),))) == E5
        assert talk.poll() == E5
        assert talk.poll()[:1] == b"\x68"


# ---- What is not for the station -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    "frame",
    [
        READ_VB100[:-2] + b"\x8c\x16",
        READ_VB100[:-1] + b"\x17",
        bytes.fromhex("10 02 00 5C 5F 16"),
        bytes.fromhex("10 03 00 5C 5F 16"),
        bytes.fromhex("10 7F 00 5C DB 16"),
        bytes.fromhex("10 02 00 08 0A 16"),
        bytes.fromhex("10 02 00 46 48 16"),
        bytes.fromhex("A2 02 00 5C 01 02 03 04 05 06 07 08 82 16"),
        bytes.fromhex("DC 02 01"),
        E5,
        b"\x00\xff\x16",
    ],
    ids=["FCS", "end", "poll FCS", "other station", "broadcast", "an answer", "SDN", "SD3", "token", "E5", "noise"],
)
def test_it_is_silent_and_keeps_the_answer(talk: Talk, frame: bytes) -> None:
    """Frames for others, of foreign masters, and broken ones: no answer, and the request before is not forgotten."""
    talk.send(READ_VB100)
    assert talk.send(frame) == b""
    assert talk.send(POLL) == VB100_IS_22


def test_a_station_knows_its_own_address(station: Station) -> None:
    """Whoever hands it a frame, it answers its own only."""
    assert station.receive(FixedFrame(3, 0, 0x49)) is None
    assert station.receive(FixedFrame(2, 0, 0x49)) == FixedFrame(0, 2, 0x00)


def test_a_broken_request_is_not_executed(talk: Talk, station: Station) -> None:
    assert talk.send(WRITE_VB100_0C[:-2] + b"\xba\x16") == b""
    assert station.executed == 0


def test_stations_are_found_by_their_fdl_status(talk: Talk) -> None:
    """Micro/WIN and other masters look for stations with 49h; a slave answers 00h (EN 50170, FDL status)."""
    assert talk.send(bytes.fromhex("10 02 00 49 4B 16")) == bytes.fromhex("10 00 02 00 02 16")
    assert talk.send(bytes.fromhex("10 05 00 49 4E 16")) == b""


def test_services_that_it_does_not_have_are_not_activated(talk: Talk) -> None:
    """SDA low (73h): short answer 03h."""
    assert talk.send(bytes.fromhex("10 02 00 73 75 16")) == bytes.fromhex("10 00 02 03 05 16")


def test_a_poll_without_a_request_finds_nothing(talk: Talk) -> None:
    assert talk.send(POLL) == E5


def test_several_stations_on_one_line() -> None:
    bus = Bus([Station(address=2, values={"VB0": 2}), Station("226", 5, values={"VB0": 5, "VB10000": 1})])
    assert Talk(bus, 2).read("VB0", "VB10000") == [(0xFF, b"\x02"), (0x05, b"")]
    assert Talk(bus, 5).read("VB0", "VB10000") == [(0xFF, b"\x05"), (0xFF, b"\x01")]
    with pytest.raises(ValueError, match="address 5 is taken"):
        bus.add(Station(address=5))


def test_a_second_line_has_its_own_masters_and_the_same_memory(talk: Talk, station: Station) -> None:
    """Another connection that starts with 7Ch is not taken for the one before it."""
    for line in (talk.bus, talk.bus.branch()):
        assert line.exchange(WRITE_VB100_0C) == E5
    assert station.executed == 2
    assert station["VB100"] == 0x0C
    other = Talk(talk.bus.branch())
    assert talk.ask(SetupRequest(3, 100)) == SetupReply(3, 100)
    assert len(other.read("VB0[200]")[0][1]) == 200


# ---- Services ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("asked", "expected"), [(960, 240), (240, 240), (100, 100), (0, 32)])
def test_the_pdu_size_is_negotiated_down(talk: Talk, asked: int, expected: int) -> None:
    assert talk.ask(SetupRequest(3, asked)) == SetupReply(3, expected)


def test_the_negotiated_size_is_a_limit(talk: Talk) -> None:
    """A PDU of 100 bytes holds 100 - 12 - 2 - 4 = 82 bytes of one item, written 100 - 10 - 14 - 4 = 72."""
    talk.ask(SetupRequest(3, 100))
    assert talk.read("VB0[82]")[0][0] == 0xFF
    assert talk.ask(ReadRequest(4, (Item.memory(Area.V, 0, 83),))) == ErrorReply(4, 0x85, 0x00)
    assert talk.write(("VB0[72]", bytes(72))) == [0xFF]
    too_long = WriteRequest(5, (ItemWrite(Item.memory(Area.V, 0, 73), bytes(73)),))
    assert talk.ask(too_long) == ErrorReply(5, 0x85, 0x00)


@pytest.mark.parametrize(
    ("switch", "answer", "mode"),
    [
        (Switch.RUN, AckReply(5, 0x28), Mode.RUN),
        (Switch.TERM, AckReply(5, 0x28), Mode.RUN),
        (Switch.STOP, ErrorReply(5, 0x80, 0x01), Mode.STOP),
    ],
)
def test_the_mode_switch_decides_whether_it_may_be_started(switch: Switch, answer: object, mode: Mode) -> None:
    station = Station(mode=Mode.STOP, switch=switch)
    assert Talk(Bus([station])).ask(RunRequest(5)) == answer
    assert station.mode is mode


def test_it_can_be_stopped_in_every_position() -> None:
    for switch in Switch:
        station = Station(switch=switch)
        assert Talk(Bus([station])).ask(StopRequest(6)) == AckReply(6, 0x29)
        assert station.mode is Mode.STOP


def pdu(parameter: str, data: str = "", lengths: str = "") -> bytes:
    """A job with reference 1; ``lengths`` replaces the right ones."""
    sizes = (
        bytes.fromhex(lengths)
        if lengths
        else len(bytes.fromhex(parameter)).to_bytes(2) + len(bytes.fromhex(data)).to_bytes(2)
    )
    return bytes.fromhex("32 01 00 00 00 01") + sizes + bytes.fromhex(parameter + data)


ITEM = "12 0A 10 02 00 01 00 01 84 00 03 20"


@pytest.mark.parametrize(
    ("job", "error"),
    [
        (pdu("1A 00"), "81 04"),
        (pdu("28 00 00 00 00 00 00 FD 00 00 05 5F 4E 45 57 31"), "81 04"),
        (pdu("29 00 00 00 00 00 09 58 5F 50 52 4F 47 52 41 4D"), "81 04"),
        (pdu("04 01 11 0A 10 02 00 01 00 01 84 00 03 20"), "81 04"),
        (bytes.fromhex("32 07 00 00 00 01 00 08 00 00 00 01 12 04 11 43 01 00"), "81 04"),
        (pdu("04 01 " + ITEM, lengths="00 0F 00 00"), "85 00"),
        (pdu("04 02 " + ITEM), "85 00"),
        (pdu("04 00"), "85 00"),
        (pdu("04 14 " + ITEM * 19), "85 00"),
        (pdu("04 01 12 0A 10 02 00 DF 00 01 84 00 00 00"), "85 00"),
        (pdu("05 01 " + ITEM), "85 00"),
        (pdu("05 01 " + ITEM, "00 04 00 10 AA"), "85 00"),
    ],
    ids=[
        "unknown function", "other PI service", "other STOP", "unknown item syntax", "SZL", "parameter length",
        "second item missing", "no items", "20 items", "223 bytes", "write without data", "value cut",
    ],
)  # fmt: skip
def test_a_job_that_is_wrong_as_a_whole_gets_a_header_error(talk: Talk, job: bytes, error: str) -> None:
    """ROSCTR 2 with error class and code; the reference is that of the job."""
    body = bytes((2, 0, 0x6C)) + job
    frame = bytes((0x68, len(body), len(body), 0x68)) + body + bytes((sum(body) & 0xFF, 0x16))
    assert talk.send(frame) == E5
    assert talk.send(POLL)[7:-2] == bytes.fromhex("32 02 00 00 00 01 00 00 00 00" + error)


@pytest.mark.parametrize("job", [b"\x32\x01\x00", b"\x33" + pdu("04 01 " + ITEM)[1:], b"\x32\x03" + bytes(12)])
def test_what_is_no_job_is_acknowledged_and_thrown_away(talk: Talk, job: bytes) -> None:
    """The line is fine, so E5; no answer ever comes."""
    body = bytes((2, 0, 0x6C)) + job
    assert talk.send(bytes((0x68, len(body), len(body), 0x68)) + body + bytes((sum(body) & 0xFF, 0x16))) == E5
    assert talk.send(POLL) == E5


def test_a_trailing_pad_of_a_write_is_accepted(talk: Talk, station: Station) -> None:
    """Micro/WIN pads the last odd value, other clients do not."""
    item = ItemWrite(Item.memory(Area.V, 100), b"\x77")
    for trailing in (True, False):
        station["VB100"] = 0
        talk.ask(WriteRequest(9, (item,), trailing))
        assert station["VB100"] == 0x77
