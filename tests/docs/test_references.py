"""What a page refers to exists: files, other pages, tests."""

from __future__ import annotations

import re

import pytest

from tests.docs.pages import PAGES, ROOT

_LINK = re.compile(r"\]\(([^)#\s]+)(#[^)\s]+)?\)")
_TEST = re.compile(r"`(tests/[\w/]+\.py)(?:::(\w+))?`")
_RECIPE = re.compile(r"^### ([^\n]+)\n(.*?)(?=^##)", re.MULTILINE | re.DOTALL)


def anchors(text: str) -> set[str]:
    """Names of the headings of a page, as GitHub makes them."""
    headings = re.findall(r"^#+ (.+)$", text, re.MULTILINE)
    return {"#" + re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-") for heading in headings}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page) -> None:
    """Every relative link of a page has its file and heading."""
    for target, anchor in _LINK.findall(page.read_text("utf-8")):
        if "://" not in target:
            found = page.parent / target
            assert found.exists(), target
            assert not anchor or anchor in anchors(found.read_text("utf-8")), target + anchor


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_tests_that_a_page_names_exist(page) -> None:
    """A test that was renamed is renamed in the page, too."""
    for file, name in _TEST.findall(page.read_text("utf-8")):
        assert (ROOT / file).exists(), file
        assert not name or f"def {name}(" in (ROOT / file).read_text("utf-8"), name


def test_every_recipe_has_its_test() -> None:
    """The four recipes of CONTRIBUTING.md each name a test that follows them."""
    recipes = dict(_RECIPE.findall((ROOT / "docs" / "CONTRIBUTING.md").read_text("utf-8")))
    assert list(recipes) == ["Add a device", "Add a kind of job", "Add a protocol", "Add an output format"]
    assert all("Test: `tests/" in recipe for recipe in recipes.values())
