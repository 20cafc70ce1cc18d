"""A forked ``plcgen`` does what a started one does, whatever it is asked."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.docs.pages import ROOT

SCRIPTS = (
    "plcgen check job.yaml",
    "mkdir a; cd a; plcgen check ../job.yaml; echo $?",
    "COLUMNS=50 plcgen check -h; COLUMNS=80 plcgen check -h",
    "plcgen encode read P2 --device sinamics-g120 | plcgen decode",
    "plcgen explain --list | head -1; echo ${PIPESTATUS[@]}",
    "plcgen wrong; echo $?; plcgen check 加工站.yaml; echo $?",
    "plcgen explain 0x11 > /dev/full; echo $?",
)


@pytest.fixture
def started(tmp_path: Path) -> Path:
    """A folder with a ``plcgen`` that starts Python."""
    tool = tmp_path / "plcgen"
    tool.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m plcgen "$@"\n', "utf-8")
    tool.chmod(0o755)
    return tmp_path


@pytest.mark.slow
@pytest.mark.parametrize("script", SCRIPTS)
def test_both_do_the_same(script: str, forks: Path, started: Path, tmp_path: Path) -> None:
    """Output, errors and exit codes; each call sees its own folder, variables and streams."""
    ends = []
    for tool in (forks, started):
        folder = tmp_path / tool.name
        folder.mkdir()
        (folder / "job.yaml").write_text("plc: {name: a}\n", "utf-8")
        environment = {**os.environ, "PATH": f"{tool}{os.pathsep}{os.environ['PATH']}", "PYTHONPATH": str(ROOT)}
        done = subprocess.run(
            ["bash", "-c", script], cwd=folder, env=environment, capture_output=True, timeout=60, check=False
        )
        ends.append((done.returncode, done.stdout, done.stderr))
    assert ends[0] == ends[1]
    assert ends[0][1] + ends[0][2]
