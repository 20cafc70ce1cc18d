"""Saving: what a drive is told, what is held back meanwhile, and how often it may be asked; by hand on the soft CPU."""

from __future__ import annotations

from pathlib import Path

import pytest

from plcgen import api
from plcgen.ds47.plan.nouns import DrivePlan
from plcgen.ds47.proof.plant import Plant
from plcgen.ds47.proof.scenario import DriveScenario
from plcgen.ds47.proof.words import WORDS

HEAD = "plc: {name: a, family: s7-1500, toolchain: tia-v19}\ndrives: {d: {device: sinamics-g120, hardware_id: 270}}\n"
SPEC = """
units:
  cu:
    device: sinamics-s120
    drives: {control: {ID: 280, drive_object: 1}, axis: {ID: 281, drive_object: 3}}
jobs:
  keep: {drive: axis, save: drive_object}
  keep_all: {drive: control, save: {persist: unit, limit: 3s}}
  keep_apart: {drive: control, save: {persist: unit, setting: 11}}
  get: {drive: axis, read: [r21]}
  set: {drive: axis, write: [{parameter: P2900, type: FloatingPoint, value: 1.0}]}
"""
WRITE, ASK = bytes.fromhex("02 03 01 10 01 03 CB 00 00 06 01 00 01"), bytes.fromhex("01 03 01 10 01 03 CB 00 00")
"""p0971 = 03CBh of drive object 3 as Unsigned16, without the request reference: set to 1, asked for."""
SECOND = 100
"""Scans of 10 ms."""


@pytest.fixture
def plant(generate, target) -> Plant:
    """A unit with two drive objects, and OB1 with all jobs."""
    made = generate(SPEC, target)
    return Plant(made.plan, made.program).fresh("save")


def started(plant: Plant, saving: int, *keys: str) -> None:
    """Start jobs; the drive takes that long to save."""
    plant.begin(DriveScenario(name="OB1", saving=saving))
    for job in plant.plan.jobs:
        if job.key in keys:
            plant.execute(job)


def ended(plant: Plant, key: str, scans: int) -> tuple[int, int]:
    """After how many scans a job has ended, and how."""
    job = next(job for job in plant.plan.jobs if job.key == key)
    for scan in range(1, scans + 1):
        plant.step()
        over, status = plant.result(job)
        if over:
            return scan, status
    raise AssertionError(f"{key} has not ended")


def sent(plant: Plant) -> list[bytes]:
    """Requests that the unit has taken, without their references."""
    return [one.data[1:] for one in plant.units["cu"].journal if one.direction == "write" and not one.status]


def test_a_drive_is_asked_until_it_has_saved(plant: Plant) -> None:
    """2.5 s of saving and a question a second: the third question is answered with 0, and the job is done."""
    started(plant, 2500, "keep")
    scans, status = ended(plant, "keep", 5 * SECOND)
    assert status == 0
    assert sent(plant) == [WRITE, ASK, ASK, ASK]
    assert 3 * SECOND <= scans <= 3 * SECOND + 50
    parameter = plant.units["cu"].objects[3].parameters[971]
    assert parameter.saved == (0,)  # the simulated drive has saved: it notes what it would have after power-on


def test_everything_else_waits(plant: Plant) -> None:
    """A read and a write of the same unit, started while it saves, are sent behind the last question, and end well."""
    started(plant, 2500, "keep")
    plant.step(SECOND)
    for job in plant.plan.jobs:
        if job.key in {"get", "set"}:
            plant.execute(job)
    assert ended(plant, "keep", 5 * SECOND)[1] == 0
    assert set(sent(plant)) == {WRITE, ASK}
    assert ended(plant, "set", SECOND)[1] == 0
    plant.step(SECOND)
    found = sent(plant)
    assert found[:4] == [WRITE, ASK, ASK, ASK]
    assert sorted(one[0] for one in found[4:]) == [1, 2]  # one read, one write


def test_a_drive_that_never_finishes(plant: Plant) -> None:
    """Limit 3 s: the questions at 1, 2 and 3 s say 1, and the last of them is the end: 8501, and the unit is free."""
    started(plant, 3_600_000, "keep_all", "get")
    scans, status = ended(plant, "keep_all", 6 * SECOND)
    assert status == 0x8501 == WORDS["NOT_SAVED"]
    assert 3 * SECOND <= scans <= 4 * SECOND + 50
    plant.step(SECOND)
    job = next(job for job in plant.plan.jobs if job.key == "get")
    assert plant.result(job) == (True, 0)


def test_too_soon(plant: Plant) -> None:
    """A second start behind a save is refused without a telegram until 10 min have passed since the first write."""
    started(plant, 300, "keep")
    assert ended(plant, "keep", 3 * SECOND)[1] == 0
    job = next(job for job in plant.plan.jobs if job.key == "keep")
    before = len(sent(plant))
    for wait, wanted in ((0, WORDS["TOO_SOON"]), (590, WORDS["TOO_SOON"]), (11, 0)):
        plant.control(job).set("keep.execute", 0)
        plant.step()
        plant.step(wait, 1000)
        plant.control(job).set("keep.execute", 1)
        assert ended(plant, "keep", 3 * SECOND)[1] == wanted
        assert (len(sent(plant)) == before) == (wanted != 0)
    name = f'"{job.caller.instance.name}".{job.member}.saves'
    assert plant.cpu[name] == 2


def test_telegrams_of_a_unit(plant: Plant) -> None:
    """p0977 = 03D1h of drive object 1, first written, then read; the write alone is never sent twice."""
    job = next(job for job in plant.plan.jobs if job.key == "keep_all")
    assert [one.request.data.hex(" ") for one in job.telegrams] == [
        "01 02 01 01 10 01 03 d1 00 00 06 01 00 01",
        "02 01 01 01 10 01 03 d1 00 00",
    ]
    assert job.once
    apart = next(job for job in plant.plan.jobs if job.key == "keep_apart")
    assert apart.telegrams[0].request.data[-2:] == b"\x00\x0b"  # setting 11
    started(plant, 500, "keep_apart")
    assert ended(plant, "keep_apart", 2 * SECOND)[1] == 0


def test_limit_and_timeout_add_up(plant: Plant) -> None:
    """The channel gives a save 10 s for its telegrams, 30 s or 3 s for the drive and 1 s to the next question."""
    assert {job.key: job.timeout for job in plant.plan.jobs if job.poll} == {
        "keep": 41_000, "keep_all": 14_000, "keep_apart": 41_000,
    }  # fmt: skip


def test_the_list_of_writes_has_it(tmp_path: Path) -> None:
    """IMPORT.md names number, value and how often; the question is no write."""
    path = tmp_path / "job.yaml"
    path.write_text(f"{HEAD}jobs: {{j: {{drive: d, save: drive_object}}}}\n", "utf-8")
    assert api.generate(path, tmp_path / "out").ok
    rows = [line for line in (tmp_path / "out" / "IMPORT.md").read_text("utf-8").splitlines() if "| P971 |" in line]
    assert len(rows) == 1
    assert "the job says save, once in 600 s at most" in rows[0]


@pytest.mark.slow
def test_own_drive(tmp_path: Path) -> None:
    """A drive file whose p0971 returns to 0 after 300 ms passes; one that leaves it at 1 does not."""
    path, drive = tmp_path / "job.yaml", tmp_path / "drive.yaml"
    path.write_text(f"{HEAD}jobs: {{j: {{drive: d, save: {{persist: drive_object, limit: 2s}}}}}}\n", "utf-8")
    assert api.generate(path, tmp_path / "out").ok
    for more, right in ((", clears_after: 300, saves: object", True), ("", False)):
        drive.write_text(
            f"objects: [{{number: 1, parameters: [{{pnu: 971, type: Unsigned16, value: 0{more}}}]}}]", "utf-8"
        )
        result = api.verify(path, tmp_path / "out", faults="none", drive=drive)
        (verdict,) = [check.verdict for check in result.checks() if check.id == "own.j"]
        assert result.ok == right, verdict
        assert verdict == "ok, values agree" if right else "16#8501" in verdict


def test_retries_are_an_int(tmp_path: Path) -> None:
    """An hour in steps of 50 ms would be 57,600 retries; an INT ends at 32,767."""
    path = tmp_path / "job.yaml"
    path.write_text(f"{HEAD}jobs: {{j: {{drive: d, read: [P1120], timeout: 60min, retry_pause: 50ms}}}}\n", "utf-8")
    plan = api.check(path).project.plan(DrivePlan)
    assert plan.jobs[0].retries == 30_000
