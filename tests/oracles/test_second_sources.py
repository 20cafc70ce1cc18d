"""Facts that are typed twice: what verify says if the second text disagrees, and where there is no second one."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from plcgen import api
from plcgen.ds47.plan.nouns import DrivePlan
from plcgen.ds47.proof import published, second
from plcgen.ds47.sheet import review_sheet
from plcgen.oracles import documents
from plcgen.proof.checks import Check, Outcome
from plcgen.proof.folder import Folder
from plcgen.proof.versions import check_versions
from tests.projects import FAQ

SPEC = """
plc: {name: a, sources: per_block, family: s7-1500, toolchain: tia-v19}
drives:
  axis: {device: sinamics-s120, hardware_id: 281, drive_object: 3}
  belt: {device: sinamics-dcm, hardware_id: 290}
jobs:
  read_axis: {drive: axis, read: ["r948[0]"]}
  connect: {drive: axis, write: {"P2112[0]": r899.2}, allow: {P2112: told by the axis}}
  read_belt: {drive: belt, read: [P50303, P50301]}
"""


@pytest.fixture
def plan(tmp_path: Path) -> DrivePlan:
    """Parameters of a list with a second source, of one list alone, and of a manual that nobody else prints."""
    (tmp_path / "job.yaml").write_text(SPEC, "utf-8")
    project = api.check(tmp_path / "job.yaml").project
    assert project is not None
    return project.plan(DrivePlan)


def facts(plan: DrivePlan) -> dict[str, Check]:
    return {check.id: check for check in second.fact_checks(plan)}


def test_one_source_is_told(plan: DrivePlan) -> None:
    """p50303 is in a FAQ besides the profile's manual, p50301 is not; r948 and p2112 are in lists."""
    found = facts(plan)
    assert (
        found["types.sinamics-dcm"].verdict
        == "1 of 2 types: a second source agrees; one source: P50301; type inferred, not read in a manual: P50301"
    )
    assert found["types.sinamics-s120"].verdict == "2 of 2 types: a second source agrees"


def test_a_type_that_a_second_source_agrees_with_is_still_told_to_be_inferred() -> None:
    """P50304 is no row of the manual that was read, and a FAQ writes it as 08h: verify and review say so alike."""
    project = api.check(FAQ).project
    assert project is not None
    doubt = "type inferred, not read in a manual"
    plan = project.plan(DrivePlan)
    assert facts(plan)["types.sinamics-dcm"].verdict == f"2 of 2 types: a second source agrees; {doubt}: P50304"
    assert [entry.doubts[0] for entry in review_sheet(plan).writes] == [doubt]


@pytest.mark.parametrize(
    ("changed", "says"),
    [
        ({"elements": 39}, "117 elements of one parameter"),
        ({"without_index": (0, 1)}, "elements without an index: 1 to read, 1 to write"),
        ({"sources": "plain"}, "sources of sinamics-s120 are drive-object here, plain in printed values"),
    ],
)
def test_a_device_that_documents_contradict(
    plan: DrivePlan, monkeypatch: pytest.MonkeyPatch, changed: dict[str, object], says: str
) -> None:
    """Elements of a request and the make-up of sources."""
    said = documents.device("sinamics-s120")
    assert said is not None
    monkeypatch.setattr(second, "device", lambda _key: replace(said, drive_objects=(), **changed))
    found = facts(plan)["facts.axis"]
    assert (found.outcome, found.diagnostic is not None and found.diagnostic.code) == (Outcome.ERROR, "PG640")
    assert says in found.verdict


def test_a_list_that_contradicts_is_an_error(plan: DrivePlan, monkeypatch: pytest.MonkeyPatch) -> None:
    """Also where it is the list that the profile was made from."""
    wrong = {2112: (documents.DocumentedType("Integer16", "parameters of TM41 (package sdrpa201)", "sdrpa201"),)}
    monkeypatch.setattr(second, "documented_types", lambda _key: wrong)
    found = facts(plan)["types.sinamics-s120"]
    assert found.outcome is Outcome.ERROR
    assert "P2112[0] is Unsigned32 here, Integer16 in: parameters of TM41" in found.verdict


def test_limits_that_a_list_contradicts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """P2900: -10000 to 10000 in the list of VECTOR, from which the profile has them; another list says nothing."""
    spec = SPEC.replace('"P2112[0]": r899.2', "P2900: 1.0")
    (tmp_path / "job.yaml").write_text(spec, "utf-8")
    project = api.check(tmp_path / "job.yaml").project
    assert project is not None
    plan = project.plan(DrivePlan)
    assert facts(plan)["types.sinamics-s120"].outcome is Outcome.OK
    printed = documents.documented_limits("sinamics-s120")[2900]
    assert [(one.low, one.high, one.package) for one in printed] == [(-10000.0, 10000.0, "sdrpa012")]
    wrong = replace(printed[0], high=100.0)
    monkeypatch.setattr(second, "documented_limits", lambda _key: {2900: (replace(wrong, package="sdrpa201"),)})
    assert facts(plan)["types.sinamics-s120"].outcome is Outcome.OK
    monkeypatch.setattr(second, "documented_limits", lambda _key: {2900: (wrong,)})
    found = facts(plan)["types.sinamics-s120"]
    assert found.outcome is Outcome.ERROR
    assert "P2900 is -10000 to 10000 here, -10000 to 100 in: TIA Portal" in found.verdict


@pytest.mark.parametrize(
    ("file", "old", "new", "says"),
    [
        ("xml/DriveChannel.xml", 'Engineering version="V19"', 'Engineering version="V18"', "Engineering is V18"),
        ("xml/DriveChannel.xml", "Interface/v5", "Interface/v4", "SW/Interface/ is v4 in"),
        ("xml/DriveChannel.xml", "StructuredText/v4", "StructuredText/v3", "StructuredText/ is v3 in"),
        ("scl/DriveChannel.scl", "'WRREC'; LibVersion := '1.1'", "'WRREC'; LibVersion := '1.0'", "WRREC is 1.0 in"),
    ],
)
def test_versions_that_documents_contradict(tmp_path: Path, file: str, old: str, new: str, says: str) -> None:
    """Schemas of V19: interface v5, text v4; exports: WRREC 1.1. A version of the spec's own is not judged."""
    spec = tmp_path / "job.yaml"
    spec.write_text(SPEC, "utf-8")
    assert api.generate(spec, tmp_path / "out").ok
    project = api.check(spec).project
    assert project is not None
    folder = Folder(tmp_path / "out")
    assert {check.outcome for check in check_versions(project, folder)} == {Outcome.OK}
    path = tmp_path / "out" / file
    text = path.read_bytes().decode("utf-8-sig")
    assert old in text
    path.write_text(text.replace(old, new), "utf-8-sig", newline="")
    wrong = [check for check in check_versions(project, folder) if check.outcome is Outcome.ERROR]
    assert len(wrong) == 1
    assert says in wrong[0].verdict
    spec.write_text(SPEC.replace("toolchain: tia-v19", "toolchain: tia-v19, instructions: {WRREC: '1.0'}"), "utf-8")
    other = api.check(spec).project
    assert other is not None
    own = {check.id: check.outcome for check in check_versions(other, folder)}
    assert own["versions.instructions"] is Outcome.OK


def test_a_number_that_is_held_as_something_else(plan: DrivePlan, monkeypatch: pytest.MonkeyPatch) -> None:
    """An Unsigned32 is a UDINT on an S7-1500, a DWORD on an S7-300; 64 bits are numbers on an S7-1500 only."""
    assert facts(plan)["types.s7"].outcome is Outcome.OK
    assert [documents.s7_types(one)["Unsigned32"] for one in ("s7-300", "s7-1200")] == ["DWORD", "UDINT"]
    assert [documents.s7_types(one).get("Integer64") for one in ("s7-1500", "s7-1200")] == ["LINT", None]
    wrong = {**documents.s7_types("s7-1500"), "Unsigned32": "DINT"}
    monkeypatch.setattr(second, "s7_types", lambda _family: wrong)
    found = facts(plan)["types.s7"]
    assert found.outcome is Outcome.ERROR
    assert found.verdict == "Unsigned32 is held as UDINT here, as DINT by its size and sign"


def test_published_sources_and_codes(plan: DrivePlan, monkeypatch: pytest.MonkeyPatch) -> None:
    """Values of BICO sources, and the two codes of a TimeDifference, each as printed."""
    found = {check.id: check for check in published.published_checks(plan)}
    assert found["published.source"].outcome is found["published.alike"].outcome is Outcome.OK
    printed = documents.published_sources()[0]
    monkeypatch.setattr(published, "published_sources", lambda: (replace(printed, value=0x02D20002),))
    monkeypatch.setattr(published, "codes_alike", lambda: ((frozenset({0x0D, 0x35}), "a manual"),))
    found = {check.id: check for check in published.published_checks(plan)}
    assert found["published.source"].verdict.startswith("r722.2 is 02D2FC02h here, 02D20002h in: SINAMICS G110M")
    assert "is refused here, but not in: a manual" in found["published.alike"].verdict
