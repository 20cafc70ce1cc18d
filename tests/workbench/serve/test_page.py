"""The page in a real browser, a test for every tab: what a user does, and what he then sees."""

from __future__ import annotations

import http.server
import json
import shutil
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest

pytest.importorskip("uvicorn", reason="the extra serve is not installed")

from plcgen.workbench.serve.page import has_editor
from tests.browser import Page, page
from tests.projects import ROOT
from tests.workbench.serve.server import served

FAQ, PUMP = "s7-300_6ra80_dp_tia.yaml", "s7-1500_g120_pn.yaml"
pytestmark = pytest.mark.slow


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with two shipped specs."""
    made = tmp_path / "machines"
    made.mkdir()
    for name in (FAQ, PUMP):
        shutil.copy(ROOT / "specs" / name, made)
    return made


@pytest.fixture
def address(folder: Path) -> Iterator[str]:
    """The page of the folder, served."""
    with served(folder) as found:
        yield found


@pytest.fixture
def browser(address: str) -> Iterator[Page]:
    """The page open at the pump's spec; nothing may have gone wrong in the browser at the end."""
    with page() as found:
        found.size(1400)
        found.open(address)
        found.wait("document.body?.dataset.ready === 'true'")
        found.fill("#file", PUMP)
        found.wait(f"document.title.startsWith('{PUMP}')")
        found.sees("#problems", "PG227")
        yield found
        assert found.problems == []


def text(browser: Page) -> str:
    """What stands in the editor."""
    return str(browser.evaluate("[...document.querySelectorAll('.cm-line')].map((one) => one.textContent).join('\\n')"))


needs_editor = pytest.mark.skipif(not has_editor(), reason="the editor is not bundled: make editor")


@needs_editor
def test_a_sign_off_has_its_reason_at_once(browser: Page) -> None:
    """Its button asks why and writes key and reason together; nothing is written while nobody gives one."""
    browser.click(".cm-line", "jobs:")
    browser.press("End")
    drive = browser.evaluate("document.querySelector('#drives b').textContent")
    browser.type(f"\n  save_all: {{drive: {drive}, write: {{P971: 1}}}}")
    browser.sees("#problems .error", "PG219")
    browser.evaluate("window.prompt = () => null, 1")
    browser.click("#problems .fix", "add allow: {P971: }")
    assert "allow:" not in text(browser)
    browser.evaluate("window.prompt = () => 'once, at commissioning: \"ok\"', 1")
    browser.click("#problems .fix", "add allow: {P971: }")
    browser.wait("!document.querySelector('#problems .error')")
    assert 'allow: {P971: "once, at commissioning: \\"ok\\""}' in text(browser)


@needs_editor
def test_a_mistake_is_seen_explained_and_corrected(browser: Page) -> None:
    """Typed in the editor: a mark and a problem; its button puts the word right; Ctrl+Z takes that back."""
    browser.click(".cm-line", "drives:")
    browser.press("End")
    browser.type("\n  fan: {devce: sinamics-g120, hardware_id: 271}")
    browser.sees("#problems .error", 'unknown key "devce"')
    browser.wait("!!document.querySelector('.cm-lintRange-error')")
    browser.click("#problems .fix", 'replace it with "device"')
    browser.wait("!document.querySelector('#problems .error')")
    assert "fan: {device: sinamics-g120" in text(browser)
    browser.click(".cm-line", "fan:")
    browser.press("z", "Control")
    browser.sees("#problems .error", "devce")


@needs_editor
def test_completion_and_hover(browser: Page) -> None:
    """Parameters of this drive with their titles; a word that is pointed at is explained."""
    browser.click(".cm-line", "read: [actual_speed]")
    browser.press("End")
    browser.press("ArrowLeft")
    browser.type(", P112")
    browser.sees(".cm-tooltip-autocomplete", "P1120")
    browser.press("Escape")
    browser.point(".cm-line span", "P1120")
    browser.sees(".card", "ramp-up")


@needs_editor
def test_a_drive_is_renamed_wherever_it_is_named(browser: Page) -> None:
    """F2 on its key: all jobs follow, and the spec stays without errors."""
    browser.click(".cm-line", "  pump:")
    browser.press("Home")
    browser.press("F2")
    browser.fill("#new-name", "feeder")
    browser.press("Enter")
    browser.wait("!document.querySelector('#dialog').open")
    assert text(browser).count("drive: feeder") == 3
    assert "drive: pump" not in text(browser)
    browser.sees("#jobs", "feeder")
    assert browser.evaluate("document.querySelector('#problems .error')") is None


@needs_editor
def test_the_form_and_the_text_are_one(browser: Page, folder: Path) -> None:
    """A parameter found by words is added with a click; saved, all other lines of the file are as they were."""
    before = (folder / PUMP).read_text("utf-8")
    browser.fill("#target", "jobs/read_speed")
    browser.fill("#search", "torque")
    browser.sees("#results .hit", "r31")
    browser.click("#results .hit:has(b) button", "+ read")
    browser.wait("[...document.querySelectorAll('.cm-line')].some((one) => /actual_speed, /.test(one.textContent))")
    browser.press("s", "Control")
    browser.sees("#state", "saved")
    browser.wait("document.querySelector('#save').disabled")
    after = (folder / PUMP).read_text("utf-8")
    changed = [(old, new) for old, new in zip(before.splitlines(), after.splitlines(), strict=True) if old != new]
    ((old, new),) = changed
    assert new.startswith(old.rstrip("]") + ", ")


def test_bytes_members_and_lines_are_marked_together(browser: Page) -> None:
    """The number of P1120 (0460h): its bytes, its row with the address, its line in the source."""
    browser.click("#tab-becomes")
    browser.sees("#side", "set_ramps")
    browser.point(".message tr[data-offset]", "04 60")
    browser.wait("document.querySelectorAll('.message .byte.marked').length === 2")
    marked = browser.evaluate("[...document.querySelectorAll('.byte.marked')].map((one) => one.innerText)")
    assert marked == ["04", "60"]
    browser.wait("document.querySelectorAll('.line.marked').length >= 1")


def test_files_are_written_when_it_is_confirmed(browser: Page, folder: Path) -> None:
    """Cancel writes nothing; then everything is there, and the list says so."""
    made = folder / "s7-1500_g120_pn_generated"
    browser.click("#tab-becomes")
    browser.click(".views button", "Files")
    browser.sees("#side .new", ".scl")
    browser.click("#write")
    browser.click("#dialog button", "Cancel")
    assert not made.exists()
    browser.click("#write")
    browser.sees("#dialog", str(made))
    browser.click("#write-now")
    browser.sees("#written-path", str(made))
    browser.sees("#guide li", "Add new external file")
    browser.click("#written-close")
    assert (made / "manifest.json").is_file()
    browser.wait("document.querySelectorAll('#side .file').length && !document.querySelector('#side .new')")
    browser.click(".views button", "Work list")
    browser.sees("#body", "P1120")


def test_a_run_is_watched_and_changed(browser: Page) -> None:
    """Execute by a click, ten scans at a time until done; a telegram is taken apart; a drive value is set."""
    browser.click("#tab-run")
    browser.click("#load")
    browser.click('[data-job="set_ramps"]')
    for _ in range(6):
        browser.click("#ten")
    browser.sees("#run-jobs", "done 0000")
    browser.click("#wire .row", "change P1120")
    browser.sees("#decoded", "parameter 1 parameter number")
    browser.fill("#run-jobs [aria-label=rampUpTime]", "2.5")
    browser.fill("#partners input[aria-label='pump.r21']", "77x")
    browser.sees("#partners .wrong", "not '77x'")
    browser.sees("#partners .wrong", "rpm")
    assert len(browser.problems) == 1  # the refusal, as the browser logs it
    browser.problems.clear()
    browser.fill("#partners input[aria-label='pump.r21']", "777.0")
    browser.wait("!document.querySelector('#partners .wrong')")
    browser.click('[data-job="read_speed"]')
    browser.click("#run")
    browser.sees("#wire", "777.0")
    browser.click("#run", "Pause")
    scan = browser.text("#scan")
    browser.wait(f"document.querySelector('#run').innerText === 'Run' && {json.dumps(scan)} !== ''")
    browser.fill("#fault-kind", "error")
    browser.evaluate("document.querySelectorAll('.fault-keys input')[0].value = '16#11'")
    for _ in range(2):
        browser.click("#inject")
        browser.sees("#struck", "error: ")
    browser.wait("document.querySelectorAll('#struck .row').length === 2")
    browser.click("#struck button")
    browser.wait("document.querySelectorAll('#struck .row').length === 1")
    browser.click("#language")
    browser.sees("#run", "Starten")
    browser.sees("#struck", "noch so oft: 1")
    browser.sees("#wire", "777.0")
    browser.click("#language")
    browser.sees("#run", "Run")
    browser.click('[data-job="set_ramps"]')  # off, then on again: with the ramp that was typed
    browser.wait("document.querySelector('[data-job=set_ramps]').getAttribute('aria-pressed') === 'false'")
    browser.click('[data-job="set_ramps"]')
    for _ in range(6):
        browser.click("#ten")
    browser.sees("#run-jobs", "error 8401")
    browser.sees("#wire", "P1120 := 2.5")


def test_verification_ends_with_a_verdict(browser: Page) -> None:
    """Progress, then every check by group."""
    browser.click("#tab-verify")
    browser.fill("#effort", "none")
    browser.click("#verify-start")
    browser.sees("#verified .verdict", "ok")
    browser.sees("#verified", "run set_ramps")


def test_a_failed_check_opens_its_run(browser: Page, folder: Path) -> None:
    """A source that was changed by hand: the run is drawn, with the scan in which it failed."""
    browser.click("#write")
    browser.click("#write-now")
    browser.click("#written-close")
    (source,) = (folder / "s7-1500_g120_pn_generated").glob("*.scl")
    right = source.read_text("utf-8")
    broken = right.replace("#done := #tempResult = #STATUS_DONE;", "#done := FALSE;")
    assert broken != source.read_text("utf-8")
    source.write_text(broken, "utf-8")
    browser.click("#tab-verify")
    browser.fill("#verify-files", "disk")
    browser.fill("#effort", "none")
    browser.click("#verify-start")
    browser.sees("#verified .verdict", "\u2717")
    browser.click(".open-run", "Open run")
    browser.sees(".replay", "scan ")
    browser.wait("!!document.querySelector('.replay canvas')")
    browser.click("#language")
    browser.sees("#verified .verdict", "fehlgeschlagen")
    browser.click("#language")
    line = next(number for number, one in enumerate(right.splitlines(), 1) if "#done := #tempResult" in one)
    browser.click(".open-line", "difference")
    browser.sees(".code .minus", "#done := FALSE;")
    assert browser.evaluate("document.querySelector('#side [aria-pressed=true]').dataset.key") == source.name
    browser.click("#tab-verify")
    browser.click(".open-line", "Open line")
    browser.wait("!!document.querySelector('.code .marked')")
    assert int(browser.text(".code .marked i")) == line


def test_two_versions_are_compared_in_tables(browser: Page) -> None:
    """A member that moved: what it means, then every change by block; no words of a shell."""
    source = "DATA_BLOCK DB1\nSTRUCT\n{}n : INT;\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n"
    for where, more in (("old", ""), ("files", "m : INT;\n")):
        browser.evaluate(f"""(() => {{
          const data = new DataTransfer();
          data.items.add(new File([{json.dumps(source.format(more))}], "a.scl"));
          const drop = new DragEvent("drop", {{ dataTransfer: data, bubbles: true }});
          document.querySelector('[data-drop="{where}"]').dispatchEvent(drop);
        }})()""")
    browser.click("#tab-tools")
    browser.wait("!!document.querySelector('#tool-result iframe')")
    browser.click("#do-diff")
    browser.sees("#tool-result .changes td", "n: moved by +2 bytes: 0.0 -> 2.0")
    browser.sees("#tool-result .changes summary", "DB1")
    assert "--" not in browser.text("#tool-result")


def test_the_review_page_is_shown(browser: Page) -> None:
    """In a frame without a way to this page."""
    browser.click("#tab-review")
    browser.click("#review-start")
    browser.wait("!!document.querySelector('#review iframe')")
    assert browser.evaluate("document.querySelector('#review iframe').contentDocument") is None


def test_what_is_dropped_is_laid_out_and_what_is_pasted_explained(browser: Page) -> None:
    """A data block dropped onto any tab is laid out; a telegram in a file or as text, a STATUS, are explained."""
    source = (ROOT / "docs" / "pictures" / "conveyor.awl").read_text("utf-8")
    browser.evaluate(f"""(() => {{
      const data = new DataTransfer();
      data.items.add(new File([{json.dumps(source)}], "conveyor.awl"));
      document.querySelector("#editor").dispatchEvent(new DragEvent("drop", {{ dataTransfer: data, bubbles: true }}));
    }})()""")
    browser.sees("#dropped", "conveyor.awl")
    browser.wait("!!document.querySelector('#tool-result iframe')")
    browser.click("#dropped button", "Clear")
    for put in ("items.add(new File(['03 01 02 01 10 01 C4 7F 00 00'], 'a.txt'))", "setData('text/plain', 'DF80B500')"):
        browser.evaluate(f"""(() => {{
          const data = new DataTransfer();
          data.{put};
          document.querySelector("nav").dispatchEvent(new DragEvent("drop", {{ dataTransfer: data, bubbles: true }}));
        }})()""")
        browser.sees("#tool-result", "50303" if "File" in put else "state conflict")
    browser.fill("#paste", "03 01 02 01 10 01 C4 7F 00 00\nDF80B500")
    browser.click("#do-explain")
    browser.sees("#tool-result", "50303")
    browser.sees("#tool-result", "state conflict")


def test_labels_and_colours_change(browser: Page) -> None:
    """German and back, dark and back; the text stays."""
    before = text(browser)
    browser.click("#language")
    browser.sees("#tab-verify", "Prüfen")
    browser.click("#tab-run")
    browser.click("#load")
    browser.sees("#run-jobs", "set_ramps")
    browser.click("#theme")
    assert browser.evaluate("document.documentElement.dataset.theme") == "dark"
    drawn = "[...document.querySelector('.lanes canvas').getContext('2d').getImageData(400, 4, 1, 1).data].slice(0, 3)"
    browser.wait(f"({drawn}).join() === '31,36,40'", "--paper of the dark page: 1f2428")
    browser.click("#language")
    browser.sees("#tab-verify", "Verify")
    assert text(browser) == before


@needs_editor
def test_one_history_for_the_editor_and_the_form(browser: Page) -> None:
    """A parameter from the form, a word typed: each goes and comes back by its key, wherever the focus is."""
    before = text(browser)
    browser.fill("#target", "jobs/read_speed")
    browser.fill("#search", "torque")
    browser.click("#results .hit:has(b) button", "+ read")
    browser.wait("[...document.querySelectorAll('.cm-line')].some((one) => /actual_speed, /.test(one.textContent))")
    added = text(browser)
    browser.press("z", "Control")  # the focus is on the button of the form
    browser.wait("[...document.querySelectorAll('.cm-line')].every((one) => !/actual_speed, /.test(one.textContent))")
    assert text(browser) == before
    browser.press("y", "Control")
    browser.wait("[...document.querySelectorAll('.cm-line')].some((one) => /actual_speed, /.test(one.textContent))")
    browser.click(".cm-line", "jobs:")
    browser.press("End")
    browser.type(" # typed")
    browser.click("#undo")
    browser.click("#undo")
    assert text(browser) == before
    browser.click("#redo")
    assert text(browser) == added


def test_what_is_shown_of_one_spec_goes_with_it(browser: Page) -> None:
    """Another spec is opened: Run, Verify and Review are empty, and say what to do."""
    browser.click("#tab-run")
    browser.click("#load")
    browser.sees("#run-jobs", "set_ramps")
    browser.click("#tab-verify")
    browser.fill("#effort", "none")
    browser.click("#verify-start")
    browser.sees("#left-out", "not run")
    browser.click("#tab-review")
    browser.click("#review-start")
    browser.wait("!!document.querySelector('#review iframe')")
    browser.fill("#file", FAQ)
    browser.wait(f"document.title.startsWith('{FAQ}')")
    browser.wait("!document.querySelector('#review iframe')")
    assert browser.evaluate("document.querySelector('#verified').innerText").startswith("Verification ")
    assert browser.evaluate("document.querySelector('#run-jobs').children.length") == 0
    assert browser.evaluate("document.querySelector('#step').disabled")
    browser.click("#tab-run")
    browser.sees("#wire", "Load the program")


@needs_editor
def test_a_new_job_is_the_one_that_parameters_go_into(browser: Page) -> None:
    """Added in the form, it is selected; the next parameter is its own; what a drive lacks cannot be chosen."""
    browser.fill("#target", "jobs/set_ramps")
    browser.click(".adding summary", "Add job")
    browser.sees("#job-kinds .off", "control unit")
    assert browser.evaluate("document.querySelector('#job-kinds [value=clock]').disabled")
    browser.click("#jobs .adding button", "Create")
    browser.sees("#jobs .row", "job1")
    browser.wait("document.querySelector('#target').value === 'jobs/job1'")
    browser.fill("#search", "torque")
    browser.click("#results .hit:has(b) button", "+ read")
    browser.wait(
        "[...document.querySelectorAll('.cm-line')].some((one) => /job1: .*[rP]\\d+, r31/.test(one.textContent))"
    )


@needs_editor
def test_a_job_is_repeated_and_reads_what_the_catalogue_lacks(browser: Page) -> None:
    """Every two seconds; a number that nobody knows is put in with its type; both stand in the text, without errors."""
    browser.fill("#target", "jobs/read_speed")
    browser.fill("#cycle", "2s")
    browser.click("#set-cycle")
    browser.wait("[...document.querySelectorAll('.cm-line')].some((one) => one.textContent === '    cycle: 2s')")
    browser.fill("#search", "P31999")
    browser.sees("#results", "P31999 is unknown")
    browser.click("#results .hit button", "+ read")
    browser.wait(
        "[...document.querySelectorAll('.cm-line')].some((one) => /actual_speed, P31999/.test(one.textContent))"
    )
    assert "P31999: {type: FloatingPoint}" in text(browser)
    browser.sees("#problems", "PG")
    assert browser.evaluate("document.querySelector('#problems .error')") is None


def test_notices_go_on_their_own(browser: Page) -> None:
    """A note after 6 s, an error, which is read more slowly, after 15 s; or when they are closed."""
    found = browser.evaluate("""(async () => {
      const { tell } = await import(new URL("page/ask.js", location.href));
      const set = window.setTimeout, timers = [];
      window.setTimeout = (call, milliseconds) => { timers.push([milliseconds, call]); return 0; };
      tell("a note");
      tell("an error", "error", "what helps");
      window.setTimeout = set;
      const shown = () => [...document.querySelectorAll(".notice")].map((one) => one.innerText.split("\\n")[0]);
      const steps = [shown()];
      for (const [, call] of timers) { call(); steps.push(shown()); }
      return [timers.map(([milliseconds]) => milliseconds), steps];
    })()""")
    assert found == [[6000, 15000], [["a note", "an error"], ["an error"], []]]


def test_panel_texts_and_lock_are_there(browser: Page, folder: Path) -> None:
    """Names with addresses; text lists come as an archive; a lock is written when it is confirmed, and compared."""
    browser.click("#tab-becomes")
    browser.click(".views button", "Panel")
    browser.sees("#body td", "%DB472.DBD4")
    browser.evaluate(
        "window.seen = []; URL.createObjectURL = (blob) => { window.seen.push(blob.type); return 'data:,'; }"
    )
    browser.click("#get-texts")
    browser.wait("window.seen[0] === 'application/zip'")
    browser.evaluate("window.confirm = () => true")
    browser.click(".views button", "Lock")
    browser.sees("#lock-state", "no lock")
    browser.click("#relock")
    browser.sees("#lock-state", "Nothing has moved")
    assert (folder / "plcgen.lock.json").is_file()


@pytest.mark.parametrize("width", [1400, 1100, 800])
def test_every_tab_fits(browser: Page, width: int) -> None:
    """No tab is wider than the window, and no control stands outside it."""
    browser.size(width)
    for key in ("spec", "becomes", "run", "verify", "review", "tools"):
        browser.click(f"#tab-{key}")
        outside = browser.evaluate("""[...document.querySelectorAll("button, select, input, h3")].filter((one) => {
          const box = one.getBoundingClientRect();
          return box.width && !one.closest(".grid, table, .cm-editor") && (box.right > innerWidth + 1 || box.left < -1);
        }).map((one) => one.outerHTML.slice(0, 80))""")
        assert (key, outside) == (key, [])
        assert browser.evaluate("document.documentElement.scrollWidth") <= width


def test_without_a_bundle_there_is_a_text_field(browser: Page) -> None:
    """It has the same face: text, edits by place, changes told."""
    found = browser.evaluate("""(async () => {
      const { makeEditor } = await import(new URL("page/editor.js", location.href));
      const room = document.createElement("div");
      document.body.append(room);
      let told = 0;
      const made = await makeEditor(room, { changed() { told += 1; } }, false);
      made.open("a: 1\\nb: 2\\n");
      made.apply([{ place: [1, 0, 1, 1], text: "c" }]);
      room.remove();
      return [made.text, told];
    })()""")
    assert found == ["a: 1\nc: 2\n", 1]


def test_a_page_of_another_site_reaches_nothing(address: str, folder: Path, tmp_path: Path) -> None:
    """Served from another origin, with the address known: it can neither read nor frame nor save."""
    script = f"""
      const address = {json.dumps(address)};
      const post = (question, more) => fetch(address + "ask/" + question, {{ method: "POST", ...more }});
      const tries = {{
        read: () => post("folder", {{ headers: {{ "Content-Type": "application/json" }}, body: "{{}}" }}),
        save: () => post("save", {{ mode: "no-cors", body: '{{"name": "x.yaml", "text": "x", "known": ""}}' }}),
        page: () => fetch(address),
        script: () => import(address + "page/app.js"),
      }};
      window.found = (async () => {{
        const results = {{}};
        for (const [name, go] of Object.entries(tries)) {{
          results[name] = await go().then((answer) => answer.type ?? "loaded", () => "refused");
        }}
        const frame = document.createElement("iframe");
        frame.src = address;
        document.body.append(frame);
        await new Promise((wake) => {{ frame.onload = wake; setTimeout(wake, 3000); }});
        let inside = "";
        try {{ inside = frame.contentDocument?.body?.innerText ?? ""; }} catch {{ inside = ""; }}
        return {{ ...results, inside }};
      }})();
    """
    site = tmp_path / "site"
    site.mkdir()
    (site / "index.html").write_text(f"<!doctype html><body><script>{script}</script></body>", "utf-8")

    class Quiet(http.server.SimpleHTTPRequestHandler):
        def log_message(self, *_: object) -> None:
            """Nothing is said."""

        def __init__(self, *given: object) -> None:
            super().__init__(*given, directory=str(site))

    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), Quiet) as other, page() as found:
        threading.Thread(target=other.serve_forever, daemon=True).start()
        found.open(f"http://127.0.0.1:{other.server_address[1]}/index.html")
        found.wait("window.found !== undefined")
        results = found.evaluate("window.found")
        other.shutdown()
    assert results == {"read": "refused", "save": "refused", "page": "refused", "script": "refused", "inside": ""}
    assert not (folder / "x.yaml").exists()
