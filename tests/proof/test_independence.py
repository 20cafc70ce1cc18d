"""The proof shares no constant with the generator, and its engine knows no protocol."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

from tests.projects import ROOT

PACKAGE = ROOT / "plcgen"
ENGINE = sorted((PACKAGE / "proof").rglob("*.py"))
PROTOCOLS = sorted(PACKAGE.glob("*/proof/**/*.py"))
GENERATOR = re.compile(r"plcgen\.(build|templates)\b|plcgen\.(ds47|ppi)\.(views|words|documents)\b")
PLANNING = re.compile(r"plcgen\.(ds47|ppi)\.(plan|kinds)\b")
HELD = {
    "ds47/proof/second.py": frozenset({"element_type"}),  # held against a second table, that is the check
    "ds47/proof/wording/__init__.py": frozenset({"kind_called"}),  # the title that a third-party kind brings
}
"""Functions of the planner that a module of the proof looks at, and why."""
NOUN = re.compile(r"[A-Z]\w*[a-z]\w*")


def imported(path: Path) -> set[str]:
    """Modules that a file imports, inside functions too."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module is not None:
            found |= {node.module, *(f"{node.module}.{name.name}" for name in node.names)}
        elif isinstance(node, ast.Import):
            found |= {name.name for name in node.names}
    return found


@pytest.mark.parametrize("path", [*ENGINE, *PROTOCOLS], ids=lambda path: str(path.relative_to(PACKAGE)))
def test_nothing_comes_from_the_generator(path: Path) -> None:
    """Status words, states, times and names of files are stated a second time."""
    assert {module for module in imported(path) if GENERATOR.match(module)} == set()


@pytest.mark.parametrize("path", PROTOCOLS, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_of_the_plan_only_nouns_are_taken(path: Path) -> None:
    """A project is what the proof is about; functions and figures of what plans and packs it are the generator's."""
    tree = ast.walk(ast.parse(path.read_text("utf-8")))
    froms = [node for node in tree if isinstance(node, ast.ImportFrom) and PLANNING.match(node.module or "")]
    taken = {name.name for node in froms for name in node.names if not NOUN.fullmatch(name.name)}
    assert taken <= HELD.get(path.relative_to(PACKAGE).as_posix(), frozenset())


@pytest.mark.parametrize("path", ENGINE, ids=lambda path: path.name)
def test_the_engine_knows_no_protocol(path: Path) -> None:
    """A protocol is met through ``plan.protocol``."""
    assert {module for module in imported(path) if module.startswith(("plcgen.ds47", "plcgen.ppi"))} == set()
    assert not re.search(r"\b(ppi|ds47|drive_object|PpiPlan|DrivePlan)\b", path.read_text("utf-8"), re.IGNORECASE)
