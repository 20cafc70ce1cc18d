"""Whatever stands in the place of what belongs there is refused at a line and column with a code, or means something.

``make hostile`` puts every shape to every place, ``make test`` one to each of some of them.
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Callable, Iterator
from itertools import cycle
from pathlib import Path
from typing import Any

import pytest
import yaml

from plcgen import api
from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Severity
from plcgen.cli.config import load_config
from plcgen.ds47.recording.faults import plan_faults
from plcgen.ds47.sim.load import load_drive
from plcgen.ppi.recording import read_faults
from plcgen.ppi.sim.load import load_bus
from plcgen.s7.compare.policy import load_policy
from tests import wrong_shapes
from tests.projects import MM4, ROOT
from tests.yaml_files import read_yaml

HOSTILE = "PLCGEN_HOSTILE" in os.environ
pytestmark = pytest.mark.slow
Door = Callable[[Path], object]
_FREE = {
    "jobs", "drives", "units", "stations", "recipes", "records", "variables", "parameters", "write", "compare", "read",
    "symbols", "ppi", "values",
}  # fmt: skip
"""Keys below which names are whatever the file says."""
FAULTS = [
    {"kind": "busy", "call": "read", "times": 2, "drive": "d"},
    {"kind": "error", "position": 1, "number": 17, "after": 3},
]
LINE_FAULTS = {
    "faults": [
        {"kind": "item", "times": "always", "station": 3, "after": 1, "value": 1, "item": 1, "code": 5},
        {"kind": "junk", "milliseconds": 3, "data": "01 02"},
    ]
}
POLICY = {"member-renamed": "compatible", "member-moved": "breaking"}
SPEC_OF_A_DEVICE = {
    "plc": {"name": "a", "family": "s7-1500", "toolchain": "tia-v19"},
    "drives": {"d": {"device": "./wrong.yaml", "hardware_id": 270}},
    "jobs": {"j": {"drive": "d", "read": ["P1120"]}},
}


def on_page(page: str) -> Any:
    """The first YAML file on a page of the documentation, numbers written as YAML has them."""
    text = re.findall(r"```yaml\n(.*?)```", (ROOT / "docs" / page).read_text("utf-8"), re.DOTALL)[0]
    return _plain(read_yaml(re.sub(r"(?<=[ \[])16#([0-9A-F]+)", r"0x\1", text)))


def _plain(data: Any) -> Any:
    if isinstance(data, dict):
        return {str(key): _plain(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [_plain(each) for each in data]
    return data if isinstance(data, str | int | float | None) else str(data)


def a_profile() -> Any:
    """A shipped profile with parameters that have every key between them."""
    whole = _plain(read_yaml((ROOT / "specs/devices/sinamics-s120.yaml").read_text("utf-8")))
    some = {name: whole["parameters"][name] for name in ("P9", "R945", "P1120", "P840", "R965")}
    some["P9"]["values"] = {"ready": 0}
    return {**whole, "parameters": some, "sources": {"cu": "a", "tia": "b", "vector": "c", "lists": "d"}}


def a_lock(folder: Path) -> Any:
    """The lock of a spec, as far as its parts differ in kind."""
    api.lock(MM4, out=folder / "whole.lock.json")
    found = json.loads((folder / "whole.lock.json").read_text("utf-8"))
    found["blocks"] = list({block["kind"]: block for block in reversed(found["blocks"])}.values())
    for block in found["blocks"]:
        block["members"] = block.get("members", [])[:2]
    return {**found, "sources": ["a.db"]}


def specs() -> Iterator[Any]:
    """The shipped specs and those of the cases of every code."""
    for path in sorted((ROOT / "specs").glob("*.yaml")):
        yield path.read_text("utf-8")
    for path in sorted((ROOT / "tests/cases").glob("PG*.yaml")):
        cases = read_yaml(path.read_text("utf-8"))
        yield from (re.sub("[«»‹›]", "", case.get("spec") or "") for kind in cases.values() for case in kind)


def kinds_of_places() -> list[tuple[Any, wrong_shapes.Path]]:
    """Places of specs that differ in more than a name or the number of an element, each with its spec."""
    seen: set[tuple[tuple[str, ...], str]] = set()
    found = []
    for text in specs():
        try:
            data = _plain(read_yaml(text)) if len(text) < 3000 else None
        except (yaml.YAMLError, RecursionError):  # a mapping that contains itself
            continue
        if not isinstance(data, dict) or "plc" not in data:
            continue
        for path in wrong_shapes.places(data):
            steps = tuple(
                "*" if isinstance(b, int) or a in _FREE else b for a, b in zip(("", *path), path, strict=False)
            )
            kind = (steps, type(wrong_shapes.at(data, path)).__name__)
            if kind not in seen:
                seen.add(kind)
                found.append((data, path))
    return found


def raising(*found: Diagnostic) -> None:
    """Errors of a result as what other doors raise."""
    raise DiagnosticError(found)


def profile_door(path: Path) -> None:
    """A spec with a drive of this profile is checked."""
    spec = path.with_name("spec.yaml")
    spec.write_text(json.dumps(SPEC_OF_A_DEVICE), "utf-8")
    raising(*api.check(spec).diagnostics)


def lock_door(path: Path) -> None:
    """A source is compared with the lock."""
    path.with_name("a.db").write_text('DATA_BLOCK "B"\nSTRUCT\n  a : Int;\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n')
    raising(*api.check_lock(lock=path).diagnostics)


DOORS: dict[str, tuple[Callable[[Path], Any], Door]] = {
    "profile": (lambda _: a_profile(), profile_door),
    "drive": (lambda _: on_page("drive-yaml.md"), lambda path: load_drive(path.read_text("utf-8"), str(path))),
    "station": (lambda _: on_page("s7-200.md"), lambda path: load_bus(path.read_text("utf-8"), str(path))),
    "lock": (a_lock, lock_door),
    "policy": (lambda _: POLICY, lambda path: load_policy([str(path)])),
    "drive faults": (lambda _: FAULTS, lambda path: plan_faults([], path, ["d"])),
    "line faults": (lambda _: LINE_FAULTS, lambda path: read_faults([], path)),
}
"""What makes a good file of each kind, and what reads it."""


def told(text: str, door: Door, path: Path) -> str:
    """What is wrong with the answer to a file; empty if nothing is."""
    path.write_text(text, "utf-8")
    try:
        door(path)
    except DiagnosticError as answer:
        lines = text.count("\n") + 2
        for one in answer.diagnostics:
            if not re.fullmatch(r"PG[1-7]\d\d", one.code) or len(one.message) > 400 or not one.message.isprintable():
                return f"{one.code}: {one.message[:80]}"
            if one.severity is Severity.ERROR and not (1 <= one.span.line <= lines and one.span.column):
                return f"{one.code} at {one.span}"
    except Exception as problem:  # noqa: BLE001 - this is what must not be
        return repr(problem)[:100]
    return ""


def tried(data: Any, path: wrong_shapes.Path, only: int, door: Door, folder: Path) -> Iterator[str]:
    """What is wrong with the answers when something else stands at a place; ``only`` one thing without HOSTILE."""
    shapes = list(wrong_shapes.wrong_files(data, path))
    for what, text in shapes if HOSTILE else [shapes[only % len(shapes)]]:
        wrong = told(text, door, folder / "wrong.yaml")
        if wrong:
            yield f"{'.'.join(map(str, path))} is {what}: {wrong}"


@pytest.mark.parametrize("kind", DOORS)
def test_a_file_that_is_no_spec(kind: str, tmp_path: Path) -> None:
    """Every value and every key of a good file."""
    make, door = DOORS[kind]
    data = make(tmp_path)
    assert told(json.dumps(data), door, tmp_path / "wrong.yaml") == ""
    found = [
        wrong
        for number, path in enumerate(wrong_shapes.places(data))
        for wrong in tried(data, path, number, door, tmp_path)
    ]
    assert found == []


def test_a_spec(tmp_path: Path) -> None:
    """Every kind of place of a spec; one in three of them without ``make hostile``."""
    all_places = kinds_of_places()
    assert len(all_places) > 250
    chosen = all_places if HOSTILE else all_places[::3]
    found = [
        wrong
        for (data, path), number in zip(chosen, cycle(range(len(wrong_shapes.VALUES))), strict=False)
        for wrong in tried(data, path, number, lambda file: raising(*api.check(file).diagnostics), tmp_path)
    ]
    assert found == []


TOML = {
    "a list": '[1, "a"]', "a table": "{a = {b = 1}}", "nothing": "", "zero": "0", "a fraction": "1.5", "inf": "inf",
    "nan": "nan", "39 digits": "9" * 39, "5,000 digits": "9" * 5000, "true": "true", "a date": "2026-11-01",
    "a time": "07:32:00", "empty": '""', "a blank": '" "', "long": '"' + "x" * 5000 + '"', "two lines": '"""a\nb"""',
    "NUL": r'"a\u0000b"', "turned": r'"a\u202eb"', "10,000 lists": "[" * 10_000 + "]" * 10_000, "a word": "zq",
    "10,000 tables": "{a=" * 10_000 + "1" + "}" * 10_000, "300 lists": "[" * 300 + "]" * 300, "lists": "[[1], [[2]]]",
    "tables": "[{a = 1}]", "control": '"a\x01"',
}  # fmt: skip
KEYS_OF_TOML = {
    "": ("specs", "strict"), "verify": ("faults", "engine", "oracle", "cache"), "diff": ("fail-on", "policy"),
    "lock": ("file", "fail-on", "policy"),
}  # fmt: skip
NAMES_OF_TOML = ('""', '" "', '"a.b"', "x" * 5000, r'"\u202e"', ".".join("a" * 10_000), "1", "'a\"b'", "a.b", "é")


def toml_files() -> Iterator[str]:
    """Every key with every value, written in every way; names that no table has; the same twice; odd bytes."""
    for table, keys in KEYS_OF_TOML.items():
        head, dotted = (f"[{table}]\n", f"{table}.") if table else ("", "")
        for value in TOML.values():
            yield from (f"{head}{key} = {value}\n" for key in keys)
            yield from (f"{dotted}{key} = {value}\n" for key in keys)
            yield f"{table or 'x'} = {value}\n"
        yield from (f"{head}{key} = 1\n{key} = 2\n" for key in keys)
        for name in NAMES_OF_TOML:
            yield from (f"{head}{name} = 1\n", f"{head}x = {{{name} = 1}}\n", f"[{name}]\n", f"[[{name}]]\n")
    yield from ("\0", "\ufeff", "[", '"', "[verify]\n[verify]\n", "a" * 100_000, " " * 100_000, "x = 1\r", "#\x85\n")
    yield "#" + "x" * 2_000_000


def test_the_file_of_defaults(tmp_path: Path) -> None:
    """plcgen.toml, all of its keys."""
    files = list(toml_files())
    assert len(files) > 700
    found = {text[:60]: wrong for text in files if (wrong := told(text, load_config, tmp_path / "plcgen.toml"))}
    assert found == {}
