"""s7://: the same client over ISO-on-TCP, against our gateway and python-snap7's server."""

import pytest

from plcgen.base.line.model import LineError
from plcgen.base.line.opening import open_line
from plcgen.ppi import gateway
from plcgen.ppi.client import RefusedError, Settings
from plcgen.ppi.client.iso import open_iso
from plcgen.ppi.wire.iso import IsoError, connect_confirm
from tests.ppi.gateway.test_clients import Served

SETTINGS = Settings(answer=2.0)


def test_the_same_addresses_and_values():
    """V, M, T, bits, types, 1000 bytes and a write, as over PPI."""
    with Served(["V"]) as served:
        served.plc["T32"] = 9
        with open_iso(f"s7://127.0.0.1:{served.port}", SETTINGS) as client:
            readings = client.read("VB100", "VW102:INT", "V100.1", "MB3", "T32", "VB0[1000]", "VB9000")
            assert [reading.value for reading in readings[:5]] == [0x22, 1234, True, 7, 9]
            assert len(readings[5].data) == 1000
            assert readings[6].error == "05h address out of range"
            assert client.write({"VW102": 77})[0].ok
            assert client.info().type == "CPU 224"
            with pytest.raises(RefusedError):
                client.stop()
    assert (served.plc["VW102"], served.plc.mode.value) == (77, "run")


def test_the_foreign_server_of_python_snap7():
    """Data block 1 of somebody else's server: read and written."""
    from snap7.server import Server, SrvArea

    other, memory = Server(), bytearray(100)
    memory[4:6] = b"\x04\xd2"
    other.register_area(SrvArea.DB, 1, memory)
    port = 10462
    other.start(tcp_port=port)
    try:
        with open_iso(f"s7://127.0.0.1:{port}?tsap=10.00/03.01", SETTINGS) as client:
            assert client.read("VW4")[0].value == 1234
            assert client.write({"VB9": 5})[0].ok
            assert client.read("VB9")[0].value == 5
    finally:
        other.stop()


def test_tsaps_are_tried_in_turn(monkeypatch):
    """A PLC that only answers to 03.01, the last that is tried; to none of the named ones: all are told."""

    def confirm(asked):
        if asked.called != b"\x03\x01":
            raise IsoError("not mine")
        return connect_confirm(asked)

    monkeypatch.setattr(gateway, "connect_confirm", confirm)
    with Served() as served:
        with open_iso(f"s7://127.0.0.1:{served.port}", SETTINGS) as client:
            assert client.read("VB100")[0].value == 0x22
        with pytest.raises(LineError, match=r"with the TSAPs 10\.00/10\.01:"):
            open_iso(f"s7://127.0.0.1:{served.port}?tsap=10.00/10.01", SETTINGS)


@pytest.mark.parametrize("name", ["s7://", "s7://host?tsap=1/2", "s7://a b:x", "s7://h/x"])
def test_names_that_are_none(name):
    """What cannot be a PLC is refused with the way to write one."""
    with pytest.raises(LineError):
        open_iso(name, Settings(answer=0.1))


@pytest.mark.parametrize("name", ["tcp://10.0.0.5:102", "socket://10.0.0.5:102", "raw://10.0.0.5:102/"])
def test_tcp_with_port_102_gets_advice(name):
    """Port 102 is no serial server: the help names s7://."""
    with pytest.raises(LineError) as caught:
        open_line(name)
    assert 'did you mean "s7://10.0.0.5"?' in caught.value.diagnostics[0].help
