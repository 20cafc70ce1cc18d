"""What devices take in a change: their own type, a size instead of it, or double words alone."""

from __future__ import annotations

from pathlib import Path
from typing import get_args

import pytest

from plcgen import api
from plcgen.ds47.plan.nouns import DrivePlan
from plcgen.ds47.types import TypeTextError, read_type
from plcgen.ds47.wire.formats import Takes, accepts, by_name
from plcgen.project.opening import open_spec

PROFILE = """title: ifm RM30
source: ifm RM30, PROFINET interface, p. 26
record_index: {profibus: 47, default: profibus}
drive_object: {default: 0}
scalar_elements: {read: 0, write: 0}
takes: {formats: TAKES}
"""
SPEC = """plc: {name: Encoder, family: s7-1500, toolchain: tia-v19}
drives: {encoder: {device: ./rm30.yaml, hardware_id: 270}}
jobs:
  preset: {drive: encoder, write: [{parameter: P65000, type: TYPE, value: 100}], allow: {P65000: the preset}}
"""
PRINTED = "00 02 00 01 10 00 FD E8 00 00 43 01 00 00 00 64"
"""ifm RM30, p. 26: P65000 becomes 100. The reference, 00 there, is counted by the channel."""


def spec(folder: Path, takes: str, type_: str) -> Path:
    """A spec with its profile."""
    (folder / "rm30.yaml").write_text(PROFILE.replace("TAKES", takes))
    file = folder / "job.yaml"
    file.write_text(SPEC.replace("TYPE", type_))
    return file


def test_the_printed_telegram(tmp_path: Path) -> None:
    file = spec(tmp_path, "double_word", "DoubleWord")
    plan = open_spec(file).sound().plan(DrivePlan)
    assert plan is not None
    assert plan.jobs[0].telegrams[0].request.data[1:] == bytes.fromhex(PRINTED)[1:]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("takes", "type_", "good"),
    [
        ("double_word", "DoubleWord", True),
        ("double_word", "Integer32", False),
        ("size", "Integer32", False),
        ("own", "Integer32", True),
        ("any", "Integer32", True),
    ],
)
def test_verify_refuses_what_the_profile_does_not_list(tmp_path: Path, takes: str, type_: str, *, good: bool) -> None:
    """The simulated drive answers 05h to any other format."""
    file = spec(tmp_path, takes, type_)
    assert api.generate(file, tmp_path / "out").ok
    result = api.verify(file, tmp_path / "out", faults="none", cache=None)
    found = [check.diagnostic for check in result.checks() if check.diagnostic is not None]
    assert bool(found) is not good
    assert good or "05h" in " ".join(one.message for one in found if one.code == "PG606")


def test_what_is_taken() -> None:
    """By code: 04h is Integer32, 41h to 43h are sizes."""
    taken = {
        takes: {code for code in (0x04, 0x41, 0x42, 0x43) if accepts(by_name("Integer32"), code, takes)}
        for takes in get_args(Takes)
    }
    assert taken == {"any": {0x04, 0x43}, "own": {0x04}, "size": {0x43}, "double_word": {0x43}}
    assert not accepts(by_name("Integer16"), 0x42, "double_word")


@pytest.mark.parametrize("text", ["WORD", "word", "BYTE", "DOUBLEWORD"])
def test_a_type_of_the_plc_is_no_size(text: str) -> None:
    """Who writes WORD means a number of two bytes."""
    with pytest.raises(TypeTextError):
        read_type(text)
    assert read_type("Word")[0].code == 0x42
