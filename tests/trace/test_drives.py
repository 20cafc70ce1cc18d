"""Several drives: each with its own unit, drive objects of one unit together, faults for one of them."""

from __future__ import annotations

from pathlib import Path

import pytest

from plcgen import api
from plcgen.trace.model import Trace

SPEC = """plc: {name: Axes, family: s7-1500, toolchain: tia-v19}
drives:
  x: {device: sinamics-s120, hardware_id: 281, drive_object: 3}
  y: {device: sinamics-s120, hardware_id: 281, drive_object: 4}
  z: {device: sinamics-g120, hardware_id: 290}
jobs:
  read_x: {drive: x, read: [P1120]}
  read_y: {drive: y, read: [P1121]}
  read_z: {drive: z, read: [P1120]}
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
    """Those at one address share a token: one after the other. The third one runs at once."""
    trace = api.simulate(*project)
    assert ends(trace) == {"read_x": ("done", 11, 0), "read_y": ("done", 21, 0), "read_z": ("done", 11, 0)}
    objects = [c.data[2] for step in trace.steps for c in step.contacts if c.group == "read_y"]
    assert objects == [4, 4]


def test_a_fault_of_one_drive(project: tuple[Path, Path]) -> None:
    """``drive=z`` leaves the others alone; without it every unit has the fault once."""
    one = ends(api.simulate(*project, faults=["busy:drive=z"]))
    assert [retries for _, _, retries in one.values()] == [0, 0, 1]
    every = ends(api.simulate(*project, faults=["busy"]))
    assert [retries for _, _, retries in every.values()] == [1, 0, 1]
    at_y = ends(api.simulate(*project, faults=["busy:drive=y,after=1"]))
    assert [retries for _, _, retries in at_y.values()] == [0, 1, 0]


def test_a_run_changes_nothing_for_the_next(project: tuple[Path, Path]) -> None:
    """Faults, drives and memory are made anew: the same run twice is the same trace."""
    assert api.simulate(*project, faults=["busy"]) == api.simulate(*project, faults=["busy"])
