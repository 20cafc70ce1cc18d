"""Activating: what a drive is told and asked, and what is said when it does not follow; by hand."""

from __future__ import annotations

import pytest

from plcgen.ds47.proof.plant import Plant
from plcgen.ds47.proof.scenario import DriveScenario
from plcgen.ds47.sim.faults import Fault, FaultKind

SPEC = """
drives: {axis: {device: sinamics-s120, ID: 281, drive_object: 3}}
jobs:
  on: {drive: axis, activate: {state: true, limit: 2s, interval: 1s}}
  off: {drive: axis, activate: not_present}
  told: {drive: axis, activate: {state: input, limit: 2s, interval: 1s}}
"""
WRITE = "02 03 01 10 01 00 69 00 00 03 01 00 0"
ASK = "01 03 01 10 01 00 6a 00 00"
"""p0105 = 0069h of drive object 3 as Integer16: its last digit is missing here; r0106 = 006Ah."""
SECOND = 100
"""Scans of 10 ms."""


def run(
    plant: Plant, key: str, inactive: int, faults: tuple[Fault, ...] = (), state: int | None = None
) -> tuple[list[str], int, list[object]]:
    """r0106 has the other value for so many scans: requests, status, active, failedStep and failedParameter."""
    active = key == "on" if state is None else state == 1
    plant.begin(DriveScenario(name="OB1", faults=faults), delivered=True)
    job = next(job for job in plant.plan.jobs if job.key == key)
    values = plant.units["axis"].objects[3].parameters[106].values
    if state is not None:
        plant.cpu['"DriveJobs".told.state'] = state
    plant.execute(job)
    for scan in range(1, 10 * SECOND):
        values[:] = [int(active == (scan > inactive))]
        plant.step()
        over, status = plant.result(job)
        if over:
            said = [plant.cpu[f'"DriveJobs".{key}.{name}'] for name in ("active", "failedStep", "failedParameter")]
            plant.fall()
            journal = plant.units["axis"].journal
            return [x.data[1:].hex(" ") for x in journal if x.direction == "write" and not x.status], status, said
    raise AssertionError("it has not ended")


def test_it_is_told_once_and_asked_until_it_follows(generate, target) -> None:
    """Asked at 0 s, 1 s, at the limit 2 s; 2 is not present, of which r0106 says 0."""
    made = generate(SPEC, target)
    plant = Plant(made.plan, made.program).fresh()
    plant.units["axis"].asked = None
    assert run(plant, "on", 50) == ([WRITE + "1", ASK, ASK], 0, [1, 0, 0])
    assert run(plant, "off", 50) == ([WRITE + "2", ASK, ASK], 0, [0, 0, 0])
    assert run(plant, "on", 1000) == ([WRITE + "1", ASK, ASK, ASK], 0x8510, [0, 2, 106])
    refused = Fault(FaultKind.ERROR, after=0, number=0x11, position=1, words=1)
    assert run(plant, "on", 0, (refused,)) == ([WRITE + "1"], 0x8401, [0, 1, 105])


def test_what_it_is_told_comes_from_an_input(generate, target) -> None:
    """1 waits for 1, 0 and 2 for 0, which is what r0106 says of both; 3 is beyond the limit of p0105, error 02h."""
    made = generate(SPEC, target)
    plant = Plant(made.plan, made.program).fresh()
    plant.units["axis"].asked = None
    for state, active in ((0, 0), (1, 1), (2, 0)):
        assert run(plant, "told", 50, state=state) == ([f"{WRITE}{state}", ASK, ASK], 0, [active, 0, 0])
    assert run(plant, "told", 1000, state=2) == ([WRITE + "2", ASK, ASK, ASK], 0x8510, [1, 2, 106])
    assert run(plant, "told", 50, state=3) == ([WRITE + "3"], 0x8401, [1, 1, 105])


@pytest.mark.parametrize(("state", "value"), [("true", 1), ("false", 0), ("not_present", 2), ("input", 1)])
def test_what_it_writes_stands_in_import_md(generate, state: str, value: int) -> None:
    """The sign-off is the key, and who brings the blocks into the project reads it."""
    made = generate(
        f"drives: {{a: {{device: sinamics-s120, ID: 281}}}}\njobs: {{j: {{drive: a, activate: {state}}}}}\n", "t15"
    )
    line = next(x for x in (made.folder / "IMPORT.md").read_text("utf-8").splitlines() if "P105" in x)
    shown = f"input, {value} if nothing is connected" if state == "input" else value
    assert f"| {shown} |" in line
    assert f"the job says activate: {state}" in line
