"""Messages that a simulated drive has are shown with their titles."""

from __future__ import annotations

from pathlib import Path

from plcgen import api

DRIVE = """objects:
  - number: 2
    parameters:
      - {pnu: 944, type: Unsigned16, values: [1]}
      - {pnu: 945, type: Unsigned16, values: [30001, 1, 0, 0, 0, 0, 0, 0]}
      - {pnu: 949, type: Integer32, values: [1, 2, 0, 0, 0, 0, 0, 0]}
      - {pnu: 948, type: TimeDifference, values: [9, 8, 0, 0, 0, 0, 0, 0]}
"""


def test_a_simulated_run_shows_titles(tmp_path: Path) -> None:
    """F30001 of an S210 of firmware 6 as its list of messages (sdral401) has it; no list has F00001."""
    spec, drive = tmp_path / "job.yaml", tmp_path / "drive.yaml"
    spec.write_text("""plc: {name: Plant, family: s7-1500, toolchain: tia-v19}
drives: {a: {device: sinamics-s210-fw6, hardware_id: 270}}
jobs: {look: {drive: a, faults: current}}
""")
    drive.write_text(DRIVE)
    assert api.generate(spec, tmp_path / "out").ok
    trace = api.simulate(spec, tmp_path / "out", drives=[f"a={drive}"])
    (job,) = trace.jobs
    assert [one.meaning for one in job.values if one.label == "r945[0..7]"] == ["F30001 Drive: overcurrent"]
    assert {one.meaning for one in job.values if one.label != "r945[0..7]"} == {""}
