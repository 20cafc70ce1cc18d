"""Restoring: which telegrams are sent, what comes back, what is left alone; by hand on the soft CPU."""

from __future__ import annotations

import struct
from collections.abc import Mapping

from plcgen.ds47.proof.plant import Plant
from plcgen.ds47.proof.scenario import DriveScenario, Event
from plcgen.ds47.sheet import review_sheet
from plcgen.ds47.sim.drive import Drive
from plcgen.ds47.sim.faults import Fault, FaultKind
from plcgen.ds47.sim.parameters import Keeps
from tests.ds47.proof.playing import job_of, status_of

SPEC = """
drives:
  axis:
    device: sinamics-s210
    ID: 270
    parameters:
      P2900: {type: Integer16}
      P2901: {type: "OctetString[3]"}
jobs:
  limits: {drive: axis, write: {P1121: 2.0, P2900: 7, P2901: "0A0B0C"}, verify: readback, on_error: restore}
  filter: {drive: axis, write: {P2900: 7}, verify: readback, on_error: {restore: running, reason: a test}}
"""
ASK = "01 02 04 10 01 04 61 00 00 10 01 0b 54 00 00 10 03 0b 55 00 00 10 01 03 83 00 00"
"""P1121 = 0461h, P2900 = 0B54h, P2901 = 0B55h with its three octets and r0899 = 0383h of drive object 2."""
WRITE = "02 02 03 10 01 04 61 00 00 10 01 0b 54 00 00 10 03 0b 55 00 00 08 01 40 00 00 00 03 01 00 07 0a 03 0a 0b 0c 00"
"""2.0 is 40000000h (IEEE 754); three octets and a pad."""
OLD = {1121: 1.5, 2900: -3, 2901: b"\x01\x02\x03"}
"""What the drive has: 1.5 is 3FC00000h, -3 is FFFDh."""
NEW = {1121: 2.0, 2900: 7, 2901: b"\x0a\x0b\x0c"}
DEVIATES, REFUSED, NOTHING = 0x8200, 0x8011, 0xFFFF
STOPPED = 0xF7FB
"""All bits of r0899 but 2 and 11."""


def values(plant: Plant) -> dict[int, object]:
    """What the drive has."""
    parameters = plant.units["axis"].objects[2].parameters
    return {pnu: parameters[pnu].values[0] for pnu in OLD}


def run(
    plant: Plant,
    key: str = "limits",
    *,
    state: int = STOPPED,
    faults: tuple[Fault, ...] = (),
    keeps: Mapping[int, Keeps] | None = None,
    events: Mapping[int, Event] | None = None,
) -> tuple[int, int]:
    """Run a job against a drive that has ``OLD``: status and cause."""
    scenario = DriveScenario(name="OB1", faults=faults, keeps=keeps or {}, events=events or {})
    plant.begin(scenario)
    parameters = plant.units["axis"].objects[2].parameters
    for pnu, value in {**OLD, 899: state}.items():
        parameters[pnu].values[0] = value
    job = job_of(plant, key)
    return status_of(plant, job), plant.cpu[f'"DriveJobs".{job.member}.cause']


def told(plant: Plant, key: str = "limits") -> list[int]:
    """``errors`` of the job."""
    job = job_of(plant, key)
    return [plant.cpu[f'"DriveJobs".{job.member}.diagnosis.errors[{n}]'] for n in range(1, len(job.uses) + 1)]


def sent(plant: Plant) -> list[str]:
    """Requests without their references."""
    return [one.data[1:].hex(" ") for one in plant.units["axis"].journal if one.direction == "write"]


def refuse(position: int, request: int) -> Fault:
    """The drive refuses a parameter of the n-th request that has so many."""
    return Fault(FaultKind.ERROR, after=request - 1, number=0x11, position=position, words=1)


def becomes(pnu: int, value: object) -> Event:
    """Somebody else writes a parameter."""

    def event(drive: Drive) -> None:
        drive.objects[2].parameters[pnu].values[0] = value  # type: ignore[call-overload]

    return event


def honest(drive: Drive) -> None:
    """The drive keeps what it is given from now on."""
    drive.objects[2].parameters[1121].keeps = None


LIMITED: Mapping[int, Keeps] = {1121: lambda _index, _value: 1.75}
"""1.75 is 3FE00000h."""


def test_a_job_has_a_word_for_a_drive_that_runs_only_if_that_matters(generate, target) -> None:
    """What restores while the drive runs, too, never ends with 8532, and has no constant for it."""
    made = generate(SPEC, target, sources="per_block")
    texts = {job.key: next(made.folder.rglob(f"{job.block.name}.scl")).read_bytes() for job in made.plan.jobs}
    assert {key: b"STATUS_RUNS" in text for key, text in texts.items()} == {"limits": True, "filter": False}


def test_what_is_right_is_left(plant: Plant) -> None:
    """Old values are asked for, three telegrams are sent; the old values are delivered."""
    assert run(plant) == (0, 0)
    assert sent(plant) == [ASK, WRITE, ASK]
    assert values(plant) == NEW
    assert told(plant) == [0] * 11
    path = '"DriveJobs".limits'
    assert struct.pack(">f", plant.cpu[f"{path}.p1121Before"]).hex() == "3fc00000"
    assert plant.cpu[f"{path}.p2900Before"] == -3
    assert plant.cpu[f"{path}.stateBefore"] == plant.cpu[f"{path}.stateBack"] == STOPPED


def test_one_is_refused(plant: Plant) -> None:
    """P2900 is refused: P1121 and P2901 were taken, and get their old values; P2900 is not sent once more."""
    assert run(plant, faults=(refuse(2, 2),)) == (0x8530, 0x8401)
    back = "02 02 02 10 01 04 61 00 00 10 03 0b 55 00 00 08 01 3f c0 00 00 0a 03 01 02 03 00"
    assert sent(plant) == [ASK, WRITE, ASK, ASK, back, ASK]
    assert values(plant) == OLD
    assert told(plant) == [0, 0, 0, 0, 0, REFUSED, 0, 0, DEVIATES, 0, 0]


def test_all_are_refused(plant: Plant) -> None:
    """Nothing was written, so that nothing is written back, whether the drive runs or not."""
    faults = (refuse(1, 2), refuse(2, 2), refuse(3, 2))
    for state in (STOPPED, 0xFFFF):
        assert run(plant, faults=faults, state=state) == (0x8530, 0x8401)
        assert sent(plant) == [ASK, WRITE, ASK, ASK]
        assert values(plant) == OLD


def test_a_drive_that_limits(plant: Plant) -> None:
    """It makes 1.75 of 2.0, and keeps what is written back: all three come back."""
    assert run(plant, keeps=LIMITED, events={5: honest}) == (0x8530, 0x8503)
    back = (
        "02 02 03 10 01 04 61 00 00 10 01 0b 54 00 00 10 03 0b 55 00 00 08 01 3f c0 00 00 03 01 ff fd 0a 03 01 02 03 00"
    )
    assert sent(plant)[4] == back
    assert values(plant) == OLD
    assert told(plant)[7] == DEVIATES


def test_a_drive_that_runs(plant: Plant) -> None:
    """Bit 2, bit 11 or both: what was taken stays, and errors say that it is not the old value."""
    for state in (0x0004, 0x0800, 0xFFFF):
        assert run(plant, faults=(refuse(2, 2),), state=state) == (0x8532, 0x8401), hex(state)
        assert sent(plant) == [ASK, WRITE, ASK, ASK]
        assert values(plant) == {**NEW, 2900: -3}
        assert told(plant)[:4] == [DEVIATES, 0, DEVIATES, 0]
    assert run(plant) == (0, 0)  # a job that is well does not ask whether it runs


def test_with_a_sign_off_it_is_not_asked(plant: Plant) -> None:
    """One parameter, restored while the drive runs: r0899 is in no telegram."""
    keeps: Mapping[int, Keeps] = {2900: lambda _index, value: 8 if value == 7 else value}
    assert run(plant, "filter", keeps=keeps, state=0xFFFF) == (0x8530, 0x8503)
    ask, write = "01 02 01 10 01 0b 54 00 00", "02 02 01 10 01 0b 54 00 00 03 01 00 07"
    assert sent(plant) == [ask, write, ask, ask, write.replace("00 07", "ff fd"), ask]
    assert values(plant) == OLD


def test_somebody_else(plant: Plant) -> None:
    """What is changed between telegrams 3 and 4 is left, and what nobody has changed is restored."""
    events = {4: becomes(2901, b"abc")}
    assert run(plant, faults=(refuse(2, 2),), events=events) == (0x8533, 0x8401)
    assert sent(plant)[4] == "02 02 01 10 01 04 61 00 00 08 01 3f c0 00 00"
    assert values(plant) == {**OLD, 2901: b"abc"}
    assert told(plant)[:4] == [0, 0, DEVIATES, 0]
    # a parameter that was refused is none of the job's, whoever has changed it
    assert run(plant, faults=(refuse(2, 2),), events={3: becomes(2900, 99)}) == (0x8533, 0x8401)
    assert values(plant) == {**OLD, 2900: 99}
    # behind telegram 4 it is overwritten, as DPV1 has no write that looks first
    assert run(plant, faults=(refuse(2, 2),), events={5: becomes(2901, b"abc")}) == (0x8530, 0x8401)
    # behind telegram 5 it is found
    assert run(plant, faults=(refuse(2, 2),), events={6: becomes(2901, b"abc")}) == (0x8531, 0x8401)
    assert told(plant)[:4] == [0, 0, DEVIATES, 0]


def test_restoring_fails(plant: Plant) -> None:
    """The drive does not take the old value, or goes on limiting; before the write there is nothing to restore."""
    assert run(plant, keeps=LIMITED) == (0x8531, 0x8503)
    assert values(plant) == {**OLD, 1121: 1.75}
    assert told(plant)[:4] == [DEVIATES, 0, 0, 0]
    # the first parameter is refused in telegram 5, the fourth request behind the first that has it
    assert run(plant, keeps=LIMITED, faults=(refuse(1, 5),)) == (0x8531, 0x8503)
    assert len(sent(plant)) == 5
    # telegram 4 is refused: nothing is known
    assert run(plant, keeps=LIMITED, faults=(refuse(1, 4),)) == (0x8531, 0x8503)
    assert told(plant)[:4] == [NOTHING, NOTHING, NOTHING, 0]
    assert run(plant, faults=(refuse(1, 1),)) == (0x8401, 0x8401)
    assert sent(plant) == [ASK]
    assert run(plant) == (0, 0)


def test_what_papers_say(generate) -> None:
    """IMPORT.md and the review say that old values come back, and under which condition."""
    made = generate(SPEC, "v5")
    text = (made.folder / "IMPORT.md").read_text("utf-8")
    assert text.count("restored if the job fails and the drive does not run") == 3
    assert text.count("restored while the drive runs, too; signed off: a test") == 1
    memory = [entry.memory for entry in review_sheet(made.plan).writes]
    limits, filter_ = ("the old value comes back if the job fails, while " + what for what in ("the drive", "it runs"))
    assert [limits in text for text in memory] == [True, True, True, False]
    assert [filter_ in text for text in memory] == [False, False, False, True]
