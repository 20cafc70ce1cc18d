"""Write, read back, save or restore in one job: what is sent, what the drive keeps, what one status says; by hand."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from plcgen import api
from plcgen.ds47.proof.plant import Plant
from plcgen.ds47.proof.scenario import DriveScenario
from plcgen.ds47.sheet import review_sheet
from plcgen.ds47.sim.faults import Fault, FaultKind
from tests.ds47.proof.playing import ended, job_of, status_of

SPEC = """
drives:
  axis: {device: sinamics-s210, ID: 270, parameters: {P2900: {type: Integer16}}}
jobs:
  limits:
    drive: axis
    write: {P1121: 2.0, P2900: 7}
    verify: readback
    save: {persist: unit, limit: 2s, interval: 200ms}
    on_error: restore
"""
ASK = "01 02 03 10 01 04 61 00 00 10 01 0b 54 00 00 10 01 03 83 00 00"
"""P1121 = 0461h, P2900 = 0B54h and r0899 = 0383h of drive object 2."""
WRITE = "02 02 02 10 01 04 61 00 00 10 01 0b 54 00 00 08 01 40 00 00 00 03 01 00 07"
"""2.0 is 40000000h (IEEE 754), a FloatingPoint (08); 7 is an Integer16 (03)."""
BACK = "02 02 02 10 01 04 61 00 00 10 01 0b 54 00 00 08 01 3f c0 00 00 03 01 ff fd"
"""1.5 is 3FC00000h, -3 is FFFDh."""
SAVE, SAVED = "02 02 01 10 01 03 d1 00 00 06 01 00 01", "01 02 01 10 01 03 d1 00 00"
"""p0977 = 03D1h, an Unsigned16 (06): set to 1, asked for."""
OLD: dict[int, Any] = {1121: 1.5, 2900: -3}
NEW: dict[int, Any] = {1121: 2.0, 2900: 7}
GOOD, REFUSED, NOTHING, DEVIATES = 0, 0x8011, 0xFFFF, 0x8200
STOPPED = 0xF7FB
"""All bits of r0899 but 2 and 11."""


def run(plant: Plant, *, state: int = STOPPED, **how: Any) -> tuple[int, int]:
    """Run the job against a drive that has ``OLD``: status and cause."""
    plant.begin(DriveScenario(name="OB1", **how))
    parameters = plant.units["axis"].objects[2].parameters
    for pnu, value in {**OLD, 899: state}.items():
        parameters[pnu].values[0] = value
    return status_of(plant, job_of(plant, "limits"), 1000), cause(plant)


def cause(plant: Plant) -> int:
    """Why the job has failed."""
    return plant.cpu['"DriveJobs".limits.cause']


def sent(plant: Plant) -> list[str]:
    """Requests without their references."""
    return [one.data[1:].hex(" ") for one in plant.units["axis"].journal if one.direction == "write"]


def values(plant: Plant) -> dict[int, Any]:
    """What the drive has in its RAM."""
    parameters = plant.units["axis"].objects[2].parameters
    return {pnu: parameters[pnu].values[0] for pnu in OLD}


def saved(plant: Plant) -> bool:
    """Whether the simulated drive has saved in this run."""
    return plant.units["axis"].objects[2].parameters[977].saved == (0,)


def told(plant: Plant) -> list[int]:
    """``errors``: old values and r0899, writes, read back and r0899, the save, the question."""
    return [plant.cpu[f'"DriveJobs".limits.diagnosis.errors[{n}]'] for n in range(1, 11)]


def refuse(position: int, request: int) -> Fault:
    """The drive refuses a parameter of the n-th request that has so many."""
    return Fault(FaultKind.ERROR, after=request - 1, number=0x11, position=position, words=1)


def test_what_is_right_is_saved(plant: Plant) -> None:
    """The drive saves for half a second: three questions, 200 ms apart; done means saved."""
    assert run(plant, saving=500) == (0, 0)
    assert sent(plant) == [ASK, WRITE, ASK, SAVE, SAVED, SAVED, SAVED]
    assert values(plant) == NEW
    assert saved(plant)
    assert told(plant) == [GOOD] * 10
    assert plant.cpu['"DriveCalls_DB".limits.saves'] == 1


def test_what_deviates_is_restored_and_not_saved(plant: Plant) -> None:
    """The drive limits P2900 until it is written back; the next start may be at once."""
    keeps = {2900: lambda _, value: 6 if value == 7 else value}
    assert run(plant, keeps=keeps) == (0x8530, 0x8503)
    assert sent(plant)[:4] == [ASK, WRITE, ASK, ASK]
    assert sent(plant)[4:] == [BACK, ASK]
    assert values(plant) == OLD
    assert not saved(plant)
    assert told(plant) == [GOOD] * 6 + [DEVIATES, GOOD, NOTHING, NOTHING]
    assert plant.cpu['"DriveCalls_DB".limits.statRest'] == 0


@pytest.mark.parametrize(
    ("state", "how", "status", "has"),
    [
        (STOPPED, {"faults": (refuse(2, 2),)}, (0x8530, 0x8401), OLD),
        (0x0804, {"faults": (refuse(2, 2),)}, (0x8532, 0x8401), {**OLD, 1121: 2.0}),
        (STOPPED, {"writes": {2: 0xDF80B000}}, (0x8530, 0x8201), OLD),
        (STOPPED, {"reads": {3: 0xDE80B000}}, (0x8530, 0x8202), OLD),
        (STOPPED, {"faults": (refuse(1, 1),)}, (0x8401, 0x8401), OLD),
    ],
)
def test_nothing_is_saved_that_is_not_right(plant: Plant, state: int, how: Any, status: Any, has: Any) -> None:
    """The write is refused, or gets lost, or cannot be read back; the old values cannot be read."""
    assert run(plant, state=state, **how) == status
    assert values(plant) == has
    assert SAVE not in sent(plant)
    assert not saved(plant)


def test_what_is_right_stays_if_it_cannot_be_saved(plant: Plant) -> None:
    """One status, nothing is written back; the cause tells whether the drive refuses, goes on, or is silent."""
    for how, why in (
        ({"faults": (Fault(FaultKind.ERROR, after=3, number=0x11, position=1, words=1),)}, 0x8401),
        ({"saving": 10_000}, 0x8501),
        ({"reads": {4: 0xDE80A000}}, 0x8205),  # the answer to the save is lost: it is not sent again
        ({"reads": {5: 0xDE80B000}}, 0x8202),
    ):
        assert run(plant, **how) == (0x8501, why), hex(why)
        assert sent(plant)[:4] == [ASK, WRITE, ASK, SAVE]
        assert set(sent(plant)[4:]) <= {SAVED}
        assert values(plant) == NEW
        assert told(plant)[:8] == [GOOD] * 8
    assert run(plant, saving=100) == (0, 0)


def test_too_soon(plant: Plant) -> None:
    """Ten minutes must pass from one save to the next: else nothing is sent at all."""
    job = job_of(plant, "limits")
    assert run(plant) == (0, 0)
    rest = plant.cpu['"DriveCalls_DB".limits.statRest']
    plant.execute(job, value=False)
    plant.step()
    plant.cpu['"DriveCalls_DB".limits.statRest'] = rest
    plant.begin(DriveScenario(name="OB1"))
    plant.cpu['"DriveJobs".limits.execute'] = True
    plant.step()
    assert plant.result(job) == (True, 0x8502)
    assert cause(plant) == 0x8502
    assert sent(plant) == []
    plant.execute(job, value=False)
    plant.step()
    assert ended(plant, job, 1000) == 0
    assert cause(plant) == 0


def test_what_papers_say(generate) -> None:
    """Old values come back, the save does not; the title says all."""
    made = generate(SPEC, "v5")
    rows = [line for line in (made.folder / "IMPORT.md").read_text("utf-8").splitlines() if line.startswith("| Limits")]
    assert ["restored if the job fails" in row for row in rows] == [True, True, False]
    memory = [entry.memory for entry in review_sheet(made.plan).writes]
    assert ["the old value comes back" in text for text in memory] == [True, True, False]
    assert "Write and read back P1121, P2900, then save, or restore" in (made.folder / "LAYOUT.md").read_text("utf-8")
    assert made.job("limits").timeout == 2 * 10_000 + 2_000 + 200


KINDS = """
plc: {name: Kinds, family: s7-1500, toolchain: tia-v19}
drives:
  axis:
    device: sinamics-s120
    hardware_id: 281
    object_type: other
    parameters: {P3121: {type: Unsigned16, min: 0, max: 15}}
recipes: {spool: {parameters: [P1120, P1121], records: 2}}
jobs:
  bits:
    drive: axis
    write: {P3121.0: null, P3121.2: 1}
    verify: readback
    on_error: {restore: running, reason: a test}
    save: {persist: drive_object, limit: 1s, interval: 200ms}
  load:
    drive: axis
    write_recipe: spool
    verify: readback
    on_error: restore
    save: {persist: unit, limit: 2s, interval: 200ms}
"""


@pytest.mark.slow
def test_bits_and_recipes_too(tmp_path: Path) -> None:
    """Every fault in every phase; a word beyond its limits, as a drive may keep one, is written back as it was."""
    (tmp_path / "job.yaml").write_text(KINDS, "utf-8")
    assert api.generate(tmp_path / "job.yaml", tmp_path / "out").ok
    result = api.verify(tmp_path / "job.yaml", tmp_path / "out")
    assert [f"{c.subject}: {c.verdict}" for c in result.checks() if c.outcome.value in {"error", "warning"}] == []
