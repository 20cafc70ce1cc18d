"""The README: short, and the same in three languages."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
ENGLISH = (ROOT / "README.md").read_text("utf-8")
_BLOCK = re.compile(r"```\w*\n.*?```", re.DOTALL)
_REMARK = re.compile(r" +# .*")
_NUMBER = re.compile(r"(?<![\w.])\d+(?:\.\d+)?")
_HIDDEN = re.compile(r"<!--.*?-->", re.DOTALL)


def commands(text: str) -> list[str]:
    """Every block of code, without remarks in it."""
    return [_REMARK.sub("", block) for block in _BLOCK.findall(text)]


def test_it_is_read_in_five_minutes() -> None:
    """At most 900 words, code included; a sentence and the picture of the page come first, then how to install it."""
    assert len(_HIDDEN.sub("", ENGLISH).split()) <= 900
    lines = [line for line in ENGLISH.splitlines() if line]
    assert lines[0] == "# plcgen"
    assert lines[2].startswith("![")
    assert commands(ENGLISH)[0] == "```console\n$ pipx install plcgen-*.whl\n```"


@pytest.mark.parametrize("language", ["de", "zh"])
def test_other_languages_have_the_same_commands_figures_and_links(language: str) -> None:
    """Whoever changes one of the three changes all of them."""
    text = (ROOT / f"README.{language}.md").read_text("utf-8")
    assert commands(text) == commands(ENGLISH)
    prose, english = (_HIDDEN.sub("", _BLOCK.sub("", each)) for each in (text, ENGLISH))
    assert _NUMBER.findall(prose) == _NUMBER.findall(english)
    links = [set(re.findall(r"\]\(([^)]+)\)", each)) for each in (prose, english)]
    assert {link for link in links[0] ^ links[1] if not link.startswith("README")} == set()
    assert len(re.findall(r"^#+ ", prose, re.MULTILINE)) == len(re.findall(r"^#+ ", english, re.MULTILINE))


def test_a_task_is_one_screen() -> None:
    """Twelve pages, each at most 45 lines, each named by the README; their commands run as those of every page."""
    pages = sorted((ROOT / "docs" / "tasks").glob("*.md"))
    assert len(pages) == 12
    assert [page.name for page in pages if len(page.read_text("utf-8").splitlines()) > 45] == []
    assert [page.name for page in pages if f"docs/tasks/{page.name}" not in ENGLISH] == []


def test_the_glossary_has_the_terms_of_the_other_languages() -> None:
    """Each German and Chinese term of docs/glossary.md is the one that the README of that language uses."""
    page = (ROOT / "docs" / "glossary.md").read_text("utf-8")
    table = page[page.index("## In German and Chinese") : page.index("<!-- languages -->")]
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in table.splitlines() if line[:1] == "|"]
    german, chinese = ((ROOT / f"README.{language}.md").read_text("utf-8").lower() for language in ("de", "zh"))
    stem = {"Statuswort": "statusw"}  # its plural has another vowel
    assert len(rows) > 20
    assert [row for row in rows[2:] if stem.get(row[1], row[1].lower()) not in german] == []
    assert [row for row in rows[2:] if row[2].lower() not in chinese] == []
