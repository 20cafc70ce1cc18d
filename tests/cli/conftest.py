"""The command line as a function, and as a process."""

import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest
from click.testing import CliRunner

from plcgen.cli.main import run as run_main

ROOT = Path(__file__).parents[2]
GOOD = """\
plc: {name: Demo, family: s7-300, toolchain: tia-v16, names: faq}
drives:
  dcm: {device: sinamics-dcm, address: 256, drive_object: 2}
jobs:
  read_it: {drive: dcm, read: [P50303], request: {db: 3}, response: {db: 4}, reference: 3}
"""
BAD = GOOD.replace("sinamics-dcm", "sinamics-dcmm")


@dataclass(frozen=True)
class Result:
    """Exit code and what each stream got."""

    code: int
    out: str
    err: str


@pytest.fixture
def plcgen(monkeypatch, tmp_path):
    """Run the command line in this process, in an empty folder."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("NO_COLOR", raising=False)
    monkeypatch.setenv("COLUMNS", "100")

    def run(*args, stdin=""):
        with CliRunner().isolation(input=stdin) as streams:
            code = run_main([str(arg) for arg in args])
            return Result(code, *(stream.getvalue().decode() for stream in streams[:2]))

    return run


@pytest.fixture
def process(tmp_path):
    """Run the command line as a real process, in an empty folder."""

    def run(*args, env=None, **more):
        command = [sys.executable, "-m", "plcgen", *map(str, args)]
        environment = {**os.environ, "PYTHONPATH": str(ROOT), "COLUMNS": "100", **(env or {})}
        return subprocess.run(
            command, cwd=tmp_path, env=environment, capture_output=True, check=False, timeout=60, **more
        )

    return run


@pytest.fixture
def good(tmp_path):
    """Path of a spec without problems."""
    path = tmp_path / "job.yaml"
    path.write_text(GOOD, encoding="utf-8")
    return path.name


@pytest.fixture
def bad(tmp_path):
    """Path of a spec with an unknown device."""
    path = tmp_path / "bad.yaml"
    path.write_text(BAD, encoding="utf-8")
    return path.name
