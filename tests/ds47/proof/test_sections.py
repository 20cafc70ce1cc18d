"""Plants that are too large to run as a whole: the jobs of one caller at a time."""

from __future__ import annotations

from pathlib import Path

import pytest

from plcgen import api
from plcgen.ds47.plan import callers
from plcgen.ds47.plan.callers import Footprint
from plcgen.ds47.plan.nouns import DrivePlan
from plcgen.ds47.proof import sections, together
from plcgen.ds47.proof.suite import DriveSuite
from plcgen.project.opening import open_spec
from plcgen.proof.coverage import cover
from plcgen.proof.execution import run_procedure
from plcgen.proof.results import Result, added
from plcgen.proof.rig import ProgramBench
from plcgen.s7.cpu.program import Program
from tests.bench.specs import grid
from tests.projects import per_block


def planned(text: str, folder: Path) -> DrivePlan:
    (folder / "plant.yaml").write_text(text)
    project = open_spec(folder / "plant.yaml").sound()
    plan = project.plan(DrivePlan)
    assert plan is not None
    return plan


def test_every_job_is_in_one_section_with_all_that_it_needs(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """600 jobs, one too many: each behind the gate and the channel of its unit, as in OB1."""
    plan = planned(grid(12, 50), tmp_path)
    assert [section.plan for section in sections.plant_sections(plan)] == [plan]
    monkeypatch.setattr(sections, "LARGE", 599)
    found = sections.plant_sections(plan)
    assert [job.key for section in found for job in section.plan.jobs] == [job.key for job in plan.jobs]
    channels = {unit.key: caller.instance.name for caller in plan.callers for unit in plan.channels(caller)}
    for caller, section in zip(plan.callers, found, strict=True):
        assert section.blocks[0] == "DriveCalls_DB"
        assert section.blocks[-1] == caller.instance.name
        assert {channels[job.drive.unit.key] for job in section.plan.jobs} <= set(section.blocks)
        assert {unit.key for unit in section.plan.units} == {job.drive.unit.key for job in section.plan.jobs}
    assert [section.outer for section in found] == [True, *[False] * (len(found) - 2), True]


@pytest.mark.slow
def test_each_caller_is_run(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Good files pass and their callers are covered; a result from a wrong output is noticed."""
    monkeypatch.setattr(callers, "ROOM", Footprint(1500, 1500))
    monkeypatch.setattr(sections, "LARGE", 4)
    for name in ("MANY", "LARGE"):
        monkeypatch.setattr(together, name, 4)
    plan = planned(per_block(grid(2, 3)), tmp_path)
    names = [caller.block.name for caller in plan.callers]
    assert len(names) > 2
    api.generate(tmp_path / "plant.yaml", tmp_path / "out")

    def run() -> tuple[Program, list[Result]]:
        suite = DriveSuite(plan)
        program = ProgramBench(open_spec(tmp_path / "plant.yaml").sound(), tmp_path / "out").program
        own = (each for each in suite.procedures(program) if each.name.startswith("DriveCalls"))
        return program, [run_procedure(program, each) for each in own]

    program, good = run()
    assert [failure for result in good for failure in result.failures] == []
    assert [name for name in names if cover(program, name, added(program, good)).missing] == []
    assert "jobs of several callers at a time" in next(iter(DriveSuite(plan).left_out())).verdict
    source = tmp_path / "out" / "scl" / "DriveCalls2.scl"
    text, right = source.read_text("utf-8"), 'done => "DriveJobs2".job0Fan02.done'
    assert right in text
    source.write_text(text.replace(right, right.replace(".done", ".error"), 1), "utf-8")
    _, bad = run()
    wrong = {str(failure).split(":")[0] for result in bad for failure in result.failures}
    assert wrong == {"DriveCalls2"}
