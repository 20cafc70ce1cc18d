"""A spec, generated and compiled with the proof's own callers around it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest

from plcgen import api
from plcgen.ds47.plan.nouns import DriveJob, DrivePlan
from plcgen.ds47.proof.plant import Plant
from plcgen.project.nouns import Project
from plcgen.project.opening import open_spec
from plcgen.proof.rig import ProgramBench
from plcgen.s7.cpu.program import Program

TARGETS = {
    "v5": ("s7-300", "step7-v5", "address"),
    "t3": ("s7-300", "tia-v16", "address"),
    "t15": ("s7-1500", "tia-v19", "hardware_id"),
}


@dataclass(frozen=True)
class Generated:
    """A spec with its files; ``program`` compiles them."""

    project: Project
    folder: Path

    @property
    def plan(self) -> DrivePlan:
        """The plan of the drives."""
        plan = self.project.plan(DrivePlan)
        assert plan is not None
        return plan

    @property
    def program(self) -> Program:
        """The program."""
        return ProgramBench(self.project, self.folder).program

    def job(self, key: str) -> DriveJob:
        """An instance by its key."""
        return next(job for job in self.plan.jobs if job.key == key)


Generate = Callable[..., Generated]


@pytest.fixture(params=[next(iter(TARGETS)), *(pytest.param(t, marks=pytest.mark.slow) for t in [*TARGETS][1:])])
def target(request: pytest.FixtureRequest) -> str:
    """Each kind of CPU."""
    return str(request.param)


@pytest.fixture
def generate(tmp_path: Path) -> Generate:
    """Generate the sections of a spec for a target; ID stands for the key of an address."""

    def run(sections: str, where: str, sources: str = "one") -> Generated:
        family, toolchain, key = TARGETS[where]
        spec = tmp_path / "job.yaml"
        head = f"plc: {{name: Plant, family: {family}, toolchain: {toolchain}, sources: {sources}}}\n"
        spec.write_text(head + sections.replace("ID:", f"{key}:"), encoding="utf-8")
        result = api.generate(spec, tmp_path / "out")
        assert result.ok, result.diagnostics
        return Generated(open_spec(spec).sound(), tmp_path / "out")

    return run


@pytest.fixture
def plant(generate: Generate, target: str, request: pytest.FixtureRequest) -> Plant:
    """The units of the spec that a file of tests has, and OB1 with its jobs."""
    made = generate(request.module.SPEC, target)
    return Plant(made.plan, made.program).fresh()
