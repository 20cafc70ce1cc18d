"""IMPORT.md of single projects: what it says of tags, calls, flags and of values in data blocks."""

from __future__ import annotations

from pathlib import Path

import pytest

from plcgen import api
from tests.projects import FAQ, MM4, TARGETS, retargeted

BARE = """plc: {{name: Pump station, family: {family}, toolchain: {toolchain}}}
drives: {{pump: {{device: sinamics-g120, hardware_id: 270, address: 256}}}}
jobs: {{set_ramp: {{drive: pump, write: {{P1120: 5.0}}{more}}}}}
"""


def guide(text: str, folder: Path) -> str:
    """The import guide of a spec in one line."""
    (folder / "job.yaml").write_text(text, "utf-8")
    assert api.generate(folder / "job.yaml", folder / "out").ok
    assert api.verify(folder / "job.yaml", folder / "out", faults="none").ok
    return " ".join((folder / "out/IMPORT.md").read_text("utf-8").split())


@pytest.mark.parametrize(("target", "call"), [("t15", '"DriveCalls_DB"();'), ("v5", '"DriveCalls"."DriveCalls_DB"();')])
def test_the_step_names_what_is_called(target: str, call: str, tmp_path: Path) -> None:
    """The line that goes into a main program, as it stands in the example."""
    family, toolchain = TARGETS[target]
    text = guide(BARE.format(family=family, toolchain=toolchain, more=""), tmp_path)
    assert f"`{call}`." in text
    assert call in (tmp_path / "out/example/Main.scl").read_text("utf-8-sig")


@pytest.mark.parametrize(("more", "named"), [("", False), (", trigger: {execute: M50.0}", True)])
def test_flags_are_spoken_of_where_there_are_some(more: str, *, named: bool, tmp_path: Path) -> None:
    """Without flags and symbols nothing is named above the structure of the job."""
    family, toolchain = TARGETS["t15"]
    text = guide(BARE.format(family=family, toolchain=toolchain, more=more), tmp_path)
    assert ("What a flag or symbol is named for above" in text) == named
    assert ("The sources use them: without the tags these names are undefined." in text) == named


@pytest.mark.parametrize("target", ["t3", "v5"])
def test_a_request_in_a_data_block_says_where_its_value_lives(target: str, tmp_path: Path) -> None:
    """4 bytes of header, 6 of the address, 2 of format and number: the REAL of a write begins at byte 12."""
    text = guide(retargeted(FAQ, target), tmp_path)
    assert "| 100.0 | start value. A run sends what WR_DataBuffer_1.Value (DB5.DBD12) holds;" in text


def test_a_constant_inside_the_block_is_what_is_sent(tmp_path: Path) -> None:
    """Without a data block of the request there is no place to change it."""
    assert "A run sends what" not in guide(MM4.read_text("utf-8"), tmp_path)


@pytest.mark.parametrize(("language", "said"), [("de-DE", "in jedem Lauf neu"), ("zh-CN", "每次运行都更新")])
def test_new_sentences_have_translations(language: str, said: str, tmp_path: Path) -> None:
    """Of the reference in the layout sheet, the value in the data block, the calls."""
    text = guide(FAQ.read_text("utf-8").replace("languages: [en-US, zh-CN]", f"languages: [{language}]"), tmp_path)
    assert said in (tmp_path / "out/LAYOUT.md").read_text("utf-8")
    for english in ("A run sends", "copy the calls", "undefined", "named for above"):
        assert english not in text
