"""Lines carry bytes, end in one known error, and wait in virtual time where they live in memory."""

from __future__ import annotations

import os
import socket
from collections.abc import Callable

import pytest

from plcgen.base.line import LineError, LineLostError
from plcgen.base.line.endpoint import Clock, EndpointLine
from plcgen.base.line.opening import open_line
from plcgen.base.line.pty import PtyLine
from plcgen.base.line.tcp import TcpLine, TcpServer, parse_endpoint

SOON = 5.0
"""Seconds after which a test gives up; nothing here takes that long."""


def code_of(action: Callable[[], object]) -> str:
    with pytest.raises(LineError) as caught:
        action()
    return caught.value.diagnostics[0].code


class Parrot:
    """Sends back what it gets, each time 30 ms later."""

    def __init__(self) -> None:
        self.queue: list[tuple[int, bytes]] = []

    def receive(self, data: bytes, now: int) -> None:  # noqa: D102
        self.queue.append((now + 30, data))

    def transmit(self, now: int) -> bytes:  # noqa: D102
        ready = b"".join(data for at, data in self.queue if at <= now)
        self.queue = [entry for entry in self.queue if entry[0] > now]
        return ready

    def due(self) -> int | None:  # noqa: D102
        return min((at for at, _ in self.queue), default=None)


def test_waiting_moves_the_clock_only_as_far_as_needed() -> None:
    """An answer due in 30 ms ends a wait of 100 ms after 30 ms; a missing one lets all 100 ms pass."""
    clock = Clock()
    line = EndpointLine(Parrot(), clock)
    line.write(b"ab")
    assert line.read(timeout=0.1) == b"ab"
    assert clock.now == 30
    assert line.read(timeout=0.1) == b""
    assert clock.now == 130


def test_an_answer_that_comes_too_late_is_there_at_the_next_read() -> None:
    """A timeout before the answer returns nothing and loses nothing."""
    line = EndpointLine(Parrot())
    line.write(b"abc")
    assert line.read(timeout=0.02) == b""
    assert line.read(maximum=2, timeout=0.02) == b"ab"
    assert line.read(timeout=0) == b"c"


def test_a_wait_that_never_ends_is_refused() -> None:
    """In memory nobody else can send: waiting for ever would hang the test."""
    with pytest.raises(LineLostError):
        EndpointLine(Parrot()).read()


def test_a_closed_line_in_memory_is_lost() -> None:
    line = EndpointLine(Parrot())
    line.close()
    assert code_of(lambda: line.write(b"a")) == "PG722"
    assert code_of(lambda: line.read(timeout=0)) == "PG722"


def test_time_does_not_run_backwards() -> None:
    with pytest.raises(ValueError, match="backwards"):
        Clock().advance(-1)


def test_a_pseudo_terminal_carries_every_byte_value_unchanged() -> None:
    """Raw mode: no echo, no line ends, no control characters."""
    line = PtyLine()
    other = os.open(line.name, os.O_RDWR | os.O_NOCTTY)
    try:
        os.write(other, bytes(range(256)))
        found = b""
        while len(found) < 256:
            found += line.read(timeout=SOON)
        assert found == bytes(range(256))
        line.write(bytes(range(256)))
        back = b""
        while len(back) < 256:
            back += os.read(other, 256)
        assert back == bytes(range(256))
        assert line.read(timeout=0) == b""
    finally:
        os.close(other)
        line.close()
    assert code_of(lambda: line.read(timeout=0)) == "PG722"


def test_a_serial_port_is_opened_through_pyserial_and_locked() -> None:
    """A pseudo terminal stands in for the port; a second program is told that it is in use."""
    pytest.importorskip("serial")
    master = PtyLine()
    port = open_line(master.name)
    try:
        assert port.name == master.name
        port.write(b"\x10\x02\x00\x5c\x5e\x16")
        assert master.read(timeout=SOON) == b"\x10\x02\x00\x5c\x5e\x16"
        master.write(b"\xe5\xe5\xe5")
        assert port.read(maximum=1, timeout=SOON) == b"\xe5"
        assert port.read(maximum=9, timeout=SOON) == b"\xe5\xe5"
        assert port.read(timeout=0) == b""
        assert code_of(lambda: open_line(master.name)) == "PG721"
    finally:
        port.close()
        master.close()


def test_programs_may_open_a_pseudo_terminal_again_and_again() -> None:
    """Linux refuses to change nothing but a parity that does not exist: the line leaves something to change."""
    serial = pytest.importorskip("serial")
    master = PtyLine()
    try:
        for _ in range(3):
            with serial.Serial(master.name, 9600, parity=serial.PARITY_EVEN, timeout=SOON) as port:
                for wait in (1, 2):
                    port.write(b"\xdc")
                    assert master.read(timeout=SOON) == b"\xdc"
                    port.timeout = wait
                port.write(b"\xe5")
                assert master.read(timeout=SOON) == b"\xe5"
    finally:
        master.close()


def test_a_serial_port_that_vanishes_is_lost() -> None:
    """The adapter is pulled out: the next use says so instead of raising something else."""
    pytest.importorskip("serial")
    master = PtyLine()
    port = open_line(master.name)
    master.close()
    try:
        assert code_of(lambda: port.read(timeout=0.01)) == "PG722"
    finally:
        port.close()


def test_a_serial_port_that_is_not_there_is_told() -> None:
    pytest.importorskip("serial")
    assert code_of(lambda: open_line("/dev/plcgen-no-such-port")) == "PG720"


def test_a_serial_port_without_pyserial_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "serial", None)
    with pytest.raises(LineError) as caught:
        open_line("/dev/ttyUSB0")
    assert caught.value.diagnostics[0].code == "PG723"
    assert "pip install pyserial" in caught.value.diagnostics[0].help


def test_tcp_connections_are_served_one_after_the_other() -> None:
    """Port 0 takes a free one; the second client waits until the first has gone."""
    server = TcpServer("127.0.0.1:0")
    try:
        for _ in range(2):
            client = open_line(server.name)
            accepted = server.accept(SOON)
            assert accepted is not None
            client.write(b"\x68\x1b")
            assert accepted.read(timeout=SOON) == b"\x68\x1b"
            accepted.write(b"\xe5")
            assert client.read(timeout=SOON) == b"\xe5"
            client.close()
            assert code_of(lambda line=accepted: line.read(timeout=SOON)) == "PG722"  # type: ignore[misc]
            accepted.close()
        assert server.accept(0) is None
        assert code_of(lambda: TcpServer(server.name)) == "PG721"
    finally:
        server.close()


def test_a_port_without_a_listener_is_told() -> None:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    assert code_of(lambda: TcpLine.connect(f"127.0.0.1:{port}")) == "PG720"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("127.0.0.1:4000", ("127.0.0.1", 4000)),
        (":4000", ("127.0.0.1", 4000)),
        ("socket://plc.local:102", ("plc.local", 102)),
        ("[::1]:7", ("::1", 7)),
    ],
)
def test_addresses(text: str, expected: tuple[str, int]) -> None:
    assert parse_endpoint(text) == expected


@pytest.mark.parametrize("text", ["", "4000", "host", "host:", "host:99999", "host:-1", "::1:7x", "::1:7", "a:١"])
def test_addresses_that_are_none(text: str) -> None:
    assert code_of(lambda: parse_endpoint(text)) == "PG720"


@pytest.mark.parametrize(
    ("name", "meant"),
    [
        ("10.0.0.5:4001", '"socket://10.0.0.5:4001"'),
        ("10.0.0.5:102", '"s7://10.0.0.5"'),
        ("COM3:9600", "write COM3: the speed"),
        ("ttyS0:19200", "write ttyS0: the speed"),
    ],
)
def test_a_number_after_a_colon(name: str, meant: str) -> None:
    """A host without a scheme is a serial server, at port 102 a PLC; the name of a port has no speed in it."""
    with pytest.raises(LineError) as caught:
        open_line(name)
    (told,) = caught.value.diagnostics
    assert (told.code, meant in told.help) == ("PG720", True)
