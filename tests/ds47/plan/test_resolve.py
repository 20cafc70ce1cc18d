"""Planning a whole spec: references, tokens, numbers, names and what is left when something is wrong."""

from __future__ import annotations

from plcgen.base.diagnostics import Report
from plcgen.ds47.plan.nouns import DrivePlan
from plcgen.project.loading import parse_spec
from plcgen.project.resolve import resolve
from tests.projects import FAQ, MM4

HEAD = "plc: {name: a, family: s7-1500, toolchain: tia-v18}\n"


def planned(text: str, *codes: str) -> DrivePlan:
    report = Report()
    loaded = parse_spec(text, "t.yaml", report)
    assert loaded is not None, list(report)
    plan = resolve(loaded, report).plan(DrivePlan)
    assert tuple(d.code for d in report) == codes
    assert plan is not None
    return plan


def test_the_seeds_telegrams() -> None:
    """FAQ 109750712 figure 5-1 and figure 4-9 with 100.0; MM4 part 3 tables 3-1 and 3-3."""
    found = {
        job.key: job.telegrams[0].request.data.hex(" ").upper()
        for path in (FAQ, MM4)
        for job in planned(path.read_text(encoding="utf-8")).jobs
    }
    assert found == {
        "read_ramp_up": "03 01 02 01 10 01 C4 7F 00 00",
        "write_ramp_down": "04 02 02 01 10 01 C4 80 00 00 08 01 42 C8 00 00",
        "read_params": "01 01 00 02 10 00 04 60 00 00 10 02 08 6B 00 01",
        "write_params": "02 02 00 02 10 01 04 60 00 00 10 01 04 61 00 00 08 01 41 30 00 00 08 01 41 B0 00 00",
    }


def test_drive_objects_at_one_address_are_one_unit() -> None:
    """One parameter channel carries one request at a time: its jobs have places in one queue."""
    project = planned(
        HEAD
        + """drives:
  x: {device: sinamics-s120, hardware_id: 270, drive_object: 3}
  y: {device: sinamics-s120, hardware_id: 270, drive_object: 4}
  z: {device: sinamics-s120, hardware_id: 271, drive_object: 3}
jobs:
  a: {drive: x, read: [r21]}
  b: {drive: y, read: [r21]}
  c: {drive: z, read: [r21]}
"""
    )
    assert [(job.drive.unit.key, job.slot) for job in project.jobs] == [("x", 1), ("x", 2), ("z", 1)]
    assert [unit.db.name for unit in project.units] == ["XUnit", "ZUnit"]


def test_automatic_numbers_avoid_pinned_ones() -> None:
    """A DB number that the spec gives is never handed out a second time."""
    project = planned(
        HEAD
        + """drives: {x: {device: sinamics-s120, hardware_id: 270}}
jobs:
  a: {drive: x, read: [r21]}
  b: {drive: x, read: [r21], request: {db: 471}, response: {db: 473}, block: {number: 470}}
"""
    )
    numbers = [(block.kind, block.number) for block in project.blocks]
    assert len(numbers) == len(set(numbers))
    assert {("DB", 471), ("DB", 473), ("FB", 470)} <= set(numbers)


def test_an_output_address_sets_bit_15() -> None:
    """ID of WRREC/RDREC on S7-300/400: an output-only module sets bit 15 of the logical address."""
    text = HEAD.replace("s7-1500", "s7-300") + (
        "drives: {x: {device: sinamics-s120, address: 256, output_address: true}}\njobs: {a: {drive: x, read: [r21]}}\n"
    )
    assert planned(text).drives[0].id_value == 0x8100


def test_what_cannot_be_planned_is_left_out_and_reported() -> None:
    """Unknown devices, drives and parameters: all reported, the good job is still planned."""
    project = planned(
        HEAD
        + """drives:
  x: {device: sinamics-s120, hardware_id: 270}
  y: {device: sinamics-s12, hardware_id: 271}
jobs:
  a: {drive: x, read: [r21]}
  b: {drive: w, read: [r21]}
  c: {drive: x, compare: {P12345: 1}}
""",
        "PG201",
        "PG202",
        "PG204",
    )
    assert [job.key for job in project.jobs] == ["a"]
