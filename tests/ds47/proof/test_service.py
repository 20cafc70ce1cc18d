"""A service job: what goes out for the inputs, what comes of the answer, what is refused; by hand, on every target."""

from __future__ import annotations

from pathlib import Path

import pytest

from plcgen import api
from plcgen.ds47.proof.plant import Plant
from plcgen.ds47.sim.parameters import SimulatedParameter
from plcgen.ds47.wire.formats import by_name
from tests.ds47.proof.playing import job_of, noticed, sent, status_of, told_of

SPEC = """
units:
  drive:
    device: sinamics-s120
    drives: {left: {ID: 281, drive_object: 3}, right: {ID: 281, drive_object: 4}}
jobs:
  ask: {drive: [left, right], service: read}
  look: {drive: right, read: [r63]}
"""
WORDS = {"number": 4, "index": 4, "count": 2, "axis": 2}


def started(plant: Plant, name: str, **inputs: int) -> tuple[int, list[str]]:
    """Status, and the requests behind their references."""
    job = job_of(plant, name)
    plant.begin(delivered=True)
    for key, number in inputs.items():
        plant.control(job).put(f"{job.member}.{key}", number.to_bytes(WORDS[key], signed=number < 0))
    status = status_of(plant, job)
    return status, sent(plant)


def test_what_is_asked_and_what_comes(generate, target) -> None:
    """r2090 = 082Ah of drive object 4: -1.5 is BF C0 00 00; 7, 8, 9 of r945 = 03B1h from index 2 on are three words."""
    made = generate(SPEC, target)
    plant = Plant(made.plan, made.program).fresh()
    parameters = plant.units["drive"].objects[4].parameters
    parameters[2090] = SimulatedParameter(2090, by_name("FloatingPoint"), [-1.5])
    parameters[945] = SimulatedParameter(945, by_name("Unsigned16"), [1, 2, 7, 8, 9], array=True)
    shown = '"DriveJobs".askLeft.value'
    assert started(plant, "ask.left", number=2090, axis=4) == (0, ["01 04 01 10 01 08 2a 00 00"])
    assert bytes(plant.cpu[shown]).hex() == "bfc0000000000000"
    assert (plant.cpu[f"{shown}Format"], plant.cpu[f"{shown}Real"], plant.cpu[f"{shown}Dword"]) == (8, -1.5, 0xBFC00000)
    found = started(plant, "ask.left", number=945, index=2, count=3, axis=4)
    assert found == (0, ["01 04 01 10 03 03 b1 00 02"])
    assert bytes(plant.cpu[shown]).hex() == "0007000800090000"
    assert (plant.cpu[f"{shown}Format"], plant.cpu[f"{shown}Dint"], plant.cpu[f"{shown}Real"]) == (6, 7, 7.0)


def test_errors_and_what_does_not_fit(generate, target) -> None:
    """The drive has no r1 (00h); five words are 10 bytes; beyond the ranges nothing is sent, and the value stays."""
    made = generate(SPEC, target)
    plant = Plant(made.plan, made.program).fresh()
    parameters = plant.units["drive"].objects[3].parameters
    parameters[945] = SimulatedParameter(945, by_name("Unsigned16"), [1, 2, 7, 8, 9], array=True)
    assert started(plant, "ask.left", number=945, axis=-1)[0] == 0
    assert started(plant, "ask.left", number=1) == (0x8401, ["01 03 01 10 01 00 01 00 00"])
    assert list(plant.cpu['"DriveJobs".askLeft.value'])[:2] == [0, 1]
    assert started(plant, "ask.left", number=945, count=5)[0] == 0x8305
    for inputs in ({"number": 0}, {"number": 65536}, {"index": -1}, {"count": 9}, {"axis": 256}, {"axis": -2}):
        right = {"number": 945, "index": 0, "count": 1, "axis": -1}
        assert started(plant, "ask.left", **{**right, **inputs}) == (0x8550, []), inputs


def test_instances_are_their_own(generate, target) -> None:
    """One block for two drives, beside a job of the program: at first both ask for r964[0] = 03C4h of their own."""
    made = generate(SPEC, target)
    plant = Plant(made.plan, made.program).fresh()
    assert started(plant, "ask.right")[1] == ["01 04 01 10 01 03 c4 00 00"]
    assert started(plant, "ask.left")[1] == ["01 03 01 10 01 03 c4 00 00"]
    assert started(plant, "look")[1] == ["01 04 01 10 01 00 3f 00 00"]


@pytest.mark.parametrize("device", ["sinamics-g130", "sinamics-g150", "sinamics-s150"])
def test_an_object_without_the_first_number_is_no_fault(device: str, tmp_path: Path) -> None:
    """The list of the drive objects of these lacks r964: the drive answers 00h to the start values, which is right."""
    spec = tmp_path / "job.yaml"
    spec.write_text(
        f"""plc: {{name: Plant, family: s7-300, toolchain: tia-v15.1}}
drives: {{a: {{device: {device}, address: 256, drive_object: 3}}}}
jobs: {{look: {{drive: a, service: read}}}}
""",
        "utf-8",
    )
    assert api.generate(spec, tmp_path / "out").ok
    result = api.verify(spec, tmp_path / "out", faults="none")
    assert not result.problems
    assert any("error 00h" in one.verdict for one in result.checks())


DAMAGE = {
    "no range": ("#number > L#65535", "#number > L#75535"),
    "negative counts": ("#count < 0", "#count < -1"),
    "more than there is room for": ("#count > 8", "#count > 9"),
    "an index of another byte": ("DINT_TO_DWORD(#index), N := 8", "DINT_TO_DWORD(#index), N := 7"),
    "always the drive of the spec": ("IF #statAxis >= 0 THEN", "IF FALSE THEN"),
    "axis 0": ("IF #statAxis >= 0 THEN", "IF #statAxis > 0 THEN"),
    "always one value": ("IF #tempCount > 1 THEN #unit", "IF FALSE THEN #unit"),
    "two are one": ("IF #tempCount > 1 THEN #unit", "IF #tempCount > 2 THEN #unit"),
    "the first value alone": ("TO #tempSize * #tempCount - 1 DO", "TO #tempSize - 1 DO"),
    "bits of another value": ("#valueDword := #tempNumber;", ";"),
    "refused for ever": ("  IF NOT #execute THEN\n    #statRefusal := W#16#0000;", "  IF NOT #execute THEN\n    ;"),
    "sent although refused": ("#execute AND #statRefusal = W#16#0000", "#execute"),
    "not latched": ("#statAxis := #axis;", "#statAxis := -1;"),
}


@pytest.mark.slow
@pytest.mark.parametrize("damage", DAMAGE)
def test_damage_is_noticed(damage: str, tmp_path: Path) -> None:
    """One change of a source, and verify is red."""
    found = noticed(
        tmp_path,
        """plc: {name: Plant, family: s7-1500, toolchain: tia-v19}
drives: {a: {device: sinamics-v90, hardware_id: 270}}
jobs: {look: {drive: a, service: read}}
""",
        *DAMAGE[damage],
    )
    assert told_of("look", found)
