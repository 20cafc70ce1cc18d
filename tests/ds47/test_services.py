"""docs/devices.md, "Services": which device takes which kind of job is what check says, and every pair is decided."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from plcgen import api
from plcgen.ds47.devices import find_device
from plcgen.ds47.plan.nouns import DrivePlan

PAGE = (Path(__file__).parents[2] / "docs" / "devices.md").read_text("utf-8")
SERVICES = {
    "faults": "faults: current",
    "alarms": "alarms: current",
    "acknowledge": "acknowledge: true",
    "save: drive_object": "save: drive_object",
    "save: unit": "save: unit",
    "clock": "clock: utc",
    "activate": "activate: false",
}
OF_THE_UNIT = {"save: unit", "clock"}
"""What is asked of the control unit where a device has one."""
_TABLE = PAGE[PAGE.index("### Services") : PAGE.index("<!-- services -->")].rstrip().split("\n\n")[-1].splitlines()
ROWS = {cells[0]: cells[1:] for cells in ([c.strip() for c in row.strip("|").split("|")] for row in _TABLE[2:])}
PAIRS = [(device, service, told) for device, row in ROWS.items() for service, told in zip(SERVICES, row, strict=True)]
WHY = (Path(__file__).parents[2] / "docs" / "evidence.md").read_text("utf-8").partition("## Services that are open")[2]
OPEN = re.findall(r"^- `([a-z0-9-]+)`, ([a-z_ :,]+): ", WHY, re.MULTILINE)


def checked(device: str, service: str, folder: Path) -> str:
    """What check says of a job without any definition: accepted, absent (a source says so) or open (nobody knows)."""
    types = find_device(device).object_types
    number = types.control_unit if types is not None and service in OF_THE_UNIT else find_device(device).drive_object
    path = folder / "job.yaml"
    path.write_text(
        "plc: {name: a, family: s7-1500, toolchain: tia-v19}\n"
        f"drives: {{d: {{device: {device}, hardware_id: 280, drive_object: {number}}}}}\n"
        f"jobs: {{j: {{drive: d, {SERVICES[service]}}}}}\n",
        "utf-8",
    )
    found = [one for one in api.check(path).diagnostics if one.severity.name in {"ERROR", "WARNING"}]
    codes = {one.code for one in found}
    return "accepted" if not codes else {"PG262": "absent", "PG248": "open", "PG243": "open"}[codes.pop()]


@pytest.mark.parametrize(("device", "service", "told"), PAIRS)
def test_the_page_says_what_check_says(device: str, service: str, told: str, tmp_path: Path) -> None:
    """Of every device and every service; a refusal that rests on a source names it."""
    assert checked(device, service, tmp_path) == told


def test_few_are_open_and_the_page_says_what_was_searched() -> None:
    """Ten of twelve devices with seven services at most; each has a line in docs/evidence.md, and no other has."""
    assert len(PAIRS) == 84
    open_ = {(device, service) for device, service, told in PAIRS if told == "open"}
    assert len(open_) <= 10
    assert {(device, one.strip()) for device, services in OPEN for one in services.split(",")} == open_


def test_without_a_counter_the_codes_are_read_twice(tmp_path: Path) -> None:
    """A G120: code, value and time of eight faults, then the codes again; with the counter defined it is read instead.

    Request of a read: reference, 01h, drive object, number of parameters; each: 10h, elements, number, first index.
    r945 = 03B1h, r949 = 03B5h, r948 = 03B4h, r944 = 03B0h.
    """
    path = tmp_path / "job.yaml"
    columns = "10 08 03 b1 00 00 10 08 03 b5 00 00 10 08 03 b4 00 00"
    for own, first, last in (
        ("", f"01 01 01 03 {columns}", "02 01 01 01 10 08 03 b1 00 00"),
        (
            ", parameters: {r944: {type: Unsigned16}}",
            f"01 01 01 04 10 01 03 b0 00 00 {columns}",
            "02 01 01 01 10 01 03 b0 00 00",
        ),
    ):
        path.write_text(
            "plc: {name: a, family: s7-1500, toolchain: tia-v19}\n"
            f"drives: {{d: {{device: sinamics-g120, hardware_id: 280{own}}}}}\n"
            "jobs: {j: {drive: d, faults: current}}\n",
            "utf-8",
        )
        (job,) = api.check(path).project.plan(DrivePlan).jobs
        assert [one.request.data.hex(" ") for one in job.telegrams] == [first, last]


def test_the_codes_are_read_again_in_one_telegram(tmp_path: Path) -> None:
    """Eight groups of codes take 4 + 8 x 18 = 148 bytes of an answer: a record of 147 is too short, 148 is enough."""
    own = tmp_path / "acme.yaml"
    path = tmp_path / "job.yaml"
    path.write_text(
        "plc: {name: a, family: s7-1500, toolchain: tia-v19}\n"
        "drives: {d: {device: ./acme.yaml, hardware_id: 280}}\n"
        "jobs: {j: {drive: d, faults: {history: 7, columns: [code]}}}\n",
        "utf-8",
    )
    for record, codes in ((147, ["PG307"]), (148, [])):
        own.write_text(
            "title: A\nsource: m\nrecord_index: {profibus: 47, default: profibus}\ndrive_object: {default: 1}\n"
            f"limits: {{record: {record}}}\nparameters: {{r945: {{type: Unsigned16, array: 64}}}}\n",
            "utf-8",
        )
        assert [one.code for one in api.check(path).diagnostics if one.severity.name == "ERROR"] == codes
