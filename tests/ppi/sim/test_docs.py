"""docs/s7-200.md tells the truth: its file loads, its tables are complete."""

from __future__ import annotations

import re
from pathlib import Path

from plcgen.ppi.sim.faults import FaultKind
from plcgen.ppi.sim.load import SingleKeys, load_bus
from plcgen.ppi.wire.profiles import profiles

PAGE = (Path(__file__).parents[3] / "docs" / "s7-200.md").read_text("utf-8")


def test_the_file_of_the_page_loads() -> None:
    (text,) = re.findall(r"```yaml\n(.*?)```", PAGE, re.DOTALL)
    bus = load_bus(text)
    assert bus.stations[2]["speed"] == 1500
    assert bus.stations[2]["VB200[8]"] == b"hello\0\0\0"
    assert len(bus.faults) == 1


def test_every_key_fault_and_cpu_is_described() -> None:
    named = set(re.findall(r"`([a-z_]+)`", PAGE))
    assert set(SingleKeys.model_fields) <= named
    assert {kind.value for kind in FaultKind} <= named
    assert all(key in PAGE for key in profiles())
