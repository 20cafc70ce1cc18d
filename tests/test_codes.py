"""The table of codes is complete: every code used is in it, has a page, and, if a spec can trigger it, cases."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from plcgen.base.diagnostics import Severity, pages
from plcgen.base.diagnostics.codes import all_codes, code
from tests.test_cases import FILES
from tests.yaml_files import read_yaml

ROOT = Path(__file__).resolve().parents[1]
_USED = re.compile(r'"(PG\d{3})"')


def _used() -> set[str]:
    return {found for path in (ROOT / "plcgen").rglob("*.py") for found in _USED.findall(path.read_text("utf-8"))}


def test_every_code_used_is_in_the_table() -> None:
    """A message without an explanation would leave its reader alone."""
    assert _used() - set(all_codes()) == set()


def test_every_code_in_the_table_is_used() -> None:
    """The table does not describe what cannot happen."""
    assert set(all_codes()) - _used() == set()


def test_a_spec_code_has_a_case_file() -> None:
    """PG1xx to PG4xx can all be triggered by a spec, and each has examples that are executed."""
    wanted = {code for code in all_codes() if code[2] in "1234"}
    assert {path.stem for path in (ROOT / "tests" / "cases").glob("PG[1-4]??.yaml")} == wanted


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_the_page_names_the_severities_that_cases_have(path: Path) -> None:
    """Who reads "error" on the page of a code is not shown a warning by a check."""
    given = {case.get("severity", "error") for case in read_yaml(path.read_text("utf-8"))["fail"]}
    assert set(code(path.stem).levels.split(" or ")) == given


def test_codes_are_in_order_and_complete() -> None:
    """Every entry has every text, as a sentence where it is one."""
    assert list(all_codes()) == sorted(set(all_codes()))
    for name in all_codes():
        info = code(name)
        assert re.fullmatch(r"PG[1-9]\d\d", info.code)
        assert info.title[0].isupper() or info.title.startswith("YAML"), info.code
        assert not info.title.endswith("."), info.code
        assert info.why.endswith((".", "?")), info.code
        assert info.fix.endswith("."), info.code
        assert info.bad, info.code
        assert info.good, info.code
        assert info.bad != info.good, info.code
        assert isinstance(info.severity, Severity)


def test_a_code_is_found_in_any_case() -> None:
    """People type pg303."""
    assert code(" pg303 ").code == "PG303"
    assert code("PG220").severity is Severity.WARNING
    with pytest.raises(KeyError):
        code("PG000")


def test_the_pages_are_in_sync() -> None:
    """docs/codes holds exactly what the table says (python -m plcgen.base.diagnostics.pages docs/codes)."""
    folder = ROOT / "docs" / "codes"
    on_disk = {path.name: path.read_text("utf-8") for path in folder.glob("*.md")}
    assert on_disk == pages.pages()


def test_stale_pages_are_removed(tmp_path: Path) -> None:
    """A code that is gone takes its page with it; other files stay."""
    (tmp_path / "PG999.md").write_text("old")
    (tmp_path / "notes.md").write_text("mine")
    pages.write_pages(tmp_path)
    assert not (tmp_path / "PG999.md").exists()
    assert (tmp_path / "notes.md").exists()
    assert (tmp_path / "PG303.md").read_text("utf-8").startswith("# PG303: ")
