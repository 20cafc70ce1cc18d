"""The form beside the editor, in a real browser: what is added, renamed, removed, refused; in German, too."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

pytest.importorskip("uvicorn", reason="the extra serve is not installed")

from tests.browser import Page, page
from tests.projects import ROOT
from tests.workbench.serve.server import served
from tests.workbench.serve.test_page import needs_editor, text
from tests.workbench.serve.test_words import ENGLISH, GERMAN

pytestmark = [pytest.mark.slow, needs_editor]
PLANT = """\
plc: {name: Press, family: s7-1200, toolchain: tia-v19}
drives:
  axis: {device: sinamics-s120, hardware_id: 270, drive_object: 3}
  twin: {device: sinamics-s120, hardware_id: 271, drive_object: 3}
  maker: {device: profidrive, hardware_id: 272}
recipes:
  glue: {parameters: [P1120], records: {thin: {P1120: 1.0}, thick: {P1120: 2.0}}}
jobs:
  ramps: {drive: axis, write: {P1120: 5.0, P1121: }}
  speed: {drive: axis, read: [r21]}
  dose: {drive: [axis, twin], write_recipe: glue}
"""


@pytest.fixture
def browser(tmp_path: Path) -> Iterator[Page]:
    """The page open at a plant; nothing has gone wrong in the browser at the end but what the server refused."""
    (tmp_path / "press").mkdir()
    (tmp_path / "press" / "plant.yaml").write_text(PLANT, "utf-8")
    shutil.copy(ROOT / "specs" / "s7-1200_s7-200_ppi.yaml", tmp_path / "press" / "wells.yaml")
    with served(tmp_path / "press") as address, page() as found:
        found.size(1400)
        found.open(address)
        found.wait("document.body?.dataset.ready === 'true'")
        found.wait("document.querySelectorAll('#jobs .entry').length === 3")
        yield found
        assert [one for one in found.problems if "422" not in one] == []


def test_jobs_drives_and_parameters_are_renamed_and_removed(browser: Page) -> None:
    """By the buttons of their rows; what is still used is refused in German, with the jobs that use it."""
    browser.evaluate("document.querySelector('#language').click()")
    browser.wait("document.querySelectorAll('#jobs .entry').length === 3")
    browser.fill("#target", "jobs/ramps")
    browser.click("#has button[aria-label='Entfernen: P1121']")
    browser.wait(
        "[...document.querySelectorAll('.cm-line')].some((one) => one.textContent.includes('write: {P1120: 5.0}}'))"
    )
    browser.click("button[aria-label='Umbenennen: speed']")
    browser.fill("#new-name", "watch")
    browser.click("#dialog button.main")
    browser.sees("#jobs", "watch")
    browser.click("button[aria-label='Entfernen: watch']")
    browser.wait("document.querySelectorAll('#jobs .entry').length === 2")
    browser.click("button[aria-label='Entfernen: axis']")
    browser.sees("#notices", '"axis" wird verwendet von "ramps, dose"')
    browser.click("button[aria-label='Entfernen: maker']")
    browser.wait("!document.querySelector('#drives').innerText.includes('maker')")
    expected = PLANT.replace(", P1121: ", "").replace("  speed: {drive: axis, read: [r21]}\n", "")
    assert text(browser).rstrip() == expected.replace("  maker: {device: profidrive, hardware_id: 272}\n", "").rstrip()


def test_a_job_says_what_it_needs_before_it_is_added(browser: Page) -> None:
    """Kinds are a list with sentences and no YAML; a foreign drive asks for number, type and unit at once, and what is
    wrong with them stands in the form, not over the problems; several drives are one job.
    """
    browser.click(".adding summary", "Add job")
    browser.wait("document.querySelectorAll('#job-kinds label').length > 12")
    said = browser.evaluate(
        "[...document.querySelectorAll('#job-kinds label:not(.off) small')].map((one) => one.innerText)"
    )
    assert all(not set(one) & set("{}:") for one in said), said
    assert "saving to ROM is a job of its own" in browser.text("#job-kinds")
    browser.fill("#job-partner", "drive:maker")
    browser.wait("document.querySelector('#job-kinds .off [value=restore]')?.disabled === true")
    browser.click("#job-kinds label:has([value=write])")
    browser.wait("!document.querySelector('#job-type').parentElement.hidden")
    browser.click("#jobs .adding button.main")
    browser.sees("#jobs .adding form .bad", "no parameter for such a job")
    assert browser.text("#notices") == ""
    browser.fill("#job-parameter", "P101")
    browser.fill("#job-type", "Unsigned16")
    browser.click("#jobs .adding button.main")
    browser.sees("#jobs", "job1")
    assert "job1: {drive: maker, write: {P101: }}" in text(browser)
    assert "parameters: {P101: {type: Unsigned16}}" in text(browser)
    browser.click(".adding summary", "Add job")
    browser.wait("document.querySelectorAll('#job-kinds label').length > 12")
    browser.evaluate("""(() => {
      const partner = document.querySelector('#job-partner');
      for (const one of partner.options) one.selected = /axis|twin/.test(one.value);
      partner.dispatchEvent(new Event("change"));
    })()""")
    browser.click("#job-kinds label:has([value=compare])")
    browser.click("#jobs .adding button.main")
    browser.sees("#jobs", "job2")
    assert "job2: {drive: [axis, twin], compare: {P1120: }}" in text(browser)


def test_buttons_are_those_that_the_job_takes(browser: Page) -> None:
    """A job that reads has no button to write; a recipe has one, and asks for the value of its records."""
    browser.fill("#target", "jobs/speed")
    browser.fill("#search", "P1121")
    browser.sees("#results .hit button", "+ read")
    assert "+ write" not in browser.text("#results")
    browser.fill("#target", "recipes/glue")
    browser.sees("#results .hit button", "+ add")
    browser.click("#results .hit button")
    browser.sees("#notices", "every record needs a value")
    browser.fill("#record-value", "4.0")
    browser.click("#results .hit button")
    browser.wait("[...document.querySelectorAll('.cm-line')].some((one) => one.textContent.includes('[P1120, P1121]'))")
    assert "{thin: {P1120: 1.0, P1121: 4.0}, thick: {P1120: 2.0, P1121: 4.0}}" in text(browser)


def test_a_new_spec_is_refused_in_the_dialog(browser: Page) -> None:
    """In the language of the page: no hint of the browser's own, nothing behind the dialog."""
    browser.evaluate("document.querySelector('#language').click()")
    browser.click("#new")
    for name, value, reason in (
        ("name", "zwei", '"zwei" ist keine Spec'),
        ("name", "plant.yaml", "Die Datei gibt es schon"),
        ("drive_object", "abc", '"abc" ist keine Zahl'),
    ):
        browser.fill("#dialog input[name=name]", "zwei.yaml")
        browser.fill(f"#dialog input[name={name}]", value)
        browser.click("#dialog button.main")
        browser.sees("#dialog .bad", reason)
    assert browser.text("#notices") == ""


def test_german_is_german_and_keeps_what_runs(browser: Page) -> None:
    """On every tab no label is left in English; the program that was loaded is still there, at its scan."""
    browser.click("#tab-run")
    browser.click("#load")
    browser.wait("!!document.querySelector('[data-job=ramps]')")
    browser.click("#ten")
    browser.sees("#scan", "scan 10,")
    browser.evaluate("document.querySelector('#language').click()")
    browser.sees("#scan", "Zyklus 10,")
    assert browser.evaluate("!document.querySelector('#step').disabled")
    english = {one for key, one in ENGLISH.items() if one and GERMAN[key] != one} - set(GERMAN.values())
    for tab in ("spec", "becomes", "run", "verify", "review", "tools"):
        browser.click(f"#tab-{tab}")
        shown = browser.evaluate("""[...document.querySelectorAll("button, label span, h3, th, summary, .empty, small")]
          .filter((one) => one.getClientRects().length).map((one) => one.innerText.trim())""")
        assert not english & set(shown), tab
    browser.click("#tab-run")
    browser.click("#step")
    browser.sees("#scan", "Zyklus 11,")
