"""Kinds of jobs: a toy kind of another distribution works like a shipped one, without a change of plcgen."""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path

import jsonschema
import pytest

from plcgen import api
from plcgen.base.diagnostics import PluginError, Severity
from plcgen.ds47 import registry
from plcgen.ds47.plan.nouns import DrivePlan
from plcgen.ds47.proof.scenarios import fault_matrix
from plcgen.ds47.registry import kinds, shipped
from plcgen.ds47.schema import drive_sections
from plcgen.oracles.spec.ds47.state import shipped_statements
from plcgen.project.shape import spec_model
from tests.projects import ROOT

TOY = """
from typing import Literal

from plcgen.ds47.kind import JobKind, ReadItem

KIND = JobKind(
    key="identify",
    writes=False,
    shape=Literal[True],
    description="true: read the first three values of the device identification",
    example="identify: true",
    items=lambda _: (ReadItem(parameter="r0964[0..2]", type="Unsigned16"),),
)
"""
STATEMENT = """
from plcgen.oracles.spec.ds47.statement import StatedStep


def steps(job):
    yield StatedStep("reads", (job.reads(job.fixed("r0964[0..2]", "Unsigned16")),))
"""
SPEC = """
plc: {name: Toy, family: s7-1500, toolchain: tia-v17}
drives: {fan: {device: sinamics-g120, hardware_id: 270}}
jobs: {who: {drive: fan, identify: true}}
"""


@pytest.fixture
def toy(distribution, tmp_path: Path) -> Path:
    """A spec with a job of the toy kind, whose distribution is installed."""
    distribution("toy_kind", "plcgen.kinds", "identify = toy_kind:KIND", TOY)
    path = tmp_path / "toy.yaml"
    path.write_text(SPEC, "utf-8")
    return path


def test_a_kind_becomes_a_telegram(toy: Path) -> None:
    """PROFIdrive profile 4.2, 6.2.3.3: 01 read, drive object 1, 1 parameter; 10 value, 3 elements, 03C4h = 964, 0."""
    plan = api.check(toy).project.plan(DrivePlan)
    assert [job.kind for job in plan.jobs] == ["identify"]
    assert plan.jobs[0].telegrams[0].request.data.hex(" ") == "01 01 01 01 10 03 03 c4 00 00"


@pytest.mark.slow
def test_a_kind_is_generated_and_verified(toy: Path, tmp_path: Path, distribution) -> None:
    """From the spec to the run in the soft CPU; a kind about which nobody says what it demands is not stated."""
    assert api.generate(toy, tmp_path / "out").ok
    found = api.verify(toy, tmp_path / "out", faults="none")
    assert [(check.id, check.verdict) for check in found.checks() if check.diagnostic] == [("spec.who", "not stated")]
    distribution("toy_statement", "plcgen.statements", "identify = toy_statement:steps", STATEMENT)
    assert api.verify(toy, tmp_path / "out", faults="none").ok


def test_a_wrong_kind_does_not_keep_its_statement(toy: Path, tmp_path: Path, distribution) -> None:
    """PG641 where the spec has the job: the toy reads r0964, its statement says r0965; documents name r0964, too."""
    distribution("toy_statement", "plcgen.statements", "identify = toy_statement:steps", STATEMENT.replace("64", "65"))
    assert api.generate(toy, tmp_path / "out").ok
    documents, found, guessed = api.verify(toy, tmp_path / "out", faults="none").problems
    assert (documents.code, found.code, found.span.line, guessed.code) == ("PG614", "PG641", 4, "PG228")
    assert "a read of 965" in found.message


@pytest.mark.usefixtures("toy")
def test_an_editor_knows_the_kind() -> None:
    """The JSON schema has its key, and refuses what its shape refuses."""
    validator = jsonschema.Draft202012Validator(api.schema())
    jobs = {"who": {"drive": "fan", "identify": True}}
    spec = {"plc": {"name": "t", "family": "s7-1500", "toolchain": "tia-v17"}, "drives": {}, "jobs": jobs}
    assert validator.is_valid(spec)
    jobs["who"]["identify"] = 3
    assert not validator.is_valid(spec)


LIKE_ACTIVATE = """
from dataclasses import replace

from plcgen.ds47.kinds.activate import ACTIVATE

KIND = replace(ACTIVATE, key="take_part")
"""
ITS_STATEMENT = """
from dataclasses import replace

from plcgen.oracles.spec.ds47.kinds.activate import activate_steps


def steps(job):
    return activate_steps(replace(job, job={**job.job, "activate": job.job["take_part"]}))
"""
ACTIVATING = """
plc: {name: Toy, family: s7-1500, toolchain: tia-v17}
drives: {axis: {device: sinamics-s120, drive_object: 3, hardware_id: 270}}
jobs: {part: {drive: axis, %s: %s}}
"""


@pytest.mark.slow
@pytest.mark.parametrize("state", ["true", "not_present", "input"])
def test_what_a_shipped_kind_can_do_a_kind_of_others_can(distribution, tmp_path: Path, state: str) -> None:
    """The same under another key is signed off, titled and noted alike: nothing depends on what a kind is called."""
    distribution("toy_kind", "plcgen.kinds", "take_part = toy_kind:KIND", LIKE_ACTIVATE)
    distribution("toy_statement", "plcgen.statements", "take_part = toy_statement:steps", ITS_STATEMENT)
    found = []
    for key in ("activate", "take_part"):
        spec, out = tmp_path / f"{key}.yaml", tmp_path / key
        spec.write_text(ACTIVATING % (key, state), "utf-8")
        assert api.generate(spec, out).ok
        assert api.verify(spec, out, faults="none").ok
        sources = {path.name: path.read_text("utf-8") for path in out.rglob("*.scl")}
        notes = [(d.code, d.message, d.help) for d in api.check(spec).diagnostics]
        found.append((notes, {name: text.replace(key, "activate") for name, text in sources.items()}))
    assert found[0] == found[1]


def test_a_kind_says_how_its_parameters_are_defined(distribution, tmp_path: Path) -> None:
    """PG248 proposes what the kind knows of its own parameter, nothing of another kind's."""
    code = TOY.replace('ReadItem(parameter="r0964[0..2]", type="Unsigned16")', 'ReadItem(parameter="r61999")')
    code = code.replace('key="identify",', 'key="identify", fixed=True, types={"r61999": "Float"},')
    distribution("toy_kind", "plcgen.kinds", "identify = toy_kind:KIND", code)
    spec = tmp_path / "job.yaml"
    spec.write_text(SPEC, "utf-8")
    found = [d for d in api.check(spec).diagnostics if d.code == "PG248"]
    assert [d.help.partition(": ")[2] for d in found] == ["parameters: {r61999: {type: Float}}"]


@pytest.mark.parametrize(("parameter", "codes"), [("P972", []), ("P9500", ["PG219"])])
def test_no_kind_signs_off_safety_integrated(distribution, tmp_path: Path, parameter: str, codes: list[str]) -> None:
    """PG219 for p9500, whatever the kind permits; p0972, which restarts the unit, is what such a job is for."""
    code = TOY.replace("ReadItem", "WriteItem").replace("writes=False", "writes=True")
    code = code.replace('parameter="r0964[0..2]"', f'parameter="{parameter}", value=1')
    code = code.replace("items=", 'permits=lambda _: {972: "it restarts", 9500: "it says so"}, items=')
    distribution("toy_kind", "plcgen.kinds", "identify = toy_kind:KIND", code)
    spec = tmp_path / "job.yaml"
    spec.write_text(SPEC, "utf-8")
    assert [d.code for d in api.check(spec).diagnostics if d.severity is Severity.ERROR] == codes


def test_two_kinds_in_one_job_are_told(toy: Path) -> None:
    """PG218 names both, and what may stand there."""
    toy.write_text(SPEC.replace("identify: true", "identify: true, read: [P1120]"), "utf-8")
    found = [d for d in api.check(toy).diagnostics if d.code == "PG218"]
    assert [d.message for d in found] == ['job "who" needs either read or identify, not both']
    toy.write_text(SPEC.replace(", identify: true", ""), "utf-8")
    found = [d for d in api.check(toy).diagnostics if d.code == "PG218"]
    assert "identify: true" in found[0].help


def test_what_is_no_kind_is_told(distribution) -> None:
    """An entry point that names something else."""
    distribution("toy_kind", "plcgen.kinds", "identify = toy_kind:KIND", "KIND = 1")
    with pytest.raises(PluginError, match=r"toy_kind:KIND in plcgen.kinds is not of type JobKind"):
        kinds()


@pytest.mark.parametrize(("key", "told"), [("read", '"read", which is taken'), ("drive", '"drive", which is taken')])
def test_a_kind_takes_no_key_that_something_has(distribution, tmp_path: Path, key: str, told: str) -> None:
    """A shipped kind and the keys that every job has stay what they are."""
    code = TOY.replace('"identify"', f'"{key}"')
    assert code != TOY
    distribution("toy_kind", "plcgen.kinds", "other = toy_kind:KIND", code)
    spec = tmp_path / "job.yaml"
    spec.write_text(SPEC, "utf-8")
    with pytest.raises(PluginError, match=told):
        api.check(spec)


@pytest.mark.parametrize("part", ["items", "title", "steps"])
def test_what_a_kind_raises_is_not_a_bug_of_plcgen(distribution, tmp_path: Path, part: str) -> None:
    """It is told by its name."""
    code = TOY + "\n\ndef broken(value):\n    raise KeyError(value)\n\n\n"
    code += f"from dataclasses import replace\nKIND = replace(KIND, {part}=broken)\n"
    distribution("toy_kind", "plcgen.kinds", "identify = toy_kind:KIND", code)
    spec = tmp_path / "job.yaml"
    spec.write_text(SPEC, "utf-8")
    with pytest.raises(PluginError, match=r"the kind of job identify cannot be planned: KeyError\(True\)"):
        api.generate(spec, tmp_path / "out")


def test_without_others_there_are_the_shipped_kinds() -> None:
    """All of them, in the order of the table in docs/spec.md."""
    keys = ["read", "write", "compare", "save", "faults", "alarms", "service"]
    keys += ["acknowledge", "sequence", "activate", "clock"]
    keys += ["write_recipe", "read_recipe", "compare_recipe"]
    assert [kind.key for kind in kinds()] == [kind.key for kind in shipped()] == keys


FOLDER = {
    "__init__.py": TOY.replace("KIND = JobKind(", "KIND = JobKind(\n    place=500,").rstrip() + "\n\nKINDS = (KIND,)\n",
    "block.py": """
from plcgen.ds47.views.parts import BlockParts

PARTS = (
    BlockParts(
        name="identify",
        precedence=100,
        has=lambda job: job.kind == "identify",
        template="plcgen.ds47.kinds.identify:parts.scl.j2",
        view=lambda plan, job: {"start": 3},
        reserved=frozenset({"visits"}),
    ),
)
""",
    "parts.scl.j2": """{% if part == "outputs" %}
  visits : Int := {{ job.identify.start }};  // how often it was started
{% elif part == "begin" %}
    #visits := #visits + 1;
{% endif %}
""",
    "scenarios.py": """
from plcgen.ds47.proof.scenario import DriveScenario, KindScenarios


def identifying(job, scans):
    yield DriveScenario(name="asked who it is", values="low")


SCENARIOS = (KindScenarios(100, lambda job: job.kind == "identify", identifying),)
""",
}
"""A kind as a folder of its own: schema, what its block has besides, and a scenario."""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A spec with a job of a kind whose folder and oracle file lie beside the shipped ones; nothing else is told."""
    caches = (registry.shipped, registry.kinds, registry.brought, registry._packages, drive_sections, spec_model)
    package, oracle = tmp_path / "kinds" / "identify", tmp_path / "oracles" / "identify.py"
    for path, text in {**{package / name: text for name, text in FOLDER.items()}, oracle: STATES}.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, "utf-8")
    for name, place in ((registry.FOLDER, package.parent), ("plcgen.oracles.spec.ds47.kinds", oracle.parent)):
        module = import_module(name)
        monkeypatch.setattr(module, "__path__", [*module.__path__, str(place)])
    for cached in (*caches, shipped_statements):
        cached.cache_clear()
    spec = tmp_path / "toy.yaml"
    spec.write_text(SPEC, "utf-8")
    yield spec
    monkeypatch.undo()
    for cached in (*caches, shipped_statements):
        cached.cache_clear()
    for module in [name for name in sys.modules if ".kinds.identify" in name]:
        del sys.modules[module]


STATES = STATEMENT.rstrip() + "\n\n\nSTATEMENTS = {'identify': steps}\n"


def test_a_kind_is_one_folder_and_one_oracle_file(folder: Path, tmp_path: Path) -> None:
    """Nothing else names it: schema, block with its own lines, statement, scenario and reserved name are found."""
    assert api.generate(folder, tmp_path / "out").ok
    source = "".join(path.read_text("utf-8-sig") for path in (tmp_path / "out").rglob("*.scl"))
    assert "  visits : Int := 3;  // how often it was started\n" in source
    assert "    #visits := #visits + 1;\n" in source
    plan = api.check(folder).project.plan(DrivePlan)
    assert "asked who it is" in [one.name for one in fault_matrix(plan.jobs[0], 60, 240)]
    told = {check.id: check.verdict for check in api.verify(folder, tmp_path / "out", faults="none").checks()}
    assert told["spec"] == "1 of 1 jobs stated and kept"
    folder.write_text(SPEC.replace("identify: true", "read: [{parameter: P1120, as: visits}]"), "utf-8")
    assert [d.code for d in api.check(folder).diagnostics if d.severity is Severity.ERROR] == ["PG406"]


KINDS = ROOT / "plcgen" / "ds47" / "kinds"
WORDS = {path.name for path in KINDS.iterdir() if (path / "__init__.py").is_file()} - {"read", "write"}
"""Folders of kinds, by which a frame may not call anything; reading and writing is what every telegram does."""
NAMED = {
    "plcgen/ds47/plan": {"messages", "recipe"},
    "plcgen/ds47/proof": {"messages", "recipe", "clock"},
    "plcgen/ds47/views": {"recipe"},
    "plcgen/ds47/rules": {"clock"},
}
"""What of a job a room still calls by the name of a kind (docs/adr/0013): the list may only get shorter."""


def named(room: Path) -> set[str]:
    """Kinds that the Python of a room names: as an attribute of a job, in an import, as a text of its own."""
    found: set[str] = set()
    for path in room.rglob("*.py"):
        if "stated" in path.parts or "wording" in path.parts:
            continue  # second statements of what a block does and says, made from the spec by hand
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("plcgen.ds47.kinds."):
                found.add((node.module or "").split(".")[3])
            if isinstance(node, ast.Attribute) and ast.unparse(node.value).endswith(("job", "kind")):
                found.add(node.attr)
            if isinstance(node, ast.Compare):
                found |= {one.value for one in ast.walk(node) if isinstance(one, ast.Constant)}
    return found & WORDS


def test_the_frame_names_no_kind() -> None:
    """No part of job.scl.j2 or telegrams.scl.j2, no room of plan, proof, views, rules, build but what is listed."""
    for name in ("job", "telegrams", "take", "build", "inputs", "constants"):
        marks = re.findall(r"\{[{%].*?[}%]\}", (ROOT / "templates" / "ds47" / f"{name}.scl.j2").read_text("utf-8"))
        assert not {word for mark in marks for word in re.findall(r"(?:job|telegram)\.(\w+)", mark)} & WORDS
    rooms = (*NAMED, "plcgen/ds47/sim", "plcgen/build")
    assert {room: named(ROOT / room) for room in rooms} == {room: NAMED.get(room, set()) for room in rooms}


def test_job_scl_is_short() -> None:
    """A page that can be read from top to bottom: at most 150 lines with 32 marks."""
    text = (ROOT / "templates" / "ds47" / "job.scl.j2").read_text("utf-8")
    assert len(text.splitlines()) <= 150
    assert len(re.findall(r"\{[{%#]", text)) <= 32
