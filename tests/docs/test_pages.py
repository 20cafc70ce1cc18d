"""Every command and Python block of README and docs runs as it stands and prints what the page shows."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.docs.pages import PAGES, ROOT, Block, blocks
from tests.docs.session import Session

NOT_RUN = {
    "README.md": 1,
    "docs/CONTRIBUTING.md": 1,
    "docs/ci.md": 1,
    "docs/cli.md": 1,
    "docs/evidence.md": 1,
    "docs/live.md": 1,
    "docs/ppi-plant.md": 1,
    "docs/releasing.md": 1,
    "docs/tutorial.md": 1,
    "docs/workbench.md": 1,
}
"""Blocks of a page that no test can run; each says why in the comment before it."""


@pytest.fixture
def session(
    page: Path, forks: Path, tmp_path: Path, tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch
) -> Iterator[Session]:
    """The folder of one page; all pages of a run, in whatever process, share their verdicts.

    Every command of the tutorial starts Python, as a reader does.
    """
    base = tmp_path_factory.getbasetemp()
    verdicts = (base.parent if "PYTEST_XDIST_WORKER" in os.environ else base) / "verdicts"
    folder = tmp_path / "page"
    folder.mkdir()
    monkeypatch.chdir(folder)
    monkeypatch.delenv("NO_COLOR", raising=False)
    opened = Session(folder, verdicts, None if page.name == "tutorial.md" else forks)
    yield opened
    opened.close()


def named(page: Path) -> str:
    """A page as it is called from the root."""
    return page.relative_to(ROOT).as_posix()


def runs(block: Block) -> bool:
    """Whether there is something to run, or a file for what runs."""
    return block.language in {"console", "python"} or bool(block.notes)


@pytest.mark.slow
@pytest.mark.parametrize("page", [page for page in PAGES if any(map(runs, blocks(page)))], ids=named)
def test_page_does_what_it_says(page: Path, session: Session) -> None:
    """Commands end as they should and print what is shown; Python blocks and the tests in them pass."""
    for block in blocks(page):
        session.run(block)


def test_what_does_not_run_says_why() -> None:
    """Every block without a test is counted here and has its reason in the page."""
    skipped = [block for page in PAGES for block in blocks(page) if "not run" in block.notes]
    found = {named(page): sum(block.page == page for block in skipped) for page in PAGES}
    assert {name: number for name, number in found.items() if number} == NOT_RUN
    assert all(block.notes["not run"] for block in skipped)


def test_commands_stand_in_console_blocks() -> None:
    """A command in a block of another language would not be run."""
    hidden = [
        b.place for page in PAGES for b in blocks(page) if b.language in {"", "sh", "text", "bash"} and "$ " in b.text
    ]
    shells = [b.place for page in PAGES for b in blocks(page) if b.language in {"sh", "bash", "shell"}]
    assert hidden + shells == []
