"""``plcgen audit``: exit codes, streams, formats."""

import json
import shutil

import pytest

from tests.projects import FAQ, ROOT

SOURCES = ROOT / "tests" / "audit" / "faq"


@pytest.fixture
def faq(tmp_path):
    """The FAQ's data blocks and calls beside a spec."""
    shutil.copytree(SOURCES, tmp_path / "plc")
    shutil.copy(FAQ, tmp_path / "job.yaml")
    return tmp_path


@pytest.mark.usefixtures("faq")
def test_text(plcgen):
    """DB6 is found, at its line, with what it needs; exit code 1."""
    result = plcgen("audit", "plc", "--spec", "job.yaml")
    assert (result.code, result.err) == (1, "")
    assert (
        "error[PG651]: response buffer 6 bytes too small: DB6 has 4 bytes, a negative answer needs 10\n" in result.out
    )
    assert " --> plc/DB6.db:3:1\n" in result.out
    assert result.out.endswith("8 checks: 7 ok, 1 error\n")
    quiet = plcgen("audit", "plc", "--spec", "job.yaml", "-q").out
    assert "WR_DataBuffer_1" not in quiet
    assert "PG651" in quiet


@pytest.mark.usefixtures("faq")
def test_good(plcgen):
    """Nothing to say with --quiet, exit code 0."""
    result = plcgen("audit", "plc/DB3.db", "plc/DB4.db", "--spec", "job.yaml", "-q")
    assert (result.code, result.out, result.err) == (0, "", "")


@pytest.mark.usefixtures("faq")
@pytest.mark.parametrize("format_", ["json", "sarif", "junit", "github"])
def test_formats(plcgen, format_):
    """Machine formats own stdout."""
    result = plcgen("audit", "plc", "--spec", "job.yaml", "-f", format_)
    assert (result.code, result.err) == (1, "")
    assert "PG651" in result.out
    if format_ == "json":
        assert json.loads(result.out)["kind"] == "audit"


def test_wrong_use(plcgen):
    """Sources and spec are needed."""
    assert plcgen("audit", "x.db").code == 2
    assert plcgen("audit", "--spec", "x.yaml").code == 2


def test_nothing_checked_is_no_success(plcgen, tmp_path):
    """Sources without anything of the spec: exit code 2, and the reason; nothing is an error of the sources."""
    (tmp_path / "other.scl").write_text("FUNCTION FC1 : INT\nBEGIN\nFC1 := 1;\nEND_FUNCTION\n")
    result = plcgen("audit", tmp_path / "other.scl", "--spec", FAQ)
    assert result.code == 2
    assert "nothing was checked" in result.err


def test_a_check_that_was_not_run_is_an_error_if_strict(plcgen, tmp_path):
    """One of four buffers is there: 0 without --strict, 1 with it."""
    shutil.copy(SOURCES / "DB3.db", tmp_path / "DB3.db")
    shutil.copy(SOURCES / "DB4.db", tmp_path / "DB4.db")
    run = ["audit", tmp_path, "--spec", FAQ]
    assert [plcgen(*run).code, plcgen(*run, "--strict").code] == [0, 1]
    assert "--strict" in plcgen(*run, "--strict").err
