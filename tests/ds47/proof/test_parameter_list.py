"""A job that reads the list of parameters that a drive keeps of itself: from the drive to what `import` makes of it."""

from __future__ import annotations

from pathlib import Path

from plcgen.ds47.catalogue.own_list import OwnList, read_own_list
from plcgen.ds47.proof.plant import Plant
from plcgen.ds47.proof.scenario import DriveScenario

SPEC = """
drives: {axis: {device: sinamics-s120, ID: 281, drive_object: 3}}
jobs: {read_list: {drive: axis, read: ["r980[0..299]"]}}
"""
ERROR = '"DriveJobs".readList.diagnosis.errors[1]'
ASK = "01 03 01 10"
"""Read from drive object 3, one parameter, its value; then elements, 980 = 03D4h, the first index."""


def run(plant: Plant, values: list[int] | None) -> tuple[int, list[str]]:
    """Status of one run on a drive with these elements (None: no r980), and the requests without their reference."""
    plant.begin(DriveScenario(name="OB1"), delivered=True)
    parameters = plant.units["axis"].objects[3].parameters
    if values is None:
        del parameters[980]
    else:
        parameters[980].values[:] = values
    (job,) = plant.plan.jobs
    plant.execute(job)
    for _ in range(1000):
        plant.step()
        over, status = plant.result(job)
        if over:
            plant.fall()
            journal = plant.units["axis"].journal
            return status, [x.data[1:].hex(" ") for x in journal if x.direction == "write" and not x.status]
    raise AssertionError("it has not ended")


def watched(plant: Plant) -> OwnList | None:
    """What a watch table of the array shows, read."""
    name = '"DriveJobs".readList.r980'
    rows = [(at + 2, [f"{name}[{at}]", "DEC", str(plant.cpu[f"{name}[{at}]"])]) for at in range(300)]
    return read_own_list([[(1, ["Name", "Display format", "Monitor value"]), *rows]], Path("watch.csv"))


def test_a_drive_tells_its_parameters(generate, target) -> None:
    """A record of 240 bytes has 4 + 2 + 2 x 117: 300 elements are 117 (75h), 117 from 75h on, 66 (42h) from EAh on."""
    made = generate(SPEC, target)
    plant = Plant(made.plan, made.program).fresh()
    plant.waiting = []
    asked = [f"{ASK} 75 03 d4 00 00", f"{ASK} 75 03 d4 00 75", f"{ASK} 42 03 d4 00 ea"]
    assert run(plant, [*range(2, 300), 61000, 0]) == (0, asked)
    found = watched(plant)
    assert found is not None
    assert (sorted(found.lines), found.ended) == ([*range(2, 300), 61000], True)
    assert run(plant, [*range(2, 300), 998, 981]) == (0, asked)
    found = watched(plant)
    assert found is not None
    assert (found.continues, max(found.lines)) == (981, 998)


def test_a_drive_that_has_no_list(generate, target) -> None:
    """With fewer elements error 03h to the second telegram, without r980 00h to the first: nothing more is asked."""
    made = generate(SPEC, target)
    plant = Plant(made.plan, made.program).fresh()
    plant.waiting = []
    assert run(plant, [*range(2, 202)]) == (0x8401, [f"{ASK} 75 03 d4 00 00", f"{ASK} 75 03 d4 00 75"])
    assert [plant.cpu[f'"DriveJobs".readList.r980[{at}]'] for at in (0, 116, 117)] == [2, 118, 0]
    assert plant.cpu[ERROR] == 0x8003
    assert run(plant, None) == (0x8401, [f"{ASK} 75 03 d4 00 00"])
    assert plant.cpu[ERROR] == 0x8000
