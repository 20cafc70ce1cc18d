"""A client by others against our device: profinet-py, which is not installed with plcgen (it is under the GPL)."""

from __future__ import annotations

import types

import pytest

from tests.ds47.live.pn_bench import changes, drive, served

rpc = pytest.importorskip("profinet.rpc", reason="profinet-py is not installed (pip install profinet-py)")
READ = bytes.fromhex("01 01 02 01 10 02 04 60 00 00")
WRITE = bytes.fromhex("02 02 02 01 10 01 04 60 00 00 08 01 41 40 00 00")


@pytest.fixture
def connection(monkeypatch):
    """Connected to a simulated drive on a port of this machine; it looks nobody up, so it is told the object UUID."""
    monkeypatch.setattr(rpc, "RPC_PORT", 0)  # for the second socket, which is for controllers
    one = drive(processing=1)
    with served(one) as where:
        device = {"device_high": 0, "device_low": 0, "vendor_high": 0, "vendor_low": 0}
        found = rpc.RPCCon(types.SimpleNamespace(ip="127.0.0.1", name="drive", **device), timeout=5)
        found.peer = ("127.0.0.1", int(where.rpartition(":")[2]))
        found.connect(bytes.fromhex("02 00 00 00 00 01"))
        yield found, one
        found.close()


def _read(connection, index: int) -> bytes:
    """The answer, asked for again while the drive is busy."""
    while True:
        try:
            return bytes(connection.read(0x3A00, 1, 1, index).payload)
        except rpc.PNIOError as busy:
            assert "B5" in str(busy)  # noqa: PT017 - every other error is one


@pytest.mark.parametrize("index", [47, 0xB02E, 0xB02F])
def test_read_and_write(connection, index):
    """Connect, write and read of the three records: 10.0 and 5.5; then 12.0 is written, once."""
    client, one = connection
    client.write(0x3A00, 1, 1, index, READ)
    assert _read(client, index) == bytes.fromhex("01 01 02 01 08 02 41 20 00 00 40 B0 00 00")
    client.write(0x3A00, 1, 1, index, WRITE)
    assert _read(client, index) == bytes.fromhex("02 02 02 01")
    assert one.objects[2].parameters[1120].values == [12.0, 5.5]
    assert changes(one) == 1


def test_refused(connection):
    """A record and a slot that the device does not have are errors there, too."""
    client, _ = connection
    for slot, index in ((1, 99), (9, 47)):
        with pytest.raises(rpc.PNIOError):
            client.write(0x3A00, slot, 1, index, READ)
