"""A step that waits and reads: one question for both, and the values are those of the answer that was waited for."""

from __future__ import annotations

from pathlib import Path

import pytest

from plcgen import api
from plcgen.ds47.plan.nouns import DrivePlan
from tests.ds47.proof.playing import noticed, told_of

SPEC = """plc: {name: Plant, family: s7-1500, toolchain: tia-v19}
drives: {a: {device: sinamics-s120, hardware_id: 270, drive_object: 3}}
jobs: {j: {drive: a, sequence: [{read: [r21, r61], until: {r899.2: 1}}, {write: {P1120: 3.0}}]}}
"""


def test_one_telegram_asks_for_both(tmp_path: Path) -> None:
    """r899 = 383h, r21 = 15h, r61 = 3Dh, in this order; P1120 = 460h is written in a telegram of its own."""
    spec = tmp_path / "job.yaml"
    spec.write_text(SPEC)
    (job,) = api.check(spec).project.plan(DrivePlan).jobs
    asked, written = (one.request.data.hex(" ") for one in job.telegrams)
    assert asked == "01 01 03 03 10 01 03 83 00 00 10 01 00 15 00 00 10 01 00 3d 00 00"
    assert written == "02 02 03 01 10 01 04 60 00 00 08 01 40 40 00 00"
    assert [use.member for use in job.outputs] == ["r899Bit2Step1", "actualSpeed", "r61"]


def test_what_does_not_fit_one_answer_is_refused(tmp_path: Path) -> None:
    """60 values of 4 bytes and a word have 4 + 2 + 240 + 4 bytes, more than 240."""
    spec = tmp_path / "job.yaml"
    own = "parameters: {P43000: {type: Unsigned32, array: 60}}, drive_object: 3"
    spec.write_text(SPEC.replace("drive_object: 3", own).replace("[r21, r61]", '["P43000[0..59]"]'))
    (told,) = [one for one in api.check(spec).diagnostics if one.code == "PG251"]
    assert told.message == "what step 1 reads while it waits does not fit one telegram"


DAMAGE = {
    "the value of another parameter": (
        "#actualSpeed := #statResponse1.actualSpeed",
        "#actualSpeed := #statResponse1.r61",
    ),
    "it does not wait": ("IF #tempMissed <> L#0 THEN", "IF FALSE THEN"),
    "a value that is read decides": ("#unit.telegram[7]", "#unit.telegram[11]"),
}


@pytest.mark.slow
@pytest.mark.parametrize("damage", DAMAGE)
def test_damage_is_noticed(damage: str, tmp_path: Path) -> None:
    """One change of a source, and verify is red."""
    found = noticed(tmp_path, SPEC, *DAMAGE[damage])
    assert told_of("j", found)
