"""Recorded runs of PPI masters, against frames and states worked out by hand from docs/ppi-master.md and EN 50170."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from plcgen import api
from plcgen.base.display.view import View
from plcgen.report.registry import output_format
from plcgen.report.trace.model import Trace

Run = Callable[..., Trace]

LINE = """  {name}:
    module: cm1241
    port: {port}
    stations: {{pump: {{address: 2, cpu: "224"}}}}
    jobs:
      level: {{station: pump, read: [VB100]}}
      again: {{station: pump, read: [M0.0], cycle: 500ms}}
      set: {{station: pump, write: {{VB110: 7}}}}
"""
PLC = "plc: {name: Pumps, family: s7-1200, toolchain: tia-v19}\n"
DRIVE = """drives:
  fan: {device: sinamics-g120, hardware_id: 290}
jobs:
  ramp: {drive: fan, read: [P1120]}
"""
REQUEST = bytes.fromhex("68 1B 1B 68 02 00 6C 32 01 0000 0001 000E 0000 04 01 12 0A 10 02 0001 0001 84 000320 8C 16")
"""The published request for VB100 with reference 1 instead of 0, so its sum is 8Ch instead of 8Bh."""
POLL = bytes.fromhex("10 02 00 5C 5E 16")
REPLY = bytes.fromhex("68 16 16 68 00 02 08 32 03 0000 0001 0002 0005 0000 04 01 FF 04 0008 01 58 16")
"""One byte, 01h: the sum from DA on is 158h."""


def made(folder: Path, text: str) -> Run:
    spec = folder / "job.yaml"
    spec.write_text(text, "utf-8")
    written = api.generate(spec, folder / "out")
    assert written.ok, written.diagnostics
    return lambda **more: api.simulate(spec, folder / "out", **more)


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    """One master with three jobs."""
    return made(tmp_path_factory.mktemp("ppi"), PLC + "ppi:\n" + LINE.format(name="line", port=270))


def states(trace: Trace, job: str) -> list[str]:
    """Names of the states of a job in order."""
    position = [found.id for found in trace.signals].index(f"{job}.state")
    names = trace.signals[position].names
    return [names[value] for step in trace.steps for n, value in step.changes if n == position]


def frames(trace: Trace, job: str) -> list[tuple[str, bytes]]:
    return [(c.direction, c.data) for step in trace.steps for c in step.contacts if c.group == job]


def test_a_read_goes_through_the_states_of_its_block(run: Run) -> None:
    """The drawing of docs/ppi-master.md from left to right; request, E5, poll, reply."""
    trace = run(jobs=["level"])
    way = ["CONFIGURE", "CONDITIONS", "BUILD", "RESET", "SEND", "ACK", "POLL", "REPLY", "IDLE"]
    assert [name for name in states(trace, "level") if name not in {"WAITING", "DRAIN"}] == way
    assert frames(trace, "level") == [("write", REQUEST), ("read", b"\xe5"), ("write", POLL), ("read", REPLY)]
    (job,) = trace.jobs
    assert (job.partner, job.ending, job.status, job.telegrams, job.retries) == ("pump", "done", 0, 1, 0)
    assert [(value.label, value.value, value.error) for value in job.values] == [("VB100", 1, None)]
    assert (trace.ok, trace.ended, trace.words) == (True, "jobs", ("module call", "station"))


def test_only_the_named_job_starts(run: Run) -> None:
    """A job with a cycle starts by itself; not if another one was asked for."""
    assert frames(run(jobs=["level"]), "again") == []
    assert [job.ending for job in run().jobs] == ["done", "done", "done"]


def test_a_lost_answer_is_one_repetition(run: Run) -> None:
    """The same frame with the same function code twice (EN 50170), then as before."""
    trace = run(jobs=["level"], faults=["silence"])
    sent = [data for direction, data in frames(trace, "level") if direction == "write"]
    assert sent == [REQUEST, REQUEST, POLL]
    assert [(job.ending, job.telegrams, job.retries) for job in trace.jobs] == [("done", 2, 1)]
    assert states(trace, "level").count("WAIT") == 1


def test_a_refused_address(run: Run) -> None:
    """Return code 05h: status 8401, the address is named with the meaning, and has no value."""
    trace = run(jobs=["level"], faults=["item:code=05"])
    (job,) = trace.jobs
    assert (job.ending, job.status, trace.ok) == ("error", 0x8401, False)
    assert (job.values[0].error, job.values[0].value) == (5, None)
    text = output_format("text").render("trace", trace, View(width=120))
    assert "VB100  vb100 error 05h address out of range" in text
    assert "level: error 8401 the station refused at least one address" in text


def test_a_deaf_station(run: Run) -> None:
    """Nothing comes back: status 8203 after the repetitions, and no answer in the record."""
    trace = run(jobs=["level"], faults=["deaf:times=always"])
    assert [(job.ending, job.status) for job in trace.jobs] == [("error", 0x8203)]
    assert {direction for direction, _ in frames(trace, "level")} == {"write"}


def test_a_constant_and_a_station_file(run: Run, tmp_path: Path) -> None:
    """What is written stands in the result; a file gives the station its values."""
    assert [value.value for value in run(jobs=["set"]).jobs[0].values] == [7]
    path = tmp_path / "station.yaml"
    path.write_text("cpu: 224\naddress: 2\nvalues: {VB100: 34}\n", "utf-8")
    for option in (str(path), f"line={path}"):
        assert run(jobs=["level"], drives=[option]).jobs[0].values[0].value == 34
    assert run(drives=[str(path), str(path)]).diagnostics[0].code == "PG901"


def test_faults_from_a_file(run: Run, tmp_path: Path) -> None:
    path = tmp_path / "faults.yaml"
    path.write_text("- {kind: silence, at: poll}\n", "utf-8")
    assert run(jobs=["level"], fault_file=path).jobs[0].retries == 1
    path.write_text("- {kind: silence, tims: 1}\n", "utf-8")
    assert [(d.code, d.span.line) for d in run(fault_file=path).diagnostics] == [("PG104", 1)]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"jobs": ["levl"]}, 'the spec has no job "levl"'),
        ({"faults": ["silense"]}, 'there is no fault "silense"'),
        ({"sets": ["level.exec=1"]}, "there is no member, tag or address level.exec"),
    ],
)
def test_arguments_that_make_no_sense(run: Run, arguments: dict[str, object], message: str) -> None:
    trace = run(**arguments)
    assert [(d.code, d.message) for d in trace.diagnostics] == [("PG901", message)]


def test_formats(run: Run) -> None:
    """JSON has every frame field by field, VCD a scope for the station."""
    trace = run(jobs=["level"])
    data = json.loads(output_format("json").render("trace", trace, View()))
    found = [exchange for step in data["steps"] for exchange in step["exchanges"]]
    assert [exchange["telegram"]["ok"] for exchange in found] == [True] * 4
    assert found[0]["text"] == "read request, station 0 to 2 (6C): VB100"
    assert found[3]["text"].endswith("VB100 = 01")
    assert {call["block"] for step in data["steps"] for call in step["calls"]} >= {"SEND_P2P", "RECEIVE_P2P"}
    vcd = output_format("vcd").render("trace", trace, View())
    assert "$scope module pump $end" in vcd
    assert REQUEST.hex().upper() in vcd


def test_several_masters(tmp_path: Path) -> None:
    """Jobs of the same name on two lines have the name of their master in front."""
    text = PLC + "ppi:\n" + LINE.format(name="north", port=270) + LINE.format(name="south", port=271)
    run = made(tmp_path, text)
    trace = run(jobs=["south.level"])
    assert [(job.key, job.ending) for job in trace.jobs] == [("south.level", "done")]
    assert [signal.path for signal in trace.signals if signal.name == "execute"] == ['"PpiJobs".southLevel.execute']
    assert not run(jobs=["level"]).ok


def test_drives_and_stations_in_one_project(tmp_path: Path) -> None:
    """Jobs of both protocols run in one CPU; a fault goes to those who know its kind."""
    run = made(tmp_path, PLC + DRIVE + "ppi:\n" + LINE.format(name="line", port=270))
    trace = run()
    assert {job.key: job.ending for job in trace.jobs} == dict.fromkeys(["ramp", "level", "again", "set"], "done")
    assert trace.words == ("call", "partner")
    assert {job.key: job.retries for job in run(faults=["busy"]).jobs} == {"ramp": 1, "level": 0, "again": 0, "set": 0}
    assert run(faults=["deaf"]).ok
    assert [d.code for d in run(faults=["nothing"]).diagnostics] == ["PG901"]
