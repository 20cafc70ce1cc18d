"""README and docs as programs: their blocks, and what HTML comments before a block say about running it.

``<!-- file: NAME -->``       the block is a file of that name
``<!-- setup: SCRIPT -->``    shell lines that come first and that the page does not show
``<!-- server -->``           the first command runs until the end of the page; ``server: COMMAND`` is a hidden one
``<!-- exit: N.. -->``        exit codes of the commands of the block if one is not 0
``<!-- not run: REASON -->``  the block needs what a test does not have
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
PAGES = [
    ROOT / "README.md",
    *(ROOT / name / "README.md" for name in ("templates", "plcgen/s7/layout", "plcgen/s7/memory", "tests/engine")),
    *(path for path in sorted((ROOT / "docs").rglob("*.md")) if path.parent.name != "codes"),
]
"""All pages but those of the codes: their examples are the table of codes, which has tests of its own."""

_BLOCK = re.compile(r"((?:^<!--.*?-->\n)*)^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_NOTE = re.compile(r"<!-- (file|setup|server|exit|not run)(?:: *|\s)(.*?)\s*-->", re.DOTALL)
_COMMAND = re.compile(r"^\$ (.+)\n((?:(?!\$ ).*\n)*)", re.MULTILINE)


@dataclass(frozen=True, slots=True)
class Block:
    """A fenced block: where it begins, its language, its text, and the notes before it by name."""

    page: Path
    line: int
    language: str
    text: str
    notes: dict[str, str]

    @property
    def place(self) -> str:
        """``page:line``."""
        return f"{self.page.relative_to(ROOT)}:{self.line}"

    @property
    def commands(self) -> list[tuple[str, str]]:
        """Commands of a console block, each with the output that the page shows."""
        return _COMMAND.findall(self.text) if self.language == "console" else []


def blocks(page: Path) -> Iterator[Block]:
    """Every fenced block of a page, in order."""
    text = page.read_text("utf-8")
    for found in _BLOCK.finditer(text):
        line = text.count("\n", 0, found.start(2)) + 1
        yield Block(page, line, found[2], found[3], dict(_NOTE.findall(found[1])))


def questions() -> dict[str, dict[str, list[str]]]:
    """What somebody asks, and the pages of which one is to come first; by when the questions were written."""
    return tomllib.loads((ROOT / "tests" / "docs" / "questions.toml").read_text("utf-8"))
