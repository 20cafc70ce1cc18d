"""Schemas in the programs that others use: ``check-jsonschema``, and the YAML language server of editors."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from plcgen.api.schemas import SCHEMAS
from plcgen.cli.schema import KINDS
from tests import yaml_server
from tests.projects import ROOT, SPECS

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def schemas(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with every schema as the command writes it."""
    from plcgen.cli.main import run

    folder = tmp_path_factory.mktemp("schemas")
    codes = [run(["schema", kind, "--quiet", "--output", str(folder / f"{kind}.json")]) for kind in KINDS]
    assert set(codes) == {0}
    return folder


def checked(*arguments: object) -> tuple[int, str]:
    """Exit code and output of check-jsonschema."""
    command = [sys.executable, "-m", "check_jsonschema", "--no-cache", *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return done.returncode, done.stdout + done.stderr


def test_check_jsonschema_takes_every_schema(schemas: Path) -> None:
    """Each is valid by its own metaschema."""
    assert set(SCHEMAS) < set(KINDS)
    assert checked("--check-metaschema", *sorted(schemas.iterdir())) == (0, "ok -- validation done\n")


def test_check_jsonschema_takes_the_shipped_specs(schemas: Path, tmp_path: Path) -> None:
    """All of them; of a wrong one it names the key."""
    code, out = checked("--schemafile", schemas / "spec.json", *SPECS)
    assert (code, out) == (0, "ok -- validation done\n")
    wrong = tmp_path / "wrong.yaml"
    wrong.write_text(SPECS[0].read_text("utf-8").replace("family:", "famly:"), "utf-8")
    code, out = checked("--schemafile", schemas / "spec.json", wrong)
    assert code == 1
    assert "famly" in out


def test_check_jsonschema_takes_the_other_files(schemas: Path, tmp_path: Path) -> None:
    """Profiles, a drive, stations, a lock, faults, a part of a spec, and results as the commands write them."""
    from plcgen.cli.main import run

    def written(name: str, text: str) -> Path:
        (tmp_path / name).write_text(text, "utf-8")
        return tmp_path / name

    lock, result = tmp_path / "plcgen.lock.json", tmp_path / "layout.json"
    assert run(["lock", str(SPECS[0]), "--out", str(lock), "--quiet"]) == 0
    assert run(["layout", str(SPECS[0]), "--format", "json", "--output", str(result), "--quiet"]) == 0
    files = {
        "profile": sorted((ROOT / "specs" / "devices").glob("*.yaml")),
        "drive": [
            written("drive.yaml", "objects: [{number: 2, parameters: [{pnu: 50303, type: FloatingPoint, value: 1}]}]")
        ],
        "station": [written("stations.yaml", "stations: [{address: 2}, {address: 3, cpu: 226}]")],
        "policy": [written("policy.yaml", "member-renamed: compatible")],
        "faults": [written("faults.yaml", "[{kind: busy, times: 2}, {kind: fcs}]")],
        "shared": [written("shared.yaml", "drives: {fan: {device: sinamics-g120, wait: $(wait)}}")],
        "lock": [lock],
        "output": [result],
    }
    found = {kind: checked("--schemafile", schemas / f"{kind}.json", *paths) for kind, paths in files.items()}
    assert found == dict.fromkeys(files, (0, "ok -- validation done\n"))


HEAD = """\
plc: {name: a, family: s7-1500, toolchain: tia-v19}
drives:
  fan:
    device: sinamics-g120
    hardware_id: 270
jobs:
  r:
    drive: fan
"""
without_server = pytest.mark.skipif(
    yaml_server.PROGRAM is None,
    reason="not run: yaml-language-server is not installed (npm brings it)",
)


@pytest.fixture(scope="module")
def editor(schemas: Path) -> Iterator[yaml_server.YamlServer]:
    """A language server that knows the schema of a spec."""
    with yaml_server.yaml_server(schemas / "spec.json") as server:
        yield server


@without_server
def test_an_editor_underlines_nothing_that_is_right(editor: yaml_server.YamlServer) -> None:
    """The shipped specs; variables for values of any type; parts of a spec that includes the rest."""
    assert {path.name: found for path in SPECS if (found := editor.underlined(path.read_text("utf-8")))} == {}
    variables = HEAD.replace("tia-v19", "$(tool)").replace("270", "$(id)") + "    write: {P1120: $(ramp)}\n"
    assert editor.underlined(variables) == []
    assert editor.underlined("include: [common.yaml]\nplc: {name: a}\ndrives: {fan: {hardware_id: 5}}\n") == []


@without_server
@pytest.mark.parametrize(
    ("old", "new", "line", "words"),
    [
        ("s7-1500", "s7-1600", 1, 'Valid values: "s7-300", "s7-400", "s7-1200", "s7-1500"'),
        ("hardware_id", "hardwareid", 5, "Property hardwareid is not allowed"),
        ("name: a, ", "", 1, 'Missing property "name"'),
        ("    drive: fan\n", "    drive: fan\n    retries: many\n", 9, "retries"),
    ],
)
def test_an_editor_underlines_mistakes(
    editor: yaml_server.YamlServer, old: str, new: str, line: int, words: str
) -> None:
    """At their lines, with words that help."""
    (found,) = editor.underlined(HEAD.replace(old, new, 1))
    assert found[0] == line
    assert words in found[1] or "Incorrect type" in found[1] or "does not match" in found[1]


@without_server
@pytest.mark.parametrize(
    ("text", "some"),
    [
        ("▮", {"plc", "drives", "units", "jobs", "ppi", "include", "variables"}),
        ("plc:\n  ▮", {"name", "family", "toolchain", "cpu"}),
        ("plc:\n  family: ▮", {"s7-300", "s7-1500"}),
        ("drives:\n  fan:\n    device: ▮", {"sinamics-g120", "sinamics-s120"}),
        (HEAD + "    ▮", {"read", "write", "save", "verify", "trigger"}),
        (HEAD + "    write:\n      ▮", {"ramp_up_time", "ramp_down_time"}),
        (HEAD + "    read:\n      - ▮", {"fault_code", "actual_speed"}),
        (HEAD + "    sequence:\n      - write:\n          ▮", {"ramp_up_time", "ramp_down_time"}),
        (HEAD + "    sequence:\n      - until:\n          ▮", {"actual_speed", "timeout"}),
        (HEAD.replace("hardware_id: 270", "parameters: {P2900: {type: ▮}}"), {"FloatingPoint", "Unsigned16"}),
    ],
)
def test_an_editor_completes(editor: yaml_server.YamlServer, text: str, some: set[str]) -> None:
    """Keys, values, devices, names of parameters, data types."""
    assert some <= set(editor.offered(text))


PROFILE = """\
title: Acme Turbo
source: Acme manual
record_index: {default: profibus, profibus: 47}
drive_object: {default: 1}
parameters: {P7: {name: acme_ramp, type: FloatingPoint}, R9: {name: acme_speed, type: FloatingPoint, access: r}}
"""


@without_server
def test_an_editor_completes_a_profile_of_the_users_own(tmp_path: Path) -> None:
    """Beside the names of the shipped devices, if the schema was made with it."""
    from plcgen.cli.main import run

    profile, schema = tmp_path / "acme.yaml", tmp_path / "spec.json"
    profile.write_text(PROFILE, "utf-8")
    assert run(["schema", "--profile", str(profile), "--quiet", "--output", str(schema)]) == 0
    with yaml_server.yaml_server(schema) as server:
        assert {"acme_ramp", "ramp_up_time"} <= set(server.offered(HEAD + "    write:\n      ▮"))
        assert {"acme_speed", "actual_speed"} <= set(server.offered(HEAD + "    read:\n      - ▮"))
        assert "acme_speed" in server.offered(HEAD + "    sequence:\n      - until:\n          ▮")
        assert "acme_ramp" in server.offered(HEAD + "recipes:\n  winding:\n    parameters:\n      - ▮")


@without_server
def test_an_editor_explains(editor: yaml_server.YamlServer) -> None:
    """The sentence of the key under the cursor."""
    assert "hardware identifier" in editor.explained(HEAD.replace("hardware", "hard▮ware"))
