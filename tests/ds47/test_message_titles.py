"""Messages that a simulated drive has are shown with their titles."""

from __future__ import annotations

import re
from pathlib import Path

from plcgen import api
from plcgen.report.review.timeline import time_line
from plcgen.report.trace.data import trace_data

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


MENTIONED = """plc: {name: Plant, family: s7-1500, toolchain: tia-v19}
drives: {a: {device: sinamics-s210-fw6, hardware_id: 270}}
jobs: {look: {drive: a, read: [r2131, r2]}, list: {drive: a, faults: current}}
"""


def test_titles_are_in_json_and_on_the_review_page(tmp_path: Path) -> None:
    """A number that is read as a parameter is a message too; 31 of r0002 is ready for switching on, in the list."""
    spec, drive = tmp_path / "job.yaml", tmp_path / "drive.yaml"
    spec.write_text(MENTIONED)
    own = "      - {pnu: 2131, type: Unsigned16, values: [30001]}\n      - {pnu: 2, type: Integer16, values: [31]}\n"
    drive.write_text(DRIVE + own)
    assert api.generate(spec, tmp_path / "out").ok
    look, listed = trace_data(api.simulate(spec, tmp_path / "out", drives=[f"a={drive}"]))["jobs"]
    assert [one["meaning"] for one in look["values"]] == [
        "F30001 Drive: overcurrent",
        "ready_for_switching_on_set_on_off1_0_1",
    ]
    assert [one["meaning"] for one in listed["values"] if one["parameter"] == "r945[0..7]"] == [
        "F30001 Drive: overcurrent"
    ]
    page = api.review(spec, tmp_path / "out", faults="none")
    run = next(one for one in page.runs if one.job == "list" and not one.fault)
    codes = next(line for line in time_line(run.trace, run.trace.jobs[0]).values if line.startswith("r945[0..7]"))
    assert re.search(r"\[\d+, \d+, 0, .*\(F\d{5} \w.*; F\d{5} \w.*\)\Z", codes), codes
