"""Labels of the page: one table for each language, each with every label."""

from __future__ import annotations

import ast
import json
import re
from collections.abc import Iterator

import pytest

pytest.importorskip("starlette", reason="the extra serve is not installed")

from plcgen.ds47.devices import device_names, find_device
from plcgen.ds47.recording.faults import DriveFault
from plcgen.ds47.sim.faults import KINDS as DRIVE_FAULTS
from plcgen.ppi.sim.faults import KINDS as STATION_FAULTS
from plcgen.ppi.sim.faults import FaultKeys as StationFault
from plcgen.workbench.serve.page import FOLDER
from plcgen.workbench.service.specs.jobs import drive_forms
from tests.projects import ROOT

TABLES = {
    path.name.split(".")[1]: {
        key: str(json.loads(text))
        for key, text in re.findall(r'^  (\w+): (".*"),$', path.read_text("utf-8"), re.MULTILINE)
    }
    for path in sorted(FOLDER.glob("words.*.js"))
}
ENGLISH, GERMAN = TABLES["en"], TABLES["de"]
PAGE = {path.name: path.read_text("utf-8") for path in FOLDER.glob("*.*") if path.suffix in {".js", ".html"}}
SAID = {
    str(json.loads(english)): str(json.loads(german))
    for english, german in re.findall(r'^  (".*"): (".*"),$', PAGE["words.de.js"], re.MULTILINE)
}
OF_THE_SERVER = ("fault_", "key_", "group_", "step_")
"""Labels that German alone has: in English the server says these itself."""


def fixed(text: str) -> str:
    """A text as the German table has it: # for numbers and for what stands in quotation marks."""
    return re.sub(r'"[^"]*"|\d+', "#", text)


def test_every_line_of_a_table_is_a_label() -> None:
    """Nothing stands in a table in a form that the other tests would not see."""
    for language, table in TABLES.items():
        body = PAGE[f"words.{language}.js"].partition("\n};\n")[0]
        assert len(table) == sum(not line.lstrip().startswith("//") for line in body.splitlines()) - 1, language
    lines = PAGE["words.de.js"].partition("SAID = {\n")[2].splitlines()
    assert (
        len(SAID)
        == sum(line.startswith('  "') for line in lines)
        == len([one for one in lines if one[:4] != "  //"]) - 1
    )


def test_every_language_has_every_label() -> None:
    """The tables have the same keys, in the same order; English alone has nothing to say about its messages."""
    assert [key for key in GERMAN if not key.startswith(OF_THE_SERVER)] == list(ENGLISH)
    assert [key for key, text in ENGLISH.items() if not text.strip()] == ["inEnglish"]
    assert all(text.strip() for text in (*GERMAN.values(), *SAID.values()))


def test_every_label_that_the_page_asks_for_is_there() -> None:
    """Also those in attributes of the page and in lists of keys; and none is there for nobody."""
    code = "\n".join(text for name, text in PAGE.items() if not name.startswith(("words.", "codemirror")))
    asked = set(re.findall(r'\bword\("(\w+)"\)|data-(?:word|title)="(\w+)"', code))
    assert {one or other for one, other in asked} <= set(ENGLISH)
    groups = tuple(f"{one}_" for one in re.findall(r'named\("(\w+)"|word\(`(\w+)_\$', code) for one in one if one)
    unused = [key for key in ENGLISH if not key.startswith(groups) and not re.search(rf"[\"'`]{key}[\"'`]", code)]
    assert unused == ["request", "manifest"]  # a telegram, the state of a file: as the server says it


def test_german_has_what_the_server_says_by_a_word() -> None:
    """Kinds of jobs, faults with their keys, groups and steps of a verification: all that there are, and no others."""
    assert {form.kind for form in drive_forms()} | {"run", "stop", "read_recipe", "compare_recipe"} >= {
        key.removeprefix("kind_") for key in GERMAN if key.startswith("kind_")
    }
    for form in drive_forms():
        assert {f"kind_{form.kind}", f"is_{form.kind}"} <= GERMAN.keys()
    faults = {f"fault_{kind.value}" for kind in (*DRIVE_FAULTS, *STATION_FAULTS)}
    keys = {f"key_{key}" for shape in (DriveFault, StationFault) for key in shape.model_fields if key != "kind"}
    groups, steps = set(), set()
    for path in (ROOT / "plcgen").rglob("*.py"):
        if {"proof", "report", "oracles"} & set(path.parts):
            text = path.read_text("utf-8")
            groups |= set(re.findall(r'\bCheckGroup\(\s*"(\w+)"', text))
            steps |= set(re.findall(r'\bprogress\(f?"(\w+)', text))
    said = {key for key in GERMAN if key.startswith(OF_THE_SERVER)}
    assert said == faults | keys | {f"group_{one}" for one in groups - AUDITED} | {f"step_{one}" for one in steps}


AUDITED = {"buffers", "calls"}
"""Groups of an audit, which is shown as the terminal has it."""


@pytest.mark.parametrize("name", device_names())
def test_german_has_the_rule_of_every_drive_object(name: str) -> None:
    """Of every device that ships."""
    assert fixed(find_device(name).drive_object_rule) in SAID


def _refusals(*names: str) -> Iterator[str]:
    """What the forms answer instead of an edit, with # for what they put in."""
    for path in (ROOT / "plcgen" / "workbench").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))) if path.name in names else ():
            if isinstance(node, ast.Call) and getattr(node.func, "id", "") in {"refused", "wrong"}:
                for argument in node.args[1:]:
                    if isinstance(argument, ast.Constant):
                        yield fixed(str(argument.value))
                    elif isinstance(argument, ast.JoinedStr):
                        parts = [str(one.value) if isinstance(one, ast.Constant) else "0" for one in argument.values]
                        yield fixed("".join(parts))


def test_german_has_what_the_forms_refuse() -> None:
    """With the remedy; what cannot come from a form of the page may be English, as messages are."""
    assert {one for one in _refusals("form.py", "starting.py") if one not in SAID} == ELSEWHERE


ELSEWHERE = {
    "a spec begins with one job at least", "choose of #", "# stands in another file",
}  # fmt: skip
"""The page offers what there is; only a spec of several files comes to the others."""
