"""plcgen ppi backup, compare and restore: files, exit codes, what is shown."""

import json

import pytest

from plcgen.base.line.tcp import TcpServer
from plcgen.ppi.sim import Bus, Station
from plcgen.ppi.sim.serve import Serving
from plcgen.ppi.sim.station import Mode


@pytest.fixture
def plc():
    """A station that is served over TCP, and the options that reach it."""
    station = Station("222", values={"VB100": 0x22})
    with Serving(Bus([station]), TcpServer("127.0.0.1:0")) as port:
        yield station, ("--port", port)


def test_the_verbs(plcgen, plc):
    """Backup to a file, a difference, restore: exit codes and what is shown."""
    station, port = plc
    assert plcgen("ppi", "backup", "VB0[300]", "-o", "a.backup", *port).err == "wrote a.backup\n"
    station["VB100"] = 1
    result = plcgen("ppi", "compare", "a.backup", *port)
    assert result.code == 1
    assert "  VB100    22      01\n" in result.out
    assert "error[PG727]: 1 byte not as in the backup, the first at VB100\n" in result.err
    dry = plcgen("ppi", "restore", "a.backup", *port)
    assert (dry.code, station["VB100"]) == (2, 1)
    assert "would be written to station 2: VB0[300] of CPU 222, station 2, 20" in dry.err
    assert plcgen("ppi", "restore", "a.backup", "--yes-write", *port).code == 0
    assert station["VB100"] == 0x22
    data = json.loads(plcgen("ppi", "compare", "a.backup", "--json", *port).out)
    assert (data["ok"], data["memory"], data["differences"], data["cpu"]) == (True, ["VB0[300]"], [], "CPU 222")


def test_a_backup_is_never_replaced(plcgen, plc, tmp_path):
    """Not even one that plcgen wrote: PG501, before anything is read; a changed one is not restored (PG726)."""
    station, port = plc
    plcgen("ppi", "backup", "VB0[4]", "-o", "a.backup", *port)
    before = (tmp_path / "a.backup").read_bytes()
    executed = station.executed
    again = plcgen("ppi", "backup", "VB0[8]", "-o", "a.backup", *port)
    assert (again.code, station.executed) == (1, executed)
    assert "error[PG501]" in again.err
    (tmp_path / "a.backup").write_bytes(before.replace(b"00 00", b"00 01"))
    damaged = plcgen("ppi", "restore", "a.backup", "--yes-write", *port)
    assert damaged.code == 1
    assert "error[PG726]" in damaged.err
    assert station.executed == executed
    (tmp_path / "a.backup").write_bytes(before.replace(b"00 00", b"00 01").rsplit(b"\n", 2)[0] + b"\n")
    assert plcgen("ppi", "restore", "a.backup", "--yes-write", *port).code == 0
    assert station["VB1"] == 1


def test_a_station_that_refuses(plcgen, plc):
    """VB0[4096] of a CPU 222, which has 2048: return code 05, exit code 1, no file; a timer is no byte."""
    _, port = plc
    result = plcgen("ppi", "backup", "VB0[4096]", "-o", "a.backup", *port)
    assert result.code == 1
    assert "error[PG719]: VB1998[222]: 05h, address out of range" in result.err
    assert "PG716" in plcgen("ppi", "backup", "T32", *port).err


def test_the_mode_does_not_matter(plcgen, plc):
    """A CPU in STOP can be backed up."""
    station, port = plc
    station.cpu.mode = Mode.STOP
    assert plcgen("ppi", "backup", "VB0[4]", *port).out.startswith("# Memory of an S7-200")
