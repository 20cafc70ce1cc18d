"""Which block calls which job: no caller is larger than a CPU takes, and none of its jobs ever moves."""

from __future__ import annotations

from pathlib import Path

import pytest

from plcgen import api
from plcgen.ds47.plan import callers
from plcgen.ds47.plan.callers import CHANNEL, GATE, Footprint, footprint
from plcgen.ds47.plan.nouns import DrivePlan
from plcgen.project.nouns import Project
from plcgen.project.opening import open_spec
from plcgen.proof.checks import Outcome
from plcgen.s7.layout.layout import layout_block
from plcgen.s7.memory.estimate import estimate
from plcgen.s7.read.blocks import read_sources
from tests.bench.specs import PLCS, grid
from tests.projects import per_block

LARGEST = 64 * 1024
"""Bytes of a code block of an S7-300/400, and of a DB with standard access (specs/cpus/s7.yaml)."""
KINDS = """
    parameters:
      P4001: {type: Boolean, array: 40}
      P4002: {type: Unsigned8, array: 40}
      P4003: {type: "OctetString[21]"}
      P4004: {type: "VisibleString[21]"}
      P4005: {type: Boolean}
      P4007: {type: Integer32, array: 500}
      P4009: {type: Boolean, array: 2}
      P4010: {type: Boolean, array: 2}
jobs:
  bits: {drive: a, read: ["P4001[0..39]", P4005]}
  set_bits: {drive: a, write: {"P4001[0..39]": null, P4005: null}}
  octets: {drive: a, read: ["P4002[0..38]", P4003, P4004]}
  set_octets: {drive: a, write: {"P4002[0..38]": null, P4003: null}}
  long: {drive: a, read: ["P4007[0..499]"]}
  set_long: {drive: a, write: {"P4007[0..499]": null}}
  single: {drive: a, read: [P4005, "P4002[3]", P1120]}
  small: {drive: a, read: ["P4009[0..1]", "P4010[0..1]"]}
  set_small: {drive: a, write: {"P4009[0..1]": null, "P4010[0..1]": null}}
  back: {drive: a, write: {P1120: null, "P4002[0..38]": null}, verify: readback}
  keep: {drive: a, save: drive_object}
  faults: {drive: a, faults: {history: 7}}
  same: {drive: a, compare: {P1120: 10.0, P1121: null, "P4007[0..99]": null}}
  steps: {drive: a, sequence: [{write: {P1120: 5.0}}, {read: [P1121]}, {until: {P1120: 5.0, timeout: 2s}}]}
  clear: {drive: a, acknowledge: true}
"""
"""Jobs of every kind, with values of every shape."""


def planned(text: str, folder: Path) -> tuple[Project, DrivePlan]:
    (folder / "plant.yaml").write_text(text)
    opened = open_spec(folder / "plant.yaml")
    assert opened.project is not None, opened.diagnostics
    plan = opened.project.plan(DrivePlan)
    assert plan is not None
    return opened.project, plan


def placed(plan: DrivePlan) -> dict[str, str]:
    return {job.key: job.caller.block.name for job in plan.jobs}


@pytest.mark.slow
@pytest.mark.parametrize("plc", [("s7-300", "step7-v5"), ("s7-300", "tia-v16"), ("s7-1500", "tia-v19")])
def test_what_is_planned_with_is_never_too_small(plc: tuple[str, str], tmp_path: Path) -> None:
    """Layout and estimate of the files on disk against what was known before; the largest engine, 33 jobs on a unit."""
    family, toolchain = plc
    place = "address" if family == "s7-300" else "hardware_id"
    head = f"plc: {{name: K, family: {family}, toolchain: {toolchain}}}\ndrives:\n"
    drive = f"  a:\n    device: sinamics-s120\n    {place}: 256\n    drive_object: 3"
    more = "".join(f"  more{i}: {{drive: a, read: [P1120]}}\n" for i in range(20))
    project, plan = planned(head + drive + KINDS + more, tmp_path)
    assert plan.variant.name == "XL"
    api.generate(tmp_path / "plant.yaml", tmp_path / "out")
    sources = read_sources([tmp_path / "out"], classic=project.target.classic)
    found = {source.block.name: source.block for source in sources.blocks}
    entries = layout_block(found["DriveCalls_DB"], sources.types).entries
    sizes = {entry.path: entry.size // 8 for entry in entries if entry.depth == 0}
    bounds = {job.member: footprint(job.uses, job.telegrams, job.listed) for job in plan.jobs}
    bounds |= {"driveGate": GATE, plan.units[0].member: CHANNEL}
    assert set(sizes) == set(bounds)
    assert [name for name, size in sizes.items() if size > bounds[name].data] == []
    code = next(b.code for b in estimate(sources, project.target.dialect).blocks if b.name == "DriveCalls")
    assert code <= sum(bound.code for bound in bounds.values())


@pytest.mark.slow
@pytest.mark.parametrize("plc", sorted(PLCS))
def test_every_block_of_a_large_plant_fits(plc: str, tmp_path: Path) -> None:
    """600 jobs, 12 on each of 50 drives: about 90 KB of instances."""
    project, plan = planned(grid(12, 50, plc), tmp_path)
    api.generate(tmp_path / "plant.yaml", tmp_path / "out")
    size = estimate(tmp_path / "out", project.target.dialect)
    assert {block.name: max(block.code, block.data) for block in size.blocks if block.total > LARGEST} == {}
    names = [caller.block.name for caller in plan.callers]
    assert names[:2] == ["DriveCalls", "DriveCalls2"]
    call = '"{0}"."{0}_DB"();' if project.target.v5 else '"{0}_DB"();'
    main = (tmp_path / "out" / "example" / "Main.scl").read_bytes().decode("latin-1")
    places = [main.index(call.format(name)) for name in names]
    assert places == sorted(places)


def test_every_channel_is_called_once_before_its_jobs(tmp_path: Path) -> None:
    """Each unit is in one caller, in none behind one of its jobs."""
    _, plan = planned(grid(12, 50), tmp_path)
    where = [(unit.key, caller.number) for caller in plan.callers for unit in plan.channels(caller)]
    assert sorted(key for key, _ in where) == sorted(unit.key for unit in plan.units)
    channels = dict(where)
    assert all(channels[job.drive.unit.key] <= job.caller.number for job in plan.jobs)


def test_a_job_that_is_added_moves_none(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Behind the others, with a drive of its own and with a telegram that needs a larger engine."""
    monkeypatch.setattr(callers, "ROOM", Footprint(20_000, 20_000))
    text = grid(8, 30)
    _, before = planned(text, tmp_path)
    indexes = ", ".join(f'"r945[{index}]"' for index in range(30))
    more = f"  more: {{drive: [fan01, late], read: [{indexes}]}}\n"
    late = "  late: {device: sinamics-g120, hardware_id: 9000}\njobs:\n"
    _, behind = planned(text.replace("jobs:\n", late) + more, tmp_path)
    assert (before.variant.name, behind.variant.name) == ("M", "L")
    assert len(before.callers) > 2
    old, new = placed(before), placed(behind)
    assert {key: name for key, name in new.items() if key in old} == old
    assert set(new) - set(old) == {"more.fan01", "more.late"}


def test_what_is_larger_than_a_caller_has_one_of_its_own(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """300 bytes of room: nothing fits beside a channel of 720; every job still has a caller, and no caller is empty."""
    monkeypatch.setattr(callers, "ROOM", Footprint(300, 300))
    _, plan = planned(grid(2, 2), tmp_path)
    assert list(placed(plan).values()) == ["DriveCalls", "DriveCalls2", "DriveCalls3", "DriveCalls4"]


SMALL = 900
"""Bytes of room in a test: a few jobs."""


@pytest.mark.slow
@pytest.mark.parametrize("plc", sorted(PLCS))
def test_several_callers_are_verified(plc: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Whatever reads the folder knows them: layouts, commands, execution with all jobs together, coverage of each."""
    monkeypatch.setattr(callers, "ROOM", Footprint(SMALL, SMALL))
    _, plan = planned(grid(2, 3, plc), tmp_path)
    assert len(plan.callers) > 2
    api.generate(tmp_path / "plant.yaml", tmp_path / "out")
    result = api.verify(tmp_path / "plant.yaml", tmp_path / "out")
    checks = [check for group in result.groups for check in group.checks]
    assert [check for check in checks if check.outcome is Outcome.ERROR] == []
    subjects = {check.subject for check in checks}
    assert {f"coverage {caller.block.name}" for caller in plan.callers} <= subjects
    assert {f'"{caller.control.name}"' for caller in plan.callers} <= subjects


@pytest.mark.slow
@pytest.mark.parametrize(
    ("file", "old", "new", "code", "told"),
    [
        ("scl/DriveCalls2.scl", "slot := 1", "slot := 4", "PG621", "slot of job_0.fan02 is 4 instead of 1"),
        ("scl/DriveCalls3.scl", '"DriveJobs3"', '"DriveJobs2"', "PG820", "there is no member job0Fan03"),
        ("scl/Main.scl", '"DriveCalls2_DB"();', "", "PG621", "slots of fan02 is 4 instead of 2"),
        ("db/DriveJobs2.db", "execute : Bool;", "execute : Bool := TRUE;", "PG614", "execute starts with TRUE"),
    ],
)
def test_damage_behind_the_first_caller_is_noticed(
    file: str, old: str, new: str, code: str, told: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Besides the changed file and the document that differs from it: the program is wrong, and why."""
    monkeypatch.setattr(callers, "ROOM", Footprint(SMALL, SMALL))
    planned(per_block(grid(2, 3)), tmp_path)
    api.generate(tmp_path / "plant.yaml", tmp_path / "out")
    path = tmp_path / "out" / file
    text = path.read_text("utf-8")
    assert old in text
    path.write_text(text.replace(old, new, 1), "utf-8")
    result = api.verify(tmp_path / "plant.yaml", tmp_path / "out")
    wrong = [d for group in result.groups for check in group.checks if (d := check.diagnostic) is not None]
    assert any(told in d.message and d.code == code for d in wrong), wrong
