"""Recipes: what is sent of which record, what is refused, what a record gets; by hand on the soft CPU."""

from __future__ import annotations

import struct
from pathlib import Path

import pytest

from plcgen import api
from plcgen.ds47.plan.nouns import DrivePlan
from plcgen.ds47.proof.plant import Plant
from plcgen.ds47.proof.scenario import DriveScenario
from plcgen.ds47.sim.faults import Fault, FaultKind
from plcgen.proof.rig import Members
from tests.ds47.proof.playing import ended, job_of, sent
from tests.projects import per_block

SPEC = """
drives:
  fan:
    device: sinamics-g120
    ID: 270
    parameters:
      P2900: {type: Integer16, name: steps, array: 8, min: -5, max: 200}
      P2901: {type: Unsigned16, name: ratio, max: 40000}
      P2902: {type: Unsigned32, name: pulses, min: 3, max: 4000000000}
      P2903: {type: Integer8, name: small, min: -3}
      P2904: {type: Boolean, name: release}
      P2905: {type: FloatingPoint, name: ramp, min: 0.5, max: 60.0}
      P2906: {type: FloatingPoint, name: free}
      P3000: {type: FloatingPoint, name: table, array: 100, max: 100.0}
recipes:
  product:
    parameters: ["P2900[2..3]", P2901, P2902, P2903, P2904, P2905, P2906]
    records:
      first: {steps: [1, 2], ramp: 5.0}
      second: {"P2900[2..3]": 7, release: true, P2902: 4000000000, small: -3}
      third: {}
  long: {parameters: ["P3000[0..99]", {parameter: P2905, as: last, start: 1.0}], records: 4}
jobs:
  load: {drive: fan, write_recipe: product}
  store: {drive: fan, read_recipe: product}
  check: {drive: fan, compare_recipe: product}
  load_long: {drive: fan, write_recipe: long, verify: readback}
  store_long: {drive: fan, read_recipe: long}
"""
NO_RECORD, OUTSIDE = 0x8540, 0x8541
NAN, INFINITY = "7FC00000", "7F800000"


def records(plant: Plant, name: str, *paths: str) -> Members:
    """Members of the records of a recipe."""
    return Members(plant.cpu, plant.program, name, [f"records{path}" for path in paths], "records")


def begin(plant: Plant, faults: tuple[Fault, ...] = ()) -> None:
    """All inputs and records as delivered."""
    plant.begin(DriveScenario(name="OB1", faults=faults), delivered=True)


def run(plant: Plant, key: str, number: int) -> int:
    """Run a job with a record; its status."""
    job = job_of(plant, key)
    for drive in plant.units.values():
        drive.journal.clear()
    plant.execute(job, value=False)
    plant.step()
    plant.cpu[f'"DriveJobs".{job.member}.recordNumber'] = number
    return ended(plant, job)


def failed(plant: Plant, key: str) -> tuple[object, object]:
    """Which parameter is outside, and its index."""
    path = f'"DriveJobs".{job_of(plant, key).member}'
    return plant.cpu[f"{path}.failedParameter"], plant.cpu[f"{path}.failedIndex"]


HEADS = (
    "10 02 0b 54 00 02 10 01 0b 55 00 00 10 01 0b 56 00 00 10 01 0b 57 00 00 10 01 0b 58 00 00 10 01 0b 59 00 00 "
    "10 01 0b 5a 00 00"
)
"""P2900[2..3] = 0B54h with two elements from index 2, then P2901 to P2906."""
FIRST = "03 02 00 01 00 02 06 01 00 00 07 01 00 00 00 03 02 01 00 00 01 01 00 00 08 01 40 a0 00 00 08 01 00 00 00 00"
"""1, 2; 0; 3, the least that P2902 may have; 0; FALSE; 5.0 = 40A00000h; 0.0. Integer8 and Boolean have a pad."""
SECOND = "03 02 00 07 00 07 06 01 00 00 07 01 ee 6b 28 00 02 01 fd 00 01 01 01 00 08 01 3f 00 00 00 08 01 00 00 00 00"
"""7, 7; 0; 4 000 000 000 = EE6B2800h; -3 = FDh; TRUE; 0.5 = 3F000000h, the least that P2905 may have; 0.0."""


def test_the_record_with_the_number_is_sent(plant: Plant) -> None:
    """One telegram: 02h changes, drive object 1, seven parameters; none for a number that no record has."""
    begin(plant)
    assert run(plant, "load", 1) == 0
    assert sent(plant) == [f"02 01 07 {HEADS} {FIRST}"]
    assert run(plant, "load", 2) == 0
    assert sent(plant) == [f"02 01 07 {HEADS} {SECOND}"]
    for number in (0, -1, 4, 32767, -32768):
        assert run(plant, "load", number) == NO_RECORD
        assert run(plant, "store", number) == NO_RECORD
        assert run(plant, "check", number) == NO_RECORD
        assert sent(plant) == []
    assert run(plant, "load", 3) == 0


OUT = (
    (".steps[3]", "00C9", 2900, 3),  # 201
    (".steps[2]", "FFFA", 2900, 2),  # -6
    (".steps[2]", "8000", 2900, 2),  # -32768
    (".ratio", "9C41", 2901, 0),  # 40001
    (".ratio", "FFFF", 2901, 0),
    (".pulses", "00000002", 2902, 0),
    (".pulses", "EE6B2801", 2902, 0),  # 4 000 000 001
    (".pulses", "FFFFFFFF", 2902, 0),
    (".small", "FC", 2903, 0),  # -4
    (".small", "80", 2903, 0),  # -128
    (".ramp", "3EFFFFFF", 2905, 0),  # the number below 0.5
    (".ramp", "42700001", 2905, 0),  # the number above 60.0
    (".ramp", NAN, 2905, 0),
    (".ramp", "FF800000", 2905, 0),
    (".free", NAN, 2906, 0),
    (".free", "FFC00001", 2906, 0),
    (".free", INFINITY, 2906, 0),
)
"""What is outside, next to its limits and far from them, with parameter and index."""
WITHIN = {".steps[3]": "00C8", ".steps[2]": "FFFB", ".ratio": "9C40", ".pulses": "EE6B2800", ".small": "FD",
          ".ramp": "42700000", ".free": "FF7FFFFF"}  # fmt: skip
"""200, -5, 40 000, 4 000 000 000, -3, 60.0, the least number of all."""


def test_a_value_outside_is_not_sent(plant: Plant) -> None:
    """Nor is any other; the first one of the record is named, and the next start with good values works."""
    begin(plant)
    db = records(plant, "RecipeProduct", *(f"[3]{path}" for path in WITHIN))
    for path, data in WITHIN.items():
        db.put(f"[3]{path}", bytes.fromhex(data))
    assert run(plant, "load", 3) == 0
    for path, data, number, index in OUT:
        good = db.bytes(f"[3]{path}")
        db.put(f"[3]{path}", bytes.fromhex(data))
        assert (run(plant, "load", 3), failed(plant, "load"), sent(plant)) == (OUTSIDE, (number, index), []), path
        db.put(f"[3]{path}", good)
    for path in (".steps[2]", ".steps[3]", ".pulses"):
        db.put(f"[3]{path}", bytes(2 if "steps" in path else 4))
    db.put("[3].steps[2]", bytes.fromhex("7FFF"))
    assert (run(plant, "load", 3), failed(plant, "load")) == (OUTSIDE, (2900, 2))
    assert (run(plant, "load", 9), failed(plant, "load")) == (NO_RECORD, (0, 0))
    assert (run(plant, "load", 1), failed(plant, "load")) == (0, (0, 0))


def test_what_is_sent_is_what_was_checked(plant: Plant) -> None:
    """The record and its number change in the call behind the start."""
    begin(plant)
    load = job_of(plant, "load")
    plant.execute(load, value=False)
    plant.step()
    plant.cpu['"DriveJobs".load.recordNumber'] = 1
    plant.execute(load)
    plant.step()
    plant.cpu['"DriveJobs".load.recordNumber'] = 2
    db = records(plant, "RecipeProduct", "[1].ramp")
    db.put("[1].ramp", bytes.fromhex(NAN))
    plant.step(40)
    assert plant.result(load) == (True, 0)
    assert sent(plant) == [f"02 01 07 {HEADS} {FIRST}"]


def test_a_record_gets_all_values_or_none(plant: Plant) -> None:
    """Two telegrams, the second one refused: the record is as it was. Then it has what the drive has, no other has."""
    paths = [f"[{record}].{name}" for record in (1, 2, 3, 4) for name in ("p3000[0]", "last")]
    names = [path.replace("p3000", "table") for path in paths]
    begin(plant, (Fault(FaultKind.ERROR, after=1, number=0x11, position=1, words=1),))
    db = records(plant, "RecipeLong", *names)
    before = [db.bytes(name) for name in names]
    drive = plant.units["fan"].objects[1].parameters
    drive[3000].values[:] = [2.5] * 100
    drive[2905].values[:] = [77.0]
    assert run(plant, "store_long", 2) == 0x8401
    assert len(sent(plant)) == 2
    assert [db.bytes(name) for name in names] == before
    begin(plant)
    drive[3000].values[:] = [2.5] * 100
    drive[2905].values[:] = [77.0]
    assert run(plant, "store_long", 2) == 0
    before[2:4] = [struct.pack(">f", 2.5), struct.pack(">f", 77.0)]
    assert [db.bytes(name) for name in names] == before
    assert (run(plant, "load_long", 2), failed(plant, "load_long")) == (OUTSIDE, (2905, 0))  # 77 is more than 60
    db.put("[2].last", struct.pack(">f", 60.0))
    assert run(plant, "load_long", 2) == 0
    assert drive[2905].values == [60.0]


def test_a_record_is_compared(plant: Plant) -> None:
    """After the second record was written the first one deviates in 7 values; a limit decides nothing."""
    begin(plant)
    assert (run(plant, "load", 2), run(plant, "check", 2)) == (0, 0)
    assert plant.cpu['"DriveJobs".check.equal'] is True
    assert run(plant, "check", 1) == 0
    path = '"DriveJobs".check'
    shown = [tuple(plant.cpu[f"{path}.deviations[{n}].{m}"] for m in ("parameter", "index")) for n in range(1, 8)]
    assert shown == [(2900, 2), (2900, 3), (2902, 0), (2903, 0), (2904, 0), (2905, 0), (0, 0)]
    db = records(plant, "RecipeProduct", "[1].ramp")
    db.put("[1].ramp", bytes.fromhex(NAN))
    assert run(plant, "check", 1) == 0


HEAD = "plc: {name: a, family: s7-1500, toolchain: tia-v19}\ndrives: {d: {device: sinamics-g120, hardware_id: 270}}\n"
SHORT = f"""{HEAD}recipes: {{r: {{parameters: [P1120], records: {{one: {{P1120: 4.0}}, two: {{}}}}, retain: RETAIN}}}}
jobs: {{j: {{drive: d, write_recipe: r}}, k: {{drive: d, read_recipe: r}}}}
"""


@pytest.mark.parametrize("retain", ["true", "false"])
def test_what_keeps_its_values(retain: str, tmp_path: Path) -> None:
    """The data block of the recipe is retentive, if it is not told otherwise; verify notices the other."""
    path = tmp_path / "job.yaml"
    path.write_text(per_block(SHORT.replace("RETAIN", retain)), "utf-8")
    assert api.generate(path, tmp_path / "out").ok
    source, document = tmp_path / "out" / "db" / "RecipeR.db", tmp_path / "out" / "xml" / "RecipeR.xml"
    text = source.read_text("utf-8-sig")
    assert ("NON_RETAIN" in text) == (retain == "false")
    assert ('Remanence="Retain"' in document.read_text("utf-8-sig")) == (retain == "true")
    other = (
        text.replace("NON_RETAIN\n", "") if retain == "false" else text.replace("  STRUCT\n", "NON_RETAIN\n  STRUCT\n")
    )
    source.write_text(other, "utf-8-sig")
    found = api.verify(path, tmp_path / "out", faults="none").checks()
    assert "PG614" in [check.diagnostic.code for check in found if check.diagnostic is not None]


@pytest.mark.slow
def test_own_drive_and_simulate(tmp_path: Path) -> None:
    """The drive gets 4.0 s from the first record, with which the input begins; it gives P1120 = 9.0."""
    path, drive = tmp_path / "job.yaml", tmp_path / "drive.yaml"
    path.write_text(SHORT.replace("RETAIN", "true"), "utf-8")
    assert api.generate(path, tmp_path / "out").ok
    drive.write_text("objects: [{number: 1, parameters: [{pnu: 1120, type: FloatingPoint, value: 9.0}]}]", "utf-8")
    result = api.verify(path, tmp_path / "out", faults="none", drive=drive)
    assert {c.id: c.verdict for c in result.checks() if c.id.startswith("own.")} == {
        "own.j": "ok, values agree",
        "own.k": "ok, values agree",
    }
    first, second = api.simulate(path, tmp_path / "out", drives=[str(drive)]).jobs
    assert [(job.status, [value.value for value in job.values]) for job in (first, second)] == [(0, [4.0]), (0, [4.0])]
    (alone,) = api.simulate(path, tmp_path / "out", drives=[str(drive)], jobs=["k"]).jobs
    assert [value.value for value in alone.values] == [9.0]
    assert "record of RecipeR" in (tmp_path / "out" / "IMPORT.md").read_text("utf-8")
    assert api.check(path).project.plan(DrivePlan).recipes[0].count == 2


@pytest.mark.parametrize(
    ("parameters", "zeros"), [('["P2900[2..3]", P2905]', 1), ('[P2905, "P2900[2..3]"]', 2), ("[P2905, P2902]", 1)]
)
def test_an_index_is_taken_back_where_one_may_stand(parameters: str, zeros: int, tmp_path: Path) -> None:
    """Values are looked at from the last to the first: only an array that is behind in the record leaves an index."""
    head = SPEC.partition("recipes:\n")[0].replace("ID:", "hardware_id:")
    spec = tmp_path / "spec.yaml"
    plc = "plc: {name: t, sources: per_block, family: s7-1500, toolchain: tia-v19}\n"
    recipe = f"recipes:\n  r: {{parameters: {parameters}, records: 2}}\n"
    spec.write_text(f"{plc}{head}{recipe}jobs:\n  load: {{drive: fan, write_recipe: r}}\n", encoding="utf-8")
    assert api.generate(spec, tmp_path / "out").ok
    assert (tmp_path / "out/scl/Load.scl").read_text("utf-8-sig").count("#failedIndex := L#0;") == zeros
