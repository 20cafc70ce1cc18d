"""Pages in a real browser: nothing stands outside, is clipped or leaves its cell; print loses nothing; script works."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest

from plcgen import api
from plcgen.base.display.view import PLAIN
from plcgen.report.registry import output_format
from tests.browser import page as browsed
from tests.chromium import MEASURE, evaluate, printed
from tests.projects import ROOT
from tests.report.review.reviews import faq_review, hostile_review, ppi_review, show

WIDTHS = (1400, 800, 480)


@pytest.fixture(params=["faq", "ppi", "hostile", "layout"])
def page(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """A page on disk."""
    target = tmp_path / "page.html"
    if request.param == "layout":
        found = api.layout(ROOT / "docs" / "pictures" / "conveyor.awl")
        format_ = output_format("html")
        assert format_ is not None
        text = format_.render("layout", found, PLAIN)
    else:
        made = {"faq": faq_review, "ppi": ppi_review, "hostile": partial(hostile_review, tmp_path)}
        text = show("html", made[request.param]())
    target.write_text(text, "utf-8")
    return target


@pytest.mark.slow
def test_nothing_is_outside_or_clipped(page: Path) -> None:
    """At three widths, with every fold open."""
    opened = f"(document.querySelectorAll('details').forEach((one) => one.open = true), {MEASURE.strip().rstrip(';')})"
    assert {width: evaluate(page, opened, width) for width in WIDTHS} == {width: [] for width in WIDTHS}


@pytest.mark.slow
def test_print_has_what_is_signed(tmp_path: Path) -> None:
    """Hash of all files, every byte of the telegrams, every member of the requests, the write list, the runs."""
    review = faq_review()
    page = tmp_path / "page.html"
    page.write_text(show("html", review), "utf-8")
    text = re.sub(r"\s+", "", printed(page, tmp_path))
    wanted = [review.files_hash, review.spec_hash, "0301020110", "RFGramp-downtime1", "Reviewedby"]
    wanted += [field.name for one in review.sheet.exchanges for field in one.request.fields]
    assert [item for item in wanted if item not in text and item.lower() not in text.lower()] == []


@pytest.mark.slow
def test_print_loses_nothing_of_a_serial_line(tmp_path: Path) -> None:
    """The frames of the runs, the bytes of the tables and the write list of a PPI master are on the paper."""
    page = tmp_path / "page.html"
    page.write_text(show("html", ppi_review()), "utf-8")
    text = re.sub(r"\s+", "", printed(page, tmp_path))
    wanted = ["poll, station 0 to 2 (5C)", "10 02 00 5C 5E 16", "P_SND_RK", "fault silence"]
    wanted += ["startDelimiterRepeated", "switches the CPU to STOP", "PDU reference, new in every request"]
    assert [item for item in wanted if item.replace(" ", "") not in text] == []


@pytest.mark.slow
def test_print_loses_nothing_of_long_names(tmp_path: Path) -> None:
    """The last columns of the write list are on the paper although the names before them are long."""
    page = tmp_path / "page.html"
    page.write_text(show("html", hostile_review(tmp_path)), "utf-8")
    text = re.sub(r"\s+", "", printed(page, tmp_path))
    assert text.count("endsupin") == 1
    assert "</td>" in text
    assert text.count("power-off") == 2


@pytest.mark.slow
def test_the_script_filters_and_exports(tmp_path: Path) -> None:
    """The field hides rows without the text; the button writes boxes and comments as Markdown."""
    page = tmp_path / "page.html"
    page.write_text(show("html", faq_review()), "utf-8")
    script = """
    (() => {
      const search = document.querySelector(".search");
      search.value = "Subindex";
      search.dispatchEvent(new Event("input"));
      const rows = [...document.querySelectorAll("tbody tr:not(.hidden)")].map((row) => row.textContent.toLowerCase());
      search.value = "";
      search.dispatchEvent(new Event("input"));
      document.querySelector("input.box").checked = true;
      document.querySelector("#reviewer").textContent = "A. Reviewer";
      document.querySelector("#c-writes").textContent = "agreed";
      document.querySelector("#export").click();
      const only = rows.length > 0 && rows.every((row) => row.includes("subindex"));
      return [only, document.querySelectorAll(".hidden").length, document.querySelector("#exported").textContent];
    })()
    """
    only, hidden, text = evaluate(page, script)
    assert only
    assert hidden == 0
    assert "Reviewed by: A. Reviewer" in text
    assert "- [x] write_ramp_down: P50304 RFG ramp-down time 1 = 100.0 s" in text
    assert "## Write list\n\nagreed" in text


@pytest.mark.slow
def test_what_a_reviewer_says_survives_a_reload(tmp_path: Path) -> None:
    """A tick, the name and a comment are there again in the same page, and not in that of other files."""
    target, other = tmp_path / "page.html", tmp_path / "other.html"
    review = faq_review()
    target.write_text(show("html", review), "utf-8")
    other.write_text(show("html", replace(review, files_hash="0" * 64)), "utf-8")
    seen = "[document.querySelector('input.box').checked, document.querySelector('#reviewer').innerText]"
    with browsed() as page:
        page.open(target.as_uri())
        page.click("input.box")
        page.click("#reviewer")
        page.type("A. Meier")
        page.open(other.as_uri())
        page.wait("location.pathname.endsWith('other.html') && document.readyState === 'complete'")
        assert page.evaluate(seen) == [False, ""]
        page.open(target.as_uri())
        page.wait("location.pathname.endsWith('page.html') && document.readyState === 'complete'")
        assert page.evaluate(seen) == [True, "A. Meier"]
        assert page.problems == []
