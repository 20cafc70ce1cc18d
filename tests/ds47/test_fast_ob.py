"""A job in an OB that interrupts OB1 and a job in OB1, both on one unit and started again and again."""

from __future__ import annotations

import random
from pathlib import Path

import pytest

from plcgen import api
from plcgen.ds47.sim.load import load_drive
from plcgen.s7.cpu.testing import load_scl

SPEC = """plc: {name: Pump station, sources: per_block, family: s7-1500, toolchain: tia-v19}
drives:
  pump: {device: sinamics-g120, hardware_id: 270}
jobs:
  read_speed: {drive: pump, read: [actual_speed]}
"""
DRIVE = "objects: [{number: 1, parameters: [{pnu: 21, type: FloatingPoint, value: 1234.5}]}]\n"
FAST = """FUNCTION_BLOCK "FastCalls"
{ S7_Optimized_Access := 'FALSE' }
VAR
  fast : "ReadSpeed";
  count : Int;
  diagnosis : "typeReadSpeed_Diagnosis";
END_VAR
BEGIN
#fast(execute := NOT #fast.done AND NOT #fast.error, hardwareId := 270, driveObject := B#16#01, slot := 2,
  unit := "PumpUnit".unit, diagnosis := #diagnosis);
IF #fast.done THEN #count := #count + 1; END_IF;
END_FUNCTION_BLOCK
DATA_BLOCK "Fast_DB"
{ S7_Optimized_Access := 'FALSE' }
"FastCalls"
BEGIN
END_DATA_BLOCK
ORGANIZATION_BLOCK "OB35"
BEGIN
"Fast_DB"();
END_ORGANIZATION_BLOCK
"""


@pytest.mark.slow
def test_a_fast_ob_does_not_keep_ob1_from_its_turn(tmp_path: Path) -> None:
    """OB35 interrupts at four points of every scan of OB1: both end well, with turns that differ by one at most."""
    spec, out = tmp_path / "job.yaml", tmp_path / "out"
    spec.write_text(SPEC)
    api.generate(spec, out)
    caller = out / "scl" / "DriveCalls.scl"
    caller.write_text(caller.read_text("utf-8-sig").replace("slots := 1", "slots := 2"), "utf-8")
    fast = tmp_path / "Fast.scl"
    fast.write_text(FAST)
    files = [*out.glob("udt/*.udt"), *out.glob("db/*.db"), *out.glob("scl/*.scl"), fast]
    cpu = load_scl(*files, drives={270: load_drive(DRIVE, "pump.yaml")}, family="s7-1500").cpu
    draw, ended = random.Random(1), 0  # points of a test
    for _ in range(1000):
        cpu["DriveJobs.readSpeed.execute"] = not cpu["DriveJobs.readSpeed.done"]
        cpu.run("Main", 40, interrupt=dict.fromkeys(draw.sample(range(60), 4), "OB35"))
        assert not cpu["DriveJobs.readSpeed.error"]
        assert not cpu["Fast_DB.fast.error"]
        ended += bool(cpu["DriveJobs.readSpeed.done"])
    assert not cpu.misuses
    assert ended > 30
    assert abs(ended - int(cpu["Fast_DB.count"])) <= 1
