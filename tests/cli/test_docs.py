"""``docs`` and ``explain`` with words: which pages they name."""

from __future__ import annotations

import re
import tomllib

import pytest

from plcgen.base.page_search import MOST, best_pages
from plcgen.base.resources import docs_dir, documented
from plcgen.cli.main import run
from tests.docs.pages import questions

QUESTIONS = {
    "which identifier": {"tasks/which-identifier", "hardware-id"},
    "identifier": {"tasks/which-identifier", "hardware-id"},
    "save to ROM": {"tasks/save-to-rom"},
    "rom": {"tasks/save-to-rom"},
    "start a job": {"generated-code", "tutorial", "tasks/ramps-from-an-hmi"},
    "DriveJobs": {"generated-code", "tasks/ramps-from-an-hmi", "tasks/read-a-value", "tutorial"},
    "execute": {"generated-code", "tutorial", "simulate"},
    "status": {"generated-code", "hmi"},
    "memory": {"memory"},
    "OB86": {"generated-code", "hardware-id"},
    "drive_object": {"hardware-id", "spec", "tasks/which-identifier"},
    "WRREC": {"generated-code", "tasks/which-identifier", "audit", "glossary"},
    "read the fault buffer": {"tasks/faults-on-a-panel"},
    "offsets of a DB": {"layout", "lock"},
    "install on windows": {"windows"},
    "import the blocks into TIA Portal": {"simaticml", "tutorial", "instructions"},
    "what changed between two versions": {"diff", "tasks/review-a-change"},
    "my drive is not in the catalogue": {"tasks/my-own-drive", "devices"},
    "simulate a fault of the drive": {"simulate"},
    "exit code": {"exit-codes"},
    "VS Code": {"editors"},
    "ramp time from a panel": {"tasks/ramps-from-an-hmi"},
    "github pipeline": {"tasks/in-ci", "ci"},
    "text list for an HMI": {"hmi"},
    "PPI cable S7-200": {"ppi", "s7-200", "ppi-plant", "ppi-master", "tasks/log-an-s7-200"},
}
"""What somebody asks, and the pages of which one answers; written before the search was."""


@pytest.mark.parametrize("question", QUESTIONS)
def test_one_of_the_best_three_pages_answers(question: str) -> None:
    """By what the pages are about, as somebody knows who has read them."""
    assert QUESTIONS[question] <= documented().keys()
    found = [name for name, _ in best_pages(question)]
    assert len(found) <= MOST
    assert QUESTIONS[question] & set(found), found


@pytest.mark.parametrize(("asked", "least"), [("before", 30), ("after", 15)])
def test_the_first_page_answers(asked: str, least: int, capsys: pytest.CaptureFixture[str]) -> None:
    """Three of four questions in English, German and numbers have the right page first; a code is its own page."""
    right = []
    for question, pages in questions()[asked].items():
        assert run(["docs", *question.split()]) == 0 or not pages, question
        shown = capsys.readouterr().out
        found = re.search(r"plcgen docs (\S+)", shown) if shown.startswith("pages that") else None
        first = found[1] if found else f"codes/{question}"
        right += [question] if first in pages else []
    assert len(right) >= least, sorted(questions()[asked].keys() - set(right))


def test_words_name_pages_that_exist() -> None:
    """The words of words.toml are of pages that there are; each page but the tables of messages has some."""
    named = tomllib.loads((docs_dir() / "words.toml").read_text("utf-8"))["pages"]
    assert named.keys() == {name for name in documented() if not name.startswith(("codes/", "adr/"))}


def test_several_words_are_searched_and_a_page_is_shown(capsys: pytest.CaptureFixture[str]) -> None:
    """``docs which identifier`` names pages, ``docs tasks/save-to-rom`` and ``docs save-to-rom`` are one."""
    assert run(["docs", "which", "identifier"]) == 0
    assert "plcgen docs tasks/which-identifier  Which identifier" in capsys.readouterr().out
    assert run(["docs", "save-to-rom"]) == 0
    assert capsys.readouterr().out == documented()["tasks/save-to-rom"].read_text("utf-8")


def test_words_that_are_nowhere_are_an_error() -> None:
    """No page is named that has none of the words."""
    assert best_pages("xyzzyplugh") == []
    assert run(["docs", "xyzzyplugh"]) == 2


@pytest.mark.parametrize(
    ("key", "said"),
    [
        ("save to ROM", "plcgen docs tasks/save-to-rom"),
        ("which identifier", "plcgen docs tasks/which-identifier"),
        ("memory", "plcgen docs memory"),
    ],
)
def test_explain_of_words_names_pages(key: str, said: str, capsys: pytest.CaptureFixture[str]) -> None:
    """What is no code may be a subject of a page."""
    assert run(["explain", key]) == 1
    assert said in capsys.readouterr().err


@pytest.mark.parametrize(
    ("key", "said"),
    [
        ("DB47", ["a block of the PLC program", "data record 47", "numbers:"]),
        ("FB1203", ["a block of the PLC program"]),
        ("7901", ["As a message of a drive", "07901: Drive: Motor overspeed"]),
        ("c840", ["As a parameter of a drive", "plcgen explain c0840"]),
        ("B02F", ["DS47", "record"]),
        ("b02eh", ["DS47"]),
        ("16#DB47", ["As the lower word"]),
        ("16#B02F", ["invalid index"]),
    ],
)
def test_numbers_with_two_meanings(key: str, said: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    """As people write them: DB47 is a block, B02F the record index; 16# in front makes them words of a STATUS.

    Message 7901: list manuals of SINAMICS, F07901 and A07901, drive: motor overspeed.
    """
    assert run(["explain", key]) == 0
    shown = capsys.readouterr().out
    assert not [text for text in said if text not in shown], shown
