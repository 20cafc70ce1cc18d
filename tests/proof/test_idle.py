"""The idle scan: its statements are counted."""

from __future__ import annotations

from pathlib import Path

import pytest

from plcgen import api
from plcgen.proof.checks import Outcome
from plcgen.proof.idle import count, idle_check
from plcgen.s7.cpu.program import Program
from plcgen.s7.scl.dialect import Dialect
from tests.projects import ROOT

SOURCE = """
FUNCTION_BLOCK FB 1
VAR_INPUT execute : BOOL; END_VAR
VAR started, n : INT; END_VAR
BEGIN
  IF NOT execute THEN        // 1
    IF started < 2 THEN      // 2
      started := started + 1;   // in the first two scans only
    END_IF;
    RETURN;                  // 3
  END_IF;
  n := n + 1;
END_FUNCTION_BLOCK
DATA_BLOCK DB 1 FB 1
BEGIN
END_DATA_BLOCK
ORGANIZATION_BLOCK OB 1
VAR_TEMP info : ARRAY[0..19] OF BYTE; END_VAR
BEGIN
  FB1.DB1(execute := FALSE);   // 1, and 3 of the block
  FB1.DB1(execute := FALSE);   // 1, and 3 of the block
END_ORGANIZATION_BLOCK
"""


def test_statements_are_counted_by_hand() -> None:
    """Two calls with three statements in each, when the block has settled: 8."""
    program = Program.load([("x.scl", SOURCE)], Dialect.STEP7_V5, coverage=True)
    assert program.ok, program.diagnostics
    assert count(program) == 8
    assert idle_check(program).text == "8 statements"


def test_without_a_cyclic_ob_it_is_not_run() -> None:
    """Not run is not passed."""
    program = Program.load([("x.scl", SOURCE[: SOURCE.index("ORGANIZATION")])], Dialect.STEP7_V5)
    assert idle_check(program).outcome is Outcome.NOT_RUN


@pytest.mark.slow
def test_generate_counts_on_request(tmp_path: Path) -> None:
    """A job more is a statement or more in every scan; without the request nothing is run."""
    spec = tmp_path / "job.yaml"
    text = (ROOT / "specs" / "s7-300_6ra80_dp_tia.yaml").read_text("utf-8")
    spec.write_text(text, "utf-8")
    assert api.generate(spec, tmp_path / "a").idle_statements is None
    before = api.generate(spec, tmp_path / "a", stats=True).size()
    spec.write_text(text.rstrip() + "\n  more: {drive: dcm, read: [P50304]}\n", "utf-8")
    after = api.generate(spec, tmp_path / "b", stats=True).size()
    assert before is not None
    assert after is not None
    assert 0 < before.data()["idle_statements"] < after.data()["idle_statements"]
    assert "an idle scan runs" in after.text()
