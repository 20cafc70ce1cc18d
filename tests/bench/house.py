"""Figures of how large the package is: ``make house``, ``python -m tests.bench.house ROOM`` what could go there.

A function counts as used once if its name stands at one place of the package besides its definition and imports, in a
call or in a table.
"""

from __future__ import annotations

import ast
import sys
from collections import Counter
from collections.abc import Iterator, Mapping
from graphlib import TopologicalSorter

from tests.test_house import PACKAGE, graph, modules, name_of

GOALS = {"lines": 68_000, "files below 40 lines": 40, "functions used once": 500}
SMALL = 40


def lines() -> dict[str, int]:
    """Lines of every module."""
    return {name_of(path): len(path.read_text("utf-8").splitlines()) for path in sorted(PACKAGE.rglob("*.py"))}


def names(module: str, tree: ast.Module) -> dict[str, tuple[str, str]]:
    """What the names of a module stand for: module and name, the name empty for a module itself."""
    found = {
        node.name: (module, node.name) for node in tree.body if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.module:
            for alias in node.names:
                inner = f"{node.module}.{alias.name}"
                found[alias.asname or alias.name] = (inner, "") if inner in modules() else (node.module, alias.name)
    return found


def uses() -> Mapping[tuple[str, str], list[str]]:
    """Of every function of a module, the places where its name stands: ``module:line``, ``()`` where it is called."""
    known = {module: names(module, tree) for module, tree in modules().items()}
    places: dict[tuple[str, str], list[str]] = {
        (module, node.name): []
        for module, tree in modules().items()
        for node in tree.body
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) and not node.decorator_list
    }

    def meant(module: str, name: str) -> tuple[str, str]:
        seen = (module, name)
        while (further := known.get(seen[0], {}).get(seen[1])) not in {None, seen}:
            assert further is not None
            seen = further
        return seen

    for module, tree in modules().items():
        called = {id(node.func) for node in ast.walk(tree) if isinstance(node, ast.Call)}
        for node in ast.walk(tree):
            if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load):
                target = meant(module, node.id)
            elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
                home, inner = known[module].get(node.value.id, ("", "-"))
                target = meant(home, node.attr) if not inner else ("", "")
            else:
                continue
            if target in places:
                places[target].append(f"{module}:{node.lineno}{'()' if id(node) in called else ''}")
    return places


def room(module: str) -> str:
    """The room that a module is in."""
    return ".".join(module.split(".")[1:2]) or "plcgen"


def figures() -> Iterator[tuple[str, int]]:
    """Every figure with its name."""
    sizes = lines()
    once = {function: found for function, found in uses().items() if len(found) == 1}
    yield "lines", sum(sizes.values())
    yield "files", len(sizes)
    yield "files below 40 lines", sum(size < SMALL for size in sizes.values())
    yield "functions used once", len(once)
    yield "of these called, the others in tables", sum(found[0].endswith("()") for found in once.values())
    yield "functions used nowhere in the package", sum(not found for found in uses().values())
    try:
        circles = 0 * len(list(TopologicalSorter(graph()).static_order()))
    except ValueError:
        circles = 1
    yield "circles of imports", circles
    yield "folders", len({path.parent for path in PACKAGE.rglob("*.py")})


def main(wanted: str) -> None:
    """Print the figures, by room too; of one room its small files and its functions that are used once."""
    sizes, once = lines(), {function: found for function, found in uses().items() if len(found) == 1}
    if wanted:
        for name, size in sizes.items():
            if size < SMALL and f".{wanted}" in name:
                print(f"{size:4} lines  {name}")
        for (module, function), found in sorted(uses().items()):
            if len(found) < 2 and f"plcgen.{wanted}" in module:
                print(f"{module}.{function}  {'nowhere' if not found else found[0]}")
        return
    for title, number in figures():
        print(f"{title:40} {number:7,}{f'  goal {GOALS[title]:,}' if title in GOALS else ''}")
    by_room: dict[str, Counter[str]] = {}
    for name, size in sizes.items():
        by_room.setdefault(room(name), Counter()).update(lines=size, files=1, small=size < SMALL)
    for module, _ in once:
        by_room[room(module)]["once"] += 1
    print("\nroom          lines  files  below 40  used once")
    for name, count in sorted(by_room.items(), key=lambda one: -one[1]["lines"]):
        print(f"{name:10} {count['lines']:8,} {count['files']:6} {count['small']:9} {count['once']:10}")


if __name__ == "__main__":
    main(sys.argv[1].removeprefix("plcgen.") if len(sys.argv) > 1 else "")
