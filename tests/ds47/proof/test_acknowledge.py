"""Acknowledging: what a drive is told, how long it is asked, and what it says of faults that stay; by hand."""

from __future__ import annotations

from pathlib import Path

import pytest

from plcgen import api
from plcgen.ds47.proof.plant import Plant
from plcgen.ds47.proof.scenario import DriveScenario
from plcgen.ds47.proof.words import WORDS
from tests.ds47.proof.playing import sent

HEAD = "plc: {name: a, family: s7-1500, toolchain: tia-v19}\ndrives: {d: {device: sinamics-s120, hardware_id: 270}}\n"
SPEC = """
drives: {axis: {device: sinamics-s120, ID: 281, drive_object: 3}}
jobs: {clear: {drive: axis, acknowledge: {limit: 2s, interval: 1s}}}
"""
WRITE = "02 03 01 10 01 0f 8d 00 00 05 01 01 00"
ASK = "01 03 02 10 01 0f 8d 00 00 10 08 03 b1 00 00"
"""p3981 = 0F8Dh of drive object 3 as Unsigned8 with its pad: set to 1; asked for, with r0945[0..7] (03B1h)."""
SECOND = 100
"""Scans of 10 ms."""


def run(plant: Plant, saving: int, remaining: int = 0) -> tuple[int, int]:
    """A drive with the faults 7 and 8 takes so many ms, some of them stay; scans and status of the job."""
    plant.begin(DriveScenario(name="OB1", saving=saving, remaining=remaining))
    plant.units["axis"].objects[3].parameters[945].values[:] = [7, 8, 0, 0, 0, 0, 0, 0]
    (job,) = plant.plan.jobs
    plant.execute(job)
    for scan in range(1, 10 * SECOND):
        plant.step()
        over, status = plant.result(job)
        if over:
            plant.fall()
            return scan, status
    raise AssertionError("it has not ended")


def codes(plant: Plant) -> list[object]:
    """What the job says of the present faults."""
    return [plant.cpu[f'"DriveJobs".clear.faultCodes[{index}]'] for index in range(8)]


@pytest.mark.slow
def test_a_drive_is_asked_until_it_has_no_fault(plant: Plant) -> None:
    """The drive takes 1.5 s: the question after 1 s is answered with 1 and the faults, the one after 2 s with zeros."""
    scans, status = run(plant, 1500)
    assert status == 0
    assert sent(plant) == [WRITE, ASK, ASK]
    assert 2 * SECOND <= scans <= 2 * SECOND + 50
    assert codes(plant) == [0] * 8


def test_faults_that_stay(plant: Plant) -> None:
    """Fault 7 is there again at once: asked after 1 s and, as the limit demands, after 2 s and the write; then 8506."""
    scans, status = run(plant, 0, remaining=1)
    assert status == 0x8506 == WORDS["FAULTS_REMAIN"]
    assert 2 * SECOND <= scans <= 3 * SECOND + 50
    assert codes(plant) == [7, 0, 0, 0, 0, 0, 0, 0]
    assert run(plant, 0)[1] == 0  # the next start acknowledges what is left


@pytest.mark.slow
def test_a_drive_that_does_not_acknowledge(plant: Plant) -> None:
    """p3981 stays 1: 8505, whatever the faults."""
    assert run(plant, 3_600_000)[1] == 0x8505 == WORDS["NOT_ACKNOWLEDGED"]
    assert codes(plant) == [7, 8, 0, 0, 0, 0, 0, 0]


@pytest.mark.slow
def test_own_drive(tmp_path: Path) -> None:
    """A drive file whose p3981 acknowledges; one in which a fault stays."""
    path, drive = tmp_path / "job.yaml", tmp_path / "drive.yaml"
    path.write_text(f"{HEAD}jobs: {{j: {{drive: d, acknowledge: true}}}}\n", "utf-8")
    assert api.generate(path, tmp_path / "out").ok
    for remaining, right in ((0, True), (1, False)):
        keys = f"clears_after: 300, acknowledges: true, remaining: {remaining}"
        drive.write_text(
            "objects: [{number: 2, parameters: [{pnu: 945, type: Unsigned16, values: [7, 8, 0, 0, 0, 0, 0, 0]},"
            f" {{pnu: 3981, type: Unsigned8, value: 0, {keys}}}]}}]",
            "utf-8",
        )
        result = api.verify(path, tmp_path / "out", faults="none", drive=drive)
        (verdict,) = [check.verdict for check in result.checks() if check.id == "own.j"]
        assert verdict == "ok, values agree" if right else "16#8506" in verdict
