"""The clock: the telegram for a time, and times for which none is sent; by hand."""

from __future__ import annotations

from pathlib import Path

from plcgen import api
from plcgen.ds47.proof.plant import Plant
from plcgen.ds47.proof.scenario import DriveScenario

SPEC = """
drives: {control: {device: sinamics-s120, ID: 280, drive_object: 1}}
jobs: {tell: {drive: control, clock: utc}}
"""
SENT = (
    "02 01 04 10 01 0c 1c 00 00 10 01 0c 1f 00 00 10 01 0c 1d 00 01 10 01 0c 1d 00 00"
    " 06 01 00 01 03 01 00 02 07 01 00 00 4d 46 07 01 02 b3 2c 95"
)
"""p3100 = 0C1Ch, p3103 = 0C1Fh, p3101[1], p3101[0] = 0C1Dh. 2024-02-29 is day 19,723 + 31 + 28 = 19,782 = 4D46h,
12:34:56.789 is 45,296,789 = 02B32C95h ms."""
DTL = "07 e8 02 1d 05 0c 22 38 2f 07 2f 40"
"""2024 = 07E8h, 2, 29, Thursday, 12, 34, 56, 789,000,000 = 2F072F40h."""
DT = "24 02 29 12 34 56 78 95"


def run(plant: Plant, time: str) -> tuple[list[str], int]:
    """The job with a time at its input: requests and status."""
    plant.begin(DriveScenario(name="OB1"))
    (job,) = plant.plan.jobs
    plant.control(job).put("tell.utc", bytes.fromhex(time))
    plant.execute(job)
    plant.until(lambda _, __: True, 100)
    status = plant.result(job)[1]
    plant.fall()
    journal = plant.units["control"].journal
    return [one.data[1:].hex(" ") for one in journal if one.direction == "write" and not one.status], status


def test_a_time_is_sent(generate, target) -> None:
    """Days and milliseconds; no February 29 in 2023, none in front of 2000, and nothing where nothing is connected."""
    made = generate(SPEC, target)
    plant = Plant(made.plan, made.program).fresh()
    right = DTL if target == "t15" else DT
    assert run(plant, right) == ([SENT], 0)
    common, old = ("07 e7", "07 cf") if target == "t15" else ("23", "99")
    for year in (common, old):
        assert run(plant, year + right[len(year) :]) == ([], 0x8520)
    assert (
        run(plant, "07 b2 01 01 05 00 00 00 00 00 00 00" if target == "t15" else "90 01 01 00 00 00 00 02")[1] == 0x8520
    )
    assert run(plant, right) == ([SENT], 0)


def test_a_telegram_with_the_names_of_the_faq(tmp_path: Path) -> None:
    """The members of the request are called otherwise there: the block writes days and milliseconds into it anyway."""
    spec = tmp_path / "job.yaml"
    text = "plc: {name: a, family: s7-1500, toolchain: tia-v19, names: faq}\n"
    text += "drives: {unit: {device: sinamics-s120, hardware_id: 280, drive_object: 1}}\n"
    spec.write_text(text + "jobs: {set_clock: {drive: unit, clock: utc}}\n", "utf-8")
    assert api.generate(spec, tmp_path / "out").ok
    assert api.verify(spec, tmp_path / "out", faults="none").ok
