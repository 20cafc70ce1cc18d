"""A service that writes: what goes out, what is refused before anything does, what changes nothing; on every target."""

from __future__ import annotations

import re
import struct
from pathlib import Path

import pytest

from plcgen import api
from plcgen.ds47.hmi.lists import text_lists
from plcgen.ds47.proof.plant import Plant
from plcgen.ds47.sim.parameters import SimulatedParameter
from plcgen.ds47.wire.formats import by_name
from tests.ds47.proof.playing import job_of, noticed, sent, status_of

SPEC = """
units:
  drive:
    device: sinamics-s120
    drives: {left: {ID: 281, drive_object: 3}, right: {ID: 281, drive_object: 4}}
jobs:
  ask: {drive: [left, right], service: {write: true}, allow: {P840: a trial, P42000: of the machine builder}}
"""
RIGHT = {"number": 1120, "index": 0, "count": 1, "axis": -1, "write": 1, "enableWrite": 1, "writeFormat": 8}
SIZES = {"number": 4, "index": 4, "count": 2, "axis": 2, "writeDint": 4, "writeDword": 4}


@pytest.fixture
def plant(generate, target) -> Plant:
    """Two axes with p1120 (REAL), p840, p2155 and p42000 (words and double words)."""
    made = generate(SPEC, target)
    found = Plant(made.plan, made.program).fresh()
    for axis in found.units["drive"].objects.values():
        for number, type_ in ((1120, "FloatingPoint"), (840, "Unsigned32"), (2900, "Integer16"), (42000, "Integer8")):
            axis.parameters[number] = SimulatedParameter(number, by_name(type_), [0, 0], array=True)
    return found


def started(plant: Plant, name: str = "ask.left", *, real: float = 0.0, **inputs: int) -> tuple[int, list[str]]:
    """Status, and the requests behind their references."""
    job = job_of(plant, name)
    plant.begin(delivered=True)
    for key, number in {**RIGHT, "writeDint": 0, "writeDword": 0, **inputs}.items():
        signed = number < 0
        plant.control(job).put(f"{job.member}.{key}", number.to_bytes(SIZES.get(key, 1), signed=signed))
    plant.control(job).put(f"{job.member}.writeReal", struct.pack(">f", real))
    return status_of(plant, job), sent(plant)


def held(plant: Plant, number: int, axis: int = 3) -> list[object]:
    return list(plant.units["drive"].objects[axis].parameters[number].values)


def test_what_is_written(plant: Plant) -> None:
    """p1120 = 0460h, 2.5 is 40 20 00 00; p2900 = 0B54h index 1, -2 is FF FE; p42000 = A410h, a byte has a pad."""
    assert started(plant, real=2.5) == (0, ["02 03 01 10 01 04 60 00 00 08 01 40 20 00 00"])
    assert held(plant, 1120) == [2.5, 0]
    found = started(plant, number=2900, index=1, writeFormat=3, writeDint=-2)
    assert found == (0, ["02 03 01 10 01 0b 54 00 01 03 01 ff fe"])
    assert held(plant, 2900) == [0, -2]
    found = started(plant, number=42000, writeFormat=2, writeDint=-128)
    assert found == (0, ["02 03 01 10 01 a4 10 00 00 02 01 80 00"])
    found = started(plant, "ask.right", number=840, axis=4, writeFormat=7, writeDword=0x02D2FC02)
    assert found == (0, ["02 04 01 10 01 03 48 00 00 07 01 02 d2 fc 02"])
    assert (held(plant, 840, 4), held(plant, 840, 3)) == ([0x02D2FC02, 0], [0, 0])
    # what was read stays behind a write; the same start without write reads what is there now
    shown = '"DriveJobs".askLeft.value'
    plant.units["drive"].objects[3].parameters[2900].values[0] = 5
    assert started(plant, number=2900, write=0)[0] == 0
    assert (plant.cpu[f"{shown}Dint"], plant.cpu[f"{shown}Format"]) == (5, 3)
    assert started(plant, number=2900, writeFormat=3, writeDint=9)[0] == 0
    assert (plant.cpu[f"{shown}Dint"], plant.cpu[f"{shown}Format"]) == (5, 3)
    assert started(plant, number=2900, write=0)[0] == 0
    assert plant.cpu[f"{shown}Dint"] == 9


REFUSED = {
    "not enabled": (0x8551, {"enableWrite": 0}),
    "not enabled, whatever the number": (0x8551, {"enableWrite": 0, "number": 971}),
    "a source that the spec does not name": (0x8552, {"number": 1070}),
    "saves": (0x8552, {"number": 977}),
    "a limit of speed": (0x8552, {"number": 1082}),
    "Safety": (0x8552, {"number": 9501}),
    "nobody knows it": (0x8552, {"number": 61234}),
    "another drive object": (0x8552, {"axis": 4}),
    "the control unit": (0x8552, {"axis": 1}),
    "no type": (0x8553, {"writeFormat": 0}),
    "a text": (0x8553, {"writeFormat": 9}),
    "eight bytes": (0x8553, {"writeFormat": 0x38}),
    "300 is no Integer8": (0x8554, {"writeFormat": 2, "writeDint": 300}),
    "-1 has no Unsigned16": (0x8554, {"writeFormat": 6, "writeDint": -1}),
    "17 bits are no word": (0x8554, {"writeFormat": 0x42, "writeDword": 0x10000}),
    "two values": (0x8550, {"count": 2}),
}


def test_what_is_refused_sends_nothing(plant: Plant) -> None:
    """Each has its status; the drive has what it had."""
    for name, (status, inputs) in REFUSED.items():
        assert started(plant, **inputs) == (status, []), name
    for number in (float("nan"), float("inf"), float("-inf")):
        assert started(plant, real=number) == (0x8554, []), number
    assert held(plant, 1120) == [0, 0]
    assert started(plant, real=1.0)[0] == 0
    # p1120 has no index 7: the drive answers error 03h
    assert started(plant, index=7, real=1.0)[0] == 0x8401
    assert list(plant.cpu['"DriveJobs".askLeft.diagnosis.errors']) == [0x8003]


def _problems(tmp_path: Path, job: str, device: str = "sinamics-s120") -> list[str]:
    """What check says of a service on an S7-1500."""
    spec = tmp_path / "job.yaml"
    drive = f"drives: {{a: {{device: {device}, hardware_id: 270}}}}"
    plc = "plc: {name: Plant, family: s7-1500, toolchain: tia-v19}"
    spec.write_text(f"{plc}\n{drive}\njobs: {{look: {{drive: a, {job}}}}}\n", "utf-8")
    return [f"{one.code} {one.message}" for one in api.check(spec).diagnostics]


def test_a_drive_of_which_nothing_is_known_needs_names(tmp_path: Path) -> None:
    """A profile without a family has no harmless numbers: what another maker's number does is not known."""
    (found,) = _problems(tmp_path, "service: {write: true}", "profidrive")
    assert found.startswith("PG219 no number is known to be harmless in profidrive")
    assert _problems(tmp_path, "service: {write: true}, allow: {P1120: ramp of the maker}", "profidrive") == []


def test_what_a_service_never_writes(tmp_path: Path) -> None:
    """Saving, Safety and displays are refused in allow; in a service that only reads nothing can be allowed."""
    for key, number in (("allow", "P971"), ("allow", "P10010"), ("allow_safety", "P9501"), ("allow", "P964")):
        (found, *_) = _problems(tmp_path, f"service: {{write: true}}, {key}: {{{number}: a trial}}")
        assert found.startswith(f"PG219 a service does not write {number}"), found
    (found,) = _problems(tmp_path, "service: read, allow: {P1120: a trial}")
    assert found == 'PG219 allow names "P1120", which this job does not write'


def test_several_drives_have_what_all_of_them_have(generate) -> None:
    """p2900, a fixed value, is in the lists of S120 but not of S210: beside one it is not written; p1460 is in both."""
    text = """
drives: {a: {device: sinamics-s120, ID: 281, drive_object: 3}, b: {device: sinamics-s210, ID: 300}}
jobs:
  both: {drive: [a, b], service: {write: true}}
  one: {drive: a, service: {write: true}}
"""
    both, _, one = (job.permitted for job in generate(text, "t15").plan.jobs)
    assert both is not None
    assert one is not None
    numbers = [{n for first, last in found.ranges for n in range(first, last + 1)} for found in (both, one)]
    assert numbers[0] < numbers[1]
    assert (2900 in numbers[0], 2900 in numbers[1], 1460 in numbers[0]) == (False, True, True)


def test_the_guide_says_what_a_panel_needs(tmp_path: Path) -> None:
    """Every input and output of the structure is in its table, the text lists are those of plcgen texts."""
    spec = tmp_path / "job.yaml"
    plc = "plc: {name: Plant, family: s7-1500, toolchain: tia-v19}"
    spec.write_text(f"{plc}\n{SPEC.strip().replace('ID:', 'hardware_id:')}\n", "utf-8")
    assert api.generate(spec, tmp_path / "out").ok
    guide = (tmp_path / "out" / "IMPORT.md").read_text("utf-8")
    section = guide.partition("## A panel for the service")[2].partition("## What")[0]
    named = set(re.findall(r"`([a-zA-Z]+)[.`]", section))
    asked = {"execute", "number", "index", "count", "axis", "enableWrite", "write", "writeFormat", "writeReal"}
    told = {"busy", "done", "error", "status", "diagnosis", "value", "valueFormat", "valueDint", "valueReal"}
    lists = {one.name for one in text_lists(["en-US"])} - {"DriveFaultClasses"}
    assert named == asked | told | {"writeDint", "writeDword", "valueDword"} | lists
    assert '`"DriveJobs".askLeft`, `"DriveJobs".askRight`' in section


DAMAGE = {
    "never enabled by it": ("IF NOT #enableWrite THEN", "IF FALSE THEN"),
    "writes on another drive object": ("#axis <> WORD_TO_INT(BYTE_TO_WORD(#driveObject))", "FALSE"),
    "one range too few": ("#tempFirst := 1; #tempLast := ", "#tempFirst := 2; #tempLast := "),
    "the number after a range": ("#number > #numbers[2 * #tempIndex]", "#number > #numbers[2 * #tempIndex] + 1"),
    "the first number of a range": ("IF #number < #numbers", "IF #number <= #numbers"),
    "another range": ("  numbers[1] := ", "  numbers[1] := 1"),
    "a dangerous number": ("  numbers[2] := ", "  numbers[2] := 840; // "),
    "several values": ("IF #write AND #count > 1 THEN", "IF FALSE THEN"),
    "values of any size": ("IF NOT #tempFits THEN", "IF FALSE THEN"),
    "no number": ("DW#16#7F800000) <> DW#16#7F800000", "DW#16#7F800000) <> DW#16#7F800001"),
    "any type": ("#statRefusal := #STATUS_NOT_WRITABLE;", ";"),
    "the value of the next start": ("N := 8 * (#statSize - #tempIndex)", "N := 8 * (#statSize - 1)"),
    "a pad that nobody cleared": (" #unit.telegram[13] := B#16#00;", ""),
    "a length without the pad": ("2 + #statSize + #statSize MOD 2", "2 + #statSize"),
    "a value of a write": (
        "W#16#0000 AND NOT #statWrites THEN\n      #valueDword",
        "W#16#0000 THEN\n      #valueDword",
    ),
    "a read that writes": ("#statWrites := #write;", "#statWrites := TRUE;"),
}


@pytest.mark.slow
@pytest.mark.parametrize("damage", DAMAGE)
def test_damage_is_noticed(damage: str, tmp_path: Path) -> None:
    """One change of a source, and verify is red."""
    found = noticed(
        tmp_path,
        """plc: {name: Plant, family: s7-1500, toolchain: tia-v19}
drives: {a: {device: sinamics-v90, hardware_id: 270}}
jobs: {look: {drive: a, service: {write: true}}}
""",
        *DAMAGE[damage],
    )
    assert any(one.code in {"PG614", "PG620", "PG621", "PG641"} for one in found)
