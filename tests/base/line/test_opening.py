"""Lines by their names: schemes, hints for those that do not exist, RFC 2217 against pyserial's own server side."""

from __future__ import annotations

import socket
import sys
import threading
from collections.abc import Iterator
from typing import Any

import pytest

from plcgen.base.line.model import LineError
from plcgen.base.line.opening import open_line
from plcgen.ppi.client import Client
from plcgen.ppi.sim import Bus, Station


@pytest.mark.parametrize(
    ("name", "help_"),
    [
        ("tcp://10.0.0.5:4000", 'did you mean "socket://10.0.0.5:4000"?'),
        ("telnet://10.0.0.5:23", 'did you mean "rfc2217://10.0.0.5:23"?'),
        ("serial:///dev/ttyUSB0", 'did you mean "/dev/ttyUSB0"?'),
        ("sockt://10.0.0.5:4000", "socket://"),
        ("quic://10.0.0.5:4000", "rfc2217://HOST:PORT is a serial server that takes speed and parity"),
    ],
)
def test_a_scheme_that_does_not_exist(name: str, help_: str) -> None:
    """The message names the scheme, the help what was meant and what there is."""
    with pytest.raises(LineError) as caught:
        open_line(name)
    (found,) = caught.value.diagnostics
    assert found.code == "PG720"
    assert "unknown kind of line" in found.message
    assert help_ in found.help


def test_a_serial_server_without_its_scheme() -> None:
    """A host and a number are no port of this machine."""
    pytest.importorskip("serial")
    with pytest.raises(LineError) as caught:
        open_line("127.0.0.1:10222")
    assert caught.value.diagnostics[0].help == 'did you mean "socket://127.0.0.1:10222"?'


def test_a_serial_server_that_is_not_there() -> None:
    """An RFC 2217 server that refuses the connection is a line that cannot be opened."""
    pytest.importorskip("serial")
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
    with pytest.raises(LineError) as caught:
        open_line(f"rfc2217://127.0.0.1:{port}")
    assert caught.value.diagnostics[0].code == "PG720"


@pytest.fixture
def rfc2217() -> Iterator[tuple[str, Any]]:
    """A bus behind the server side of pyserial's RFC 2217: its name, and the port that the client sets."""
    serial = pytest.importorskip("serial")
    manager_of = pytest.importorskip("serial.rfc2217").PortManager
    port = serial.serial_for_url("loop://", timeout=0)
    bus = Bus([Station(values={"VW100": 1234})])
    server = socket.create_server(("127.0.0.1", 0))

    def serve() -> None:
        connection, _ = server.accept()
        with connection, connection.makefile("wb", buffering=0) as out:
            manager = manager_of(port, out)
            while data := connection.recv(1024):
                answer = bus.exchange(b"".join(manager.filter(bytes(data))))
                if answer:
                    out.write(b"".join(manager.escape(answer)))

    thread = threading.Thread(target=serve, daemon=True)
    thread.start()
    yield f"rfc2217://127.0.0.1:{server.getsockname()[1]}", port
    server.close()
    thread.join(5)


@pytest.mark.filterwarnings("ignore:set(Daemon|Name):DeprecationWarning")
def test_rfc_2217(rfc2217: tuple[str, Any]) -> None:
    """The client reads through it, and the server has been told 19200 bit/s and even parity."""
    name, port = rfc2217
    with Client.open(name, rate=19200) as plc:
        assert plc.read("VW100")[0].value == 1234
    assert (port.baudrate, port.parity) == (19200, "E")


@pytest.mark.parametrize("name", ["10.0.0.5:4000", "plc-gateway:4001", "[::1]:4000", ":4000"])
def test_a_serial_server_without_its_scheme_or_pyserial(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """It needs no pyserial: what helps is the scheme, not the package."""
    monkeypatch.setitem(sys.modules, "serial", None)
    with pytest.raises(LineError) as caught:
        open_line(name)
    assert caught.value.diagnostics[0].help == f'did you mean "socket://{name}"?'
