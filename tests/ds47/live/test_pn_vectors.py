"""Packets that others have captured: read as Wireshark shows them, and written again as they are."""

from __future__ import annotations

import tomllib
from dataclasses import replace
from pathlib import Path

import pytest

from plcgen.ds47.sim.pn_device import PnDevice
from plcgen.ds47.wire import pnio, rpc
from plcgen.ds47.wire.rpc import PacketType
from plcgen.ds47.wire.status import explain_pnio
from tests.ds47.live.pn_bench import drive

PACKETS = {
    row["id"]: row
    for row in tomllib.loads((Path(__file__).parents[2] / "vectors" / "pnio.toml").read_text("utf-8"))["packet"]
}


def _octets(name: str) -> bytes:
    return bytes.fromhex(PACKETS[name]["hex"])


def _blocks(name: str) -> bytes:
    packet = rpc.decode_packet(_octets(name))
    return pnio.decode_args(packet.body, packet.order)[1]


@pytest.mark.parametrize("name", PACKETS)
def test_header(name):
    """Kind, operation, sequence number and byte order."""
    row, packet = PACKETS[name], rpc.decode_packet(_octets(name))
    shown = (packet.kind.name.lower(), packet.operation, packet.sequence, packet.order)
    assert shown == (row["kind"], row["operation"], row["sequence"], row["order"])
    assert packet.interface == rpc.IO_DEVICE
    assert str(packet.object).startswith("dea00000-6c97-11d1-8271-")


@pytest.mark.parametrize("name", [name for name in PACKETS if name != "fack"])
def test_header_as_it_is(name):
    """Each octet of the header comes back, but for version, hints and padding that only one of the devices fills."""
    data = _octets(name)
    again = rpc.encode_packet(rpc.decode_packet(data))
    size = 80 + int.from_bytes(data[74:76], "little" if data[4] else "big")
    kept = [at for at in range(size) if not 68 <= at < 74 and at != 3]
    assert [again[at] for at in kept] == [data[at] for at in kept]


@pytest.mark.parametrize("name", [name for name in PACKETS if "status" in PACKETS[name]])
def test_status(name):
    """The first number of an answer."""
    packet = rpc.decode_packet(_octets(name))
    assert pnio.decode_args(packet.body, packet.order)[0] == PACKETS[name]["status"]


@pytest.mark.parametrize("name", ["connect-device-access", "connect-controller"])
def test_connect(name):
    """A supervisor's with device access is the same octets again; of a controller's, the blocks behind it are named."""
    row = PACKETS[name]
    found, more = pnio.decode_ar_request(_blocks(name))
    shown = (str(found.ar), found.session, found.properties, found.kind)
    assert shown == (row["ar"], row["session"], row["properties"], row["ar_type"])
    assert _blocks(name).startswith(pnio.encode_ar_request(found))
    assert bool(more) == (name == "connect-controller")


def test_a_controller_is_not_served():
    """The captured connect of a controller (AR type 1): field 4 of the AR block is refused, DB810104."""
    packet = rpc.decode_packet(_octets("connect-controller"))
    device = PnDevice(drive())
    (answer,) = device.receive(rpc.encode_packet(replace(packet, object=pnio.object_uuid(1, 0, 0))))
    found = rpc.decode_packet(answer)
    assert pnio.decode_args(found.body, found.order) == (0xDB810104, b"")


def test_the_session_of_another_stack_is_served():
    """Connect and release that p-net is tested with, of one relation: both are carried out, and answered."""
    device = PnDevice(drive())
    for name in ("connect-device-access", "release-device-access"):
        packet = rpc.decode_packet(_octets(name))
        (answer,) = device.receive(rpc.encode_packet(replace(packet, object=pnio.object_uuid(1, 0, 0))))
        found = rpc.decode_packet(answer)
        assert (found.kind, pnio.decode_args(found.body, found.order)[0]) == (PacketType.RESPONSE, 0)
    assert device.done == {"connect": 1, "release": 1}


@pytest.mark.parametrize("name", ["release-device-access", "release", "released"])
def test_release(name):
    """Relation, session and command; the same octets again."""
    row = PACKETS[name]
    _, ar, session, command = pnio.decode_release(_blocks(name))
    assert (str(ar), session, command) == (row["ar"], row["session"], row["command"])
    assert _blocks(name) == pnio.encode_release(ar, session, answer=name == "released")


def test_connected():
    """What a device answers to a controller: the first block is that of the relation."""
    row = PACKETS["connected"]
    kind, ar, session = pnio.decode_ar_answer(_blocks("connected"))
    assert (kind, str(ar), session) == (row["ar_type"], row["ar"], row["session"])


@pytest.mark.parametrize("name", [name for name in PACKETS if "block" in PACKETS[name]])
def test_records(name):
    """Slot, subslot, index, length and data; API 0 in all of them; the same octets again."""
    row = PACKETS[name]
    found = pnio.decode_record(_blocks(name), row["block"])
    assert (str(found.ar), found.slot, found.subslot) == (row["ar"], row["slot"], row["subslot"])
    assert (found.index, found.size, found.api) == (row["index"], row["size"], 0)
    assert found.sequence == row.get("record_sequence", found.sequence)
    assert found.data.hex() == row.get("data", found.data.hex())
    assert _blocks(name).startswith(pnio.encode_record(found))


def test_fack():
    """A receipt of a real device: version 1, window of one packet, 1464 octets; ours has the same content."""
    packet = rpc.decode_packet(_octets("fack"))
    fragment = rpc.Packet(PacketType.REQUEST, 3, packet.activity, 1, flags=rpc.FRAGMENT, order="little")
    ours = rpc.acknowledgement(fragment)
    assert ours is not None
    shown = [at for at in range(16) if at != 1]  # octet 1 is padding
    assert [ours.body[at] for at in shown] == [packet.body[at] for at in shown]


def test_a_device_without_room():
    """DB814004 of a real device, and what is said of it."""
    packet = rpc.decode_packet(_octets("no-room"))
    assert "no room for another connection" in explain_pnio(pnio.decode_args(packet.body, packet.order)[0])
