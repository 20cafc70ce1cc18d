"""Pages in headless Chromium: what a script measures in them, pictures, and print to PDF."""

from __future__ import annotations

import html
import json
import os
import re
import shutil
import subprocess
from functools import cache
from pathlib import Path
from typing import Any

import pytest

NAMES = ("chromium", "chromium-browser", "google-chrome")
_POLICY = re.compile(r"<meta http-equiv=\"Content-Security-Policy\"[^>]*>")

MEASURE = Path(__file__).with_name("measure.js").read_text("utf-8")
_PROBE = """<script>window.addEventListener("load", () => {
  const out = document.createElement("output");
  out.id = "probe";
  out.textContent = JSON.stringify(SCRIPT);
  document.body.append(out);
});</script>"""


@cache
def chromium() -> str:
    """The program, or skip the test with the reason."""
    found = next(filter(None, map(shutil.which, NAMES)), None)
    if found is None:
        pytest.skip(f"no headless browser to look at pages with: {', '.join(NAMES)} are not installed")
    return found


def _run(room: Path, *arguments: str) -> bytes:
    """What the browser prints. On a loaded machine it hangs now and then when all is done: then it is asked again."""
    fixed = ["--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", f"--user-data-dir={room / 'user'}"]
    command = [chromium(), *fixed, *arguments]
    environment = {**os.environ, "HOME": str(room)}
    try:
        done = subprocess.run(command, capture_output=True, check=False, timeout=60, env=environment)
    except subprocess.TimeoutExpired as hung:
        if (hung.stdout or b"").rstrip().endswith(b"</html>"):
            return hung.stdout or b""
        shutil.rmtree(room / "user", ignore_errors=True)
        done = subprocess.run(command, capture_output=True, check=False, timeout=120, env=environment)
    assert done.returncode == 0, done.stderr.decode(errors="replace")[-2000:]
    return done.stdout


def evaluate(page: Path, room: Path, script: str, width: int = 1400, *, policy: bool = True) -> Any:
    """What an expression gives in a page of that width; the policy that the page must have is lifted for it alone."""
    text = page.read_text("utf-8")
    assert bool(_POLICY.search(text)) is policy
    probe = _PROBE.replace("SCRIPT", script.strip().rstrip(";")) + "</body>"
    copy = room / f"probe-{width}.html"
    copy.write_text(_POLICY.sub("", text).replace("</body>", probe), "utf-8")
    dom = _run(room, f"--window-size={width},1000", "--virtual-time-budget=3000", "--dump-dom", copy.as_uri()).decode()
    answer = re.search(r'<output id="probe">(.*?)</output>', dom, re.DOTALL)
    assert answer, dom[-2000:]
    return json.loads(html.unescape(answer[1]))


def printed(page: Path, room: Path) -> str:
    """The text of a page printed to PDF, without its white space; skips where no program reads PDF."""
    if shutil.which("pdftotext") is None:
        pytest.skip("nothing reads the printed page: pdftotext is not installed")
    target = room / "print.pdf"
    _run(room, "--no-pdf-header-footer", f"--print-to-pdf={target}", page.as_uri())
    text = subprocess.run(["pdftotext", "-raw", str(target), "-"], capture_output=True, check=True).stdout
    return text.decode()


def picture(page: Path, room: Path, target: Path, width: int, height: int) -> None:
    """A screenshot as PNG."""
    _run(room, f"--window-size={width},{height}", f"--screenshot={target}", page.as_uri())
