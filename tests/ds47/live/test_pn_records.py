"""Parameters over PROFINET's records: the client against the simulated device, on a wire that does what it is told."""

from __future__ import annotations

import socket
from dataclasses import replace

import pytest

from plcgen.base.diagnostics import DiagnosticError
from plcgen.ds47.device import Parameter
from plcgen.ds47.devices import find_device
from plcgen.ds47.live import backup
from plcgen.ds47.live.channel import PnParameters
from plcgen.ds47.live.profinet import TRIES, PnConnection, UdpLink, unicast
from plcgen.ds47.sim.faults import Fault, FaultKind
from plcgen.ds47.sim.pn_device import OBJECT, PnDevice
from plcgen.ds47.wire import formats, pnio, rpc
from plcgen.ds47.wire.model import ErrorBlock, ParameterAddress, ValueBlock, ZeroBlock
from plcgen.ds47.wire.rpc import Operation, Packet, PacketType
from tests.ds47.live.pn_bench import PLACE, S120, Wire, changes, channel, drive, intact

REAL, WORD = Parameter(1120, "FloatingPoint", array=2), Parameter(59900, "Unsigned16", array=120)
TEN = bytes.fromhex("41 20 00 00")  # 10.0 = 1.25 * 2 ** 3: exponent 130, fraction .25


def _texts(reader: PnParameters, *wanted: tuple[Parameter, range]) -> list[str]:
    return [one.text for one in reader.read(wanted, 2)]


@pytest.mark.parametrize("order", ["little", "big"])
def test_read(order):
    """One element: the bytes on the wire are those of a request by hand, whatever the byte order of the packets is."""
    wire = Wire(PnDevice(drive()))
    with channel(wire, order) as reader:
        (found,) = reader.read([(REAL, [0])], 2)
    assert (found.data, found.text, found.doubt) == (TEN, "10", "")
    # 01: reference, 01: read, 02: drive object, 01: one parameter; 10: value, 01: one element; 0460h = 1120, index 0
    assert wire.device.drive.journal[0].data == bytes.fromhex("01 01 02 01 10 01 04 60 00 00")
    assert wire.device.done == {"connect": 1, "write": 1, "read": 1, "release": 1}
    assert all(data[4] == (0x10 if order == "little" else 0) for _, data in wire.seen)


def test_array():
    """An array of 120 words is read in three requests: 117 elements are the most of an S120, 58 words * 2 fit, too."""
    wire = Wire(PnDevice(drive()))
    with channel(wire) as reader:
        assert _texts(reader, (WORD, range(120))) == [str(number) for number in range(120)]
    asked = [call.data for call in wire.device.drive.journal if call.direction == "write"]
    assert [data[5] for data in asked] == [117, 3]


def test_several_parameters():
    """Four parameters of four types in one request, each with its own number of elements."""
    wire = Wire(PnDevice(drive()))
    text, source = Parameter(59901, "VisibleString[8]"), Parameter(840, "Unsigned32", bico=True)
    with channel(wire) as reader:
        assert _texts(reader, (REAL, range(2)), (Parameter(52, "Unsigned16"), range(1)), (text, range(1)),
                      (source, range(1))) == ["10", "5.5", "1000", "pump 7  ", "r722.2"]  # fmt: skip
    assert wire.device.done["write"] == 1


BEHAVIOURS = [
    {}, {"error_words": 1}, {"answer_format": "size"}, {"multi_supported": False}, {"max_parameters": 2},
    {"max_elements": 10}, {"record_limit": 60}, {"strict_length": False}, {"error_table": "profidrive"},
]  # fmt: skip


@pytest.mark.parametrize("behaviour", BEHAVIOURS, ids=str)
def test_whatever_a_drive_can_do(behaviour):
    """Short records, few parameters or elements, one at a time, sizes instead of types: the same values and errors."""
    wire = Wire(PnDevice(drive(**behaviour)))
    unknown = Parameter(9, "Unsigned16")
    with channel(wire) as reader:
        wanted = [(REAL, range(2)), (WORD, range(120)), (unknown, [0]), (Parameter(59901, "VisibleString[8]"), [0])]
        found = list(reader.read(wanted, 2))
    assert [one.text for one in found] == ["10", "5.5", *map(str, range(120)), "", "pump 7  "]
    assert [one.doubt[:18] for one in found if one.doubt] == ["refused: error 00h"]


@pytest.mark.parametrize("behaviour", BEHAVIOURS, ids=str)
def test_whatever_a_drive_can_do_it_is_saved(behaviour):
    """The same for a backup: each parameter whole, with its own type where the drive or the catalogue says one."""
    wire = Wire(PnDevice(drive(**behaviour)))
    known = [replace(REAL, array=None), Parameter(59900, ""), Parameter(59901, ""), Parameter(9, "")]
    with channel(wire) as reader:
        real, words, text, none = backup.gather(reader, known, 2)
    assert [backup.value_text(one) for one in real.elements] == ["10", "5.5"]
    assert [backup.value_text(one) for one in words.elements] == [str(number) for number in range(120)]
    assert [backup.value_text(one) for one in text.elements] == ["pump 7"]
    assert none.refusal.startswith("error 00h")


def test_the_drive_says_its_type():
    """Without a type in the catalogue it is that of the answer; another one than the catalogue's is no value."""
    with channel(Wire(PnDevice(drive()))) as reader:
        (found,) = reader.read([(Parameter(52, ""), [0])], 2)
        assert (found.text, found.parameter.type) == ("1000", "Unsigned16")
        (found,) = reader.read([(Parameter(52, "FloatingPoint"), [0])], 2)
        assert (found.value, found.doubt) == (None, "the drive answers Unsigned16, not FloatingPoint")


def test_refused_read():
    """One of three does not exist (00h), one has no index 7 (03h): the third is read all the same."""
    with channel(Wire(PnDevice(drive()))) as reader:
        found = list(reader.read([(Parameter(9, "Unsigned16"), [0]), (REAL, [7]), (REAL, [1])], 2))
    assert [one.text for one in found] == ["", "", "5.5"]
    assert [one.doubt[:18] for one in found] == ["refused: error 00h", "refused: error 03h", ""]


def test_of_a_range_that_is_too_long_the_rest_is_read():
    """Indexes 0 to 3 of an array of two: the answer does not say which are there, so each one is asked for."""
    with channel(Wire(PnDevice(drive()))) as reader:
        found = list(reader.read([(REAL, range(4))], 2))
    assert [one.text for one in found] == ["10", "5.5", "", ""]


def test_a_drive_object_that_is_not_there():
    """Error 19h stands for all of the request, and is not asked for again."""
    wire = Wire(PnDevice(drive()))
    with channel(wire) as reader:
        found = list(reader.read([(REAL, [0]), (REAL, [1])], 9))
    assert [one.doubt[:18] for one in found] == ["refused: error 19h"] * 2
    assert wire.device.done["write"] == 1


def _changed(value: float, index: int = 0) -> tuple[ParameterAddress, ValueBlock]:
    return ParameterAddress(1120, index, 1), ValueBlock.of(formats.by_name("FloatingPoint"), [value])


def test_write():
    """12.0 = 41400000h is in the drive; the answer is the header alone."""
    wire = Wire(PnDevice(drive()))
    with channel(wire) as reader:
        assert reader.change([_changed(12.0)], 2) == []
    assert wire.device.drive.objects[2].parameters[1120].values == [12.0, 5.5]
    assert wire.device.drive.journal[0].data == bytes.fromhex("01 02 02 01 10 01 04 60 00 00 08 01 41 40 00 00")


def test_refused_write():
    """1000 is beyond the limit (02h); the other one of the request was written."""
    wire = Wire(PnDevice(drive()))
    with channel(wire) as reader:
        refused, done = reader.change([_changed(1000.0), _changed(7.0, 1)], 2)
    assert isinstance(refused, ErrorBlock)
    assert (refused.number, done) == (0x02, ZeroBlock())
    assert wire.device.drive.objects[2].parameters[1120].values == [10.0, 7.0]


@pytest.mark.parametrize("processing", [0, 150, 1000, 5000])
def test_busy(processing):
    """Until the answer is there the drive ends a read with DE80B500: asked again every 0.2 s, 40 times at most."""
    wire = Wire(PnDevice(drive(processing=processing)))
    with channel(wire) as reader:
        assert _texts(reader, (REAL, range(1))) == ["10"]
    busy = sum(call.status == 0xDE80B500 for call in wire.device.drive.journal)
    assert busy == -(-processing // 200)


def test_busy_for_ever():
    """A drive that never answers: a message with the status, after 40 tries of a read."""
    wire = Wire(PnDevice(drive(Fault(FaultKind.SILENCE, times=None))))
    with channel(wire) as reader, pytest.raises(DiagnosticError) as lost:
        list(reader.read([(REAL, [0])], 2))
    assert lost.value.diagnostics[0].code == "PG708"
    assert "DE80B500" in lost.value.diagnostics[0].message
    assert wire.device.done["read"] == 40


def test_a_lost_answer_begins_again():
    """80A0h on a read: the request is written again, once more for a read, never for a change."""
    gone = Fault(FaultKind.STATUS, call="read", status=0xDE80A000)
    wire = Wire(PnDevice(drive(gone)))
    with channel(wire) as reader:
        assert _texts(reader, (REAL, range(1))) == ["10"]
    assert wire.device.done["write"] == 2
    wire = Wire(PnDevice(drive(replace(gone, times=1))))
    with channel(wire) as reader, pytest.raises(DiagnosticError) as lost:
        reader.change([_changed(12.0)], 2)
    assert "may have taken the values" in lost.value.diagnostics[0].help
    assert changes(wire.device.drive) == 1


@pytest.mark.parametrize(("record", "place"), [(47, (1, 1)), (0xB02E, (1, 1)), (0xB02F, (1, 1))])
def test_every_record(record, place):
    """47, B02Eh and B02Fh carry the same."""
    wire = Wire(PnDevice(drive(), place))
    with channel(wire, index=record) as reader:
        assert _texts(reader, (REAL, range(2))) == ["10", "5.5"]
    assert {call.index for call in wire.device.drive.journal} == {record}


@pytest.mark.parametrize(
    ("place", "api", "status"), [((2, 1), 0x3A00, "DF80B200"), ((1, 2), 0x3A00, "DF80B200"), ((1, 1), 0, "DF80B200")]
)
def test_another_place(place, api, status):
    """The parameter access point is in another slot, subslot or API: the status is shown."""
    wire = Wire(PnDevice(drive(), place, api=api))
    with channel(wire) as reader, pytest.raises(DiagnosticError) as wrong:
        list(reader.read([(REAL, [0])], 2))
    assert (wrong.value.diagnostics[0].code, status in wrong.value.diagnostics[0].message) == ("PG708", True)


@pytest.mark.parametrize("lost", ["there", "back"])
@pytest.mark.parametrize("number", range(6))
def test_lost_packets(lost, number):
    """Look-up twice, connect, write, read, release: whichever packet is lost, it is sent again, and executed once."""

    def lose(at: int, data: bytes) -> tuple[bytes, ...]:
        return () if at == number else (data,)

    wire = Wire(PnDevice(drive()), **{lost: lose})
    with channel(wire) as reader:
        assert reader.change([_changed(12.0)], 2) == []
    assert wire.device.done == {"connect": 1, "write": 1, "read": 1, "release": 1}
    assert changes(wire.device.drive) == 1


@pytest.mark.parametrize("way", ["there", "back"])
def test_doubled_packets(way):
    """Each one comes twice: executed once, answered once, and the second answer is not taken for the next one."""
    wire = Wire(PnDevice(drive()), **{way: lambda _at, data: (data, data)})
    with channel(wire) as reader:
        assert _texts(reader, (REAL, range(2))) == ["10", "5.5"]
        assert reader.change([_changed(12.0)], 2) == []
    assert wire.device.done == {"connect": 1, "write": 2, "read": 2, "release": 1}


def test_late_packets():
    """Every answer comes behind the one to the repeated request: old ones are left alone."""
    held: list[bytes] = []

    def late(_at: int, data: bytes) -> list[bytes]:
        held.append(data)
        return held[-2:-1]

    with channel(Wire(PnDevice(drive()), back=late)) as reader:
        assert _texts(reader, (REAL, range(2))) == ["10", "5.5"]


def test_a_host_that_was_not_asked():
    """What another host sends to our port is not even looked at."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other, socket.socket(type=socket.SOCK_DGRAM) as there:
        other.bind(("127.0.0.2", 0))
        there.bind(("127.0.0.1", 0))
        link = UdpLink(*there.getsockname())
        try:
            link.send(b"question")
            _, us = there.recvfrom(100)
            other.sendto(b"of another host", us)
            there.sendto(b"answer", us)
            assert link.receive(link.now() + 5) == b"answer"
            assert link.receive(link.now()) is None
        finally:
            link.close()


def test_nobody_answers():
    """All is lost: five tries, then one message; the time is that of the call."""
    wire = Wire(PnDevice(drive()), there=lambda _at, _data: ())
    with pytest.raises(DiagnosticError) as lost, channel(wire):
        pass
    assert (lost.value.diagnostics[0].code, wire.time) == ("PG705", 5.0)
    assert lost.value.diagnostics[0].message == "pn://127.0.0.1/1.1 did not answer within 5 s"
    assert wire.counts["there"] == TRIES


def test_a_write_without_an_answer_is_not_called_one():
    """The connection breaks off behind the write: it may have been carried out, and that is said."""
    wire = Wire(PnDevice(drive()))
    with pytest.raises(DiagnosticError) as lost, channel(wire) as reader:  # noqa: PT012 - it must be connected first
        wire.back = lambda _at, _data: ()
        reader.change([_changed(12.0)], 2)
    assert "the drive may have taken the values" in lost.value.diagnostics[0].help
    assert changes(wire.device.drive) == 1


def _answering(change, only: Operation | None = None):
    """A damage that changes answers of the device interface."""

    def damage(_at: int, data: bytes) -> list[bytes]:
        packet = rpc.decode_packet(data)
        mine = packet.interface == rpc.IO_DEVICE and only in (None, packet.operation)
        return [rpc.encode_packet(change(packet))] if mine else [data]

    return damage


def _blocks(packet: Packet, change) -> Packet:
    status, blocks = pnio.decode_args(packet.body, packet.order)
    return replace(packet, body=pnio.encode_args(change(blocks), packet.order, status))


def _record(**other):
    return lambda packet: _blocks(
        packet, lambda blocks: pnio.encode_record(replace(pnio.decode_record(blocks, pnio.READ_ANSWER), **other))
    )


def _refused(kind: PacketType, number: int):
    return lambda packet: replace(packet, kind=kind, body=bytes((number, 0, 1, 0x1C)))


def _length(packet: Packet) -> Packet:
    return replace(packet, body=packet.body[:4] + b"\1\0\0\0" + packet.body[8:])


def _status(packet: Packet) -> Packet:
    return _blocks(packet, lambda blocks: blocks[:44] + bytes.fromhex("DF80B700") + blocks[48:])


def _session(packet: Packet) -> Packet:
    return _blocks(packet, lambda blocks: blocks[:24] + b"\xff\xff" + blocks[26:])


@pytest.mark.parametrize(
    ("damage", "code", "told"),
    [
        (_answering(lambda packet: replace(packet, activity=OBJECT)), "PG705", "it belongs to another connection"),
        (_answering(lambda packet: replace(packet, sequence=77)), "PG705", "it has the sequence number 77, not 2"),
        (_answering(lambda packet: replace(packet, kind=PacketType.PING)), "PG705", "it is of type ping"),
        (_answering(_refused(PacketType.FAULT, 3)), "PG708", "RPC fault 1C010003h"),
        (_answering(_refused(PacketType.REJECT, 2)), "PG708", "RPC reject 1C010002h"),
        (_answering(lambda packet: replace(packet, body=packet.body[:19])), "PG708", "20 bytes at least, not 19"),
        (_answering(lambda packet: replace(packet, body=packet.body[:-1])), "PG708", "contradict each other"),
        (_answering(_length), "PG708", "length 1, array of 34"),
        (_answering(_status, Operation.WRITE), "PG708", "DF80B700"),
        (_answering(_session, Operation.CONNECT), "PG708", "accepted another connection"),
        (_answering(_record(ar=OBJECT), Operation.READ), "PG708", f"the connection {OBJECT}"),
        (_answering(_record(sequence=9), Operation.READ), "PG708", "the sequence number 9, the request had 2"),
        (_answering(_record(slot=3), Operation.READ), "PG708", "the slot 3, the request had 1"),
        (_answering(_record(subslot=3), Operation.READ), "PG708", "the subslot 3, the request had 1"),
        (_answering(_record(index=47), Operation.READ), "PG708", "the record 47, the request had 45103"),
        (_answering(_record(api=0), Operation.READ), "PG708", "the API 0, the request had 14848"),
        (_answering(_record(size=241, data=bytes(241)), Operation.READ), "PG708", "241 bytes, 240 were asked for"),
        (_answering(_record(size=9), Operation.READ), "PG708", "the answer does not fit the request"),
        (_answering(_record(size=12), Operation.READ), "PG708", "12 bytes by its header, 10 came"),
        (_answering(_record(data=bytes.fromhex("02 01 02 01 08 01 41 20 00 00")), Operation.READ), "PG708",
         "the request reference 2 does not mirror the request's 1"),
        (lambda _at, data: [data[:60]], "PG705", "60 bytes: the header of an RPC packet has 80"),
        (lambda _at, data: [b"\5" + data[1:]], "PG705", "version 5 of the RPC protocol"),
        (lambda _at, data: [data[:-1]], "PG705", "bytes is announced"),
    ],
)  # fmt: skip
def test_wrong_answers(damage, code, told):
    """Of another connection, another sequence number, another length, no answer at all: a message says which."""
    wire = Wire(PnDevice(drive()), back=damage)
    with pytest.raises(DiagnosticError) as wrong, channel(wire) as reader:
        list(reader.read([(REAL, [0])], 2))
    assert (wrong.value.diagnostics[0].code, told in wrong.value.diagnostics[0].message) == (code, True), wrong.value


def test_answers_of_others_do_not_matter():
    """A packet of another connection before each right one, and a torn one: they are passed over."""
    strange = rpc.encode_packet(Packet(PacketType.RESPONSE, 0, OBJECT, 0, bytes(20)))
    with channel(Wire(PnDevice(drive()), back=lambda _at, data: (strange, b"?", data))) as reader:
        assert _texts(reader, (REAL, range(2))) == ["10", "5.5"]


@pytest.mark.parametrize(("kind", "time"), [(PacketType.WORKING, 1.0), (PacketType.NO_CALL, 0.0)])
def test_not_yet(kind, time):
    """A device that says WORKING is asked again after a fifth of the 5 s; one that knows no such call at once."""

    def other(at: int, data: bytes) -> list[bytes]:
        return [rpc.encode_packet(replace(rpc.decode_packet(data), kind=kind, body=b""))] if at == 2 else [data]

    wire = Wire(PnDevice(drive()), back=other)
    with channel(wire) as reader:
        assert _texts(reader, (REAL, range(1))) == ["10"]
    assert wire.time == time
    assert wire.device.done["connect"] == 1


def test_a_device_without_room():
    """A second relation is refused with DB814004: nothing else is tried, and the first one goes on."""
    device = PnDevice(drive())
    wire, second = Wire(device), Wire(device)
    with channel(wire) as reader:
        with pytest.raises(DiagnosticError) as full, channel(second):
            pass
        assert _texts(reader, (REAL, range(1))) == ["10"]
    assert full.value.diagnostics[0].code == "PG708"
    assert "no room for another connection" in full.value.diagnostics[0].message
    assert "DB814004" in full.value.diagnostics[0].message
    assert sum(rpc.decode_packet(data).operation == Operation.CONNECT for way, data in second.seen
               if way == "there" and rpc.decode_packet(data).interface == rpc.IO_DEVICE) == 1  # fmt: skip


def test_a_relation_ends_with_time():
    """Silent for longer than 100 * 100 ms: DE814005, and there is room for another one."""
    wire = Wire(PnDevice(drive()))
    with pytest.raises(DiagnosticError) as gone, channel(wire) as reader:  # noqa: PT012 - time passes in between
        wire.pause(10.1)
        list(reader.read([(REAL, [0])], 2))
    assert "it does not know this connection (any more)" in gone.value.diagnostics[0].message
    with channel(Wire(wire.device)) as reader:
        assert _texts(reader, (REAL, range(1))) == ["10"]


def test_references():
    """Each request has the next one: 1 to 255, and then 1 again; 0 is reserved."""
    wire = Wire(PnDevice(drive()))
    with channel(wire) as reader:
        for _ in range(256):
            list(reader.read([(REAL, [0])], 2))
    sent = [call.data[0] for call in wire.device.drive.journal if call.direction == "write"]
    assert sent == [*range(1, 256), 1]


def test_bodies_have_an_end():
    """A fragment that comes a hundred times counts once; more than 64 KiB are refused, and a number behind the last."""
    part = Packet(PacketType.RESPONSE, 0, OBJECT, 0, bytes(1384), flags=rpc.FRAGMENT)
    assembly = rpc.Assembly()
    assert [assembly.add(part) for _ in range(100)] == [None] * 100
    for number in range(47):  # 47 * 1384 = 65,048
        assembly.add(replace(part, fragment=number))
    with pytest.raises(rpc.PacketError, match="are no body"):
        assembly.add(replace(part, fragment=47))
    assembly = rpc.Assembly()
    assembly.add(replace(part, fragment=3))
    with pytest.raises(rpc.PacketError, match="are no body"):
        assembly.add(replace(part, fragment=1, flags=rpc.FRAGMENT | rpc.LAST))


def test_limits_of_a_record():
    """39 parameters make a request of 4 + 39 * 6 = 238 bytes; 40 need two. 58 DWORD are 4 + 2 + 232 = 238 bytes."""
    g120 = find_device("sinamics-g120")
    wire = Wire(PnDevice(drive()))
    with channel(wire, known=g120) as reader:
        list(reader.read([(Parameter(52, "Unsigned16"), [0])] * 40, 2))
    assert [len(call.data) for call in wire.device.drive.journal if call.direction == "write"] == [238, 10]
    assert max(len(call.data) for call in wire.device.drive.journal if call.direction == "read") <= 240


def test_a_change_that_does_not_fit_is_not_sent():
    """20 REAL are 4 + 20 * 12 = 244 bytes: none of them is written."""
    wire = Wire(PnDevice(drive()))
    with channel(wire) as reader, pytest.raises(DiagnosticError) as long:
        reader.change([_changed(1.0)] * 20, 2)
    assert (long.value.diagnostics[0].code, changes(wire.device.drive)) == ("PG709", 0)
    with channel(wire) as reader:
        assert reader.change([_changed(1.0)] * 19, 2) == []  # 232 bytes


def test_a_record_of_241_bytes_is_refused():
    """By the device, with DF80B100; 240 bytes are a matter of their content."""
    wire = Wire(PnDevice(drive()))
    with PnConnection(PLACE, 0xB02F, 5.0, wire) as connection:
        for size, status in ((241, "DF80B100"), (240, None)):
            request = bytes.fromhex("01 01 02 01 10 01 04 60 00 00").ljust(size, b"\0")
            if status:
                with pytest.raises(Exception, match=status):
                    connection.write(request)
            else:
                connection.write(request)


@pytest.mark.parametrize("size", [8, 64, 100])
def test_fragments(size):
    """A device whose packets are short: bodies are put together, whatever the order they come in."""
    wire = Wire(PnDevice(drive(), fragment=size))
    backwards: list[bytes] = []

    def reverse(_at: int, data: bytes) -> list[bytes]:
        packet = rpc.decode_packet(data)
        backwards.insert(0, data)
        if packet.fragmented and not packet.flags & rpc.LAST:
            return []
        found = list(backwards)
        backwards.clear()
        return found

    wire.back = reverse
    with channel(wire) as reader:
        assert _texts(reader, (REAL, range(2))) == ["10", "5.5"]


def test_fragments_of_a_request():
    """A long request in pieces of 100 octets that ask for a receipt: FACK of each but the last, then one answer."""
    device = PnDevice(drive())
    relation = pnio.Relation(OBJECT, 1, OBJECT)
    body = pnio.encode_args(pnio.encode_ar_request(relation), "little")
    whole = Packet(PacketType.REQUEST, Operation.CONNECT, OBJECT, 0, body, object=OBJECT)
    parts = [replace(one, flags=one.flags & ~rpc.NO_FACK) for one in rpc.fragments(whole, 40)]
    answers = [[rpc.decode_packet(one) for one in device.receive(rpc.encode_packet(part))] for part in parts]
    assert [[one.kind.name for one in each] for each in answers] == [["FACK"], ["FACK"], ["RESPONSE"]]
    assert [each[0].fragment for each in answers[:2]] == [0, 1]
    assert device.done == {"connect": 1}


def test_a_receipt_that_is_asked_for():
    """The client acknowledges each fragment whose sender waits for it."""
    wire = Wire(PnDevice(drive(), fragment=64))

    def asking(_at: int, data: bytes) -> list[bytes]:
        packet = rpc.decode_packet(data)
        return [rpc.encode_packet(replace(packet, flags=packet.flags & ~rpc.NO_FACK))]

    wire.back = asking
    with channel(wire) as reader:
        assert _texts(reader, (REAL, range(1))) == ["10"]
    kinds = [rpc.decode_packet(data).kind for way, data in wire.seen if way == "there"]
    assert PacketType.FACK in kinds


def test_every_connect_is_harmless():
    """Of all that was sent in this module's way: AR type 6, device access, no takeover, one block, nothing else."""
    wire = Wire(PnDevice(drive()))
    with channel(wire) as reader:
        list(reader.read([(REAL, [0])], 2))
        reader.change([_changed(12.0)], 2)
    sent = [rpc.decode_packet(data) for way, data in wire.seen if way == "there"]
    connects = [one for one in sent if one.interface == rpc.IO_DEVICE and one.operation == 0]
    assert len(connects) == 1
    for one in connects:
        blocks = one.body[20:]
        assert blocks[:2] == b"\x01\x01"  # ARBlockReq
        assert len(blocks) == int.from_bytes(blocks[2:4]) + 4  # and nothing behind it: no IOCR, submodules, alarms
        assert int.from_bytes(blocks[6:8]) == 6  # IO supervisor
        properties = int.from_bytes(blocks[48:52])
        assert properties == 0b1_0001_0001  # active, parameters by the initiator, device access; bit 3, takeover, is 0
    used = {one.operation for one in sent if one.interface == rpc.IO_DEVICE}
    assert used == {0, 1, 2, 3}  # connect, release, read, write: no control, which would begin to set parameters


def test_nothing_else_can_be_connected():
    """The only place that makes a connect request takes type and properties from a relation with these defaults."""
    relation = pnio.Relation(OBJECT, 1, OBJECT)
    assert (relation.kind, relation.properties) == (6, 0x111)
    assert not relation.properties & pnio.TAKEOVER


@pytest.mark.parametrize(
    ("host", "why"),
    [
        ("192.168.0.5", ""),
        ("127.0.0.1", ""),
        ("224.0.0.1", "multicast"),
        ("239.255.255.250", "multicast"),
        ("255.255.255.255", "broadcast"),
        ("240.0.0.1", "broadcast or reserved"),
        ("0.0.0.0", "no address of a device"),  # noqa: S104 - it is refused
        ("drive.local", "no IPv4 address"),
        ("192.168.0.5,192.168.0.6", "no IPv4 address"),
        ("192.168.0.0/24", "no IPv4 address"),
        ("", "no IPv4 address"),
    ],
)
def test_one_device_is_addressed(host, why):
    """Neither groups nor ranges nor everybody."""
    assert why in unicast(host)
    assert bool(why) == bool(unicast(host))


def test_reading_writes_nothing():
    """Reads of all kinds: the drive has seen requests to read alone, and its values are those of before."""
    wire = Wire(PnDevice(drive()))
    before = [list(one.values) for one in wire.device.drive.objects[2].parameters.values()]
    with channel(wire) as reader:
        list(reader.read([(REAL, range(2)), (WORD, range(120)), (Parameter(9, ""), [0])], 2))
    assert changes(wire.device.drive) == 0
    assert before == [list(one.values) for one in wire.device.drive.objects[2].parameters.values()]
    assert intact(0, b"") == (b"",)
    assert S120.key == "sinamics-s120"
