"""The files for GitHub, GitLab, pre-commit and Docker: their commands run here as they would there."""

from __future__ import annotations

import os
import subprocess
import tomllib
from pathlib import Path
from typing import Any

import pytest
import yaml
from projects import FAQ, ROOT

BROKEN = "plc: {name: a}\n"


def read(name: str) -> Any:
    """A YAML file of the repository."""
    return yaml.safe_load((ROOT / name).read_text("utf-8"))


@pytest.fixture
def repository(tmp_path: Path, forks: Path) -> Path:
    """A repository of somebody who uses plcgen: a spec, its committed sources, a lock; and ``plcgen`` on the path."""
    (tmp_path / "bin").symlink_to(forks)
    folder = tmp_path / "repository"
    folder.mkdir()
    (folder / "press.yaml").write_bytes(FAQ.read_bytes())
    done = run("plcgen generate . --quiet && plcgen lock press_generated --quiet", folder)
    assert done.returncode == 0, done.stderr
    return folder


def run(script: str, folder: Path, **variables: str) -> subprocess.CompletedProcess[str]:
    """Run a script as a runner does: bash that stops at the first error."""
    path = f"{folder.parent / 'bin'}{os.pathsep}{os.environ['PATH']}"
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "PATH": path, **variables}
    command = ["bash", "-e", "-o", "pipefail", "-c", script]
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)


def hooks() -> list[tuple[str, str]]:
    """Name and command of every hook."""
    return [(hook["id"], " ".join([hook["entry"], *hook.get("args", [])])) for hook in read(".pre-commit-hooks.yaml")]


@pytest.mark.slow
def test_hooks(repository: Path) -> None:
    """Each hook passes in a repository that is in order; a spec with a mistake is found by the first."""
    for _, command in hooks():
        done = run(command, repository)
        assert done.returncode == 0, (command, done.stderr)
    (repository / "other.yaml").write_text(BROKEN, "utf-8")
    assert run(dict(hooks())["plcgen-check"], repository).returncode == 1


def test_hooks_are_as_pre_commit_wants_them() -> None:
    """Keys that every hook needs; none gets names of files, because each looks at the whole repository."""
    for hook in read(".pre-commit-hooks.yaml"):
        assert {"id", "name", "entry", "language"} <= hook.keys()
        assert hook["language"] == "python"
        assert hook["pass_filenames"] is False


@pytest.mark.slow
def test_action(repository: Path) -> None:
    """Every step of the action but the installation runs; a mistake is annotated at its line."""
    action = read("action.yml")
    assert action["runs"]["using"] == "composite"
    steps = [step for step in action["runs"]["steps"] if "plcgen " in step.get("run", "")]
    assert [step["run"].split()[1] for step in steps] == ["check", "generate", "lock", "verify"]
    values = {"paths": ".", "faults": "none", "lock": "plcgen.lock.yaml"}
    assert values.keys() < action["inputs"].keys()
    for step in steps:
        assert step["shell"] == "bash"
        assert "${{" not in step["run"], "what somebody else typed gets to the shell as a variable"
        variables = {name: values[text.split(".")[1].rstrip(" }")] for name, text in step["env"].items()}
        done = run(step["run"], repository, **variables)
        assert done.returncode == 0, (step["run"], done.stderr)
    (repository / "press.yaml").write_text(BROKEN, "utf-8")
    failed = run(steps[0]["run"], repository, PATHS=".")
    assert failed.returncode == 1
    assert failed.stdout.startswith("::error file=press.yaml,line=1,")


@pytest.mark.slow
def test_gitlab(repository: Path) -> None:
    """The scripts run and leave the reports that the template names; without a source of plcgen it stops at once."""
    template = read("ci/gitlab.yml")
    first, _install = template[".plcgen"]["before_script"]
    assert run(first, repository, PLCGEN="").returncode == 1
    for job in ("plcgen-check", "plcgen-verify"):
        script = "\n".join(template[job]["script"])
        done = run(script, repository, PLCGEN_PATHS=".", PLCGEN_FAULTS="none")
        assert done.returncode == 0, (script, done.stderr)
        assert (repository / template[job]["artifacts"]["reports"]["junit"]).is_file()


def test_docker() -> None:
    """What is copied into the image is all that the wheel is made of."""
    ignored = (ROOT / ".dockerignore").read_text("utf-8").split()
    copied = {line.removeprefix("!") for line in ignored if line.startswith("!")}
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
    wheel = project["tool"]["hatch"]["build"]["targets"]["wheel"]
    needed = {
        project["project"]["readme"],
        *project["project"]["license-files"],
        *wheel["packages"],
        *wheel["force-include"],
    }
    assert copied == needed | {"pyproject.toml"}
    assert all((ROOT / name).exists() for name in copied)


def test_git_diff_goes_on_after_a_version_that_cannot_be_read(repository: Path) -> None:
    """The command of docs/diff.md: git ends at the first file whose command does not end with 0."""
    (command,) = (
        line[2:] for line in (ROOT / "docs/diff.md").read_text("utf-8").splitlines() if "$ git config" in line
    )
    (repository / ".gitattributes").write_text("*.db diff=plcgen\n")
    db = 'DATA_BLOCK "{}" STRUCT a : {}; END_STRUCT BEGIN END_DATA_BLOCK\n'
    for name in "AB":
        (repository / f"{name}.db").write_text(db.format(name, "INT"))
    assert run(f"git init --quiet . && git add . && {command}", repository).returncode == 0
    (repository / "A.db").write_text(db.format("A", "???"))
    (repository / "B.db").write_text(db.format("B", "REAL"))
    done = run("git diff", repository)
    assert (done.returncode, "a: INT -> REAL" in done.stdout) == (0, True), done
