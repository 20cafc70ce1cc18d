"""Dangerous specs, written by hand: each is refused by name, and a sign-off is the only thing that helps."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from plcgen import api
from plcgen.ds47.devices import device_names, find_device
from plcgen.ds47.plan.nouns import DrivePlan
from plcgen.ds47.sim.bench import build_drive
from plcgen.ds47.sim.load import load_drive
from tests.yaml_files import read_yaml

DANGEROUS: list[dict[str, Any]] = read_yaml(Path(__file__).with_name("dangerous.yaml").read_text("utf-8"))
SIGNABLE = [case for case in DANGEROUS if "code" not in case]
PROFILE = """\
title: Acme
source: manual
record_index: {profibus: 47, default: profibus}
drive_object: {default: 1}
parameters:
"""


def write(folder: Path, case: dict[str, Any], sign: str | None = None) -> Path:
    """The spec of a case, and its profile; with another drive in front of its own if it names one."""
    if "profile" in case:
        like = f"like: {case['like']}\n" if "like" in case else ""
        (folder / "acme.yaml").write_text(f"{like}{PROFILE}  {case['profile']}\n", "utf-8")
    front = f"front: {{device: {case['front']}, address: 300}}, " if "front" in case else ""
    job = f"drive: {'[front, d]' if front else 'd'}, write: [{case['write']}]"
    sign = sign or case.get("sign")
    path = folder / "job.yaml"
    path.write_text(
        "plc: {name: a, family: s7-300, toolchain: tia-v16}\n"
        f"drives: {{{front}d: {{device: {case.get('drive', './acme.yaml')}, address: 256}}}}\n"
        f"jobs: {{j: {{{job}{', ' + sign if sign else ''}}}}}\n",
        "utf-8",
    )
    return path


def test_the_list_is_long_enough():
    """At least 60 of them, all different, and every number that a shipped profile calls dangerous is among them."""
    assert len({str({**case, "name": ""}) for case in DANGEROUS}) == len(DANGEROUS) >= 60
    known = {f"P{one.pnu}" for name in device_names() for one in find_device(name).parameters.values() if one.dangerous}
    assert known <= {case["says"] for case in SIGNABLE}


@pytest.mark.parametrize("case", DANGEROUS, ids=lambda case: case["name"])
def test_refused(case, tmp_path):
    """An error of its code names the number; a dangerous one has a reason, and nothing is generated."""
    path = write(tmp_path, case)
    found = api.check(path).diagnostics
    told = [d for d in found if d.code == case.get("code", "PG219") and d.severity.name == "ERROR"]
    assert told, found
    assert re.search(rf"\b{re.escape(case['says'])}\b", told[0].message), told
    if "code" not in case:
        assert re.search(r"needs a sign-off: \w+ \w+", told[0].message)
        assert f"{{{case['says']}: why}}" in told[0].help
    assert not api.generate(path, tmp_path / "out").ok
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("case", SIGNABLE, ids=lambda case: case["name"])
def test_a_sign_off_is_all_that_is_missing(case, tmp_path):
    """The number and a reason, under the key for its kind."""
    number = int(case["says"][1:])
    safety = 9300 <= number <= 9399 or 9500 <= number <= 10299 or number in {3117, 60022}
    path = write(tmp_path, case, f"{'allow_safety' if safety else 'allow'}: {{{case['says']}: agreed with QA}}")
    assert api.check(path).ok


def test_import_guide_repeats_reason_and_safety(tmp_path):
    """Who imports the blocks reads what was signed off, and that a Safety parameter is among it."""
    case = {"drive": "sinamics-s120", "write": "{parameter: P9501, type: Unsigned32, value: 0}"}
    path = write(tmp_path, case, "allow_safety: {P9501: agreed | tested}")
    assert api.generate(path, tmp_path / "out").ok
    guide = (tmp_path / "out" / "IMPORT.md").read_text("utf-8")
    assert "signed off: agreed \\| tested; type inferred" in guide
    assert "**Safety: block J writes P9501 of drive d.**" in guide


def test_the_simulated_drive_refuses_to_write_a_display(tmp_path):
    """Error 01h for an r parameter that the spec defines itself, and for the fault buffer of a drive file."""
    spec = tmp_path / "job.yaml"
    spec.write_text(
        "plc: {name: a, family: s7-300, toolchain: tia-v16}\n"
        "drives: {d: {device: sinamics-g120, address: 256, parameters: {r2000: {type: Unsigned16}}}}\n"
        "jobs: {j: {drive: d, read: [r2000]}}\n",
        "utf-8",
    )
    plan = api.check(spec).project.plan(DrivePlan)
    drive = build_drive(plan, plan.drives[0])
    change = bytes.fromhex("01 02 01 01 10 01 07 D0 00 00 06 01 00 01")
    assert drive.write_record(47, change) == 0
    assert drive.read_record(47, 240) == (0, bytes.fromhex("01 82 01 01 44 02 00 01 00 00"))
    own = load_drive("objects: [{number: 1, parameters: [{pnu: 945, type: Unsigned16, values: [0, 0]}]}]")
    assert own.write_record(47, bytes.fromhex("01 02 01 01 10 01 03 B1 00 00 06 01 00 01")) == 0
    assert own.read_record(47, 240)[1] == bytes.fromhex("01 82 01 01 44 02 00 01 00 00")


@pytest.mark.parametrize("number", ["P1122", "P1112", "p1119", "P970", "R946"])
def test_a_neighbouring_number_is_never_offered(number, tmp_path):
    """A number that looks like a known one is another parameter: following such a hint writes the wrong one."""
    case = {"drive": "sinamics-dcm, parameters: {P1120: {type: FloatingPoint}}", "write": f"{{parameter: {number}}}"}
    told = [d for d in api.check(write(tmp_path, case)).diagnostics if d.code == "PG204"]
    written = {"p1119": "P1119", "R946": "r946"}.get(number, number)
    define = f"or define it in the drive: parameters: {{{written}: {{type: ..}}}}"
    given = f"look it up in the list manual and give its type: {number}: {{type: ..}}"
    assert [d.help for d in told] == [f"{given}; {define}"]


def test_a_similar_name_is_offered(tmp_path):
    """Names are words, and a slip of the pen in one is seen as such."""
    case = {"drive": "sinamics-g120", "write": "{parameter: ramp_up_tiem, value: 1.0}"}
    (told,) = api.check(write(tmp_path, case)).diagnostics
    assert told.help == 'did you mean "ramp_up_time"?'
