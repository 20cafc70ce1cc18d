"""Mistakes in the shape of a spec hide nothing, and nothing that follows from them is reported."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from plcgen import api
from plcgen.base.diagnostics import Report
from plcgen.base.files.yaml import YamlNode, parse_yaml
from tests.projects import ROOT
from tests.yaml_files import read_yaml

CASES = ROOT / "tests" / "cases"
OF_A_SOUND_SPEC = {"PG227", "PG263", "PG412", "PG413"}
"""What is written if nothing is connected, where PROFINET is, and sizes: of blocks that can be made."""
MARKS = str.maketrans("", "", "«»‹›")


def cases(kind: str) -> list[Any]:
    """Specs of the cases: what is wrong with them is wrong with their meaning."""
    return [
        pytest.param(case, id=f"{path.stem}: {case['name']}")
        for path in sorted(CASES.glob("PG[2-4]??.yaml"))
        for case in read_yaml(path.read_text("utf-8")).get(kind, [])
        if "spec" in case and case.get("severity", "error") != "note"
    ]


def check(folder: Path, case: dict[str, Any], text: str) -> list[tuple[str, str]]:
    """Code and place of what is found."""
    for name, content in case.get("files", {}).items():
        (folder / name).write_text(content, "utf-8")
    path = folder / "spec.yaml"
    path.write_text(text, "utf-8")
    return [(d.code, f"{d.span.line}:{d.span.column} {d.message}") for d in api.check(path).diagnostics]


@pytest.mark.parametrize("case", cases("fail"))
def test_an_unknown_key_hides_no_other_mistake(case: dict[str, Any], tmp_path: Path) -> None:
    """The same findings as without it, and the key."""
    text = case["spec"].translate(MARKS)
    alone = check(tmp_path, case, text)
    both = check(tmp_path, case, f"{text.rstrip()}\nzzz: 1\n")
    problems = [found for found in alone if found[0] not in OF_A_SOUND_SPEC]
    assert [found for found in both if found[0] != "PG104" or "zzz" not in found[1]] == problems
    assert "PG104" in [found for found, _ in both]


def scalars(node: YamlNode) -> Iterator[YamlNode]:
    """Every value that stands in one line."""
    if node.kind == "scalar":
        yield node
    for _, below in node.pairs.values():
        yield from scalars(below)
    for item in node.items:
        yield from scalars(item)


def damaged(text: str, by: str) -> Iterator[str]:
    """The text with one value after the other replaced."""
    root = parse_yaml(text, "x", Report())
    lines = text.splitlines(keepends=True)
    for node in scalars(root) if root is not None else ():
        place = node.span
        if place.line == place.end_line and place.end_column > place.column:
            line = lines[place.line - 1]
            new = line[: place.column - 1] + by + line[place.end_column - 1 :]
            yield "".join((*lines[: place.line - 1], new, *lines[place.line :]))


@pytest.mark.slow
@pytest.mark.parametrize("case", cases("pass"))
def test_nothing_follows_from_what_cannot_be_read(case: dict[str, Any], tmp_path: Path) -> None:
    """A good spec with one value of a wrong type has that mistake and no other."""
    anyway = {name for name, _ in check(tmp_path, case, case["spec"])}
    for by in ("{zz: [1]}", "[[]]", "-7.5"):
        for text in damaged(case["spec"], by):
            found = [name for name, _ in check(tmp_path, case, text) if name not in anyway]
            if any(name < "PG2" for name in found):
                assert not [name for name in found if name >= "PG2"], text


def test_every_mistake_is_reported_in_one_run(tmp_path: Path) -> None:
    """A misspelt key, a wrong type and a missing key beside a drive, a parameter and a value that do not exist."""
    path = tmp_path / "spec.yaml"
    path.write_text(
        """
plc: {name: a, family: s7-1500, toolchain: tia-v19, nmae: x}
drives:
  d: {device: sinamics-g120, hardware_id: 270, parameters: {P2900: {type: FloatingPoint, min: 0.0}}}
  e: {hardware_id: 271}
jobs:
  j: {drive: x, read: [P1120]}
  k: {drive: d, reed: [foo]}
  l: {drive: d, write: {P2900: -1.0, P1121: {zz: 1}}, timeout: 10}
  m: {drive: e, read: [P1120, foo]}
""",
        "utf-8",
    )
    found = [(d.code, d.span.line, d.span.column) for d in api.check(path).diagnostics]
    assert found == [
        ("PG104", 2, 53),  # nmae
        ("PG105", 5, 6),  # e lacks device
        ("PG202", 7, 14),  # no drive x
        ("PG104", 8, 17),  # reed
        ("PG203", 8, 24),  # read as read: no parameter foo
        ("PG209", 9, 32),  # below min
        ("PG104", 9, 46),  # zz
        ("PG107", 9, 64),  # no unit
    ]  # nothing of m: its drive could not be read
    assert api.check(path).project is None


def test_a_drive_that_is_not_there_beside_one_that_cannot_be_read(tmp_path: Path) -> None:
    """No list of drives is offered that has none in it."""
    path = tmp_path / "spec.yaml"
    path.write_text(
        "plc: {name: a, family: s7-1500, toolchain: tia-v19}\n"
        "drives: {d: {device: sinamics-g120, hardware_id: 270000}}\n"
        "jobs: {j: {drive: x, read: [P1120]}}\n",
        "utf-8",
    )
    (told,) = (one for one in api.check(path).diagnostics if one.code == "PG202")
    assert told.help == "the spec has no drive that can be read"


@pytest.mark.parametrize("device", ["{zz: [1]}", "sinamics-g12"])
def test_a_recipe_that_no_job_uses_beside_a_drive_that_cannot_be_read(device: str, tmp_path: Path) -> None:
    """That drive has its parameter: nothing follows from the mistake."""
    path = tmp_path / "spec.yaml"
    path.write_text(
        "plc: {name: a, family: s7-1500, toolchain: tia-v19}\n"
        "drives:\n"
        "  d: {device: sinamics-g120, hardware_id: 270}\n"
        f"  e: {{device: {device}, hardware_id: 271, parameters: {{P9999: {{type: Unsigned16}}}}}}\n"
        "recipes: {winding: {parameters: [P9999], records: 2}}\n"
        "jobs: {j: {drive: d, read: P1120}}\n",
        "utf-8",
    )
    (told,) = api.check(path).diagnostics
    assert (told.span.line, told.code < "PG202") == (4, True)


def test_an_alias_and_a_list_of_drives(tmp_path: Path) -> None:
    """A drive that cannot be read is in a list that two jobs share: the second job has another mistake, which waits."""
    path = tmp_path / "spec.yaml"
    path.write_text(
        """
plc: {name: a, family: s7-1500, toolchain: tia-v19}
drives:
  a: {device: sinamics-g120, hardware_id: [270]}
  b: {device: sinamics-g120, hardware_id: 271}
jobs:
  j: {drive: &all [a, b], read: [P1120]}
  k: {drive: *all, read: [foo]}
  l: {drive: b, read: [foo]}
""",
        "utf-8",
    )
    assert [(d.code, d.span.line) for d in api.check(path).diagnostics] == [("PG106", 4), ("PG203", 9)]
