"""The wheel works with the source tree out of the way: templates, specs and catalogues are inside."""

from __future__ import annotations

import os
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from tests.projects import ROOT


@pytest.fixture(scope="module")
def unpacked(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Content of a freshly built wheel."""
    folder = tmp_path_factory.mktemp("wheel")
    command = [sys.executable, "-m", "build", "--wheel", "--no-isolation", "--outdir", str(folder), str(ROOT)]
    subprocess.run(command, check=True, capture_output=True)
    (wheel,) = folder.glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(folder / "site")
    return folder / "site"


def run(unpacked: Path, cwd: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": str(unpacked), "PYTHONSAFEPATH": "1"}
    return subprocess.run(
        [sys.executable, *arguments], cwd=cwd, env=environment, capture_output=True, text=True, check=False
    )


@pytest.mark.slow
def test_every_shipped_spec_runs_from_the_wheel(unpacked: Path, tmp_path: Path) -> None:
    """Each shipped spec generates without the source tree, and one of each protocol verifies."""
    where = run(unpacked, tmp_path, "-c", "import plcgen; print(plcgen.__file__)")
    assert where.stdout.startswith(str(unpacked)), where.stderr
    specs = [str(spec) for spec in (unpacked / "plcgen" / "_specs").glob("*.yaml")]
    both = [spec for spec in specs if Path(spec).stem in {"s7-300_mm440_dp", "s7-1200_s7-200_ppi"}]
    for arguments in (["generate", *specs], ["verify", "--faults", "none", *both]):
        done = run(unpacked, tmp_path, "-m", "plcgen", *arguments)
        assert (done.returncode, len(both)) == (0, 2), done.stdout + done.stderr


def test_pages_are_shown_offline(unpacked: Path, tmp_path: Path) -> None:
    """A list, a page, the page of a code; a word that is none is told with what was probably meant."""
    listed = run(unpacked, tmp_path, "-m", "plcgen", "docs").stdout
    assert "spec " in listed
    assert "The spec" in listed
    for page in ("spec", "PG209"):
        shown = run(unpacked, tmp_path, "-m", "plcgen", "docs", page)
        name = page if page == "spec" else f"codes/{page}"
        assert (shown.returncode, shown.stdout) == (0, (ROOT / "docs" / f"{name}.md").read_text("utf-8"))
    wrong = run(unpacked, tmp_path, "-m", "plcgen", "docs", "../spek")
    assert wrong.returncode == 2
    assert "no page" in wrong.stderr


@pytest.mark.slow
def test_the_wheel_holds_what_it_needs_and_nothing_else(unpacked: Path) -> None:
    """Type marker, licence, templates, specs, pages of the documentation without pictures; no tests, no examples."""
    files = {p.relative_to(unpacked).as_posix() for p in unpacked.rglob("*") if p.is_file()}
    assert {"plcgen/py.typed", "plcgen/_templates/ds47/job.scl.j2", "plcgen/_specs/devices/sinamics-dcm.yaml"} <= files
    assert "plcgen/_specs/cpus/s7.yaml" in files
    assert {"plcgen/_docs/spec.md", "plcgen/_docs/codes/PG209.md"} <= files
    assert not any(name.endswith((".png", "site.py")) for name in files)
    assert any(name.endswith("LICENSE") for name in files)
    assert not any(name.startswith(("tests/", "examples/", "bench/")) for name in files)


def test_the_metadata(unpacked: Path) -> None:
    """No address that is nobody's; ``ppi`` is the old name of ``serial``."""
    (metadata,) = unpacked.glob("*.dist-info/METADATA")
    lines = metadata.read_text("utf-8").split("\n\n")[0].splitlines()
    assert not [line for line in lines if line.startswith(("Project-URL", "Home-page"))]
    needs: dict[str, set[str]] = {"serial": set(), "ppi": set()}
    for line in lines:
        if line.startswith("Requires-Dist") and (extra := line.rpartition("extra ==")[2].strip(" '\"")) in needs:
            needs[extra].add(line.partition(";")[0])
    assert needs["ppi"] == needs["serial"] != set()


def test_the_sdist_holds_what_make_needs(tmp_path: Path) -> None:
    """Every file of the source tree that Makefile, tests and their tools read is in it."""
    command = [sys.executable, "-m", "build", "--sdist", "--no-isolation", "--outdir", str(tmp_path), str(ROOT)]
    subprocess.run(command, check=True, capture_output=True)
    (archive,) = tmp_path.glob("*.tar.gz")
    import tarfile

    with tarfile.open(archive) as packed:
        held = {Path(*Path(name).parts[1:]).as_posix() for name in packed.getnames()}
    assert {"Makefile", "requirements.lock", "pyproject.toml", ".ci/runtime.lock", "action.yml"} <= held
    folders = ("plcgen", "templates", "specs", "tests", "docs", ".ci", ".github")
    files = (path for each in folders for path in (ROOT / each).rglob("*") if path.is_file())
    mine = {path.relative_to(ROOT).as_posix() for path in files if "__pycache__" not in path.parts}
    assert not [name for name in sorted(mine - held) if not name.endswith(".pyc")]
