"""``--watch``: what changes makes a run, what does not change makes none. Time is what the test says it is."""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from click.testing import CliRunner

from plcgen.cli import watch
from plcgen.cli.main import run
from tests.projects import FAQ, ROOT

SPEC = (ROOT / "specs" / f"{FAQ.stem}.yaml").read_text("utf-8")
Step = Callable[[], object]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current folder with a spec."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "job.yaml").write_text(SPEC, "utf-8")
    return tmp_path


def watched(monkeypatch: pytest.MonkeyPatch, args: list[str], *steps: Step) -> tuple[int, str, str]:
    """Exit code, stdout and stderr of a watch; each step happens in one pause, after the last one comes Ctrl-C."""
    left: Iterator[Step] = iter(steps)

    def pause(_seconds: float) -> None:
        step = next(left, None)
        if step is None:
            raise KeyboardInterrupt
        step()

    monkeypatch.setattr(watch, "pause", pause)
    with CliRunner().isolation() as streams:
        code = run([*args, "--watch"])
        return code, streams[0].getvalue().decode(), streams[1].getvalue().decode()


def nothing() -> None:
    """A pause in which nothing happens."""


def test_a_change_is_a_run(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The mistake is told, and its end, and Ctrl-C is no error; without a change there is no run."""
    spec = folder / "job.yaml"
    steps = [
        nothing,
        lambda: spec.write_text(SPEC.replace("P50304: 100.0", "P2044: 700.0"), "utf-8"),
        nothing,
        lambda: spec.write_text(SPEC, "utf-8"),
        nothing,
    ]
    code, out, err = watched(monkeypatch, ["check", "job.yaml"], *steps)
    assert code == 0
    assert out.count("error[PG209]") == 1
    assert err.count("watching 1 file; Ctrl-C ends") == 3
    assert err.count("job.yaml has changed") == 2


def test_a_file_that_is_still_written_waits(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As long as it changes from look to look nothing runs: the half text is never told of."""
    spec = folder / "job.yaml"
    steps = [lambda: spec.write_text(SPEC[:50], "utf-8"), lambda: spec.write_text(SPEC + "# more\n", "utf-8"), nothing]
    _, out, err = watched(monkeypatch, ["check", "job.yaml"], *steps)
    assert "error" not in out
    assert err.count("watching") == 2


def test_included_files_and_profiles_count(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever a spec may read is looked at: what is new and what is gone, too."""
    shared = folder / "common" / "plant.yaml"

    def appears() -> None:
        shared.parent.mkdir()
        shared.write_text("variables: {}\n")

    _, _, err = watched(monkeypatch, ["check", "job.yaml"], appears, nothing, shared.unlink, nothing)
    name = Path("common", "plant.yaml")
    assert f"{name} is new" in err
    assert f"{name} is gone" in err


def test_its_own_files_are_no_change(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Generate does not run for what it wrote; a spec that vanishes is told, the watch goes on."""
    spec = folder / "job.yaml"
    steps = [nothing, nothing, spec.unlink, nothing, lambda: spec.write_text(SPEC, "utf-8"), nothing]
    code, _, err = watched(monkeypatch, ["generate", "job.yaml"], *steps)
    assert code == 0
    assert (folder / "job_generated" / "manifest.json").is_file()
    assert "cannot read the file: no such file" in err
    assert err.count("watching") == 3


@pytest.mark.slow
def test_verify_looks_at_the_generated_files(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A block that somebody changes is verified again."""
    assert run(["generate", "job.yaml", "--quiet"]) == 0
    (block,) = (folder / "job_generated").glob("*.scl")
    steps = [lambda: block.write_text(block.read_text("utf-8") + "// by hand\n", "utf-8"), nothing]
    _, out, err = watched(monkeypatch, ["verify", "job.yaml", "--faults", "none"], *steps)
    assert f"{block.name} has changed" in err
    assert out.count("PG602") == 1


def test_a_stream_of_results_is_refused(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """JSON needs a file, which is written again by each run and is no change itself."""
    code, _, err = watched(monkeypatch, ["check", "job.yaml", "--json"])
    assert (code, "needs a file: --output FILE" in err) == (2, True)
    code, _, err = watched(monkeypatch, ["generate", "job.yaml", "--watch", "--json"])
    assert (code, "--watch shows text only" in err) == (2, True)  # generate has no --output
    code, out, _ = watched(monkeypatch, ["check", "job.yaml", "--json", "-o", "found.json"], nothing, nothing)
    assert (code, out) == (0, "")
    assert (folder / "found.json").stat().st_size > 0


@pytest.mark.skipif(sys.platform == "win32", reason="not run: signals of POSIX")
@pytest.mark.slow
def test_ctrl_c_without_a_terminal(folder: Path) -> None:
    """A process of its own, its streams in pipes: SIGINT ends it with 0."""
    command = [sys.executable, "-m", "plcgen", "check", "job.yaml", "--watch"]
    with subprocess.Popen(command, cwd=folder, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stderr is not None
        while "Ctrl-C ends" not in process.stderr.readline():
            assert process.poll() is None
        process.send_signal(signal.SIGINT)
        try:
            assert process.wait(60) == 0
        finally:
            process.kill()
