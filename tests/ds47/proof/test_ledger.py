"""What a drive rests on: its parameters on the spec or the catalogue, its device on what documents state as it does."""

from __future__ import annotations

from pathlib import Path

import pytest

from plcgen.base.diagnostics import Report
from plcgen.base.resources import specs_dir
from plcgen.ds47.devices import read_profile
from plcgen.project.loading import load_spec
from plcgen.project.resolve import resolve
from plcgen.proof.ledger import Assumption, Grade

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
    found = {
        (one.subject, one.text): (one.source, one.grade)
        for one in ledger(tmp_path / "job.yaml")
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


def ledger(spec: Path) -> list[Assumption]:
    """Every assumption of a spec."""
    report = Report()
    loaded = load_spec(spec, report)
    assert loaded is not None, report
    (plan,) = resolve(loaded, report).plans
    return list(plan.protocol.proof(plan).ledger())


S120 = """
plc: {name: Ledger, family: s7-300, toolchain: tia-v16}
drives: {axis: {device: sinamics-s120, address: 256, record_index: profibus}}
jobs: {look: {drive: axis, read: [r21]}}
"""


@pytest.mark.parametrize(
    ("old", "new", "text", "grade"),
    [
        ("profibus: 47", "profibus: 47", "parameters are reached through record 002Fh (profibus)", Grade.MANUAL),
        ("profibus: 47", "profibus: 46", "parameters are reached through record 002Eh (profibus)", Grade.SECOND),
        ("default: 2,", "default: 3,", "drive object 3 by default, of any", Grade.SECOND),
        ("format: exact", "format: size", "a value is answered by size (41h to 43h)", Grade.SECOND),
    ],
)
def test_a_statement_that_no_document_makes_has_none_as_its_source(
    old: str, new: str, text: str, grade: Grade, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The S120 function manual prints record 47, drive object 2 and answers in the type of the parameter."""
    shipped = (specs_dir() / "devices/sinamics-s120.yaml").read_text("utf-8")
    assert old in shipped
    profile = tmp_path / "sinamics-s120.yaml"
    profile.write_text(shipped.replace(old, new, 1), "utf-8")
    monkeypatch.setattr("plcgen.ds47.devices._shipped_device", lambda key: read_profile(profile, key))
    (tmp_path / "job.yaml").write_text(S120, "utf-8")
    found = {one.text: one for one in ledger(tmp_path / "job.yaml")}
    assert found[text].grade is grade
    assert ("function manual communication (12/2018" in found[text].source) is (grade is Grade.MANUAL)
