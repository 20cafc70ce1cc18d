"""Rules about parameters look at every drive of a job: none is hidden behind the first one, none is told twice."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from plcgen import api
from plcgen.ds47.device import Device, Parameter
from plcgen.ds47.devices import device_names, find_device
from plcgen.ds47.plan.nouns import DrivePlan
from plcgen.ds47.sheet import review_sheet

HEAD = """\
title: Harmless
source: manual
record_index: {profibus: 47, default: profibus}
drive_object: {default: 2}
bases: []
parameters:
"""
KNOWN = """\
  P899: {type: Unsigned16, access: r}
  P971: {type: Unsigned16, min: 0, max: 1}
  P1016: {title: Mode, type: Integer16, min: 0, max: 16DANGER}
  P1400: {title: Configuration, type: Unsigned16DANGER}
  P2616: {title: Numbers, type: Integer16, array: 9, min: 0, max: 6DANGER}
  P2900: {type: FloatingPoint, array: 9, min: 0.0, max: 90.0}
"""
"""Harmless in every family: what is dangerous is said by a profile."""
RECIPES = "recipes: {few: {parameters: [P2900, P1016], records: 2}}\n"
FORMS = {
    "alone": ("P1016", "write: {P1016: 4}"),
    "short form of an input": ("P1016", "write: [{parameter: P1016}]"),
    "an input": ("P1016", "write: [{parameter: P1016, type: Integer16, start: 4}]"),
    "by its number": ("P1016", "write: [{parameter: '1016', value: 4}]"),
    "behind another": ("P1016", "write: [{parameter: P2900, value: 1.0}, {parameter: P1016, value: 4}]"),
    "an index": ("P2616", "write: [{parameter: 'P2616[2]', value: 1}]"),
    "a range": ("P2616", "write: [{parameter: 'P2616[0..3]', value: [0, 1, 2, 3]}]"),
    "a bit": ("P1400", "write: [{parameter: P1400.3, value: 1}]"),
    "several bits": ("P1400", "write: [{parameter: P2900, value: 1.0}, {parameter: P1400.0}, {parameter: P1400.3}]"),
    "a step": ("P1016", "sequence: [{read: [P2900]}, {write: {P1016: 4}}]"),
    "a step behind a wait": ("P1016", 'sequence: [{until: {P2900: "> 1.0"}}, {write: {P1016: 4}}]'),
    "a recipe": ("P1016", "write_recipe: few"),
    "a recipe that is read back": ("P1016", "write_recipe: few, verify: readback"),
    "read back": ("P1016", "write: {P1016: 4}, verify: readback"),
    "restored": ("P1016", "write: {P1016: 4}, verify: readback, on_error: restore"),
    "restored bits": ("P1400", "write: {P1400.3: 1}, verify: readback, on_error: restore"),
    "read back and saved": ("P1016", "write: {P1016: 4}, verify: readback, save: drive_object"),
    "split": ("P2616", "write: [{parameter: 'P2616[0..1]', value: 1}, {parameter: 'P2616[2..3]', value: 1, as: more}]"),
}  # fmt: skip
"""Every form of a write, with the number that it writes."""


def write(folder: Path, job: str, order: list[str]) -> Path:
    """A job on drives: s is one in which it is dangerous, in every other one nothing of it is."""
    (folder / "plain.yaml").write_text(HEAD + KNOWN.replace("DANGER", ""), "utf-8")
    (folder / "danger.yaml").write_text(HEAD + KNOWN.replace("DANGER", ", dangerous: opens the chuck"), "utf-8")
    drives = [
        f"  {key}: {{device: ./{'danger' if key[0] == 's' else 'plain'}.yaml, address: {256 + 8 * at}}}\n"
        for at, key in enumerate(order)
    ]
    spec = folder / "job.yaml"
    spec.write_text(
        "plc: {name: a, family: s7-300, toolchain: tia-v16}\n"
        f"drives:\n{''.join(drives)}{RECIPES}jobs: {{j: {{drive: [{', '.join(order)}], {job}}}}}\n",
        "utf-8",
    )
    return spec


@pytest.mark.parametrize("order", ["s", "sp", "ps", "pqs", "pqsr"], ids=" ".join)
@pytest.mark.parametrize("form", FORMS)
def test_a_dangerous_number_is_refused_in_every_form_on_every_drive(tmp_path: Path, form: str, order: str) -> None:
    """Once, with its number and the drive that makes it dangerous; nothing is generated; signed off, it is accepted."""
    number, job = FORMS[form]
    spec = write(tmp_path, job, list(order))
    found = [d for d in api.check(spec).diagnostics if d.severity.name == "ERROR"]
    assert {d.code for d in found} == {"PG219"}
    assert len(found) == (2 if form == "split" else 1)
    for told in found:
        assert re.match(
            rf"writing {number} \(.*\){'' if order[0] == 's' else ' of s'} needs a sign-off: ", told.message
        )
    assert not api.generate(spec, tmp_path / "out").ok
    assert not (tmp_path / "out").exists()
    signed = write(tmp_path, f"{job}, allow: {{{number}: agreed}}", list(order))
    assert [d.message for d in api.check(signed).diagnostics if d.severity.name == "ERROR"] == []


def test_what_was_signed_off_is_listed_for_the_drive_in_which_it_is_dangerous(tmp_path: Path) -> None:
    """IMPORT.md has the reason at the drive; the sheet of the job has it, whichever drive it is."""
    spec = write(tmp_path, "write: {P1016: 4}, allow: {P1016: agreed}", ["p", "s"])
    result = api.generate(spec, tmp_path / "out")
    assert result.ok
    guide = (tmp_path / "out" / "IMPORT.md").read_text("utf-8").splitlines()
    rows = [line for line in guide if "P1016" in line and "| " in line]
    assert ["signed off: agreed" in row for row in rows] == [False, True]
    assert "None" not in "".join(rows)
    (entry,) = review_sheet(api.check(spec).project.plan(DrivePlan)).writes
    assert (entry.danger[:8], entry.signed) == ("opens th", "agreed")


@pytest.mark.parametrize("different", [False, True], ids=["equal", "each defined in its own way"])
def test_twenty_drives_are_one_problem(tmp_path: Path, different: bool) -> None:
    """However many of them are dangerous, unlike an axis: the first one is named."""
    own = [f"parameters: {{P2999: {{type: Integer16, max: {20 + n if different else 20}}}}}" for n in range(20)]
    drives = "".join(
        f"  s{n}: {{device: sinamics-s120, object_type: a_inf, address: {300 + 8 * n}, {own[n]}}}\n" for n in range(20)
    )
    spec = tmp_path / "job.yaml"
    names = ", ".join(f"s{n}" for n in range(20))
    spec.write_text(
        "plc: {name: a, family: s7-300, toolchain: tia-v16}\n"
        f"drives:\n  p: {{device: sinamics-s120, address: 256}}\n{drives}"
        f"jobs: {{j: {{drive: [p, {names}], write: [{{parameter: P1800, type: FloatingPoint, value: 4}}]}}}}\n",
        "utf-8",
    )
    (told,) = api.check(spec).diagnostics
    assert (told.code, told.message[:46]) == (
        "PG219",
        "writing P1800 (Pulse frequency) of s0 needs a ",
    )


def test_equal_drives_that_do_not_fit_are_one_problem(tmp_path: Path) -> None:
    """PG222 names the first of them, and says what is wrong there."""
    spec = tmp_path / "job.yaml"
    drives = "".join(f"  s{n}: {{device: sinamics-s210, address: {300 + 8 * n}}}\n" for n in range(9))
    spec.write_text(
        "plc: {name: a, family: s7-300, toolchain: tia-v16}\n"
        f"drives:\n  g: {{device: sinamics-v90, address: 256}}\n{drives}jobs:\n"
        "  j:\n"
        "    drive: [g, s0, s1, s2, s3, s4, s5, s6, s7, s8]\n"
        "    write: [{parameter: P1083, type: FloatingPoint, value: 999999.0}]\n",
        "utf-8",
    )
    (told,) = [d for d in api.check(spec).diagnostics if d.code == "PG222"]
    assert [note.message for note in told.notes] == ["s0: P1083 = 999999 is outside its limits 0..210000 rpm"]


def dangers(device: Device) -> dict[int, Parameter]:
    """What is dangerous in a device, as far as its catalogue knows it."""
    return {
        pnu: one
        for pnu, one in device.parameters.items()
        if device.danger(pnu, [least(one)]) and one.type and one.access != "r"
    }


def least(one: Parameter) -> float:
    """The value that is written: no signal, for a sink of a signal."""
    return max(one.minimum or 0, 0)


def plain(known: dict[int, Parameter]) -> str:
    """A profile with the same numbers, in which all of them are harmless and writable."""
    rows = [f"  P{pnu}: {{type: '{one.type}', array: {one.array or 1}}}\n" for pnu, one in known.items()]
    return HEAD + "".join(rows)


def both(folder: Path, name: str, known: dict[int, Parameter], order: str) -> Path:
    """A job that writes all of these numbers to drives d, of this device, and p, a harmless one."""
    (folder / "plain.yaml").write_text(plain(known), "utf-8")
    ends = {
        "d": f"device: {name}, record_index: {find_device(name).default_index}",
        "p": "device: ./plain.yaml",
    }
    items = [f"{{parameter: P{pnu}, value: {least(one):g}}}" for pnu, one in known.items()]
    lists = [", ".join(items[at : at + 30]) for at in range(0, len(items), 30)]
    object_ = find_device(name).drive_object
    drives = [
        f"  {key}: {{{ends[key]}, address: {256 + 8 * at}, drive_object: {object_}}}\n" for at, key in enumerate(order)
    ]
    jobs = [f"  j{at}: {{drive: [{', '.join(order)}], write: [{some}]}}\n" for at, some in enumerate(lists)]
    spec = folder / "job.yaml"
    spec.write_text(
        f"plc: {{name: a, family: s7-300, toolchain: tia-v16}}\ndrives:\n{''.join(drives)}jobs:\n{''.join(jobs)}",
        "utf-8",
    )
    return spec


@pytest.mark.parametrize("order", ["d", "dp", "pd"])
@pytest.mark.parametrize("name", device_names())
def test_every_dangerous_number_of_every_family(tmp_path: Path, name: str, order: str) -> None:
    """All of a catalogue, on the only drive, the first and the last one."""
    known = dangers(find_device(name))
    found = api.check(both(tmp_path, name, known, order)).diagnostics
    told = [match[1] for d in found if d.code == "PG219" and (match := re.match(r"writing P(\d+) ", d.message))]
    assert sorted(map(int, told)) == sorted(known)


@pytest.mark.parametrize("order", ["d", "dp", "pd"])
@pytest.mark.parametrize("name", device_names())
def test_every_display_of_every_family(tmp_path: Path, name: str, order: str) -> None:
    """What can only be read in one of the drives is written to none."""
    device = find_device(name)
    known = {
        pnu: one
        for pnu, one in device.parameters.items()
        if one.access == "r" and one.type and "[" not in one.type and not device.danger(pnu)
    }
    found = api.check(both(tmp_path, name, known, order)).diagnostics
    told = [match[1] for d in found if d.code == "PG207" and (match := re.match(r"r(\d+) ", d.message))]
    assert sorted(map(int, told)) == sorted(known)


@pytest.mark.parametrize("name", device_names())
def test_a_profile_that_is_like_a_device_keeps_its_guards(tmp_path: Path, name: str) -> None:
    """Numbers that it defines again are as dangerous, and as little writable, as in the device."""
    device = find_device(name)
    own = tmp_path / "own.yaml"
    typed = {pnu: one for pnu, one in device.parameters.items() if one.type}
    own.write_text(plain(typed).replace("parameters:", f"like: {name}\nparameters:"), "utf-8")
    found = find_device(str(own))
    assert {pnu for pnu in typed if not found.danger(pnu)} == {pnu for pnu in typed if not device.danger(pnu)}
    reads = {pnu for pnu, one in found.parameters.items() if one.access == "r"}
    assert reads == {pnu for pnu, one in device.parameters.items() if one.access == "r"}
