"""The registry: one file per format, others by entry point; a toy format from elsewhere works with every verb."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from plcgen.base.diagnostics import PluginError
from plcgen.base.display.view import PLAIN
from plcgen.report import formats, registry
from tests.projects import FAQ, ROOT

TOY = '''"""A format of somebody else: counts."""

from plcgen.report.registry import OutputFormat

FORMAT = OutputFormat(
    name="toy",
    findings=lambda found, view: f"toy: {found.verb} found {len(found.diagnostics)}\\n",
    verification=lambda result, view: f"toy: {len(list(result.checks()))} checks of {result.verb}\\n",
)
'''


@pytest.fixture
def toy(distribution):
    """A distribution with a toy format is installed; returns how to install one with other contents."""

    def install(text=TOY, entry="toy = toy_format:FORMAT"):
        distribution("toy_format", "plcgen.outputs", entry, text)

    install()
    return install


@pytest.mark.parametrize(
    ("kind", "names"),
    [
        ("findings", "text github json junit sarif"),
        ("verification", "text github json junit sarif"),
        ("layout", "text csv html json markdown svg"),
        ("comparison", "text github json junit markdown sarif"),
        ("trace", "text json vcd"),
        ("answer", "text json"),
    ],
)
def test_formats_of_a_kind(kind, names):
    """Which formats show what, and the page about the command line says so."""
    assert list(registry.formats_for(kind)) == names.split()
    assert " ".join(f"`{name}`" for name in names.split()) in (ROOT / "docs" / "cli.md").read_text("utf-8")


def test_one_file_per_format():
    """The name of the file is the name of the format, and each shows something."""
    files = {path.stem for path in Path(formats.__file__).parent.glob("*.py")} - {"__init__"}
    known = {name: registry.output_format(name) for name in files}
    assert all(found.name == name and any(map(found.shows, registry.KINDS)) for name, found in known.items())
    assert registry.output_format("nope") is None


def test_a_kind_that_is_not_shown():
    """A format says what it cannot show."""
    with pytest.raises(ValueError, match="the format vcd does not show a layout"):
        registry.output_format("vcd").render("layout", None, PLAIN)


@pytest.mark.usefixtures("toy")
def test_a_toy_format_works(plcgen, tmp_path):
    """Check and verify offer it, take it and show it in their help; verbs whose results it cannot show do not."""
    (tmp_path / "job.yaml").write_text(FAQ.read_text("utf-8"), "utf-8")
    assert plcgen("check", "job.yaml", "--format", "toy").out == "toy: check found 0\n"
    assert plcgen("verify", "job.yaml", "--faults", "none", "-f", "toy").out.startswith("toy: ")
    assert "junit, sarif, toy." in plcgen("verify", "--help").out
    assert "toy" not in plcgen("layout", "--help").out
    refused = plcgen("layout", "job.yaml", "--format", "toy")
    assert (refused.code, refused.out) == (2, "")
    assert "'toy' is not one of 'text', 'csv', 'html'" in refused.err


@pytest.mark.usefixtures("toy")
def test_completion(plcgen, monkeypatch):
    """The Tab key knows it as well."""
    monkeypatch.setenv("COMP_WORDS", "plcgen check --format t")
    monkeypatch.setenv("COMP_CWORD", "3")
    monkeypatch.setenv("_PLCGEN_COMPLETE", "bash_complete")
    assert plcgen().out.split() == ["plain,text", "plain,toy"]


def test_entry_points_that_are_no_format(toy, plcgen):
    """Said by name: an object of another class, a format of another name. Shipped names are taken."""
    toy("FORMAT = 1\n")
    with pytest.raises(PluginError, match=r"toy_format:FORMAT in plcgen.outputs is not of type OutputFormat"):
        registry.output_format("toy")
    sys.modules.pop("toy_format")
    toy(TOY, "other = toy_format:FORMAT")
    with pytest.raises(PluginError, match=r"other in plcgen.outputs is a format called toy"):
        registry.formats_for("findings")
    sys.modules.pop("toy_format")
    toy("import nowhere\n", "other = toy_format:FORMAT")
    refused = plcgen("check", "--help")
    assert (refused.code, refused.out) == (1, "")
    assert refused.err == ("error: the plug-in other (toy_format:FORMAT) cannot be loaded: No module named 'nowhere'\n")
    sys.modules.pop("toy_format", None)
    toy("raise SystemExit(3)\n", "other = toy_format:FORMAT")
    assert plcgen("check", "--help").err == "error: the plug-in other (toy_format:FORMAT) cannot be loaded: 3\n"
    toy(TOY, "json = toy_format:FORMAT")
    assert registry.output_format("json").layout is not None


def test_formats_are_imported_when_asked_for():
    """A run in text imports no other format."""
    code = (
        "import sys; from plcgen.cli.main import run; run(['check', sys.argv[1]]);"
        "print([name for name in sys.modules if name.startswith('plcgen.report.formats.')])"
    )
    out = subprocess.run([sys.executable, "-c", code, FAQ], capture_output=True, text=True, check=True).stdout
    assert out == "['plcgen.report.formats.text']\n"
