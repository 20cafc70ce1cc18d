"""docs/architecture.md shows the package as it is."""

from __future__ import annotations

import ast
import functools
import re
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.docs.pages import ROOT

PACKAGE = ROOT / "plcgen"
PAGE = (ROOT / "docs" / "architecture.md").read_text("utf-8")
HOMES = {"yaml": "base/files", "jinja2": "build", "lxml": "s7/xml", "serial": "base/line", "click": "cli"}


@functools.cache
def imported(path: Path) -> frozenset[str]:
    """Top-level names of what a module imports at run time."""
    return frozenset(_imported(ast.parse(path.read_text("utf-8"))))


def _imported(tree: ast.Module) -> Iterator[str]:
    for node in ast.walk(tree):
        if isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING":
            node.body.clear()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (name.name.partition(".")[0] for name in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module.partition(".")[0]


def test_the_table_lists_every_room_in_the_order_of_the_levels() -> None:
    """Top first, as in the contract of import-linter; rooms of one level in any order."""
    table = PAGE[: PAGE.index("<!-- rooms -->")]
    rooms = re.findall(r"^\| `(\w+)` \|", table, re.MULTILINE)
    assert sorted(rooms) == sorted(path.parent.name for path in PACKAGE.glob("*/__init__.py"))
    contract = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["tool"]["importlinter"]["contracts"][0]
    level: dict[str, int] = {}
    for number, layer in enumerate(contract["layers"]):
        for room in re.findall(r"(\w+)", layer):
            level.setdefault(room, number)
    assert [level[room] for room in rooms] == sorted(level[room] for room in rooms)


@pytest.mark.slow
def test_third_party_libraries_have_one_place_each() -> None:
    """The page says which; a second place would be a second way to do the same."""
    found: dict[str, set[str]] = {name: set() for name in HOMES}
    for path in PACKAGE.rglob("*.py"):
        for name in HOMES.keys() & imported(path):
            found[name].add(next(home for home in (*HOMES.values(), str(path)) if path.is_relative_to(PACKAGE / home)))
    assert found == {name: {home} for name, home in HOMES.items()}


@pytest.mark.slow
def test_dependencies_are_imported() -> None:
    """Whatever the package or one of its extras installs is used by the package; what developers need is a group."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    extras = [need for needs in project["optional-dependencies"].values() for need in needs]
    needs = (need for need in (*project["dependencies"], *extras) if not need.startswith("plcgen["))
    names = {re.split(r"[<>=]", need)[0] for need in needs}
    module = {"PyYAML": "yaml", "pyserial": "serial", "python-snap7": "snap7", "paho-mqtt": "paho"}
    used = {name for path in PACKAGE.rglob("*.py") for name in imported(path)}
    assert {module.get(name, name) for name in names} <= used


def test_both_protocols_have_the_structure_of_the_page() -> None:
    """Every folder and file that the page names is in both packages."""
    section = PAGE[PAGE.index("| folder or file") :]
    named = set(
        re.findall(r"`(\w+)`", "".join(row.split("|")[1] for row in re.findall(r"^\|.*`.*\|$", section, re.MULTILINE)))
    )
    for protocol in ("ds47", "ppi"):
        parts = {path.stem for path in (PACKAGE / protocol).iterdir()}
        assert named - parts == set(), protocol
