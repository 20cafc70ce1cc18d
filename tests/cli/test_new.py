"""``plcgen new``: every kind of job, the form of the FAQ, PPI; what it writes passes every check, or it is refused."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from plcgen.cli.main import run
from plcgen.workbench.starter import KINDS

DEVICES = ("sinamics-s120", "sinamics-g120", "sinamics-dcm", "micromaster-4")


@pytest.mark.parametrize("job", KINDS)
def test_every_kind_of_job_begins_well(job: str, plcgen: Callable[..., Any]) -> None:
    """On an S120 all of them; on others a spec without an error, or a reason."""
    for device in DEVICES:
        made = plcgen("new", f"{device}.yaml", "--device", device, "--job", job)
        assert made.code in ({0} if device == "sinamics-s120" else {0, 2}), made.err
        if made.code == 0:
            assert "error[" not in plcgen("check", f"{device}.yaml").err
        else:
            assert "cannot have such a job" in made.err


@pytest.mark.parametrize("family", ["s7-300", "s7-400", "s7-1200", "s7-1500"])
def test_ppi(family: str, plcgen: Callable[..., Any]) -> None:
    """A master for each family that has one."""
    assert plcgen("new", "line.yaml", "--ppi", "--family", family).code == 0
    assert plcgen("check", "line.yaml").code == (1 if family == "s7-400" else 0)


_HEAD = "Request_ID 1.0 Axis{} 2.0 Num_of_{}ara 3.0"
READ = f"Request_Ref 0.0 {_HEAD.format('', 'P')} Para_Attribute 4.0 Num_of_Element 5.0 Para_No 6.0 Subindex 8.0"
WRITE = f"{READ} Value_Format 10.0 No_of_Element 11.0 Value 12.0"
ANSWER = f"Request_Ref_Mirror 0.0 {_HEAD.format('_Mirror', 'p')} Para_Format 4.0 Num_of_Element 5.0 ParameterValue 6.0"
WRITTEN = f"Request_Ref_Mirror 0.0 {_HEAD.format('_Mirror', 'P')}"
"""FAQ 109750712, figures 4-5, 4-6, 4-9, 4-10: members and offsets of DB3 to DB6; an error's follow behind DB6."""


def test_the_project_of_the_faq(plcgen: Callable[..., Any]) -> None:
    """What ``new --faq`` writes has the data blocks, the telegrams (figure 5-1) and the flags of FAQ 109750712."""
    assert plcgen("new", "dcm.yaml", "--faq").code == 0
    checked = plcgen("check", "dcm.yaml")
    assert (checked.code, checked.err.count("PG")) == (0, 0)
    laid = plcgen("layout", "dcm.yaml").out
    for block, members in (
        ('DB3 "WR_DataBuffer"', READ), ('DB4 "RD_DataBuffer"', ANSWER),
        ('DB5 "WR_DataBuffer_1"', WRITE), ('DB6 "RD_DataBuffer_1"', WRITTEN),
    ):  # fmt: skip
        rows = [line.split() for line in laid.partition(block)[2].partition("\n\n")[0].splitlines()[2:]]
        found = " ".join(f"{row[2]} {row[0]}" for row in rows)
        assert found.partition(" Error_Format 4.0")[0] == members, block
    assert plcgen("generate", "dcm.yaml").code == 0
    said = plcgen("verify", "dcm.yaml", "--faults", "none").out
    assert "03 01 02 01 10 01 C4 7F 00 00 LEN 10" in said  # figure 5-1
    assert "04 02 02 01 10 01 C4 80 00 00 08 01 42 C8 00 00 LEN 16" in said  # 100.0, of figure 4-9 and section 5.2
    tags = Path("dcm_generated/tags.csv").read_text("utf-8-sig")
    assert "%M50.0" in tags
    assert "%M150.0" in tags


@pytest.mark.parametrize("device", DEVICES)
@pytest.mark.parametrize("family", ["s7-300", "s7-1200"])
def test_other_drives_in_the_form_of_the_faq(device: str, family: str, plcgen: Callable[..., Any]) -> None:
    """The same blocks and flags with the ramps of another drive: no problem with any."""
    assert plcgen("new", "job.yaml", "--faq", "--device", device, "--family", family).code == 0
    assert "PG" not in plcgen("check", "job.yaml").err
    assert "M150.0" in Path("job.yaml").read_text("utf-8")


def test_the_form_of_the_faq_has_no_other_jobs(plcgen: Callable[..., Any]) -> None:
    """``--job`` and ``--ppi`` are refused beside it, and so is a drive that has nothing harmless to write."""
    assert "leave --job and --ppi out" in plcgen("new", "--faq", "--job", "faults").err
    assert "leave --job and --ppi out" in plcgen("new", "--faq", "--ppi").err
    made = plcgen("new", "--faq", "--device", "sinamics-dcp")
    assert (made.code, "cannot have such a job" in made.err, Path("job.yaml").exists()) == (2, True, False)


@pytest.mark.parametrize(("device", "said"), [("sinamics-g220", "unit"), ("sinamics-g120", "drive_object")])
def test_saving_is_what_the_device_has(
    device: str, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A G220 has no p0971 (its list, TIA Portal V19), a G120 has."""
    path = tmp_path / "job.yaml"
    assert run(["new", str(path), "--device", device, "--job", "save", "--family", "s7-1500"]) == 0
    assert re.search(rf"save: {said} ", path.read_text("utf-8"))
    assert run(["check", str(path)]) == 0, capsys.readouterr().err
