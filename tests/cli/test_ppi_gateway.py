"""``plcgen ppi gateway`` as people and programs meet it."""

import contextlib
import errno
import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from plcgen.base.line import tcp
from plcgen.base.line.tcp import TcpServer
from plcgen.ppi.client import Settings
from plcgen.ppi.client.iso import open_iso
from plcgen.ppi.sim import Bus, Station
from plcgen.ppi.sim.serve import Serving

ROOT = Path(__file__).parents[2]
SOON = 20.0


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="signals")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_it_serves_until_a_signal(tmp_path, number):
    """The first line is the address, then a JSON object for each write; only what --allow-write names is written."""
    plc = Station(values={"VW100": 1234})
    with Serving(Bus([plc]), TcpServer("127.0.0.1:0")) as port:
        command = [sys.executable, "-m", "plcgen", "ppi", "gateway", "--port", port, "--tcp", "0", "--json"]
        with subprocess.Popen(
            [*command, "--allow-write", "VB102"],
            cwd=tmp_path,
            env={**os.environ, "PYTHONPATH": str(ROOT)},
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        ) as running:
            try:
                opened = json.loads(running.stdout.readline())
                assert opened["event"] == "open"
                client = open_iso(opened["line"], Settings(answer=SOON))
                with contextlib.closing(client):
                    assert [each.value for each in client.read("VW100")] == [1234]
                    client.write({"VB102": 9})
                wrote = json.loads(running.stdout.readline())
                running.send_signal(number)
                out, err = running.communicate(timeout=SOON)
            finally:
                running.kill()
    assert opened["line"].startswith("s7://127.0.0.1:")
    assert (wrote["event"], wrote["write"], wrote["result"]) == ("write", "VB102 = 09", "ok")
    assert (running.returncode, out) == (0, ""), err
    assert "writes are passed on to VB102" in err
    assert "other machines" not in err
    assert plc["VB102"] == 9


def test_a_missing_right_to_the_port_is_said_with_the_ways_to_get_it(plcgen, monkeypatch):
    """The system refuses port 102: PG720, the three ways on Linux and another port; exit code 1."""

    def refuse(*_args, **_more):
        raise PermissionError(errno.EACCES, "Permission denied")

    with Serving(Bus([Station()]), TcpServer("127.0.0.1:0")) as port:
        monkeypatch.setattr(tcp.socket, "create_server", refuse)
        done = plcgen("ppi", "gateway", "--port", port)
    assert (done.code, done.out) == (1, "")
    for word in ("PG720", "127.0.0.1:102", "cap_net_bind_service", "ip_unprivileged_port_start=102", "--tcp 10102"):
        assert word in " ".join(done.err.split())
