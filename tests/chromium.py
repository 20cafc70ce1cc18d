"""Pages in headless Chromium: what a script measures in them, pictures, and print to PDF."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from tests.browser import Page
from tests.browser import page as tab

_POLICY = re.compile(r"<meta http-equiv=\"Content-Security-Policy\"[^>]*>")

MEASURE = Path(__file__).with_name("measure.js").read_text("utf-8")


@contextmanager
def shown(path: Path, width: int, height: int = 1000) -> Iterator[Page]:
    """A file in a tab of that size."""
    with tab() as page:
        page.size(width, height)
        page.open(path.as_uri())
        page.wait(f"document.readyState === 'complete' && location.pathname.endsWith({json.dumps(path.name)})")
        yield page


def evaluate(path: Path, script: str, width: int = 1400, *, policy: bool = True) -> Any:
    """What an expression gives in a page of that width, which must have a policy or must have none."""
    assert bool(_POLICY.search(path.read_text("utf-8"))) is policy
    with shown(path, width) as page:
        return page.evaluate(script.strip().rstrip(";"))


def printed(path: Path, room: Path) -> str:
    """The text of a page printed to PDF; skips where no program reads PDF."""
    if shutil.which("pdftotext") is None:
        pytest.skip("nothing reads the printed page: pdftotext is not installed")
    target = room / "print.pdf"
    with shown(path, 1400) as page:
        page.print(target)
    text = subprocess.run(["pdftotext", "-raw", str(target), "-"], capture_output=True, check=True).stdout
    return text.decode()


def picture(path: Path, target: Path, width: int, height: int) -> None:
    """A screenshot as PNG."""
    with shown(path, width, height) as page:
        page.picture(target)
