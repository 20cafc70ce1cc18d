"""A bus on real lines, and the client of python-snap7, which others wrote, talking to it."""

from __future__ import annotations

import socket
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from typing import Any

import pytest

from plcgen.base.line.opening import open_line
from plcgen.base.line.pty import PtyLine
from plcgen.base.line.tcp import TcpServer, parse_endpoint
from plcgen.ppi.sim import Bus, Station
from plcgen.ppi.sim.serve import MOST_CONNECTIONS, Serving
from plcgen.ppi.wire.areas import Area
from plcgen.ppi.wire.model import Item, ReadRequest
from plcgen.ppi.wire.telegram import encode_poll, encode_request

SOON = 5.0
E5 = b"\xe5"
REQUEST = encode_request(ReadRequest(7, (Item.memory(Area.V, 100),)))
POLL = encode_poll(function=0x5C)
GOOD = bytes.fromhex("68 16 16 68 00 02 08 32 03 00 00 00 07 00 02 00 05 00 00 04 01 FF 04 00 08 22 7F 16")


@pytest.fixture
def bus() -> Bus:
    return Bus([Station(values={"VB100": 0x22})])


def receive(connection: socket.socket, size: int) -> bytes:
    """Exactly ``size`` bytes, or what came before the end or the time-out."""
    found = b""
    while len(found) < size:
        more = connection.recv(size - len(found))
        if not more:
            break
        found += more
    return found


@contextmanager
def connected(name: str) -> Iterator[socket.socket]:
    with socket.create_connection(parse_endpoint(name), SOON) as connection:
        yield connection


# ---- Bytes over real lines -----------------------------------------------------------------------------------


def test_an_exchange_over_a_pseudo_terminal(bus: Bus) -> None:
    pytest.importorskip("serial")
    with Serving(bus, PtyLine()) as name:
        line = open_line(name)
        line.write(REQUEST)
        assert line.read(1, SOON) == E5
        line.write(POLL)
        found = b""
        while len(found) < len(GOOD):
            found += line.read(timeout=SOON)
        assert found == GOOD
        line.close()


def test_connections_one_after_the_other(bus: Bus) -> None:
    """Frames in pieces; each connection starts with fresh frame counts, the memory stays."""
    with Serving(bus, TcpServer("127.0.0.1:0")) as name:
        for value in (0x22, 0x23, 0x24):
            bus.stations[2]["VB100"] = value
            with connected(name) as client:
                for byte in encode_request(ReadRequest(7, (Item.memory(Area.V, 100),)), function=0x7C):
                    client.sendall(bytes((byte,)))
                assert receive(client, 1) == E5
                client.sendall(POLL)
                assert receive(client, len(GOOD))[-3] == value
    assert bus.stations[2].executed == 3


def test_two_clients_at_once(bus: Bus) -> None:
    """Nobody waits for another client, and nobody gets another one's answer."""
    with Serving(bus, TcpServer("127.0.0.1:0")) as name, connected(name) as first, connected(name) as second:
        first.sendall(REQUEST)
        assert receive(first, 1) == E5
        second.sendall(encode_request(ReadRequest(9, (Item.memory(Area.V, 0),))))
        assert receive(second, 1) == E5
        first.sendall(POLL)
        assert receive(first, len(GOOD)) == GOOD
        second.sendall(POLL)
        assert receive(second, len(GOOD))[11:13] == b"\x00\x09"


def test_idle_connections_keep_nobody_out(bus: Bus) -> None:
    """Who did nothing longest makes room; who is in the middle of something stays."""
    with Serving(bus, TcpServer("127.0.0.1:0")) as name, ExitStack() as idle:
        busy = idle.enter_context(connected(name))
        for _ in range(MOST_CONNECTIONS - 1):
            idle.enter_context(connected(name))
        busy.sendall(REQUEST)
        assert receive(busy, 1) == E5
        with connected(name) as late:
            late.sendall(encode_request(ReadRequest(9, (Item.memory(Area.V, 0),))))
            assert receive(late, 1) == E5
        busy.sendall(POLL)
        assert receive(busy, len(GOOD)) == GOOD


def test_a_client_that_vanishes_leaves_the_server_running(bus: Bus) -> None:
    serving = Serving(bus, TcpServer("127.0.0.1:0"))
    with serving as name:
        with connected(name) as client:
            client.sendall(REQUEST[:5])
        with connected(name) as client:
            client.sendall(REQUEST)
            assert receive(client, 1) == E5
    assert serving.failure is None


def test_a_late_answer_is_late_on_a_real_line(bus: Bus) -> None:
    """It comes by itself, without another byte from the client."""
    bus.faults += Bus((), ["late:milliseconds=30,at=request"]).faults
    with Serving(bus, TcpServer("127.0.0.1:0")) as name, connected(name) as client:
        client.sendall(REQUEST)
        assert receive(client, 1) == E5


def test_a_line_that_vanishes_is_told(bus: Bus) -> None:
    """The thread ends with the reason; nothing hangs."""

    class Gone:
        name = "gone"

        def read(self, maximum: int = 1, timeout: float | None = None) -> bytes:
            raise OSError("gone")

        def write(self, data: bytes) -> None:
            """Never called."""

        def close(self) -> None:
            """Nothing to close."""

    serving = Serving(bus, Gone())
    with serving:
        pass
    assert isinstance(serving.failure, OSError)


# ---- python-snap7 --------------------------------------------------------------------------------------------


@pytest.fixture(params=["pty", "socket"])
def served(request: pytest.FixtureRequest, bus: Bus) -> Iterator[tuple[Bus, str]]:
    """A bus on both kinds of lines."""
    line = PtyLine() if request.param == "pty" else TcpServer("127.0.0.1:0")
    with Serving(bus, line) as name:
        yield bus, name


@contextmanager
def snap7_client(name: str, wait: float = SOON, **more: Any) -> Iterator[Any]:
    """The client of python-snap7 over a pty or ``socket://``, which it opens through pyserial."""
    ppi = pytest.importorskip("snap7.ppi")
    serial = pytest.importorskip("serial")
    if name.startswith("socket://"):
        with (
            serial.serial_for_url(name, timeout=wait) as port,
            ppi.PPIClient(name, transport=ppi.PPITransport(name, serial_port=port, **more)) as client,
        ):
            yield client
        return
    with ppi.PPIClient(name, timeout=wait, **more) as client:
        yield client


def test_snap7_reads_and_writes_v_m_i_q(served: tuple[Bus, str]) -> None:
    """What it writes is in the memory, what the memory holds is read, at the first and last byte of each area."""
    bus, name = served
    station = bus.stations[2]
    with snap7_client(name) as client:
        area = pytest.importorskip("snap7.ppi").PPIArea
        for letter, last in (("V", 8191), ("M", 31), ("I", 15), ("Q", 15)):
            for at in (0, last):
                station[f"{letter}B{at}"] = 0xA5
                assert client.read_area(area[letter], at, 1) == b"\xa5"
                client.write_area(area[letter], at, b"\x5a")
                assert station[f"{letter}B{at}"] == 0x5A


def test_snap7_moves_the_longest_blocks(served: tuple[Bus, str]) -> None:
    """222 bytes read, 205 written (its own limit)."""
    bus, name = served
    data = bytes(range(205))
    with snap7_client(name) as client:
        client.v_write(1000, data)
        assert client.v_read(1000, 222) == data + bytes(17)
    assert bus.stations[2]["VB1000[205]"] == data


def test_snap7_reads_special_memory_and_analog_values(served: tuple[Bus, str]) -> None:
    bus, name = served
    bus.stations[2]["AIW4"] = 0x1234
    bus.stations[2]["SMB34"] = 0x50
    with snap7_client(name) as client:
        area = pytest.importorskip("snap7.ppi").PPIArea
        assert client.read_area(area.AI, 4, 1) == b"\x12\x34"
        assert client.read_area(area.SM, 34, 1) == b"\x50"
        client.write_area(area.AQ, 2, b"\x43\x21")
    assert bus.stations[2]["AQW2"] == 0x4321


def test_snap7_is_told_what_is_beyond_the_cpu(served: tuple[Bus, str]) -> None:
    """The return code 05 arrives as its error; the next read works."""
    error = pytest.importorskip("snap7.error").S7ProtocolError
    with snap7_client(served[1]) as client:
        with pytest.raises(error, match="0x05"):
            client.v_read(8191, 2)
        with pytest.raises(error):
            client.v_write(8192, b"\0")
        assert client.v_read(100, 1) == b"\x22"


@pytest.mark.parametrize(
    "faults",
    [
        ["not_ready:times=4"],
        ["late:milliseconds=40,times=3"],
        ["silence:at=request"],
    ],
)
def test_snap7_survives_what_a_real_line_does(bus: Bus, faults: list[str]) -> None:
    bus.faults += Bus((), faults).faults
    with Serving(bus, TcpServer("127.0.0.1:0")) as name, snap7_client(name, wait=0.5) as client:
        assert client.v_read(100, 1) == b"\x22"
    assert bus.faults == []


def test_snap7_reaches_every_station(bus: Bus) -> None:
    bus.add(Station("226", 5, values={"VB100": 0x55}))
    for station, expected in ((2, b"\x22"), (5, b"\x55")):
        with Serving(bus, TcpServer("127.0.0.1:0")) as name, snap7_client(name, station=station) as client:
            assert client.v_read(100, 1) == expected


def test_snap7_comes_back_to_a_pseudo_terminal(bus: Bus) -> None:
    """Program after program opens the same port."""
    pytest.importorskip("snap7.ppi")
    with Serving(bus, PtyLine()) as name:
        for _ in range(3):
            with snap7_client(name) as client:
                assert client.v_read(100, 1) == b"\x22"
