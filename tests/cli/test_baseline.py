"""check beside an earlier result: what is known is left out, what is new fails."""

import json
from pathlib import Path

import pytest

OLD = """\
FUNCTION_BLOCK FB 1
CONST
  STEP := 2;
END_CONST
VAR
  total : INT;
END_VAR
BEGIN
total := total + STEP;
END_FUNCTION_BLOCK
"""
"""STEP 7 V5 as TIA does not read it: a CONST without VAR, a block that is only a number, a statement without #."""


@pytest.fixture
def recorded(plcgen, tmp_path):
    """A source with problems, and its result as known.json."""
    (tmp_path / "old.scl").write_text(OLD, "utf-8")
    done = plcgen("check", "old.scl", "--target", "tia-1500", "--format", "json", "-o", "known.json")
    assert done.code == 1
    known = json.loads(Path("known.json").read_text("utf-8"))
    assert known["diagnostics"]
    return known


def test_what_is_known_does_not_fail(plcgen, recorded, tmp_path):
    """Lines may move: the place of a problem is its file."""
    (tmp_path / "old.scl").write_text("\n\n" + OLD, "utf-8")
    done = plcgen("check", "old.scl", "--target", "tia-1500", "--baseline", "known.json")
    assert (done.code, done.out) == (0, "")
    assert f"{len(recorded['diagnostics'])} known of known.json left out" in done.err
    assert "gone" not in done.err


@pytest.mark.usefixtures("recorded")
def test_what_is_new_fails_and_is_all_that_is_shown(plcgen, tmp_path):
    (tmp_path / "new.scl").write_text(OLD.replace("FB 1", "FB 2").replace("total : INT", "total : INTT"), "utf-8")
    done = plcgen("check", "old.scl", "new.scl", "--target", "tia-1500", "--baseline", "known.json")
    assert done.code == 1
    assert "new.scl" in done.out
    assert "old.scl" not in done.out


def test_the_same_problem_once_more_is_new(plcgen, recorded, tmp_path):
    """A problem counts as often as it was recorded."""
    more = "FUNCTION_BLOCK FB 3\nCONST\n  NEXT := 2;\nEND_CONST\nBEGIN\n;\nEND_FUNCTION_BLOCK\n"
    (tmp_path / "old.scl").write_text(OLD + more, "utf-8")
    done = plcgen("check", "old.scl", "--target", "tia-1500", "--baseline", "known.json", "--json")
    data = json.loads(done.out)
    assert done.code == 1
    assert data["baseline"] == {"known": len(recorded["diagnostics"]), "gone": 0}
    assert data["diagnostics"]
    assert all(found["line"] > OLD.count("\n") for found in data["diagnostics"][-1:])


def test_what_is_gone_is_told(plcgen, recorded, tmp_path):
    (tmp_path / "old.scl").write_text("", "utf-8")
    done = plcgen("check", "old.scl", "--target", "tia-1500", "--baseline", "known.json", "--json")
    assert json.loads(done.out)["baseline"]["gone"] == len(recorded["diagnostics"])


@pytest.mark.usefixtures("recorded")
@pytest.mark.parametrize(
    "text", ["", "[1", "[]", "{}", '{"kind": "layout", "diagnostics": []}', '{"kind": "check", "diagnostics": [1]}']
)
def test_another_file_is_refused(plcgen, tmp_path, text):
    """Wrong use: exit code 2, and how to record one."""
    (tmp_path / "known.json").write_text(text, "utf-8")
    done = plcgen("check", "old.scl", "--baseline", "known.json")
    assert done.code == 2
    assert "error[PG901]: this is not a result of plcgen check --format json" in done.err
    assert "record it: plcgen check PATHS --format json --output FILE" in done.err


@pytest.mark.usefixtures("recorded")
def test_a_file_that_is_not_there(plcgen):
    done = plcgen("check", "old.scl", "--baseline", "none.json")
    assert done.code == 2
    assert "not readable" in done.err
