"""The JSON schema for editors agrees with what the tool accepts."""

from __future__ import annotations

import copy
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import jsonschema
import pytest
import yaml

from plcgen import api
from plcgen.base.diagnostics import ArgumentError, DiagnosticError, Report
from plcgen.base.files.yaml import resolve_plain
from plcgen.ds47 import devices as catalog
from plcgen.project.loading import parse_spec, spec_keys
from plcgen.project.registry import protocols
from plcgen.project.shape import json_schema
from tests.projects import SPECS, every_type

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


def _texts(schema: object, path: str = "") -> Iterator[str]:
    """Keys of the schema that nothing is said about."""
    if isinstance(schema, dict):
        for key, value in schema.get("properties", {}).items():
            if isinstance(value, dict) and not value.get("description"):
                yield f"{path}/{key}"
        for key, value in schema.items():
            if key != "then":  # says which keys are required, not what they are
                yield from _texts(value, f"{path}/{key}")


def test_every_key_is_explained() -> None:
    """The text that an editor shows; and a name of the schema that stays what it is."""
    schema = json_schema(protocols())
    assert list(_texts(schema)) == []
    assert schema["$id"] == "urn:plcgen:spec:1"


def test_editors_complete() -> None:
    """Devices, CPUs, data types, and names of parameters, of which only what can be written stands below write."""
    schema = json_schema(protocols())
    definitions = schema["$defs"]
    assert "sinamics-g120" in definitions["DriveEntry"]["properties"]["device"]["anyOf"][0]["enum"]
    assert "FloatingPoint" in definitions["ParameterDef"]["properties"]["type"]["anyOf"][0]["enum"]
    assert "224XP" in definitions["PpiStation"]["properties"]["cpu"]["anyOf"][0]["enum"]
    assert "fault_code" in definitions["ReadItem"]["properties"]["parameter"]["anyOf"][0]["enum"]
    writable = definitions["Job"]["properties"]["write"]["anyOf"][0]["properties"]
    assert writable["ramp_up_time"]["description"]
    assert "fault_code" not in writable


def test_editors_complete_parameters_of_steps_and_recipes() -> None:
    """As in a job; a step that waits has its times beside what it waits for."""
    definitions = json_schema(protocols())["$defs"]
    step, recipe = (definitions[name]["properties"] for name in ("SequenceStep", "RecipeEntry"))
    for texts in (step["read"]["anyOf"], recipe["parameters"]["anyOf"]):
        assert all("ramp_up_time" in one["anyOf"][0]["enum"] for one in (texts[0], texts[1]["items"]["anyOf"][0]))
    written, awaited = step["write"]["anyOf"][0]["properties"], step["until"]["anyOf"][1]["properties"]
    assert {"ramp_up_time", "actual_speed"} & {*written} == {"ramp_up_time"}
    assert {"ramp_up_time", "actual_speed", "timeout", "interval"} <= {*awaited}


def test_editors_complete_profiles_of_the_users_own(tmp_path: Path) -> None:
    """What is written offers what can be written, all of it what has a name."""
    profile = tmp_path / "acme.yaml"
    profile.write_text(
        "title: Acme\nsource: Acme manual\nrecord_index: {default: profibus, profibus: 47}\n"
        "drive_object: {default: 1}\n"
        "parameters: {P7: {name: acme_ramp, type: Unsigned16}, R9: {name: acme_speed, type: Unsigned16, access: r}}\n",
        "utf-8",
    )
    for kind in ("spec", "shared"):
        job = api.schema(kind, profiles=[profile])["$defs"]["Job"]["properties"]
        assert {"acme_ramp", "acme_speed", "ramp_up_time"} <= {*job["read"]["anyOf"][0]["anyOf"][0]["enum"]}
        assert {"acme_ramp", "acme_speed"} & {*job["write"]["anyOf"][0]["properties"]} == {"acme_ramp"}
        assert "acme_speed" in job["compare"]["anyOf"][0]["properties"]
    with pytest.raises(ArgumentError, match="schema of drive offers nothing of device profiles; spec and shared do"):
        api.schema("drive", profiles=[profile])
    with pytest.raises(DiagnosticError):
        api.schema(profiles=[tmp_path / "nowhere.yaml"])


@pytest.mark.parametrize("access", ["r", "w"])
def test_a_profile_takes_no_name_of_another_device_away(access: str, tmp_path: Path) -> None:
    """The ramp-up time of a G120 can be read and written, whatever a profile can do with one of that name."""
    profile = tmp_path / "acme.yaml"
    profile.write_text(
        "title: Acme\nsource: Acme manual\nrecord_index: {default: profibus, profibus: 47}\n"
        "drive_object: {default: 1}\n"
        f"parameters: {{P7: {{name: ramp_up_time, type: Unsigned16, access: {access}}}}}\n",
        "utf-8",
    )
    job = api.schema(profiles=[profile])["$defs"]["Job"]["properties"]
    assert all("ramp_up_time" in job[key]["anyOf"][0]["properties"] for key in ("write", "compare"))


def test_defaults_are_written_as_in_a_file() -> None:
    """A default that an editor inserts is one that the tool takes: 60s, not 60000."""
    settings = json_schema(protocols())["$defs"]["DriveEntry"]["properties"]
    assert settings["wait"]["default"] == "60s"
    assert VALIDATOR.schema["$defs"]["Job"]["properties"]["retry_pause"]["default"] == "200ms"


class _Editor(getattr(yaml, "CSafeLoader", yaml.SafeLoader)):
    """YAML as an editor reads it, to which a number in the spelling of STEP 7 is a text."""


_Editor.yaml_implicit_resolvers = {}
_Editor.add_constructor(
    "tag:yaml.org,2002:str",
    lambda _, node: node.value if node.style or "#" in node.value else resolve_plain(node.value),
)

DRIVES = {
    "plc": {"name": "a", "family": "s7-1500", "toolchain": "tia-v19"},
    "units": {"u": {"device": "sinamics-s120", "drives": {"x": {"hardware_id": 281}}}},
    "drives": {"d": {"device": "sinamics-g120", "hardware_id": 270, "parameters": {"P2900": {"type": "N2"}}}},
    "jobs": {
        "r": {"drive": "d", "read": [{"parameter": "r21"}], "trigger": {"execute": "M1.0"}, "block": {"number": 1}},
        "w": {"drive": "d", "write": [{"parameter": "P1120"}], "request": {"db": 3}},
        "m": {"drive": "d", "write": {"P1120": {"as": "x"}}},
    },
}
MASTERS = {
    "plc": {"name": "a", "family": "s7-1200", "toolchain": "tia-v19", "numbers": {"db": 5}, "instructions": {}},
    "ppi": {
        "m": {
            "module": "cm1241",
            "port": 270,
            "stations": {"s": {"address": 2}},
            "jobs": {
                "r": {"station": "s", "read": [{"item": "VB1"}], "response": {"db": 3}},
                "w": {"station": "s", "write": [{"item": "VB1"}]},
            },
        }
    },
}
VALUES = [
    "5", "0", "-1", "70000", "1.5", "true", "null", "abc", "''", "16#0A", "10s", "{}", "[a]", "[1]", "{a: 1}",
    "{en-US: x}", "{P971: why}", "auto", "CDS", "profibus", "V2.1", "{execute: M50.0}", "[{parameter: P1}]",
    "[{item: VB1}]",
]  # fmt: skip
EDITORS_MAY_BE_STRICTER = {"device", "baud", "version"}
"""What a rule refuses later, not the shape; and ``version: true``."""
TEXTS = {"16#0A", "''"}
"""Numbers to the tool, texts to an editor; and a text that is empty, which some shapes take."""
NUMBERS = {"firmware"}
"""2.1 is a version, 5 is none: to an editor both are numbers."""


def _places(data: Any, at: tuple[str | int, ...] = ()) -> Iterator[tuple[str | int, ...]]:
    """Every key that a spec has, or may have beside those it has."""
    if isinstance(data, dict):
        yield from ((*at, key) for key in dict.fromkeys([*spec_keys(at), *data]))
    for key, value in data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ():
        yield from _places(value, (*at, key))


def _with(data: Any, path: tuple[str | int, ...], value: str) -> str:
    spec: Any = copy.deepcopy(data)
    node = spec
    for step in path[:-1]:
        node = node[step]
    node[path[-1]] = "HERE"
    return json.dumps(spec).replace('"HERE"', value)


@pytest.mark.slow
@pytest.mark.parametrize("base", [DRIVES, MASTERS], ids=["drives", "masters"])
def test_editor_and_tool_take_the_same(base: dict[str, Any]) -> None:
    """Whatever stands at whatever key: the schema takes it if, and only if, the shape of a spec does."""
    sections = set(base) | set(spec_keys(())) - {"ppi", "units", "drives", "jobs"}
    different, seen = [], set()
    for path in dict.fromkeys(place for place in _places(base) if place[0] in sections):
        kind = (*spec_keys(path[:-1]), path[-1])
        for value in VALUES if kind not in seen else ():
            text, report = _with(base, path, value), Report()
            tool = parse_spec(text, "t.yaml", report) is not None
            if tool == VALIDATOR.is_valid(yaml.load(text, Loader=_Editor)):  # noqa: S506 - texts and numbers only
                continue
            if (tool and path[-1] in EDITORS_MAY_BE_STRICTER) or (not tool and (value in TEXTS or path[-1] in NUMBERS)):
                continue
            different.append((".".join(map(str, path)), value, "only the tool" if tool else "only the editor"))
        seen.add(kind)
    assert different == []


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
    from plcgen.ds47.references import parse_type
    from plcgen.ds47.wire.formats import by_name

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
