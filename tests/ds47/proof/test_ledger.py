"""What a drive's parameters rest on: a fact that the spec states on its place there, others on the catalogue."""

from __future__ import annotations

from pathlib import Path

from plcgen.diagnostics import Report
from plcgen.project.loading import load_spec
from plcgen.project.resolve import resolve
from plcgen.proof.ledger import Grade

SPEC = """
plc: {name: Ledger, family: s7-300, toolchain: tia-v16}
drives:
  fan:
    device: ./acme.yaml
    address: 256
    parameters:
      p1: {type: Integer16, max: 5}
      P7: {type: Integer16, min: -3}
jobs:
  look: {drive: fan, read: [P1, P2, P7, {parameter: P9, type: Unsigned16}, {parameter: P3, type: Integer32}]}
"""
PROFILE = """
title: Acme
source: manual
record_index: {profibus: 47, default: profibus}
drive_object: {default: 1}
sources: {list: "list, page 7"}
parameters:
  P1: {title: One, type: Integer16, min: 1, max: 9, source: list}
  P2: {title: Two, type: Integer16, max: 9, facts: {type: inferred}, source: list}
  P3: {title: Three, type: unknown, max: 7, source: list}
"""


def test_facts_of_the_spec_rest_on_its_place(tmp_path: Path) -> None:
    """P1 is narrowed to 5: that is the spec's, 1 is the list's; P7 is in no list; the job says what P9 and P3 are."""
    (tmp_path / "job.yaml").write_text(SPEC, "utf-8")
    (tmp_path / "acme.yaml").write_text(PROFILE, "utf-8")
    report = Report()
    loaded = load_spec(tmp_path / "job.yaml", report)
    assert loaded is not None, report
    (plan,) = resolve(loaded, report).plans
    found = {
        (one.subject, one.text): (one.source, one.grade)
        for one in plan.protocol.proof(plan).ledger()
        if one.subject.startswith("fan ")
    }
    place = "the spec, drives.fan.parameters"
    assert found == {
        ("fan P1", "type Integer16"): (f"{place}.p1", Grade.SPEC),
        ("fan P1", "min 1"): ("list, page 7", Grade.MANUAL),
        ("fan P1", "max 5"): (f"{place}.p1", Grade.SPEC),
        ("fan P2", "type Integer16"): ("list, page 7", Grade.SECOND),
        ("fan P2", "max 9"): ("list, page 7", Grade.MANUAL),
        ("fan P7", "type Integer16"): (f"{place}.P7", Grade.SPEC),
        ("fan P7", "min -3"): (f"{place}.P7", Grade.SPEC),
        ("fan P9", "type Unsigned16"): ("the spec", Grade.SPEC),
        ("fan P3", "type Integer32"): ("the spec", Grade.SPEC),
        ("fan P3", "max 7"): ("list, page 7", Grade.MANUAL),
    }
