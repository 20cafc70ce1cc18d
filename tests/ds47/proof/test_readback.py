"""Reading back: what is sent, what counts as the same, who is told what; by hand on the soft CPU."""

from __future__ import annotations

import struct
from pathlib import Path

import pytest

from plcgen import api
from plcgen.ds47.plan.access import Verify
from plcgen.ds47.plan.nouns import DrivePlan
from plcgen.ds47.proof.plant import Plant
from plcgen.ds47.proof.rig import JobRig
from plcgen.ds47.proof.scenario import DriveScenario
from plcgen.ds47.proof.stimulus import UNITS
from plcgen.ds47.proof.words import GRANT, WORDS
from plcgen.ds47.sim.parameters import Keeps
from tests.ds47.proof.playing import job_of, sent, status_of

HEAD = "plc: {name: a, family: s7-1500, toolchain: tia-v19}\ndrives: {d: {device: sinamics-g120, hardware_id: 270}}\n"
SPEC = """
drives:
  mixer:
    device: sinamics-g120
    ID: 270
    parameters:
      P2900: {type: Integer16, array: 8}
      P2901: {type: "VisibleString[4]"}
      P3000: {type: FloatingPoint, array: 200}
jobs:
  ramp: {drive: mixer, write: {P1120: 10.0}, verify: readback}
  steps: {drive: mixer, write: {P1121: 2.0, "P2900[3..5]": [1, 2, 3], P2901: "abc"}, verify: readback}
  long: {drive: mixer, write: {"P3000[0..99]": 1.5}, verify: readback}
"""
DEVIATES = 0x8200


def run(
    plant: Plant, key: str, keeps: dict[int, Keeps] | None = None, meanwhile: dict[int, Keeps] | None = None
) -> int:
    """Run a job against a drive that makes something of its values; its status."""
    plant.begin(DriveScenario(name="OB1", keeps=keeps or {}, meanwhile=meanwhile or {}))
    job = job_of(plant, key)
    return status_of(plant, job)


def told(plant: Plant, key: str) -> list[tuple[int, int]]:
    """What the job says of each parameter: written, then read back."""
    path = f'"DriveJobs".{job_of(plant, key).member}.diagnosis'
    count = len(job_of(plant, key).uses)
    return [(plant.cpu[f"{path}.errors[{n}]"], plant.cpu[f"{path}.errorInfos[{n}]"]) for n in range(1, count + 1)]


def test_it_writes_and_asks(plant: Plant) -> None:
    """P1120 = 0460h of drive object 1: 41200000h is written, then the parameter is read, once each."""
    assert run(plant, "ramp") == 0
    assert sent(plant) == ["02 01 01 10 01 04 60 00 00 08 01 41 20 00 00", "01 01 01 10 01 04 60 00 00"]
    assert told(plant, "ramp") == [(0, 0), (0, 0)]
    assert plant.cpu[back(plant)] == 10.0


def back(plant: Plant) -> str:
    """Where the value of P1120 lies that was read back."""
    job = job_of(plant, "ramp")
    return f'"DriveJobs".{job.member}.{job.outputs[0].member}'


def bits(pattern: str) -> Keeps:
    """The drive has these bytes of a FloatingPoint."""
    return lambda _index, _value: struct.unpack(">f", bytes.fromhex(pattern))[0]


NEIGHBOURS = {
    "41200000": True,
    "41200001": True,  # one unit of the last place up: 10.000001
    "411FFFFF": True,  # and down: the bytes differ in three places, the numbers by 9.5e-7
    "41200002": False,
    "411FFFFE": False,
    "41300000": False,  # 11.0, a drive that clips
    "C1200000": False,  # -10.0
    "41210001": False,  # the last byte is one away as well
    "00000000": False,
}
"""What a drive may have instead of 10.0, which is 41200000h (IEEE 754), and whether that is the same."""


def test_one_unit_of_the_last_place(plant: Plant) -> None:
    """The neighbours of a REAL are what rounding of a REAL may lead to; nothing else is the same."""
    for pattern, same in NEIGHBOURS.items():
        status = run(plant, "ramp", keeps={1120: bits(pattern)})
        assert status == (0 if same else 0x8503), pattern
        assert told(plant, "ramp") == [(0, 0), (0, 0) if same else (DEVIATES, 0)]
        assert struct.pack(">f", plant.cpu[back(plant)]).hex().upper() == pattern  # what the drive has is delivered


def test_the_next_run_is_a_new_one(plant: Plant) -> None:
    """After a deviation the same job is done when the drive has the value."""
    assert run(plant, "ramp", keeps={1120: bits("41300000")}) == 0x8503 == WORDS["DEVIATES"]
    assert run(plant, "ramp") == 0


def test_somebody_else_writes_in_between(plant: Plant) -> None:
    """The drive took 10.0; before it is asked, an operator panel makes 5.0 of it."""
    assert run(plant, "ramp", meanwhile={1120: bits("40A00000")}) == 0x8503
    assert plant.cpu[back(plant)] == 5.0


def test_errors_name_parameter_and_index(plant: Plant) -> None:
    """Parameters 1 to 3 were taken; of those read back, 4 is right, of 5 the value of index 4, of 6 octet 2 is not."""
    keeps: dict[int, Keeps] = {
        2900: lambda index, value: 9 if index >= 4 else value,
        2901: lambda _index, _value: "abX ",
    }
    assert run(plant, "steps", keeps=keeps) == 0x8503
    assert told(plant, "steps") == [(0, 0), (0, 0), (0, 0), (0, 0), (DEVIATES, 4), (DEVIATES, 2)]


def test_nothing_is_sent_behind_a_deviation(plant: Plant) -> None:
    """100 REALs are two telegrams each way; the first answer is enough to know, the second question is not asked."""
    assert [telegram.writes for telegram in job_of(plant, "long").telegrams] == [True, True, False, False]
    assert run(plant, "long") == 0
    assert len(sent(plant)) == 4
    assert run(plant, "long", keeps={3000: lambda index, value: 0.0 if index == 7 else value}) == 0x8503
    assert len(sent(plant)) == 3
    assert told(plant, "long") == [(0, 0), (DEVIATES, 7)]
    assert run(plant, "long", keeps={3000: lambda index, value: 0.0 if index == 99 else value}) == 0x8503
    assert len(sent(plant)) == 4
    assert told(plant, "long") == [(0, 0), (DEVIATES, 99)]


def test_other_jobs_wait_until_it_is_read_back(plant: Plant) -> None:
    """The unit is held from the write to the answer: a job that is started meanwhile sends behind both."""
    plant.begin(DriveScenario(name="OB1"))
    plant.execute(job_of(plant, "ramp"))
    plant.step(2)
    plant.execute(job_of(plant, "long"))
    plant.step(100)
    assert [request[:2] for request in sent(plant)] == ["02", "01", "02", "02", "01", "01"]


def test_indexes_that_no_int_has(generate, target) -> None:
    """Index 40001 is 9C41h."""
    text = "{drive: m, write: {'P5000[40001]': 7}, verify: readback}"
    made = generate(
        "drives: {m: {device: sinamics-g120, ID: 270, parameters: {P5000: {type: Integer16, array: 40002}}}}\n"
        f"jobs: {{j: {text}}}\n",
        target,
    )
    plant = Plant(made.plan, made.program).fresh()
    plant.begin(DriveScenario(name="OB1", keeps={5000: lambda _index, _value: 8}))
    plant.execute(plant.plan.jobs[0])
    plant.step(100)
    assert plant.result(plant.plan.jobs[0]) == (True, 0x8503)
    assert told(plant, "j") == [(0, 0), (DEVIATES, 0x9C41)]


def test_it_leaves_alone_what_is_not_its_own(generate, target) -> None:
    """The unit belongs to another slot, whose telegram 2 has just ended: the job has lost it, and marks nothing."""
    made = generate(SPEC, target)
    rig = JobRig(made.plan, made.program, made.plan.shapes[0], 1)
    rig.next_values("factory")
    rig.drive.begin(DriveScenario(name="lost"))
    rig.db.set("execute", 1)
    while rig.telegram < 2:
        rig.cpu.call(rig.db.block, 10)
    unit = f'"{UNITS[0]}".unit'
    rig.cpu[f"{unit}.turn.grant"] = 2 * GRANT + 1
    rig.cpu[f"{unit}.turn.served"] = 2
    rig.cpu[f"{unit}.turn.status"] = 0
    rig.cpu[f"{unit}.errors[1]"] = 0
    rig.cpu.call(rig.db.block, 10)
    assert rig.db.get("status") == WORDS["LOST"]
    assert rig.cpu[f"{unit}.errors[1]"] == 0


SAVED = """
drives: {mixer: {device: sinamics-g120, ID: 270}}
jobs: {keep: {drive: mixer, write: {P1120: 10.0}, verify: readback, save: drive_object}}
"""
WRITE, ASK = "02 01 01 10 01 04 60 00 00 08 01 41 20 00 00", "01 01 01 10 01 04 60 00 00"
SAVE, SAVING = "02 01 01 10 01 03 cb 00 00 06 01 00 01", "01 01 01 10 01 03 cb 00 00"
"""P1120 = 0460h and p0971 = 03CBh of drive object 1: written, asked for."""


def test_what_is_right_is_saved(generate, target) -> None:
    """Written, read back, saved, asked whether that has ended: in this order, and once each."""
    made = generate(SAVED, target)
    plant = Plant(made.plan, made.program).fresh()
    assert run(plant, "keep") == 0
    assert sent(plant) == [WRITE, ASK, SAVE, SAVING]
    assert told(plant, "keep") == [(0, 0)] * 4
    assert plant.cpu['"DriveCalls_DB".keep.saves'] == 1


def test_what_is_not_right_is_not_saved(generate, target) -> None:
    """A deviation ends the job in front of the save; it costs no distance: the next start saves at once."""
    made = generate(SAVED, target)
    plant = Plant(made.plan, made.program).fresh()
    saves, rest = (f'"DriveCalls_DB".keep.{name}' for name in ("saves", "statRest"))
    assert run(plant, "keep", keeps={1120: bits("41300000")}) == 0x8503
    assert sent(plant) == [WRITE, ASK]
    assert told(plant, "keep") == [(0, 0), (DEVIATES, 0), (0xFFFF, 0), (0xFFFF, 0)]
    assert (plant.cpu[saves], plant.cpu[rest]) == (0, 0)
    assert run(plant, "keep") == 0
    assert plant.cpu[saves] == 1


def test_too_soon_writes_nothing(generate, target) -> None:
    """Within the distance of a save a start is refused as a whole: the values are not written either."""
    made = generate(SAVED, target)
    plant = Plant(made.plan, made.program).fresh()
    assert run(plant, "keep") == 0
    before = len(sent(plant))
    plant.control(job_of(plant, "keep")).set("keep.execute", 0)
    plant.step()
    plant.control(job_of(plant, "keep")).set("keep.execute", 1)
    plant.step(50)
    assert plant.result(job_of(plant, "keep")) == (True, WORDS["TOO_SOON"])
    assert len(sent(plant)) == before


@pytest.mark.slow
@pytest.mark.parametrize(
    ("more", "right"),
    [("", True), (", step: 0.5", True), (", step: 0.4", False), (", low: 0, high: 9, clips: true", False)],
)
def test_own_drive(more: str, right: bool, tmp_path: Path) -> None:
    """10.5 in steps of 0.4 is 10.4, clipped it is 9.0: 16#8503. 10.5 is a multiple of 0.5."""
    path, drive = tmp_path / "job.yaml", tmp_path / "drive.yaml"
    path.write_text(f"{HEAD}jobs: {{j: {{drive: d, write: {{P1120: 10.5}}, verify: readback}}}}\n", "utf-8")
    assert api.generate(path, tmp_path / "out").ok
    drive.write_text(
        f"objects: [{{number: 1, parameters: [{{pnu: 1120, type: FloatingPoint, value: 1.0{more}}}]}}]", "utf-8"
    )
    result = api.verify(path, tmp_path / "out", faults="none", drive=drive)
    (verdict,) = [check.verdict for check in result.checks() if check.id == "own.j"]
    assert verdict == "ok, values agree" if right else "16#8503" in verdict


@pytest.mark.slow
def test_simulate_shows_what_the_drive_has(tmp_path: Path) -> None:
    """10.5 becomes 9.0 in a drive that clips: the value that was read is among those of the job."""
    path, drive = tmp_path / "job.yaml", tmp_path / "drive.yaml"
    path.write_text(f"{HEAD}jobs: {{j: {{drive: d, write: {{P1120: 10.5}}, verify: readback}}}}\n", "utf-8")
    assert api.generate(path, tmp_path / "out").ok
    keys = "pnu: 1120, type: FloatingPoint, value: 1.0, low: 0, high: 9, clips: true"
    drive.write_text(f"objects: [{{number: 1, parameters: [{{{keys}}}]}}]", "utf-8")
    (job,) = api.simulate(path, tmp_path / "out", drives=[str(drive)]).jobs
    assert (job.status, [value.value for value in job.values]) == (0x8503, [10.5, 9.0])


def test_what_is_written_is_listed_once(tmp_path: Path) -> None:
    """IMPORT.md has the write, not the read."""
    path = tmp_path / "job.yaml"
    path.write_text(f"{HEAD}jobs: {{j: {{drive: d, write: {{P1120: 10.5}}, verify: readback}}}}\n", "utf-8")
    assert api.generate(path, tmp_path / "out").ok
    text = (tmp_path / "out" / "IMPORT.md").read_text("utf-8")
    assert text.count("| P1120 |") == 1
    assert [use.as_(Verify) is not None for use in api.check(path).project.plan(DrivePlan).jobs[0].uses] == [
        False,
        True,
    ]
