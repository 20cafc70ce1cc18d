"""Tables of the docs that must name everything there is."""

from __future__ import annotations

import re

from docs.pages import ROOT


def test_the_page_of_the_soft_cpu_names_every_code() -> None:
    """docs/soft-cpu.md has a row for every code that the soft CPU reports."""
    sources = " ".join(path.read_text("utf-8") for path in (ROOT / "plcgen" / "cpu").rglob("*.py"))
    page = (ROOT / "docs" / "soft-cpu.md").read_text("utf-8")
    assert set(re.findall(r'"(PG8[23]\d)"', sources)) == set(re.findall(r"^\| (PG8[23]\d) ", page, re.MULTILINE))
