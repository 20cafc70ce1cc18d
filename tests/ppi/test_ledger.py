"""What a PPI master rests on: who says so, and how well that is known."""

from __future__ import annotations

from pathlib import Path

import pytest

from plcgen.base.diagnostics import Report
from plcgen.project.loading import load_spec
from plcgen.project.resolve import resolve
from plcgen.proof.ledger import Assumption, Grade

SPEC = """
plc: {name: Ledger, family: FAMILY}
ppi:
  line:
    MODULE
    ack_timeout: 900ms
    stations: {pump: {address: 2, cpu: "224"}, other: {address: 3}}
    jobs:
      all: {station: pump, read: [VB100, MB0, T37, C5, HC0, S0.0, SMB34]}
      few: {station: other, write: {MB0: 1}}
      go: {station: pump, run: true}
"""
MODULES = {
    "cm": ("s7-1200, toolchain: tia-v19", "module: cm1241\n    port: 270"),
    "cp": ("s7-300, toolchain: tia-v19", "module: cp341\n    address: 256"),
}


def assumptions(folder: Path, module: str) -> dict[tuple[str, str], Assumption]:
    """The ledger of a spec by subject and text."""
    family, text = MODULES[module]
    (folder / "job.yaml").write_text(SPEC.replace("FAMILY", family).replace("MODULE", text), "utf-8")
    report = Report()
    loaded = load_spec(folder / "job.yaml", report)
    assert loaded is not None, report
    found = [one for plan in resolve(loaded, report).plans for one in plan.protocol.proof(plan).ledger()]
    assert len(found) == len(set(found))
    return {(one.subject, one.text): one for one in found}


GRADES = {
    ("PPI read", "function 04h"): Grade.OBSERVED,
    ("PPI write", "function 05h"): Grade.OBSERVED,
    ("PPI run", "function 28h"): Grade.OBSERVED,
    ("PPI", "area 84h"): Grade.OBSERVED,
    ("PPI", "area 05h"): Grade.OBSERVED,
    # nodave.h: daveTimer200 31, daveCounter200 30; it has no name for HC (20h) and S (04h)
    ("PPI", "area 1Fh, timers: status byte and 32 bits"): Grade.SECOND,
    ("PPI", "area 1Eh, counters: status byte and 16 bits"): Grade.SECOND,
    ("PPI", "area 20h, high-speed counters"): Grade.GENERAL,
    ("PPI", "area 04h"): Grade.GENERAL,
    # profiles.toml: V and SM of a CPU 224 are unchecked, M is not
    ("line pump", "CPU 224 has 32 bytes of M"): Grade.SECOND,
    ("line pump", "CPU 224 has 8192 bytes of V"): Grade.GENERAL,
    ("line pump", "CPU 224 has 6 elements of HC"): Grade.GENERAL,
    ("line other", "CPU 226 has 32 bytes of M"): Grade.SECOND,
    ("line", "E5 has been received after 900 ms"): Grade.SPEC,
    ("line", "the reply to a poll has been received"): Grade.GENERAL,
    ("line", "a cycle of OB1 takes 50 ms at most"): Grade.SPEC,
}


@pytest.mark.parametrize("module", MODULES)
def test_every_assumption_has_its_grade(module: str, tmp_path: Path) -> None:
    """Services and areas that are used, the memory that is addressed, times; nothing of what the spec does not use."""
    found = assumptions(tmp_path, module)
    for (subject, start), grade in GRADES.items():
        (one,) = (one for (who, text), one in found.items() if who == subject and text.startswith(start))
        assert (one.grade, bool(one.source)) == (grade, True), one
    assert not any(start in text for _, text in found for start in ("29h", "area 81h", "bytes of Q", "of V of CPU 226"))
    assert not any(subject == "line other" and "of V" in text for subject, text in found)


def test_the_module_has_its_own_source(tmp_path: Path) -> None:
    """A CP 341 by its manual, a CM 1241 by the help of the TIA Portal."""
    sources = {
        module: {one.source for (subject, _), one in assumptions(tmp_path, module).items() if subject == "line"}
        for module in MODULES
    }
    assert any("A5E02191071-01" in source for source in sources["cp"] - sources["cm"])
    assert any("Receive_Config" in source for source in sources["cm"] - sources["cp"])
