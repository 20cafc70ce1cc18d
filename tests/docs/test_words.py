"""Reference pages are for looking something up: what is proof, or for those who work on plcgen, is elsewhere."""

from __future__ import annotations

import re

from tests.docs.pages import ROOT

LIMIT = 45_000
APART = {
    "tables made by programs": {"options", "exit-codes", "instructions"},
    "what was measured and looked up": {"evidence"},
    "for those who work on plcgen": {"CONTRIBUTING", "architecture", "releasing", "testing"},
}
_HIDDEN = re.compile(r"<!--.*?-->", re.DOTALL)


def test_reference_pages_are_short() -> None:
    """All of them together have at most 45,000 words, code and tables included, the comments that run them not."""
    apart = {name for names in APART.values() for name in names}
    pages = {page.stem: page.read_text("utf-8") for page in (ROOT / "docs").glob("*.md")}
    assert apart <= pages.keys()
    words = {name: len(_HIDDEN.sub("", text).split()) for name, text in pages.items() if name not in apart}
    longest = sorted(words.items(), key=lambda one: -one[1])[:5]
    assert sum(words.values()) <= LIMIT, f"shorten a page before you add to one; the longest are {longest}"
