"""The S7 part is a library: its page works with the rest of plcgen hidden."""

from __future__ import annotations

import re
import subprocess
import sys

import pytest

import plcgen.s7
from tests.projects import ROOT

PAGE = ROOT / "plcgen" / "s7" / "README.md"
HIDE = """
import sys

class Hidden:
    def find_spec(self, name, path=None, target=None):
        if name.startswith("plcgen.") and name.split(".")[1] not in {"s7", "base", "_moved", "_version"}:
            raise ModuleNotFoundError(f"{name} is hidden")

sys.meta_path.insert(0, Hidden())
"""
ALL = """
import importlib, pkgutil, plcgen.s7
names = [m.name for m in pkgutil.walk_packages(plcgen.s7.__path__, "plcgen.s7.")]
for name in names:
    importlib.import_module(name)
assert len(names) > 100
"""


def run(code: str) -> subprocess.CompletedProcess[str]:
    """Run code in a process in which nothing but the library and what it stands on can be imported."""
    return subprocess.run([sys.executable, "-c", HIDE + code], capture_output=True, text=True, cwd=ROOT, check=False)


def test_the_page_works_with_the_rest_hidden() -> None:
    """Every Python block of the page, in order, in one process."""
    code = "\n".join(re.findall(r"```python\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL))
    assert code.count("assert") > 4
    done = run(code)
    assert (done.returncode, done.stderr) == (0, "")


def test_every_module_loads_with_the_rest_hidden() -> None:
    done = run(ALL)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize("room", ["project", "ds47"])
def test_the_rest_is_hidden(room: str) -> None:
    """Without that the tests above would say nothing."""
    assert f"plcgen.{room} is hidden" in run(f"import plcgen.{room}").stderr


def test_its_names_are_there() -> None:
    """Every name of the API, sorted, and nothing else."""
    assert {name: getattr(plcgen.s7, name) for name in plcgen.s7.__all__}
    assert plcgen.s7.__all__ == sorted(plcgen.s7.__all__)
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = plcgen.s7.nothing


def test_the_page_names_every_room() -> None:
    rooms = set(re.findall(r"^\| `(\w+)` \|", PAGE.read_text("utf-8"), re.MULTILINE))
    assert rooms == {path.parent.name for path in (ROOT / "plcgen" / "s7").glob("*/__init__.py")}
