"""A fact that generator, simulator and checks share is broken: somebody else must notice.

Each fault is put into a copy of plcgen, which then generates and verifies with it: everything inside agrees.
"""

from __future__ import annotations

import compileall
import json
import os
import py_compile
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.projects import ROOT

SPEC = """\
plc: {name: a, family: s7-1500, toolchain: tia-v19}
drives: {d: {device: sinamics-g120, hardware_id: 270, record_index: profinet-local}}
jobs:
  set_ramps: {drive: d, write: {P1120: 5.0, P1121: null, P29998: {type: Unsigned8, value: 1}}}
  read_faults: {drive: d, read: ["r945[0..2]", P1120, {parameter: r29999, type: Unsigned8}, r947]}
"""
FORMATS, MODEL = "plcgen/ds47/wire/formats.py", "plcgen/ds47/wire/model.py"
UNITS, DRIVES = "plcgen/ds47/plan/units.py", "plcgen/ds47/rules/drives.py"
SERVER, G120 = "plcgen/ds47/sim/behaviour.py", "specs/devices/sinamics-g120.yaml"
VALUE, DESCRIPTION = "    VALUE = 0x10\n    DESCRIPTION = 0x20\n", "    VALUE = 0x20\n    DESCRIPTION = 0x10\n"
READ, CHANGE = "    READ = 0x01\n    CHANGE = 0x02\n", "    READ = 0x02\n    CHANGE = 0x01\n"
REAL = "type: FloatingPoint, unit: s, array: n, min: 0.0, max: 999999.0, default: 10.0"
UDINT = "type: Unsigned32, unit: s, array: n, min: 0, max: 999999, default: 10"
NO_RULE = "def drive_object(_plan: object) -> object:\n    return iter(())\n\n\ndef _drive_object(plan"
FAULTS = {
    "REAL is 0Fh": [
        (FORMATS, 'Format(0x0F, "Float64"', 'Format(0x08, "Float64"'),
        (FORMATS, 'Format(0x08, "FloatingPoint"', 'Format(0x0F, "FloatingPoint"'),
        (FORMATS, "OCTET_STRING = 0x08,", "OCTET_STRING = 0x0F,"),
    ],
    "the attribute of values is 20h": [(MODEL, VALUE, DESCRIPTION)],
    "the record is B02Dh": [(G120, "0xB02E", "0xB02D"), (SERVER, "0xB02E", "0xB02D")],
    "the drive object of a G120 is 2": [(G120, "{default: 1, allowed: [1]", "{default: 2, allowed: [2]")],
    "the drive object is one more": [
        (UNITS, "drive_object=number,", "drive_object=number + 1,"),
        (DRIVES, "def drive_object(plan", NO_RULE),
    ],
    "P1120 is Unsigned32": [(G120, REAL, UDINT)],
    "r945 is Integer16": [(G120, "title: Fault code, type: Unsigned16", "title: Fault code, type: Integer16")],
    "a read is 02h, a change 01h": [(MODEL, READ, CHANGE)],
}
"""By name: file, what stands there (every time), what stands there instead."""
BOTH = """
from plcgen.cli.main import run
run(["generate", "job.yaml", "--quiet"]) and exit(9)
exit(run(["verify", "job.yaml", "--faults", "none", "--json"]))
"""


@pytest.fixture(scope="module")
def good(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of what plcgen is run from; compiled here, so that only what a fault changes is compiled again."""
    root = tmp_path_factory.mktemp("plcgen")
    for name in ("plcgen", "specs", "templates"):
        shutil.copytree(ROOT / name, root / name, ignore=shutil.ignore_patterns("__pycache__"))
    compileall.compile_dir(root, quiet=1, invalidation_mode=py_compile.PycInvalidationMode.CHECKED_HASH)
    return root


def verified(root: Path, tmp_path: Path) -> dict:
    """What the copy of plcgen says about what it has generated."""
    (tmp_path / "job.yaml").write_text(SPEC)
    environment = {**os.environ, "PYTHONPATH": str(root), "PYTHONDONTWRITEBYTECODE": "1"}

    command = [sys.executable, "-c", BOTH]
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, check=False)
    assert done.returncode in {0, 1}, done.stderr.decode()
    return json.loads(done.stdout)


def test_the_copy_is_good(good: Path, tmp_path: Path) -> None:
    """Without a fault nothing is wrong."""
    result = verified(good, tmp_path)
    assert result["ok"], [c for group in result["groups"] for c in group["checks"] if c["outcome"] == "error"]


@pytest.mark.parametrize("name", FAULTS)
def test_a_common_fault_is_noticed(good: Path, tmp_path: Path, name: str) -> None:
    """By one of those who share nothing: a published telegram, a document, the second drive."""
    before = {file: (good / file).read_text("utf-8") for file, *_ in FAULTS[name]}
    try:
        for file, old, new in FAULTS[name]:
            text = (good / file).read_text("utf-8")
            assert old in text, (file, old)
            (good / file).write_text(text.replace(old, new), "utf-8")
        result = verified(good, tmp_path)
    finally:
        for file, text in before.items():
            (good / file).write_text(text, "utf-8")
    oracles = next(group for group in result["groups"] if group["name"] == "oracles")
    assert not result["ok"]
    assert {check["diagnostic"]["code"] for check in oracles["checks"] if check["outcome"] == "error"} == {"PG640"}
