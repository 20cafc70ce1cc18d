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
