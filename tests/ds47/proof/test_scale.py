"""Fixed point values: the spec is in the unit, the telegram counts; by hand."""

from __future__ import annotations

from pathlib import Path

import pytest

from plcgen import api
from plcgen.ds47.proof.plant import Plant
from tests.ds47.proof.conftest import Generate
from tests.ds47.proof.playing import ended, job_of, sent

SPEC = """
drives:
  a: {device: sinamics-v90, ID: 281, parameters: {P42000: {type: Integer16, unit: s, scale: 0.01}}}
jobs:
  set: {drive: a, write: {P42000: VALUE}}
"""


@pytest.mark.parametrize(
    ("value", "count"), [("3.5", "01 5e"), ("-0.01", "ff ff"), ("327.67", "7f ff"), ("0.29", "00 1d")]
)
def test_a_telegram_counts(generate: Generate, target: str, value: str, count: str) -> None:
    """P42000 = A410h, Integer16 = 03h; 3.5 s are 350 = 015Eh counts of 0.01 s, 0.29 s are 29."""
    made = generate(SPEC.replace("VALUE", value), target)
    plant = Plant(made.plan, made.program).fresh()
    plant.begin(delivered=True)
    assert ended(plant, job_of(plant, "set")) == 0
    assert sent(plant) == [f"02 02 01 10 01 a4 10 00 00 03 01 {count}"]


@pytest.mark.parametrize("value", ["3.505", "327.68", "0.001"])
def test_a_value_that_no_count_has_is_refused(tmp_path: Path, value: str) -> None:
    """Between two counts, or more of them than the type has."""
    spec = tmp_path / "job.yaml"
    sections = SPEC.replace("VALUE", value).replace("ID", "hardware_id")
    spec.write_text(f"plc: {{name: P, family: s7-1200, toolchain: tia-v18}}{sections}")
    assert "PG208" in {one.code for one in api.check(spec).diagnostics}
