"""Triggers in the user's own program: text, XML, tables, stand-ins, and the check that finds what is missing."""

from __future__ import annotations

from pathlib import Path

import pytest

from plcgen import api
from plcgen.base.diagnostics import Diagnostic
from plcgen.s7.cpu.sources import SourceCheck, Tags, check_program, find_sources, read_tag_file
from plcgen.s7.scl.dialect import Dialect

TARGETS = {
    "step7-v5": ("s7-300", "address: 256", Dialect.STEP7_V5),
    "tia-v16": ("s7-300", "address: 256", Dialect.TIA_300_400),
    "tia-v19": ("s7-1500", "hardware_id: 270", Dialect.TIA_1200_1500),
}
PLANT = """DATA_BLOCK "Plant"
STRUCT
  startRamps : BOOL;
  line : ARRAY[1..3] OF STRUCT done : BOOL; status : WORD; END_STRUCT;
END_STRUCT;
BEGIN
END_DATA_BLOCK
"""


def spec(folder: Path, toolchain: str) -> Path:
    """Two jobs that the user's program starts."""
    family, where, _ = TARGETS[toolchain]
    path = folder / "job.yaml"
    path.write_text(
        f"""
plc: {{name: a, sources: per_block, family: {family}, toolchain: {toolchain}}}
drives: {{d: {{device: sinamics-g120, {where}}}}}
jobs:
  set_ramps:
    drive: d
    write: {{P1120: null}}
    trigger: {{execute: Tag_1, done: '"Plant".line[2].done', status: "Plant.line[3].status"}}
  read_ramps: {{drive: d, read: [P1120], trigger: Plant.startRamps}}
""",
        "utf-8",
    )
    return path


@pytest.mark.parametrize("toolchain", TARGETS)
def test_symbols_stand_where_the_instances_are_called(toolchain: str, tmp_path: Path) -> None:
    """In the text and in its XML; DriveJobs has no such members, the guide lists what must be there."""
    out = tmp_path / "out"
    assert api.generate(spec(tmp_path, toolchain), out).ok
    calls = (out / "scl" / "DriveCalls.scl").read_text("utf-8-sig")
    for symbol in ('"Tag_1"', '"Plant".line[2].done', '"Plant".line[3].status', '"Plant".startRamps'):
        assert symbol in calls
        assert f"`{symbol}`" in (out / "IMPORT.md").read_text("utf-8")
    if toolchain != "step7-v5":
        xml = (out / "xml" / "DriveCalls.xml").read_text("utf-8")
        assert '<Component Name="Tag_1"' in xml
        assert '<Component Name="startRamps"' in xml
    jobs = next((out / "db").glob("DriveJobs.*")).read_text("utf-8-sig")
    assert jobs.count("execute") == 0
    assert jobs.count("busy") == 2
    assert "startRamps" in (out / "watch" / "ReadRamps.csv").read_text("utf-8-sig")


@pytest.mark.parametrize("toolchain", TARGETS)
def test_a_program_check_finds_what_is_missing(toolchain: str, tmp_path: Path) -> None:
    """With the user's sources and tags it is a whole program, without them it is not."""
    out, dialect = tmp_path / "out", TARGETS[toolchain][2]
    assert api.generate(spec(tmp_path, toolchain), out).ok
    table = out / "symbols.sdf"
    tags: Tags = read_tag_file(table) if table.is_file() else {}
    found = _but_error_obs(check_program(find_sources(out), dialect, tags))
    assert {(d.code, d.message) for d in found} == {
        ("PG820", "Tag_1 is not defined"),
        ("PG820", "Plant is not defined"),
    }
    own = tmp_path / "Plant.db"
    own.write_text(PLANT, "utf-8")
    assert _but_error_obs(check_program([*find_sources(out), own], dialect, tags | {"Tag_1": ("M10.0", "BOOL")})) == []


def _but_error_obs(checked: SourceCheck) -> list[Diagnostic]:
    """PG845 apart: the organization blocks for errors are the user's own, too."""
    return [one for one in checked.diagnostics if one.code != "PG845"]


@pytest.mark.slow
@pytest.mark.parametrize("toolchain", TARGETS)
def test_jobs_run_with_stand_ins_and_with_the_users_own_block(toolchain: str, tmp_path: Path) -> None:
    """Verify and simulate need no other program; a block of the user's replaces its stand-in."""
    path, out = spec(tmp_path, toolchain), tmp_path / "out"
    assert api.generate(path, out).ok
    seen = api.verify(path, out)
    assert seen.ok, [(c.id, c.verdict) for c in seen.checks() if c.outcome.value == "error"]
    assert [job.ending for job in api.simulate(path, out).jobs] == ["done", "done"]
    own = tmp_path / "plant.scl"
    own.write_text(PLANT, "utf-8")
    trace = api.simulate(path, out, own=[own])
    assert [job.ending for job in trace.jobs] == ["done", "done"]
    own.write_text(PLANT.replace("startRamps", "start"), "utf-8")
    wrong = api.simulate(path, out, own=[own])
    assert any("startRamps" in d.message for d in wrong.diagnostics if d.severity.label == "error")
