"""S7 clients on the gateway, over TCP on this machine: python-snap7, and raw connections that behave badly.

nodes7 (Node-RED) and libnodave are tried by hand, docs/ppi-plant.md says how.
"""

import contextlib
import socket
import threading
import time

import pytest
from snap7 import Area, Client
from snap7.error import S7Error

from plcgen.base.line.endpoint import EndpointLine
from plcgen.base.line.tcp import TcpServer
from plcgen.ppi.client import Client as PpiClient
from plcgen.ppi.gateway import Allowed, Gateway, Passing
from plcgen.ppi.sim import Bus, Station
from plcgen.ppi.wire.iso import carry, connect_request
from tests.ppi.gateway.test_iso import CONFIRM, REQUEST, SETUP


class Served:
    """A gateway in a thread."""

    def __init__(self, allowed=(), **how):
        self.plc = Station(values={"VB100": 0x22, "VW102": 1234, "MB3": 7, "IB0": 1, "QB0": 2})
        self.told, self.said = [], []
        self._line = EndpointLine(Bus([self.plc]))
        self.server = TcpServer("127.0.0.1:0")
        passing = Passing(self._open, Allowed.of(allowed), lambda *words: self.told.append(words), time.monotonic)
        self.gateway = Gateway(self.server, passing, self.said.append, **how)
        self.port = int(self.server.name.rpartition(":")[2])
        self._end = threading.Event()
        self._thread = threading.Thread(target=self.gateway.serve, args=(self._end.is_set, 0.02), daemon=True)

    def _open(self):
        return PpiClient(self._line, now=lambda: self._line.clock.now / 1000)

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._end.set()
        self._thread.join()
        self.server.close()

    def raw(self, *sent):
        """A connection that has sent some bytes."""
        found = socket.create_connection(("127.0.0.1", self.port), 5)
        found.settimeout(5)
        for data in sent:
            found.sendall(data)
        return found


@contextlib.contextmanager
def snap7(served):
    """A connected client of python-snap7; rack 0, slot 1."""
    client = Client()
    client.connect("127.0.0.1", 0, 1, served.port)
    try:
        yield client
    finally:
        client.disconnect()


def test_python_snap7_reads():
    """DB1 is V; M, I and Q by their names; 222 bytes at once and 1000 in pieces."""
    with Served() as served, snap7(served) as client:
        assert client.db_read(1, 100, 4) == bytearray.fromhex("22 00 04 D2")
        assert client.read_area(Area.MK, 0, 3, 1) == b"\x07"
        assert client.read_area(Area.PE, 0, 0, 1) == b"\x01"
        assert client.read_area(Area.PA, 0, 0, 1) == b"\x02"
        assert client.db_read(1, 0, 1000)[100:104] == bytearray.fromhex("22 00 04 D2")


def test_python_snap7_writes_only_where_it_may():
    """VB100[10] is allowed: written and told; VB200 is not: an error, and the value stays."""
    with Served(["VB100[10]"]) as served, snap7(served) as client:
        client.db_write(1, 100, bytearray(b"\x01\x02"))
        with pytest.raises(S7Error):
            client.db_write(1, 200, bytearray(b"\x09"))
    assert (served.plc["VW100"], served.plc["VB200"]) == (0x0102, 0)
    assert [words[1:] for words in served.told] == [("VB100[2] = 01 02", "ok"), ("VB200 = 09", "access denied")]


@pytest.mark.parametrize("call", ["plc_stop", "plc_hot_start", "plc_cold_start"])
def test_python_snap7_cannot_stop_the_plc(call):
    """RUN and STOP are errors for the client; the CPU does not hear of them."""
    with Served(["V", "M", "Q"]) as served, snap7(served) as client:
        with contextlib.suppress(S7Error):
            getattr(client, call)()
        assert client.db_read(1, 100, 1) == b"\x22"
    assert served.plc.mode.value == "run"
    assert served.plc.executed == 1


def test_several_clients_at_once():
    """Four clients with 25 reads each: every one gets its own answers."""

    def work(served, byte, found):
        with snap7(served) as client:
            found += [bytes(client.db_read(1, byte, 1)) for _ in range(25)]

    with Served() as served:
        for byte in range(4):
            served.plc[f"VB{byte}"] = byte + 1
        lists = [[] for _ in range(4)]
        threads = [threading.Thread(target=work, args=(served, byte, lists[byte])) for byte in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    assert lists == [[bytes([byte + 1])] * 25 for byte in range(4)]


def answer(connection, size):
    """So many bytes, or what came before the end."""
    found = b""
    with contextlib.suppress(TimeoutError, ConnectionError):
        while len(found) < size and (more := connection.recv(size - len(found))):
            found += more
    return found


def test_connecting_and_negotiating_byte_by_byte():
    """Confirmation, then a PDU of 240 bytes and one job: as the published captures have it."""
    with Served() as served, served.raw(REQUEST) as line:
        confirmed = answer(line, 22)
        assert confirmed[:6] + confirmed[11:] == CONFIRM[:6] + CONFIRM[11:]
        line.sendall(SETUP)
        # 27 bytes: ack-data, reference 0400h, F0, one job each way, 240 = 00F0h
        assert answer(line, 27).hex() == "0300001b02f0803203000004000008000000" + "00f0000001000100f0"


@pytest.mark.parametrize(
    "sent",
    [
        [b"GET / HTTP/1.0\r\n\r\n"], [SETUP], [REQUEST, REQUEST], [REQUEST, carry(b"hello, world")],
        [REQUEST, SETUP * 20],
        [bytes.fromhex("03 00 00 09 02 70 80 32 01")],
    ],
)  # fmt: skip
def test_connections_that_behave_badly_are_ended(sent):
    """HTTP, no greeting, two of them, no S7, a flood, another kind: closed, and the next client is served."""
    with Served() as served:
        with served.raw(*sent) as line:
            while answer(line, 4096):
                pass
        with snap7(served) as client:
            assert client.db_read(1, 100, 1) == b"\x22"
    assert any("disconnected" in text for text in served.said)


def test_connections_are_bounded():
    """With room for two, the third ends the one that was silent longest."""
    hello = connect_request(b"\x01\x00", b"\x03\x01")
    with Served(most=2) as served, served.raw(hello) as first:
        assert len(answer(first, 22)) == 22
        with served.raw(hello) as second:
            assert len(answer(second, 22)) == 22
            with served.raw(hello) as third:
                assert len(answer(third, 22)) == 22
                assert answer(first, 1) == b""
                second.sendall(SETUP)
                assert len(answer(second, 27)) == 27


def test_silent_connections_are_ended():
    """After the time given by --idle."""
    with Served(idle=0.1) as served, served.raw(REQUEST) as line:
        assert answer(line, 22)
        assert line.recv(1) == b""
