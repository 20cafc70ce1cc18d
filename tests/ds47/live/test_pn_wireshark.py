"""Every packet of both ends through Wireshark's dissector, field by field: it reads what we read."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from plcgen.base.diagnostics import DiagnosticError
from plcgen.base.programs import find_program
from plcgen.ds47.device import Parameter
from plcgen.ds47.live.channel import PnParameters
from plcgen.ds47.proof.dissected import compare_dissection, request_facts, response_facts
from plcgen.ds47.sim.pn_device import PnDevice
from plcgen.ds47.wire import formats, pnio, rpc
from plcgen.ds47.wire.codec import decode_request, decode_response
from plcgen.ds47.wire.model import ParameterAddress, ValueBlock
from plcgen.ds47.wire.rpc import Operation, Packet, PacketType
from plcgen.oracles import wireshark
from tests.ds47.live.pn_bench import Wire, channel, drive

PROGRAM = find_program("tshark") or ""
pytestmark = [
    pytest.mark.skipif(not PROGRAM, reason="tshark is not installed (apt install tshark)"),
    pytest.mark.slow,
]
REAL = formats.by_name("FloatingPoint")


def _talk(reader: PnParameters) -> None:
    """Values, an array, errors, a busy drive, a change, a refused change."""
    list(reader.read([(Parameter(1120, "FloatingPoint"), range(2)), (Parameter(9, ""), [0])], 2))
    list(reader.read([(Parameter(59900, "Unsigned16"), range(117))], 2))
    for value in (12.0, 1000.0):
        reader.change([(ParameterAddress(1120, 0, 1), ValueBlock.of(REAL, [value]))], 2)


def _seen(order: str, fragment: int = rpc.BODY) -> list[tuple[str, bytes]]:
    """Everything on the wire, with a second connection that is refused, and a record that is not there."""
    wire = Wire(PnDevice(drive(processing=150), fragment=fragment))
    with channel(wire, order) as reader:
        _talk(reader)
        other = Wire(wire.device)
        with pytest.raises(DiagnosticError), channel(other, order):
            pass
    third = Wire(wire.device)
    with pytest.raises(DiagnosticError), channel(third, order, index=48) as reader:
        list(reader.read([(Parameter(1120, "FloatingPoint"), range(2))], 2))
    return [*wire.seen, *other.seen, *third.seen]


def _facts(packet: Packet, data: bytes) -> Iterator[tuple[str, object]]:
    """Fields of a packet in the order of its bytes, as we read them, under Wireshark's names."""
    yield "dcerpc.ver", 4
    yield "dcerpc.pkt_type", int(packet.kind)
    for bit, name in ((rpc.LAST, "last_frag"), (rpc.FRAGMENT, "frag"), (rpc.NO_FACK, "nofack"),
                      (rpc.IDEMPOTENT, "idempotent")):  # fmt: skip
        yield f"dcerpc.dg_flags1_{name}", int(bool(packet.flags & bit))
    yield "dcerpc.drep.byteorder", int(packet.order == "little")
    yield "dcerpc.obj_id", str(packet.object)
    yield "dcerpc.dg_if_id", str(packet.interface)
    yield "dcerpc.dg_act_id", str(packet.activity)
    yield "dcerpc.dg_if_ver", rpc.VERSIONS[packet.interface]
    yield "dcerpc.dg_seqnum", packet.sequence
    yield "dcerpc.opnum", packet.operation
    yield "dcerpc.dg_frag_len", len(data) - rpc.HEADER
    yield "dcerpc.dg_frag_num", packet.fragment
    if not packet.fragmented:
        yield from _look_up(packet) if packet.interface == rpc.ENDPOINT_MAPPER else _operation(packet)


def _look_up(packet: Packet) -> Iterator[tuple[str, object]]:
    if packet.kind is PacketType.REQUEST:
        inquiry, handle, most = pnio.decode_lookup(packet.body, packet.order)
        yield from (("epm.inq_type", inquiry), ("epm.hnd", handle.hex(":")), ("epm.max_ents", most))
        return
    found = pnio.decode_found(packet.body, packet.order)
    yield from (("epm.hnd", found.handle.hex(":")), ("epm.num_ents", len(found.entries)))
    for entry in found.entries:
        yield from (("epm.object", str(entry.object)), ("epm.uuid", str(entry.interface)))
        yield from (("epm.proto.udp_port", entry.port), ("epm.annotation", entry.text))
    yield "epm.rc", found.status


def _operation(packet: Packet) -> Iterator[tuple[str, object]]:
    first, blocks = pnio.decode_args(packet.body, packet.order)
    answer = packet.kind is PacketType.RESPONSE
    if answer:
        yield from (("pn_io.error_code", first >> 24), ("pn_io.error_decode", first >> 16 & 0xFF))
        yield from (("pn_io.error_code1", first >> 8 & 0xFF), ("pn_io.error_code2", first & 0xFF))
    else:
        yield "pn_io.args_max", first
    yield from (("pn_io.args_len", len(blocks)), ("pn_io.array_act_count", len(blocks)))
    if blocks:
        yield from (
            ("pn_io.block_type", int.from_bytes(blocks[:2])),
            ("pn_io.block_length", int.from_bytes(blocks[2:4])),
        )
        yield from _block(Operation(packet.operation), blocks, answer)


def _block(operation: Operation, blocks: bytes, answer: bool) -> Iterator[tuple[str, object]]:
    if operation is Operation.CONNECT and answer:
        _, ar, session = pnio.decode_ar_answer(blocks)
        yield from (("pn_io.ar_uuid", str(ar)), ("pn_io.session_key", session))
    elif operation is Operation.CONNECT:
        asked, more = pnio.decode_ar_request(blocks)
        assert not more
        yield from (("pn_io.ar_uuid", str(asked.ar)), ("pn_io.session_key", asked.session))
        yield from (("pn_io.cminitiator_mac_add", asked.mac.hex(":")), ("pn_io.cminitiator_uuid", str(asked.initiator)))
        yield "pn_io.ar_properties", asked.properties
        yield "pn_io.cminitiator_activitytimeoutfactor", asked.timeout
        yield "pn_io.cminitiator_station_name", asked.station.decode()
    elif operation is Operation.RELEASE:
        _, ar, session, command = pnio.decode_release(blocks)
        yield from (("pn_io.ar_uuid", str(ar)), ("pn_io.session_key", session), ("pn_io.control_command", command))
    else:
        kinds = {Operation.READ: (pnio.READ_REQUEST, pnio.READ_ANSWER),
                 Operation.WRITE: (pnio.WRITE_REQUEST, pnio.WRITE_ANSWER)}  # fmt: skip
        record = pnio.decode_record(blocks, kinds[operation][answer])
        yield from (("pn_io.seq_number", record.sequence), ("pn_io.ar_uuid", str(record.ar)))
        yield from (("pn_io.api", record.api), ("pn_io.slot_nr", record.slot), ("pn_io.subslot_nr", record.subslot))
        yield from (("pn_io.index", record.index), ("pn_io.record_data_length", record.size))


def _telegram(packet: Packet) -> tuple[str, list[tuple[str, object]]] | None:
    """The parameter request of a write, or the answer of a read, as the codec reads it."""
    if packet.fragmented or packet.interface != rpc.IO_DEVICE:
        return None
    blocks = pnio.decode_args(packet.body, packet.order)[1]
    if packet.operation == Operation.WRITE and packet.kind is PacketType.REQUEST:
        record = pnio.decode_record(blocks, pnio.WRITE_REQUEST)
        return ("request", request_facts(decode_request(record.data))) if record.index == 0xB02F else None
    if packet.operation == Operation.READ and packet.kind is PacketType.RESPONSE and blocks:
        record = pnio.decode_record(blocks, pnio.READ_ANSWER)
        return ("answer", response_facts(decode_response(record.data))) if record.data else None
    return None


def _same(wanted: object, shown: str) -> bool:
    return int(shown, 0) == wanted if isinstance(wanted, int) else shown == wanted


@pytest.mark.parametrize(("order", "fragment"), [("little", rpc.BODY), ("big", rpc.BODY), ("little", 64)])
def test_every_field_of_every_packet(order, fragment):
    """Wireshark shows each field with our value, in our order, and nothing as malformed; bodies in fragments, too."""
    seen = _seen(order, fragment)
    shown = wireshark.dissect(PROGRAM, wireshark.datagrams((way == "back", data) for way, data in seen))
    assert len(shown) == len(seen)
    compared, telegrams, prefix = 0, 0, wireshark.PROFIDRIVE
    unknown: set[str] = set()
    for (_, data), fields in zip(seen, shown, strict=True):
        names = [name for name, _ in fields]
        assert not [name for name in names if name.startswith(("_ws.malformed", "_ws.expert"))], fields
        left = list(fields)
        packet = rpc.decode_packet(data)
        for name, wanted in _facts(packet, data):
            at = next((at for at, (one, text) in enumerate(left) if one == name and _same(wanted, text)), None)
            assert at is not None, (name, wanted, [text for one, text in fields if one == name])
            del left[: at if name.startswith(("pn_io", "epm")) else 0]
            compared += 1
        telegram = _telegram(packet)
        if telegram is not None:
            own = tuple((name.removeprefix(prefix), text) for name, text in fields if name.startswith(prefix))
            wrong = compare_dissection(telegram[0], telegram[1], wireshark.Dissected(own), unknown)
            assert not wrong
            telegrams += 1
    assert compared > (20 if fragment == rpc.BODY else 15) * len(seen)
    assert telegrams >= (8 if fragment == rpc.BODY else 4)
    assert not unknown


def test_every_connect_in_wireshark():
    """As Wireshark names them: IO supervisor, device access, no takeover; no IOCR, submodule or alarm."""
    seen = _seen("little")
    shown = wireshark.dissect(PROGRAM, wireshark.datagrams((way == "back", data) for way, data in seen))
    connects = [fields for (way, _), fields in zip(seen, shown, strict=True)
                if way == "there" and ("pn_io.opnum", "0") in fields]  # fmt: skip
    assert len(connects) == 3
    for fields in connects:
        found = {name: text for name, text in fields if name.startswith("pn_io.ar_properties.")}
        bits = {name.rpartition(".")[2] for name, text in found.items() if int(text, 0)}
        assert bits == {"device_access", "parameterization_server", "state"}
        assert int(found["pn_io.ar_properties.supervisor_takeover_allowed"], 0) == 0
        blocks = [text for name, text in fields if name == "pn_io.block_type"]
        assert blocks == ["0x0101"]


def test_a_wrong_field_is_found():
    """The comparison notices a number that is another one: the sequence number of the record is 9, not 1."""
    wire = Wire(PnDevice(drive()))
    with channel(wire) as reader:
        list(reader.read([(Parameter(1120, "FloatingPoint"), [0])], 2))
    data = next(data for way, data in wire.seen if rpc.decode_packet(data).operation == Operation.WRITE)
    at = rpc.HEADER + 20 + 6  # arguments, block header
    (fields,) = wireshark.dissect(PROGRAM, wireshark.datagrams([(False, data[:at] + b"\0\x09" + data[at + 2 :])]))
    texts = [text for name, text in fields if name == "pn_io.seq_number"]
    assert not any(_same(1, text) for text in texts)
    assert any(_same(9, text) for text in texts)
