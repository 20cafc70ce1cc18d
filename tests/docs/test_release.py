"""The release workflow: what it permits, what it publishes, and its commands as a runner would execute them."""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import subprocess
import sys
import tomllib
from importlib.metadata import requires, version
from pathlib import Path
from typing import Any

import pytest
import yaml
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from packaging.version import Version

from plcgen._version import __version__
from tests.projects import ROOT

FILES = ("plcgen", "templates", "specs", "docs", ".ci", "pyproject.toml", "README.md", "LICENSE")
"""As much of the repository as a build needs."""


def workflow() -> Any:
    return yaml.safe_load((ROOT / ".github" / "workflows" / "release.yml").read_text("utf-8"))


def script(name: str) -> str:
    """The shell of a step."""
    (found,) = (step["run"] for job in workflow()["jobs"].values() for step in job["steps"] if step.get("name") == name)
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
    assert set(jobs) == {"build", "attest", "publish"}
    assert jobs["publish"]["if"] == "${{ vars.PUBLISH == 'true' && startsWith(github.ref, 'refs/tags/') }}"
    assert (jobs["publish"]["needs"], jobs["attest"]["needs"]) == ("attest", "build")
    assert not any("publish" in step.get("uses", "") for job in ("build", "attest") for step in jobs[job]["steps"])


def test_no_job_may_write_to_the_repository() -> None:
    """Each job has what it needs: reading, attesting, publishing."""
    assert workflow()["permissions"] == {}
    assert {name: job["permissions"] for name, job in workflow()["jobs"].items()} == {
        "build": {"contents": "read"},
        "attest": {"id-token": "write", "attestations": "write"},
        "publish": {"id-token": "write"},
    }


def test_what_may_sign_runs_nothing_of_others() -> None:
    """Where a token can be had, no package is installed and no script of the repository runs."""
    for job in (job for job in workflow()["jobs"].values() if "id-token" in job["permissions"]):
        assert not any("checkout" in step.get("uses", "") for step in job["steps"])
        scripts = " ".join(step.get("run", "") for step in job["steps"])
        assert not re.search(r"\b(pip|python|npm|curl|bash|sh)\b", scripts)


def test_actions_are_named_by_commit() -> None:
    """A tag can be moved; the version stands behind."""
    texts = (*(ROOT / ".github").rglob("*.yml"), ROOT / "action.yml")
    used = [line.strip(" -") for path in texts for line in path.read_text("utf-8").splitlines() if "uses:" in line]
    assert len(used) > 7
    assert [line for line in used if not re.fullmatch(r"uses: [\w./-]+@[0-9a-f]{40} # v[0-9.]+", line)] == []


def test_zizmor_has_no_findings() -> None:
    """The auditor of workflows, without the network, at its strictest."""
    command = [str(Path(sys.executable).with_name("zizmor")), "--offline", "--no-progress", "--persona=auditor"]
    done = subprocess.run([*command, ".github", "action.yml"], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout


def test_everything_in_the_repository_that_a_step_names_exists() -> None:
    assert os.access(ROOT / script("Build twice").split()[0], os.X_OK)
    assert all((ROOT / name).is_file() for name in re.findall(r"\S+\.lock", str(workflow())))


PLACES = ("Makefile", ".ci/release.sh", ".github/workflows/release.yml", "action.yml", ".ci/Dockerfile")


@pytest.mark.parametrize("place", PLACES)
def test_a_lock_is_installed_as_it_is(place: str) -> None:
    """Older pips look for ``coverage[toml]`` outside the lock: an error as soon as there is a newer coverage."""
    installations = [
        line for line in (ROOT / place).read_text("utf-8").splitlines() if re.search(r"-r \S*\.lock", line)
    ]
    assert installations
    assert all({"--require-hashes", "--no-deps"} <= set(line.split()) for line in installations)


@pytest.mark.parametrize("place", [".github/workflows/release.yml", "action.yml", ".ci/Dockerfile"])
def test_nothing_is_installed_that_has_no_hash(place: str) -> None:
    """Every package comes from a lock, or was built here and brings no other."""
    lines = (ROOT / place).read_text("utf-8").splitlines()
    installing = [line for line in lines if re.search(r"pip .*\b(install|wheel) ", line)]
    assert installing
    for line in installing:
        assert (
            "--require-hashes" in line
            or {"--no-deps", "--no-build-isolation"} <= set(line.split())
            or ("--no-index" in line)
        ), line


def locked(name: str) -> dict[str, str]:
    """Version of each package of a lock; every one has a hash."""
    text = (ROOT / name).read_text("utf-8")
    found = re.findall(r"^([\w.-]+)==(\S+) \\\n    --hash=sha256:[0-9a-f]{64}", text, re.MULTILINE)
    assert len(found) == len(re.findall(r"^\S", text, re.MULTILINE)), name
    return {canonicalize_name(package): version for package, version in found}


def test_the_lowest_versions_are_those_that_the_package_allows() -> None:
    """What the second Python of .ci/run has is what pyproject.toml names, no version above."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    floors = {name.lower(): version for name, version in (d.split(">=") for d in project["dependencies"])}
    lowest = locked(".ci/lowest.lock")
    assert {name: Version(lowest[name]) for name in floors} == {name: Version(v) for name, v in floors.items()}


def test_the_small_locks_are_parts_of_the_large_one() -> None:
    """What is tried here is what is built with and installed; ``make lock`` makes all of them."""
    everything = locked("requirements.lock")
    for name in (".ci/runtime.lock", ".ci/build.lock"):
        assert set(locked(name).items()) <= set(everything.items())
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    assert {canonicalize_name(Requirement(text).name) for text in project["dependencies"]} <= set(
        locked(".ci/runtime.lock")
    )
    assert {"build", "hatchling"} <= set(locked(".ci/build.lock"))
    assert "cyclonedx-bom" in locked(".ci/sbom.lock")


def test_the_lock_has_everything_that_its_packages_ask_for() -> None:
    """Nothing else is installed, so nothing may be missing."""
    versions = locked("requirements.lock")
    if version("pydantic") != versions["pydantic"]:
        pytest.skip("what is installed is not of this lock: its packages ask for other ones")
    made = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
    waiting = [Requirement(text) for text in (*made["project"]["dependencies"], *made["dependency-groups"]["dev"])]
    seen = set()
    while waiting:
        wanted = waiting.pop()
        name = canonicalize_name(wanted.name)
        if (name, *wanted.extras) in seen or name == "plcgen":
            continue
        seen.add((name, *wanted.extras))
        assert wanted.specifier.contains(versions[name], prereleases=True), str(wanted)
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
            shutil.copytree(source, first / name, ignore=shutil.ignore_patterns("__pycache__", "*.png", "codemirror.*"))
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
