"""plcgen ppi log: rows, states, deadbands, rotation; a day with everything that goes wrong has no unmarked gap."""

import errno
import itertools
import json
import os
import signal
import sqlite3
import subprocess
import sys
import time
from datetime import datetime, timedelta, timezone
from pathlib import Path

import pytest

from plcgen.base.diagnostics import DiagnosticError
from plcgen.base.line.tcp import TcpServer
from plcgen.ppi.client.values import parse_place
from plcgen.ppi.log import files
from plcgen.ppi.log.files import Channel, Rotation, iso
from plcgen.ppi.log.logger import PAUSE, Pace
from plcgen.ppi.sim import Bus, Station
from plcgen.ppi.sim.serve import Serving
from tests.ppi.log.support import MIDNIGHT, Day, iso_at, rows_of

ROOT = Path(__file__).parents[3]


def run(logger, count):
    """Log for a number of cycles."""
    return logger.run(lambda: False, count)


def test_one_row_per_cycle(tmp_path):
    """Start, a row per cycle with ISO time, zone and values of two stations, stop."""
    day = Day(Station(values={"VW100": 7, "VD200": 1.5}), Station(address=3, values={"M0.0": True}))
    path = tmp_path / "a.csv"
    logger, _ = day.logger(path, "VW100", "VD200:REAL", "3:M0.0")
    assert run(logger, 3)
    lines = path.read_text("utf-8").splitlines()
    assert lines[0] == "time,state,since,note,VW100,VD200:REAL,3:M0.0"
    assert lines[1] == "2026-11-26T00:00:00.000+00:00,start,,,,,"
    assert lines[2] == "2026-11-26T00:00:00.000+00:00,good,,,7,1.5,1"
    assert [line.split(",")[1] for line in lines[1:]] == ["start", "good", "good", "good", "stop"]
    assert lines[3].startswith("2026-11-26T00:00:01.000")


def test_time_has_its_zone():
    """13:00 UTC is 14:00 in a zone one hour to the east; the offset is in the text."""
    assert iso(MIDNIGHT + 13 * 3600, timezone(timedelta(hours=1))) == "2026-11-26T14:00:00.000+01:00"


def test_a_silent_station_is_bad_since(tmp_path):
    """Station 3 is switched off: its column is empty, the row is bad since the first failure and says why."""
    day = Day(Station(values={"VW100": 7}))
    path = tmp_path / "a.csv"
    logger, _ = day.logger(path, "VW100", "3:VW100")
    assert not run(logger, 3)
    bad = [row for row in rows_of(path) if row["state"] == "bad"]
    assert [row["VW100"] for row in bad] == ["7", "7", "7"]
    assert {row["3:VW100"] for row in bad} == {""}
    assert {row["since"] for row in bad} == {bad[0]["time"]}
    assert "station 3 does not answer" in bad[0]["note"]


def test_a_refused_item_is_bad_alone(tmp_path):
    """VB9000 does not exist on a CPU 224 (V ends at VB8191): the others keep their values."""
    path = tmp_path / "a.csv"
    logger, _ = Day().logger(path, "VW100", "VB9000")
    assert not run(logger, 1)
    row = rows_of(path)[1]
    assert (row["state"], row["VW100"], row["VB9000"]) == ("bad", "7", "")
    assert row["note"] == "VB9000: 05h address out of range"


def test_the_line_is_opened_again_forever(tmp_path):
    """Unplugged from 10 s to 60 s: bad since 10 s, and good again within a pause after 60 s."""
    day = Day(down=[(10, 60)])
    path = tmp_path / "a.csv"
    logger, _ = day.logger(path)
    assert run(logger, 100)
    rows = rows_of(path)
    bad = [row for row in rows if row["state"] == "bad"]
    assert bad[0]["time"] == bad[-1]["since"] == iso_at(10)
    last = datetime.fromisoformat(bad[-1]["time"]).timestamp() - MIDNIGHT
    assert 59 <= last <= 60 + PAUSE
    assert rows[-2]["state"] == "good"
    assert any(text.startswith("good again") for text in day.told)


def test_a_dead_station_does_not_slow_the_others_down(tmp_path):
    """After three failures it is asked every ten seconds only, so most cycles of a second are kept."""
    path = tmp_path / "a.csv"
    logger, _ = Day().logger(path, "VW100", "3:VW100")
    run(logger, 100)
    late = [row for row in rows_of(path) if "missed" in row["note"]]
    assert 0 < len(late) <= 15


def test_changes_only(tmp_path):
    """With changes: the first cycle, then a row when the value moves by more than the deadband, and the heartbeat."""
    plc = Station(values={"VW100": 100})
    day = Day(plc)
    path = tmp_path / "a.csv"
    logger, keeper = day.logger(path, pace=Pace(1.0, changes=True, heartbeat=60), deadband=5)
    for second in range(150):
        plc["VW100"] = {20: 103, 30: 106, 31: 101}.get(second, plc["VW100"])
        logger.cycle()
        day.sleep(1)
    keeper.close()
    found = [(row["time"][11:19], row["VW100"]) for row in rows_of(path)]
    # 100 -> 103 is within 5; 106 is 6 from 100; 101 is 5 from 106: not more than 5; heartbeats 60 s after a row
    assert found == [("00:00:00", "100"), ("00:00:30", "106"), ("00:01:30", "101")]


@pytest.mark.parametrize(
    ("old", "new", "band", "differs"),
    [
        (1, 1, 0, False), (1, 2, 0, True), (1.0, 1.4, 0.5, False), (1.0, 1.6, 0.5, True), (None, 1, 9, True),
        (1, None, 9, True), (True, False, 9, True), ("a", "b", 9, True), ((1, 2), (1, 5), 4, False),
        ((1, 2), (1, 7), 4, True), (float("nan"), float("nan"), 0, False), (float("nan"), 1.0, 9, True),
        (1.0, float("inf"), 9, True),
    ],
)  # fmt: skip
def test_deadband(old, new, band, differs):
    """More than the deadband counts, the deadband itself does not; bits, texts and missing values have none."""
    assert Channel(2, parse_place("VB0"), "x", band).differs(old, new) is differs


def test_json_lines(tmp_path):
    """One object per line; what is no number in JSON is a text."""
    day = Day(Station(values={"VD0": 0x7FC00000, "VB8": 3}))
    path = tmp_path / "a.jsonl"
    logger, _ = day.logger(path, "VD0:REAL", "VB8[2]")
    run(logger, 1)
    start, row, _ = map(json.loads, path.read_text("utf-8").splitlines())
    assert row == {
        "time": iso_at(0), "state": "good", "since": None, "note": "", "values": {"VD0:REAL": "nan", "VB8[2]": [3, 0]},
    }  # fmt: skip
    assert start["values"] == {"VD0:REAL": None, "VB8[2]": None}


def test_sqlite(tmp_path):
    """A table with a column per value, which SQLite's own tools read."""
    path = tmp_path / "a.sqlite"
    logger, _ = Day().logger(path, "VW100", "M0.0")
    run(logger, 2)
    with sqlite3.connect(path) as base:
        rows = base.execute('SELECT time, state, "VW100", "M0.0" FROM log').fetchall()
    base.close()
    assert rows[1:3] == [(iso_at(0), "good", 7, 0), (iso_at(1), "good", 7, 0)]
    assert [row[1] for row in rows] == ["start", "good", "good", "stop"]


@pytest.mark.parametrize("suffix", ["csv", "jsonl", "sqlite"])
def test_going_on_with_a_log(tmp_path, suffix):
    """A second run appends; the rows of the first stay, stop and start stand between."""
    path = tmp_path / f"a.{suffix}"
    for _ in range(2):
        logger, _ = Day().logger(path)
        run(logger, 1)
    assert states(path) == ["start", "good", "stop"] * 2


def states(path):
    """States of all rows of a log of any kind."""
    if path.suffix == ".sqlite":
        base = sqlite3.connect(path)
        found = [row[0] for row in base.execute("SELECT state FROM log")]
        base.close()
        return found
    if path.suffix == ".jsonl":
        return [json.loads(line)["state"] for line in path.read_text("utf-8").splitlines()]
    return [row["state"] for row in rows_of(path)]


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.csv", "time,state,since,note,VW102\n"), ("a.csv", "my own notes\n"), ("a.jsonl", "{}\n"),
        ("a.jsonl", '{"time": 1, "values": {"VW100": 1}}\n'), ("a.jsonl", "notes"), ("a.jsonl", "[" * 5000 + "\n"),
        ("a.sqlite", "my own notes, no database " * 9), ("a.txt", ""),
    ],
)  # fmt: skip
def test_a_file_of_somebody_else_is_not_touched(tmp_path, name, text):
    """Other columns, other contents, another suffix: PG725, and the file is as it was."""
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    with pytest.raises(DiagnosticError) as caught:
        Day().logger(path)
    assert [each.code for each in caught.value.diagnostics] == ["PG725"]
    assert path.read_text("utf-8") == text


def test_a_database_of_somebody_else_is_not_touched(tmp_path):
    """A database with other tables is no place for a log."""
    path = tmp_path / "a.sqlite"
    base = sqlite3.connect(path)
    base.execute("CREATE TABLE mine (a)")
    base.close()
    with pytest.raises(DiagnosticError):
        Day().logger(path)


@pytest.mark.parametrize("suffix", ["csv", "jsonl"])
def test_a_torn_row_is_cut_off(tmp_path, suffix):
    """A process was killed while it wrote: the half row goes, the start row says so, the rest stays."""
    path = tmp_path / f"a.{suffix}"
    logger, _ = Day().logger(path)
    run(logger, 2)
    whole = path.read_bytes()
    path.write_bytes(whole[:-9])
    logger, _ = Day().logger(path)
    run(logger, 1)
    assert path.read_bytes().startswith(whole[: whole[:-1].rindex(b"\n") + 1])
    assert states(path) == ["start", "good", "good", "start", "good", "stop"]
    assert files.TORN in path.read_text("utf-8").splitlines()[3 + (suffix == "csv")]


def test_rotation_by_hour(tmp_path):
    """A new file each hour, named after its first row; every row is in the file of its hour, each with a header."""
    path = tmp_path / "a.csv"
    logger, _ = Day().logger(path, pace=Pace(600), rotation=Rotation("hour"))
    run(logger, 13)
    first, second = tmp_path / "a.20261126T000000.csv", tmp_path / "a.20261126T010000.csv"
    assert [len(rows_of(each)) for each in (first, second, path)] == [7, 6, 2]  # start and 6; 6; one at 02:00 and stop
    assert sorted(tmp_path.iterdir()) == [first, second, path]


def test_rotation_by_size_keeps_some(tmp_path):
    """From 400 bytes on a new file begins; the two newest old ones stay, a file of another name is not touched."""
    other = tmp_path / "a.20261126T000000-old.csv"
    other.write_text("mine", encoding="utf-8")
    path = tmp_path / "a.csv"
    logger, _ = Day().logger(path, rotation=Rotation(size=400, keep=2))
    run(logger, 60)
    old = sorted(each.name for each in tmp_path.iterdir() if each not in {path, other})
    assert len(old) == 2
    assert other.read_text("utf-8") == "mine"
    kept = [row["time"] for name in [*old, "a.csv"] for row in rows_of(tmp_path / name)]
    assert kept == sorted(kept)
    assert all((tmp_path / name).stat().st_size < 400 + 60 for name in old)


def test_a_clock_that_is_set_back_is_marked(tmp_path):
    """An hour back: the row says so."""
    day = Day()
    path = tmp_path / "a.csv"
    logger, keeper = day.logger(path)
    for jump in (0, -3600):
        day.jump = jump
        logger.cycle()
        day.sleep(1)
    keeper.close()
    assert rows_of(path)[1]["note"] == "the clock was set back by 3599.0 s"


def test_more_rows_than_the_memory_holds_leave_a_mark(tmp_path, monkeypatch):
    """The disk is full for 20 rows, 5 fit into memory: the oldest give way, one row says how many."""
    day = Day()
    path = tmp_path / "a.csv"
    logger, keeper = day.logger(path, most=5)
    with monkeypatch.context() as patch:
        patch.setattr(files.os, "write", full)
        for _ in range(20):
            logger.cycle()
            day.sleep(1)
        assert len(keeper.waiting) == 6
    keeper.close()
    rows = rows_of(path)
    assert (rows[0]["state"], rows[0]["time"]) == ("lost", iso_at(0))
    assert rows[0]["note"] == f"no room on the disk: 15 rows lost up to {iso_at(14)}"
    assert [row["time"] for row in rows[1:]] == [iso_at(second) for second in range(15, 20)]


REAL_WRITE = os.write


def full(descriptor, data):
    """A disk with room for three bytes, then for none."""
    REAL_WRITE(descriptor, bytes(data)[:3])
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def test_a_full_database_loses_nothing(tmp_path):
    """SQLite finds the disk full (its own limit of pages): rows wait, and are there when there is room again."""
    day = Day(Station(values={f"VB{n}": 65 for n in range(100)}))
    path = tmp_path / "a.sqlite"
    logger, keeper = day.logger(path, "VB0[100]:CHAR")
    base = keeper._file._base
    base.execute("PRAGMA max_page_count = 4")
    for _ in range(100):
        logger.cycle()
        day.sleep(1)
    assert len(keeper.waiting) > 20
    assert any("full" in text for text in day.told)
    base.execute("PRAGMA max_page_count = 1000000")
    assert keeper.close()
    assert len(states(path)) == 100


HOLES = {"line": [(3_600, 3_900), (40_000, 47_000)], "disk": [(20_000, 26_000), (46_000, 50_000)], "killed": 60_000}
"""Seconds of the day: the line is unplugged (the second time while the disk is full), no room, the process is gone."""


@pytest.mark.slow
@pytest.mark.parametrize("changes", [False, True])
def test_a_day_has_no_gap_without_a_mark(tmp_path, monkeypatch, changes):
    """A day of 10 s cycles with lost lines, a full disk, lost answers and a killed process that leaves half a row.

    Between two rows at most one cycle passes (a heartbeat with changes only), or the later one says what is missing.
    """
    faults = [f"{kind}:after={n}" for n in range(0, 16_000, 300) for kind in ("silence", "fcs", "cut")]
    faults += [f"silence:after={n},times=40" for n in (2_000, 9_000)]
    plc = Station(values={"VW100": 7})
    day = Day(plc, faults=faults, down=HOLES["line"])
    path = tmp_path / "a.csv"
    monkeypatch.setattr(files.os, "fsync", lambda _: None)

    def write(descriptor, data):
        return full(descriptor, data) if no_room(day) else REAL_WRITE(descriptor, data)

    monkeypatch.setattr(files.os, "write", write)
    pace = Pace(10.0, changes=changes, heartbeat=60.0)
    logger, keeper = day.logger(path, pace=pace)
    logger.run(lambda: day.now() >= HOLES["killed"])
    keeper.close()
    path.write_bytes(path.read_bytes()[:-5])  # killed: the last row is torn, nobody wrote "stop"
    day.virtual.advance(2_000_000)
    logger, keeper = day.logger(path, pace=pace)
    assert logger.run(lambda: day.now() >= 86_400)
    rows = rows_of(path)
    most = 60.0 + 10 if changes else 10.0
    for before, after in itertools.pairwise(rows):
        passed = datetime.fromisoformat(after["time"]).timestamp() - datetime.fromisoformat(before["time"]).timestamp()
        assert passed >= 0
        assert passed <= most * 1.5 or after["state"] in {"start", "lost"} or "missed" in after["note"], (before, after)
    for begin, end in HOLES["line"]:
        inside = [row for row in rows if iso_at(begin + 10) <= row["time"] < iso_at(end)]
        assert inside
        assert {row["state"] for row in inside} == {"bad"}
    assert not any(row["state"] == "lost" for row in rows)
    starts = [row for row in rows if row["state"] == "start"]
    assert (len(starts), starts[1]["note"]) == (2, files.TORN)
    if not changes:
        good = sum(row["state"] == "good" for row in rows)
        assert good == len(rows) - 3 - sum(row["state"] == "bad" for row in rows)
        assert good > (86_400 - 2_000 - 7_300) / 10 * 0.97


def no_room(day):
    """Whether the disk is full."""
    return any(begin <= day.now() < end for begin, end in HOLES["disk"])


# ---- As a process ---------------------------------------------------------------------------------------------


def process(tmp_path, port, *more, **how):
    """``plcgen ppi log VW100 --out a.csv`` as a process."""
    command = [sys.executable, "-m", "plcgen", "ppi", "log", "VW100", "--out", "a.csv", "--port", port, *more]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    return subprocess.Popen(
        command, cwd=tmp_path, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **how
    )


def wait_for(path, lines):
    """Wait until a file has some lines."""
    for _ in range(1000):
        if path.exists() and path.read_bytes().count(b"\n") >= lines:
            return
        time.sleep(0.02)
    raise AssertionError(f"{path} has no {lines} lines")


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="signals")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_signals(tmp_path, number):
    """SIGINT and SIGTERM end the log with its row and exit code 0; after SIGKILL the next run marks the gap."""
    path = tmp_path / "a.csv"
    with Serving(Bus([Station(values={"VW100": 7})]), TcpServer("127.0.0.1:0")) as port:
        running = process(tmp_path, port, "--interval", "0.02")
        wait_for(path, 5)
        running.send_signal(number)
        out, err = running.communicate(timeout=20)
        if number != signal.SIGKILL:
            assert (running.returncode, out) == (0, ""), err
            assert rows_of(path)[-1]["state"] == "stop"
            return
        running = process(tmp_path, port, "--interval", "0.02", "--count", "2")
        running.communicate(timeout=20)
    assert running.returncode == 0
    assert [row["state"] for row in rows_of(path)][-4:] == ["start", "good", "good", "stop"]
    assert "stop" not in [row["state"] for row in rows_of(path)][:-1]


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="limits of files")
def test_a_file_that_must_not_grow(tmp_path):
    """The system refuses the file more than 300 bytes: what found no place is on stdout as JSON lines, exit code 1."""
    import resource

    def limit():
        resource.setrlimit(resource.RLIMIT_FSIZE, (300, 300))

    with Serving(Bus([Station(values={"VW100": 7})]), TcpServer("127.0.0.1:0")) as port:
        running = process(tmp_path, port, "--interval", "0.02", "--count", "10", preexec_fn=limit)
        out, err = running.communicate(timeout=30)
    assert running.returncode == 1
    assert "rows are kept in memory" in err
    rest = [json.loads(line) for line in out.splitlines()]
    rows = rows_of(tmp_path / "a.csv")
    assert (tmp_path / "a.csv").read_bytes().endswith(b"\n")
    assert [row["state"] for row in rows] + [row["state"] for row in rest] == ["start", *["good"] * 10, "stop"]
