"""The release workflow: what it permits, what it publishes, and its commands as a runner would execute them."""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import subprocess
import sys
import tomllib
from importlib.metadata import requires
from pathlib import Path
from typing import Any

import pytest
import yaml
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from projects import ROOT

from plcgen._version import __version__

FILES = ("plcgen", "templates", "specs", "docs", "ci", "pyproject.toml", "README.md", "LICENSE")
"""As much of the repository as a build needs."""


def workflow() -> Any:
    return yaml.safe_load((ROOT / ".github" / "workflows" / "release.yml").read_text("utf-8"))


def script(name: str) -> str:
    """The shell of a step."""
    (found,) = (step["run"] for step in workflow()["jobs"]["build"]["steps"] if step.get("name") == name)
    return str(found)


def run(command: str, folder: Path, **variables: str) -> subprocess.CompletedProcess[str]:
    """As a runner does: bash that stops at the first error, with our Python as ``python``."""
    environment = {**os.environ, "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}", **variables}
    environment |= {"GIT_CONFIG_GLOBAL": os.devnull, "GIT_CONFIG_NOSYSTEM": "1"}
    return subprocess.run(
        ["bash", "-e", "-o", "pipefail", "-c", command], cwd=folder, env=environment, capture_output=True, text=True,
        check=False,
    )  # fmt: skip


def test_nothing_is_published_by_default() -> None:
    """Publishing waits for a variable of the repository and for a tag; only that job may ask for an upload."""
    jobs = workflow()["jobs"]
    assert set(jobs) == {"build", "publish"}
    assert jobs["publish"]["if"] == "${{ vars.PUBLISH == 'true' && startsWith(github.ref, 'refs/tags/') }}"
    assert jobs["publish"]["needs"] == "build"
    assert not any("publish" in step.get("uses", "") for step in jobs["build"]["steps"])


def test_no_job_may_write_to_the_repository() -> None:
    """The token reads; what is written are attestations."""
    assert workflow()["permissions"] == {"contents": "read"}
    for job in workflow()["jobs"].values():
        assert set(job["permissions"]) <= {"contents", "id-token", "attestations"}
        assert job["permissions"].get("contents", "read") == "read"


def test_everything_in_the_repository_that_a_step_names_exists() -> None:
    assert os.access(ROOT / script("Build twice").split()[0], os.X_OK)
    assert (ROOT / "requirements.lock").is_file()


@pytest.mark.parametrize("place", ["Makefile", "ci/release.sh", ".github/workflows/release.yml"])
def test_the_lock_is_installed_as_it_is(place: str) -> None:
    """Older pips look for ``coverage[toml]`` outside the lock: an error as soon as there is a newer coverage."""
    installations = [line for line in (ROOT / place).read_text("utf-8").splitlines() if "-r requirements.lock" in line]
    assert installations
    assert all("--require-hashes --no-deps" in line for line in installations)


def test_the_lock_has_everything_that_its_packages_ask_for() -> None:
    """Nothing else is installed, so nothing may be missing. Extras count, too."""
    found = re.findall(r"^([\w.-]+)==(\S+)", (ROOT / "requirements.lock").read_text("utf-8"), re.MULTILINE)
    locked = {canonicalize_name(name): version for name, version in found}
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    waiting = [Requirement(text) for text in (*project["dependencies"], *project["optional-dependencies"]["dev"])]
    seen = set()
    while waiting:
        wanted = waiting.pop()
        name = canonicalize_name(wanted.name)
        if (name, *wanted.extras) in seen or name == "plcgen":
            continue
        seen.add((name, *wanted.extras))
        assert wanted.specifier.contains(locked[name], prereleases=True), str(wanted)
        for one in map(Requirement, requires(name) or ()):
            extras = ("", *wanted.extras)
            if one.marker is None or any(one.marker.evaluate({"extra": extra}) for extra in extras):
                waiting.append(one)
    assert len(seen) > 40


@pytest.mark.skipif(os.name == "nt", reason="the script is for a shell")
def test_the_tag_is_the_version() -> None:
    """Anything else fails."""
    command = script("The tag is the version")
    assert run(command, ROOT, GITHUB_REF_NAME=f"v{__version__}").returncode == 0
    assert run(command, ROOT, GITHUB_REF_NAME="v99.0.0").returncode == 1


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="the script is for a shell")
def test_two_builds_give_the_same_bytes(tmp_path: Path) -> None:
    """The script compares them; a third build from a clone elsewhere gives the same hashes, too."""
    first, second = tmp_path / "first", tmp_path / "further" / "away"
    for name in FILES:
        source = ROOT / name
        if source.is_dir():
            shutil.copytree(source, first / name, ignore=shutil.ignore_patterns("__pycache__", "*.png"))
        else:
            shutil.copy(source, first / name)
    who = "git -c user.name=T -c user.email=t@example.org"
    made = run(f"git init -q . && git add . && {who} commit -qm first --date 2024-01-02T03:04:05Z", first)
    assert made.returncode == 0, made.stderr
    second.parent.mkdir()
    assert run(f"git clone -q '{first}' '{second}'", tmp_path).returncode == 0
    sums = []
    for folder in (first, second):
        done = run(script("Build twice"), folder)
        assert done.returncode == 0, done.stderr
        dist = folder / "dist"
        lines = (dist / "SHA256SUMS").read_text("utf-8").splitlines()
        assert {name: hashlib.sha256((dist / name).read_bytes()).hexdigest() for _, name in map(str.split, lines)} == {
            name: digest for digest, name in map(str.split, lines)
        }
        sums.append(lines)
    assert len(sums[0]) == 2
    assert sums[0] == sums[1]
