"""Lists of messages: what is sent, in which order it comes out, a buffer that changes; by hand on the soft CPU."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from plcgen import api
from plcgen.ds47.plan.nouns import DrivePlan
from plcgen.ds47.proof.plant import Plant
from plcgen.ds47.proof.scenario import DriveScenario
from plcgen.ds47.sim.drive import Drive
from tests.ds47.proof.playing import job_of, sent, status_of

HEAD = "plc: {name: a, family: s7-1500, toolchain: tia-v19}\ndrives: {d: {device: sinamics-s120, hardware_id: 270}}\n"
SPEC = """
drives: {axis: {device: sinamics-s120, ID: 281, drive_object: 3}}
jobs:
  what: {drive: axis, faults: {history: 1, tries: 2}}
  warned: {drive: axis, alarms: {history: 1, columns: [code, removed]}}
"""
FIRST = (
    "01 03 07 10 01 03 b0 00 00 10 08 03 b1 00 00 10 08 03 b5 00 00 10 08 03 b4 00 00"
    " 10 08 03 b1 00 08 10 08 03 b5 00 08 10 08 03 b4 00 08"
)
LAST = "01 03 01 10 01 03 b0 00 00"
"""r0944 = 03B0h, then indexes 0 to 7 and 8 to 15 of r0945 = 03B1h, r0949 = 03B5h and r0948 = 03B4h; r0944 once more."""


def holds(plant: Plant, **values: list[int]) -> None:
    """What the drive has: of an array the first values, then zeros."""
    parameters = plant.units["axis"].objects[3].parameters
    for name, given in values.items():
        held = parameters[int(name[1:])].values
        held[:] = given + [0] * (len(held) - len(given))


def run(plant: Plant, key: str, events: dict[int, Callable[[Drive], None]] | None = None, **values: list[int]) -> int:
    """Run a job against a drive with these values; its status."""
    plant.begin(DriveScenario(name="OB1", events=events or {}))
    holds(plant, **values)
    return status_of(plant, job_of(plant, key))


def entries(plant: Plant, path: str, *columns: str) -> list[tuple[object, ...]]:
    """The 16 places of a list."""
    name = f'"DriveJobs".{path}'
    return [tuple(plant.cpu[f"{name}[{place}].{column}"] for column in columns) for place in range(1, 17)]


def test_the_latest_first(plant: Plant) -> None:
    """r0945[0] is the oldest fault of the present case (parameters of S210, r0945): 7800 came after 30001."""
    history = [0] * 6 + [7, 8, 9]
    assert run(plant, "what", r945=[30001, 7800, *history], r949=[1, -2, *history], r948=[5, 6, *history]) == 0
    assert sent(plant) == [FIRST, LAST]
    none, place = (0, 0, 0), '"DriveJobs".what.faultCount'
    assert entries(plant, "what.faults", "code", "value", "received") == [
        (7800, -2, 6), (30001, 1, 5), *[none] * 6,
        (9, 9, 9), (8, 8, 8), (7, 7, 7), *[none] * 5,
    ]  # fmt: skip
    assert plant.cpu[place] == 2
    assert run(plant, "what", r945=[]) == 0
    assert entries(plant, "what.faults", "code", "value", "received") == [none] * 16
    assert plant.cpu[place] == 0


@pytest.mark.slow
def test_alarms_that_have_gone_are_the_latest_first_already(plant: Plant) -> None:
    """r2122[7] is the latest of the present, r2122[8] that of those that have gone (parameters of S120, r2122)."""
    gone = [0] * 5 + [9, 8, 7]
    assert run(plant, "warned", r2122=[1, 2, 3, *gone], r2125=[0, 0, 0, *gone]) == 0
    none = [(0, 0)]
    expected = [(3, 0), (2, 0), (1, 0), *none * 5, (9, 9), (8, 8), (7, 7), *none * 5]
    assert entries(plant, "warned.alarms", "code", "removed") == expected
    assert plant.cpu['"DriveJobs".warned.alarmCount'] == 3


def comes(drive: Drive) -> None:
    """Fault 99 comes: r0945[0], and r0944 counts on."""
    parameters = drive.objects[3].parameters
    parameters[945].values[0] = 99
    parameters[944].values[0] += 1  # type: ignore[operator]


@pytest.mark.slow
def test_a_buffer_that_changes_is_read_again(plant: Plant) -> None:
    """A fault comes between the two questions: the second try has it, and is what is listed."""
    assert run(plant, "what", {2: comes}, r944=[41], r945=[7]) == 0
    assert sent(plant) == [FIRST, LAST, FIRST, LAST]
    assert entries(plant, "what.faults", "code")[:2] == [(99,), (0,)]


def test_a_buffer_that_always_changes(plant: Plant) -> None:
    """After two tries it is 8504, and the list is that of the run before."""
    assert run(plant, "what", r944=[41], r945=[7]) == 0
    assert run(plant, "what", {2: comes, 4: comes}, r944=[50], r945=[8]) == 0x8504
    assert sent(plant) == [FIRST, LAST, FIRST, LAST]
    assert entries(plant, "what.faults", "code")[:2] == [(7,), (0,)]
    assert run(plant, "what", r944=[60], r945=[8]) == 0
    assert entries(plant, "what.faults", "code")[:2] == [(8,), (0,)]


def test_a_case_is_never_divided(tmp_path: Path) -> None:
    """Header 4, counter 2 + 2, codes of a case 2 + 16, values and times 2 + 32 each: a case has 86 bytes, a record 240.

    8 + 2 x 86 + 18 + 34 = 232; 4 + 34 + 2 x 86 + 18 = 228; 4 + 34 + 34 + 86 + 18 + 34 = 210; 4 + 34; 4 + 4.
    """
    path = tmp_path / "job.yaml"
    path.write_text(f"{HEAD}jobs: {{j: {{drive: d, faults: all}}}}\n", "utf-8")
    job = api.check(path).project.plan(DrivePlan).jobs[0]
    assert [len(telegram.parts) for telegram in job.telegrams] == [9, 8, 7, 1, 1]
    assert all(part.whole for telegram in job.telegrams for part in telegram.parts)
    assert [telegram.positive_length for telegram in job.telegrams] == [232, 228, 210, 38, 8]


@pytest.mark.slow
def test_own_drive(tmp_path: Path) -> None:
    """A drive file with a buffer."""
    path, drive = tmp_path / "job.yaml", tmp_path / "drive.yaml"
    path.write_text(f"{HEAD}jobs: {{j: {{drive: d, faults: {{columns: [code]}}}}}}\n", "utf-8")
    assert api.generate(path, tmp_path / "out").ok
    held = "{pnu: 944, type: Unsigned16, value: 3}, {pnu: 945, type: Unsigned16, values: [1, 2, 0, 0, 0, 0, 0, 0]}"
    drive.write_text(f"objects: [{{number: 2, parameters: [{held}]}}]", "utf-8")
    result = api.verify(path, tmp_path / "out", faults="none", drive=drive)
    (verdict,) = [check.verdict for check in result.checks() if check.id == "own.j"]
    assert verdict == "ok, values agree"
