"""The JSON schema for editors agrees with what the tool accepts."""

from __future__ import annotations

from pathlib import Path

import jsonschema
import pytest
import yaml
from projects import SPECS, every_type

from plcgen.diagnostics import Report
from plcgen.project.loading import parse_spec, spec_keys
from plcgen.project.shape import json_schema
from plcgen.protocols.ds47 import devices as catalog
from plcgen.protocols.registry import protocols

VALIDATOR = jsonschema.Draft202012Validator(json_schema(protocols()))


def test_schema_is_a_json_schema() -> None:
    """The schema itself is valid draft 2020-12."""
    meta = jsonschema.Draft202012Validator(jsonschema.Draft202012Validator.META_SCHEMA)
    assert [problem.message for problem in meta.iter_errors(json_schema(protocols()))] == []


@pytest.mark.parametrize("path", SPECS, ids=lambda p: p.stem)
def test_shipped_specs_validate(path: Path) -> None:
    """An editor shows no error in a shipped spec, short forms included."""
    assert [e.message for e in VALIDATOR.iter_errors(yaml.safe_load(path.read_text(encoding="utf-8")))] == []


@pytest.mark.parametrize(
    "line",
    [
        "read: [P1], colour: red",
        "read: [{parameter: P1, kind: x}]",
        "read: [P1], timeout: 10",
        "read: {P1: 2}",
        "read: [P1], split: 3",
    ],
)
def test_editor_and_tool_refuse_the_same(line: str) -> None:
    """What the tool refuses for its shape, the editor underlines too."""
    text = f"plc: {{name: a, family: s7-300, toolchain: tia-v16}}\ndrives: {{d: {{device: sinamics-dcm, address: 256}}}}\njobs: {{j: {{drive: d, {line}}}}}\n"  # noqa: E501
    assert list(VALIDATOR.iter_errors(yaml.safe_load(text)))
    report = Report()
    assert parse_spec(text, "t.yaml", report) is None
    assert report.has_errors


def test_the_spec_of_every_type_has_the_right_shape() -> None:
    """The biggest spec of the tests is accepted by the tool's own schema."""
    report = Report()
    assert parse_spec(every_type("t15"), "t.yaml", report) is not None
    assert list(report) == []


def test_field_names_follow_the_models() -> None:
    """Suggestions for unknown keys come from the model at that place."""
    assert "hardware_id" in spec_keys(("drives", "x"))
    assert spec_keys(("jobs", "x", "read", 0)) == ["parameter", "as", "type", "comment"]
    assert spec_keys(("jobs", "x", "nothing")) == []


@pytest.mark.parametrize("key", catalog.device_names())
def test_device_profiles_are_complete(key: str) -> None:
    """Every profile names its source, a record index that exists, and parameters with known types and sources."""
    from plcgen.protocols.ds47.plan.references import parse_type
    from plcgen.protocols.ds47.wire.formats import by_name

    device = catalog.find_device(key)
    assert device.source
    assert device.default_index in device.record_index
    assert device.drive_objects is None or device.drive_object in device.drive_objects
    assert 1 <= device.max_parameters <= 39
    for parameter in (p for p in device.parameters.values() if p.type):
        split = parse_type(parameter.type)
        assert split is not None
        assert by_name(split[0]).writable
        assert parameter.source, parameter.pnu
        if parameter.minimum is not None and isinstance(parameter.default, int | float):
            assert parameter.maximum is not None
            assert parameter.minimum <= parameter.default <= parameter.maximum
    names = [p.name for p in device.parameters.values() if p.name]
    assert len(names) == len(set(names))
