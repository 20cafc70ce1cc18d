"""Runs of the FAQ's read job, the shipped folders, and a program of the user's own."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from plcgen import api
from plcgen.report.trace.model import Trace
from tests.projects import FAQ, ROOT, retargeted

EXPECTED = ROOT / "examples" / FAQ.stem / "expected"


@pytest.fixture(scope="session")
def folders(tmp_path_factory: pytest.TempPathFactory) -> dict[str, tuple[Path, Path]]:
    """The FAQ's spec with its generated folder, for the three dialects."""
    found: dict[str, tuple[Path, Path]] = {"faq": (FAQ, EXPECTED)}
    for target in ("v5", "t3", "t15"):
        folder = tmp_path_factory.mktemp(target)
        spec = folder / "job.yaml"
        spec.write_text(retargeted(FAQ, target), encoding="utf-8")
        assert api.generate(spec, folder / "out").ok
        found[target] = spec, folder / "out"
    return found


@pytest.fixture
def run(folders: dict[str, tuple[Path, Path]]) -> Callable[..., Trace]:
    """Simulate the FAQ's project; ``target`` is a dialect, the rest goes to ``api.simulate``."""

    def simulate(target: str = "faq", **more: Any) -> Trace:
        return api.simulate(*folders[target], **more)

    return simulate


OWN = """FUNCTION_BLOCK "Sender"
{ S7_Optimized_Access := 'FALSE' }
VAR
  wr {InstructionName := 'WRREC'; LibVersion := '1.0'} : WRREC;
  step : Int;
  buffer : Array[0..9] of Byte;
END_VAR
BEGIN
#buffer[0] := B#16#05;
#buffer[1] := B#16#01;
#buffer[2] := B#16#02;
#buffer[3] := B#16#01;
#buffer[4] := B#16#10;
#buffer[5] := B#16#01;
#buffer[6] := B#16#C4;
#buffer[7] := B#16#7F;
#step := #step + 1;
#wr(REQ := #step < 3, ID := DW#16#100, INDEX := 47, LEN := SEL(G := #step = 2, IN0 := 10, IN1 := 9), RECORD := #buffer);
END_FUNCTION_BLOCK
DATA_BLOCK "Sender_DB"
{ S7_Optimized_Access := 'FALSE' }
"Sender"
BEGIN
END_DATA_BLOCK
ORGANIZATION_BLOCK "MyCycle"
{ S7_Optimized_Access := 'FALSE' }
BEGIN
"Sender_DB"();
END_ORGANIZATION_BLOCK
"""
"""A block that changes LEN in the second call of a job, and the OB that calls it."""


@pytest.fixture
def own(tmp_path: Path) -> Path:
    """File of the user's own program."""
    path = tmp_path / "own.scl"
    path.write_text(OWN, encoding="utf-8")
    return path
