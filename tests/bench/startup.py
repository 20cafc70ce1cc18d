"""Start-up of the command line next to another click tool (cantools) and to bare Python, as whole processes."""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

from tests.bench.specs import hundred_lines

PEER = "cantools --help"
GOALS = {"plcgen --help": 1.0, "plcgen check (100 lines)": 1.5}
"""Times the CPU time of the peer."""


def table(rounds: int) -> list[str]:
    """A line for each command: median CPU time in milliseconds, ratio to the peer in the same run."""
    with tempfile.TemporaryDirectory() as folder:
        spec = Path(folder) / "job.yaml"
        spec.write_text(hundred_lines())
        commands = {
            "python -c pass": ["-c", "pass"],
            "plcgen --version": ["-m", "plcgen", "--version"],
            "plcgen --help": ["-m", "plcgen", "--help"],
            "plcgen check (100 lines)": ["-m", "plcgen", "check", "--quiet", str(spec)],
            PEER: ["-m", "cantools", "--help"],
        }
        times: dict[str, list[float]] = {name: [] for name in commands}
        for _ in range(rounds):
            for name, arguments in commands.items():
                times[name].append(_milliseconds(arguments))
    found = {name: statistics.median(each) for name, each in times.items()}
    return [
        f"{name:<26} {time:6.0f} ms   ratio {time / found[PEER]:4.1f}"
        + (f"   goal <= {GOALS[name]}" if name in GOALS else "")
        for name, time in found.items()
    ]


def _milliseconds(arguments: list[str]) -> float:
    before = os.times()
    subprocess.run([sys.executable, *arguments], capture_output=True, check=True, cwd=Path(__file__).parents[2])
    after = os.times()
    return 1000 * (after.children_user - before.children_user + after.children_system - before.children_system)
