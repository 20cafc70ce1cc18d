"""The documentation as a site: every page has a place in it, links lead where they lead in the repository."""

from __future__ import annotations

import importlib.util
import json
import os
import re
import shutil
import subprocess
from pathlib import Path
from types import ModuleType

import pytest
import yaml

from tests.chromium import evaluate
from tests.docs.pages import questions
from tests.projects import ROOT


class _Loader(yaml.SafeLoader):
    """Ignores what only MkDocs understands."""


_Loader.add_multi_constructor("tag:yaml.org,2002:python/", lambda *_: None)
CONFIG = yaml.load((ROOT / ".github" / "mkdocs.yml").read_text("utf-8"), _Loader)  # noqa: S506 - a safe loader


def hook() -> ModuleType:
    """docs/site.py, without MkDocs."""
    spec = importlib.util.spec_from_file_location("site_hook", ROOT / "docs" / "site.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def pages(nav: object) -> list[str]:
    """Every page of a navigation in order."""
    if isinstance(nav, str):
        return [nav]
    parts = nav.values() if isinstance(nav, dict) else nav
    return [page for part in parts for page in pages(part)]


def test_every_page_has_one_place() -> None:
    """All pages of docs and those beside it, but not a page for each code: their table leads there."""
    wanted = {path.relative_to(ROOT / "docs").as_posix() for path in (ROOT / "docs").rglob("*.md")}
    wanted = {page for page in wanted if not re.fullmatch(r"codes/PG[0-9]+\.md", page)}
    found = pages(CONFIG["nav"])
    assert sorted(found) == sorted({*wanted, *hook().PAGES.values()})


def test_nothing_is_fetched() -> None:
    """No fonts, no plugin with a script from elsewhere; links are to files, so that pages open from a folder."""
    assert CONFIG["theme"]["font"] is False
    assert [name for plugin in CONFIG["plugins"] for name in plugin] == ["search"]
    assert CONFIG["extra_javascript"] == ["search.js"]
    assert CONFIG["use_directory_urls"] is False


@pytest.mark.parametrize(
    ("page", "written", "expected"),
    [
        ("index.md", "[a](docs/spec.md#saving)", "[a](spec.md#saving)"),
        ("index.md", "![a](docs/pictures/review_faq.png)", "![a](pictures/review_faq.png)"),
        ("index.md", "[a](docs/codes/README.md)", "[a](codes/README.md)"),
        ("index.md", "[a](docs/adr/)", "[a](architecture.md)"),
        ("spec.md", "[a](../specs/devices)", "[a](devices.md)"),
        ("spec.md", "[a](../specs/s7-300_plant_v5.yaml)", "[a](specs/s7-300_plant_v5.yaml)"),
        ("index.md", "[a](docs/CONTRIBUTING.md#style)", "[a](CONTRIBUTING.md#style)"),
        ("adr/0009-one-channel-per-unit.md", "[a](../verify.md)", "[a](../verify.md)"),
        ("CHANGELOG.md", "[a](examples/s7-1500_s120_save)", "[a](examples.md)"),
        ("ci.md", "[a](https://pre-commit.com)", "[a](https://pre-commit.com)"),
        ("ci.md", "```text\n[a](../x)\n```", "```text\n[a](../x)\n```"),
    ],
)
def test_links_are_those_of_the_repository(page: str, written: str, expected: str) -> None:
    assert hook().relinked(written, page) == expected


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the site; skips where MkDocs is not installed: it has an environment of its own (make site)."""
    program = shutil.which("mkdocs", path=f"{ROOT / '.venv-site' / 'bin'}{os.pathsep}{os.environ['PATH']}")
    if program is None:
        pytest.skip("mkdocs is not installed: make site installs it")
    folder = tmp_path_factory.mktemp("site")
    command = [
        program,
        "build",
        "--strict",
        "--config-file",
        str(ROOT / ".github" / "mkdocs.yml"),
        "-d",
        str(folder),
    ]
    environment = {**os.environ, "NO_MKDOCS_2_WARNING": "1"}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


@pytest.mark.slow
def test_the_site_fetches_nothing(site: Path) -> None:
    """It is built without a warning, and no page asks another server."""
    page = (site / "tutorial.html").read_text("utf-8")
    assert not re.findall(r"<(?:script|link|img)[^>]*(?:src|href)=[\"']https?:", page)


@pytest.mark.slow
@pytest.mark.parametrize("page", ["spec", "ppi", "generated-code", "lock", "layout"])
def test_code_is_not_cut(page: str, site: Path) -> None:
    """Every block of code is as wide as its widest line at a width of 1400 px; these pages have the longest lines."""
    cut = """Array.from(document.querySelectorAll("pre > code")).filter((one) => one.scrollWidth > one.clientWidth)
      .map((one) => one.textContent.slice(0, 60))"""
    assert evaluate(site / f"{page}.html", cut, policy=False) == []


@pytest.mark.slow
@pytest.mark.parametrize(("asked", "least"), [("before", 30), ("after", 15)])
def test_the_first_page_answers(asked: str, least: int, site: Path) -> None:
    """Three of four questions in English, German and numbers have the right page first, by the script of the theme."""
    node = shutil.which("node")
    if node is None:
        pytest.skip("node is not installed")
    wanted = questions()[asked]
    command = [node, str(ROOT / "tests" / "docs" / "ask_site.cjs"), str(site)]
    done = subprocess.run(command, input=json.dumps(list(wanted)), capture_output=True, text=True, check=True)
    first = [place.split("#")[0].removesuffix(".html") for place in json.loads(done.stdout)]
    wrong = [question for question, page in zip(wanted, first, strict=True) if page not in wanted[question]]
    assert len(wrong) <= len(wanted) - least, wrong
