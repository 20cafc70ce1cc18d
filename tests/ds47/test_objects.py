"""Drive objects: which of them have a parameter, by the lists that name them (TIA Portal help, firmware 5.2)."""

from __future__ import annotations

from pathlib import Path

import pytest

from plcgen import api
from plcgen.ds47.catalogue.merging import profile_text
from plcgen.ds47.devices import find_device, read_profile
from plcgen.ds47.objects import GROUPS, singular, spoken
from plcgen.ds47.plan.nouns import DrivePlan
from plcgen.ds47.sim.bench import build_drive

LISTED = {
    # lists of CU, VECTOR and A_INF: rows p0009, p0105, r0722, p0971, p0977, p1120, p2900, p3100, p3981
    9: {"control_unit"},
    105: {"control_unit", "vector", "a_inf", "tm31"},
    722: {"control_unit"},
    945: {"control_unit", "vector", "a_inf", "tm31"},
    971: {"control_unit", "vector", "a_inf", "tm31"},
    977: {"control_unit"},
    1120: {"vector"},
    2900: {"vector", "a_inf"},
    3100: {"control_unit"},
    3981: {"control_unit", "vector", "a_inf", "tm31"},
}
READ_WHOLE = ("control_unit", "vector", "a_inf", "tm31")


@pytest.mark.parametrize("device", ["sinamics-s120", "sinamics-s150", "sinamics-g130", "sinamics-g150"])
def test_who_has_it(device: str) -> None:
    """What the lists print, number by number: an object of a list that was read whole has it, or surely lacks it."""
    found = find_device(device)
    for number, types in LISTED.items():
        for one in READ_WHOLE:
            assert found.lacks(number, one) == ("" if one in types else "surely"), (number, one)


def test_what_nobody_has_read_is_not_claimed() -> None:
    """The list of SERVO is not public: what VECTOR has is left open, what the control unit alone has is doubted."""
    axis = find_device("sinamics-s120")
    assert [axis.lacks(number, "servo") for number in (1120, 722, 980)] == ["", "perhaps", ""]
    assert axis.lacks(722, "drive") == "surely"  # one of VECTOR and SERVO, and VECTOR lacks it
    assert axis.lacks(1120, "b_inf") == "perhaps"
    assert axis.lacks(722, "other") == ""
    assert find_device("sinamics-g120").lacks(840, "control_unit") == ""  # one drive object has everything


def test_what_another_profile_is_like_is_a_conclusion(tmp_path: Path) -> None:
    """Objects of a device that a profile is like were not read for this one: a doubt, no error."""
    profile = tmp_path / "acme.yaml"
    profile.write_text(
        "title: Acme\nsource: manual\nrecord_index: {profibus: 47, default: profibus}\n"
        "drive_object: {default: 2}\nobject_types: {control_unit: 1, others: vector, whole: [vector]}\n"
        "like: sinamics-s120\n",
        "utf-8",
    )
    assert read_profile(profile, "acme").lacks(722, "vector") == "perhaps"


def test_a_profile_keeps_its_objects(tmp_path: Path) -> None:
    """What ``catalogue import`` writes reads back with the types and the objects of every parameter."""
    device = find_device("sinamics-s120")
    (tmp_path / "own.yaml").write_text(profile_text(device), "utf-8")
    again = read_profile(tmp_path / "own.yaml", "own")
    assert again.object_types == device.object_types
    assert {pnu: one.objects for pnu, one in again.parameters.items()} == {
        pnu: one.objects for pnu, one in device.parameters.items()
    }


def test_the_simulated_drive_does_not_have_it(tmp_path: Path) -> None:
    """Error 00h for p1120 in the control unit: 44h, two words, 0000h and 0000h."""
    (tmp_path / "job.yaml").write_text(
        "plc: {name: a, family: s7-300, toolchain: tia-v16}\n"
        "drives: {d: {device: sinamics-s120, address: 256, drive_object: 1}}\n"
        "jobs: {j: {drive: d, read: [P1120, r945]}}\n",
        "utf-8",
    )
    checked = api.check(tmp_path / "job.yaml")
    assert [d.code for d in checked.diagnostics] == ["PG262"]
    assert checked.project is not None
    plan = checked.project.plan(DrivePlan)
    drive = build_drive(plan, plan.drives[0])
    drive.write_record(47, bytes.fromhex("01 01 01 02 10 01 04 60 00 00 10 01 03 B1 00 00"))
    drive.advance(1000)
    assert drive.read_record(47, 240)[1][:10] == bytes.fromhex("01 81 01 02 44 02 00 00 00 00")


def test_types_in_words() -> None:
    """Groups by their words if all of them are there, single types as p0107 spells them."""
    assert spoken(frozenset({"control_unit"})) == "the control unit"
    assert spoken(frozenset({"servo", "vector", "a_inf"})) == "drives and A_INF"
    assert spoken(GROUPS["infeed"] | {"vector", "control_unit"}) == "the control unit, infeeds and VECTOR"
    assert (singular("terminal_module"), singular("a_inf")) == ("terminal module", "A_INF")


def test_a_type_for_a_device_that_has_none(tmp_path: Path) -> None:
    """A G120 has one drive object with everything in it."""
    (tmp_path / "job.yaml").write_text(
        "plc: {name: a, family: s7-300, toolchain: tia-v16}\n"
        "drives: {d: {device: sinamics-g120, address: 256, object_type: vector}}\n"
        "jobs: {j: {drive: d, read: [r21]}}\n",
        "utf-8",
    )
    (found,) = api.check(tmp_path / "job.yaml").diagnostics
    assert (found.code, found.span.line, found.span.column) == ("PG217", 2, 64)
    assert found.message == "SINAMICS G120 (control units CU2x0-2 DP/PN) has no types of drive objects"
