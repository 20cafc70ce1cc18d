"""Nine jobs of somebody who has not seen the page: from nothing to verified files, by what stands on it."""

from __future__ import annotations

import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

pytest.importorskip("uvicorn", reason="the extra serve is not installed")

from plcgen import api
from tests.browser import Page, page
from tests.workbench.serve.server import served

pytestmark = pytest.mark.slow


@dataclass(frozen=True)
class Task:
    """A spec to begin with, and what is done in the form: (job, words, parameter, + read or + write); a kind of job."""

    device: str
    family: str
    toolchain: str
    added: tuple[tuple[str, str, str, str], ...] = ()
    kind: str = ""
    every: str = ""
    seen: str = ""
    named: str = ""


TASKS = {
    "read the speed of a pump": Task(
        "sinamics-g120",
        "s7-1500",
        "tia-v19",
        (("read_actual_values", "motor temperature", "r35", "+ read"),),
        seen="r35",
    ),
    "set ramps from a panel": Task(
        "sinamics-g120", "s7-1200", "tia-v17", (("set_ramps", "OFF3 ramp", "P1135", "+ write"),), seen="P1135"
    ),
    "show the fault memory": Task("sinamics-s120", "s7-1500", "tia-v20", kind="messages", seen="faults"),
    "save to ROM": Task("sinamics-s120", "s7-1500", "tia-v19", kind="save", seen="save: drive_object"),
    "an MM440 on PROFIBUS": Task("micromaster-4", "s7-300", "step7-v5", seen="P1120"),
    "a DCM as in the FAQ": Task("sinamics-dcm", "s7-300", "tia-v16", seen="P50304"),
    "log an S7-200": Task(
        "ppi", "s7-1200", "tia-v19", kind="read", every="2s", seen="read: [VW100], cycle: 2s", named="tank"
    ),
    "a recipe": Task(
        "sinamics-s120", "s7-1200", "tia-v19", kind="write_recipe", seen="write_recipe: recipe1", named="winder"
    ),
    "a drive of another maker": Task("profidrive", "s7-1500", "tia-v18"),
}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """An empty folder."""
    (tmp_path / "machine").mkdir()
    return tmp_path / "machine"


@pytest.fixture
def browser(folder: Path) -> Iterator[Page]:
    """The page of it, which begins with a new spec."""
    with served(folder) as address, page() as found:
        found.size(1400)
        found.open(address)
        found.wait("!!document.querySelector('#dialog')?.open")
        yield found
        assert found.problems == []


def begin(browser: Page, device: str, family: str, toolchain: str, named: str = "") -> None:
    """The dialog for a new spec."""
    for name, value in (("device", device), ("family", family), ("toolchain", toolchain)):
        browser.fill(f"#dialog select[name={name}]", value)
    if named:
        browser.fill("#dialog input[name=key]", named)
    browser.click("#dialog button", "Create")
    browser.wait("!document.querySelector('#dialog')?.open")
    browser.wait("document.querySelectorAll('#jobs .row').length")


def finish(browser: Page) -> None:
    """Write the files, verify those on disk."""
    browser.wait("!document.querySelector('#problems .error') && !document.querySelector('#write').disabled")
    browser.evaluate("document.querySelector('#notices').replaceChildren()")
    browser.click("#write")
    browser.click("#write-now")
    browser.sees("#dialog", "written")
    browser.sees("#guide", "how to import")
    browser.click("#written-close")
    browser.click("#tab-verify")
    browser.fill("#verify-files", "disk")
    browser.fill("#effort", "none")
    browser.click("#verify-start")
    browser.wait("document.querySelector('#verify-cancel').disabled", "it has ended")
    browser.sees("#verified .verdict", "\u2713 ok")


@pytest.mark.parametrize("name", TASKS)
def test_a_job_is_done_through_the_page_alone(name: str, browser: Page, folder: Path) -> None:
    """A new spec, the form, files that are written and verified; what was wanted is in them."""
    task = TASKS[name]
    begin(browser, task.device, task.family, task.toolchain, task.named)
    for job, words, parameter, button in task.added:
        browser.fill("#target", f"jobs/{job}")
        browser.fill("#search", words)
        browser.sees("#results .hit", parameter)
        row = (
            f"""[...document.querySelectorAll("#results .hit")].find((one) => one.innerText.includes("{parameter} "))"""
        )
        browser.evaluate(f"[...{row}.querySelectorAll('button')].find((one) => one.innerText === '{button}').click()")
        browser.wait("!document.querySelector('#problems .error')")
    if task.kind:
        browser.click(".adding summary", "Add job")
        if task.every:
            browser.fill("#job-start", "cycle")
            browser.fill("#job-when", task.every)
        browser.click(f"#job-kinds label:has([value={task.kind}]:enabled)")
        browser.click("#jobs .adding button", "Create")
        browser.sees("#jobs .row", "job1")
    finish(browser)
    spec = folder / "job.yaml"
    checked = api.generate(spec, check_only=True)
    assert (checked.ok, checked.diff) == (True, "")
    browser.click("#tab-becomes")
    browser.click(".views button", "Telegrams")
    browser.wait("document.querySelectorAll('.byte').length")
    for seen in (task.seen, task.named):
        assert seen in spec.read_text("utf-8")


def test_a_change_is_compared_with_the_revision_before(browser: Page, folder: Path) -> None:
    """The ninth: a value is edited, and the review says what changed since the last commit."""
    begin(browser, "sinamics-g120", "s7-1500", "tia-v19")
    finish(browser)
    for command in (["init", "-q"], ["add", "."], ["commit", "-qm", "before"]):
        subprocess.run(["git", "-c", "user.name=A", "-c", "user.email=a@example.org", *command], cwd=folder, check=True)
    browser.click("#tab-spec")
    browser.fill("#target", "jobs/set_ramps")
    browser.fill("#search", "P1135")
    browser.click("#results .hit button", "+ write")
    finish(browser)
    browser.click("#tab-review")
    browser.fill("#base", "HEAD")
    browser.click("#review-start")
    browser.wait("!!document.querySelector('#review iframe')")
    page_text = browser.evaluate("fetch(document.querySelector('#review iframe').src).then((answer) => answer.text())")
    assert "P1135" in page_text
    assert "nothing to compare with" not in page_text
