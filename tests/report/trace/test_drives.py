"""Several drives: each with its own unit, drive objects of one unit together, faults for one of them."""

from __future__ import annotations

from pathlib import Path

import pytest

from plcgen import api
from plcgen.report.trace.model import Trace
from plcgen.report.trace.run import RunSettings, Simulation
from plcgen.s7.cpu.program import Program

SPEC = """plc: {name: Axes, family: s7-1500, toolchain: tia-v19}
drives:
  x: {device: sinamics-s120, hardware_id: 281, drive_object: 3}
  y: {device: sinamics-s120, hardware_id: 281, drive_object: 4}
  z: {device: sinamics-g120, hardware_id: 290}
jobs:
  read_x: {drive: x, read: [P1120]}
  read_y: {drive: y, read: [P1121]}
  read_z: {drive: z, read: [P1120]}
  set_z: {drive: z, write: {P1120: null, P1121: 8.0}}
"""


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Spec and generated folder of three drives, two of them at one address."""
    folder = tmp_path_factory.mktemp("axes")
    spec = folder / "job.yaml"
    spec.write_text(SPEC, "utf-8")
    assert api.generate(spec, folder / "out").ok
    return spec, folder / "out"


def ends(trace: Trace) -> dict[str, tuple[str, int, int]]:
    return {job.key: (job.ending, job.scan, job.retries) for job in trace.jobs}


def test_objects_of_one_unit_take_turns(project: tuple[Path, Path]) -> None:
    """Those at one address are one unit: one after the other. The third one runs at once."""
    trace = api.simulate(*project)
    assert ends(trace) == {
        "read_x": ("done", 8, 0),
        "read_y": ("done", 15, 0),
        "read_z": ("done", 8, 0),
        "set_z": ("done", 15, 0),
    }
    objects = [c.data[2] for step in trace.steps for c in step.contacts if c.group == "read_y"]
    assert objects == [4, 4]


@pytest.mark.slow
def test_a_fault_of_one_drive(project: tuple[Path, Path]) -> None:
    """``drive=z`` leaves the others alone; without it every unit has the fault once."""
    one = ends(api.simulate(*project, faults=["busy:drive=z"]))
    assert [retries for _, _, retries in one.values()] == [0, 0, 1, 0]
    every = ends(api.simulate(*project, faults=["busy"]))
    assert [retries for _, _, retries in every.values()] == [1, 0, 1, 0]
    at_y = ends(api.simulate(*project, faults=["busy:drive=y,after=1"]))
    assert [retries for _, _, retries in at_y.values()] == [0, 1, 0, 0]


def test_a_run_changes_nothing_for_the_next(project: tuple[Path, Path]) -> None:
    """Faults, drives and memory are made anew: the same run twice is the same trace."""
    assert api.simulate(*project, faults=["busy"]) == api.simulate(*project, faults=["busy"])


def test_values_and_errors_by_parameter(project: tuple[Path, Path]) -> None:
    """A write shows what was written, input or constant; the refused parameter has its error, the other none."""
    trace = api.simulate(
        *project, jobs=["set_z"], sets=["setZ.rampUpTime=5"], faults=["error:number=2,position=2,info=3"]
    )
    (job,) = trace.jobs
    assert [(v.label, v.value, v.error, v.info) for v in job.values] == [
        ("P1120", 5.0, None, 0),
        ("P1121", 8.0, 2, 3),
    ]
    assert ends(trace) == {"set_z": ("error", 8, 0)}


def test_a_value_that_is_called_state(tmp_path: Path) -> None:
    """The state of the block keeps its signal, the value gets another name."""
    spec = tmp_path / "job.yaml"
    spec.write_text(
        SPEC.partition("jobs:")[0] + "jobs:\n  set_z: {drive: z, write: {P1120: {as: state, start: 5.0}}}\n", "utf-8"
    )
    assert api.generate(spec, tmp_path / "out").ok
    trace = api.simulate(spec, tmp_path / "out")
    ids = [signal.id for signal in trace.signals]
    assert len(ids) == len(set(ids))
    assert trace.start[ids.index("set_z.state_value")] == 5.0
    assert trace.start[ids.index("set_z.state")] == 0


def test_a_hardware_identifier_by_name(tmp_path: Path) -> None:
    """A system constant has some number in a project; a recorded run gives it one of its own."""
    spec = tmp_path / "job.yaml"
    spec.write_text(
        "plc: {name: Axes, family: s7-1500, toolchain: tia-v19}\n"
        'drives: {d: {device: sinamics-g120, hardware_id: "Drive_1~PROFIdrive"}}\n'
        "jobs: {read_speed: {drive: d, read: [r21]}}\n",
        "utf-8",
    )
    assert api.generate(spec, tmp_path / "out").ok
    assert ends(api.simulate(spec, tmp_path / "out")) == {"read_speed": ("done", 8, 0)}


def test_runs_of_one_simulation_know_nothing_of_each_other(
    project: tuple[Path, Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    """What one run does to drives and data blocks is gone in the next; the program is compiled once."""
    loads = []
    real = Program.load
    monkeypatch.setattr(Program, "load", lambda *sources, **more: loads.append(1) or real(*sources, **more))
    several = Simulation(*project)
    settings = [RunSettings(jobs=("set_z",)), RunSettings(jobs=("set_z",), faults=("error:number=2",)), RunSettings()]
    runs = [several.run(each) for each in (*settings, *settings)]
    assert len(loads) == 1
    assert runs == [Simulation(*project).run(each) for each in settings] * 2
