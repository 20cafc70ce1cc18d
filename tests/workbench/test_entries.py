"""What the form does to a spec: the new lines, and every other line as it was."""

from __future__ import annotations

from pathlib import Path

import pytest

from plcgen import api
from plcgen.base.diagnostics import DiagnosticError
from plcgen.workbench.service.specs.entries import Entries, add_parameter
from tests.projects import ROOT

BLOCK = """\
plc: {name: Press, family: s7-1500, toolchain: tia-v19}  # the plant

drives:
  axis:               # the big one
    device: sinamics-s120
    hardware_id: 270
    drive_object: 3

jobs:
  # ramps from the panel
  set_ramps:
    drive: axis
    write:
      P1120: {start: 5.0}   # up
      P1121:                # down
  read_speed: {drive: axis, read: [r21]}   # once

# the end
"""


def added(old: str, new: str) -> list[str]:
    """The lines that are new; all others must be there in their order."""
    before, found = old.splitlines(), []
    for line in new.splitlines():
        if before and line == before[0]:
            before.pop(0)
        else:
            found.append(line)
    assert before == [], new
    return found


@pytest.mark.parametrize(
    ("job", "parameter", "writes", "lines"),
    [
        ("set_ramps", "P1082", True, ["      P1082:"]),
    ],
)
def test_a_parameter_in_block_style(job: str, parameter: str, lines: list[str], *, writes: bool) -> None:
    """Behind the last one, indented like it; the comments stay where they are."""
    found = add_parameter(Entries(BLOCK, "press.yaml"), ["jobs", job], parameter, writes=writes)
    assert added(BLOCK, found) == lines


def test_a_parameter_in_flow_style() -> None:
    """In its brackets; what stands behind them stays."""
    found = add_parameter(Entries(BLOCK, "press.yaml"), ["jobs", "read_speed"], "r27", writes=False)
    assert added(BLOCK.replace("[r21]}   # once", "[r21, r27]}   # once"), found) == []


def test_a_parameter_that_is_there_is_not_added_again() -> None:
    """Whatever letter and case it is written with."""
    for text in ("P1120", "p1120", "r1120"):
        with pytest.raises(DiagnosticError, match="already"):
            add_parameter(Entries(BLOCK, "press.yaml"), ["jobs", "set_ramps"], text, writes=True)


def test_a_job_either_reads_or_writes() -> None:
    """What is written is not put into a job that reads, which would be a mistake in the spec."""
    with pytest.raises(DiagnosticError, match='has "read": a job does one of them'):
        add_parameter(Entries(BLOCK, "press.yaml"), ["jobs", "read_speed"], "P1082", writes=True)


def test_a_drive_and_a_job() -> None:
    """Behind the last one of their section, before the comment at the end of the file."""
    found = Entries(BLOCK, "press.yaml").add(["drives"], "fan", "{device: sinamics-g120, hardware_id: 271}")
    assert added(BLOCK, found) == ["  fan: {device: sinamics-g120, hardware_id: 271}"]
    found = Entries(BLOCK, "press.yaml").add(["jobs"], "save_all", "{drive: axis, save: drive_object}")
    assert found.index("save_all") < found.index("# the end")
    with pytest.raises(DiagnosticError, match="already"):
        Entries(BLOCK, "press.yaml").add(["drives"], "axis", "{}")


@pytest.mark.parametrize(
    "text",
    [
        "plc: {name: Press, family: s7-1500, toolchain: tia-v19}\n",
        "plc: {name: Press, family: s7-1500, toolchain: tia-v19}",
        "plc: {name: Press, family: s7-1500, toolchain: tia-v19}\ndrives:\n",
        "plc: {name: Press, family: s7-1500, toolchain: tia-v19}\ndrives: {}\n",
    ],
)
def test_the_first_of_its_section(text: str, tmp_path: Path) -> None:
    """The section is made if it is not there; what comes of it is a spec."""
    found = Entries(text, "a.yaml").add(
        ["drives"], "axis", "{device: sinamics-s120, hardware_id: 270, drive_object: 3}"
    )
    found = Entries(found, "a.yaml").add(["jobs"], "read_speed", "{drive: axis, read: [r21]}")
    spec = tmp_path / "a.yaml"
    spec.write_text(found, "utf-8")
    assert [d for d in api.check(spec).diagnostics if d.severity.label == "error"] == []


@pytest.mark.parametrize("spec", sorted((ROOT / "specs").glob("*.yaml")), ids=lambda path: path.stem)
def test_every_shipped_spec_keeps_its_lines(spec: Path) -> None:
    """A parameter for each job of each that may have it: no line but one is another one, and it stays YAML."""
    text = spec.read_text("utf-8")
    jobs = Entries(text, spec.name).at("jobs")
    for job in jobs.pairs if jobs is not None else ():
        for writes in (False, True):
            try:
                found = add_parameter(Entries(text, spec.name), ["jobs", job], "P29999", writes=writes)
            except DiagnosticError:
                continue  # it does the other
            node = Entries(found, spec.name).at("jobs", job, "write" if writes else "read")
            assert node is not None
            assert "P29999" in str(node.data())
            changed = set(text.splitlines()) - set(found.splitlines())
            assert len(changed) <= 1
            assert all(line.split("#")[-1] in found for line in changed if "#" in line)
