"""One request, one answer: whatever the line does, it ends, and nothing is executed twice."""

import math
from dataclasses import replace

import pytest

from plcgen.base.line.endpoint import EndpointLine
from plcgen.base.line.model import LineLostError
from plcgen.ppi.client import Client, ClientError, NoAnswerError, RefusedError, Settings
from plcgen.ppi.client.heard import Heard, HeardKind
from plcgen.ppi.sim import Fault, FaultKind, Station
from plcgen.ppi.wire.address import parse_item
from plcgen.ppi.wire.fdl import decode_frame, encode_frame
from plcgen.ppi.wire.model import VariableFrame
from tests.ppi.client.support import Script, connect, scripted

READ = "68 1B 1B 68 02 00 {fc} 32 01 00 00 00 01 00 0E 00 00 04 01 12 0A 10 02 00 01 00 01 84 00 03 20 {fcs} 16"
ANSWER = bytes.fromhex("68 16 16 68 00 02 08 32 03 00 00 00 01 00 02 00 05 00 00 04 01 FF 04 00 08 22 79 16")
"""The answer of the seed document to VB100, with the reference 1: checksum 78 + 1."""

ACK = b"\xe5"


def test_the_bytes_on_the_line():
    """The telegrams of the seed document (reference 1, so the checksum 8B becomes 8C), E5, poll; then 7C and 5C."""
    client, script, _ = scripted(
        [ACK, ANSWER, ACK, ANSWER.replace(b"\x32\x03\x00\x00\x00\x01", b"\x32\x03\x00\x00\x00\x02")]
    )
    assert client.read("VB100")[0].value == 0x22
    assert script.heard == [bytes.fromhex(READ.format(fc="6C", fcs="8C")), bytes.fromhex("10 02 00 5C 5E 16")]
    with pytest.raises(NoAnswerError):
        client.read("VB100")
    assert script.heard[2][6] == 0x7C
    assert script.heard[3] == bytes.fromhex("10 02 00 5C 5E 16")


def test_every_request_alternates_the_frame_count_bit():
    """6C 5C 7C 5C 7C ...: request, poll, request, poll."""
    client, _, bus, _ = connect()
    for _ in range(3):
        client.read("VB0")
    codes = [entry.frame.function for entry in bus.journal if entry.direction == ">"]
    assert codes == [0x6C, 0x5C, 0x7C, 0x5C, 0x7C, 0x5C]


@pytest.mark.parametrize(
    "fault",
    [
        "silence",
        "silence:at=poll",
        "silence:times=2",
        "silence:at=poll,times=5",
        "deaf",
        "deaf:times=2",
        "deaf:at=poll,times=4",
        "fcs",
        "fcs:times=4",
        "cut",
        "cut:value=4,times=2",
        "garbage:data=112233",
        "noise:data=0011223344",
        "noise:data=681B1B68,times=2",
        "clipped",
        "echo:times=always",
        "token:times=always",
        "foreign:times=2",
        "not_ready:times=9",
        "late:milliseconds=200",
        "late:milliseconds=600",
        "late:milliseconds=600,at=poll",
        "late:milliseconds=900,at=poll,times=2",
        "stale",
        "reference",
        "address",
        "nack",
        "nack:times=2",
    ],
)
def test_what_a_line_does_for_a_while(fault):
    """The value comes all the same, and a write is executed once."""
    client, plc, _, _ = connect(values={"VB100": 0x22})
    client.read("VB0")
    executed = plc.executed
    client, plc, bus, _ = connect([], values={"VB100": 0x22})
    client.read("VB0")
    from plcgen.ppi.sim.faults import parse_fault

    bus.faults.append(parse_fault(fault))
    assert [reading.value for reading in client.read("VB100")] == [0x22]
    (written,) = client.write({"VW200": 4711})
    assert written.ok
    assert plc["VW200"] == 4711
    assert plc.executed == executed + 2


@pytest.mark.parametrize(
    ("fault", "message"),
    [
        ("silence:times=always", "station 2 does not answer (3 times sent)"),
        ("deaf:times=always", "station 2 does not answer (3 times sent)"),
        ("garbage:data=11,times=always", "3 damaged frames instead of an answer from station 2 (3 times sent)"),
        ("silence:at=poll,times=always", "station 2 does not answer (10 polls)"),
        ("not_ready:times=always", "station 2 is not ready: E5 without end (10 polls)"),
        ("fcs:times=always", "10 damaged frames instead of an answer from station 2 (10 polls)"),
        ("cut:value=20,at=poll,times=always", "a frame from station 2 broke off after 20 bytes (10 polls)"),
        ("cut:value=3,at=poll,times=always", "10 damaged frames instead of an answer from station 2 (10 polls)"),
        ("nack:times=always", "station 2 has no resource (NACK 02h, 3 times sent)"),
        ("nack:at=poll,times=always", "station 2 has no resource (NACK 02h, 10 polls)"),
    ],
)
def test_what_a_line_does_for_ever(fault, message):
    """Everything ends after a bounded number of telegrams, with the reason; the next exchange starts with 6C."""
    client, _, bus, line = connect([fault])
    with pytest.raises(NoAnswerError) as caught:
        client.read("VB100")
    (diagnostic,) = caught.value.diagnostics
    assert diagnostic.code == "PG718"
    assert diagnostic.message.startswith(message)
    assert len([entry for entry in bus.journal if entry.direction == ">"]) <= 2 * 13  # a read that was damaged, twice
    assert line.clock.now < 20_000
    bus.faults.clear()
    assert client.read("VB100")[0].ok
    requests = [entry.frame.function for entry in bus.journal if entry.direction == ">" and len(entry.data) > 6]
    assert requests[-1] == 0x6C


def test_a_station_that_repeats_references_is_held_to_that():
    """Once it has repeated one, an answer with another reference is one to an older request, for ever."""
    client, _, bus, _ = connect(values={"VB100": 0x22})
    client.read("VB100")
    bus.faults.append(Fault(FaultKind.REFERENCE, times=None, value=9))
    with pytest.raises(NoAnswerError, match=r"no answer from station 2 .10 polls.: an answer to request 0009h"):
        client.read("VB100")


class Virtual:
    """A partner like HslCommunication's virtual S7-200: E5, then after a frame that ends with 16h the answer, with
    reference 0000 to a read, 0001 to a write. A poll without a request ends the connection.
    """

    def __init__(self, *, echo_first=0):
        self.station = Station(values={"VB100": 0x22, "VW200": 7})
        self.asked = None
        self.waiting = b""
        self.requests = []
        self.echo_first = echo_first

    def receive(self, data, _now):
        """A request, or the poll for its answer."""
        if self.asked is None:
            assert data[0] == 0x68, "a poll without a request"
            self.asked, self.waiting = bytes(data), ACK
            self.requests.append(self.asked)
            return
        self.station.receive(decode_frame(self.asked))
        answer = self.station.receive(decode_frame(bytes.fromhex("10 02 00 5C 5E 16")))
        write = self.asked[17] == 5
        self.echo_first -= 1
        if self.echo_first < 0:
            answer = replace(answer, pdu=answer.pdu[:4] + bytes((0, write)) + answer.pdu[6:])
        self.asked, self.waiting = None, encode_frame(answer)

    transmit, due = Script.transmit, Script.due


def virtual(partner, **settings):
    """A client on it, and what its user is told."""
    line = EndpointLine(partner, name="virtual")
    client = Client(line, Settings(**settings), now=lambda: line.clock.now / 1000)
    told = []
    client.exchange.notice = told.append
    return client, told


def test_a_partner_without_references_is_found_out_by_the_first_read():
    """The read is repeated with another reference; the answer has not that either, so order counts. Said once."""
    partner = Virtual()
    client, told = virtual(partner)
    assert client.read("VB100")[0].value == 0x22
    assert [request[11:13] for request in partner.requests] == [b"\x00\x01", b"\xff\xfe"]
    assert told == ["station 2 does not repeat references: its answers are taken in their order"]
    (written,) = client.write({"VW200": 4711})
    assert written.ok
    assert client.read("VW200", "VB100")[0].value == 4711
    assert (len(partner.requests), len(told)) == (4, 1)


def test_a_write_to_a_partner_without_references_comes_after_the_read_that_finds_it_out():
    """SMB0 twice, then the write, once."""
    partner = Virtual()
    client, told = virtual(partner)
    (written,) = client.write({"VW200": 4711})
    assert written.ok
    assert [request[17] for request in partner.requests] == [4, 4, 5]
    assert partner.station["VW200"] == 4711
    assert len(told) == 1


def test_references_that_the_user_does_not_want_checked():
    """--reference ignore: no second read, nothing to say; what is answered must still be what was asked."""
    partner = Virtual()
    client, told = virtual(partner, reference="ignore")
    assert client.read("VB100")[0].value == 0x22
    assert (len(partner.requests), told) == (1, [])
    wrong = bytes.fromhex("68 12 12 68 00 02 08 32 03 00 00 00 00 00 02 00 01 00 00 05 01 FF 47 16")
    client, _script, _ = scripted([ACK, wrong], reference="ignore")
    with pytest.raises(NoAnswerError):
        client.read("VB100")


def test_a_partner_that_repeated_a_reference_once_is_not_taken_for_one_that_never_does():
    """Whoever can repeat one and then does not sends answers to something else."""
    client, told = virtual(Virtual(echo_first=1))
    assert client.read("VB100")[0].value == 0x22
    with pytest.raises((NoAnswerError, AssertionError)):
        client.read("VB100")
    assert told == []


def test_a_whole_frame_with_a_wrong_sum_did_not_break_off():
    """68 17 17 68 .. with LE = 17h = 23 has 29 bytes: all of them came, so no patience helps."""
    client, _, _, _ = connect(["fcs:times=always"])
    with pytest.raises(NoAnswerError) as caught:
        client.read("VW100")
    assert caught.value.diagnostics[0].message.startswith("10 damaged frames instead of an answer from station 2")


def test_foreign_traffic_without_end_does_not_hold_us():
    """Another master that never stops talking: the wait is bounded all the same."""
    client, _, line = scripted([], sends=2, answer=0.3)

    class Chatter:
        def receive(self, data, _now):
            pass

        def transmit(self, _now):
            line.clock.now += 1
            return bytes.fromhex("10 07 01 5C 64 16")

        def due(self):
            return None

    line.endpoint = Chatter()
    with pytest.raises(NoAnswerError):
        client.read("VB0")
    assert line.clock.now < 100_000


def test_a_refused_job():
    """An error in the header: the code, its meaning and what to do."""
    client, _, _, _ = connect(["header:code=8404"])
    with pytest.raises(RefusedError, match="8404h, the CPU is busy") as caught:
        client.read("VB0")
    assert caught.value.error == 0x8404
    assert caught.value.diagnostics[0].code == "PG719"
    assert caught.value.diagnostics[0].help == "repeat it later"


@pytest.mark.parametrize(("value", "word"), [("1", "user error"), ("3", "service not activated")])
def test_a_short_refusal(value, word):
    """A station that knows no such service says so in a short frame: no repetition helps."""
    client, _, bus, _ = connect([f"nack:value={value}"])
    with pytest.raises(RefusedError, match=word):
        client.read("VB0")
    assert len([entry for entry in bus.journal if entry.direction == ">"]) == 1


def test_an_answer_without_acknowledgement():
    """Some adapters hide E5 and deliver the answer at once."""
    client, script, _ = scripted([ANSWER])
    assert client.read("VB100")[0].value == 0x22
    assert len(script.heard) == 1


def test_old_bytes_are_forgotten():
    """What arrived before the request is no answer to it."""
    client, script, line = scripted([None, ACK, ANSWER])
    line.write(b"")
    script.waiting = ACK + other(0, 2, 0x08)
    assert client.read("VB100")[0].value == 0x22
    assert script.heard[1][6] == 0x6C


def other(destination, source, function):
    """Return the answer 99 to the same request in a frame of our choice."""
    pdu = ANSWER[7:-2].replace(b"\x22", b"\x99")
    return encode_frame(VariableFrame(destination, source, function, pdu))


@pytest.mark.parametrize("frame", [(0, 3, 0x08), (1, 2, 0x08), (0, 2, 0x6C)])
def test_frames_that_only_look_like_the_answer(frame):
    """From another station, to another master, or a request: passed over although everything else fits."""
    client, _, _ = scripted([ACK, other(*frame) + ANSWER])
    assert client.read("VB100")[0].value == 0x22
    assert client.exchange.count.skipped == 1


@pytest.mark.parametrize(
    "pdu",
    [
        "32 03 00 00 00 01 00 02 00 01 00 00 05 01 FF",
        "32 03 00 00 00 01 00 02 00 06 00 00 04 01 FF 04 00 10 00 22",
        "32 03 00 00 00 01 00 02 00 08 00 00 04 02 FF 04 00 08 22 00 05 00 00 00",
        "32 03 00 00 00 01 00 01 00 00 00 00 28",
        "32 03 00 00 00 01 00 02 00 05 00 00 04 01 FF 04 00 18 22",
    ],
)
def test_answers_to_something_else(pdu):
    """The right reference with another function, length or number of items is refused, never misread."""
    frame = encode_frame(VariableFrame(0, 2, 0x08, bytes.fromhex(pdu)))
    client, _, _ = scripted([ACK, frame])
    with pytest.raises(ClientError) as caught:
        client.read("VB100")
    assert caught.value.diagnostics[0].code == "PG718"


def test_a_lost_line():
    """The line's own error passes through."""
    client, _, _, line = connect()
    line.close()
    with pytest.raises(LineLostError):
        client.read("VB0")


def test_stations_and_bounds():
    """Station, own address, number of sends and polls are settings."""
    settings = Settings(station=5, own=3, sends=1, polls=2)
    client, _, bus, _ = connect(["not_ready:times=always"], address=5, settings=settings)
    with pytest.raises(NoAnswerError, match=r"station 5 is not ready: E5 without end \(2 polls\)"):
        client.read("VB0")
    assert [(e.frame.destination, e.frame.source) for e in bus.journal if e.direction == ">"] == [(5, 3)] * 6
    assert client.exchange.count.polls == 4  # a read is sent once more as a whole


@pytest.mark.parametrize(
    "fault",
    ["deaf:times=3", "silence:at=request,times=3", "garbage:at=request,times=3", "not_ready:times=10",
     "silence:at=poll,times=10", "fcs:at=poll,times=10", "reference:at=poll,times=3", "nack:value=2,times=3"],
)  # fmt: skip
def test_a_read_is_sent_once_more_whatever_failed(fault):
    """What is lost, damaged, answered to somebody else or not ready until all tries are used up costs no reading."""
    client, _, bus, _ = connect([fault], values={"VW100": 1234})
    assert client.read("VW100")[0].value == 1234
    requests = [e.frame for e in bus.journal if e.direction == ">" and isinstance(e.frame, VariableFrame)]
    assert len({frame.function for frame in requests}) == 1, "the second exchange begins like a session: 6Ch"


@pytest.mark.parametrize("fault", ["header:code=8404", "nack:value=3"])
def test_a_refusal_is_not_asked_for_again(fault):
    """A station that says no has said so: one request, no other."""
    client, _, bus, _ = connect([fault])
    with pytest.raises(RefusedError):
        client.read("VW100")
    assert sum(isinstance(e.frame, VariableFrame) for e in bus.journal if e.direction == ">") == 1


@pytest.mark.parametrize(("job", "seen"), [("write", 7), ("stop", "stop")])
@pytest.mark.parametrize("fault", ["silence:at=poll,after=1,times=always", "fcs:at=poll,after=1,times=always"])
def test_what_was_taken_may_have_been_executed(job, seen, fault):
    """The station took the request with E5; its answer is lost: the error says so, and nothing is sent twice."""
    client, plc, bus, _ = connect([fault])
    with pytest.raises(NoAnswerError, match="the request was taken and may have been executed") as caught:
        client.write({"VW100": 7}) if job == "write" else client.stop()
    assert caught.value.diagnostics[0].help == "read what it should have changed before you repeat it"
    requests = [e.frame for e in bus.journal if e.direction == ">" and isinstance(e.frame, VariableFrame)]
    assert len(requests) == 2, "the read of SMB0, and the request once"
    bus.faults.clear()
    assert (client.read("VW100")[0].value if job == "write" else plc.cpu.mode.value) == seen


@pytest.mark.parametrize(("fault", "value"), [("deaf", b"\0\1"), ("silence", b"\0\7")])
def test_without_e5_nobody_knows(fault, value):
    """Three times deaf, or three times E5 lost: the client hears the same, and one of both was executed."""
    client, plc, _, _ = connect([f"{fault}:at=request,after=1,times=always"], values={"VW100": 1})
    with pytest.raises(NoAnswerError, match=r"does not answer .3 times sent.; the request may have been executed"):
        client.write({"VW100": 7})
    assert plc.cpu.memory.read(parse_item("VW100")).data == value


def test_what_comes_after_a_read_that_failed_is_not_sent():
    """Nothing is said of a write whose read of SMB0 has no answer: it was not executed."""
    client, plc, bus, _ = connect(["silence:times=always"], values={"VW100": 1})
    with pytest.raises(NoAnswerError) as caught:
        client.write({"VW100": 7})
    assert "executed" not in caught.value.diagnostics[0].message
    assert plc.cpu.memory.read(parse_item("VW100")).data == b"\0\1"
    assert all(len(entry.data) != 41 - 2 for entry in bus.journal)


@pytest.mark.parametrize(
    ("rare", "often"),
    [
        (HeardKind.DAMAGED, HeardKind.NOT_READY), (HeardKind.BROKEN, HeardKind.NOT_READY),
        (HeardKind.DAMAGED, HeardKind.OTHER), (HeardKind.OTHER, HeardKind.NOT_READY),
        (HeardKind.NOT_READY, HeardKind.SILENCE), (HeardKind.DAMAGED, HeardKind.SILENCE),
    ],
)  # fmt: skip
def test_the_cause_is_what_tells_most(rare, often):
    """An answer that was damaged once is followed by E5 without end: damage is the cause, not a busy CPU."""
    assert Heard([often] * 4 + [rare] + [often] * 5).cause is rare


def test_the_wait_for_a_frame_that_has_begun():
    """A frame that comes in two pieces 400 ms apart is waited for once it has begun."""
    client, script, line = scripted([ACK, None], answer=0.2, frame=0.5)
    line_read = line.read
    pieces = [ANSWER[:10], ANSWER[10:]]

    def read(maximum=4096, timeout=None):
        if len(script.heard) < 2 or not pieces or timeout == 0:
            return line_read(maximum, timeout)
        gap = 150 if len(pieces) == 2 else 400
        line.clock.now += min(gap, math.ceil(timeout * 1000))
        return pieces.pop(0) if gap <= timeout * 1000 else b""

    line.read = read
    assert client.read("VB100")[0].value == 0x22
    assert isinstance(line, EndpointLine)
    assert isinstance(client, Client)


@pytest.mark.parametrize(
    ("fault", "help_"),
    [
        ("fcs:times=always", "check baud rate, parity and wiring"),
        ("cut:value=20,at=poll,times=always", "raise --timeout"),
        ("nack:times=always", "try again later"),
        ("deaf:times=always", "check station address, baud rate, cable and adapter"),
    ],
)
def test_what_to_do_about_it(fault, help_):
    """Each cause has its own remedy."""
    client, _, _, _ = connect([fault])
    with pytest.raises(NoAnswerError) as caught:
        client.read("VB100")
    assert help_ in caught.value.diagnostics[0].help


def test_the_first_frame_of_a_session_is_a_read():
    """A lost E5 of 6Ch is executed twice, as the station cannot see the repetition: so SMB0 is read before a write."""
    client, plc, bus, _ = connect(["silence:at=request"])
    client.write({"VB100": 7})
    requests = [e.frame for e in bus.journal if e.direction == ">" and isinstance(e.frame, VariableFrame)]
    assert [frame.function for frame in requests] == [0x6C, 0x6C, 0x7C]
    assert [frame.pdu[10] for frame in requests] == [4, 4, 5]
    assert plc["VB100"] == 7


def test_a_lost_e5_never_writes_twice():
    """The write is the second frame: its repetition has the same frame count bit, the station only answers again."""
    client, plc, _, _ = connect(["silence:at=request,after=1"])
    client.write({"VB100": 7})
    assert plc.executed == 2


def test_a_read_is_sent_again_if_its_answer_was_damaged():
    """Ten damaged answers, then a good one to the same read sent as a whole; a write is never sent again."""
    client, _, bus, _ = connect(["fcs:times=10,at=poll"], values={"VB100": 7})
    assert client.read("VB100")[0].value == 7
    requests = [e.frame for e in bus.journal if e.direction == ">" and isinstance(e.frame, VariableFrame)]
    assert [frame.function for frame in requests] == [0x6C, 0x6C]
    client, plc, _, _ = connect(["fcs:times=10,at=poll,after=1"])
    with pytest.raises(NoAnswerError):
        client.write({"VB100": 7})
    assert plc.executed == 2


def test_an_answer_that_looks_like_the_one_before_is_compared_with_it():
    """The same read again takes its value; a return code, length or count that differs is examined and refused."""
    client, plc, bus, _ = connect(values={"VW100": 1, "VB103": 5})
    for value in (1, 2, 3):
        plc["VW100"] = value
        assert [reading.value for reading in client.read("VW100", "T32", "VB103")] == [value, 0, 5]
    bus.faults.append(Fault(FaultKind.ITEM, item=1, code=5))
    assert [reading.code for reading in client.read("VW100", "T32", "VB103")][1] == 0xFF
    bus.faults.append(Fault(FaultKind.COUNT, times=None))
    with pytest.raises(NoAnswerError, match="no valid PDU"):
        client.read("VW100", "T32", "VB103")
