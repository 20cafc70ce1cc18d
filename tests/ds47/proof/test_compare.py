"""Comparing: what is sent, what is listed and in which order, what counts as the same; by hand on the soft CPU."""

from __future__ import annotations

import struct
from pathlib import Path

import pytest

from plcgen import api
from plcgen.ds47.plan.nouns import DrivePlan
from plcgen.ds47.proof.plant import Plant
from plcgen.ds47.proof.scenario import DriveScenario
from plcgen.ds47.sim.faults import Fault, FaultKind
from tests.ds47.proof.playing import job_of, sent, status_of

HEAD = "plc: {name: a, family: s7-1500, toolchain: tia-v19}\ndrives: {d: {device: sinamics-g120, hardware_id: 270}}\n"
SPEC = """
drives:
  mixer:
    device: sinamics-g120
    ID: 270
    parameters:
      P2900: {type: Integer16, array: 8}
      P2901: {type: Integer8, array: 3}
      P2902: {type: Unsigned32}
      P2903: {type: Integer32}
      P3000: {type: FloatingPoint, array: 200}
jobs:
  ramps: {drive: mixer, compare: {P1120: 10.0, P1121: {as: down, start: 5.0}}}
  mixed:
    drive: mixer
    compare: {"P2900[3..5]": [1, -2, 3], "P2901[0..2]": [1, -1, 7], P2902: r722.2, P2903: -1, P1120: 4.0}
  long: {drive: mixer, compare: {"P3000[0..99]": 1.5}}
"""
FIRST = "01 01 02 10 01 04 60 00 00 10 01 04 61 00 00"
"""P1120 = 0460h and P1121 = 0461h of drive object 1."""
NONE = (0, 0, 0.0, 0.0, 0, 0)


def run(plant: Plant, key: str, held: dict[int, list[float]], faults: tuple[Fault, ...] = ()) -> int:
    """Run a job against a drive that holds these values, the inputs as delivered; its status."""
    plant.begin(DriveScenario(name="OB1", faults=faults), delivered=True)
    for pnu, values in held.items():
        plant.units["mixer"].objects[1].parameters[pnu].values[: len(values)] = values
    return status_of(plant, job_of(plant, key))


def listed(plant: Plant, key: str) -> list[tuple[float, ...]]:
    """The entries, without the empty places after them, which are looked at here."""
    job = job_of(plant, key)
    path = f'"DriveJobs".{job.member}'
    count, places = plant.cpu[f"{path}.deviationCount"], job.deviations.places
    names = ("parameter", "index", "wanted", "found", "wantedBits", "foundBits")
    rows = [tuple(plant.cpu[f"{path}.deviations[{n}].{name}"] for name in names) for n in range(1, places + 1)]
    assert rows[count:] == [NONE] * (places - count if count < places else 0)
    assert plant.cpu[f"{path}.equal"] == (count == 0)
    return rows[: min(count, places)]


def test_it_only_asks(plant: Plant) -> None:
    """A telegram that reads both parameters; 11.0 is 41300000h, 10.0 is 41200000h (IEEE 754)."""
    assert run(plant, "ramps", {1120: [10.0], 1121: [5.0]}) == 0
    assert sent(plant) == [FIRST]
    assert listed(plant, "ramps") == []
    assert run(plant, "ramps", {1120: [11.0], 1121: [5.0]}) == 0
    assert listed(plant, "ramps") == [(1120, 0, 10.0, 11.0, 0x41200000, 0x41300000)]


def test_an_input_is_wanted(plant: Plant) -> None:
    """With 7.0 = 40E00000h at the input, 5.0 = 40A00000h in the drive is another value."""
    plant.control(job_of(plant, "ramps")).put("ramps.down", struct.pack(">f", 7.0))
    assert run(plant, "ramps", {1120: [10.0], 1121: [5.0]}) == 0
    assert listed(plant, "ramps") == [(1121, 0, 7.0, 5.0, 0x40E00000, 0x40A00000)]
    assert run(plant, "ramps", {1120: [10.0], 1121: [7.0]}) == 0
    assert listed(plant, "ramps") == []


NEIGHBOURS = {
    "41200001": True,  # one unit of the last place up: 10.000001
    "411FFFFF": True,  # and down
    "41200002": False,
    "411FFFFE": False,
    "C1200000": False,  # -10.0
    "00000000": False,
}
"""What a drive may have instead of 10.0, which is 41200000h (IEEE 754), and whether that is the same."""


def test_one_unit_of_the_last_place(plant: Plant) -> None:
    """As when reading back."""
    for pattern, same in NEIGHBOURS.items():
        (value,) = struct.unpack(">f", bytes.fromhex(pattern))
        assert run(plant, "ramps", {1120: [value], 1121: [5.0]}) == 0
        found = [] if same else [(1120, 0, 10.0, value, 0x41200000, int(pattern, 16))]
        assert listed(plant, "ramps") == found, pattern


def test_both_zeros_are_the_same(generate, target) -> None:
    """-0.0 is 80000000h; the smallest number above zero, 00000001h, is a neighbour of 0.0, but not of -0.0."""
    made = generate(
        "drives: {mixer: {device: sinamics-g120, ID: 270}}\njobs: {j: {drive: mixer, compare: {P1120: 0.0}}}\n", target
    )
    plant = Plant(made.plan, made.program).fresh()
    for pattern, same in {"80000000": True, "00000001": True, "80000001": False, "00000002": False}.items():
        (value,) = struct.unpack(">f", bytes.fromhex(pattern))
        assert run(plant, "j", {1120: [value]}) == 0
        assert len(listed(plant, "j")) == (0 if same else 1), pattern


def test_every_kind_of_number(plant: Plant) -> None:
    """By hand: -2 in 16 bits is FFFEh, in 8 bits FEh; r722.2 of this drive object is 02D2FC02h = 47 381 506.

    From 2**25 to 2**26 there are REALs for multiples of 4 only: 47 381 506 lies in the middle between 47 381 504 and
    47 381 508, and the one with the even mantissa wins, 4 x 11 845 376. FFFFFFFFh = 4 294 967 295 becomes 2**32,
    7FFFFFFFh becomes 2**31.
    """
    same = {2900: [0, 0, 0, 1, -2, 3], 2901: [1, -1, 7], 2902: [0x02D2FC02], 2903: [-1], 1120: [4.0]}
    assert run(plant, "mixed", same) == 0
    assert listed(plant, "mixed") == []
    other = {2900: [0, 0, 0, 1, 2, -3], 2901: [-2, 127, 7], 2902: [0xFFFFFFFF], 2903: [2**31 - 1], 1120: [4.0]}
    assert run(plant, "mixed", other) == 0
    assert listed(plant, "mixed") == [
        (2900, 4, -2.0, 2.0, 0xFFFE, 2),
        (2900, 5, 3.0, -3.0, 3, 0xFFFD),
        (2901, 0, 1.0, -2.0, 1, 0xFE),
        (2901, 1, -1.0, 127.0, 0xFF, 0x7F),
        (2902, 0, 47381504.0, 4294967296.0, 0x02D2FC02, 0xFFFFFFFF),
        (2903, 0, -1.0, 2147483648.0, 0xFFFFFFFF, 0x7FFFFFFF),
    ]


def test_more_than_there_is_room_for(plant: Plant) -> None:
    """100 values in two telegrams: 32 places, the first of them listed, all counted."""
    assert run(plant, "long", {3000: [1.5] * 100}) == 0
    assert len(sent(plant)) == 2
    assert listed(plant, "long") == []
    assert run(plant, "long", {3000: [1.5] * 50 + [2.0] * 50}) == 0
    path = f'"DriveJobs".{job_of(plant, "long").member}'
    assert plant.cpu[f"{path}.deviationCount"] == 50
    assert [(row[0], row[1]) for row in listed(plant, "long")] == [(3000, index) for index in range(50, 82)]
    assert run(plant, "long", {3000: [1.5] * 99 + [2.0]}) == 0  # a value of the second telegram
    assert [(row[0], row[1]) for row in listed(plant, "long")] == [(3000, 99)]


def test_an_error_leaves_the_list_of_the_run_before(plant: Plant) -> None:
    """The second parameter cannot be read (11h), in one telegram; of two telegrams the second fails."""
    assert run(plant, "ramps", {1120: [11.0], 1121: [5.0]}) == 0
    before = listed(plant, "ramps")
    refused = Fault(FaultKind.ERROR, number=0x11, position=2, words=1)
    assert run(plant, "ramps", {1120: [12.0], 1121: [6.0]}, (refused,)) == 0x8401
    assert listed(plant, "ramps") == before
    assert run(plant, "long", {3000: [2.0] + [1.5] * 99}) == 0
    second = Fault(FaultKind.ERROR, after=1, number=0x11, position=1, words=1)
    assert run(plant, "long", {3000: [3.0] * 100}, (second,)) == 0x8401
    assert [row[3] for row in listed(plant, "long")] == [2.0]


def test_an_index_that_no_int_has(generate, target) -> None:
    """Index 40001 of P50000: both are larger than 32767."""
    made = generate(
        "drives: {mixer: {device: sinamics-g120, ID: 270, parameters: {P50000: {type: Integer16, array: 40002}}}}\n"
        "jobs: {j: {drive: mixer, compare: {'P50000[40001]': 7}}}\n",
        target,
    )
    plant = Plant(made.plan, made.program).fresh()
    assert run(plant, "j", {50000: [0] * 40001 + [8]}) == 0
    assert listed(plant, "j") == [(50000, 40001, 7.0, 8.0, 7, 8)]


def test_drives_with_other_factory_settings_have_no_common_block(tmp_path: Path) -> None:
    """The name ``on`` is 1 in one drive and 2 in the other: what is wanted is in the block."""
    path = tmp_path / "job.yaml"
    one, two = (f"{{type: Unsigned16, values: {{'on_': {n}}}}}" for n in (1, 2))
    path.write_text(
        "plc: {name: a, family: s7-1500, toolchain: tia-v19}\n"
        "drives:\n"
        f"  a: {{device: sinamics-g120, hardware_id: 270, parameters: {{P2900: {one}}}}}\n"
        f"  b: {{device: sinamics-g120, hardware_id: 271, parameters: {{P2900: {two}}}}}\n"
        "jobs: {j: {drive: [a, b], compare: {P2900: on_}}}\n",
        "utf-8",
    )
    assert [d.code for d in api.check(path).diagnostics if d.severity.name == "ERROR"] == ["PG222"]


def test_nothing_is_written(tmp_path: Path) -> None:
    """No line in IMPORT.md and no sign-off, whatever is compared: p0971 may be read."""
    path = tmp_path / "job.yaml"
    path.write_text(f"{HEAD}jobs: {{j: {{drive: d, compare: {{P971: 0, P1120: 10.0}}}}}}\n", "utf-8")
    assert api.generate(path, tmp_path / "out").ok
    assert "| P1120 |" not in (tmp_path / "out" / "IMPORT.md").read_text("utf-8")
    assert not api.check(path).project.plan(DrivePlan).jobs[0].writes


@pytest.mark.slow
def test_own_drive_and_simulate(tmp_path: Path) -> None:
    """9.0 instead of 10.5 is a deviation, and the job is done all the same; a recorded run shows it."""
    path, drive = tmp_path / "job.yaml", tmp_path / "drive.yaml"
    path.write_text(f"{HEAD}jobs: {{j: {{drive: d, compare: {{P1120: 10.5}}}}}}\n", "utf-8")
    assert api.generate(path, tmp_path / "out").ok
    drive.write_text("objects: [{number: 1, parameters: [{pnu: 1120, type: FloatingPoint, value: 9.0}]}]", "utf-8")
    result = api.verify(path, tmp_path / "out", faults="none", drive=drive)
    (verdict,) = [check.verdict for check in result.checks() if check.id == "own.j"]
    assert verdict == "ok, values agree"
    (job,) = api.simulate(path, tmp_path / "out", drives=[str(drive)]).jobs
    assert (job.status, [value.value for value in job.values]) == (0, [10.5])


def test_a_telegram_knows_its_own_types(generate, target) -> None:
    """A Boolean in the first answer alone: what lists the second one has no branch for it, which no answer reaches."""
    made = generate(
        "drives: {mixer: {device: sinamics-g120, ID: 270, parameters: {P2900: {type: Boolean},\n"
        "  P3000: {type: FloatingPoint, array: 60}}}}\n"
        "jobs: {j: {drive: mixer, compare: {P2900: true, 'P3000[0..59]': 1.5}}}\n",
        target,
        sources="per_block",
    )
    (source,) = (path for path in made.folder.rglob("J.scl"))
    text = source.read_text("utf-8-sig" if target != "v5" else "cp1252")
    first, second = (part for part in text.split("the answer is compared with the one that would be right")[1:])
    assert ("tempFormat OF" in first, "tempFormat OF" in second) == (True, False)
    plant = Plant(made.plan, made.program).fresh()
    assert run(plant, "j", {2900: [False], 3000: [1.5] * 59 + [2.0]}) == 0
    assert [row[:4] for row in listed(plant, "j")] == [(2900, 0, 1.0, 0.0), (3000, 59, 1.5, 2.0)]
