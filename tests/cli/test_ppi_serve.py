"""``plcgen ppi serve`` as people and programs meet it."""

from __future__ import annotations

import json
import os
import select
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from jsonschema import Draft202012Validator

from plcgen.api import schema
from plcgen.base.line.tcp import parse_endpoint

ROOT = Path(__file__).parents[2]
SOON = 20.0
REQUEST = bytes.fromhex(
    "68 1B 1B 68 02 00 6C 32 01 00 00 00 00 00 0E 00 00 04 01 12 0A 10 02 00 01 00 01 84 00 03 20 8B 16"
)
POLL = bytes.fromhex("10 02 00 5C 5E 16")
ANSWER = bytes.fromhex("68 16 16 68 00 02 08 32 03 00 00 00 00 00 02 00 05 00 00 04 01 FF 04 00 08 22 78 16")


@contextmanager
def running(tmp_path: Path, *args: str) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """A server process and its first line of output."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "COLUMNS": "100"}
    with subprocess.Popen(
        [sys.executable, "-m", "plcgen", "ppi", "serve", *args],
        cwd=tmp_path,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        try:
            assert process.stdout is not None
            yield process, process.stdout.readline().strip()
        finally:
            if process.poll() is None:
                process.kill()


def ended(process: subprocess.Popen[str], number: signal.Signals = signal.SIGTERM) -> tuple[str, str]:
    """Rest of the output after a signal; the exit code must be 0."""
    process.send_signal(number)
    out, err = process.communicate(timeout=SOON)
    assert process.returncode == 0, err
    return out, err


def exchange(name: str) -> bytes:
    """Read VB100 over TCP: E5 and the answer."""
    with socket.create_connection(parse_endpoint(name), SOON) as client:
        client.sendall(REQUEST)
        found = client.recv(1)
        client.sendall(POLL)
        while len(found) < 1 + len(ANSWER):
            found += client.recv(100)
        return found


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_it_serves_a_pseudo_terminal_until_a_signal(tmp_path: Path, number: signal.Signals) -> None:
    """Stdout has the name to open and nothing else, stderr tells people."""
    with running(tmp_path, "--set", "VB100=16#22") as (process, name):
        line = os.open(name, os.O_RDWR | os.O_NOCTTY)
        os.write(line, REQUEST + POLL)
        found = b""
        while len(found) < 1 + len(ANSWER) and select.select([line], [], [], SOON)[0]:
            found += os.read(line, 100)
        os.close(line)
        assert found == b"\xe5" + ANSWER
        out, err = ended(process, number)
    assert out == ""
    assert err == f"CPU 224, station 2, RUN, on {name}\nCtrl-C ends\nended after 1 request\n"


def test_the_log_shows_every_frame_decoded(tmp_path: Path) -> None:
    """One line per frame: time, direction, meaning, bytes, and what a fault did."""
    args = ("--tcp", "127.0.0.1:0", "--set", "VB100=16#22", "--log", "--quiet", "--fault", "token:at=poll")
    with running(tmp_path, *args) as (process, name):
        with socket.create_connection(parse_endpoint(name), SOON) as client:
            client.sendall(b"\x00" + REQUEST)
            found = client.recv(1)
            client.sendall(POLL)
            while not found.endswith(ANSWER):
                found += client.recv(100)
        out, err = ended(process)
    assert err == ""
    lines = [line[10:] for line in out.splitlines()]
    assert lines == [
        "->  1 byte without a frame  00",
        f"->  read request, station 0 to 2 (6C): VB100  {REQUEST.hex(' ').upper()}",
        "<-  acknowledgement  E5",
        "->  poll, station 0 to 2 (5C)  10 02 00 5C 5E 16",
        "<-  token, station 1 to 3  [token]  DC 03 01 DC 01 03",
        f"<-  read reply, station 2 to 0 (08): VB100 = 22  {ANSWER.hex(' ').upper()}",
    ]


def test_json_lines_are_for_programs(tmp_path: Path) -> None:
    """Open, connection, frames, end: one JSON object a line, nothing else on stdout."""
    with running(tmp_path, "--json", "--tcp", "127.0.0.1:0", "--set", "VB100=16#22") as (process, first):
        opened = json.loads(first)
        assert exchange(opened["line"]) == b"\xe5" + ANSWER
        out, _ = ended(process)
    assert opened["event"] == "open"
    assert opened["stations"] == [{"address": 2, "cpu": "CPU 224", "mode": "run"}]
    events = [json.loads(line) for line in out.splitlines()]
    line = Draft202012Validator(schema("serve"))
    assert [list(line.iter_errors(event)) for event in [opened, *events]] == [[]] * (1 + len(events))
    assert not line.is_valid({**opened, "event": "closed"})
    assert not line.is_valid({**opened, "surplus": 1})
    assert [event["event"] for event in events if event["event"] != "connection"] == ["frame"] * 4 + ["end"]
    frames = [event for event in events if event["event"] == "frame"]
    assert [frame["direction"] for frame in frames] == ["request", "answer"] * 2
    assert bytes.fromhex(frames[3]["bytes"]) == ANSWER
    assert frames[3]["text"] == "read reply, station 2 to 0 (08): VB100 = 22"
    assert frames[3]["fault"] is None
    assert events[-1]["requests"] == 1


def test_stations_values_and_faults_from_a_file(tmp_path: Path) -> None:
    (tmp_path / "plant.yaml").write_text(
        "stations:\n  - {address: 2, values: {VB100: 16#22}}\n  - {cpu: 226, address: 3, mode: stop}\n"
        "faults: [{kind: silence, station: 3}]\n"
    )
    with running(tmp_path, "--values", "plant.yaml", "--tcp", "127.0.0.1:0") as (process, name):
        assert exchange(name) == b"\xe5" + ANSWER
        _, err = ended(process)
    assert err.startswith(f"CPU 224, station 2, RUN, on {name}\nCPU 226, station 3, STOP, on {name}\n")


def test_symbols_of_micro_win_name_addresses(tmp_path: Path) -> None:
    """The table's names work in the file and on the command line."""
    (tmp_path / "plant.csv").write_text("Symbol,Address,Comment\nfill level,VB100,\nmode,VB101,\n")
    (tmp_path / "plant.yaml").write_text('values: {"fill level": 1, mode: 7}\n')
    args = ("--symbols", "plant.csv", "--values", "plant.yaml", "--set", "fill level=16#22", "--tcp", "127.0.0.1:0")
    with running(tmp_path, *args) as (process, name):
        assert exchange(name) == b"\xe5" + ANSWER
        ended(process)


def test_mistakes_in_file_and_options_are_told_together(plcgen, tmp_path) -> None:
    (tmp_path / "plant.yaml").write_text("cpu: 225\nvalues:\n  VB100: 300\n")
    result = plcgen("ppi", "serve", "--values", "plant.yaml", "--fault", "slience")
    assert result.code == 1
    assert result.out == ""
    for words in ('there is no CPU "225"', "VB100: 300 does not fit into 8 bits", 'there is no fault "slience"'):
        assert words in result.err
    assert "plant.yaml:3:10" in result.err
    assert "did you mean" in result.err


@pytest.mark.parametrize(
    ("args", "code", "words"),
    [
        (("--values", "nowhere.yaml"), 1, "PG110"),
        (("--cpu", "315"), 1, 'there is no CPU "315"'),
        (("--set", "VB9000=1"), 1, "beyond the memory of a CPU 224"),
        (("--set", "VB1"), 1, "an address and its value are needed"),
        (("--port", "/dev/plcgen-no-such-port"), 1, "PG720"),
        (("--tcp", "nonsense"), 1, "a TCP line is HOST:PORT"),
        (("--tcp", "a:1", "--port", "b"), 2, "cannot be used together"),
        (("--station", "127"), 2, "127"),
        (("--baud", "fast"), 2, "fast"),
    ],
)
def test_mistakes_end_without_a_traceback(plcgen, args, code, words) -> None:
    pytest.importorskip("serial")
    result = plcgen("ppi", "serve", *args)
    assert result.code == code
    assert words in result.err
    assert "Traceback" not in result.err
    assert result.out == ""


def test_signals_are_given_back(plcgen, monkeypatch) -> None:
    """A program that calls the verb in its own process keeps its Ctrl-C."""
    monkeypatch.setattr("plcgen.ppi.sim.serve.serve_line", lambda *_: None)
    before = [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)]
    assert plcgen("ppi", "serve").code == 0
    assert [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)] == before


def test_a_busy_port_is_told(plcgen) -> None:
    with socket.create_server(("127.0.0.1", 0)) as other:
        result = plcgen("ppi", "serve", "--tcp", f"127.0.0.1:{other.getsockname()[1]}")
    assert result.code == 1
    assert "PG721" in result.err
    assert "in use by another program" in result.err


def test_a_serial_port_that_vanishes_ends_it_with_a_reason(tmp_path: Path) -> None:
    """A pseudo terminal is the port; its other side is closed in mid-run."""
    pytest.importorskip("serial")
    from plcgen.base.line.pty import PtyLine

    master = PtyLine()
    with running(tmp_path, "--port", master.name) as (process, name):
        assert name == master.name
        master.close()
        _, err = process.communicate(timeout=SOON)
    assert process.returncode == 1
    assert "PG722" in err
    assert "Traceback" not in err
