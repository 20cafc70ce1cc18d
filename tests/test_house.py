"""The house keeps its shape: no circles of imports, no room that asks which protocol it has, no class of two ideas."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path

from tests.projects import ROOT

PACKAGE = ROOT / "plcgen"


def name_of(path: Path) -> str:
    """Module name of a file."""
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


@cache
def modules() -> dict[str, ast.Module]:
    """Every module of the package, parsed when the first test asks."""
    return {name_of(path): ast.parse(path.read_text("utf-8")) for path in sorted(PACKAGE.rglob("*.py"))}


def imported(tree: ast.Module) -> Iterator[str]:
    """Modules of the package that a module imports, inside functions and for type checkers too."""
    known = modules().keys()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name in known)
        elif isinstance(node, ast.ImportFrom) and node.module and node.module.split(".")[0] == "plcgen":
            below = {f"{node.module}.{alias.name}" for alias in node.names} & known
            yield from below or {node.module} & known


@cache
def graph() -> dict[str, set[str]]:
    """What each module imports."""
    return {name: set(imported(tree)) - {name} for name, tree in modules().items()}


def reachable(start: str) -> set[str]:
    """Every module that a module imports, directly or not."""
    seen: set[str] = set()
    left = [start]
    while left:
        for module in graph()[left.pop()] - seen:
            seen.add(module)
            left.append(module)
    return seen


def test_no_circles() -> None:
    """Not inside a room either, and not through imports inside functions; CycleError names the modules of one."""
    assert set(TopologicalSorter(graph()).static_order()) == set(graph())


def test_the_graph_sees_imports_inside_functions() -> None:
    """A face imports its parts when they are asked for: the graph knows that it does."""
    assert "plcgen.ds47.plan.resolve" in graph()["plcgen.ds47"]
    assert "plcgen.ds47.schema" in reachable("plcgen.ds47")


def test_no_room_asks_which_protocol_it_has() -> None:
    """Outside the protocols, the program above them and their own verbs, nothing imports a protocol."""
    above = ("plcgen.ds47", "plcgen.ppi", "plcgen.api", "plcgen.cli", "plcgen.workbench")
    found = {
        (name, module)
        for name, modules in graph().items()
        for module in modules
        if module.startswith(("plcgen.ds47", "plcgen.ppi"))
        if not name.startswith(above)
    }
    assert found == set()


def test_protocols_do_not_know_each_other() -> None:
    """Neither imports anything of the other."""
    for own, other in (("ds47", "ppi"), ("ppi", "ds47")):
        inside = [name for name in graph() if name.startswith(f"plcgen.{own}.")]
        found = {(name, m) for name in inside for m in graph()[name] if m.startswith(f"plcgen.{other}.")}
        assert found == set()


def test_no_stubs_that_only_subclasses_fill() -> None:
    """Parts are composed; how long a class is, its reader decides."""
    texts = {path: path.read_text("utf-8") for path in sorted(PACKAGE.rglob("*.py"))}
    assert [name for name, text in texts.items() if "raise NotImplementedError" in text] == []
