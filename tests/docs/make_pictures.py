"""Makes the screenshots in docs/pictures: review pages of the FAQ's example and of a large plant; the workbench."""

from __future__ import annotations

import re
import shutil
import sys
import tempfile
from pathlib import Path

from plcgen import api
from plcgen.base.display.view import PLAIN
from plcgen.report.registry import output_format
from tests.browser import NAMES
from tests.chromium import picture
from tests.projects import ROOT

PICTURES = {
    "review_faq.png": ("s7-300_6ra80_dp_tia", 1400, 3000),
    "review_plant.png": ("s7-300_plant_v5", 1400, 3000),
    "review_phone.png": ("s7-300_6ra80_dp_tia", 480, 2000),
}
"""File: spec, width and height in pixels; a longer page is cut."""


def main() -> int:
    """Write them; 1 if there is no browser."""
    if not any(map(shutil.which, NAMES)):
        sys.stderr.write(f"no pictures: {', '.join(NAMES)} are not installed\n")
        return 1
    format_ = output_format("html")
    assert format_ is not None
    with tempfile.TemporaryDirectory() as name:
        room = Path(name)
        for target, (spec, width, height) in PICTURES.items():
            page = room / f"{spec}.html"
            if not page.exists():
                folder = room / f"{spec}_generated"
                source = shutil.copy(ROOT / "specs" / f"{spec}.yaml", room)
                assert api.generate(source, folder).ok
                text = format_.render("review", api.review(source, folder), PLAIN)
                page.write_text(text.replace(f"{room.as_posix()}/", ""), "utf-8")
            picture(page, ROOT / "docs" / "pictures" / target, width, height)
        workbench(room, ROOT / "docs" / "pictures" / "workbench.png")
    return 0


def workbench(room: Path, target: Path) -> None:
    """The page of ``serve`` with a mistake in a spec, and parameters that were found by a word."""
    from tests.browser import page
    from tests.workbench.serve.server import served

    folder = room / "machines"
    folder.mkdir()
    text = (ROOT / "specs" / "s7-1500_g120_pn.yaml").read_text("utf-8")
    text = re.sub(r", zh-CN(: [^}]+)?", "", text)  # not every machine has the letters
    (folder / "pump.yaml").write_text(text.replace("hardware_id", "hardware_ident"), "utf-8")
    with served(folder) as address, page() as browser:
        browser.size(1280, 800)
        browser.open(address)
        browser.sees("#problems .error", "hardware_ident")
        browser.fill("#search", "ramp")
        browser.sees("#results .hit", "P1120")
        browser.picture(target)


if __name__ == "__main__":
    sys.exit(main())
