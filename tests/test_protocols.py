"""The face of a protocol: every protocol keeps its promises, and a toy from elsewhere works like a shipped one."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

import plcgen
from plcgen import api
from plcgen.base.diagnostics import PluginError
from plcgen.project.nouns import Plan
from plcgen.project.registry import SHIPPED, protocols
from plcgen.protocol.base import Protocol
from tests.projects import ROOT, SPECS, per_block

SPEC = """
plc: {name: Toys, family: FAMILY, toolchain: TOOLCHAIN}
beacons: {red: {number: 3}, green: {number: 4}}
"""
TARGETS = [("s7-300", "step7-v5"), ("s7-400", "tia-v16"), ("s7-1500", "tia-v19")]


@pytest.fixture(params=TARGETS, ids=lambda target: target[1])
def toy(distribution, tmp_path: Path, request: pytest.FixtureRequest) -> Path:
    """A spec of the toy protocol, whose distribution is installed."""
    distribution("beacon", "plcgen.protocols", "beacon = beacon:PROTOCOL", ROOT / "tests" / "toys" / "beacon")
    family, toolchain = request.param
    path = tmp_path / "toy.yaml"
    path.write_text(SPEC.replace("FAMILY", family).replace("TOOLCHAIN", toolchain), "utf-8")
    return path


def test_a_toy_is_generated_and_verified(toy: Path, tmp_path: Path) -> None:
    """From the spec to the check of its bytes on disk: BEh and the number of the lamp, without a change of plcgen."""
    result = api.generate(toy, tmp_path / "out")
    assert [d for d in result.diagnostics if d.severity.label == "error"] == []
    verification = api.verify(toy, tmp_path / "out")
    telegrams = [(c.subject, c.text, c.outcome.value) for c in verification.checks() if c.id.startswith("telegram.")]
    assert telegrams == [("red", "BE 03", "ok"), ("green", "BE 04", "ok")]
    assert verification.ok, [(c.id, c.verdict) for c in verification.checks() if c.outcome.value == "error"]


def test_the_proof_of_a_toy_can_fail(toy: Path, tmp_path: Path) -> None:
    """A byte that was changed on disk is noticed by its own check."""
    toy.write_text(per_block(toy.read_text("utf-8")), "utf-8")
    api.generate(toy, tmp_path / "out")
    source = next(path for path in (tmp_path / "out" / "db").iterdir() if path.name.startswith("Red_Request"))
    data = source.read_bytes()
    assert data.count(b"16#03") == 1
    source.write_bytes(data.replace(b"16#03", b"16#07"))
    wrong = [c.text for c in api.verify(toy, tmp_path / "out").checks() if c.outcome.value == "error"]
    assert "BE 07" in wrong


def test_the_other_verbs_know_a_toy(toy: Path, tmp_path: Path) -> None:
    """Rules, layouts, comparison and schema."""
    assert [(table.name, table.size) for table in api.layout(toy).blocks] == [("Red_Request", 2), ("Green_Request", 2)]
    other = tmp_path / "other.yaml"
    other.write_text(toy.read_text("utf-8").replace("number: 4", "number: 5"), "utf-8")
    changes = [(change.kind, change.message) for change in plcgen.diff(toy, other).changes]
    assert ("telegram-field", "byte 1: lamp 4 -> 5") in changes
    other.write_text(toy.read_text("utf-8").replace("number: 4", "number: 40"), "utf-8")
    assert [d.message for d in api.check(other).diagnostics] == ["there is no lamp 40"]
    assert "beacons" in json.dumps(api.schema())


def test_a_toy_stands_beside_drives(toy: Path, tmp_path: Path) -> None:
    """One spec, two protocols: blocks of both, and one OB that calls all."""
    drives = "drives: {fan: {device: sinamics-g120, address: 256, hardware_id: 270}}\n"
    jobs = "jobs: {ramps: {drive: fan, read: [P1120]}}\n"
    toy.write_text(toy.read_text("utf-8") + drives + jobs, "utf-8")
    assert api.generate(toy, tmp_path / "out").ok
    assert api.verify(toy, tmp_path / "out", faults="none").ok
    main = (tmp_path / "out" / "example" / "Main.scl").read_text("latin-1")
    assert main.index("DriveCalls_DB") < main.index("Red_DB")


@pytest.mark.parametrize(("old", "new"), [('key = "beacon"', 'key = "ppi"'), ('("beacons",)', '("jobs",)')])
def test_a_protocol_takes_no_name_that_something_has(distribution, tmp_path: Path, old: str, new: str) -> None:
    """Keys and sections of the shipped protocols stay theirs: the plug-in is named, plcgen is not to blame."""
    folder = tmp_path / "beacon"
    shutil.copytree(ROOT / "tests" / "toys" / "beacon", folder, ignore=shutil.ignore_patterns("__pycache__"))
    code = (folder / "__init__.py").read_text("utf-8")
    assert old in code
    (folder / "__init__.py").write_text(code.replace(old, new), "utf-8")
    distribution("beacon", "plcgen.protocols", "beacon = beacon:PROTOCOL", folder)
    with pytest.raises(PluginError, match=f'brings "{new.split(chr(34))[1]}", which is taken'):
        protocols()


def test_a_clash_is_shown_at_the_thing_that_clashes(toy: Path) -> None:
    """Not at the section: a rule finds out from the schema what has a name."""
    toy.write_text(toy.read_text("utf-8").replace("green", "Red"), "utf-8")
    found = [d for d in api.check(toy).diagnostics if d.code in {"PG405", "PG406"}]
    assert [(d.span.line, d.span.column > 12) for d in found] == [(3, True)] * len(found)
    assert found


def plans() -> list[tuple[str, Plan]]:
    """The plans of the shipped specs."""
    found = [(path.stem, api.check(path).project) for path in SPECS]
    return [(name, plan) for name, project in found if project is not None for plan in project.plans]


def test_the_shipped_protocols_have_the_face() -> None:
    """They are objects with every member of the face, and stand in front of others."""
    assert [protocol.key for protocol in protocols()] == list(SHIPPED)
    assert all(isinstance(protocol, Protocol) for protocol in protocols())
    assert {plan.protocol.key for _, plan in plans()} == set(SHIPPED)


@pytest.mark.parametrize(("name", "plan"), plans(), ids=lambda value: value if isinstance(value, str) else "")
def test_every_byte_of_a_telegram_has_one_name(name: str, plan: Plan) -> None:
    """Members cover a request from its first byte to its last, without gaps, and hold its bytes."""
    for job in plan.jobs:
        for telegram in job.telegrams:
            for buffer in telegram.buffers:
                ends = [(field.offset, field.offset + field.size) for field in buffer.fields]
                assert [end for _, end in ends[:-1]] == [start for start, _ in ends[1:]], name
                assert (ends[0][0], ends[-1][1]) == (0, buffer.size), name
                assert len({field.name.lower() for field in buffer.fields}) == len(buffer.fields), name
            image = b"".join(field.data.ljust(field.size, b"\0") for field in telegram.request.fields)
            assert image == telegram.request.image, name


@pytest.mark.parametrize(("name", "plan"), plans(), ids=lambda value: value if isinstance(value, str) else "")
def test_a_request_is_dissected_whole(name: str, plan: Plan) -> None:
    """The dissector names no wrong field in what was planned."""
    for job in plan.jobs:
        for telegram in job.telegrams:
            fields = plan.protocol.request_fields(telegram.request.data)
            assert fields, name
            assert [field.name for field in fields if field.problem] == [], name


def test_the_toy_is_what_the_recipe_says() -> None:
    """One folder: a module with the face, and its template."""
    folder = ROOT / "tests" / "toys" / "beacon"
    files = sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.suffix != ".pyc")
    assert [name for name in files if "." in name] == ["__init__.py", "templates/lamp.scl.j2"]
