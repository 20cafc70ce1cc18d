"""README, docs and messages are written in plain English: what no native speaker would write is on a list."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.docs.pages import PAGES, ROOT

ODD = {
    r"\bsoil(s|ed|ing)?\b": "fill with garbage",
    r"\bsay(s|ing)? the same\b": "be equal, agree",
    r"\bstarves?\b": "every job gets its turn",
    r"\bhabits?\b": "behaviour, custom",
    r"\bothers notice\b": "what changed for HMIs, PLCs and drives",
    r"\bway of the data\b": "flow of data",
    r"\bthe house\b": "rooms, structure",
    r"\bin mid-": "during",
    r"\bspoil(s|t|ed|ing)?\b": "damage, affect",
    r"\bfor ever\b": "forever",
    r"\banew\b": "again",
    r"\btoo dear\b": "too costly",
    r"\bone an? (line|port|object|job)\b": "one per",
    r"\b(sources|SCL|answers|exchange) of others\b|\bof other people\b": "third-party",
    r"\bby (itself|themselves)\b": "on its own, separately, automatically",
    r"\btime-outs?\b": "timeout",
    r"\b(is|are|was) (only |still )?said\b": "is reported",
    r"\bmistakes? (is|are) told\b": "is reported",
    r"\bat hand\b": "available",
    r"\bsenseless\b": "meaningless",
    r"\bdoes no harm\b": "is harmless",
    r"\bas people have\b": "in any common form",
    r"(?-i:\bblanks?\b)": "space",
    r"\bstands? (at|on|below|beside|behind|in a)\b": "is",
    r"\bgoes wrong on\b": "fails on",
    r"\b(makes?|made) an error of\b": "is an error, causes an error",
    r"\bhangs? together\b": "depend on each other",
    r"\brepeats? itself\b": "is repeated, recurs",
    r"\bfrom one hand\b": "by the same author",
    r"\bspoke against\b|\bspeaks? against\b": "the argument against",
    r"\bbehind (BEGIN|it|them|its?|this|an?|the (last|first|value|name|colon|point|end|header|block))\b": "after",
}
"""What was found so far, with what is meant."""
ANY = re.compile("|".join(ODD), re.IGNORECASE)


def written() -> Iterator[tuple[str, str]]:
    """Everything a reader of the project meets, with its place."""
    pages = [
        *PAGES,
        *(ROOT / name for name in ("CHANGELOG.md", "examples/README.md", "plcgen/base/diagnostics/codes.toml")),
    ]
    for page in pages:
        for number, line in enumerate(page.read_text("utf-8").splitlines(), 1):
            yield f"{page.relative_to(ROOT)}:{number}", line
    for source in sorted((ROOT / "plcgen").rglob("*.py")):
        if source.parent.name in {"documents", "views"}:
            continue  # words of generated files, which change with a version of the generator only
        for line, text in messages(source):
            yield f"{source.relative_to(ROOT)}:{line}", text


def messages(source: Path) -> Iterator[tuple[int, str]]:
    """String literals of a module that are no docstrings, but for those of commands, and its public names."""
    tree = ast.parse(source.read_text("utf-8"))
    hidden = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef | ast.ClassDef) and not node.name.startswith("_"):
            yield node.lineno, node.name.replace("_", " ")
        if isinstance(node, ast.Expr) and "cli" not in source.parts:
            hidden.add(id(node.value))
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in hidden:
            yield node.lineno, node.value


@pytest.mark.slow
def test_no_odd_word() -> None:
    """No page, message or public name has a word of the list."""
    found = [
        f'{place}: "{match[0]}", say: {meant}'
        for place, text in written()
        if ANY.search(text)
        for odd, meant in ODD.items()
        for match in re.finditer(odd, text, re.IGNORECASE)
    ]
    assert found == []
