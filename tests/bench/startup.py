"""Start-up of the command line next to another click tool (cantools) and to bare Python, as whole processes."""

from __future__ import annotations

import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from tests.bench.specs import hundred_lines

ROUNDS = 11


def table() -> list[tuple[str, float, float | None]]:
    """(command, median milliseconds, budget in milliseconds or None)."""
    with tempfile.TemporaryDirectory() as folder:
        spec = Path(folder) / "job.yaml"
        spec.write_text(hundred_lines())
        rows: list[tuple[str, list[str], float | None]] = [
            ("python -c pass", ["-c", "pass"], None),
            ("plcgen --version", ["-m", "plcgen", "--version"], 60),
            ("plcgen --help", ["-m", "plcgen", "--help"], 120),
            ("plcgen check (100 lines)", ["-m", "plcgen", "check", "--quiet", str(spec)], 250),
            ("cantools --version", ["-m", "cantools", "--version"], None),
            ("cantools --help", ["-m", "cantools", "--help"], None),
        ]
        times: dict[str, list[float]] = {name: [] for name, _, _ in rows}
        for _ in range(ROUNDS):
            for name, arguments, _ in rows:
                times[name].append(_milliseconds(arguments))
        return [(name, statistics.median(times[name]), budget) for name, _, budget in rows]


def _milliseconds(arguments: list[str]) -> float:
    start = time.perf_counter()
    subprocess.run([sys.executable, *arguments], capture_output=True, check=True, cwd=Path(__file__).parents[2])
    return (time.perf_counter() - start) * 1000
