"""JSON schemas of files and results: what is shipped and documented passes, what the tool refuses does not."""

from __future__ import annotations

import json
import re
import shutil
import tomllib
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import yaml
from click.testing import CliRunner
from jsonschema import Draft202012Validator

from plcgen import api
from plcgen.api.schemas import SCHEMAS
from plcgen.base.diagnostics import DiagnosticError
from plcgen.base.display.view import PLAIN
from plcgen.cli.main import run
from plcgen.cli.schema import KINDS
from plcgen.ds47.recording.faults import plan_faults
from plcgen.ds47.sim.load import load_drive
from plcgen.ppi.sim.load import load_bus
from plcgen.report.diff.lockfile import read_lock
from plcgen.report.registry import output_format
from plcgen.s7.compare.policy import load_policy
from tests.projects import FAQ, ROOT, generated_example


@cache
def schema(kind: str) -> dict[str, Any]:
    """As the command prints it."""
    with CliRunner().isolation() as streams:
        assert run(["schema", kind]) == 0
        found: dict[str, Any] = json.loads(streams[0].getvalue())
    return found


def wrong(kind: str, data: Any) -> list[str]:
    """What a schema says against data; keys are texts there."""
    validator = Draft202012Validator(schema(kind))
    return [f"{list(one.absolute_path)}: {one.message}" for one in validator.iter_errors(json.loads(json.dumps(data)))]


def blocks(page: str, language: str = "yaml") -> list[str]:
    """The code blocks of a page."""
    text = (ROOT / "docs" / page).read_text("utf-8")
    return re.findall(rf"^```{language}\n(.*?)^```", text, re.DOTALL | re.MULTILINE)


def test_every_schema_is_one_and_has_a_name_of_its_own() -> None:
    """Draft 2020-12, an ``$id`` for each, the same from Python as from the command line."""
    assert set(KINDS) == {*SCHEMAS, "config"}
    for kind in KINDS:
        Draft202012Validator.check_schema(schema(kind))
        assert kind == "config" or api.schema(kind) == schema(kind)
    names = [schema(kind)["$id"] for kind in KINDS]
    assert len(set(names)) == len(KINDS)
    assert all(re.fullmatch(r"urn:plcgen:[a-z]+:[0-9]+", name) for name in names)
    with pytest.raises(ValueError, match="there is no schema of nothing"):
        api.schema("nothing")


@pytest.mark.parametrize("kind", ["drive", "station", "config"])
def test_every_key_is_explained(kind: str) -> None:
    """An editor shows a sentence; a key that leads to keys of its own has it there."""
    found = schema(kind)
    objects = [found, *found["$defs"].values(), *(found[key] for key in ("then", "else") if key in found)]
    silent = [
        name
        for each in objects
        for name, key in each.get("properties", {}).items()
        if "description" not in key and "$ref" not in key and name not in {"objects", "stations"}
    ]
    assert silent == []


def test_what_is_shipped_and_documented_passes() -> None:
    """Device profiles, the drive and the stations of the manual, the policy, ``plcgen.toml``."""
    profiles = sorted((ROOT / "specs" / "devices").glob("*.yaml"))
    assert profiles
    for path in profiles:
        assert wrong("profile", yaml.safe_load(path.read_text("utf-8"))) == [], path
    assert wrong("drive", yaml.safe_load(blocks("drive-yaml.md")[0])) == []
    assert wrong("station", yaml.safe_load(blocks("s7-200.md")[0])) == []
    assert (
        wrong("station", {"stations": [{"address": 2}, {"address": 3, "cpu": 226}], "faults": [{"kind": "fcs"}]}) == []
    )
    assert wrong("policy", {"member-renamed": "compatible", "start-value": "documentation"}) == []
    faults = [
        {"kind": "busy", "drive": "fan"},
        {"kind": "status", "status": "16#DF80B500"},
        {"kind": "fcs"},
    ]
    assert wrong("faults", faults) == []
    assert wrong("faults", {"faults": faults}) == []
    assert wrong("faults", [{"kind": "not_ready", "times": "always", "at": "poll"}]) == []
    assert wrong("config", tomllib.loads(blocks("cli.md", "toml")[0])) == []


def test_a_lock_passes(tmp_path: Path) -> None:
    """The lock of the example; one of another format or with an unknown block does not."""
    path = tmp_path / "plcgen.lock.json"
    made = shutil.copytree(generated_example(FAQ.stem), tmp_path / "made")
    assert api.lock(made, out=path).path == path
    data = yaml.safe_load(path.read_text("utf-8"))
    assert len(data["blocks"]) > 10
    assert wrong("lock", data) == []
    assert wrong("lock", {**data, "format": 999})
    assert wrong("lock", {**data, "blocks": [{"kind": "XX", "name": "a", "hash": "", "access": "standard"}]})


BROKEN: list[tuple[str, str]] = [
    ("drive", "objcts: []"),
    ("drive", "objects: []"),
    ("drive", "objects: [{number: 256}]"),
    ("drive", "objects: [{number: 1, parameters: [{pnu: 0, type: Word, value: 1}]}]"),
    ("drive", "objects: [{number: 1}]\nbehaviour: {error_words: 3}"),
    ("drive", "objects: [{number: 1}]\nfaults: [{kind: bussy}]"),
    ("drive", "objects: [{number: 1}]\nfaults: [{kind: busy, times: never}]"),
    ("station", "address: 127"),
    ("station", "mode: sleeping"),
    ("station", "stations: []"),
    ("station", "stations: [{adress: 2}]"),
    ("station", "faults: [{kind: silence, at: noon}]"),
    ("faults", "[{kind: bussy}]"),
    ("faults", "faults: [{kind: busy, colour: red}]"),
    ("faults", "kind: busy"),
    ("policy", "member-renamd: breaking"),
    ("policy", "member-renamed: harmless"),
    ("lock", '{"format": 4, "blocks": [{"kind": "DB", "name": "a", "hash": "", "access": "none"}]}'),
    ("config", "[verify]\nfaults = 'some'"),
    ("config", "[verify]\nfault = 'none'"),
    ("config", "specs = 'job.yaml'"),
]


@pytest.mark.parametrize(("kind", "text"), BROKEN)
def test_what_the_tool_refuses_does_not_pass(kind: str, text: str, tmp_path: Path) -> None:
    """The same mistake is a diagnostic of the tool."""
    from plcgen.cli.config import load_config

    path = tmp_path / ("plcgen.toml" if kind == "config" else "file.yaml")
    path.write_text(text, "utf-8")
    readers = {
        "drive": lambda: load_drive(text),
        "station": lambda: load_bus(text),
        "policy": lambda: load_policy([str(path)]),
        "lock": lambda: read_lock(path),
        "faults": lambda: plan_faults([], path, []),
        "config": lambda: load_config(path),
    }
    with pytest.raises(DiagnosticError):
        readers[kind]()
    assert wrong(kind, tomllib.loads(text) if kind == "config" else yaml.safe_load(text))


def test_a_result_with_other_keys_does_not_pass() -> None:
    """A key too many, one too few, a kind that does not exist, a severity that nobody knows."""
    format_ = output_format("json")
    assert format_ is not None
    data = json.loads(format_.render("layout", api.layout(ROOT / "docs" / "pictures" / "conveyor.awl"), PLAIN))
    assert wrong("output", data) == []
    assert wrong("output", {**data, "surplus": 1})
    assert wrong("output", {key: value for key, value in data.items() if key != "ok"})
    assert wrong("output", {**data, "kind": "unknown"})
    problem = {"code": "PG101", "severity": "fatal", "message": "", "file": "a", "help": "", "notes": []}
    assert wrong("output", {**data, "diagnostics": [problem]})
    assert not wrong("output", {**data, "diagnostics": [{**problem, "severity": "error"}]})
