"""Every fault does what it says, as often as it says, and leaves the next exchange alone."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from plcgen.base.diagnostics import DiagnosticError
from plcgen.base.line.endpoint import Clock, EndpointLine
from plcgen.ppi.sim import Bus, Fault, FaultKind, Station, Traffic
from plcgen.ppi.sim.faults import parse_fault
from plcgen.ppi.wire.areas import Area
from plcgen.ppi.wire.errors import Kind, PpiError
from plcgen.ppi.wire.model import ErrorReply, Item, ReadRequest
from plcgen.ppi.wire.telegram import decode_telegram, encode_poll, encode_request
from tests.s7_200_talk import E5, Talk

READ = ReadRequest(7, (Item.memory(Area.V, 100),))
REQUEST = encode_request(READ)
GOOD = bytes.fromhex("68 16 16 68 00 02 08 32 03 00 00 00 07 00 02 00 05 00 00 04 01 FF 04 00 08 22 7F 16")
"""VB100 = 22h with the reference 7: the captured answer, FCS 78h + 7."""


def wrong(value: int, at: int) -> bytes:
    """The good answer with another byte at ``at`` and its checksum changed by the difference."""
    total = (GOOD[-2] + value - GOOD[at]) & 0xFF
    return GOOD[:at] + bytes((value,)) + GOOD[at + 1 : -2] + bytes((total, 0x16))


def talk(*faults: str | Fault) -> Talk:
    return Talk(Bus([Station(values={"VB100": 0x22})], faults))


def replied(master: Talk) -> bytes:
    assert master.request(READ) == E5
    return master.poll()


def test_without_a_fault() -> None:
    assert replied(talk()) == GOOD


@pytest.mark.parametrize(
    ("fault", "answers", "executed"),
    [
        ("deaf:at=request", [b"", E5], 0),
        ("deaf:at=poll", [E5, b""], 1),
        ("silence:at=request", [b"", GOOD], 1),
        ("silence:at=poll", [E5, b""], 1),
        ("silence:times=2", [b"", b""], 1),
    ],
)
def test_no_answer(fault: str, answers: list[bytes], executed: int) -> None:
    """A lost request is not executed; one whose acknowledgement or answer is lost is."""
    master = talk(fault)
    assert [master.request(READ, 0x6C), master.poll(0x5C)] == answers
    assert master.bus.stations[2].executed == executed


def test_a_lost_answer_comes_again_with_the_same_bit() -> None:
    master = talk("silence:at=poll")
    assert replied(master) == b""
    assert master.poll(0x5C) == GOOD


def test_a_lost_acknowledgement_leads_to_one_execution() -> None:
    master = talk("silence:at=request")
    assert master.request(READ, 0x7C) == b""
    assert master.request(READ, 0x7C) == E5
    assert master.poll(0x5C) == GOOD
    assert master.bus.stations[2].executed == 1


def test_not_ready_for_some_polls_and_for_ever() -> None:
    master = talk("not_ready:times=3")
    assert replied(master) == E5
    assert [master.poll(), master.poll(), master.poll()] == [E5, E5, GOOD]
    master = talk("not_ready:times=always")
    master.request(READ)
    assert {master.poll() for _ in range(100)} == {E5}


@pytest.mark.parametrize(
    ("fault", "answer"),
    [
        ("fcs", GOOD[:-2] + b"\x80\x16"),
        ("fcs:value=0", GOOD[:-2] + b"\x00\x16"),
        ("cut", GOOD[:-2]),
        ("cut:value=9", GOOD[:9]),
        ("garbage", bytes.fromhex("00FF6816681055AA")),
        ("garbage:data=AA BB,at=poll", b"\xaa\xbb"),
        ("noise:at=poll", b"\x00\xff" + GOOD),
        ("echo:at=poll", bytes.fromhex("10 02 00 5C 5E 16") + GOOD),
        ("token:at=poll", bytes.fromhex("DC 03 01 DC 01 03") + GOOD),
        ("nack:at=poll", bytes.fromhex("10 00 02 02 04 16")),
        ("nack:at=poll,value=3", bytes.fromhex("10 00 02 03 05 16")),
        ("reference", wrong(0x08, 12)),
        ("reference:value=256", GOOD[:11] + b"\x01\x00" + GOOD[13:-2] + b"\x79\x16"),
        ("stale", wrong(0x06, 12)),
        ("address", wrong(0x03, 5)),
        ("function", wrong(0x02, 6)),
        ("count", wrong(0x02, 20)),
        ("length", wrong(0x10, 24)),
    ],
)  # fmt: skip
def test_spoilt_answers(fault: str, answer: bytes) -> None:
    """Once, then the exchange is as it should be."""
    master = talk(fault if "at=" in fault else f"{fault}{',' if ':' in fault else ':'}at=poll")
    assert replied(master) == answer
    assert master.bus.faults == []
    assert replied(master) == GOOD


def test_a_stale_answer_is_the_one_before() -> None:
    master = talk("stale:after=1")
    first = replied(master)
    master.bus.stations[2]["VB100"] = 0x99
    assert replied(master) == first == GOOD
    assert replied(master)[-3] == 0x99


def test_a_clipped_acknowledgement() -> None:
    """F9 or FE: the first bits of E5 are lost when the line turns around."""
    master = talk("clipped", "clipped:value=0xFE,after=1")
    assert master.request(READ) == b"\xf9"
    assert master.poll() == GOOD
    assert master.request(READ) == b"\xfe"
    assert master.poll() == GOOD
    assert master.request(READ) == E5


def test_foreign_traffic_is_a_whole_exchange_of_others() -> None:
    """Every frame is valid and none is for us: a master must not take the foreign answer for its own."""
    master = talk("foreign:at=poll")
    answer = replied(master)
    assert answer.endswith(GOOD)
    foreign = answer.removesuffix(GOOD)
    assert decode_telegram(foreign[:33]).pdu is not None
    assert foreign[33:34] == E5
    assert foreign[34:40] == bytes.fromhex("10 06 01 5C 63 16")
    assert foreign[40:47] == bytes.fromhex("68 16 16 68 01 06 08")
    assert decode_telegram(foreign[40:]).frame is not None


def test_a_late_answer_comes_in_virtual_time() -> None:
    """A line in memory waits without sleeping; the read that is patient enough gets the answer."""
    clock = Clock()
    line = EndpointLine(talk("late:milliseconds=300,at=poll").bus, clock)
    line.write(REQUEST)
    assert line.read(timeout=0) == E5
    line.write(encode_poll(function=0x5C))
    assert line.read(timeout=0.15) == b""
    assert line.read(timeout=0.2) == GOOD
    assert clock.now == 300


def test_one_item_is_refused_and_not_written() -> None:
    master = talk("item:item=2,code=0A")
    assert master.write(("VB0", b"\x01"), ("VB1", b"\x02"), ("VB2", b"\x03")) == [0xFF, 0x0A, 0xFF]
    assert master.read("VB0[3]") == [(0xFF, b"\x01\x00\x03")]
    master = talk("item")
    assert master.read("VB0", "VB100") == [(0x05, b""), (0xFF, b"\x22")]


def test_a_job_is_refused_as_a_whole_and_not_executed() -> None:
    master = talk("header", "header:code=8500,after=1")
    assert master.ask(READ) == ErrorReply(7, 0x84, 0x04)
    assert master.ask(READ) == ErrorReply(7, 0x85, 0x00)
    assert replied(master) == GOOD


def test_lines_to_the_same_cpus_share_their_faults() -> None:
    """What has struck on one connection is over on all of them."""
    bus = talk("silence", "silence:after=1").bus
    first, second = bus.branch(), bus.branch()
    assert [line.exchange(REQUEST) for line in (first, second, first)] == [b"", b"", E5]
    assert bus.faults == []
    assert len(bus.journal) == 4


def test_faults_wait_and_choose_their_station() -> None:
    bus = Bus([Station(address=2), Station(address=3)], ["silence:station=3,after=1,times=2"])
    request = {address: encode_request(READ, destination=address) for address in (2, 3)}
    assert [bus.exchange(request[3]) for _ in range(4)] == [E5, b"", b"", E5]
    assert bus.exchange(request[2]) == E5


def test_an_echo_for_ever_is_a_hearing_adapter() -> None:
    master = talk("echo:times=always")
    for _ in range(3):
        assert master.request(READ, 0x6C) == REQUEST + E5
        assert master.poll(0x5C) == encode_poll(function=0x5C) + GOOD


def test_several_faults_at_once() -> None:
    master = talk("token:at=poll", "fcs", "late:milliseconds=50,at=poll")
    assert replied(master) == bytes.fromhex("DC 03 01 DC 01 03")
    assert master.bus.due() == 50
    assert master.bus.transmit(49) == b""
    assert master.bus.transmit(50) == GOOD[:-2] + b"\x80\x16"


@pytest.mark.slow
@given(st.lists(st.sampled_from(list(FaultKind)), max_size=6), st.integers(0, 0xFFFF) | st.none())
def test_any_mixture_of_faults_is_survived(kinds: list[FaultKind], value: int | None) -> None:
    """Whatever strikes, nothing raises, and the exchange after the faults is right."""
    master = talk(*(Fault(kind, value=value) for kind in kinds))
    for _ in range(20):
        master.request(READ)
        master.poll()
        master.now += 1000
        master.bus.transmit(master.now)
    assert master.bus.faults == [] or {fault.kind for fault in master.bus.faults} <= set(FaultKind)
    assert replied(master) == GOOD or master.bus.faults


# ---- Faults as text ------------------------------------------------------------------------------------------


def test_faults_as_text() -> None:
    assert parse_fault("silence") == Fault(FaultKind.SILENCE)
    assert parse_fault("not_ready:times=always,station=3") == Fault(FaultKind.NOT_READY, times=None, station=3)
    assert parse_fault("fcs:times=once") == Fault(FaultKind.FCS, times=1)
    assert parse_fault("item:item=3, code=0A") == Fault(FaultKind.ITEM, item=3, code=0x0A)
    assert parse_fault("header:code=D602") == Fault(FaultKind.HEADER, code=0xD602)
    assert parse_fault("garbage:data=68 16") == Fault(FaultKind.GARBAGE, data=b"\x68\x16")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("sillence", 'there is no fault "sillence"'), ("silence:times", "has no value"),
        ("silence:tims=2", "unknown key"),
        ("silence:times=0", "greater than or equal to 1"), ("item:code=FF", "is 1 to 254"),
        ("header:code=xyz", "whole number"),
        ("garbage:data=1", "hexadecimal"), ("fcs:at=later", "is not a value of"), ("", "there is no fault"),
    ],
)  # fmt: skip
def test_faults_that_are_none(text: str, words: str) -> None:
    with pytest.raises(DiagnosticError, match=words) as caught:
        parse_fault(text)
    assert {found.code for found in caught.value.diagnostics} == {"PG901"}
    assert f"--fault {text}" in str(caught.value.diagnostics[0].span)


# ---- Bytes in pieces, noise, pauses --------------------------------------------------------------------------


@given(st.lists(st.integers(1, 40), max_size=20))
def test_frames_may_arrive_in_any_pieces(cuts: list[int]) -> None:
    """The answers do not depend on how the bytes are cut."""
    stream, out, at = REQUEST + encode_poll(function=0x5C), b"", 0
    bus = talk().bus
    for size in [*cuts, len(stream)]:
        out += bus.exchange(stream[at : at + size], at)
        at += size
    assert out == E5 + GOOD


@given(st.binary(max_size=300))
def test_noise_never_raises_and_a_pause_ends_it(noise: bytes) -> None:
    """After any bytes and a pause, the next exchange works."""
    master = talk()
    master.send(noise)
    master.now += 1000
    master.count.restart()
    assert replied(master) == GOOD


def test_a_pause_inside_a_frame_ends_it() -> None:
    """200 ms still belong together, 201 ms do not; the journal says what became of the rest."""
    for pause, expected in ((200, E5), (201, b"")):
        bus = talk().bus
        bus.receive(REQUEST[:10], 5000)
        assert bus.exchange(REQUEST[10:], 5000 + pause) == expected
        assert ("unfinished" in [entry.note for entry in bus.journal]) == (expected == b"")


def test_the_journal_tells_everything_in_order() -> None:
    heard: list[Traffic] = []
    bus = Bus([Station(values={"VB100": 0x22})], ["fcs"], heard.append)
    bus.exchange(b"\xff" + REQUEST, 10)
    bus.exchange(encode_poll(function=0x5C), 20)
    assert [(entry.time, entry.direction, entry.note) for entry in heard] == [
        (10, ">", "no frame"),
        (10, ">", ""),
        (10, "<", ""),
        (20, ">", ""),
        (20, "<", "fcs"),
    ]
    assert list(bus.journal) == heard
    with pytest.raises(PpiError) as caught:
        decode_telegram(heard[-1].data)
    assert caught.value.kinds == (Kind.CHECKSUM,)
