"""What runs on an S7-1200 and an S7-400: the text of the S7-1500 and the S7-300, whose blocks the proof runs.

The soft CPU knows three dialects of SCL, not four families; tests/ds47/proof runs every kind of job in all of them.
Integers of 64 bits, which an S7-1200 has no type for, are in tests/build/test_goldens.py.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from plcgen import api
from plcgen.ds47.plan.nouns import DrivePlan
from plcgen.ds47.registry import shipped
from plcgen.project.opening import open_spec

SPEC = """
plc: {{name: Plant, sources: per_block, family: {family}, toolchain: {toolchain}}}
units:
  cu1:
    device: sinamics-s120
    wait: 30min
    drives:
      control: {{{key}: 280, drive_object: 1}}
      axis:
        {key}: 281
        drive_object: 3
        parameters: {{P2907: {{type: "OctetString[3]"}}, P3121: {{type: Unsigned16, min: 0, max: 9}}}}
recipes: {{spool: {{parameters: [P3121, P1120], records: {{small: {{P3121: 1}}, large: {{P3121: 2}}}}}}}}
jobs:
  read: {{drive: axis, read: [r21, "r945[0..7]", P2907]}}
  write: {{drive: axis, write: {{P1120: null, P2907: "010203"}}}}
  bits: {{drive: axis, write: {{P3121.0: null, P3121.2: 1}}}}
  kept: {{drive: axis, write: {{P1120: null, P3121.1: 1}}, verify: readback, save: drive_object}}
  restored: {{drive: axis, write: {{P1121: null, P3121: 3}}, verify: readback, on_error: restore}}
  compare: {{drive: axis, compare: {{P1120: null, P2900: 1.0}}}}
  save: {{drive: control, save: unit}}
  faults: {{drive: axis, faults: {{history: 2}}}}
  alarms: {{drive: axis, alarms: {{history: 2}}}}
  acknowledge: {{drive: axis, acknowledge: true}}
  sequence: {{drive: axis, sequence: [{{write: {{P3121: 1}}}}, {{until: {{P3121: 1, P1120: "> 0.5"}}}}, {{read: r21}}]}}
  activate: {{drive: axis, activate: input}}
  clock: {{drive: control, clock: utc}}
  look: {{drive: axis, service: read}}
  load: {{drive: axis, write_recipe: spool, verify: readback, on_error: restore}}
  store: {{drive: axis, read_recipe: spool}}
  check: {{drive: axis, compare_recipe: spool}}
"""
SAME = {
    "s7-1200": ("s7-1500", "tia-v19", "hardware_id", 4, 10),
    "s7-400": ("s7-300", "tia-v16", "address", 8, 4),
    "s7-400 in STEP 7 V5": ("s7-300", "step7-v5", "address", 8, 4),
}
"""The family whose text it is, the tool, the key of an address, record jobs at once (Siemens entry 15364459)."""


HASH = re.compile(r"\bH[0-9A-F]{7}\b")


def generated(folder: Path, family: str, toolchain: str, key: str) -> dict[str, list[str]]:
    """What is compiled or imported, line by line, but for what lists or counts the files."""
    folder.mkdir()
    (folder / "job.yaml").write_text(SPEC.format(family=family, toolchain=toolchain, key=key), "utf-8")
    assert api.generate(folder / "job.yaml", folder / "out").ok
    plan = open_spec(folder / "job.yaml").sound().plan(DrivePlan)
    assert plan is not None
    assert {job.kind for job in plan.jobs} == {kind.key for kind in shipped()}
    paths = sorted(
        path for path in (folder / "out").rglob("*") if path.suffix in {".scl", ".udt", ".db", ".xml", ".sdf"}
    )
    return {path.relative_to(folder / "out").as_posix(): path.read_text("utf-8-sig").splitlines() for path in paths}


@pytest.mark.parametrize("family", SAME)
def test_every_kind_is_the_same_text(family: str, tmp_path: Path) -> None:
    """One line differs: how many record jobs the caller lets run at once; and with it the caller's hash of itself."""
    other, toolchain, key, places, others = SAME[family]
    mine = generated(tmp_path / "mine", family.partition(" ")[0], toolchain, key)
    found = generated(tmp_path / "other", other, toolchain, key)
    assert len(mine) > 60
    assert [*mine] == [*found]
    assert [len(lines) for lines in mine.values()] == [len(lines) for lines in found.values()]
    differ = {
        name: [
            pair for pair in zip(mine[name], found[name], strict=True) if HASH.sub("", pair[0]) != HASH.sub("", pair[1])
        ]
        for name in mine
        if mine[name] != found[name]
    }
    assert [*differ] == ["scl/DriveCalls.scl", "xml/DriveCalls.xml"][: 1 if toolchain == "step7-v5" else 2]
    for (own, its), *more in differ.values():
        assert more == []
        assert any(own.replace(form.format(places), form.format(others)) == its for form in ("places := {}", ">{}</"))
