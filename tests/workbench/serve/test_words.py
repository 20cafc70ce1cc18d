"""Labels of the page: one table for each language, each with every label."""

from __future__ import annotations

import json
import re

import pytest

pytest.importorskip("starlette", reason="the extra serve is not installed")

from plcgen.workbench.serve.page import FOLDER

TABLES = {
    path.name.split(".")[1]: {
        key: str(json.loads(text))
        for key, text in re.findall(r'^  (\w+): (".*"),$', path.read_text("utf-8"), re.MULTILINE)
    }
    for path in sorted(FOLDER.glob("words.*.js"))
}
ENGLISH, GERMAN = TABLES["en"], TABLES["de"]
PAGE = {path.name: path.read_text("utf-8") for path in FOLDER.glob("*.*") if path.suffix in {".js", ".html"}}


def test_every_line_of_a_table_is_a_label() -> None:
    """Nothing stands in a table in a form that the other tests would not see."""
    for language, table in TABLES.items():
        assert len(table) == len(PAGE[f"words.{language}.js"].splitlines()) - 3, language


@pytest.mark.parametrize("language", TABLES)
def test_every_language_has_every_label(language: str) -> None:
    """The tables have the same keys, in the same order; English alone has nothing to say about its messages."""
    assert list(TABLES[language]) == list(ENGLISH)
    assert [key for key, text in TABLES[language].items() if not text.strip()] == (
        ["inEnglish"] if language == "en" else []
    )


def test_every_label_that_the_page_asks_for_is_there() -> None:
    """Also those in attributes of the page and in lists of keys; and none is there for nobody."""
    code = "\n".join(text for name, text in PAGE.items() if not name.startswith(("words.", "codemirror")))
    asked = set(re.findall(r'\bword\("(\w+)"\)|data-(?:word|title)="(\w+)"', code))
    assert {one or other for one, other in asked} <= set(ENGLISH)
    groups = tuple(f"{one}_" for one in re.findall(r'named\("(\w+)"|word\(`(\w+)_\$', code) for one in one if one)
    unused = [key for key in ENGLISH if not key.startswith(groups) and not re.search(rf"[\"'`]{key}[\"'`]", code)]
    assert unused == ["manifest"]  # a state of a file, as the server says it
