"""What somebody asks who has never imported such files: where a job starts, where its results are, what to address."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

from tests.build.test_guides import lines, project, wrong

DRIVES = ("s7-300_6ra80_dp_tia", "s7-300_mm440_dp", "s7-1500_g120_pn")
PPI = ("s7-1200_s7-200_ppi", "s7-300_s7-200_ppi_cp341")


@pytest.mark.parametrize("name", [*DRIVES, *PPI])
def test_the_guide_answers_what_a_newcomer_asks(name: str, tmp_path: Path) -> None:
    """Start and results of a job, symbolic access of what has no fixed number, loading again, watch tables."""
    spec = project(tmp_path, name, "en-US")
    assert wrong(spec, tmp_path / "en-US") == []
    said = lines(tmp_path / "en-US")
    text = " ".join(said["IMPORT.md"])
    control = "PpiJobs" if name in PPI else "DriveJobs"
    assert f"The structure of a job is in `{control}`: `execute` starts the job" in text
    assert ("`diagnosis` are beside it" in text) == (name in DRIVES)
    assert ("Address the structure by name" in text) == (not (tmp_path / "en-US" / "symbols.sdf").exists())
    assert ("`hardware_id` in the spec takes the number or the name" in text) == (name == "s7-1500_g120_pn")
    assert "Importing again replaces blocks of the same name; loaded data blocks begin with start values" in text
    page = tmp_path / "en-US" / "LAYOUT.md"
    named = f"Programs and panels address `{control}` by name: a structure for each job. "
    assert named in " ".join(said["LAYOUT.md"])
    page.write_text(page.read_text("utf-8").replace(f"`{control}`", "`Jobs`"), "utf-8")
    assert "address `Jobs` by name" in " ".join(wrong(spec, tmp_path / "en-US"))
    assert "The files of `watch`" in text
    assert ("Openness" in text.partition("The files of `watch`")[2]) == ("xml/IMPORT.md" in said)


@pytest.mark.parametrize("name", ["s7-300_6ra80_dp_tia", "s7-1500_g120_pn"])
def test_the_page_of_the_documents_names_the_script_only_where_there_is_one(name: str, tmp_path: Path) -> None:
    """An S7-300 has neither the script nor optimized access: no row of its page is about them."""
    project(tmp_path, name, "en-US")
    text = (tmp_path / "en-US" / "xml" / "IMPORT.md").read_text("utf-8")
    script = (tmp_path / "en-US" / "xml" / "import.ps1").exists()
    assert script == (name == "s7-1500_g120_pn")
    assert ("-Overwrite" in text, "MemoryLayout" in text) == (script, script)


@pytest.mark.parametrize("name", [*DRIVES, *PPI])
def test_modify_all_starts_no_job(name: str, tmp_path: Path) -> None:
    """No watch table offers a value for what starts a job, be it a member, a flag or a tag."""
    project(tmp_path, name, "en-US")
    rows = []
    for table in (tmp_path / "en-US" / "watch").glob("*.csv"):
        rows += list(csv.reader(table.read_text("utf-8-sig").splitlines(), delimiter=";"))[1:]
    assert rows
    assert [row for row in rows if row[3].upper() == "TRUE"] == []


@pytest.mark.parametrize(("language", "said"), [("en-US", ", read back"), ("de-DE", ", zurückgelesen")])
def test_a_value_that_is_read_back_says_so(language: str, said: str, tmp_path: Path) -> None:
    """Each written parameter of the example is an input and an output of the block: their comments differ."""
    spec = project(tmp_path, "s7-1500_g120_readback", language)
    assert wrong(spec, tmp_path / language) == []
    (source,) = (tmp_path / language).glob("*.scl")
    control = source.read_text("utf-8-sig").partition('DATA_BLOCK "DriveJobs"')[2].partition("END_DATA_BLOCK")[0]
    outputs = [line for line in control.splitlines() if "Back : " in line]
    assert outputs
    assert [line for line in outputs if said not in line] == []
