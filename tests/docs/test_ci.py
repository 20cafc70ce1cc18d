"""The files for GitHub, GitLab, pre-commit and Docker: their commands run here as they would there."""

from __future__ import annotations

import os
import subprocess
import tomllib
from pathlib import Path
from typing import Any

import pytest
import yaml

from tests.docs.test_architecture import HOMES
from tests.projects import FAQ, ROOT

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
    values = {"paths": ".", "faults": "none", "lock": "plcgen.lock.json", "fail-on": "any"}
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
    template = read(".ci/gitlab.yml")
    first, _install = template[".plcgen"]["before_script"]
    assert run(first, repository, PLCGEN="").returncode == 1
    for job in ("plcgen-check", "plcgen-verify"):
        script = "\n".join(template[job]["script"])
        done = run(script, repository, PLCGEN_PATHS=".", PLCGEN_FAULTS="none")
        assert done.returncode == 0, (script, done.stderr)
        assert (repository / template[job]["artifacts"]["reports"]["junit"]).is_file()


def commands() -> list[str]:
    """Every command line of plcgen in the action, the template and the hooks."""
    lines = [step.get("run", "") for step in read("action.yml")["runs"]["steps"]]
    template = read(".ci/gitlab.yml")
    lines += [line for job in ("plcgen-check", "plcgen-verify") for line in template[job]["script"]]
    return [line for line in [*lines, *(command for _, command in hooks())] if line.startswith("plcgen ")]


def test_what_counts_is_not_left_to_the_repository() -> None:
    """Whatever plcgen.toml may lower or name, and what a file called like an option could, is said on the line."""
    said = {"verify": {"--faults", "--no-cache"}, "lock": {"--fail-on", "--out"}, "check": set(), "generate": set()}
    assert {line.split()[1] for line in commands()} == set(said)
    for line in commands():
        words = line.split()
        assert said[words[1]] <= set(words), line
        paths = [place for place, word in enumerate(words) if "PATHS" in word]
        assert all(words[place - 1] == "--" for place in paths), line


def test_pip_is_not_taken_from_the_repository() -> None:
    """``python -m`` looks into the current folder first, which is what is judged: -I leaves it out."""
    lines = [step.get("run", "") for step in read("action.yml")["runs"]["steps"]]
    lines += read(".ci/gitlab.yml")[".plcgen"]["before_script"]
    installing = [line for text in lines for line in text.splitlines() if "pip" in line and line.startswith("python")]
    assert len(installing) == 3
    assert all(line.startswith("python -I -m pip ") for line in installing)


@pytest.mark.slow
def test_a_repository_cannot_weaken_the_hooks(repository: Path) -> None:
    """A pull request that changes a layout and says fail-on = never is found all the same."""
    (repository / "plcgen.toml").write_text('[lock]\nfail-on = "never"\n', "utf-8")
    spec = repository / "press.yaml"
    spec.write_text(spec.read_text("utf-8").replace("P50303", "P50304"), "utf-8")
    assert run("plcgen generate . --quiet --force", repository).returncode == 0
    assert run("plcgen lock --check", repository).returncode == 0
    found = run(dict(hooks())["plcgen-lock"], repository)
    assert (found.returncode, "PG903" in found.stderr) == (1, False), found


def test_where_libraries_are_used_is_tested_on_every_python() -> None:
    """The sample has the tests of every room that is the place of a library, and names nothing that is gone."""
    (line,) = (line for line in (ROOT / "Makefile").read_text("utf-8").splitlines() if line.startswith("SAMPLE := "))
    sample = [ROOT / "tests" / name for name in line.removeprefix("SAMPLE := ").split()]
    assert [path for path in sample if not path.exists()] == []
    assert [
        home for home in HOMES.values() if not {ROOT / "tests" / home, *(ROOT / "tests" / home).parents} & {*sample}
    ] == []


def test_docker() -> None:
    """What is copied into the image is all that the wheel is made of."""
    ignored = (ROOT / ".dockerignore").read_text("utf-8").split()
    copied = {line.removeprefix("!") for line in ignored if line.startswith("!")}
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
    wheel = project["tool"]["hatch"]["build"]["targets"]["wheel"]
    needed = {
        project["project"]["readme"],
        *project["project"]["license-files"],
        *wheel["only-include"],
        *wheel["force-include"],
    }
    assert copied == needed | {"pyproject.toml", ".ci/build.lock", ".ci/runtime.lock"}
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
