"""Files against what the spec demands: damage in a source on disk is told with the line of the spec.

Nothing here goes through the planner but the generation of the undamaged files.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from plcgen import api
from plcgen.ds47.proof.stated.checks import stated_checks
from plcgen.project.opening import open_spec
from plcgen.proof.checks import Check
from plcgen.s7.cpu.sources import FolderParts, read_parts
from plcgen.s7.scl.dialect import Dialect

SPEC = """\
plc: {name: Stated, family: s7-1500, toolchain: tia-v19, sources: per_block}
units:
  cu1:
    device: sinamics-s120
    wait: 2min
    drives: {control: {hardware_id: 280, drive_object: 1}, axis: {hardware_id: 281, drive_object: 3}}
recipes:
  tension:
    parameters: [P2900, P1121]
    records: {copper: {P2900: 20.0, P1121: 5.0}, steel: {P2900: 35.0, P1121: 6.0}}
jobs:
  set_ramps: {drive: axis, write: {P1120: 5.0, P1121: null}, timeout: 4s, retries: 5}
  read_speed: {drive: axis, read: [r21, r899]}
  save_axis: {drive: axis, save: {persist: drive_object, limit: 4s, distance: 1min}}
  wait: {drive: axis, sequence: [{until: {r899.1: 1, r21: "<= 100.0", timeout: 3s}}, {read: ["r945[0]"]}]}
  load: {drive: axis, write_recipe: tension}
"""
LINES = {key: number for number, line in enumerate(SPEC.splitlines(), 1) for key in [line.split(":")[0].strip()]}


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, FolderParts]:
    """The spec, and the sources of its folder."""
    folder = tmp_path_factory.mktemp("stated")
    spec = folder / "job.yaml"
    spec.write_text(SPEC, "utf-8")
    assert api.generate(spec, folder / "out").ok
    return spec, read_parts(folder / "out", Dialect.TIA_1200_1500)


def rows(made: tuple[Path, FolderParts], name: str = "", old: str = "", new: str = "") -> list[Check]:
    """The rows of the report, with ``old`` replaced in one source."""
    spec, parts = made
    sources = list(damaged(parts, name, old, new)) if name else parts.sources
    program = FolderParts(tuple(sources), parts.tags, parts.numbers, parts.constants).load(Dialect.TIA_1200_1500)
    assert program.ok, program.diagnostics
    return list(stated_checks(open_spec(spec).sound().loaded, program, {}, "s7-1500"))


def damaged(parts: FolderParts, name: str, old: str, new: str) -> Iterator[tuple[str, str]]:
    """The sources with one change."""
    changes = 0
    for source in parts.sources:
        assert isinstance(source, tuple)
        file, text = source
        if Path(file).stem == name:
            changes += text.count(old)
            text = text.replace(old, new)
        yield file, text
    assert changes, f"{old} is not in {name}"


def test_what_is_right_is_one_row(made: tuple[Path, FolderParts]) -> None:
    """Five jobs on one of the drives."""
    (row,) = rows(made)
    assert (row.id, row.verdict) == ("spec", "5 of 5 jobs stated and kept")


# What the source of a job or its request has, what stands there instead, the job, and what is told; 971 = 03CBh.
DAMAGES = {
    "value": ("typeSetRamps_Request", "Real := 5.0", "Real := 6.0", "set_ramps", "(P1120: 5.0), found 1120 = 6.0"),
    "identifier": ("DriveCalls", "hardwareId := 281", "hardwareId := 280", "set_ramps", "identifier 281"),
    "drive object": ("DriveCalls", "driveObject := B#16#03", "driveObject := B#16#01", "set_ramps", "drive object 3"),
    "record": ("DriveCalls", "recordIndex := 45103", "recordIndex := 47", "set_ramps", "record B02Fh"),
    "wait": ("DriveCalls", "waitLimit := L#120000", "waitLimit := L#60000", "set_ramps", "120000 ms, found 60000"),
    "timeout": ("SetRamps", "L#4000", "L#2000", "set_ramps", "if the answer comes within 4000 ms"),
    "retries": ("SetRamps", "retries := 5", "retries := 1", "set_ramps", "5 retries, found 1"),
    "reset": ("typeSaveAxis_Request1", "16#03CB", "16#03CA", "save_axis", "971 (P971), found a write of 970"),
    "distance": ("SaveAxis", "L#60000;", "L#6000;", "save_axis", "16#8502 before 60000 ms are over"),
    "limit": ("SaveAxis", "SAVE_LIMIT : DInt := L#4000", "SAVE_LIMIT : DInt := L#2000", "save_axis", "4000 ms"),
    "interval": ("SaveAxis", "SAVE_INTERVAL : DInt := L#1000", "SAVE_INTERVAL : DInt := L#500", "save_axis", "1000 ms"),
    "twice": ("SaveAxis", "statOrder.once := TRUE", "statOrder.once := FALSE", "save_axis", "sent once"),
    "comparison": ("Wait", "Step1 <= 100.0", "Step1 < 100.0", "wait", ""),
    "bit": ("Wait", "B#16#02", "B#16#04", "wait", ""),
    "output": ("DriveCalls", "readSpeed.r899", "wait.faultCodeIndex0", "read_speed", ".r899 = "),
    "start value": ("RecipeTension", "35.0", "34.0", "load", "p2900 = 35.0 as delivered, found 34.0"),
}  # fmt: skip


@pytest.mark.parametrize("case", DAMAGES)
def test_damage_is_told_where_the_spec_demands_something_else(made: tuple[Path, FolderParts], case: str) -> None:
    """PG641 with the line of the job or of its drive, what is demanded and what was found."""
    name, old, new, job, told = DAMAGES[case]
    found = {check.id: check.diagnostic for check in rows(made, name, old, new) if check.diagnostic is not None}
    problem = found[f"spec.{job}"]
    assert problem.code == "PG641"
    assert told in problem.message
    assert problem.span.line in {LINES[job], LINES["drives"], LINES["parameters"]}


def test_a_job_with_nothing_in_the_control_db_is_started_by_flags(tmp_path: Path) -> None:
    """An empty STRUCT cannot be imported: without values and with a flag for every signal, there is none."""
    flags = "{execute: M100.0, busy: M100.1, done: M100.2, error: M100.3, status: MW150}"
    drive = "drives: {axis: {device: sinamics-g120, hardware_id: 281}}"
    job = f"jobs: {{put: {{drive: axis, write: {{P1120: 7.0}}, trigger: {flags}}}}}"
    spec, out = tmp_path / "spec.yaml", tmp_path / "out"
    spec.write_text(
        f"plc: {{name: Flags, family: s7-1500, toolchain: tia-v19, sources: per_block}}\n{drive}\n{job}\n", "utf-8"
    )
    assert api.generate(spec, out).ok
    assert "Struct;" not in (out / "db" / "DriveJobs.db").read_text("utf-8-sig")
    assert [str(each) for each in api.verify(spec, out, faults="none").problems] == []
